// SPDX-License-Identifier: BSD-3-Clause
// Our trees as methods of stratus-bench tree, and the names of all methods.
#include "tree_methods.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace bench {

namespace {

const char* const peers[] = { "embree:low", "embree:medium", "embree:high", "embree:packet:low", "embree:packet", "embree:packet:high",
  "embree:bricks:low", "embree:bricks", "embree:bricks:high", "openvdb" };

// Returns whether a method's leaves contain bricks; other leaves contain voxels.
bool has_bricks(stratus_tree_method m)
{
  return m == STRATUS_TREE_HYBRID || m == STRATUS_TREE_HYBRID_PAPER;
}

// Whether a method's tree is more than one distance field.
bool has_leaves(stratus_tree_method m)
{
  return m != STRATUS_TREE_DISTANCE && m != STRATUS_TREE_OCTANT && m != STRATUS_TREE_WIDE && m != STRATUS_TREE_AUTO;
}

const char* const by_edges = "stratus:ac-edges";          // agglomerative clustering by the sum of edges
const char* const raw_paper = "stratus:hybrid-paper-raw"; // leaves keep the distances of jump flooding as they come out

std::string name_of(stratus_tree_method m)
{
  return std::string("stratus:") + stratus_tree_method_name(m);
}

class stratus_hits : public first_hits
{
public:
  stratus_hits(const voxel_set& s, const stratus_tree_options& o)
      : set(s), builder(host_context(2)), tracer(host_context(1)), tree_options(o)
  {
  }
  ~stratus_hits() override { stratus_tree_destroy(this->tree); }
  void build() override
  {
    stratus_tree_destroy(this->tree);
    this->tree = nullptr;
    stratus_voxels* voxels = nullptr;
    stratus_context* c = this->builder.get();
    check_status(c, stratus_voxels_create_list(c, this->set.dimensions, this->set.positions, this->set.count, &voxels));
    const stratus_status status = stratus_tree_create(c, voxels, &this->tree_options, &this->tree);
    stratus_voxels_destroy(voxels);
    check_status(c, status);
  }
  tree_numbers numbers() const override
  {
    stratus_tree_statistics s;
    stratus_tree_get_statistics(this->tree, &s);
    tree_numbers n;
    n.bytes = static_cast<double>(s.bytes);
    n.nodes = static_cast<double>(s.nodes);
    n.depth = s.depth;
    n.sah = s.sah;
    return n;
  }
  void prepare(const voxel_rays& r) override
  {
    this->order = tile_order(r, 8);
    this->rays.clear();
    for (const uint32_t number : this->order) {
      this->rays.push_back(r.rays[number]);
    }
    this->found.resize(r.rays.size());
  }
  void trace() override
  {
    check_status(
      this->tracer.get(), stratus_tree_first_hit(this->tracer.get(), this->tree, this->rays.data(), this->rays.size(), this->found.data()));
  }
  std::vector<voxel_hit> hits() const override
  {
    std::vector<voxel_hit> result(this->found.size());
    for (size_t i = 0; i < result.size(); ++i) {
      if (this->found[i].voxel[0] >= 0) {
        result[this->order[i]].t = this->found[i].t;
        std::copy(this->found[i].voxel, this->found[i].voxel + 3, result[this->order[i]].voxel);
      }
    }
    return result;
  }
  double visits() const override
  {
    double sum = 0.0;
    for (const stratus_hit& hit : this->found) {
      sum += hit.visited;
    }
    return sum / static_cast<double>(this->found.size());
  }

private:
  const voxel_set& set;
  context_pointer builder, tracer;
  stratus_tree_options tree_options;
  stratus_tree* tree = nullptr;
  std::vector<uint32_t> order;
  std::vector<stratus_ray> rays;
  std::vector<stratus_hit> found;
};

// stratus:METHOD[:LEAF], stratus:ac-edges[:LEAF] or stratus:hybrid-paper-raw[:LEAF]. A tree that is one distance field has no leaves to
// size.
bool parse_tree(const std::string& name, stratus_tree_options& options)
{
  const std::string family = family_of(name);
  const bool sized = family != name;
  const int leaf = sized ? std::atoi(name.c_str() + family.size() + 1) : 0;
  options = stratus_tree_options_default();
  options.agglomerative_by_edges = family == by_edges;
  options.uncorrected_flooding = family == raw_paper;
  const std::string plain = options.agglomerative_by_edges ? name_of(STRATUS_TREE_AC)
    : options.uncorrected_flooding                         ? name_of(STRATUS_TREE_HYBRID_PAPER)
                                                           : family;
  for (int m = 0; m < STRATUS_TREE_METHODS; ++m) {
    options.method = static_cast<stratus_tree_method>(m);
    if (plain == name_of(options.method)) {
      if (sized) {
        (has_bricks(options.method) ? options.leaf_bricks : options.leaf_voxels) = leaf;
      }
      return !sized || (leaf >= 1 && leaf <= 64 && has_leaves(options.method));
    }
  }
  return false;
}

// All names of our trees, without sizes of leaves.
std::vector<std::string> tree_names()
{
  std::vector<std::string> names;
  for (int m = 0; m < STRATUS_TREE_METHODS; ++m) {
    names.push_back(name_of(static_cast<stratus_tree_method>(m)));
    if (m == STRATUS_TREE_AC) {
      names.push_back(by_edges);
    } else if (m == STRATUS_TREE_HYBRID_PAPER) {
      names.push_back(raw_paper);
    }
  }
  return names;
}
} // namespace

std::vector<uint32_t> tile_order(const voxel_rays& rays, size_t tile)
{
  constexpr size_t width = 512;
  std::vector<uint32_t> order(rays.rays.size());
  for (size_t r = 0; r < order.size(); ++r) {
    const size_t lane = r % (tile * tile), number = r / (tile * tile), across = width / tile;
    const size_t x = number % across * tile + lane % tile, y = number / across * tile + lane / tile;
    order[r] = static_cast<uint32_t>(rays.coherent ? y * width + x : r);
  }
  return order;
}

context_pointer open_context(const char* device, int threads)
{
  stratus_context_options o = stratus_context_options_default();
  stratus_context* context = nullptr;
  char message[1024];
  o.device = device;
  o.threads = threads;
  if (stratus_context_create(&o, &context, message, sizeof message) != STRATUS_OK) {
    throw failure(message);
  }
  return context_pointer(context);
}

context_pointer host_context(int threads)
{
  return open_context("host", threads);
}

stratus_tree_options tree_options_of(const std::string& method)
{
  stratus_tree_options options;
  if (!parse_tree(method, options)) {
    throw failure(method + " is none of our trees");
  }
  return options;
}

void check_status(stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    throw failure(std::string(stratus_status_name(status)) + ": " + stratus_context_message(context));
  }
}

std::vector<std::string> all_tree_methods()
{
  std::vector<std::string> names = tree_names();
  names.insert(names.end(), std::begin(peers), std::end(peers));
  return names;
}

bool is_slow_tree(const std::string& method)
{
  static const char* const slow[] = { "stratus:hybrid-paper", raw_paper, "stratus:ac", by_edges, "stratus:dpc", "stratus:kmeans" };
  return std::any_of(std::begin(slow), std::end(slow), [&](const char* name) { return family_of(method) == name; });
}

bool may_err(const std::string& method)
{
  return family_of(method) == raw_paper;
}

std::vector<std::string> tree_curve_methods(bool quick)
{
  std::vector<std::string> names;
  for (const std::string& name : tree_names()) {
    stratus_tree_options options;
    parse_tree(name, options);
    if ((quick && is_slow_tree(name)) || may_err(name)) {
      continue;
    }
    if (!has_leaves(options.method)) {
      names.push_back(name);
      continue;
    }
    for (const char* leaf :
      has_bricks(options.method) ? std::array<const char*, 3>{ ":1", ":4", ":16" } : std::array<const char*, 3>{ ":1", ":2", ":4" }) {
      names.push_back(name + leaf);
    }
  }
  names.insert(names.end(), std::begin(peers), std::end(peers));
  return names;
}

std::unique_ptr<first_hits> make_hits(const voxel_set& set, const std::string& method)
{
  if (method == "openvdb") {
    return make_openvdb_hits(set);
  }
  if (method.rfind("embree:", 0) == 0) {
    return make_embree_hits(set, method.substr(7));
  }
  stratus_tree_options options;
  if (parse_tree(method, options)) {
    return std::make_unique<stratus_hits>(set, options);
  }
  throw failure("unknown method " + method);
}

bool is_tree_method(const std::string& name)
{
  stratus_tree_options options;
  return parse_tree(name, options) || std::find(std::begin(peers), std::end(peers), name) != std::end(peers);
}
} // namespace bench
