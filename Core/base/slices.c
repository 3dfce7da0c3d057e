/* SPDX-License-Identifier: BSD-3-Clause
 * Slices: checks the surface, and takes it from the world to the coordinates of rays. */
#include "slices.h"

#include "matrix.h"

#include <math.h>

static double coefficient(const stratus_slice* slice, int i)
{
  return i < 6 ? slice->square[i] : i < 9 ? slice->linear[i - 6] : i < 10 ? slice->constant : slice->center[i - 10];
}

stratus_status stratus_slice_check(stratus_context* context, const stratus_slice* slice)
{
  bool any = false;
  for (int i = 0; i < 13; ++i) {
    const double number = coefficient(slice, i);
    any = any || (i < 9 && number != 0.0);
    if (!isfinite(number)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the slice's %s has %g, must be finite",
        i < 6      ? "square"
          : i < 9  ? "linear"
          : i < 10 ? "constant"
                   : "center",
        number);
    }
  }
  return any ? STRATUS_OK : stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the slice is no surface: all of its square and linear are 0");
}

/* Transforms the form d.Q d + b.d of world displacements M d to one of displacements d. */
static void transform(const stratus_slice* slice, const double m[16], double square[6], double linear[3])
{
  const double* s = slice->square;
  const double q[3][3] = { { s[0], 0.5 * s[3], 0.5 * s[5] }, { 0.5 * s[3], s[1], 0.5 * s[4] }, { 0.5 * s[5], 0.5 * s[4], s[2] } };
  double form[3][3];
  for (int i = 0; i < 3; ++i) {
    linear[i] = 0.0;
    for (int r = 0; r < 3; ++r) {
      linear[i] += slice->linear[r] * m[4 * r + i];
    }
    for (int j = 0; j < 3; ++j) {
      form[i][j] = 0.0;
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
          form[i][j] += m[4 * r + i] * q[r][c] * m[4 * c + j];
        }
      }
    }
  }
  for (int i = 0; i < 3; ++i) {
    square[i] = form[i][i];
    square[3 + i] = 2.0 * form[i][(i + 1) % 3];
  }
}

void stratus_slice_set(const stratus_slice* slice, const double to_world[16], stratus_slice_arguments* a)
{
  double from_world[16], center[3], square[6], linear[3], largest = 0.0;
  if (!stratus_matrix_invert_affine(to_world, from_world)) {
    return; /* the frame's set-up has refused it */
  }
  stratus_matrix_point(from_world, slice->center, center);
  transform(slice, to_world, square, linear);
  for (int i = 0; i < 6; ++i) {
    largest = fmax(largest, fmax(fabs(square[i]), fabs(linear[i % 3])));
  }
  /* Only the ratios count. Scaled, they stay within the range of floats. */
  const double scale = largest > 0.0 ? 1.0 / largest : 0.0;
  for (int i = 0; i < 6; ++i) {
    a->square[i] = stratus_pair_of(square[i] * scale);
  }
  for (int i = 0; i < 3; ++i) {
    a->center[i] = stratus_pair_of(center[i]);
    a->linear[i] = stratus_pair_of(linear[i] * scale);
  }
  a->level = stratus_pair_of(slice->constant * scale);
}
