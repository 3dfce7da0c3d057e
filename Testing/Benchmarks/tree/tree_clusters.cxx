// SPDX-License-Identifier: BSD-3-Clause
// Generated sets of stratus-bench tree, `clusters:NUMBER`: clusters of different size and density, apart from each other, and rays that
// begin among them. The number decides everything, so that a set never changes.
#include "tree_methods.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace bench {

namespace {

constexpr int longest = 2048;       // the grid's edge, in voxels
constexpr double most_voxels = 2e6; // of a set; clusters behind that are left out

// Numbers that follow from a seed (splitmix64).
class numbers
{
public:
  explicit numbers(uint64_t seed) : state(seed * 0x9e3779b97f4a7c15u) {}
  double unit() // in [0, 1)
  {
    uint64_t z = this->state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  double between(double low, double high) { return low + (high - low) * this->unit(); }
  double between_powers(double low, double high) { return low * std::pow(high / low, this->unit()); }

private:
  uint64_t state;
};

enum class shape { ball, shell, sponge };

struct cluster {
  double at[3], radius, fill;
  shape form;
};

// Whether a voxel at `p`, relative to the cluster's middle, belongs to the cluster's form.
bool in_form(const cluster& c, const double p[3])
{
  const double distance = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  if (distance > c.radius) {
    return false;
  }
  if (c.form == shape::shell) {
    return distance > 0.9 * c.radius - 1.0;
  }
  const double wave = 12.0 / c.radius; // a gyroid of about four periods
  const double x = wave * p[0], y = wave * p[1], z = wave * p[2];
  return c.form == shape::ball || std::fabs(std::sin(x) * std::cos(y) + std::sin(y) * std::cos(z) + std::sin(z) * std::cos(x)) < 0.25;
}

std::vector<cluster> make_clusters(numbers& random, int64_t dimensions[3])
{
  const int count = 1 << static_cast<int>(random.between(0.0, 7.0));
  const double radius = random.between_powers(8.0, 64.0), gap = random.between_powers(2.5, 40.0), fill = random.between_powers(0.003, 1.0);
  const shape form = static_cast<shape>(static_cast<int>(random.between(0.0, 3.0)));
  const double edge = std::min<double>(longest, std::ceil(std::cbrt(count) * gap * radius) + 4.0 * radius);
  std::fill(dimensions, dimensions + 3, static_cast<int64_t>(edge));
  std::vector<cluster> clusters;
  for (int n = 0; n < count; ++n) {
    cluster c;
    c.radius = std::min(radius * random.between_powers(0.7, 1.4), 0.45 * edge);
    c.fill = std::min(fill * random.between_powers(0.3, 3.0), 1.0);
    c.form = form;
    for (double& x : c.at) {
      x = random.between(c.radius + 1.0, edge - c.radius - 1.0);
    }
    clusters.push_back(c);
  }
  return clusters;
}
} // namespace

bool is_cluster_scene(const std::string& name)
{
  return name.rfind("clusters:", 0) == 0 && name.size() > 9 && name.find_first_not_of("0123456789", 9) == std::string::npos;
}

void make_cluster_set(const std::string& name, int64_t dimensions[3], std::vector<int32_t>& positions, std::vector<cluster_box>& boxes)
{
  numbers random(std::strtoull(name.c_str() + 9, nullptr, 10));
  for (const cluster& c : make_clusters(random, dimensions)) {
    const size_t before = positions.size();
    cluster_box box;
    for (int a = 0; a < 3; ++a) {
      box.lo[a] = static_cast<int32_t>(std::floor(c.at[a] - c.radius));
      box.hi[a] = static_cast<int32_t>(std::ceil(c.at[a] + c.radius)) + 1;
    }
    for (int32_t z = box.lo[2]; z < box.hi[2]; ++z) {
      for (int32_t y = box.lo[1]; y < box.hi[1]; ++y) {
        for (int32_t x = box.lo[0]; x < box.hi[0]; ++x) {
          const double p[3] = { x + 0.5 - c.at[0], y + 0.5 - c.at[1], z + 0.5 - c.at[2] };
          if (in_form(c, p) && random.unit() < c.fill) {
            positions.insert(positions.end(), { x, y, z });
          }
        }
      }
    }
    if (positions.size() > before) {
      boxes.push_back(box);
    }
    if (static_cast<double>(positions.size()) > 3.0 * most_voxels) {
      break;
    }
  }
  if (positions.empty()) {
    throw failure(name + " has no voxel; take another number");
  }
}

void make_cluster_rays(const stratus_voxels* voxels, const std::vector<cluster_box>& boxes, std::vector<stratus_ray>& rays)
{
  numbers random(boxes.size());
  int64_t n[3];
  stratus_voxels_dimensions(voxels, n);
  for (stratus_ray& ray : rays) {
    ray = stratus_ray();
    ray.t_max = INFINITY;
    bool empty = false;
    while (!empty) {
      const cluster_box& box = boxes[static_cast<size_t>(random.unit() * static_cast<double>(boxes.size()))];
      int64_t at[3];
      empty = true;
      for (int a = 0; a < 3; ++a) {
        const double rim = 0.125 * (box.hi[a] - box.lo[a]);
        ray.origin[a] = static_cast<double>(static_cast<float>(random.between(box.lo[a] - rim, box.hi[a] + rim)));
        at[a] = static_cast<int64_t>(std::floor(ray.origin[a]));
        empty = empty && at[a] >= 0 && at[a] < n[a];
      }
      empty = empty && !stratus_voxels_get(voxels, at[0], at[1], at[2]);
    }
    const double z = random.between(-1.0, 1.0), angle = random.between(0.0, 6.283185307179586), around = std::sqrt(1.0 - z * z);
    const double d[3] = { around * std::cos(angle), around * std::sin(angle), z };
    for (int a = 0; a < 3; ++a) {
      const float rounded = static_cast<float>(d[a]);
      ray.direction[a] = static_cast<double>(std::fabs(rounded) < 1e-6f ? 1e-6f : rounded); // never nearly parallel to a face
    }
  }
}
} // namespace bench
