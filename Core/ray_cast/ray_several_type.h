/* SPDX-License-Identifier: BSD-3-Clause
 * The functions of one type of values that rays through several volumes call. The including file defines STRATUS_TYPE and RAY_NAME. */
#define STRATUS_RAY_MODE STRATUS_RAY_SHADING
#define STRATUS_PREINTEGRATED 0
#define RAY_WITH_FUNCTIONS_2D 1
#include "ray_cast.h"
#include "several_media.h"
#undef RAY_WITH_FUNCTIONS_2D
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

static void RAY_NAME(several_corners)(const stratus_ray_cast_arguments* a, value_source values, const vint at[3], vmask mask, vfloat v[8])
{
  RAY_NAME(fetch_cell)(a, values, at[0], at[1], at[2], mask, v);
}

static void RAY_NAME(several_nearest)(const stratus_ray_cast_arguments* a, value_source values, const vint at[3], vmask mask, vfloat* value)
{
  *value = RAY_NAME(fetch_nearest)(a, values, at[0], at[1], at[2], mask);
}

/* Of one type of values. */
static const several_reading RAY_NAME(several_reading) = { RAY_NAME(several_value), RAY_NAME(several_gradient), RAY_NAME(several_corners),
  RAY_NAME(several_nearest), RAY_NAME(several_media) };

#undef RAY_NAME
#undef STRATUS_TYPE
