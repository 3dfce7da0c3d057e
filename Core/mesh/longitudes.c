/* SPDX-License-Identifier: BSD-3-Clause
 * Longitudes that jump by whole turns, made continuous: neighbours are joined into groups, those that differ least first. */
#include "longitudes.h"
#include "stratus/globe.h"

#define FARTHEST 1e9 /* degrees: neighbours that differ by more are not joined */

static const double differences[] = { 1.0, 3.0, 10.0, 30.0, 90.0, 180.0 }; /* neighbours are joined in this order, in degrees */

/* Groups of places whose turns to each other are known. Each place points to another of its group, up to the group's first. */
typedef struct longitude_groups {
  int64_t* parents;
  int32_t* turns; /* that a place has more than its parent */
  const double* degrees;
  double above, below; /* neighbours that differ by more than the one and at most the other are joined */
} longitude_groups;

/* Returns the group's first place, and the turns that the place has more than that. */
static int64_t find(longitude_groups* groups, int64_t place, int32_t* turns)
{
  int64_t first = place;
  *turns = 0;
  while (groups->parents[first] != first) {
    *turns += groups->turns[first];
    first = groups->parents[first];
  }
  int32_t rest = *turns; /* point all on the way to the first */
  while (groups->parents[place] != first && place != first) {
    const int64_t next = groups->parents[place];
    const int32_t own = groups->turns[place];
    groups->parents[place] = first;
    groups->turns[place] = rest;
    rest -= own;
    place = next;
  }
  return first;
}

double stratus_longitudes_turns(double difference)
{
  return fabs(difference) > 0.5 * TURN ? round(difference / TURN) : 0.0;
}

static void join_pair(void* state, int64_t a, int64_t b)
{
  longitude_groups* const groups = state;
  const double difference = groups->degrees[b] - groups->degrees[a];
  if (!(fabs(difference) < FARTHEST)) { /* or one is NaN */
    return;
  }
  const double turns = stratus_longitudes_turns(difference), rest = fabs(difference - turns * TURN);
  if (!(rest > groups->above && rest <= groups->below)) {
    return;
  }
  int32_t of_a = 0, of_b = 0;
  const int64_t first_a = find(groups, a, &of_a), first_b = find(groups, b, &of_b);
  const int32_t more = of_a - (int32_t)turns - of_b; /* turns that b's group gets */
  if (first_a < first_b) {                           /* the first place stays the lowest number */
    groups->parents[first_b] = first_a;
    groups->turns[first_b] = more;
  } else if (first_b < first_a) {
    groups->parents[first_a] = first_b;
    groups->turns[first_a] = -more;
  }
}

typedef struct jump_search {
  const double* degrees;
  bool found;
} jump_search;

static void compare_pair(void* state, int64_t a, int64_t b)
{
  jump_search* const search = state;
  search->found = search->found || fabs(search->degrees[a] - search->degrees[b]) > 0.5 * TURN;
}

bool stratus_longitudes_jump(const stratus_edges* edges, const double* degrees)
{
  jump_search search = { degrees, false };
  edges->walk(edges, compare_pair, &search);
  return search.found;
}

/* Moves groups that no neighbours join by whole turns, to where their middles are nearest to the widest group's middle.
 * ends: two numbers for each place; only groups' first places use theirs */
static void gather_groups(longitude_groups* groups, int64_t count, const double* degrees, double* ends)
{
  for (int64_t i = 0; i < count; ++i) {
    ends[2 * i] = INFINITY;
    ends[2 * i + 1] = -INFINITY;
  }
  int64_t widest = -1;
  for (int64_t i = 0; i < count; ++i) {
    int32_t turns = 0;
    const int64_t first = find(groups, i, &turns);
    if (isfinite(degrees[i])) {
      double* const own = ends + 2 * first;
      const double at = degrees[i] + turns * TURN;
      own[0] = at < own[0] ? at : own[0];
      own[1] = at > own[1] ? at : own[1];
      if (widest < 0 || own[1] - own[0] > ends[2 * widest + 1] - ends[2 * widest]) {
        widest = first;
      }
    }
  }
  for (int64_t i = 0; i < count; ++i) {
    if (widest >= 0 && groups->parents[i] == i && isfinite(ends[2 * i]) && fabs(ends[2 * i]) < FARTHEST) {
      const double difference = 0.5 * (ends[2 * i] + ends[2 * i + 1]) - 0.5 * (ends[2 * widest] + ends[2 * widest + 1]);
      groups->turns[i] = fabs(difference) < FARTHEST ? -(int32_t)stratus_longitudes_turns(difference) : 0;
    }
  }
}

stratus_status stratus_longitudes_join(stratus_context* context, const stratus_edges* edges, double* degrees, int* changed)
{
  *changed = 0;
  if (!stratus_longitudes_jump(edges, degrees)) {
    return STRATUS_OK;
  }
  void *parents = NULL, *turns = NULL, *ends = NULL;
  stratus_status status = STRATUS_OK;
  TRY_CLEANUP(stratus_allocate(context, (size_t)edges->count, sizeof(int64_t), &parents));
  TRY_CLEANUP(stratus_allocate_zero(context, (size_t)edges->count, sizeof(int32_t), &turns));
  TRY_CLEANUP(stratus_allocate(context, (size_t)edges->count, 2 * sizeof(double), &ends));
  longitude_groups groups = { .parents = parents, .turns = turns, .degrees = degrees, .above = -1.0 };
  for (int64_t i = 0; i < edges->count; ++i) {
    groups.parents[i] = i;
  }
  for (size_t i = 0; i < sizeof differences / sizeof *differences; ++i) {
    groups.below = differences[i];
    edges->walk(edges, join_pair, &groups);
    groups.above = groups.below;
  }
  gather_groups(&groups, edges->count, degrees, ends);
  for (int64_t i = 0; i < edges->count; ++i) {
    int32_t own = 0;
    const int64_t first = find(&groups, i, &own);
    own += groups.turns[first]; /* of the group */
    degrees[i] += own * TURN;
    *changed = *changed || own != 0;
  }
cleanup:
  stratus_release(context, parents);
  stratus_release(context, turns);
  stratus_release(context, ends);
  return status;
}

/* Places in up to three directions. */
typedef struct lattice_edges {
  stratus_edges edges; /* its first member */
  int64_t lengths[3], strides[3];
} lattice_edges;

static void walk_lattice(const stratus_edges* edges, stratus_edge_function call, void* state)
{
  const lattice_edges* const lattice = (const lattice_edges*)edges;
  const int64_t *n = lattice->lengths, *step = lattice->strides;
  for (int64_t k = 0; k < n[2]; ++k) {
    for (int64_t j = 0; j < n[1]; ++j) {
      for (int64_t i = 0; i < n[0]; ++i) {
        const int64_t at = i * step[0] + j * step[1] + k * step[2];
        if (i > 0) {
          call(state, at - step[0], at);
        }
        if (j > 0) {
          call(state, at - step[1], at);
        }
        if (k > 0) {
          call(state, at - step[2], at);
        }
      }
    }
  }
}

stratus_status stratus_longitudes_unwrap(
  stratus_context* context, const int64_t lengths[3], const int64_t strides[3], double* degrees, int* changed)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!lengths || !strides || !degrees || !changed) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "lengths, strides, degrees or changed is NULL");
  }
  const int64_t most = INT64_C(1) << 40;
  lattice_edges lattice = { .edges = { .count = 1, .walk = walk_lattice } };
  for (int axis = 0; axis < 3; ++axis) {
    if (lengths[axis] < 1 || lengths[axis] > most || strides[axis] < 0 || strides[axis] > most) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "axis %d has %lld places %lld apart, must be 1 to 2^40 and 0 to 2^40", axis,
        (long long)lengths[axis], (long long)strides[axis]);
    }
    lattice.lengths[axis] = strides[axis] > 0 ? lengths[axis] : 1;
    lattice.strides[axis] = strides[axis];
    size_t last = 0;
    TRY(stratus_product(context, "places", (size_t)(lattice.lengths[axis] - 1), (size_t)strides[axis], 1, &last));
    lattice.edges.count += (int64_t)last;
    if (last > (size_t)most || lattice.edges.count > most) {
      return stratus_fail(context, STRATUS_OVERFLOW, "a lattice of more than 2^40 places");
    }
  }
  return stratus_longitudes_join(context, &lattice.edges, degrees, changed);
}
