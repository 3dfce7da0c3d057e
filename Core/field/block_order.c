/* SPDX-License-Identifier: BSD-3-Clause
 * Puts boxes in the order in which rays meet them. A plane across an axis that cuts no box parts them: all on the eye's side come first.
 * Where no plane does so, as with blocks that wind around one another, the boxes are compared two by two. */
#include "block_order.h"

#include <stdlib.h>
#include <string.h>

typedef struct sorting {
  const stratus_block_box* boxes;
  const stratus_block_eye* eye;
  double slack;
  int *order, *spare;
  int* overlap;
} sorting;

typedef struct keyed {
  double key;
  int box;
} keyed;

static int by_key(const void* a, const void* b)
{
  const keyed *first = a, *second = b;
  return first->key < second->key ? -1 : first->key > second->key ? 1 : (first->box > second->box) - (first->box < second->box);
}

/* Return 1 if rays pass a plane across an axis from below, -1 if from above, 0 if they are in it. */
static int side_of(const stratus_block_eye* eye, int axis, double plane)
{
  const double upwards = eye->parallel ? eye->point[axis] : plane - eye->point[axis];
  return (upwards > 0.0) - (upwards < 0.0);
}

/* Sorts count boxes of order[from..] by their lower ends along an axis. */
static void sort_along(const sorting* s, int from, int count, int axis, keyed* keys)
{
  for (int i = 0; i < count; ++i) {
    keys[i] = (keyed){ .key = s->boxes[s->order[from + i]].lo[axis], .box = s->order[from + i] };
  }
  qsort(keys, (size_t)count, sizeof *keys, by_key);
  for (int i = 0; i < count; ++i) {
    s->order[from + i] = keys[i].box;
  }
}

/* Returns after how many of the boxes, sorted along an axis, a plane lies that cuts none of them: nearest to the middle; 0: there is none.
 */
static int find_plane(const sorting* s, int from, int count, int axis, double* plane)
{
  int best = 0;
  double reach = -INFINITY;
  for (int i = 0; i < count; ++i) {
    const stratus_block_box* box = &s->boxes[s->order[from + i]];
    if (i > 0 && reach <= box->lo[axis] + s->slack && (best == 0 || abs(2 * i - count) < abs(2 * best - count))) {
      best = i;
      *plane = 0.5 * (reach + box->lo[axis]);
    }
    reach = fmax(reach, box->hi[axis]);
  }
  return best;
}

/* Whether `near` may hide something of `far`: no plane across an axis that parts them has the eye on the side of `far`. */
static bool may_hide(const sorting* s, const stratus_block_box* near, const stratus_block_box* far)
{
  for (int axis = 0; axis < 3; ++axis) {
    if (far->hi[axis] <= near->lo[axis] + s->slack && side_of(s->eye, axis, 0.5 * (far->hi[axis] + near->lo[axis])) >= 0) {
      return false;
    }
    if (near->hi[axis] <= far->lo[axis] + s->slack && side_of(s->eye, axis, 0.5 * (near->hi[axis] + far->lo[axis])) <= 0) {
      return false;
    }
  }
  return true;
}

static bool overlaps(const sorting* s, const stratus_block_box* a, const stratus_block_box* b)
{
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    inside = inside && a->lo[axis] < b->hi[axis] - s->slack && b->lo[axis] < a->hi[axis] - s->slack;
  }
  return inside;
}

/* How far the box's middle is, in a unit that all boxes share. */
static double distance_of(const stratus_block_eye* eye, const stratus_block_box* box)
{
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double middle = 0.5 * (box->lo[axis] + box->hi[axis]);
    sum += eye->parallel ? middle * eye->point[axis] : (middle - eye->point[axis]) * (middle - eye->point[axis]);
  }
  return sum;
}

/* Puts boxes in order that no plane parts: always one that none of those left may hide, the nearest of these. */
static void sort_by_pairs(sorting* s, int from, int count, keyed* keys)
{
  for (int i = 0; i < count; ++i) {
    const int box = s->order[from + i];
    keys[i] = (keyed){ .key = distance_of(s->eye, &s->boxes[box]), .box = box };
    for (int j = 0; j < i; ++j) {
      if (overlaps(s, &s->boxes[box], &s->boxes[s->order[from + j]])) {
        s->overlap[0] = s->order[from + j];
        s->overlap[1] = box;
      }
    }
  }
  qsort(keys, (size_t)count, sizeof *keys, by_key);
  for (int left = count, done = 0; left > 0; --left, ++done) {
    int next = 0;
    for (int i = 0; i < left; ++i) {
      int other = 0;
      while (other < left && (other == i || !may_hide(s, &s->boxes[keys[other].box], &s->boxes[keys[i].box]))) {
        ++other;
      }
      if (other == left) {
        next = i;
        break;
      }
    }
    s->order[from + done] = keys[next].box;
    memmove(keys + next, keys + next + 1, (size_t)(left - next - 1) * sizeof *keys);
  }
}

static void sort_part(sorting* s, int from, int count, keyed* keys)
{
  while (count > 1) {
    int after = 0, along = 0;
    double plane = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      double at = 0.0;
      sort_along(s, from, count, axis, keys);
      const int found = find_plane(s, from, count, axis, &at);
      if (found > 0 && (after == 0 || abs(2 * found - count) < abs(2 * after - count))) {
        after = found;
        along = axis;
        plane = at;
      }
    }
    if (after == 0) {
      sort_by_pairs(s, from, count, keys);
      return;
    }
    sort_along(s, from, count, along, keys);
    if (side_of(s->eye, along, plane) < 0) { /* those above come first */
      memcpy(s->spare, s->order + from, (size_t)after * sizeof *s->order);
      memmove(s->order + from, s->order + from + after, (size_t)(count - after) * sizeof *s->order);
      memcpy(s->order + from + count - after, s->spare, (size_t)after * sizeof *s->order);
      after = count - after;
    }
    /* The smaller part by recursion, so that its depth stays below the logarithm of the count. */
    if (2 * after <= count) {
      sort_part(s, from, after, keys);
      from += after;
      count -= after;
    } else {
      sort_part(s, from + after, count - after, keys);
      count = after;
    }
  }
}

stratus_status stratus_block_order(stratus_context* context, const stratus_block_box* boxes, int count, const stratus_block_eye* eye,
  double slack, int* order, int overlap[2])
{
  void *keys = NULL, *spare = NULL;
  stratus_status status = STRATUS_OK;
  overlap[0] = overlap[1] = -1;
  for (int i = 0; i < count; ++i) {
    order[i] = i;
  }
  TRY_CLEANUP(stratus_allocate(context, (size_t)count, sizeof(keyed), &keys));
  TRY_CLEANUP(stratus_allocate(context, (size_t)count, sizeof(int), &spare));
  sorting s = { .boxes = boxes, .eye = eye, .slack = slack, .order = order, .spare = spare, .overlap = overlap };
  sort_part(&s, 0, count, keys);
cleanup:
  stratus_release(context, keys);
  stratus_release(context, spare);
  return status;
}
