/* SPDX-License-Identifier: BSD-3-Clause
 * Density of bricks of voxels: the sums of density_rows.c. They are sums of whole numbers, so that their order does not matter and the
 * results are the host's to the bit. Bricks are sorted by (z, y, x), and a binary search finds the first brick of a row. */
#ifndef GROUP
#define GROUP 64 /* work items of a group, which has one brick: an item for each of its voxels */
#endif
#ifndef RUN
#define RUN 1 /* bricks of an item, where a brick has one sum */
#endif

typedef struct brick {
  ulong mask;
  ushort x, y, z, count;
} brick;

typedef struct row {
  int offset, table;
} row;

static ulong place(long x, long y, long z) { return (ulong)(z + 8) << 40 | (ulong)(y + 8) << 20 | (ulong)(x + 8); }

static ulong place_of(__global const brick* bricks, ulong b) { return place(bricks[b].x, bricks[b].y, bricks[b].z); }

static ulong first_brick(__global const brick* bricks, ulong count, ulong key)
{
  ulong low = 0;
  while (low < count) {
    const ulong middle = low + (count - low) / 2;
    if (place_of(bricks, middle) < key) {
      low = middle + 1;
    } else {
      count = middle;
    }
  }
  return low;
}

/* Gathers the voxels within reach of brick b as bits: bit x of rows[z*side + y]. Each item of the group takes rows of bricks in turn; a
 * row of bricks is sixteen rows of voxels. */
static void gather(__global const brick* bricks, ulong count, ulong b, int reach, __local ulong* rows)
{
  const int n = 2 * reach + 1, side = 4 * n;
  for (int i = (int)get_local_id(0); i < n * n; i += GROUP) {
    const int dy = i % n, dz = i / n;
    __local ulong* own = rows + dz * 4 * side + dy * 4;
    for (int r = 0; r < 16; ++r) {
      own[(r >> 2) * side + (r & 3)] = 0;
    }
    const ulong first = place((long)bricks[b].x - reach, (long)bricks[b].y + dy - reach, (long)bricks[b].z + dz - reach);
    for (ulong j = first_brick(bricks, count, first); j < count && place_of(bricks, j) <= first + 2 * (ulong)reach; ++j) {
      const int shift = 4 * ((int)bricks[j].x - (int)bricks[b].x + reach);
      for (int r = 0; r < 16; ++r) {
        own[(r >> 2) * side + (r & 3)] |= (bricks[j].mask >> (4 * r) & 15) << shift;
      }
    }
  }
}

/* One group does one brick and writes its voxels' sums from sums[start[b]] on. rows: memory of the group, 16 (2 reach + 1)^2 words. */
__kernel void exact(__global const brick* bricks, ulong count, __global const ulong* start, int reach, int radius, int width, int row_count,
  __global const row* offsets, __global const uint* table, __global ulong* sums, __local ulong* rows)
{
  const ulong b = get_group_id(0);
  const int bit = (int)get_local_id(0), side = 4 * (2 * reach + 1);
  if (b < count) {
    gather(bricks, count, b, reach, rows);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (b >= count || !(bricks[b].mask >> bit & 1)) {
    return;
  }
  __local const ulong* own = rows + (4 * reach + (bit >> 4)) * side + 4 * reach + (bit >> 2 & 3);
  const int shift = 4 * reach + (bit & 3) - radius;
  const ulong window = (1UL << (2 * radius + 1)) - 1, piece = (1UL << width) - 1;
  ulong sum = 0;
  for (int r = 0; r < row_count; ++r) {
    int at = offsets[r].table;
    for (ulong bits = own[offsets[r].offset] >> shift & window; bits; bits >>= width) {
      sum += table[at + (int)(bits & piece)];
      at += 1 << width;
    }
  }
  sums[start[b] + popcount(bricks[b].mask & ((1UL << bit) - 1))] = sum;
}

/* Gathers the rows of bits in reach of brick b as gather() does. Bricks come in ascending order, and so do the first bricks in reach of
 * them in a row at a fixed offset: each row has a cursor that only moves forward. It is `count` + 1 before the first brick. */
static void gather_next(__global const brick* bricks, ulong count, ulong b, int reach, __global ulong* cursors, __global ulong* rows)
{
  const int n = 2 * reach + 1, side = 4 * n;
  for (int i = 0; i < side * side; ++i) {
    rows[i] = 0;
  }
  for (int i = 0; i < n * n; ++i) {
    const int dy = i % n, dz = i / n;
    __global ulong* own = rows + dz * 4 * side + dy * 4;
    const ulong first = place((long)bricks[b].x - reach, (long)bricks[b].y + dy - reach, (long)bricks[b].z + dz - reach);
    ulong j = cursors[i] > count ? first_brick(bricks, count, first) : cursors[i];
    while (j < count && place_of(bricks, j) < first) {
      ++j;
    }
    cursors[i] = j;
    for (; j < count && place_of(bricks, j) <= first + 2 * (ulong)reach; ++j) {
      const ulong mask = bricks[j].mask;
      const int shift = 4 * ((int)bricks[j].x - (int)bricks[b].x + reach);
      for (int r = 0; r < 16; ++r) {
        own[(r >> 2) * side + (r & 3)] |= (mask >> (4 * r) & 15) << shift;
      }
    }
  }
}

/* The same as exact(), for a processor: a group of one item takes a run of bricks. rooms: for each group 17 (2 reach + 1)^2 words. */
__kernel void exact_run(__global const brick* bricks, ulong count, __global const ulong* start, int reach, int radius, int width,
  int row_count, __global const row* offsets, __global const uint* table, __global ulong* sums, __global ulong* rooms)
{
  const ulong group = get_group_id(0), groups = get_num_groups(0);
  const int n = 2 * reach + 1, side = 4 * n;
  const ulong window = (1UL << (2 * radius + 1)) - 1, piece = (1UL << width) - 1;
  __global ulong *cursors = rooms + group * 17 * n * n, *rows = cursors + n * n;
  for (int i = 0; i < n * n; ++i) {
    cursors[i] = count + 1;
  }
  for (ulong b = count * group / groups; b < count * (group + 1) / groups; ++b) {
    __global ulong* to = sums + start[b];
    gather_next(bricks, count, b, reach, cursors, rows);
    for (ulong mask = bricks[b].mask; mask; mask &= mask - 1) {
      const int bit = 63 - (int)clz(mask & -mask), shift = 4 * reach + (bit & 3) - radius;
      __global const ulong* own = rows + (4 * reach + (bit >> 4)) * side + 4 * reach + (bit >> 2 & 3);
      ulong sum = 0;
      for (int r = 0; r < row_count; ++r) {
        int at = offsets[r].table;
        ulong bits = own[offsets[r].offset] >> shift & window;
        sum += table[at + (int)(bits & piece)];
        for (bits >>= width; bits; bits >>= width) {
          at += 1 << width;
          sum += table[at + (int)(bits & piece)];
        }
      }
      *to++ = sum;
    }
  }
}

/* One item does RUN bricks, as if all voxels of a brick lay in one place: neighbours weigh by their distance in bricks. Its bricks are in
 * ascending order, and so are the first bricks in reach of them in a row at a fixed offset: one search finds the row for all of them. */
__kernel void binned(__global const brick* bricks, ulong count, int reach, __global const uint* table, __global ulong* sums)
{
  const ulong first = get_global_id(0) * RUN;
  if (first >= count) {
    return;
  }
  const int n = reach + 1, run = (int)min((ulong)RUN, count - first);
  ulong own[RUN];
  for (int r = 0; r < RUN; ++r) {
    own[r] = 0;
  }
  for (int dz = -reach; dz <= reach; ++dz) {
    for (int dy = -reach; dy <= reach; ++dy) {
      __global const uint* weights = table + ((int)abs(dz) * n + (int)abs(dy)) * n;
      ulong j = first_brick(bricks, count, place((long)bricks[first].x - reach, (long)bricks[first].y + dy, (long)bricks[first].z + dz));
      for (int r = 0; r < run; ++r) {
        const brick b = bricks[first + r];
        const ulong from = place((long)b.x - reach, (long)b.y + dy, (long)b.z + dz);
        while (j < count && place_of(bricks, j) < from) {
          ++j;
        }
        for (ulong i = j; i < count && place_of(bricks, i) <= from + 2 * (ulong)reach; ++i) {
          own[r] += (ulong)bricks[i].count * weights[abs((int)bricks[i].x - (int)b.x)];
        }
      }
    }
  }
  for (int r = 0; r < run; ++r) {
    sums[first + r] = own[r];
  }
}
