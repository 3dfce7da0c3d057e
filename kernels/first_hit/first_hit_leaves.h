/* SPDX-License-Identifier: BSD-3-Clause
 * Leads rays to the leaves of a tree: each lane of a packet descends by itself, with a stack of its own, and walks its leaf by hit_step()
 * of first_hit.h. A leaf of bricks is walked brick by brick, each as a field of one cell.
 *
 * A plane across an axis is between the boxes of two siblings, and a ray meets the sibling before the plane first. The sign of its
 * direction therefore gives the order without rounding. So do bricks of a list come in the order of the sum of their coordinates along the
 * ray's octant. A box is met if the ray meets it grown by the slack. So no leaf is missed, and the first voxel that is found, if the ray is
 * certain of it, is the first of the whole tree. */
#ifndef STRATUS_FIRST_HIT_LEAVES_H
#define STRATUS_FIRST_HIT_LEAVES_H

#include "first_hit.h"

#define STRATUS_HIT_DEPTH 130 /* a ray leaves one node behind at each level; trees are at most 128 deep */
#define STRATUS_HIT_KIND_BRICKS 1

typedef struct stratus_hit_search {
  int stack[STRATUS_HIT_DEPTH * STRATUS_WIDTH]; /* a lane's nodes are at i * STRATUS_WIDTH + lane */
  vint top;                                     /* how many */
  vint node;                                    /* the next node, which the ray meets; -1: none */
  vint first, count;                            /* the leaf's list of bricks; count 0: none */
  vint key, number;                             /* of the brick that was walked last */
} stratus_hit_search;

/* A box of voxels in each lane, [lo, hi). */
typedef struct stratus_hit_box {
  vint lo[3], hi[3];
} stratus_hit_box;

/* Puts lanes of new rays before the root. */
INLINE void hit_begin(stratus_hit_packet* k, stratus_hit_search* s, vmask fresh)
{
  const vint zero = vi_set(0);
  k->seeking = k->seeking | fresh;
  s->top = vi_select(fresh, zero, s->top);
  s->node = vi_select(fresh, zero, s->node);
  s->count = vi_select(fresh, zero, s->count);
}

INLINE void hit_push(stratus_hit_search* s, vint node, vmask mask)
{
  if (m_any(mask)) {
#if !defined(STRATUS_DEVICE) && STRATUS_ISA == 2 && STRATUS_WIDTH == 16
    _mm512_mask_i32scatter_epi32(s->stack, mask, (__m512i)((s->top << vi_set(4)) + vi_lanes()), (__m512i)node, 4);
#else
    int top[STRATUS_WIDTH], nodes[STRATUS_WIDTH], on[STRATUS_WIDTH];
    vi_store(top, s->top);
    vi_store(nodes, node);
    vi_store(on, vi_select(mask, vi_set(1), vi_set(0)));
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      if (on[lane]) {
        s->stack[top[lane] * STRATUS_WIDTH + lane] = nodes[lane];
      }
    }
#endif
    s->top = vi_select(mask, s->top + vi_set(1), s->top);
  }
}

/* Takes the next node from the stack. */
INLINE void hit_pop(stratus_hit_search* s, vmask mask)
{
  if (m_any(mask)) {
    const vmask some = mask & vi_ge(s->top, vi_set(1));
    s->top = vi_select(some, s->top - vi_set(1), s->top);
#if !defined(STRATUS_DEVICE) && STRATUS_ISA == 2 && STRATUS_WIDTH == 16
    const vint node = v_gather_ints(s->stack, (s->top << vi_set(4)) + vi_lanes(), some);
#else
    int top[STRATUS_WIDTH], nodes[STRATUS_WIDTH], on[STRATUS_WIDTH];
    vi_store(top, s->top);
    vi_store(on, vi_select(some, vi_set(1), vi_set(0)));
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      nodes[lane] = on[lane] ? s->stack[top[lane] * STRATUS_WIDTH + lane] : -1;
    }
    const vint node = vi_load(nodes);
#endif
    s->node = vi_select(mask, vi_select(some, node, vi_set(-1)), s->node);
  }
}

/* The lanes whose rays meet their boxes, grown by the slack. */
INLINE vmask hit_meets(CONSTANT stratus_hit_arguments* a, const stratus_hit_packet* k, const stratus_hit_box* box, vmask mask)
{
  vfloat enter = v_set(0.0f), leave = k->end;
  for (int axis = 0; axis < 3; ++axis) {
    const vfloat lo = (v_from_int(box->lo[axis]) - v_set(a->slack) - k->o[axis]) * k->inverse[axis],
                 hi = (v_from_int(box->hi[axis]) + v_set(a->slack) - k->o[axis]) * k->inverse[axis];
    enter = v_max(enter, v_min(lo, hi));
    leave = v_min(leave, v_max(lo, hi));
  }
  return mask & v_le(enter, leave);
}

/* Gathers the nodes' boxes, first children or contents, and kinds with counts. */
INLINE void hit_node(const stratus_hit_tables* tables, vint node, vmask mask, stratus_hit_box* box, vint* first, vint* kind)
{
  vint low[4], high[4];
  gather_four_ints(tables->nodes, node + node, mask, low);
  gather_four_ints(tables->nodes, node + node + vi_set(1), mask, high);
  for (int axis = 0; axis < 3; ++axis) {
    box->lo[axis] = low[axis];
  }
  box->hi[0] = low[3];
  box->hi[1] = high[0];
  box->hi[2] = high[1];
  *first = high[2];
  *kind = high[3];
}

/* Sends lanes from an inner node to the child that they meet first. They leave the other behind if they meet that, too. */
INLINE void hit_descend(CONSTANT stratus_hit_arguments* a, const stratus_hit_tables* tables, const stratus_hit_packet* k,
  stratus_hit_search* s, vint child, vmask mask)
{
  const vint one = vi_set(1);
  stratus_hit_box box[2];
  vint first, kind;
  vmask before = m_none();
  hit_node(tables, child, mask, &box[0], &first, &kind);
  hit_node(tables, child + one, mask, &box[1], &first, &kind);
  for (int axis = 0; axis < 3; ++axis) {
    const vmask up = k->up[axis];
    before = before | vi_ge(vi_select(up, box[1].lo[axis], box[0].lo[axis]), vi_select(up, box[0].hi[axis], box[1].hi[axis]));
  }
  const vmask left = hit_meets(a, k, &box[0], mask), right = hit_meets(a, k, &box[1], mask), both = left & right;
  hit_push(s, vi_select(before, child + one, child), both);
  s->node = vi_select(left | right, child + vi_select(m_andnot(right, left & before), one, vi_set(0)), s->node);
  hit_pop(s, m_andnot(mask, left | right));
}

/* Puts lanes into their leaf or brick where they enter its box. Where that is certain they live, else they are doubtful. */
INLINE void hit_land(
  CONSTANT stratus_hit_arguments* a, const stratus_hit_tables* tables, stratus_hit_packet* k, const stratus_hit_box* box, vmask mask)
{
  const vfloat half_one = v_set(0.5f), zero = v_set(0.0f);
  const vint one = vi_set(1);
  vfloat enter[3], position[3], t = zero, late = zero;
  vmask near = m_none();
  vint cell[3];
  for (int axis = 0; axis < 3; ++axis) {
    enter[axis] = (v_from_int(vi_select(k->up[axis], box->lo[axis], box->hi[axis])) - k->o[axis]) * k->inverse[axis];
    t = v_max(t, enter[axis]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    late = v_select(v_le(t, enter[axis]), v_max(late, v_abs(k->inverse[axis])), late);
  }
  late = late * v_set(a->slack);
  const vfloat certain = v_fma(late, v_set(-0.25f), v_set(0.5f - a->slack));
  for (int axis = 0; axis < 3; ++axis) {
    const vmask entered = v_le(t, enter[axis]);
    position[axis] = v_fma(t, k->d[axis], k->o[axis]);
    const vfloat inside = v_min(v_max(position[axis], v_from_int(box->lo[axis])), v_from_int(box->hi[axis]));
    const vint last = box->hi[axis] - one, in = vi_min(v_to_int(inside), last);
    cell[axis] = vi_select(entered, vi_select(k->up[axis], box->lo[axis], last), in);
    k->cell[axis] = vi_select(mask, cell[axis], k->cell[axis]);
    near = near | m_andnot(v_lt(certain, v_abs((position[axis] - v_from_int(cell[axis])) - half_one)), entered);
  }
  /* A slow ray may enter where floats have it still outside. */
  vmask doubtful = mask & v_lt(v_set(1.0f), late);
  const vmask doubt = m_andnot(mask & near, doubtful);
  if (m_any(doubt)) {
    doubtful = doubtful | hit_doubts(a, tables, k, doubt, position, cell, late, STRATUS_HIT_LEAVES);
  }
  k->doubtful = k->doubtful | doubtful;
  k->seeking = m_andnot(k->seeking, mask);
  k->live = k->live | m_andnot(mask, doubtful);
}

/* Gathers the place of a brick of the lane's list. */
INLINE void hit_brick(const stratus_hit_tables* tables, vint brick, vmask mask, vint at[3])
{
  const vint word = (brick << vi_set(2)) + vi_set(2), low = vi_set(0xffff);
  const vint two = v_gather_ints(tables->bricks, word, mask);
  at[0] = two & low;
  at[1] = (two >> vi_set(16)) & low;
  at[2] = v_gather_ints(tables->bricks, word + vi_set(1), mask) & low;
}

INLINE void hit_box_of_brick(const vint at[3], stratus_hit_box* box)
{
  for (int axis = 0; axis < 3; ++axis) {
    box->lo[axis] = at[axis] << vi_set(2);
    box->hi[axis] = box->lo[axis] + vi_set(4);
  }
}

/* Puts lanes into a brick. */
INLINE void hit_take_brick(CONSTANT stratus_hit_arguments* a, const stratus_hit_tables* tables, stratus_hit_packet* k, vint brick,
  const vint at[3], const stratus_hit_box* box, vmask mask)
{
  k->brick = vi_select(mask, brick, k->brick);
  for (int axis = 0; axis < 3; ++axis) {
    k->at[axis] = vi_select(mask, at[axis], k->at[axis]);
    k->cells[axis] = vi_select(mask, vi_set(1), k->cells[axis]);
  }
  hit_land(a, tables, k, box, mask);
}

/* Sends lanes with lists to the next brick that they meet. A list that has no other is forgotten. */
INLINE void hit_next_brick(
  CONSTANT stratus_hit_arguments* a, const stratus_hit_tables* tables, stratus_hit_packet* k, stratus_hit_search* s, vmask mask)
{
  const vint none = vi_set(0x7fffffff), one = vi_set(1);
  vint best = none, number = none, place[3] = { vi_set(0), vi_set(0), vi_set(0) };
  stratus_hit_box box;
  vmask left = mask;
  for (vint i = vi_set(0); m_any(left); i = i + one) {
    vint at[3], key = vi_set(0);
    hit_brick(tables, s->first + i, left, at);
    for (int axis = 0; axis < 3; ++axis) {
      key = key + vi_select(k->up[axis], at[axis], vi_set(0) - at[axis]);
    }
    hit_box_of_brick(at, &box);
    k->visited = vi_select(left, k->visited + one, k->visited);
    const vmask later = vi_lt(s->key, key) | m_andnot(vi_ge(key, s->key) & vi_lt(s->number, i), vi_lt(s->key, key));
    const vmask closer = hit_meets(a, k, &box, left & later & vi_lt(key, best));
    best = vi_select(closer, key, best);
    number = vi_select(closer, i, number);
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = vi_select(closer, at[axis], place[axis]);
    }
    left = left & vi_lt(i + one, s->count);
  }
  const vmask found = mask & vi_lt(number, none);
  s->key = vi_select(found, best, s->key);
  s->number = vi_select(found, number, s->number);
  s->count = vi_select(m_andnot(mask, found), vi_set(0), s->count);
  if (m_any(found)) {
    hit_box_of_brick(place, &box);
    hit_take_brick(a, tables, k, s->first + number, place, &box, found);
  }
}

/* Brings every seeking lane one node or brick nearer to its next leaf. A lane that has no node left ends. */
INLINE void hit_seek(CONSTANT stratus_hit_arguments* a, const stratus_hit_tables* tables, stratus_hit_packet* k, stratus_hit_search* s)
{
  const vint one = vi_set(1), zero = vi_set(0);
  const vmask listed = k->seeking & vi_ge(s->count, one);
  if (m_any(listed)) {
    hit_next_brick(a, tables, k, s, listed);
  }
  vmask now = m_andnot(k->seeking, listed);
  const vmask done = now & vi_lt(s->node, zero);
  k->seeking = m_andnot(k->seeking, done);
  now = m_andnot(now, done);
  if (!m_any(now)) {
    return;
  }
  stratus_hit_box box;
  vint first, kind;
  hit_node(tables, s->node, now, &box, &first, &kind);
  k->visited = vi_select(now, k->visited + one, k->visited);
  const vint what = (kind >> vi_set(30)) & vi_set(3);
  const vmask inner = now & vi_zero(what), bricks = now & vi_zero(what - vi_set(STRATUS_HIT_KIND_BRICKS)),
              fields = m_andnot(now, inner | bricks);
  if (m_any(inner)) {
    hit_descend(a, tables, k, s, first, inner);
  }
  hit_pop(s, fields | bricks);
  if (m_any(fields)) {
    vint low[4], high[4];
    gather_four_ints(tables->fields, first + first, fields, low);
    gather_four_ints(tables->fields, first + first + one, fields, high);
    const vint cells[3] = { low[3], high[0], high[1] };
    for (int axis = 0; axis < 3; ++axis) {
      k->at[axis] = vi_select(fields, low[axis], k->at[axis]);
      k->cells[axis] = vi_select(fields, cells[axis], k->cells[axis]);
    }
    k->first_entry = vi_select(fields, high[2], k->first_entry);
    k->first_row = vi_select(fields, high[3], k->first_row);
    k->brick = vi_select(fields, vi_set(-1), k->brick);
    hit_land(a, tables, k, &box, fields);
  }
  if (m_any(bricks)) {
    const vint count = kind & vi_set(0x3fffffff);
    const vmask single = bricks & vi_zero(count - one), several = m_andnot(bricks, single);
    s->first = vi_select(several, first, s->first);
    s->count = vi_select(several, count, s->count);
    s->key = vi_select(several, vi_set(-0x7fffffff), s->key);
    s->number = vi_select(several, vi_set(-1), s->number);
    if (m_any(single)) {
      vint at[3];
      hit_brick(tables, first, single, at);
      hit_take_brick(a, tables, k, first, at, &box, single);
    }
  }
}

/* The packet's next step: its leaves are walked until half of its lanes seek another. */
INLINE void hit_step_leaves(CONSTANT stratus_hit_arguments* a, const stratus_hit_tables* tables, stratus_hit_packet* k,
  stratus_hit_search* s, const int octants, const int entry_bytes, const int cell_log2)
{
  if (m_any(k->seeking) && (2 * m_count(k->seeking) >= STRATUS_WIDTH || !m_any(k->live))) {
    hit_seek(a, tables, k, s);
  }
  if (m_any(k->live)) {
    hit_step(a, tables, k, STRATUS_HIT_LEAVES, octants, entry_bytes, cell_log2);
  }
}

#endif
