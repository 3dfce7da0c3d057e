/* SPDX-License-Identifier: BSD-3-Clause
 * The exact Euclidean distance transform. The field holds a squared distance for each voxel: positive outside effective voxels; inside
 * them negative where the field is signed, else 0. Along y an item walks a column of bits up and down; along x and z each voxel searches
 * outward, no farther than the best distance found so far. All numbers are integers, so that the results are the host's. Kernels for a
 * processor are below. */
#ifndef STRATUS_DEVICE
#define STRATUS_DEVICE 1
#endif
#undef STRATUS_WIDTH
#define STRATUS_WIDTH 16 /* of the kernels for a processor */
#include "packet.h"

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

/* Distance along y to the last voxel of the opposite kind, with the sign of this one. before: the distance of the voxel before. */
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

/* ---- for a processor
 * The host's passes (Core/distance_field/distance_field_body.h), 16 voxels at once, in place: planes, in which distances along y are
 * counted and rows searched along x; then tiles of 16 columns along z. One array holds both halves of a signed field, for one is 0 wherever
 * the other is not. Searches read them apart, voxels outside `plus` and voxels inside `minus`, and keep best - n^2, which no step lets
 * overflow. */
#if !WIDE
/* First and last place along a line that holds a target, effective (0) and other (1). */
typedef struct ranges {
  long first[2], last[2];
} ranges;

static int some_above(vint a) { return m_any(vi_lt(vi_set(0), a)); }

static vint load_part(__global const int* from, long lanes)
{
  int part[16] = { 0 };
  if (lanes >= 16) {
    return vload16(0, from);
  }
  for (long i = 0; i < lanes; ++i) {
    part[i] = from[i];
  }
  return vload16(0, part);
}

static void store_part(vint a, long lanes, __global int* to)
{
  int part[16];
  if (lanes >= 16) {
    vstore16(a, 0, to);
    return;
  }
  vstore16(a, 0, part);
  for (long i = 0; i < lanes; ++i) {
    to[i] = part[i];
  }
}

/* Searches for 16 targets of the halves at plus and minus, at n*one and n*other from their own places. c: best - n^2. */
static vint look(
  vint c, vmask inside, int kinds, __global const int* plus, __global const int* minus, long one, long other, long last, long* step)
{
  __global const int* only = kinds == 1 ? plus : minus;
  long n = *step;
  if (kinds != 3) {
    for (; n <= last && some_above(c); ++n) {
      c = min(c, min(vload16(0, only + n * one), vload16(0, only + n * other))) - (int16)((int)(2 * n + 1));
    }
  } else {
    for (; n <= last && some_above(c); ++n) {
      const int16 out = min(vload16(0, plus + n * one), vload16(0, plus + n * other));
      const int16 in = min(vload16(0, minus + n * one), vload16(0, minus + n * other));
      c = min(c, vi_select(inside, in, out)) - (int16)((int)(2 * n + 1));
    }
  }
  *step = n;
  return c;
}

/* The places that hold targets of the kinds. */
static long first_of(const ranges* r, int kinds)
{
  return kinds == 1 ? r->first[0] : kinds == 2 ? r->first[1] : min(r->first[0], r->first[1]);
}
static long last_of(const ranges* r, int kinds) { return kinds == 1 ? r->last[0] : kinds == 2 ? r->last[1] : max(r->last[0], r->last[1]); }

/* Squared distances with their signs, of targets whose halves are plus and minus at their own places: in a row, of which all lanes see
 * places first .. last, or in a tile of columns (stride 16). */
static vint search_lanes(__global const int* plus, __global const int* minus, long lanes, const ranges* r, long at, long stride)
{
  const vmask valid = vi_lt(vi_lanes(), vi_set((int)min(lanes, 16L)));
  const vint above = vi_select(valid, vload16(0, plus), vi_set(0)), below = vi_select(valid, vload16(0, minus), vi_set(0));
  const vmask inside = vi_lt(vi_set(0), below);
  vint c = above + below; /* one of them is 0 */
  const int kinds = (some_above(above) ? 1 : 0) | (m_any(inside) ? 2 : 0);
  const long wide = stride == 1 ? 15 : 0; /* a row's lanes stand side by side */
  if (kinds == 0) {
    return c;
  }
  const long first = first_of(r, kinds), last = last_of(r, kinds);
  const long left = at + wide - first, right = last - at; /* the farthest places, negative: there are none */
  const long nearest = max(first - (at + wide), at - last);
  long n = min(max(nearest, 1L), (long)FAR_LINE);
  c -= (int16)((int)(n * n));
  if (stride == 1) {
    c = look(c, inside, kinds, plus, minus, -1, 1, max(left, right), &n);
  } else {
    c = look(c, inside, kinds, plus, minus, -stride, stride, min(left, right), &n);
    if (left > right) {
      c = look(c, inside, kinds, plus, minus, -stride, -stride, left, &n);
    } else {
      c = look(c, inside, kinds, plus, minus, stride, stride, right, &n);
    }
  }
  c += (int16)((int)(n * n));
  return vi_select(inside, -c, c);
}

/* Finds the columns of a plane that hold each kind. Returns bit 0: some voxel is effective, bit 1: some is not. */
static int survey(__global const ulong* bits, long nx, long ny, long words, ranges* r)
{
  int kinds = 0;
  for (long i = 0; i < words; ++i) {
    const ulong within = nx - 64 * i >= 64 ? ~0UL : (1UL << (nx - 64 * i)) - 1;
    ulong any = 0, all = ~0UL;
    for (long y = 0; y < ny; ++y) {
      any |= bits[y * words + i];
      all &= bits[y * words + i];
    }
    const ulong holds[2] = { any, ~all & within };
    for (int kind = 0; kind < 2; ++kind) {
      if (holds[kind]) {
        const long low = 64 * i + (long)popcount((holds[kind] & -holds[kind]) - 1);
        r->first[kind] = kinds >> kind & 1 ? r->first[kind] : low;
        r->last[kind] = 64 * i + 63 - (long)clz(holds[kind]);
        kinds |= 1 << kind;
      }
    }
  }
  return kinds;
}

/* step_on() for 16 voxels, and for the first row, which has none before it. */
static vint step_lanes(vint before, vmask inside, int is_signed, int is_first)
{
  vint now = vi_set(FAR_LINE);
  if (!is_first) {
    const vint same = is_signed ? vi_select(inside, -before, before) : before;
    now = vi_min(vi_max(same, vi_set(0)) + 1, now);
  }
  return vi_select(inside, is_signed ? -now : vi_set(0), now);
}

/* rooms: for each group a row of distances along y, and rows plus and minus with margins of `pad` values. kinds: of each plane. A group of
 * one item takes every so many planes. */
PACKET_KERNEL void planes(__global const ulong* bits, long nx, long ny, long nz, long words, int is_signed, long pad, __global int* rooms,
  __global uchar* kinds, __global int* field)
{
  const long row = (nx + 15) / 16 * 16, groups = (long)get_num_groups(0);
  __global int* line = rooms + (long)get_group_id(0) * (3 * row + 4 * pad);
  __global int *plus = line + row + pad, *minus = plus + row + 2 * pad;
  for (long x = -pad; x < row + pad; ++x) {
    plus[x] = minus[x] = FAR;
  }
  for (long k = (long)get_group_id(0); k < nz; k += groups) {
    __global const ulong* plane_bits = bits + k * ny * words;
    __global int* plane = field + k * nx * ny;
    ranges r = { { 0, 0 }, { 0, 0 } };
    const int some = survey(plane_bits, nx, ny, words, &r);
    kinds[k] = (uchar)some;
    if (some != 3) {
      const int fill = some == 2 ? FAR : is_signed ? -FAR : 0;
      for (long i = 0; i < nx * ny; ++i) {
        plane[i] = fill;
      }
      continue;
    }
    for (int back = 0; back < 2; ++back) {
      for (long i = 0; i < ny; ++i) {
        const long y = back ? ny - 1 - i : i;
        __global int* to = plane + y * nx;
        for (long x = 0; x < nx; x += 16) {
          const int word = (int)(plane_bits[y * words + x / 64] >> (x & 63)) & 0xffff;
          const vmask inside = vi_lt(vi_set(0), vi_set(word) & ((vint)(1) << vi_lanes()));
          const vint now = step_lanes(vload16(0, line + x), inside, is_signed, i == 0);
          vstore16(now, 0, line + x);
          if (!back) {
            store_part(now, nx - x, to + x);
            continue;
          }
          const vint up = load_part(to + x, nx - x), least = vi_min(up < 0 ? -up : up, now < 0 ? -now : now), square = least * least;
          const vmask within = vi_lt(vi_lanes() + (int)x, vi_set((int)nx)), sign = vi_lt(up, vi_set(0));
          vstore16(vi_select(within, vi_select(sign, vi_set(0), square), vi_set(FAR)), 0, plus + x);
          vstore16(vi_select(within, vi_select(sign, square, vi_set(0)), vi_set(FAR)), 0, minus + x);
        }
        for (long x = 0; back && x < nx; x += 16) {
          store_part(search_lanes(plus + x, minus + x, nx - x, &r, x, 1), nx - x, to + x);
        }
      }
    }
  }
}

/* rooms: for each group both halves of a tile. A group of one item takes every so many tiles. */
PACKET_KERNEL void tiles(__global const uchar* kinds, long nx, long ny, long nz, __global int* rooms, __global int* field)
{
  const long plane = nx * ny, groups = (long)get_num_groups(0);
  __global int *plus = rooms + (long)get_group_id(0) * 2 * 16 * nz, *minus = plus + 16 * nz;
  ranges r = { { 0, 0 }, { nz - 1, nz - 1 } };
  for (int kind = 0; kind < 2; ++kind) {
    while (r.first[kind] < r.last[kind] && !(kinds[r.first[kind]] >> kind & 1)) {
      ++r.first[kind];
    }
    while (r.last[kind] > r.first[kind] && !(kinds[r.last[kind]] >> kind & 1)) {
      --r.last[kind];
    }
  }
  for (long at = 16 * (long)get_group_id(0); at < plane; at += 16 * groups) {
    for (long k = 0; k < nz; ++k) {
      const int16 s = load_part(field + k * plane + at, plane - at);
      vstore16(max(s, (int16)(0)), 0, plus + 16 * k);
      vstore16(max(-s, (int16)(0)), 0, minus + 16 * k);
    }
    for (long k = 0; k < nz; ++k) {
      store_part(search_lanes(plus + 16 * k, minus + 16 * k, 16, &r, k, 16), plane - at, field + k * plane + at);
    }
  }
}
#endif
