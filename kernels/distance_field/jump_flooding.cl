/* SPDX-License-Identifier: BSD-3-Clause
 * A pass of jump flooding (Rong & Tan 2006). Each voxel looks at the nearest effective voxel that it knows, and at those known to 26
 * others `step` away, and keeps the nearest of all. Of equally near ones it keeps the one of the smallest index, so that the order of
 * looking does not matter and host and device agree to the bit. */
#include "jump_flooding.h"

#ifndef WIDE
#define WIDE 0
#endif
#if WIDE
typedef long squared_length;
typedef long16 squared_lengths;
#define TO_LENGTHS convert_long16
#define LENGTH_MAX LONG_MAX
#else
typedef int squared_length;
typedef int16 squared_lengths;
#define TO_LENGTHS
#define LENGTH_MAX INT_MAX
#endif
#ifndef GROUP
#define GROUP 64
#endif

static squared_length squared_distance(uint position, const int at[3], int shift_y, int shift_z)
{
  if (position == FLOOD_UNKNOWN) {
    return LENGTH_MAX;
  }
  const squared_length x = (int)(position & ((1u << shift_y) - 1)) - at[0];
  const squared_length y = (int)(position >> shift_y & ((1u << (shift_z - shift_y)) - 1)) - at[1];
  const squared_length z = (int)(position >> shift_z) - at[2];
  return x * x + y * y + z * z;
}

/* A group is GROUP items along x. Group g writes to sums[2 g] how many of its voxels came nearer, and to sums[2 g + 1] the sum of their
 * ratios. */
__kernel void flood(
  __global const uint* from, long nx, long ny, long nz, int step, int shift_y, int shift_z, __global uint* to, __global uint* sums)
{
  __local uint updated[GROUP], ratios[GROUP];
  const int item = (int)get_local_id(0);
  const int at[3] = { (int)get_global_id(0), (int)get_global_id(1), (int)get_global_id(2) };
  updated[item] = ratios[item] = 0;
  if (at[0] < nx) {
    const long here = ((long)at[2] * ny + at[1]) * nx + at[0];
    uint nearest = from[here];
    const squared_length before = squared_distance(nearest, at, shift_y, shift_z);
    squared_length now = before;
    for (int n = 0; n < 27; ++n) {
      const long x = at[0] + (long)step * (n % 3 - 1), y = at[1] + (long)step * (n / 3 % 3 - 1), z = at[2] + (long)step * (n / 9 - 1);
      if (x < 0 || x >= nx || y < 0 || y >= ny || z < 0 || z >= nz) {
        continue;
      }
      const uint position = from[(z * ny + y) * nx + x];
      const squared_length distance = squared_distance(position, at, shift_y, shift_z);
      if (distance < now || (distance == now && position < nearest)) {
        now = distance;
        nearest = position;
      }
    }
    to[here] = nearest;
    if (now < before) {
      updated[item] = 1;
      ratios[item] = before == LENGTH_MAX ? 0 : (uint)flood_ratio((float)now, (float)before);
    }
  }
  for (int other = GROUP / 2; other > 0; other /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < other) {
      updated[item] += updated[item + other];
      ratios[item] += ratios[item + other];
    }
  }
  if (item == 0) {
    const long group = ((long)get_group_id(2) * get_num_groups(1) + get_group_id(1)) * get_num_groups(0) + get_group_id(0);
    sums[2 * group] = updated[0];
    sums[2 * group + 1] = ratios[0];
  }
}

/* ---- for a processor: 16 voxels of a row at once */

static squared_lengths squared_distances(uint16 position, int16 x, int y, int z, int shift_y, int shift_z)
{
  const squared_lengths dx = TO_LENGTHS(convert_int16(position & (uint16)((1u << shift_y) - 1)) - x);
  const squared_lengths dy = TO_LENGTHS(convert_int16(position >> (uint16)(shift_y) & (uint16)((1u << (shift_z - shift_y)) - 1)) - y);
  const squared_lengths dz = TO_LENGTHS(convert_int16(position >> (uint16)(shift_z)) - z);
  return select(dx * dx + dy * dy + dz * dz, (squared_lengths)(LENGTH_MAX), TO_LENGTHS(position == (uint16)(FLOOD_UNKNOWN)));
}

/* The positions that voxels x .. x + 15 of a row know; nothing is known beyond its ends. */
static uint16 load_positions(__global const uint* row, long x, long nx)
{
  if (x >= 0 && x + 16 <= nx) {
    return vload16(0, row + x);
  }
  uint position[16];
  for (int lane = 0; lane < 16; ++lane) {
    position[lane] = x + lane >= 0 && x + lane < nx ? row[x + lane] : FLOOD_UNKNOWN;
  }
  return vload16(0, position);
}

static void store_positions(__global uint* row, long x, long nx, uint16 nearest)
{
  if (x + 16 <= nx) {
    vstore16(nearest, 0, row + x);
    return;
  }
  uint position[16];
  vstore16(nearest, 0, position);
  for (long lane = 0; x + lane < nx; ++lane) {
    row[x + lane] = position[lane];
  }
}

static uint sum_of_16(uint16 a)
{
  const uint8 b = a.lo + a.hi;
  const uint4 c = b.lo + b.hi;
  return c.x + c.y + c.z + c.w;
}

/* Does the same as the kernel `flood`. One item for each row of voxels; its sums replace the sums of as many groups as the row has
 * there. */
__kernel void flood_rows(
  __global const uint* from, long nx, long ny, long nz, int step, int shift_y, int shift_z, __global uint* to, __global uint* sums)
{
  const int y = (int)get_global_id(0), z = (int)get_global_id(1);
  if (y >= ny) {
    return;
  }
  const long row = ((long)z * ny + y) * nx, groups = (nx + GROUP - 1) / GROUP;
  const int16 lanes = (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  __global uint* sum = sums + 2 * groups * ((long)z * ny + y);
  for (long group = 0; group < groups; ++group) {
    uint16 updated = (uint16)(0), ratios = (uint16)(0);
    for (long x = group * GROUP; x < nx && x < (group + 1) * GROUP; x += 16) {
      const int16 at = lanes + (int16)((int)x);
      uint16 nearest = load_positions(from + row, x, nx);
      const squared_lengths before = squared_distances(nearest, at, y, z, shift_y, shift_z);
      squared_lengths now = before;
      for (int n = 0; n < 9; ++n) {
        const long j = y + (long)step * (n % 3 - 1), k = z + (long)step * (n / 3 - 1);
        if (j < 0 || j >= ny || k < 0 || k >= nz) {
          continue;
        }
        __global const uint* other = from + (k * ny + j) * nx;
        for (int side = -1; side <= 1; ++side) {
          const uint16 position = load_positions(other, x + (long)side * step, nx);
          const squared_lengths distance = squared_distances(position, at, y, z, shift_y, shift_z);
          const squared_lengths nearer = (distance < now) | ((distance == now) & TO_LENGTHS(position < nearest));
          now = select(now, distance, nearer);
          nearest = select(nearest, position, as_uint16(convert_int16(nearer)));
        }
      }
      store_positions(to + row, x, nx, nearest);
      const squared_lengths came = (now < before) & TO_LENGTHS(at < (int16)((int)nx));
      const squared_lengths counted = came & (before != (squared_lengths)(LENGTH_MAX)), one = (squared_lengths)(1);
      updated += convert_uint16(came & one);
      ratios += convert_uint16(counted & one) *
        convert_uint16(flood_ratios(convert_float16(select(one, now, counted)), convert_float16(select(one, before, counted))));
    }
    sum[2 * group] = sum_of_16(updated);
    sum[2 * group + 1] = sum_of_16(ratios);
  }
}
