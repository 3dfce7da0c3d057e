/* SPDX-License-Identifier: BSD-3-Clause
 * The exact Euclidean distance transform. The field holds a squared distance for each voxel: positive outside effective voxels; inside
 * them negative where the field is signed, else 0. Along y an item walks a column of bits up and down; along x and z each voxel searches
 * outward, no farther than the best distance found so far. All numbers are integers, so that the results are the host's. */
#ifndef WIDE
#define WIDE 0
#endif
#if WIDE
typedef long value;
#define FAR_LINE 1073741824L
#else
typedef int value;
#define FAR_LINE 46339
#endif
#define FAR (FAR_LINE * FAR_LINE)

/* Distance along y to the last voxel of the opposite kind, with the sign of this one. before: that of the voxel before. */
static value step_on(value before, int inside, int is_signed)
{
  const value same = inside ? -before : before;
  if (!is_signed) {
    return inside ? 0 : min(before + 1, (value)FAR_LINE);
  }
  const value now = min(max(same, (value)0) + 1, (value)FAR_LINE);
  return inside ? -now : now;
}

__kernel void columns(__global const ulong* bits, long nx, long ny, long nz, long words, int is_signed, __global value* field)
{
  const long x = (long)get_global_id(0), z = (long)get_global_id(1);
  if (x >= nx || z >= nz) {
    return;
  }
  __global const ulong* column = bits + z * ny * words + x / 64;
  __global value* to = field + z * ny * nx + x;
  const value none = FAR_LINE;
  value d = none;
  for (long y = 0; y < ny; ++y) {
    const int inside = (int)(column[y * words] >> (x & 63) & 1);
    d = y > 0 ? step_on(d, inside, is_signed) : inside ? (is_signed ? -none : 0) : none;
    to[y * nx] = d;
  }
  for (long y = ny - 1; y >= 0; --y) {
    const int inside = (int)(column[y * words] >> (x & 63) & 1);
    d = y < ny - 1 ? step_on(d, inside, is_signed) : inside ? (is_signed ? -none : 0) : none;
    const value up = to[y * nx], least = min(up < 0 ? -up : up, d < 0 ? -d : d);
    to[y * nx] = inside ? -least * least : least * least;
  }
}

/* Takes the least over voxels along axis 0 or 2, of distances that hold for the axes done before. */
__kernel void search(__global const value* from, long nx, long ny, long nz, int axis, __global value* to)
{
  const long at[3] = { (long)get_global_id(0), (long)get_global_id(1), (long)get_global_id(2) };
  if (at[0] >= nx || at[1] >= ny || at[2] >= nz) {
    return;
  }
  const long here = (at[2] * ny + at[1]) * nx + at[0], step = axis == 0 ? 1 : nx * ny, last = (axis == 0 ? nx : nz) - 1;
  const int inside = from[here] < 0;
  value best = inside ? -from[here] : from[here];
  /* Voxels of the opposite sign are the targets. Their own distance is 0, so negate and clamp. */
  for (long n = 1; n * n < (long)best && (n <= at[axis] || n <= last - at[axis]); ++n) {
    value nearest = FAR;
    if (n <= at[axis]) {
      const value other = from[here - n * step];
      nearest = max(inside ? -other : other, (value)0);
    }
    if (n <= last - at[axis]) {
      const value other = from[here + n * step];
      nearest = min(nearest, max(inside ? -other : other, (value)0));
    }
    const value square = (value)(n * n); /* added only once the sum is known to fit */
    best = nearest < best - square ? nearest + square : best;
  }
  to[here] = inside ? -best : best;
}
