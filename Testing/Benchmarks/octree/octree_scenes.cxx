// SPDX-License-Identifier: BSD-3-Clause
#include "bench.h"
#include "octree_bench.h"

#include <cmath>
#include <cstdlib>

namespace bench {

namespace {

constexpr double middle = 37.5;

struct generator {
  uint32_t state = 1;
  double next()
  {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) / 16777216.0;
  }
};
} // namespace

std::vector<box_bounds> make_boxes(const std::string& name)
{
  const long count = name.rfind("boxes-", 0) == 0 ? std::atol(name.c_str() + 6) : 0;
  if (count < 1 || count > 100000000) {
    throw failure("unknown scene " + name + "; see --help");
  }
  generator random;
  std::vector<box_bounds> boxes(static_cast<size_t>(count));
  // 64 clusters, each denser towards its centre. Boxes shrink as their number grows, so that they fill the same share of space.
  const double edge = 0.05 * std::cbrt(1e5 / static_cast<double>(count));
  for (box_bounds& box : boxes) {
    const double spread = 30.0 * std::pow(random.next(), 3.0);
    const double half = edge * std::pow(100.0, random.next());
    for (size_t a = 0; a < 3; ++a) {
      const double center = 25.0 * std::floor(4.0 * random.next()) + spread * (2.0 * random.next() - 1.0);
      const double extent = half * (0.2 + 0.8 * random.next());
      box[2 * a] = center - extent;
      box[2 * a + 1] = center + extent;
    }
  }
  return boxes;
}

const std::vector<std::string>& path_names()
{
  static const std::vector<std::string> names = { "far", "near", "inside", "turn" };
  return names;
}

// Makes a path of cameras. far sees everything, near about half, inside a part from among the boxes, and all three move slowly. turn goes
// round four times.
std::vector<stratus_camera> camera_path(stratus_context* context, const std::string& name, int frames)
{
  const double up[3] = { 0, 0, 1 };
  std::vector<stratus_camera> path;
  for (int f = 0; f < frames; ++f) {
    const double along = static_cast<double>(f) / frames;
    const double angle = name == "turn" ? 8.0 * 3.14159265358979323846 * along : 0.3 * along;
    const double radius = name == "far" ? 400.0 : name == "near" ? 110.0 : name == "inside" ? 15.0 : 0.0;
    const double eye[3] = { middle + radius * std::cos(angle), middle + radius * std::sin(angle), middle + 0.3 * radius };
    double focal[3] = { middle, middle, middle };
    if (name == "inside" || name == "turn") {
      focal[0] = eye[0] + std::cos(angle + 2.0);
      focal[1] = eye[1] + std::sin(angle + 2.0);
      focal[2] = eye[2];
    }
    stratus_camera camera;
    if (stratus_camera_perspective(context, eye, focal, up, 30.0, 4.0 / 3.0, &camera) != STRATUS_OK) {
      throw failure(stratus_context_message(context));
    }
    camera.near_k = 0.1;
    camera.far_k = 1000.0;
    path.push_back(camera);
  }
  return path;
}
} // namespace bench
