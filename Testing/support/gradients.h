/* SPDX-License-Identifier: BSD-3-Clause
 * Gives volumes the gradients that the core takes itself, as gradients of their own: pictures must stay what they are. */
#ifndef STRATUS_TESTING_GRADIENTS_H
#define STRATUS_TESTING_GRADIENTS_H

#include "picture_case.h"

/* Component c of value v, a float or a byte. */
static inline double gradients_value(const stratus_volume* volume, int c, int64_t v)
{
  const int64_t at = v * volume->value_stride + c;
  return volume->type == STRATUS_UINT8 ? (double)((const uint8_t*)volume->values)[at]
    : volume->type == STRATUS_FLOAT64  ? ((const double*)volume->values)[at]
                                       : (double)((const float*)volume->values)[at];
}

/* Where value i is along an axis. */
static inline double gradients_place(const stratus_volume* volume, int axis, int64_t i)
{
  const double* x = volume->coordinates[axis];
  return !x ? volume->spacing[axis] * (double)i : volume->cell_centered ? 0.5 * (x[i] + x[i + 1]) : x[i];
}

/* The slope of the parabola through three values, or of the line through two at an end. */
static inline double gradients_slope(const stratus_volume* volume, int c, int64_t v, int axis, int64_t i, int64_t step)
{
  const double here = gradients_value(volume, c, v), x = gradients_place(volume, axis, i);
  double slope[2] = { 0, 0 }, length[2] = { 0, 0 };
  for (int side = 0; side < 2; ++side) {
    const int64_t to = i + (side ? 1 : -1);
    if (to >= 0 && to < volume->dimensions[axis]) {
      length[side] = fabs(gradients_place(volume, axis, to) - x);
      slope[side] = (gradients_value(volume, c, v + (to - i) * step) - here) / (gradients_place(volume, axis, to) - x);
    }
  }
  const double both = length[0] + length[1];
  return length[0] > 0 && length[1] > 0 ? (slope[0] * length[1] + slope[1] * length[0]) / both : slope[0] + slope[1];
}

/* Sets the gradients of a volume of floats, doubles or bytes without gaps. in_place: of one component of floats, which move in front of
 * their gradients. Returns the memory, which the caller frees. */
static inline float* gradients_set(stratus_volume* volume, bool in_place)
{
  const int64_t *n = volume->dimensions, count = n[0] * n[1] * n[2], steps[3] = { 1, n[0], n[0] * n[1] };
  const int components = volume->components > 1 ? volume->components : 1;
  float *memory = malloc((size_t)(count * (3 * components + 1)) * sizeof(float)), *to = memory + (in_place ? count : 0);
  assert_non_null(memory);
  for (int64_t v = 0; v < count; ++v) {
    const int64_t at[3] = { v % n[0], v / n[0] % n[1], v / (n[0] * n[1]) };
    for (int c = 0; c < components; ++c) {
      for (int axis = 0; axis < 3; ++axis) {
        to[(3 * c + axis) * count + v] = (float)gradients_slope(volume, c, v, axis, at[axis], steps[axis]);
      }
    }
    if (in_place) {
      memory[v] = (float)gradients_value(volume, 0, v);
    }
  }
  volume->values = in_place ? memory : volume->values;
  volume->gradients = to;
  return memory;
}

#endif
