/* SPDX-License-Identifier: BSD-3-Clause
 * Random sets of voxels, and densities by plain sums over all voxels in double precision, for the tests of density. */
#ifndef STRATUS_TESTING_DENSITY_PLAIN_H
#define STRATUS_TESTING_DENSITY_PLAIN_H

#include "voxel_sets.h"
#include "tree.h"

#define PI 3.14159265358979323846

static stratus_context* context;
static voxel_set set;
static int32_t at[VOXEL_SET_MAX][3];

/* Makes a random set in a random box: noise, sometimes with a solid part, so that bricks are full, sparse or absent. */
static inline stratus_voxels* random_set(uint32_t* random, int64_t longest, int64_t noise)
{
  set_begin(&set, 1 + random_below(random, longest), 1 + random_below(random, longest), 1 + random_below(random, longest));
  set_add_noise(&set, 1 + random_below(random, noise), random);
  if (random_below(random, 2)) {
    const int64_t* n = set.dimensions;
    set_add_box(&set, 0, n[0] < 6 ? n[0] : 6, 0, n[1] < 5 ? n[1] : 5, 0, n[2] < 7 ? n[2] : 7);
  }
  stratus_voxels* voxels = make_voxels(context, &set);
  list_voxels(voxels, at);
  return voxels;
}

static inline double random_bandwidth(uint32_t* random)
{
  static const double some[] = { 0.6, 1.0, 1.5, 2.0, 3.0, 4.2, 7.0, 11.0, 28.0, 33.0, 90.0 };
  return random_below(random, 3) ? some[random_below(random, 11)] : 0.5 + (double)random_below(random, 4000) / 300.0;
}

/* ---- plain sums */

typedef struct plain {
  double density, first[3], second[3];
} plain;

/* Sums eq. 5 and its derivatives term by term. A voxel whose distance equals the bandwidth up to rounding may count or not: its terms of
 * the density and the slope are 0, but its term of the second derivative jumps. *edge is 1 if there is such a voxel. */
static inline plain sum_plainly(const stratus_voxels* voxels, double h, const double p[3], int* edge)
{
  plain sum = { .density = 0.0 };
  const double n = (double)voxels->count, c = 105.0 / (32.0 * PI);
  *edge = 0;
  for (int64_t v = 0; v < voxels->count; ++v) {
    double d[3], squared = 0.0;
    for (int a = 0; a < 3; ++a) {
      d[a] = p[a] - at[v][a];
      squared += d[a] * d[a];
    }
    const double t = sqrt(squared) / h;
    *edge |= fabs(t - 1.0) < 1e-9;
    if (t < 1.0) {
      const double u = t * t;
      sum.density += c / (n * h * h * h) * (1.0 - u) * (1.0 - u);
      for (int a = 0; a < 3; ++a) {
        sum.first[a] += c / (n * h * h * h) * 2.0 * (1.0 - u) * (-2.0 * d[a] / (h * h));
        sum.second[a] += c / (n * h * h * h) * (8.0 * d[a] * d[a] / (h * h * h * h) - 4.0 * (1.0 - u) / (h * h));
      }
    }
  }
  return sum;
}

static inline void assert_near(double value, double expected, double tolerance)
{
  if (!(fabs(value - expected) <= tolerance)) {
    fail_msg("%.17g, not %.17g within %g", value, expected, tolerance);
  }
}

static inline int open_context(void** state)
{
  (void)state;
  context = make_context("host", 1);
  return 0;
}

static inline int close_context(void** state)
{
  (void)state;
  stratus_context_destroy(context);
  return 0;
}

#endif
