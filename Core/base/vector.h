/* SPDX-License-Identifier: BSD-3-Clause
 * Vectors of three doubles. */
#ifndef STRATUS_VECTOR_H
#define STRATUS_VECTOR_H

#include <math.h>
#include <stdbool.h>

static inline double stratus_vector_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void stratus_vector_cross(const double a[3], const double b[3], double result[3])
{
  result[0] = a[1] * b[2] - a[2] * b[1];
  result[1] = a[2] * b[0] - a[0] * b[2];
  result[2] = a[0] * b[1] - a[1] * b[0];
}

/* Scales v to length 1, and returns its former length. Returns 0, and writes nothing, for a zero or infinite vector. The components are
 * scaled first, so that no square over- or underflows. */
static inline double stratus_vector_normalize(double v[3])
{
  const double largest = fmax(fmax(fabs(v[0]), fabs(v[1])), fabs(v[2]));
  if (!(largest > 0.0) || !isfinite(largest)) {
    return 0.0;
  }
  for (int a = 0; a < 3; ++a) {
    v[a] /= largest;
  }
  const double length = sqrt(stratus_vector_dot(v, v));
  for (int a = 0; a < 3; ++a) {
    v[a] /= length;
  }
  return largest * length;
}

static inline bool stratus_vector_finite(const double v[3])
{
  return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

#endif
