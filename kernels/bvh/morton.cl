/* SPDX-License-Identifier: BSD-3-Clause
 * Morton codes of boxes, and the hierarchy over sorted ones: see morton.h. */
#ifndef STRATUS_DEVICE
#define STRATUS_DEVICE 1
#endif
#include "morton.h"

/* boxes: lo, then hi, of each. least_x, least_y, least_z: the least lo + hi of all boxes. */
__kernel void codes(__global const int* boxes, uint count, int least_x, int least_y, int least_z, int shift, __global ulong* result)
{
  const size_t b = get_global_id(0);
  if (b < count) {
    __global const int* box = boxes + 6 * b;
    result[b] = morton_code((uint)(box[0] + box[3] - least_x), (uint)(box[1] + box[4] - least_y), (uint)(box[2] + box[5] - least_z), shift);
  }
}

__kernel void hierarchy(__global const ulong* sorted, uint count, __global uint* pairs)
{
  const size_t i = get_global_id(0);
  if (i + 1 < count) {
    uint left, right;
    morton_children(sorted, (long)count, (long)i, &left, &right);
    pairs[2 * i] = left;
    pairs[2 * i + 1] = right;
  }
}
