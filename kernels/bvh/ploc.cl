/* SPDX-License-Identifier: BSD-3-Clause
 * Parallel locally-ordered clustering: what Core/bvh/bvh_ploc.c does on the host. A round takes four launches: each cluster finds its
 * nearest, each work-group counts what remains of its chunk, one group sums the counts, and each group moves its chunk. Rounds share two
 * slots of `state`, so that the host need not know how many clusters remain. One group makes the last rounds in one launch. On a processor
 * a group has one item, which compares 16 clusters at a time. */
#pragma OPENCL FP_CONTRACT OFF
#ifndef GROUP
#define GROUP 64
#endif

#define RADIUS 16
#define PADDING 16 /* entries before the first cluster and after the last, which are read but never chosen */
#define LEAF 0x80000000u

#if GROUP == 1
#define WIDTH 16
typedef float16 floats;
typedef uint16 uints;
#define LOAD(from) vload16(0, from)
#define STORE(what, to) vstore16(what, 0, to)
#define NUMBERS (uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#else
#define WIDTH 1
typedef float floats;
typedef uint uints;
#define LOAD(from) (*(from))
#define STORE(what, to) (*(to) = (what))
#define NUMBERS 0u
#endif

/* Boxes and children, as in a pair, of all clusters. Side s (lo x y z, hi x y z) of cluster i is sides[s*stride + PADDING + i]. */
typedef struct clusters {
  __global float* sides;
  __global uint* child;
  size_t stride;
} clusters;

static __global float* side_of(const clusters* c, int s, uint i) { return c->sides + s * c->stride + PADDING + i; }

/* Finds the nearest of clusters i .. i + WIDTH - 1 among `count`: the least pair of area of the union and XOR of the places. */
static void find_nearest(const clusters* c, uint i, uint count, __global uint* nearest)
{
  __global const float *alx = side_of(c, 0, i), *aly = side_of(c, 1, i), *alz = side_of(c, 2, i);
  __global const float *ahx = side_of(c, 3, i), *ahy = side_of(c, 4, i), *ahz = side_of(c, 5, i);
  const floats lx = LOAD(alx), ly = LOAD(aly), lz = LOAD(alz), hx = LOAD(ahx), hy = LOAD(ahy), hz = LOAD(ahz);
  const uints own = NUMBERS + i;
  floats best_area = INFINITY;
  uints best = 0; /* XOR of the places */
  for (int d = -RADIUS; d <= RADIUS; ++d) {
    const floats blx = LOAD(alx + d), bly = LOAD(aly + d), blz = LOAD(alz + d);
    const floats bhx = LOAD(ahx + d), bhy = LOAD(ahy + d), bhz = LOAD(ahz + d);
    const floats x = (bhx > hx ? bhx : hx) - (blx < lx ? blx : lx);
    const floats y = (bhy > hy ? bhy : hy) - (bly < ly ? bly : ly);
    const floats z = (bhz > hz ? bhz : hz) - (blz < lz ? blz : lz);
    const floats area = x * y + y * z + z * x;
    const uints other = own + (uint)d, apart = own ^ other; /* a place before the first wraps around to a large one */
    const floats candidate = ((other < count) & (apart != 0u)) ? area : (floats)INFINITY;
    const floats old = best_area;
    best_area = candidate < old ? candidate : old;
    best = ((candidate < old) | ((candidate == old) & (apart < best))) ? apart : best;
  }
  STORE(own ^ best, nearest + i);
}

/* Bit 0: cluster i remains, by itself or with another. Bit 16: it merges with another. */
static uint remains(__global const uint* nearest, uint i)
{
  const uint j = nearest[i];
  const uint merges = j != i && nearest[j] == i;
  return !merges ? 1u : i < j ? 1u << 16 | 1u : 0u;
}

/* Moves what remains of clusters begin .. end - 1 to places from to.x on. Merged ones become pairs from to.y on. Returns the next place and
 * pair. flags: GROUP numbers. All items of the group call this function with the same arguments. */
static uint2 move_clusters(const clusters* now, __global const uint* nearest, uint begin, uint end, uint2 to, const clusters* next,
  __global uint* pairs, __local uint* flags)
{
  const uint item = (uint)get_local_id(0);
  for (uint block = begin; block < end; block += GROUP) {
    const uint i = block + item, flag = i < end ? remains(nearest, i) : 0u;
    uint before = 0, all = flag;
#if GROUP > 1
    flags[item] = flag;
    barrier(CLK_LOCAL_MEM_FENCE);
    all = 0;
    for (uint other = 0; other < GROUP; ++other) {
      before += other < item ? flags[other] : 0;
      all += flags[other];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
#endif
    if (flag) {
      const uint place = to.x + (before & 0xffffu), pair = to.y + (before >> 16), other = flag > 1u ? nearest[i] : i;
      for (int s = 0; s < 6; ++s) {
        const float a = *side_of(now, s, i), b = *side_of(now, s, other);
        *side_of(next, s, place) = (s < 3) == (a < b) ? a : b;
      }
      if (other != i) {
        pairs[2 * (size_t)pair] = now->child[i];
        pairs[2 * (size_t)pair + 1] = now->child[other];
      }
      next->child[place] = other != i ? pair : now->child[i];
    }
    to += (uint2)(all & 0xffffu, all >> 16);
  }
  return to;
}

/* Boxes become clusters; boxes: lo, then hi, of each. */
__kernel void start(__global const int* boxes, uint count, ulong stride, __global float* sides, __global uint* child)
{
  const clusters c = { sides, child, (size_t)stride };
  const uint i = (uint)get_global_id(0);
  if (i < count) {
    for (int s = 0; s < 6; ++s) {
      *side_of(&c, s, i) = (float)boxes[6 * (size_t)i + s];
    }
    child[i] = LEAF | i;
  }
}

/* state: of each slot, the number of clusters and of pairs. */
__kernel void find(__global float* sides, ulong stride, __global const uint* state, int slot, uint chunk, __global uint* nearest)
{
  const clusters c = { sides, 0, (size_t)stride };
  const uint count = state[2 * slot], begin = min((uint)get_group_id(0) * chunk, count), end = begin + min(chunk, count - begin);
  for (uint i = begin + WIDTH * (uint)get_local_id(0); i < end; i += WIDTH * GROUP) {
    find_nearest(&c, i, count, nearest);
  }
}

/* sums: of each chunk, how many of its clusters remain and how many of these merge. */
__kernel void count(__global const uint* state, int slot, uint chunk, __global const uint* nearest, __global uint* sums)
{
  __local uint flags[GROUP];
  const uint item = (uint)get_local_id(0), group = (uint)get_group_id(0);
  const uint size = state[2 * slot], begin = min(group * chunk, size), end = begin + min(chunk, size - begin);
  uint sum = 0;
  for (uint i = begin + item; i < end; i += GROUP) {
    sum += remains(nearest, i);
  }
  flags[item] = sum;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0) {
    for (uint other = 1; other < GROUP; ++other) {
      sum += flags[other];
    }
    sums[2 * (size_t)group] = sum & 0xffffu;
    sums[2 * (size_t)group + 1] = sum >> 16;
  }
}

/* One group: each chunk's numbers become sums over all chunks before, and the other slot what the round leaves. */
__kernel void sum(__global uint* state, int slot, uint chunk, __global uint* sums)
{
  __local uint kept[GROUP], merged[GROUP];
  const uint item = (uint)get_local_id(0), chunks = (state[2 * slot] - 1) / chunk + 1, stretch = (chunks - 1) / GROUP + 1;
  const uint begin = min(item * stretch, chunks), end = begin + min(stretch, chunks - begin);
  uint2 here = 0, before = 0;
  for (uint c = begin; c < end; ++c) {
    here += (uint2)(sums[2 * (size_t)c], sums[2 * (size_t)c + 1]);
  }
  kept[item] = here.x;
  merged[item] = here.y;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint other = 0; other < item; ++other) {
    before += (uint2)(kept[other], merged[other]);
  }
  if (item == GROUP - 1) {
    state[2 * (1 - slot)] = before.x + here.x;
    state[2 * (1 - slot) + 1] = state[2 * slot + 1] + before.y + here.y;
  }
  for (uint c = begin; c < end; ++c) {
    const uint2 own = (uint2)(sums[2 * (size_t)c], sums[2 * (size_t)c + 1]);
    sums[2 * (size_t)c] = before.x;
    sums[2 * (size_t)c + 1] = before.y;
    before += own;
  }
}

__kernel void merge(__global float* sides, __global uint* child, ulong stride, __global const uint* state, int slot, uint chunk,
  __global const uint* nearest, __global const uint* sums, __global float* next_sides, __global uint* next_child, __global uint* pairs)
{
  __local uint flags[GROUP];
  const clusters now = { sides, child, (size_t)stride }, next = { next_sides, next_child, (size_t)stride };
  const uint size = state[2 * slot], group = (uint)get_group_id(0), begin = min(group * chunk, size);
  const uint2 to = (uint2)(sums[2 * (size_t)group], state[2 * slot + 1] + sums[2 * (size_t)group + 1]);
  (void)move_clusters(&now, nearest, begin, begin + min(chunk, size - begin), to, &next, pairs, flags);
}

/* One group: rounds until one cluster is left. */
__kernel void finish(__global float* sides, __global uint* child, ulong stride, __global const uint* state, int slot,
  __global uint* nearest, __global float* next_sides, __global uint* next_child, __global uint* pairs)
{
  __local uint flags[GROUP];
  clusters now = { sides, child, (size_t)stride }, next = { next_sides, next_child, (size_t)stride };
  uint2 left = (uint2)(state[2 * slot], state[2 * slot + 1]);
  while (left.x > 1) {
    for (uint i = WIDTH * (uint)get_local_id(0); i < left.x; i += WIDTH * GROUP) {
      find_nearest(&now, i, left.x, nearest);
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
    left = move_clusters(&now, nearest, 0, left.x, (uint2)(0, left.y), &next, pairs, flags);
    barrier(CLK_GLOBAL_MEM_FENCE);
    const clusters swap = now;
    now = next;
    next = swap;
  }
}
