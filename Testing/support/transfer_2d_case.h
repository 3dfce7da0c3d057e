/* SPDX-License-Identifier: BSD-3-Clause
 * Functions of two variables for picture cases, and a second component for their values. */
#ifndef STRATUS_TESTING_TRANSFER_2D_CASE_H
#define STRATUS_TESTING_TRANSFER_2D_CASE_H

#include "picture_case.h"

#define TRANSFER_2D_SIDE 64

typedef struct transfer_2d_case {
  stratus_transfer_2d of;
  float rgba[4 * TRANSFER_2D_SIDE * TRANSFER_2D_SIDE];
  void* pairs; /* values of two components; NULL: none */
} transfer_2d_case;

/* Gives a case a random function: hills of opacity over transparent ground. Of one component, the rows go to `steepest` of the values'
 * scale in a spacing. */
static inline void transfer_2d_case_set(picture_case* c, transfer_2d_case* f, uint32_t seed, double steepest)
{
  enum { HILLS = 3 };
  const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
  const bool two = c->volume.components > 1;
  double hill[HILLS][5];
  f->of = (stratus_transfer_2d){ .rgba = f->rgba,
    .columns = 2 + (int)(case_random(&seed) % (TRANSFER_2D_SIDE - 1)),
    .rows = 1 + (int)(case_random(&seed) % TRANSFER_2D_SIDE),
    .value_range = { base - scale, base + scale },
    .second_range = { two ? base - scale : 0.0, two ? base + scale : steepest * scale },
    .unit_distance = 1.0,
    .revision = f->of.revision + 1 };
  for (int h = 0; h < HILLS; ++h) {
    hill[h][0] = case_uniform(&seed, -0.3, 0.5);
    hill[h][1] = case_uniform(&seed, two ? -0.3 : -1.0, two ? 0.5 : 0.2);
    hill[h][2] = case_uniform(&seed, 0.1, 0.4);
    hill[h][3] = case_uniform(&seed, 0.4, 0.9);
    hill[h][4] = case_uniform(&seed, 0.1, 0.7);
  }
  for (int j = 0; j < f->of.rows; ++j) {
    for (int i = 0; i < f->of.columns; ++i) {
      const double x = 2.0 * (i + 0.5) / f->of.columns - 1.0, y = 2.0 * (j + 0.5) / f->of.rows - 1.0;
      float* entry = f->rgba + 4 * (j * f->of.columns + i);
      double opacity = 0.0;
      for (int h = 0; h < HILLS; ++h) {
        const double u = (x - hill[h][0]) / hill[h][2], v = (y - hill[h][1]) / hill[h][3], near = 1.0 - u * u - v * v;
        opacity = fmax(opacity, near > 0.0 ? near * hill[h][4] : 0.0);
      }
      entry[0] = (float)(0.5 + 0.5 * x);
      entry[1] = (float)(0.5 + 0.5 * y);
      entry[2] = (float)(0.5 - 0.25 * x * y);
      entry[3] = (float)opacity;
    }
  }
  c->options.optics.transfer_2d = &f->of;
}

/* Gives a case's values a second component, a field of other waves of the same type. */
static inline void transfer_2d_case_pair(picture_case* c, transfer_2d_case* f, uint32_t seed)
{
  const size_t count = (size_t)(c->volume.dimensions[0] * c->volume.dimensions[1] * c->volume.dimensions[2]);
  const size_t bytes = stratus_type_size(c->volume.type);
  char* pairs = malloc(2 * count * bytes);
  assert_non_null(pairs);
  for (int component = 0; component < 2; ++component) {
    for (size_t at = 0; at < count; ++at) {
      memcpy(pairs + (2 * at + (size_t)component) * bytes, (char*)c->values + at * bytes, bytes);
    }
    case_fill(c, seed); /* the second */
  }
  f->pairs = pairs;
  c->volume.values = pairs;
  c->volume.value_stride = c->volume.components = 2;
}

#endif
