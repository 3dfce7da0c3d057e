// SPDX-License-Identifier: BSD-3-Clause
// Compares first hits with the plain walk's in double precision.
#include "tree_methods.h"

#include <algorithm>
#include <cmath>

namespace bench {

namespace {

// Rounding error of a crossing, relative to the numbers that it is computed from.
constexpr double relative = 1e-9;
// Error of a hit's distance that was computed in a few float operations.
constexpr double float_relative = 4e-6;

struct chord {
  double from, to;
};

// Finds where a ray enters and leaves a voxel; from > to: it misses the voxel.
chord chord_of(const stratus_ray& r, const int32_t voxel[3])
{
  chord c = { r.t_min, r.t_max };
  for (int a = 0; a < 3; ++a) {
    const double t0 = (voxel[a] - r.origin[a]) / r.direction[a], t1 = (voxel[a] + 1.0 - r.origin[a]) / r.direction[a];
    c.from = std::max(c.from, std::min(t0, t1));
    c.to = std::min(c.to, std::max(t0, t1));
  }
  return c;
}

double scale_of(const stratus_ray& r, double t)
{
  double most = std::max(1.0, std::fabs(t));
  for (double o : r.origin) {
    most = std::max(most, std::fabs(o));
  }
  return most * relative;
}

// Whether rounding decides between two hits that differ: the ray's chord in either voxel has no length, or it enters both at once.
bool is_grazing(const stratus_ray& r, const stratus_hit& walk, const voxel_hit& hit)
{
  const bool walk_hit = walk.voxel[0] >= 0, other_hit = hit.t >= 0.0;
  double walk_from = INFINITY;
  if (walk_hit) {
    const chord c = chord_of(r, walk.voxel);
    walk_from = c.from;
    if (c.to - c.from <= scale_of(r, c.from)) {
      return true;
    }
  }
  if (other_hit) {
    const chord c = chord_of(r, hit.voxel);
    const double slack = scale_of(r, c.from);
    return c.to - c.from >= -slack && (c.to - c.from <= slack || std::fabs(c.from - walk_from) <= slack);
  }
  return false;
}
} // namespace

wrong_count count_wrong(
  const stratus_voxels* voxels, const voxel_rays& rays, const std::vector<stratus_hit>& walk, const std::vector<voxel_hit>& hits)
{
  wrong_count count;
  for (size_t i = 0; i < walk.size(); ++i) {
    const stratus_ray& r = rays.rays[i];
    const voxel_hit& h = hits[i];
    if (std::equal(h.voxel, h.voxel + 3, walk[i].voxel)) {
      double most = walk[i].voxel[0] < 0 ? INFINITY : std::max(1.0, walk[i].t);
      for (double o : r.origin) {
        most = std::max(most, std::fabs(o));
      }
      count.wrong += walk[i].voxel[0] >= 0 && !(std::fabs(h.t - walk[i].t) <= float_relative * most);
    } else if (h.t >= 0.0 && !stratus_voxels_get(voxels, h.voxel[0], h.voxel[1], h.voxel[2])) {
      ++count.wrong;
    } else if (is_grazing(r, walk[i], h)) {
      ++count.grazing;
    } else {
      ++count.wrong;
      count.missed += h.t < 0.0;
      count.late += h.t >= 0.0 && walk[i].voxel[0] >= 0 && h.t > walk[i].t;
    }
  }
  return count;
}
} // namespace bench
