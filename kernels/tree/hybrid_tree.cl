/* SPDX-License-Identifier: BSD-3-Clause
 * Sums over the bricks of a hybrid tree's nodes, all nodes of a level at once, as in Core/tree/hybrid_host.c. They are whole numbers, so
 * that their order does not matter and the results are the host's to the bit. A work-group sums a chunk of one node's bricks in local
 * memory, and adds the sums to the node's. On a processor a group has one item, which needs no atomic operations for that. */
#include "hybrid_arguments.h"

#ifndef GROUP
#define GROUP 64
#endif

#if GROUP == 1
#define LOCAL_ADD(p, v) (*(p) += (v))
#define LOCAL_MIN(p, v) (*(p) = min(*(p), (v)))
#define LOCAL_MAX(p, v) (*(p) = max(*(p), (v)))
#else
#define LOCAL_ADD(p, v) atomic_add((p), (v))
#define LOCAL_MIN(p, v) atomic_min((p), (v))
#define LOCAL_MAX(p, v) atomic_max((p), (v))
#endif

#ifdef STRATUS_SLOT_BYTES
/* Arrays of negative size, which do not compile, where the host lays the structs out otherwise. */
typedef char stratus_slots_agree[sizeof(stratus_hybrid_slot) == STRATUS_SLOT_BYTES ? 1 : -1];
typedef char stratus_chunks_agree[sizeof(stratus_hybrid_chunk) == STRATUS_CHUNK_BYTES ? 1 : -1];
#endif

#define BRICK 4

typedef struct brick {
  ulong mask;
  ushort at[3], count;
} brick;

/* Bits of a brick's layer along an axis. */
static ulong layer_of(ulong mask, int axis, int layer)
{
  return axis == 0 ? mask & 0x1111111111111111UL << layer
    : axis == 1    ? mask & 0x000f000f000f000fUL << 4 * layer
                   : mask & 0xffffUL << 16 * layer;
}

static int layer_count(ulong mask, int axis, int layer) { return (int)popcount(layer_of(mask, axis, layer)); }

/* Adds to a sum of 64 bits in two words, lower one first: a carry goes to the upper one. */
static void add_long(__global uint* sum, long value)
{
  const uint low = (uint)value, before = atomic_add(sum, low);
  const uint high = (uint)((ulong)value >> 32) + (before + low < before ? 1u : 0u);
  if (high) {
    atomic_add(sum + 1, high);
  }
}

/* ---- density */

/* Returns the bit of the voxel nearest to the brick's middle, the first of several. */
static int middle_bit(ulong mask)
{
  int best = 0, least = 64;
  for (int bit = 0; bit < 64; ++bit) {
    const int x = 2 * (bit & 3) - 3, y = 2 * (bit >> 2 & 3) - 3, z = 2 * (bit >> 4) - 3, squared = x * x + y * y + z * z;
    if ((mask >> bit & 1) && squared < least) {
      least = squared;
      best = bit;
    }
  }
  return best;
}

static void offer_peak(uint density, const brick* b, int bit, int axis, const uint* peak, __local uint* best)
{
  const uint x = BRICK * b->at[0] + (bit & 3), y = BRICK * b->at[1] + (bit >> 2 & 3), z = BRICK * b->at[2] + (bit >> 4);
  if (axis == 3) {
    LOCAL_MAX(best, density);
  } else if (density == peak[0] && (axis == 2 || (z == peak[3] && (axis == 1 || y == peak[2])))) {
    LOCAL_MIN(best, axis == 2 ? z : axis == 1 ? y : x);
  }
}

/* peaks: four numbers a node. axis 3: the greatest density, as the bits of a float of 0 or more. axis 2, 1, 0: the least coordinate among
 * the voxels of that density, and of the coordinates found before. densities: one for each voxel from start[brick] on, or, without exact,
 * one for each brick. own: they are of one node's bricks, in its order. */
__kernel void peaks(__global const brick* bricks, __global const uint* order, __global const stratus_hybrid_slot* slots,
  __global const stratus_hybrid_chunk* chunks, __global const float* densities, __global const long* start, int exact, int own, int axis,
  __global uint* peaks)
{
  __local uint best;
  const int item = (int)get_local_id(0);
  const stratus_hybrid_chunk c = chunks[get_group_id(0)];
  __global uint* const node = peaks + 4 * c.slot;
  /* the components that other items do not write now */
  const uint peak[4] = { axis < 3 ? node[0] : 0, 0, axis < 1 ? node[2] : 0, axis < 2 ? node[3] : 0 };
  const uint none = axis == 3 ? 0 : UINT_MAX;
  if (item == 0) {
    best = none;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = item; i < c.count; i += GROUP) {
    const uint number = order[c.first + i];
    const brick b = bricks[number];
    const ulong at = own ? (ulong)(c.first + i - slots[c.slot].first) : number;
    if (!exact) {
      const uint density = as_uint(densities[at]);
      if (axis == 3 || density == peak[0]) {
        offer_peak(density, &b, middle_bit(b.mask), axis, peak, &best);
      }
      continue;
    }
    __global const float* of = densities + start[at];
    for (int bit = 0; bit < 64; ++bit) {
      if (b.mask >> bit & 1) {
        offer_peak(as_uint(*of), &b, bit, axis, peak, &best);
        ++of;
      }
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0 && best != none) {
    if (axis == 3) {
      atomic_max(node, best);
    } else {
      atomic_min(node + 1 + axis, best);
    }
  }
}

/* squares: four sums of 64 bits a node: of the squared distances to the peak along each axis, and of voxels. */
__kernel void squares(__global const brick* bricks, __global const uint* order, __global const stratus_hybrid_chunk* chunks,
  __global const uint* peaks, __global uint* squares)
{
  __local long parts[4 * GROUP];
  const int item = (int)get_local_id(0);
  const stratus_hybrid_chunk c = chunks[get_group_id(0)];
  __global const uint* const peak = peaks + 4 * c.slot + 1;
  long own[4] = { 0, 0, 0, 0 };
  for (int i = item; i < c.count; i += GROUP) {
    const brick b = bricks[order[c.first + i]];
    for (int a = 0; a < 3; ++a) {
      for (int layer = 0; layer < BRICK; ++layer) {
        const long d = (long)(BRICK * b.at[a] + layer) - (long)peak[a];
        own[a] += layer_count(b.mask, a, layer) * d * d;
      }
    }
    own[3] += b.count;
  }
  for (int a = 0; a < 4; ++a) {
    parts[a * GROUP + item] = own[a];
  }
  for (int other = GROUP / 2; other > 0; other /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int a = 0; a < 4 && item < other; ++a) {
      parts[a * GROUP + item] += parts[a * GROUP + item + other];
    }
  }
  for (int a = 0; a < 4 && item == 0; ++a) {
    add_long(squares + 2 * (4 * c.slot + a), parts[a * GROUP]);
  }
}

/* Adds a mass at the doubled coordinate `at` of the line, `across` squared from it, to all planes in reach: plane p has 2 p - 1. */
static void add_mass(__global uint* planes, int lo, int hi, long at, long across, long reach, long mass)
{
  const int most = hi - lo + 1;
  const int away = (int)fmin(sqrt((float)(reach - across)) * 1.001f, 2.0e9f) / 2 + 2, middle = (int)((at + 1) / 2);
  const int first = away > middle - lo ? 0 : middle - away - lo, last = away > hi - middle ? most - 1 : middle + away - lo;
  for (int p = first; p <= last; ++p) {
    const long along = 2 * (long)(p + lo) - 1 - at, squared = along * along;
    if (squared + across < reach) {
      __global uint* const sums = planes + 8 * p;
      add_long(sums, mass);
      add_long(sums + 2, mass * (3 * squared + across));
      add_long(sums + 4, mass * along);
      add_long(sums + 6, mass * along * (squared + across));
    }
  }
}

/* lines: four sums of 64 bits for each plane between voxels on the lines through the peak: x, y, z, from lo to hi of the voxels' box. */
__kernel void lines(__global const brick* bricks, __global const uint* order, __global const stratus_hybrid_slot* slots,
  __global const stratus_hybrid_chunk* chunks, __global uint* lines)
{
  const stratus_hybrid_chunk c = chunks[get_group_id(0)];
  const stratus_hybrid_slot s = slots[c.slot];
  const long reach = (long)((ulong)s.reach_high << 32 | s.reach_low);
  for (int i = (int)get_local_id(0); i < c.count; i += GROUP) {
    const brick b = bricks[order[c.first + i]];
    __global uint* planes = lines + 8 * (ulong)s.at;
    for (int a = 0; a < 3; ++a) {
      const int u = (a + 1) % 3, v = (a + 2) % 3;
      const long du = 8 * b.at[u] + 3 - 2 * s.peak[u], dv = 8 * b.at[v] + 3 - 2 * s.peak[v];
      if (s.whole) {
        if (du * du + dv * dv < reach) {
          add_mass(planes, s.from[a], s.to[a], 8 * b.at[a] + 3, du * du + dv * dv, reach, b.count);
        }
      } else {
        const long nu = max((du < 0 ? -du : du) - 3, 0L), nv = max((dv < 0 ? -dv : dv) - 3, 0L);
        for (int bit = 0; bit < 64 && nu * nu + nv * nv < reach; ++bit) {
          const long eu = du - 3 + 2 * (bit >> 2 * u & 3), ev = dv - 3 + 2 * (bit >> 2 * v & 3), across = eu * eu + ev * ev;
          if ((b.mask >> bit & 1) && across < reach) {
            add_mass(planes, s.from[a], s.to[a], 8 * b.at[a] + 2 * (bit >> 2 * a & 3), across, reach, 1);
          }
        }
      }
      planes += 8 * (s.to[a] - s.from[a] + 1);
    }
  }
}

/* counts: of the voxels at each coordinate along the node's axis. */
__kernel void histograms(__global const brick* bricks, __global const uint* order, __global const stratus_hybrid_slot* slots,
  __global const stratus_hybrid_chunk* chunks, __global uint* counts)
{
  const stratus_hybrid_chunk c = chunks[get_group_id(0)];
  const stratus_hybrid_slot s = slots[c.slot];
  for (int i = (int)get_local_id(0); i < c.count; i += GROUP) {
    const brick b = bricks[order[c.first + i]];
    for (int layer = 0; layer < BRICK; ++layer) {
      const uint voxels = (uint)layer_count(b.mask, s.axis, layer);
      if (voxels) {
        atomic_add(counts + s.at + BRICK * (b.at[s.axis] - s.lo[s.axis]) + layer, voxels);
      }
    }
  }
}

/* ---- surface area: a bin is its number of bricks, then their box */

#define BIN 7

static int empty_bin(int i) { return i >= 1 && i <= 3 ? INT_MAX : 0; }

static void grow(__local int* bin, const brick* b)
{
  LOCAL_ADD(bin, 1);
  for (int a = 0; a < 3; ++a) {
    LOCAL_MIN(bin + 1 + a, (int)b->at[a]);
    LOCAL_MAX(bin + 4 + a, b->at[a] + 1);
  }
}

/* Adds the group's bins, from number `from` on, to the node's. */
static void add_bins(__local const int* own, int from, int count, __global int* to)
{
  for (int bin = from + (int)get_local_id(0); bin < from + count; bin += GROUP) {
    if (own[BIN * bin]) {
      atomic_add(to + BIN * bin, own[BIN * bin]);
      for (int a = 0; a < 3; ++a) {
        atomic_min(to + BIN * bin + 1 + a, own[BIN * bin + 1 + a]);
        atomic_max(to + BIN * bin + 4 + a, own[BIN * bin + 4 + a]);
      }
    }
  }
}

/* Makes bins empty: the numbers of `count` bins. */
__kernel void clear_bins(__global int* bins, ulong count)
{
  const ulong i = get_global_id(0);
  if (i < BIN * count) {
    bins[i] = empty_bin((int)(i % BIN));
  }
}

__kernel void bins(__global const brick* bricks, __global const uint* order, __global const stratus_hybrid_slot* slots,
  __global const stratus_hybrid_chunk* chunks, __global int* bins)
{
  __local int own[3 * HYBRID_BINS * BIN];
  const stratus_hybrid_chunk c = chunks[get_group_id(0)];
  const stratus_hybrid_slot s = slots[c.slot];
  int used[3], all = 0;
  for (int a = 0; a < 3; ++a) {
    used[a] = min(s.hi[a] - s.lo[a], HYBRID_BINS);
    all += used[a];
  }
  for (int i = (int)get_local_id(0); i < BIN * all; i += GROUP) {
    own[i] = empty_bin(i % BIN);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = (int)get_local_id(0); i < c.count; i += GROUP) {
    const brick b = bricks[order[c.first + i]];
    __local int* along = own;
    for (int a = 0; a < 3; ++a) {
      grow(along + BIN * ((b.at[a] - s.lo[a]) * used[a] / (s.hi[a] - s.lo[a])), &b);
      along += BIN * used[a];
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  add_bins(own, 0, all, bins + BIN * (ulong)s.at);
}

/* sides: a bin for each side of each of the two planes that are offered. */
__kernel void sides(__global const brick* bricks, __global const uint* order, __global const stratus_hybrid_slot* slots,
  __global const stratus_hybrid_chunk* chunks, __global int* sides)
{
  __local int own[4 * BIN];
  const stratus_hybrid_chunk c = chunks[get_group_id(0)];
  const stratus_hybrid_slot s = slots[c.slot];
  for (int i = (int)get_local_id(0); i < 4 * BIN; i += GROUP) {
    own[i] = empty_bin(i % BIN);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = (int)get_local_id(0); i < c.count; i += GROUP) {
    const brick b = bricks[order[c.first + i]];
    for (int offer = 0; offer < 2; ++offer) {
      grow(own + BIN * (2 * offer + (b.at[s.axis] >= s.plane[offer])), &b);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  add_bins(own, 0, 4, sides + 4 * BIN * (ulong)c.slot);
}

/* ---- division */

__kernel void count_below(__global const brick* bricks, __global const uint* order, __global const stratus_hybrid_slot* slots,
  __global const stratus_hybrid_chunk* chunks, __global int* below)
{
  __local int own;
  const stratus_hybrid_chunk c = chunks[get_group_id(0)];
  const stratus_hybrid_slot s = slots[c.slot];
  if (get_local_id(0) == 0) {
    own = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = (int)get_local_id(0); i < c.count; i += GROUP) {
    if (bricks[order[c.first + i]].at[s.axis] < s.plane[0]) {
      LOCAL_ADD(&own, 1);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_local_id(0) == 0) {
    below[get_group_id(0)] = own;
  }
}

/* A box of bricks and one of voxels: lo and hi of each. */
#define BOX 12

static void widen(__local int* box, const brick* b)
{
  for (int a = 0; a < 3; ++a) {
    const int at = BRICK * b->at[a];
    int first = 0, last = BRICK - 1;
    while (!layer_of(b->mask, a, first)) {
      ++first;
    }
    while (!layer_of(b->mask, a, last)) {
      --last;
    }
    LOCAL_MIN(box + a, (int)b->at[a]);
    LOCAL_MAX(box + 3 + a, b->at[a] + 1);
    LOCAL_MIN(box + 6 + a, at + first);
    LOCAL_MAX(box + 9 + a, at + last + 1);
  }
}

/* Writes the bricks below the plane from `below` on and the others from `above` on, each in their order, and widens the boxes of the two
 * children, which begin empty. */
__kernel void divide(__global const brick* bricks, __global const uint* order, __global const stratus_hybrid_slot* slots,
  __global const stratus_hybrid_chunk* chunks, __global uint* divided, __global int* boxes)
{
  __local int own[2 * BOX], ranks[GROUP];
  const int item = (int)get_local_id(0);
  const stratus_hybrid_chunk c = chunks[get_group_id(0)];
  const stratus_hybrid_slot s = slots[c.slot];
  int below = c.below, above = c.above;
  for (int i = item; i < 2 * BOX; i += GROUP) {
    own[i] = i % 6 < 3 ? INT_MAX : 0;
  }
  for (int first = 0; first < c.count; first += GROUP) {
    const int i = first + item;
    uint number = 0;
    int is_below = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (i < c.count) {
      number = order[c.first + i];
      const brick b = bricks[number];
      is_below = b.at[s.axis] < s.plane[0];
      widen(own + (is_below ? 0 : BOX), &b);
    }
    ranks[item] = is_below;
    for (int step = 1; step < GROUP; step *= 2) {
      barrier(CLK_LOCAL_MEM_FENCE);
      const int before = item >= step ? ranks[item - step] : 0;
      barrier(CLK_LOCAL_MEM_FENCE);
      ranks[item] += before;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (i < c.count) {
      divided[is_below ? below + ranks[item] - 1 : above + item - ranks[item]] = number;
    }
    below += ranks[GROUP - 1];
    above += min(GROUP, c.count - first) - ranks[GROUP - 1];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = item; i < 2 * BOX; i += GROUP) {
    __global int* const to = boxes + 2 * BOX * (ulong)c.slot + i;
    if (i % 6 < 3) {
      atomic_min(to, own[i]);
    } else {
      atomic_max(to, own[i]);
    }
  }
}

/* Makes the boxes of `count` nodes' children empty. */
__kernel void clear_boxes(__global int* boxes, ulong count)
{
  const ulong i = get_global_id(0);
  if (i < 2 * BOX * count) {
    boxes[i] = i % 6 < 3 ? INT_MAX : 0;
  }
}

/* Copies the divided nodes' bricks back to the order. */
__kernel void keep(__global const uint* divided, __global const stratus_hybrid_chunk* chunks, __global uint* order)
{
  const stratus_hybrid_chunk c = chunks[get_group_id(0)];
  for (int i = (int)get_local_id(0); i < c.count; i += GROUP) {
    order[c.first + i] = divided[c.first + i];
  }
}

__kernel void clear(__global uint* words, ulong count)
{
  if (get_global_id(0) < count) {
    words[get_global_id(0)] = 0;
  }
}
