/* SPDX-License-Identifier: BSD-3-Clause
 * First hits among voxels of any widths: each work item walks a ray. */
#ifndef STRATUS_DEVICE
#define STRATUS_DEVICE 1
#endif
#ifndef STRATUS_WIDTH
#define STRATUS_WIDTH 1
#endif
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#include "first_hit_stretched.h"

#ifdef STRATUS_ARGUMENTS_BYTES
/* An array of negative size, which does not compile, where the host lays the arguments out otherwise. */
typedef char stratus_arguments_agree[sizeof(stratus_stretched_arguments) == STRATUS_ARGUMENTS_BYTES ? 1 : -1];
#endif

/* rays: 8 doubles a ray, origin x y z, direction x y z, t_min, t_max. results: 4 ints a ray, voxel x y z (-1: none), steps. */
__kernel void first_hit_stretched(__constant stratus_stretched_arguments* a, __global const uchar* entries, __global const uint* rows,
  __global const ulong* masks, __global const double* borders, __global const double* rays, __global int* results)
{
  const int ray = (int)get_global_id(0);
  if (ray >= a->count) {
    return;
  }
  __global const double* from = rays + 8 * (size_t)ray;
  hit_stretched w = { a, entries, rows, masks, borders, { from[0], from[1], from[2] }, { from[3], from[4], from[5] }, from[6], from[7] };
  int voxel[3], visited;
  const bool hit = stretched_walk(&w, voxel, &visited);
  for (int axis = 0; axis < 3; ++axis) {
    results[4 * (size_t)ray + (size_t)axis] = hit ? voxel[axis] : -1;
  }
  results[4 * (size_t)ray + 3] = visited;
}
