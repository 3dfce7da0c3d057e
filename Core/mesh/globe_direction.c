/* SPDX-License-Identifier: BSD-3-Clause
 * Directions of points on a sphere. */
#include "globe_direction.h"

#include <math.h>

#define DEGREE 0.017453292519943295

void stratus_globe_direction(const double degrees[2], double unit[3])
{
  const double across = cos(degrees[1] * DEGREE);
  unit[0] = across * cos(degrees[0] * DEGREE);
  unit[1] = across * sin(degrees[0] * DEGREE);
  unit[2] = sin(degrees[1] * DEGREE);
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

bool stratus_globe_pole(const double* one, const double* second, const double* third, double pole[3])
{
  double u[3], v[3];
  for (int a = 0; a < 3; ++a) {
    u[a] = second[a] - one[a];
    v[a] = third[a] - one[a];
  }
  pole[0] = u[1] * v[2] - u[2] * v[1];
  pole[1] = u[2] * v[0] - u[0] * v[2];
  pole[2] = u[0] * v[1] - u[1] * v[0];
  const double length = (dot(pole, one) < 0.0 ? -1.0 : 1.0) * sqrt(dot(pole, pole));
  for (int a = 0; a < 3; ++a) {
    pole[a] /= length;
  }
  return isfinite(dot(pole, pole));
}
