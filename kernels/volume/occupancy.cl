/* SPDX-License-Identifier: BSD-3-Clause
 * Occupancy of blocks, one work item a block: what stratus_table_shows() in Core/volume/volume.h does on the host. 1e-6f is the
 * STRATUS_HULL_SLACK of the same header. */
#pragma OPENCL FP_CONTRACT OFF

static int table_entry(float value, int size, float scale, float offset)
{
  const float entry = fma(value, scale, offset), last = (float)(size - 1);
  return (int)(!(entry > 0.0f) ? 0.0f : entry > last ? last : entry);
}

__kernel void occupancy(__global const float* lo, __global const float* hi, __global const uchar* gaps, __global const int* next_shown,
  int size, float scale, float offset, int gaps_show, ulong count, __global uchar* occupied)
{
  const ulong b = get_global_id(0);
  if (b >= count) {
    return;
  }
  uchar shows = gaps_show && gaps[b] ? 1 : 0;
  const float from = lo[b], to = hi[b];
  if (from <= to) {
    const float slack = 1e-6f * fmax(fabs(from), fabs(to));
    shows |= next_shown[table_entry(from - slack, size, scale, offset)] <= table_entry(to + slack, size, scale, offset) ? 1 : 0;
  }
  occupied[b] = shows;
}
