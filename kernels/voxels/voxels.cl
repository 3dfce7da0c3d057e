/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels of a volume: a mask for each brick of 4^3 values, and the bricks that hold a voxel, what Core/voxels/voxels_scan.c and
 * voxels.c do on the host. Comparisons are exact, and false for NaN. */
#ifndef VALUE
#define VALUE float
#endif
#ifndef AS
#define AS float /* in which values are compared */
#endif

#define BRICK 4

typedef struct brick {
  ulong mask;
  ushort x, y, z, count;
} brick;

/* One item a brick (x, y, z) of some planes of values, of which `before` layers of bricks come before. ghosts: a byte of flags a value,
 * where any of `hidden` excludes it; hidden 0: there are none. intervals: lo and hi of each. */
__kernel void masks(__global const VALUE* values, long nx, long ny, long nz, long stride, __global const uchar* ghosts, uint hidden,
  __global const AS* intervals, int interval_count, long bx, long by, long before, __global ulong* masks)
{
  const long i = (long)get_global_id(0), j = (long)get_global_id(1), k = (long)get_global_id(2);
  if (i >= bx) {
    return;
  }
  ulong mask = 0;
  for (int z = 0; z < BRICK && BRICK * k + z < nz; ++z) {
    for (int y = 0; y < BRICK && BRICK * j + y < ny; ++y) {
      const long row = ((BRICK * k + z) * ny + BRICK * j + y) * nx;
      for (int x = 0; x < BRICK && BRICK * i + x < nx; ++x) {
        const long at = row + BRICK * i + x;
        const AS value = (AS)values[at * stride];
        int shown = 0;
        for (int n = 0; n < interval_count; ++n) {
          shown |= value >= intervals[2 * n] && value <= intervals[2 * n + 1];
        }
        if (hidden && (ghosts[at] & hidden)) {
          shown = 0;
        }
        mask |= (ulong)shown << ((z * BRICK + y) * BRICK + x);
      }
    }
  }
  masks[((before + k) * by + j) * bx + i] = mask;
}

/* Counts the bricks of a row that hold a voxel. One item a row of n masks. */
__kernel void count_rows(__global const ulong* masks, long n, ulong rows, __global uint* counts)
{
  const ulong row = get_global_id(0);
  if (row < rows) {
    uint count = 0;
    for (long i = 0; i < n; ++i) {
      count += masks[row * (ulong)n + (ulong)i] != 0;
    }
    counts[row] = count;
  }
}

/* Writes the bricks of a row that hold a voxel, from bricks[start[row]] on. ny: rows of a slice. */
__kernel void compact(__global const ulong* masks, long n, ulong rows, ulong ny, __global const ulong* start, __global brick* bricks)
{
  const ulong row = get_global_id(0);
  if (row < rows) {
    __global brick* to = bricks + start[row];
    for (long i = 0; i < n; ++i) {
      const ulong mask = masks[row * (ulong)n + (ulong)i];
      if (mask) {
        brick b;
        b.mask = mask;
        b.x = (ushort)i;
        b.y = (ushort)(row % ny);
        b.z = (ushort)(row / ny);
        b.count = (ushort)popcount(mask);
        *to++ = b;
      }
    }
  }
}
