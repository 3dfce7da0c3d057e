/* SPDX-License-Identifier: BSD-3-Clause
 * Occupancy of blocks, one work item a block: what stratus_occupancy_build() in Core/volume/occupancy.c does on the host. */
#pragma OPENCL FP_CONTRACT OFF

__kernel void occupancy(__global const float* lo, __global const float* hi, __global const uchar* gaps, __global const float* intervals,
  int interval_count, int gaps_show, ulong count, __global uchar* occupied)
{
  const ulong b = get_global_id(0);
  if (b >= count) {
    return;
  }
  const float from = lo[b], to = hi[b];
  int first = 0, beyond = interval_count; /* the first interval that does not end below the block's range */
  while (first < beyond) {
    const int middle = (first + beyond) / 2;
    if (intervals[2 * middle + 1] < from) {
      first = middle + 1;
    } else {
      beyond = middle;
    }
  }
  const int meets = from <= to && first < interval_count && intervals[2 * first] <= to;
  occupied[b] = (gaps_show && gaps[b]) || meets ? 1 : 0;
}
