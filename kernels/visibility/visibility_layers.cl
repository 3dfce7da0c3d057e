/* SPDX-License-Identifier: BSD-3-Clause
 * Peeling in layers, all leaves at once: what Core/visibility/visibility_layers.c does by a queue for each leaf. `list` holds the cells
 * layer by layer, `positions` each cell's place in it. A layer takes two launches, which share it out among all groups: one counts the
 * cells that each group will list, and one lists them. A cell is listed by the last cell before it, so that no atomic operation is needed
 * and the order is the queue's. On a processor a group has one item. */
#ifndef GROUP
#define GROUP 64
#endif
#define CHUNKS ((uint)get_num_groups(0))
#define NOT_LISTED UINT_MAX

/* bounds: begin and end of the current layer and of the next, which exchange their places at each layer; then the number of layers. */
#define BOUNDS_LAYERS 4

static uint before_of(__global const uchar* sides, __global const uchar* state, uint cell)
{
  return (uint)state[cell] >> 4 & (uint)sides[cell];
}

/* The faces of the listed cell at `at` behind which a cell has become ready: no cell that comes before it is listed later. */
static uint released_by(__global const int* neighbours, __global const uchar* sides, __global const uchar* state,
  __global const uint* positions, uint cell, uint at)
{
  __global const int* own = neighbours + 4 * (size_t)cell;
  const uint after = (uint)state[cell] & (uint)sides[cell] & 15u;
  uint bits = 0;
  for (int f = 0; f < 4; ++f) {
    int ready = (int)(after >> f & 1);
    for (int g = f + 1; g < 4; ++g) { /* of two faces between the same cells the last releases */
      ready = ready && !((after >> g & 1) && own[g] == own[f]);
    }
    if (ready) {
      __global const int* behind = neighbours + 4 * (size_t)own[f];
      const uint before = before_of(sides, state, (uint)own[f]);
      for (int g = 0; g < 4; ++g) {
        ready = ready && !((before >> g & 1) && positions[behind[g]] > at);
      }
      bits |= (uint)ready << f;
    }
  }
  return bits;
}

__kernel void clear(__global uint* positions, uint cells)
{
  for (uint i = (uint)get_global_id(0); i < cells; i += (uint)get_global_size(0)) {
    positions[i] = NOT_LISTED;
  }
}

/* first: all cells are examined, and cells that no cell hides are ready. flags: for each entry of the layer, the cells that it releases. */
__kernel void count(__global const int* neighbours, __global const uchar* sides, __global const uchar* state, uint cells, int first,
  int parity, __global const uint* bounds, __global const uint* list, __global const uint* positions, __global uchar* flags,
  __global uint* counts)
{
  __local uint sums[GROUP];
  const uint item = (uint)get_local_id(0), group = (uint)get_group_id(0);
  const uint begin = first ? 0 : bounds[2 * parity], size = first ? cells : bounds[2 * parity + 1] - begin;
  const uint from = begin + (uint)((ulong)size * group / CHUNKS), to = begin + (uint)((ulong)size * (group + 1) / CHUNKS);
  uint sum = 0;
  for (uint i = from + item; i < to; i += GROUP) {
    const uint bits = first ? (uint)(before_of(sides, state, i) == 0) : released_by(neighbours, sides, state, positions, list[i], i);
    flags[i] = (uchar)bits;
    sum += popcount(bits);
  }
  sums[item] = sum;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0) {
    for (uint other = 1; other < GROUP; ++other) {
      sum += sums[other];
    }
    counts[group] = sum;
  }
}

__kernel void place(__global const int* neighbours, uint cells, int first, int parity, __global uint* bounds, __global uint* list,
  __global uint* positions, __global const uchar* flags, __global const uint* counts)
{
  __local uint found[GROUP];
  const uint item = (uint)get_local_id(0), group = (uint)get_group_id(0);
  const uint end = bounds[2 * parity + 1], begin = first ? 0 : bounds[2 * parity], size = first ? cells : end - begin;
  const uint from = begin + (uint)((ulong)size * group / CHUNKS), to = begin + (uint)((ulong)size * (group + 1) / CHUNKS);
  uint next = end, total = 0;
  for (uint chunk = 0; chunk < CHUNKS; ++chunk) {
    next += chunk < group ? counts[chunk] : 0;
    total += counts[chunk];
  }
  for (uint block = from; block < to; block += GROUP) {
    const uint i = block + item, bits = i < to ? flags[i] : 0;
    uint to_place = next;
    found[item] = popcount(bits);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint other = 0; other < GROUP; ++other) {
      to_place += other < item ? found[other] : 0;
      next += found[other];
    }
    for (int f = 0; f < 4; ++f) {
      if (bits >> f & 1) {
        const uint cell = first ? i : (uint)neighbours[4 * (size_t)list[i] + f];
        list[to_place] = cell;
        positions[cell] = to_place++;
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (group == 0 && item == 0) {
    bounds[2 * (1 - parity)] = end;
    bounds[2 * (1 - parity) + 1] = end + total;
    bounds[BOUNDS_LAYERS] += total > 0 ? 1 : 0;
  }
}

/* The rank of each listed cell's leaf, by which a stable sort makes of layers of all leaves each leaf's layers. */
__kernel void ranks(__global const uint* list, uint count, __global const uint* leaf_begin, __global const uint* leaf_rank, uint leaf_count,
  __global ulong* keys, __global uint* values)
{
  for (uint i = (uint)get_global_id(0); i < count; i += (uint)get_global_size(0)) {
    const uint cell = list[i];
    uint low = 0, high = leaf_count;
    while (high - low > 1) { /* the last leaf that begins at the cell or before it */
      const uint middle = low + (high - low) / 2;
      if (leaf_begin[middle] <= cell) {
        low = middle;
      } else {
        high = middle;
      }
    }
    keys[i] = leaf_rank[low];
    values[i] = cell;
  }
}
