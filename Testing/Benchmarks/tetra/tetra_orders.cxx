// SPDX-License-Identifier: BSD-3-Clause
// Compares sorters with VTK's: their times, their memory, and the pairs of cells in the wrong order, which rays find.
#include "tetra_bench.h"

#include <vtkCamera.h>
#include <vtkCellCenterDepthSort.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace bench {

namespace {

struct recipe {
  const char* name;
  int depth; // 2^depth leaves; -1: VTK's
  stratus_peeling peeling;
  stratus_partition_rule rule;
};

const recipe recipes[] = {
  { "stratus:sort", 3, STRATUS_PEELING_NEAREST, STRATUS_PARTITION_MEDIAN },
  { "stratus:sort-1", 0, STRATUS_PEELING_NEAREST, STRATUS_PARTITION_MEDIAN },
  { "stratus:sort-2", 1, STRATUS_PEELING_NEAREST, STRATUS_PARTITION_MEDIAN },
  { "stratus:sort-4", 2, STRATUS_PEELING_NEAREST, STRATUS_PARTITION_MEDIAN },
  { "stratus:sort-fifo", 0, STRATUS_PEELING_LAYERS, STRATUS_PARTITION_MEDIAN },
  { "stratus:sort-fifo-2", 1, STRATUS_PEELING_LAYERS, STRATUS_PARTITION_PAPER },
  { "stratus:sort-fifo-4", 2, STRATUS_PEELING_LAYERS, STRATUS_PARTITION_PAPER },
  { "stratus:sort-fifo-8", 3, STRATUS_PEELING_LAYERS, STRATUS_PARTITION_PAPER },
  { "vtk:depthsort", -1, STRATUS_PEELING_NEAREST, STRATUS_PARTITION_MEDIAN },
};

const recipe& find(const std::string& name)
{
  for (const recipe& r : recipes) {
    if (name == r.name) {
      return r;
    }
  }
  throw failure("unknown sorter " + name);
}

using partition_pointer = std::unique_ptr<stratus_partition, decltype(&stratus_partition_destroy)>;
using order_pointer = std::unique_ptr<stratus_visibility_order, decltype(&stratus_visibility_order_destroy)>;

void check(stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    throw failure(std::string(stratus_status_name(status)) + ": " + stratus_context_message(context));
  }
}

// A mesh to be sorted: cut into leaves, or whole.
struct pieces {
  partition_pointer partition = { nullptr, &stratus_partition_destroy };
  stratus_partition_result cut = {};
  stratus_mesh mesh;
  bool has_leaves = false;
  double ms = 0.0;
};

pieces cut_mesh(stratus_context* context, const stratus_mesh& mesh, const recipe& r)
{
  pieces p;
  p.mesh = mesh;
  if (r.depth <= 0) {
    return p;
  }
  stratus_partition_options options = stratus_partition_options_default();
  stratus_partition* made = nullptr;
  options.depth = r.depth;
  options.rule = r.rule;
  const double start = now_ms();
  check(context, stratus_partition_create(context, &mesh, &options, &made));
  p.ms = now_ms() - start;
  p.partition.reset(made);
  stratus_partition_get(made, &p.cut);
  p.mesh.points = p.cut.points;
  p.mesh.point_count = p.cut.point_count;
  p.mesh.vertices = p.cut.vertices;
  p.mesh.cell_count = p.cut.cell_count;
  p.mesh.values = nullptr; // sorters need no values
  p.has_leaves = true;
  return p;
}

order_pointer make_order(stratus_context* context, const pieces& p, double* ms)
{
  stratus_visibility_order* made = nullptr;
  const double start = now_ms();
  check(context, stratus_visibility_order_create(context, &p.mesh, p.has_leaves ? &p.cut.leaves : nullptr, &made));
  *ms = now_ms() - start;
  return order_pointer(made, &stratus_visibility_order_destroy);
}

// One method on one mesh, on all threads and on one.
class sorter
{
public:
  sorter(stratus_context* context, stratus_context* single, const tetra_mesh& mesh, const recipe& r) : Context(context), Recipe(r)
  {
    if (r.depth < 0) {
      this->Pieces.mesh = mesh.view();
      this->Vtk->SetInput(mesh.grid);
      this->Vtk->SetCamera(this->Camera);
      this->Vtk->SetDirectionToFrontToBack();
      this->Camera->SetPosition(0, 0, -1);
      const double start = now_ms();
      this->traverse(nullptr); // finds the cells' centres
      this->Build.push_back(now_ms() - start);
      return;
    }
    this->Single = single;
    this->Pieces = cut_mesh(context, mesh.view(), r);
    double ms = 0.0;
    for (int i = 0; i < 3; ++i) {
      this->Order = make_order(context, this->Pieces, &ms);
      this->Build.push_back(ms);
    }
    this->SingleOrder = make_order(single, this->Pieces, &ms);
  }

  // Returns the order, valid until the next call, and its time.
  const std::vector<uint32_t>& sort(const stratus_camera& camera, double* ms)
  {
    if (this->Recipe.depth < 0) {
      this->Camera->SetPosition(camera.eye);
      this->Camera->SetFocalPoint(camera.eye[0] + camera.forward[0], camera.eye[1] + camera.forward[1], camera.eye[2] + camera.forward[2]);
      this->Camera->SetParallelProjection(camera.parallel);
      this->Cells.clear();
      const double start = now_ms();
      this->traverse(nullptr);
      *ms = now_ms() - start;
      this->traverse(&this->Cells);
      return this->Cells;
    }
    const double start = now_ms();
    check(this->Context, stratus_visibility_order_sort(this->Order.get(), &camera, nullptr, this->Recipe.peeling, &this->Result));
    *ms = now_ms() - start;
    this->Cells.assign(this->Result.cells, this->Result.cells + this->Result.count);
    return this->Cells;
  }

  double sort_alone(const stratus_camera& camera)
  {
    stratus_visibility_result result = {};
    if (this->Recipe.depth < 0) {
      return 0.0;
    }
    const double start = now_ms();
    check(this->Single, stratus_visibility_order_sort(this->SingleOrder.get(), &camera, nullptr, this->Recipe.peeling, &result));
    return now_ms() - start;
  }

  const recipe& made_by() const { return this->Recipe; }
  const pieces& cut() const { return this->Pieces; }
  const stratus_visibility_result& last() const { return this->Result; }
  double build_ms() const { return median(this->Build); }

private:
  void traverse(std::vector<uint32_t>* cells)
  {
    this->Vtk->InitTraversal();
    for (vtkIdTypeArray* ids = this->Vtk->GetNextCells(); ids; ids = this->Vtk->GetNextCells()) {
      if (cells) {
        const vtkIdType* first = ids->GetPointer(0);
        std::transform(
          first, first + ids->GetNumberOfTuples(), std::back_inserter(*cells), [](vtkIdType id) { return static_cast<uint32_t>(id); });
      }
    }
  }

  stratus_context* Context;
  stratus_context* Single = nullptr;
  const recipe& Recipe;
  pieces Pieces;
  order_pointer Order = { nullptr, &stratus_visibility_order_destroy }, SingleOrder = { nullptr, &stratus_visibility_order_destroy };
  stratus_visibility_result Result = {};
  std::vector<uint32_t> Cells;
  std::vector<double> Build;
  vtkNew<vtkCellCenterDepthSort> Vtk;
  vtkNew<vtkCamera> Camera;
};

struct tally {
  std::vector<double> ms, alone_ms, layers;
  double wrong = 0.0, pairs = 0.0, cycles = 0.0;
};

// Counts, for each order (given as ranks), the pairs of consecutive cells on rays that it has in the wrong order.
void ask_rays(const stratus_mesh& mesh, const stratus_camera& camera, int rays, const std::vector<std::vector<uint32_t>>& ranks,
  const std::vector<tally*>& tallies)
{
  double size = 0.0;
  for (int64_t i = 3; i < 3 * mesh.point_count; ++i) {
    size = std::max(size, std::abs(mesh.points[i] - mesh.points[i % 3]));
  }
  const double least = 1e-9 * size; // shorter stretches may be rounding errors
  visit_rays(mesh, camera, rays, true, [&](ray_of_pixel& ray) {
    auto& s = ray.stretches;
    s.erase(std::remove_if(s.begin(), s.end(), [&](const stretch& x) { return (x.high - x.low) * ray.length <= least; }), s.end());
    std::vector<double> wrong(ranks.size(), 0.0);
    double pairs = 0.0;
    for (size_t i = 1; i < s.size(); ++i) {
      if (s[i - 1].high * ray.length <= s[i].low * ray.length + 0.1 * least) {
        pairs += 1.0;
        for (size_t r = 0; r < ranks.size(); ++r) {
          wrong[r] += ranks[r][static_cast<size_t>(s[i - 1].cell)] > ranks[r][static_cast<size_t>(s[i].cell)];
        }
      }
    }
#pragma omp critical(bench_ask_rays)
    for (size_t r = 0; r < ranks.size(); ++r) {
      tallies[r]->pairs += pairs;
      tallies[r]->wrong += wrong[r];
    }
  });
}

// Returns the ranks of cells. If no cell was cut, they are ranks of the whole mesh's cells, so that its rays are cast only once.
std::vector<uint32_t> ranks_of(const sorter& s, const std::vector<uint32_t>& cells, int64_t whole)
{
  const bool cut = s.cut().mesh.cell_count != whole;
  std::vector<uint32_t> ranks(cells.size());
  for (size_t i = 0; i < cells.size(); ++i) {
    ranks[s.cut().has_leaves && !cut ? static_cast<size_t>(s.cut().cut.cells[cells[i]]) : cells[i]] = static_cast<uint32_t>(i);
  }
  return ranks;
}

void judge_orders(const tetra_mesh& mesh, const std::vector<stratus_camera>& cameras, int rays,
  std::vector<std::unique_ptr<sorter>>& sorters, std::vector<tally>& tallies)
{
  const stratus_mesh whole = mesh.view();
  for (const stratus_camera& camera : cameras) {
    std::vector<std::vector<uint32_t>> shared;
    std::vector<tally*> of_shared;
    for (size_t i = 0; i < sorters.size(); ++i) {
      double ms = 0.0;
      const std::vector<uint32_t>& cells = sorters[i]->sort(camera, &ms);
      tallies[i].cycles += static_cast<double>(sorters[i]->last().cycles);
      if (cells.size() != static_cast<size_t>(sorters[i]->cut().mesh.cell_count)) {
        throw failure(std::string(sorters[i]->made_by().name) + " returned " + std::to_string(cells.size()) + " cells");
      }
      std::vector<uint32_t> ranks = ranks_of(*sorters[i], cells, whole.cell_count);
      if (sorters[i]->cut().mesh.cell_count == whole.cell_count) {
        shared.push_back(std::move(ranks));
        of_shared.push_back(&tallies[i]);
      } else {
        ask_rays(sorters[i]->cut().mesh, camera, rays, { ranks }, { &tallies[i] });
      }
    }
    ask_rays(whole, camera, rays, shared, of_shared);
  }
}

void time_orders(
  stratus_context* context, const tetra_mesh& mesh, int rounds, std::vector<std::unique_ptr<sorter>>& sorters, std::vector<tally>& tallies)
{
  for (int round = 0; round < rounds; ++round) {
    for (int view = 0; view < views; ++view) {
      stratus_camera camera;
      check(context, stratus_scene_camera(context, mesh.bounds, 2, view, 0, 1.0, &camera));
      for (size_t i = 0; i < sorters.size(); ++i) {
        double ms = 0.0;
        sorters[i]->sort(camera, &ms);
        tallies[i].ms.push_back(ms);
        tallies[i].alone_ms.push_back(sorters[i]->sort_alone(camera));
        tallies[i].layers.push_back(sorters[i]->last().layers);
      }
    }
  }
}

// Adds the bytes of an order with its partition's tree, without the caller's mesh.
void add_bytes(const tetra_mesh& mesh, const sorter& s, int threads, sorter_metrics& m)
{
  counted_context counted(threads);
  double ms = 0.0;
  const size_t before = counted.live();
  const order_pointer order = make_order(counted, s.cut(), &ms);
  stratus_camera camera;
  stratus_visibility_result result;
  check(counted, stratus_scene_camera(counted, mesh.bounds, 2, 0, 0, 1.0, &camera));
  check(counted, stratus_visibility_order_sort(order.get(), &camera, nullptr, s.made_by().peeling, &result));
  const auto cells = static_cast<double>(s.cut().mesh.cell_count);
  const auto after = static_cast<double>(counted.live() - before), peak = static_cast<double>(counted.peak() - before);
  m["bytes"] = { after, "B" };
  m["peak_bytes"] = { peak, "B" };
  m["bytes_per_cell"] = { after / cells, "B" };
  m["peak_bytes_per_cell"] = { peak / cells, "B" };
}

sorter_metrics metrics_of(const tetra_mesh& mesh, const sorter& s, const tally& t, int threads)
{
  sorter_metrics m;
  const auto whole = static_cast<double>(mesh.view().cell_count), cells = static_cast<double>(s.cut().mesh.cell_count);
  m["sort_ms"] = { median(t.ms), "ms" };
  m["build_ms"] = { s.build_ms(), "ms" };
  m["cells"] = { cells, "1" };
  m["wrong_visible_pairs"] = { t.wrong, "1" };
  m["visible_pairs"] = { t.pairs, "1" };
  if (s.made_by().depth < 0) {
    return m;
  }
  m["sort_1thread_ms"] = { median(t.alone_ms), "ms" };
  m["cycles"] = { t.cycles, "1" };
  m["layers"] = { median(t.layers), "1" };
  add_bytes(mesh, s, threads, m);
  if (s.cut().has_leaves) {
    m["partition_ms"] = { s.cut().ms, "ms" };
    m["leaves"] = { static_cast<double>(s.cut().cut.leaves.leaf_count), "1" };
    m["growth"] = { 100.0 * (cells / whole - 1.0), "%" };
    m["largest_leaf"] = { 100.0 * static_cast<double>(s.cut().cut.largest_leaf) / cells, "%" };
  }
  return m;
}
} // namespace

const std::vector<std::string>& tetra_sorters()
{
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const recipe& r : recipes) {
      all.emplace_back(r.name);
    }
    return all;
  }();
  return names;
}

std::map<std::string, sorter_metrics> run_sorters(
  stratus_context* context, const tetra_mesh& mesh, const std::vector<std::string>& names, const order_options& options)
{
  const counted_context single(1);
  std::vector<std::unique_ptr<sorter>> sorters;
  std::vector<tally> tallies(names.size());
  std::map<std::string, sorter_metrics> results;
  for (const std::string& name : names) {
    sorters.push_back(std::make_unique<sorter>(context, single, mesh, find(name)));
  }
  time_orders(context, mesh, options.rounds, sorters, tallies);
  if (options.rays > 0) {
    judge_orders(mesh, order_cameras(context, mesh), options.rays, sorters, tallies);
  }
  for (size_t i = 0; i < sorters.size(); ++i) {
    results[names[i]] = metrics_of(mesh, *sorters[i], tallies[i], options.threads);
  }
  return results;
}
} // namespace bench
