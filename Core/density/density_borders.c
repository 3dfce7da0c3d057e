/* SPDX-License-Identifier: BSD-3-Clause
 * Density and its derivatives at a point, and the borders of a peak: the positions along an axis where density falls most steeply.
 *
 * With u = (distance / h)^2, c = 105 / (32 pi) and n the number of voxels, a voxel within h adds
 *    c / (n h^3) (1 - u)^2                                to the density,
 *   -4 c / (n h^5) (x - xi) (1 - u)                       to its first derivative along x,
 *   -4 c / (n h^5) (1 - u - 2 (x - xi)^2 / h^2)           to its second derivative along x.
 * Guo et al. 2025 print the same formulas (eq. 9 to 11) with 15/16 for c and 15/4 for 4 c: the constant of one dimension. */
#include "density.h"

#include "density_plan.h"

#include <stdlib.h>
#include <string.h>

#define SMALL_BANDWIDTH 16.0 /* below it bricks are too coarse to represent their voxels along a line, and few voxels are in reach */

/* ---- at a point */

typedef struct point_sums {
  double density, first[3], second[3];
} point_sums;

static void add_brick(const stratus_brick* brick, const double point[3], double squared, point_sums* sums)
{
  for (uint64_t bits = brick->mask; bits; bits &= bits - 1) {
    const int bit = __builtin_ctzll(bits);
    const double d[3] = { point[0] - (STRATUS_BRICK * brick->at[0] + (bit & 3)), point[1] - (STRATUS_BRICK * brick->at[1] + (bit >> 2 & 3)),
      point[2] - (STRATUS_BRICK * brick->at[2] + (bit >> 4)) };
    const double rest = 1.0 - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / squared;
    if (rest > 0.0) {
      sums->density += rest * rest;
      for (int a = 0; a < 3; ++a) {
        sums->first[a] += d[a] * rest;
        sums->second[a] += rest - 2.0 * d[a] * d[a] / squared;
      }
    }
  }
}

/* Sums over the voxels in reach. Bricks are searched row by row, unless a scan of all bricks is cheaper. */
static void sum_at(const stratus_voxels* voxels, double bandwidth, const double point[3], point_sums* sums)
{
  int64_t lo[3], hi[3];
  for (int a = 0; a < 3; ++a) {
    const double last = (double)voxels->bricks_along[a] - 1.0;
    lo[a] = (int64_t)fmin(fmax(floor((point[a] - bandwidth) / STRATUS_BRICK), 0.0), last + 1.0);
    hi[a] = (int64_t)fmax(fmin(floor((point[a] + bandwidth) / STRATUS_BRICK), last), -1.0);
    if (lo[a] > hi[a]) {
      return;
    }
  }
  const int64_t count = voxels->brick_count;
  if ((hi[2] - lo[2] + 1) * (hi[1] - lo[1] + 1) > count / 4) {
    for (int64_t b = 0; b < count; ++b) {
      add_brick(voxels->bricks + b, point, bandwidth * bandwidth, sums);
    }
    return;
  }
  for (int64_t k = lo[2]; k <= hi[2]; ++k) {
    for (int64_t j = lo[1]; j <= hi[1]; ++j) {
      for (int64_t b = density_first_brick(voxels->bricks, count, density_key(lo[0], j, k));
           b < count && density_brick_key(voxels->bricks + b) <= density_key(hi[0], j, k); ++b) {
        add_brick(voxels->bricks + b, point, bandwidth * bandwidth, sums);
      }
    }
  }
}

stratus_status stratus_density_at(stratus_context* context, const stratus_voxels* voxels, double bandwidth, const double point[3],
  double* density, double first[3], double second[3])
{
  point_sums sums = { .density = 0.0 };
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!voxels || !point || !density) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", !voxels ? "voxels" : point ? "density" : "point");
  }
  if (!(bandwidth >= 1e-6 && bandwidth <= 1e9)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "bandwidth %g outside 1e-6..1e9 voxels", bandwidth);
  }
  for (int a = 0; a < 3; ++a) {
    if (!isfinite(point[a])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "coordinate %d of the point is %g, not a finite number", a, point[a]);
    }
  }
  sum_at(voxels, bandwidth, point, &sums);
  const double count = voxels->count ? (double)voxels->count : 1.0, h2 = bandwidth * bandwidth;
  const double unit = DENSITY_CONSTANT / (count * h2 * bandwidth);
  *density = unit * sums.density;
  for (int a = 0; a < 3; ++a) {
    if (first) {
      first[a] = -4.0 * unit / h2 * sums.first[a];
    }
    if (second) {
      second[a] = -4.0 * unit / h2 * sums.second[a];
    }
  }
  return STRATUS_OK;
}

/* ---- borders
 * The line through the peak has its planes between voxels, where offsets are multiples of 1/2. D is twice the offset along the line, q
 * the squared distance across it. Multiplied by 4 h^2, the sums above become sums of integers, exact in double, and h^2 times their
 * number. The order of bricks therefore changes nothing. */

typedef struct line {
  int axis;
  double reach; /* squared reach in doubled coordinates: 4 h^2 */
  int32_t peak[3];
  int32_t lo, hi; /* first and last plane */
  stratus_density_line* planes;
} line;

/* Adds a mass at the doubled coordinates `at` to all planes in reach. */
static void add_mass(const line* line, const int32_t at[3], double mass)
{
  const int u = (line->axis + 1) % 3, v = (line->axis + 2) % 3;
  const double du = at[u] - 2 * line->peak[u], dv = at[v] - 2 * line->peak[v], across = du * du + dv * dv;
  if (across >= line->reach) {
    return;
  }
  /* Plane p has the doubled coordinate 2 p - 1. */
  const double half = sqrt(line->reach - across), middle = 0.5 * (at[line->axis] + 1);
  const int32_t first = (int32_t)fmax(floor(middle - 0.5 * half), line->lo), last = (int32_t)fmin(ceil(middle + 0.5 * half), line->hi);
  for (int32_t p = first; p <= last; ++p) {
    const double along = 2.0 * p - 1.0 - at[line->axis], squared = along * along;
    if (squared + across < line->reach) {
      stratus_density_line* sums = line->planes + (p - line->lo);
      sums->count += mass;
      sums->curvature += mass * (3.0 * squared + across);
      sums->slope += mass * along;
      sums->slope_cubic += mass * along * (squared + across);
    }
  }
}

static void add_bricks(const line* line, const stratus_brick* bricks, const uint32_t* which, int64_t count, int whole)
{
  const int u = (line->axis + 1) % 3, v = (line->axis + 2) % 3;
  for (int64_t i = 0; i < count; ++i) {
    const stratus_brick* brick = bricks + (which ? (int64_t)which[i] : i);
    const int32_t at[3] = { 8 * brick->at[0], 8 * brick->at[1], 8 * brick->at[2] };
    if (whole) {
      add_mass(line, (const int32_t[3]){ at[0] + 3, at[1] + 3, at[2] + 3 }, brick->count);
      continue;
    }
    const double du = fmax(abs(at[u] + 3 - 2 * line->peak[u]) - 3, 0), dv = fmax(abs(at[v] + 3 - 2 * line->peak[v]) - 3, 0);
    for (uint64_t bits = du * du + dv * dv < line->reach ? brick->mask : 0; bits; bits &= bits - 1) {
      const int bit = __builtin_ctzll(bits);
      add_mass(line, (const int32_t[3]){ at[0] + 2 * (bit & 3), at[1] + 2 * (bit >> 2 & 3), at[2] + 2 * (bit >> 4) }, 1.0);
    }
  }
}

/* Magnitude of the first derivative, without its factor 4 c / (n h^5), times 8 h^2. bend_at() has the sign of the second derivative. */
static double fall_at(const line* line, int32_t plane)
{
  const stratus_density_line* sums = line->planes + (plane - line->lo);
  return fabs(line->reach * sums->slope - sums->slope_cubic);
}

static double bend_at(const line* line, int32_t plane)
{
  const stratus_density_line* sums = line->planes + (plane - line->lo);
  return sums->curvature - line->reach * sums->count;
}

/* Walks from the peak outward to the first plane where the second derivative is positive or no voxel is in reach (the second derivative
 * jumps at the kernel's end). The border is the steeper of that plane and the one before it. */
static void scan_side(const line* line, int side, int32_t* position, double* fall)
{
  const int32_t step = side ? 1 : -1, start = line->peak[line->axis] + (side ? 1 : 0);
  *position = start;
  *fall = 0.0;
  for (int32_t p = start; p >= line->lo && p <= line->hi; p += step) {
    if (bend_at(line, p) > 0.0 || line->planes[p - line->lo].count <= 0.0) {
      const int32_t before = p == start ? p : p - step;
      const int32_t steeper = fall_at(line, before) >= fall_at(line, p) ? before : p;
      if (steeper > line->lo && steeper < line->hi) {
        *position = steeper;
        *fall = fall_at(line, steeper);
      }
      return;
    }
  }
}

bool stratus_density_takes_whole_bricks(double bandwidth, int exact)
{
  return !exact && bandwidth >= SMALL_BANDWIDTH;
}

size_t stratus_density_line_start(const int32_t lo[3], const int32_t hi[3], int axis)
{
  size_t start = 0;
  for (int a = 0; a < axis; ++a) {
    start += (size_t)(hi[a] - lo[a]) + 1;
  }
  return start;
}

void stratus_density_sum_lines(const stratus_brick* bricks, const uint32_t* which, int64_t count, double bandwidth, int exact,
  const int32_t peak[3], const int32_t lo[3], const int32_t hi[3], stratus_density_line* lines)
{
  memset(lines, 0, sizeof *lines * stratus_density_line_start(lo, hi, 3));
  for (int a = 0; a < 3; ++a) {
    const line line = { .axis = a,
      .reach = 4.0 * bandwidth * bandwidth,
      .peak = { peak[0], peak[1], peak[2] },
      .lo = lo[a],
      .hi = hi[a],
      .planes = lines + stratus_density_line_start(lo, hi, a) };
    add_bricks(&line, bricks, which, count, stratus_density_takes_whole_bricks(bandwidth, exact));
  }
}

void stratus_density_scan_lines(stratus_density_line* lines, int64_t voxels, double bandwidth, const int32_t peak[3], const int32_t lo[3],
  const int32_t hi[3], stratus_density_borders* borders)
{
  const double h2 = bandwidth * bandwidth, unit = DENSITY_CONSTANT / ((double)(voxels ? voxels : 1) * h2 * bandwidth);
  for (int a = 0; a < 3; ++a) {
    const line line = { .axis = a,
      .reach = 4.0 * h2,
      .peak = { peak[0], peak[1], peak[2] },
      .lo = lo[a],
      .hi = hi[a],
      .planes = lines + stratus_density_line_start(lo, hi, a) };
    for (int side = 0; side < 2; ++side) {
      double fall;
      scan_side(&line, side, &borders->position[a][side], &fall);
      /* 4 c / (n h^5) |sum of (D / 2) (1 - (D^2 + 4 q) / (4 h^2))| */
      borders->fall[a][side] = fall * 4.0 * unit / h2 / (2.0 * line.reach);
    }
  }
}
