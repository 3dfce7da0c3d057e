/* SPDX-License-Identifier: BSD-3-Clause
 * Value ranges of blocks, the same as value_range.c builds. The kernel `columns` reduces, for a row of blocks, each column of values (all
 * y and z of one x), so that neighbouring work items read neighbouring values. The kernel `blocks` then reduces the few columns of each
 * block.
 *
 * VALUE: the type of a value. WIDE 1: the value less the bias, computed in double, becomes the float. */
#ifndef VALUE
#define VALUE float
#endif
#ifndef WIDE
#define WIDE 0
#endif
#if WIDE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double bias_type;
#define FETCH(v) ((float)((double)(v)-bias))
#else
typedef float bias_type; /* 0 */
#define FETCH(v) ((float)(v))
#endif
#pragma OPENCL FP_CONTRACT OFF

/* The column of block row (j, k) at x: values (x, j size .. (j+1) size, k size .. (k+1) size), as far as the volume goes. Columns are
 * indexed as blocks are, x fastest. */
__kernel void columns(__global const VALUE* values, bias_type bias, long nx, long ny, long nz, long stride, long size, long blocks_y,
  long blocks_z, __global float* lo, __global float* hi, __global uchar* bad)
{
  const long x = (long)get_global_id(0), j = (long)get_global_id(1), k = (long)get_global_id(2);
  if (x >= nx || j >= blocks_y || k >= blocks_z) {
    return;
  }
  (void)bias; /* narrow types have no bias */
  float least = INFINITY, most = -INFINITY;
  uchar odd = 0;
  const long y1 = min((j + 1) * size, ny - 1), z1 = min((k + 1) * size, nz - 1);
  for (long z = k * size; z <= z1; ++z) {
    for (long y = j * size; y <= y1; ++y) {
      const float v = FETCH(values[((z * ny + y) * nx + x) * stride]);
      if (fabs(v) <= FLT_MAX) {
        least = v < least ? v : least;
        most = v > most ? v : most;
      } else {
        odd = 1;
      }
    }
  }
  const long column = (k * blocks_y + j) * nx + x;
  lo[column] = least;
  hi[column] = most;
  bad[column] = odd;
}

__kernel void blocks(__global const float* column_lo, __global const float* column_hi, __global const uchar* column_bad, long nx, long size,
  long blocks_x, long rows, __global float* lo, __global float* hi, __global uchar* gaps)
{
  const long i = (long)get_global_id(0), row = (long)get_global_id(1);
  if (i >= blocks_x || row >= rows) {
    return;
  }
  float least = INFINITY, most = -INFINITY;
  uchar odd = 0;
  const long x1 = min((i + 1) * size, nx - 1);
  for (long x = i * size; x <= x1; ++x) {
    const long column = row * nx + x;
    least = column_lo[column] < least ? column_lo[column] : least;
    most = column_hi[column] > most ? column_hi[column] : most;
    odd |= column_bad[column];
  }
  /* -0 becomes 0, so that the order of comparisons does not show in the bits. */
  lo[row * blocks_x + i] = least == 0.0f ? 0.0f : least;
  hi[row * blocks_x + i] = most == 0.0f ? 0.0f : most;
  gaps[row * blocks_x + i] = odd;
}
