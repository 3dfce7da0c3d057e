/* SPDX-License-Identifier: BSD-3-Clause
 * The functions that read a field of one type of values. The including file defines STRATUS_TYPE and RAY_NAME. */
#include "fetch.h"
#include "ray_value.h"
#include "gradient.h"

static vfloat RAY_NAME(reading_value)(
  const stratus_ray_cast_arguments* a, value_source values, const uchar* hidden, const int* grid, const vfloat x[3], vmask mask)
{
  return RAY_NAME(ray_value)(a, values, hidden, grid, x, mask);
}

static void RAY_NAME(reading_gradient)(
  const stratus_ray_cast_arguments* a, value_source values, const int* grid, const vfloat x[3], vmask mask, vfloat g[3])
{
  RAY_NAME(ray_gradient)(a, values, grid, x, mask, g);
}

static void RAY_NAME(reading_cell)(
  const stratus_ray_cast_arguments* a, value_source values, vint i, vint j, vint k, vmask mask, vfloat v[8])
{
  RAY_NAME(fetch_cell)(a, values, i, j, k, mask, v);
}

static vfloat RAY_NAME(reading_nearest)(const stratus_ray_cast_arguments* a, value_source values, vint i, vint j, vint k, vmask mask)
{
  return RAY_NAME(fetch_nearest)(a, values, i, j, k, mask);
}

#undef RAY_NAME
#undef STRATUS_TYPE
