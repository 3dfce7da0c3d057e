/* SPDX-License-Identifier: BSD-3-Clause
 * Affine matrices of 4x4 numbers, row-major. */
#include "matrix.h"

#include <math.h>
#include <string.h>

/* Determinant, after the columns are scaled to length about 1, below which the matrix is singular within the precision of doubles. */
#define SINGULAR_BELOW 1e-12

void stratus_matrix_vector(const double matrix[16], const double vector[3], double result[3])
{
  double turned[3];
  for (int r = 0; r < 3; ++r) {
    turned[r] = matrix[4 * r] * vector[0] + matrix[4 * r + 1] * vector[1] + matrix[4 * r + 2] * vector[2];
  }
  memcpy(result, turned, sizeof turned);
}

void stratus_matrix_point(const double matrix[16], const double point[3], double result[3])
{
  double moved[3];
  stratus_matrix_vector(matrix, point, moved);
  for (int r = 0; r < 3; ++r) {
    result[r] = moved[r] + matrix[4 * r + 3];
  }
}

bool stratus_matrix_invert_affine(const double matrix[16], double inverse[16])
{
  /* Powers of two scale the columns to length about 1 without rounding: a spacing of 1e-120 must not underflow the determinant. */
  double a[3][3];
  int exponent[3];
  for (int c = 0; c < 3; ++c) {
    const double longest = fmax(fmax(fabs(matrix[c]), fabs(matrix[4 + c])), fabs(matrix[8 + c]));
    if (!(longest > 0.0) || !isfinite(longest)) {
      return false;
    }
    (void)frexp(longest, &exponent[c]);
    for (int r = 0; r < 3; ++r) {
      a[r][c] = ldexp(matrix[4 * r + c], -exponent[c]);
    }
  }
  double cofactor[3][3];
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
      cofactor[r][c] = a[r1][c1] * a[r2][c2] - a[r1][c2] * a[r2][c1];
    }
  }
  const double determinant = a[0][0] * cofactor[0][0] + a[0][1] * cofactor[0][1] + a[0][2] * cofactor[0][2];
  if (!(fabs(determinant) > SINGULAR_BELOW)) {
    return false;
  }
  double result[16] = { [15] = 1.0 };
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      result[4 * r + c] = ldexp(cofactor[c][r] / determinant, -exponent[r]);
    }
  }
  const double translation[3] = { -matrix[3], -matrix[7], -matrix[11] };
  double back[3];
  stratus_matrix_vector(result, translation, back);
  for (int r = 0; r < 3; ++r) {
    result[4 * r + 3] = back[r];
  }
  for (int i = 0; i < 12; ++i) {
    if (!isfinite(result[i])) {
      return false;
    }
  }
  memcpy(inverse, result, sizeof result);
  return true;
}

void stratus_matrix_box(const double matrix[16], const double lo[3], const double hi[3], double bounds[6])
{
  for (int corner = 0; corner < 8; ++corner) {
    double local[3], point[3];
    for (int axis = 0; axis < 3; ++axis) {
      local[axis] = corner >> axis & 1 ? hi[axis] : lo[axis];
    }
    stratus_matrix_point(matrix, local, point);
    for (int axis = 0; axis < 3; ++axis) {
      bounds[2 * axis] = corner ? fmin(bounds[2 * axis], point[axis]) : point[axis];
      bounds[2 * axis + 1] = corner ? fmax(bounds[2 * axis + 1], point[axis]) : point[axis];
    }
  }
}
