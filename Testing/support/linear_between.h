/* SPDX-License-Identifier: BSD-3-Clause
 * A function that is linear between its points, as the references of tests read a transfer function. */
#ifndef STRATUS_TESTING_LINEAR_BETWEEN_H
#define STRATUS_TESTING_LINEAR_BETWEEN_H

#include <stddef.h>

/* Returns component `component` (from 1 on) at x. points: `width` numbers each, of which the first is the place; before the first point and
 * behind the last the function is constant, and of two points at one place the second counts. */
static inline double linear_between(const double* points, size_t count, size_t width, size_t component, double x)
{
  size_t i = 0;
  while (i + 1 < count && points[(i + 1) * width] <= x) {
    ++i;
  }
  const double* p = points + i * width;
  if (i + 1 == count || x <= p[0]) {
    return p[component];
  }
  return p[component] + (x - p[0]) / (p[width] - p[0]) * (p[width + component] - p[component]);
}

#endif
