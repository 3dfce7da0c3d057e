/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels of a volume: a mask for each brick of 4^3 values, and the bricks that hold a voxel, what Core/voxels/voxels_scan.c and
 * voxels.c do on the host. Comparisons are exact, and false for NaN. */
#ifndef VALUE
#define VALUE float
#endif
#ifndef AS
#define AS float /* in which values are compared */
#endif
#ifndef END
#define END float /* of intervals, as the host gives them */
#endif

#define JOIN_2(a, b) a##b
#define JOIN(a, b) JOIN_2(a, b)

#define BRICK 4

typedef struct brick {
  ulong mask;
  ushort x, y, z, count;
} brick;

/* Return 1 if the value is in an interval and no flag hides it. */
static int shows(
  __global const VALUE* values, long at, long stride, __global const uchar* ghosts, uint hidden, __global const END* intervals, int count)
{
  const AS value = (AS)values[at * stride];
  int shown = 0;
  for (int n = 0; n < count; ++n) {
    shown |= value >= (AS)intervals[2 * n] && value <= (AS)intervals[2 * n + 1];
  }
  return shown && !(hidden && (ghosts[at] & hidden));
}

static ulong brick_mask(__global const VALUE* values, long nx, long ny, long nz, long stride, __global const uchar* ghosts, uint hidden,
  __global const END* intervals, int interval_count, long i, long j, long k)
{
  ulong mask = 0;
  for (int z = 0; z < BRICK && BRICK * k + z < nz; ++z) {
    for (int y = 0; y < BRICK && BRICK * j + y < ny; ++y) {
      const long row = ((BRICK * k + z) * ny + BRICK * j + y) * nx;
      for (int x = 0; x < BRICK && BRICK * i + x < nx; ++x) {
        const int shown = shows(values, row + BRICK * i + x, stride, ghosts, hidden, intervals, interval_count);
        mask |= (ulong)shown << ((z * BRICK + y) * BRICK + x);
      }
    }
  }
  return mask;
}

/* One item a brick (x, y, z) of some planes of values, of which `before` layers of bricks come before. ghosts: a byte of flags a value,
 * where any of `hidden` excludes it; hidden 0: there are none. intervals: lo and hi of each. */
__kernel void masks(__global const VALUE* values, long nx, long ny, long nz, long stride, __global const uchar* ghosts, uint hidden,
  __global const END* intervals, int interval_count, long bx, long by, long before, __global ulong* masks)
{
  const long i = (long)get_global_id(0), j = (long)get_global_id(1), k = (long)get_global_id(2);
  if (i < bx) {
    masks[((before + k) * by + j) * bx + i] = brick_mask(values, nx, ny, nz, stride, ghosts, hidden, intervals, interval_count, i, j, k);
  }
}

/* Returns which of 16 values show, as bits. Of each eight flags of 0 or 1 the multiplication gathers the bits in the highest byte. */
static ulong shown_of_16(
  __global const VALUE* values, __global const uchar* ghosts, uint hidden, __global const END* intervals, int interval_count)
{
  const JOIN(AS, 16) value = JOIN(convert_, JOIN(AS, 16))(vload16(0, values));
  uchar16 flags = (uchar16)(0);
  for (int n = 0; n < interval_count; ++n) {
    flags |= as_uchar16(convert_char16((value >= (AS)intervals[2 * n]) & (value <= (AS)intervals[2 * n + 1])));
  }
  if (hidden) {
    flags &= as_uchar16((vload16(0, ghosts) & (uchar16)((uchar)hidden)) == (uchar16)(0));
  }
  const ulong2 words = as_ulong2(flags & (uchar16)(1)) * (ulong2)(0x0102040810204080UL) >> (ulong2)(56);
  return words.x | words.y << 8;
}

/* The same for a processor: one item a row of bricks, four bricks at once where the row has them and values lie together. */
__kernel void mask_rows(__global const VALUE* values, long nx, long ny, long nz, long stride, __global const uchar* ghosts, uint hidden,
  __global const END* intervals, int interval_count, long bx, long by, long before, __global ulong* masks)
{
  const long j = (long)get_global_id(0), k = (long)get_global_id(1);
  if (j >= by) {
    return;
  }
  __global ulong* const row = masks + ((before + k) * by + j) * bx;
  long i = 0;
#ifdef __ENDIAN_LITTLE__
  for (; stride == 1 && BRICK * (i + 4) <= nx; i += 4) {
    ulong four[4] = { 0, 0, 0, 0 };
    for (int z = 0; z < BRICK && BRICK * k + z < nz; ++z) {
      for (int y = 0; y < BRICK && BRICK * j + y < ny; ++y) {
        const long at = ((BRICK * k + z) * ny + BRICK * j + y) * nx + BRICK * i;
        const ulong shown = shown_of_16(values + at, hidden ? ghosts + at : ghosts, hidden, intervals, interval_count);
        for (int b = 0; b < 4; ++b) {
          four[b] |= (shown >> (BRICK * b) & 15) << ((z * BRICK + y) * BRICK);
        }
      }
    }
    for (int b = 0; b < 4; ++b) {
      row[i + b] = four[b];
    }
  }
#endif
  for (; i < bx; ++i) {
    row[i] = brick_mask(values, nx, ny, nz, stride, ghosts, hidden, intervals, interval_count, i, j, k);
  }
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
