/* SPDX-License-Identifier: BSD-3-Clause
 * What rays through several volumes ask of one type of values. The including file defines STRATUS_TYPE and RAY_NAME. */
#define STRATUS_RAY_MODE STRATUS_RAY_SHADING
#define STRATUS_PREINTEGRATED 0
#include "ray_cast.h"
#undef STRATUS_PREINTEGRATED
#undef STRATUS_RAY_MODE

static void RAY_NAME(several_value)(const stratus_ray_cast_arguments* a, value_source values, const uchar* hidden, const int* grid,
  const vfloat x[3], vmask mask, vfloat* value)
{
  *value = RAY_NAME(ray_value)(a, values, hidden, grid, x, mask);
}

static void RAY_NAME(several_gradient)(
  const stratus_ray_cast_arguments* a, value_source values, const int* grid, const vfloat x[3], vmask mask, vfloat g[3])
{
  RAY_NAME(ray_gradient)(a, values, grid, x, mask, g);
}

#undef RAY_NAME
#undef STRATUS_TYPE
