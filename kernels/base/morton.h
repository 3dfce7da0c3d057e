/* SPDX-License-Identifier: BSD-3-Clause
 * Morton codes of boxes, and the hierarchy over sorted codes (Karras 2012). Host and device compile the same integer arithmetic, so they
 * build the same tree. A code interleaves 21 bits of each axis: of the box's lo + hi, which is twice its middle, less the least lo + hi of
 * all boxes, shifted right until 21 bits hold it. */
#ifndef STRATUS_MORTON_H
#define STRATUS_MORTON_H

#ifdef STRATUS_DEVICE
#define MORTON_GLOBAL __global
#define MORTON_ULONG ulong
#define MORTON_UINT uint
#define MORTON_LONG long
#define MORTON_ZEROS_64(x) ((int)clz(x))
#define MORTON_ZEROS_32(x) ((int)clz(x))
#define MORTON_INLINE static inline
#else
#include <stdint.h>
#define MORTON_GLOBAL
#define MORTON_ULONG uint64_t
#define MORTON_UINT uint32_t
#define MORTON_LONG int64_t
#define MORTON_ZEROS_64(x) __builtin_clzll(x)
#define MORTON_ZEROS_32(x) __builtin_clz(x)
#define MORTON_INLINE static inline
#endif

#define MORTON_LEAF 0x80000000u /* set in a child's number where the child is a box, clear where it is an inner node */

/* Puts two zero bits between neighbouring bits of x, which has 21. */
MORTON_INLINE MORTON_ULONG morton_spread(MORTON_ULONG x)
{
  x = (x | x << 32) & 0x001f00000000fffful;
  x = (x | x << 16) & 0x001f0000ff0000fful;
  x = (x | x << 8) & 0x100f00f00f00f00ful;
  x = (x | x << 4) & 0x10c30c30c30c30c3ul;
  x = (x | x << 2) & 0x1249249249249249ul;
  return x;
}

MORTON_INLINE MORTON_ULONG morton_code(MORTON_UINT x, MORTON_UINT y, MORTON_UINT z, int shift)
{
  return morton_spread(x >> shift) | morton_spread(y >> shift) << 1 | morton_spread(z >> shift) << 2;
}

/* How many leading bits codes i and j share, or -1 if j is beyond the array. Equal codes count on with the leading bits of their indices,
 * so that no two codes are the same. */
MORTON_INLINE int morton_shared(MORTON_GLOBAL const MORTON_ULONG* codes, MORTON_LONG count, MORTON_LONG i, MORTON_LONG j)
{
  if (j < 0 || j >= count) {
    return -1;
  }
  return codes[i] != codes[j] ? MORTON_ZEROS_64(codes[i] ^ codes[j]) : 64 + MORTON_ZEROS_32((MORTON_UINT)i ^ (MORTON_UINT)j);
}

/* The two children of inner node i, 0 <= i < count - 1. A node covers a run of sorted codes, and code i is one end of node i's run. Node 0
 * is the root. */
MORTON_INLINE void morton_children(
  MORTON_GLOBAL const MORTON_ULONG* codes, MORTON_LONG count, MORTON_LONG i, MORTON_UINT* left, MORTON_UINT* right)
{
  const MORTON_LONG d = morton_shared(codes, count, i, i + 1) > morton_shared(codes, count, i, i - 1) ? 1 : -1;
  const int least = morton_shared(codes, count, i, i - d);
  MORTON_LONG reach = 2, length = 0;
  while (morton_shared(codes, count, i, i + reach * d) > least) {
    reach *= 2;
  }
  for (MORTON_LONG step = reach / 2; step > 0; step /= 2) {
    length += morton_shared(codes, count, i, i + (length + step) * d) > least ? step : 0;
  }
  const MORTON_LONG j = i + length * d;
  const int shared = morton_shared(codes, count, i, j);
  MORTON_LONG split = 0, step = length;
  do {
    step = (step + 1) / 2;
    split += morton_shared(codes, count, i, i + (split + step) * d) > shared ? step : 0;
  } while (step > 1);
  const MORTON_LONG low = i < j ? i : j, high = i < j ? j : i;
  const MORTON_LONG at = d > 0 ? i + split : i - split - 1; /* the last code of the left child */
  *left = (MORTON_UINT)at | (at == low ? MORTON_LEAF : 0u);
  *right = (MORTON_UINT)(at + 1) | (at + 1 == high ? MORTON_LEAF : 0u);
}

#endif
