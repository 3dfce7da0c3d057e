/* SPDX-License-Identifier: BSD-3-Clause
 * Coordinates for the picture cases: grids of equal, stretched and random spacing. */
#ifndef STRATUS_TESTING_GRID_CASE_H
#define STRATUS_TESTING_GRID_CASE_H

#include "picture_case.h"

#define GRID_CASE_MOST 80

typedef enum grid_kind { GRID_EQUAL, GRID_GEOMETRIC, GRID_RANDOM } grid_kind;

typedef struct grid_case {
  double of[3][GRID_CASE_MOST];
} grid_case;

/* Gives the axes of `axes` (bits 1, 2, 4) coordinates from `begin` on that are `spacing` apart in the mean. stretch: of GEOMETRIC, the last
 * spacing over the first; of RANDOM, the greatest over the least at most. */
static inline void grid_case_set(
  picture_case* c, grid_case* grid, grid_kind kind, int axes, double begin, double spacing, double stretch, uint32_t* random)
{
  for (int a = 0; a < 3; ++a) {
    const int64_t last = c->volume.dimensions[a] - (c->volume.cell_centered ? 0 : 1);
    double* x = grid->of[a];
    c->volume.coordinates[a] = axes >> a & 1 ? x : NULL;
    assert_in_range(last, axes >> a & 1 ? 1 : 0, GRID_CASE_MOST - 1);
    x[0] = 0.0;
    for (int64_t i = 0; i < last; ++i) {
      const double part = last > 1 ? (double)i / (double)(last - 1) : 0.0;
      x[i + 1] = x[i] + (kind == GRID_EQUAL ? 1.0 : pow(stretch, kind == GRID_GEOMETRIC ? part : case_uniform(random, 0.0, 1.0)));
    }
    const double scale = (double)last * spacing / x[last];
    for (int64_t i = 0; i <= last; ++i) {
      x[i] = begin + scale * x[i];
    }
  }
}

/* Makes a random case one of a grid whose spacing changes along at least one axis. */
static inline void grid_case_set_random(stratus_context* context, uint32_t seed, picture_case* c, grid_case* grid)
{
  uint32_t s = seed * 40503u + 7u;
  int axes = 1 + (int)(case_random(&s) % 7);
  for (int a = 0; a < 3 && !c->volume.cell_centered; ++a) {
    axes &= c->volume.dimensions[a] > 1 ? 7 : ~(1 << a);
  }
  axes = axes ? axes : 4; /* there are two layers at least */
  grid_case_set(c, grid, case_random(&s) % 2 ? GRID_GEOMETRIC : GRID_RANDOM, axes, 0.0, 1.0, case_random(&s) % 3 ? 20.0 : 200.0, &s);
  for (int a = 0; a < 3 && case_random(&s) % 3 == 0; ++a) { /* falling */
    const int64_t last = c->volume.dimensions[a] - (c->volume.cell_centered ? 0 : 1);
    for (int64_t i = 0; i < (last + 1) / 2; ++i) {
      const double swap = grid->of[a][i];
      grid->of[a][i] = grid->of[a][last - i];
      grid->of[a][last - i] = swap;
    }
  }
  case_camera(context, c, (int)(case_random(&s) % 8), (int)(case_random(&s) % 2));
}

#endif
