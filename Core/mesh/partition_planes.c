/* SPDX-License-Identifier: BSD-3-Clause
 * Chooses the plane that cuts a node. Each candidate's new cells (the paper's beta) and imbalance (alpha) are counted, not estimated. The
 * median rule's candidates pass through points of the mesh: even bent grids often have planes of faces, which cut no cell. */
#include "radix_sort.h"
#include "partition_build.h"

#include <string.h>

#define MIDDLE_LOW 0.4 /* a median plane is between these quantiles of the cells */
#define MIDDLE_HIGH 0.6

typedef struct candidate_set {
  double* values; /* ascending */
  int64_t* below; /* cells and pieces below each candidate */
  int64_t* above;
  int64_t* added; /* new cells */
  int count;
} candidate_set;

static double coordinate(const stratus_partition* partition, int axis, int32_t point)
{
  return partition->along[3 * (int64_t)point + axis];
}

/* If `below`, the first candidate that x is below; else the first that x is not above. */
static int find_candidate(const candidate_set* set, double x, double tolerance, bool below)
{
  int low = 0, high = set->count;
  while (low < high) {
    const int middle = (low + high) / 2;
    const double above = stratus_kdtree_above(x, set->values[middle], tolerance);
    if (above > 0.0 || (below && above == 0.0)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

/* Counts cells below and above all candidates in one pass over the cells: each cell adds changes from one candidate to the next, which are
 * then summed up. */
static void count_sides(const stratus_partition* partition, const stratus_kdtree_node* node, int axis, candidate_set* set)
{
  const double tolerance = partition->tolerance;
  memset(set->below, 0, (size_t)(set->count + 1) * sizeof *set->below);
  memset(set->above, 0, (size_t)(set->count + 1) * sizeof *set->above);
  memset(set->added, 0, (size_t)(set->count + 1) * sizeof *set->added);
  for (int64_t i = 0; i < node->count; ++i) {
    double x[4], low = INFINITY, high = -INFINITY;
    for (int v = 0; v < 4; ++v) {
      x[v] = coordinate(partition, axis, node->cells[i].vertex[v]);
      low = fmin(low, x[v]);
      high = fmax(high, x[v]);
    }
    /* A cell in the plane counts as below it. */
    const int first_cut = find_candidate(set, low, tolerance, true), first_below = find_candidate(set, high, tolerance, false);
    ++set->below[first_below];
    set->above[first_cut < first_below ? first_cut : first_below]++;
    for (int c = first_cut; c < first_below; ++c) {
      int below = 0, above = 0, pieces_below, pieces_above;
      for (int v = 0; v < 4; ++v) {
        const double side = stratus_kdtree_above(x[v], set->values[c], tolerance);
        below += side < 0.0;
        above += side > 0.0;
      }
      stratus_kdtree_pieces(below, above, &pieces_below, &pieces_above);
      set->added[c] += pieces_below + pieces_above - 1;
      /* The pieces count only for this candidate. */
      set->below[c] += pieces_below;
      set->below[c + 1] -= pieces_below;
      set->above[c] -= pieces_above;
      set->above[c + 1] += pieces_above;
    }
  }
  /* So far above[c] counts the cells that are above candidates before c, but not above c. */
  int64_t below = 0, gone = 0;
  for (int c = 0; c < set->count; ++c) {
    below += set->below[c];
    gone += set->above[c];
    set->below[c] = below;
    set->above[c] = node->count - gone;
  }
}

static void take_best(
  const stratus_partition* partition, const stratus_kdtree_node* node, int axis, const candidate_set* set, stratus_kdtree_plane* best)
{
  for (int c = 0; c < set->count; ++c) {
    const double below = (double)set->below[c], above = (double)set->above[c];
    const double growth = (double)set->added[c] / (double)node->count, imbalance = fabs(below - above) / (0.5 * (below + above));
    if (below == 0.0 || above == 0.0 || growth > partition->options.growth || !(imbalance < partition->options.imbalance)) {
      continue;
    }
    if (best->axis < 0 || growth < best->growth || (growth == best->growth && imbalance < best->imbalance)) {
      *best = (stratus_kdtree_plane){ axis, set->values[c], growth, imbalance };
    }
  }
}

static void evenly_spaced(const stratus_partition* partition, const stratus_kdtree_node* node, int axis, candidate_set* set)
{
  double low = INFINITY, high = -INFINITY;
  for (int64_t i = 0; i < 4 * node->count; ++i) {
    const double x = coordinate(partition, axis, node->cells[i / 4].vertex[i % 4]);
    low = fmin(low, x);
    high = fmax(high, x);
  }
  set->count = 0;
  for (int i = 1; i <= partition->options.planes; ++i) {
    const double share = i / (partition->options.planes + 1.0), value = low * (1.0 - share) + high * share;
    if (value > low && value < high && (set->count == 0 || value > set->values[set->count - 1])) {
      set->values[set->count++] = value;
    }
  }
}

/* Maps doubles to integers in the same order, for the radix sort; number_of() is the inverse. */
static uint64_t bits_of(double value)
{
  uint64_t bits;
  value += 0.0; /* -0 is 0 */
  memcpy(&bits, &value, sizeof bits);
  return bits >> 63 ? ~bits : bits | UINT64_C(1) << 63;
}

static double number_of(uint64_t bits)
{
  double value;
  bits = bits >> 63 ? bits & ~(UINT64_C(1) << 63) : ~bits;
  memcpy(&value, &bits, sizeof value);
  return value;
}

/* Chooses candidates among sorted coordinates, keys[0..count). A run is a stretch of equal keys. At most half of the candidates are the
 * longest runs, where a plane may follow many faces; the others are spread evenly over the runs. */
static void through_points(const uint64_t* keys, int64_t count, int planes, candidate_set* set)
{
  int64_t runs = 0, longest = 1, least = 1;
  for (int64_t i = 0, begin = 0; i < count; ++i) {
    if (i + 1 == count || keys[i + 1] != keys[i]) {
      ++runs;
      longest = i + 1 - begin > longest ? i + 1 - begin : longest;
      begin = i + 1;
    }
  }
  /* Find the smallest power-of-two run length that at most planes/2 runs reach. Doubling is precise enough: only long runs matter. */
  for (int64_t longer = runs; longer > planes / 2 && least <= longest; least *= 2) {
    longer = 0;
    for (int64_t i = 0, begin = 0; i < count; ++i) {
      if (i + 1 == count || keys[i + 1] != keys[i]) {
        longer += i + 1 - begin >= 2 * least;
        begin = i + 1;
      }
    }
  }
  const int64_t spread = planes - planes / 2;
  set->count = 0;
  int64_t run = 0;
  for (int64_t i = 0, begin = 0; i < count && set->count < planes; ++i) {
    if (i + 1 == count || keys[i + 1] != keys[i]) {
      if (i + 1 - begin >= least || run * spread / runs != (run + 1) * spread / runs) {
        set->values[set->count++] = number_of(keys[i]);
      }
      ++run;
      begin = i + 1;
    }
  }
}

static stratus_status middle_points(const stratus_partition* partition, const stratus_kdtree_node* node, int axis, candidate_set* set)
{
  stratus_context* context = partition->context;
  stratus_status status = STRATUS_OK;
  void *keys = NULL, *numbers = NULL;
  TRY_CLEANUP(stratus_allocate(context, (size_t)node->count, sizeof(uint64_t), &keys));
  TRY_CLEANUP(stratus_allocate(context, (size_t)node->count, sizeof(uint32_t), &numbers));
  uint64_t* key = keys;
  for (int64_t i = 0; i < node->count; ++i) {
    key[i] = bits_of(coordinate(partition, axis, node->cells[i].vertex[i % 4]));
  }
  memset(numbers, 0, (size_t)node->count * sizeof(uint32_t));
  TRY_CLEANUP(stratus_radix_sort(context, keys, numbers, (uint32_t)node->count, 64));
  const int64_t low = (int64_t)(MIDDLE_LOW * (double)node->count), high = (int64_t)(MIDDLE_HIGH * (double)node->count) + 1;
  through_points(key + low, (high < node->count ? high : node->count) - low, partition->options.planes, set);

cleanup:
  stratus_release(context, keys);
  stratus_release(context, numbers);
  return status;
}

stratus_status stratus_kdtree_choose_plane(const stratus_partition* partition, const stratus_kdtree_node* node, stratus_kdtree_plane* plane)
{
  stratus_status status = STRATUS_OK;
  candidate_set set = { 0 };
  const size_t room = (size_t)partition->options.planes + 1;
  void *values = NULL, *counts = NULL;
  *plane = (stratus_kdtree_plane){ .axis = -1 };
  TRY_CLEANUP(stratus_allocate(partition->context, room, sizeof *set.values, &values));
  TRY_CLEANUP(stratus_allocate(partition->context, room, 3 * sizeof(int64_t), &counts));
  set.values = values;
  set.below = counts;
  set.above = set.below + room;
  set.added = set.above + room;
  for (int axis = 0; axis < 3; ++axis) {
    if (partition->options.rule == STRATUS_PARTITION_PAPER) {
      evenly_spaced(partition, node, axis, &set);
    } else {
      TRY_CLEANUP(middle_points(partition, node, axis, &set));
    }
    count_sides(partition, node, axis, &set);
    take_best(partition, node, axis, &set, plane);
  }

cleanup:
  stratus_release(partition->context, values);
  stratus_release(partition->context, counts);
  return status;
}
