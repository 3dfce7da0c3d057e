/* SPDX-License-Identifier: BSD-3-Clause
 * Common parts of both methods of peeling: stratus_order_cut() drops a relation of a ring, and seeds give the order of cells that no
 * relation decides. */
#include "visibility_order.h"

void stratus_order_cut(stratus_visibility_order* order, uint32_t cell, int face)
{
  const uint32_t before = (uint32_t)order->neighbours[4 * (int64_t)cell + face];
  const unsigned after = stratus_order_after(order, before);
  order->state[cell] = (uint8_t)(order->state[cell] & ~(16u << face));
  for (int f = 0; f < 4; ++f) {
    if (after >> f & 1 && order->neighbours[4 * (int64_t)before + f] == (int32_t)cell) {
      order->state[before] = (uint8_t)(order->state[before] & ~(1u << f));
      return;
    }
  }
}

/* ---- seeds: a heap sort, as it needs no memory of its own */

static bool comes_before(const stratus_order_seed* p, const stratus_order_seed* q)
{
  return p->key < q->key || (p->key == q->key && p->first < q->first);
}

static void sift_down(stratus_order_seed* seeds, int64_t from, int64_t count)
{
  for (int64_t child; (child = 2 * from + 1) < count; from = child) {
    child += child + 1 < count && comes_before(seeds + child, seeds + child + 1);
    if (!comes_before(seeds + from, seeds + child)) {
      return;
    }
    const stratus_order_seed seed = seeds[from];
    seeds[from] = seeds[child];
    seeds[child] = seed;
  }
}

void stratus_order_sort_seeds(const stratus_visibility_order* order, int32_t leaf, stratus_order_seed* seeds)
{
  const int64_t begin = order->leaf_begin[leaf], cells = order->leaf_begin[leaf + 1] - begin, count = stratus_order_seed_count(cells);
  for (int64_t s = 0; s < count; ++s) {
    const int64_t first = STRATUS_SEED_CELLS * s, middle = first + STRATUS_SEED_CELLS / 2;
    seeds[s].first = (uint32_t)(begin + first);
    seeds[s].key = stratus_order_key(order, (uint32_t)(begin + (middle < cells ? middle : first)));
  }
  for (int64_t i = count / 2 - 1; i >= 0; --i) {
    sift_down(seeds, i, count);
  }
  for (int64_t end = count - 1; end > 0; --end) {
    const stratus_order_seed seed = seeds[0];
    seeds[0] = seeds[end];
    seeds[end] = seed;
    sift_down(seeds, 0, end);
  }
}
