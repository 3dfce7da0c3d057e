// SPDX-License-Identifier: BSD-3-Clause
#include "sort.h"

#include "mesh.h"
#include "support.h"

#include "vtkStratusTetrahedra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>

namespace {

constexpr int views = 8;              // of record, each perspective and parallel
constexpr int rays = 64;              // per view
constexpr double least_length = 1e-9; // relative to the mesh's size; shorter stretches may be due to rounding

using point = std::array<double, 3>;

struct stretch {
  double low, high;
  int64_t rank;
};

double dot(const point& a, const point& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

point corner(const stratus_mesh& mesh, int64_t cell, int vertex)
{
  const double* p = mesh.points + 3 * static_cast<int64_t>(mesh.vertices[4 * cell + vertex]);
  return { p[0], p[1], p[2] };
}

point minus(const point& a, const point& b)
{
  return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

// Finds the part of a ray inside all four faces. Returns false where there is none, or where the cell is flat up to rounding.
bool clip(const stratus_mesh& mesh, int64_t cell, const point& origin, const point& direction, stretch& hit)
{
  hit.low = 0.0;
  hit.high = INFINITY;
  for (int f = 0; f < 4; ++f) {
    const point a = corner(mesh, cell, (f + 1) % 4), u = minus(corner(mesh, cell, (f + 2) % 4), a),
                v = minus(corner(mesh, cell, (f + 3) % 4), a);
    const point normal = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] };
    const double inner = dot(normal, minus(corner(mesh, cell, f), a)), sign = inner > 0.0 ? 1.0 : -1.0;
    const double start = sign * dot(normal, minus(origin, a)), slope = sign * dot(normal, direction);
    if (std::abs(inner) <= 1e-12 * std::sqrt(dot(normal, normal) * dot(u, u)) || (slope == 0.0 && start < 0.0)) {
      return false;
    }
    if (slope > 0.0) {
      hit.low = std::max(hit.low, -start / slope);
    } else if (slope < 0.0) {
      hit.high = std::min(hit.high, -start / slope);
    }
    if (hit.high < hit.low) {
      return false;
    }
  }
  return true;
}

// Finds spheres around the cells, to reject most cells near no ray. The fourth number is the squared radius.
std::vector<std::array<double, 4>> balls_of(const stratus_mesh& mesh)
{
  std::vector<std::array<double, 4>> balls(static_cast<size_t>(mesh.cell_count));
  for (int64_t c = 0; c < mesh.cell_count; ++c) {
    point middle = { 0, 0, 0 };
    double radius = 0.0;
    for (int i = 0; i < 12; ++i) {
      middle[i % 3] += 0.25 * corner(mesh, c, i / 3)[i % 3];
    }
    for (int v = 0; v < 4; ++v) {
      const point from = minus(corner(mesh, c, v), middle);
      radius = std::max(radius, dot(from, from));
    }
    balls[static_cast<size_t>(c)] = { middle[0], middle[1], middle[2], radius * (1.0 + 1e-9) };
  }
  return balls;
}

bool is_near(const std::array<double, 4>& ball, const point& origin, const point& direction)
{
  const point from = { ball[0] - origin[0], ball[1] - origin[1], ball[2] - origin[2] };
  const double along = dot(from, direction);
  const point across = { from[0] - along * direction[0], from[1] - along * direction[1], from[2] - along * direction[2] };
  return dot(across, across) <= ball[3] + 1e-14 * dot(from, from);
}

// Counts the pairs of cells that follow one another on rays through cells, and the pairs that the order has reversed.
void ask_rays(const stratus_mesh& mesh, const std::vector<std::array<double, 4>>& balls, const stratus_camera& camera,
  const uint32_t* cells, double size, int64_t& pairs, int64_t& wrong)
{
  std::mt19937 random(1);
  std::vector<int64_t> rank(static_cast<size_t>(mesh.cell_count));
  for (int64_t i = 0; i < mesh.cell_count; ++i) {
    rank[cells[i]] = i;
  }
  for (int r = 0; r < rays; ++r) {
    const auto through = static_cast<int64_t>(random() % static_cast<uint64_t>(mesh.cell_count));
    point target = { 0, 0, 0 }, origin, direction;
    for (int v = 0; v < 4; ++v) {
      const point p = corner(mesh, through, v);
      for (int a = 0; a < 3; ++a) {
        target[a] += (0.19 + 0.04 * v) * p[a];
      }
    }
    for (int a = 0; a < 3; ++a) {
      direction[a] = camera.parallel ? camera.forward[a] : target[a] - camera.eye[a];
    }
    const double length = std::sqrt(dot(direction, direction));
    for (int a = 0; a < 3; ++a) {
      direction[a] /= length;
      origin[a] = camera.parallel ? target[a] - 4.0 * size * direction[a] : camera.eye[a];
    }
    std::vector<stretch> hits;
    stretch hit;
    if (!clip(mesh, through, origin, direction, hit)) {
      continue; // a ray through a cell without volume may run between the others
    }
    for (int64_t c = 0; c < mesh.cell_count; ++c) {
      if (is_near(balls[static_cast<size_t>(c)], origin, direction) && clip(mesh, c, origin, direction, hit) &&
        hit.high - hit.low > least_length * size) {
        hit.rank = rank[static_cast<size_t>(c)];
        hits.push_back(hit);
      }
    }
    std::sort(hits.begin(), hits.end(), [](const stretch& p, const stretch& q) { return p.low + p.high < q.low + q.high; });
    for (size_t i = 1; i < hits.size(); ++i) {
      if (hits[i - 1].high <= hits[i].low + 0.1 * least_length * size) {
        ++pairs;
        wrong += hits[i - 1].rank > hits[i].rank;
      }
    }
  }
}

std::string count(int64_t number)
{
  return cli::grouped(static_cast<unsigned long long>(number));
}

void bounds_of(const stratus_mesh& mesh, double bounds[6])
{
  for (int a = 0; a < 3; ++a) {
    bounds[2 * a] = INFINITY;
    bounds[2 * a + 1] = -INFINITY;
    for (int64_t i = 0; i < 4 * mesh.cell_count; ++i) {
      const double x = mesh.points[3 * static_cast<int64_t>(mesh.vertices[i]) + a];
      bounds[2 * a] = std::min(bounds[2 * a], x);
      bounds[2 * a + 1] = std::max(bounds[2 * a + 1], x);
    }
  }
}

// Measures one way to sort over all views and prints it as one line.
void measure(const cli::context& core, const cli::options& o, const char* name, const stratus_mesh& mesh, const stratus_leaves* leaves,
  stratus_peeling peeling)
{
  stratus_visibility_order* made = nullptr;
  core.check(stratus_visibility_order_create(core, &mesh, leaves, &made), "visibility order");
  const std::unique_ptr<stratus_visibility_order, decltype(&stratus_visibility_order_destroy)> order(
    made, &stratus_visibility_order_destroy);
  double bounds[6], size = 0.0, milliseconds = 0.0;
  int64_t pairs = 0, wrong = 0, cycles = 0, overlaps = 0, forced = 0, layers = 0;
  stratus_visibility_result result = {};
  bounds_of(mesh, bounds);
  const std::vector<std::array<double, 4>> balls = balls_of(mesh);
  for (int a = 0; a < 3; ++a) {
    size = std::max(size, bounds[2 * a + 1] - bounds[2 * a]);
  }
  for (int view = 0; view < 2 * views; ++view) {
    stratus_camera camera;
    core.check(stratus_scene_camera(core, bounds, o.up.empty() ? 2 : o.up[0] - 'x', view / 2, view % 2, 1.0, &camera), "camera");
    core.check(stratus_visibility_order_sort(order.get(), &camera, nullptr, peeling, &result), "visibility order");
    milliseconds += (result.signs_ms + result.peel_ms) / (2 * views);
    cycles += result.cycles;
    layers += result.layers;
    overlaps += result.overlaps;
    forced += result.forced;
    ask_rays(mesh, balls, camera, result.cells, size, pairs, wrong);
  }
  cli::row(name,
    cli::format("%.1f ms, neighbours %.1f ms once; ", milliseconds, result.build_ms) +
      (peeling == STRATUS_PEELING_LAYERS ? count(layers / (2 * views)) + " layers; " : "") + count(cycles) + " cycles, " + count(overlaps) +
      " overlaps, " + count(forced) + " cells before what hides them; " + count(wrong) + " of " + count(pairs) + " pairs wrong");
  if (peeling == STRATUS_PEELING_LAYERS && !leaves) {
    cli::row("as given",
      count(result.flat) + " cells without volume, " + count(result.inverted) + " of negative orientation, " + count(result.folded) +
        " faces folded");
  }
}
} // namespace

void cli::print_sort(const options& o)
{
  context core(o.device, o.threads);
  const vtkSmartPointer<vtkUnstructuredGrid> grid = read_grid(o.source);
  vtkStratusTetrahedra tetrahedra;
  std::string error;
  if (!tetrahedra.Set(grid, error)) {
    throw failure(error);
  }
  const stratus_mesh mesh = tetrahedra.GetMesh();
  if (mesh.cell_count == 0) {
    throw failure("'" + o.source + "' has no cell with a volume to sort");
  }
  stratus_partition_options options = stratus_partition_options_default();
  options.depth = o.depth;
  stratus_partition* made = nullptr;
  core.check(stratus_partition_create(core, &mesh, &options, &made), "partition");
  const std::unique_ptr<stratus_partition, decltype(&stratus_partition_destroy)> partition(made, &stratus_partition_destroy);
  stratus_partition_result cut;
  stratus_partition_get(partition.get(), &cut);
  stratus_mesh pieces = mesh;
  pieces.points = cut.points;
  pieces.point_count = cut.point_count;
  pieces.vertices = cut.vertices;
  pieces.cell_count = cut.cell_count;

  std::printf("%s\n", o.source.c_str());
  row(
    "grid", count(grid->GetNumberOfCells()) + " cells, " + count(mesh.cell_count) + " tetrahedra, " + count(mesh.point_count) + " points");
  row("leaves",
    count(cut.leaves.leaf_count) +
      format(", the largest with %.1f %% of the cells; %.2f %% more cells, ",
        100.0 * static_cast<double>(cut.largest_leaf) / static_cast<double>(cut.cell_count),
        100.0 * static_cast<double>(cut.cell_count - mesh.cell_count) / static_cast<double>(mesh.cell_count)) +
      count(cut.cut_cells) + " cut");
  row("device", stratus_context_device(core));
  row("views", format("%d, %d rays each", 2 * views, rays));
  measure(core, o, "by leaves", pieces, &cut.leaves, STRATUS_PEELING_NEAREST);
  measure(core, o, "in one leaf", mesh, nullptr, STRATUS_PEELING_NEAREST);
  measure(core, o, "in layers", mesh, nullptr, STRATUS_PEELING_LAYERS);
  if (o.report) {
    core.print_build_report();
  }
}
