/* SPDX-License-Identifier: BSD-3-Clause
 * The intervals of values that a criterion shows, and the test whether one set of intervals covers another.
 *
 * A piecewise linear opacity is above 0 on a union of open and closed intervals of real numbers. Among doubles, each of them has a closed
 * equivalent. Ray casting reads a table that samples the function at its entries, and an entry stands for all values that round to it: the
 * intervals of cells are therefore those that the table shows. */
#include "criterion.h"

#include <string.h>

/* Sample distance, in unit distances, so long that any opacity above 0 is above 0 in a float, too. */
#define LONG_SAMPLE 1e30
/* Fraction of a table's size by which fma() and rounding to floats can shift a value's entry. The bounds of intervals move outward by
 * it. */
#define ENTRY_ROUNDING 2.4e-7

stratus_criterion stratus_criterion_default(void)
{
  return (stratus_criterion){ .lower = -INFINITY, .upper = INFINITY };
}

stratus_status stratus_criterion_check(stratus_context* context, const stratus_criterion* criterion)
{
  if (!criterion) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "criterion is NULL");
  }
  if (criterion->transfer) {
    return stratus_transfer_check(context, criterion->transfer);
  }
  if (!(criterion->lower <= criterion->upper)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "criterion from %g to %g, the lower end must be at most the upper",
      criterion->lower, criterion->upper);
  }
  return STRATUS_OK;
}

/* ---------------------------------------------------------------- values of single voxels */

/* Appends lo..hi if lo <= hi. If no double lies between it and the last interval, it lengthens that one. */
static void append(stratus_intervals* list, double lo, double hi)
{
  if (!(lo <= hi)) {
    return;
  }
  if (list->count > 0 && lo <= nextafter(list->of[list->count - 1][1], INFINITY)) {
    list->of[list->count - 1][1] = fmax(hi, list->of[list->count - 1][1]);
    return;
  }
  list->of[list->count][0] = lo;
  list->of[list->count][1] = hi;
  ++list->count;
}

/* Of points of equal value, the last counts at that value and the first towards smaller values. */
static void append_opacity(stratus_intervals* list, const stratus_transfer* transfer)
{
  const double(*point)[2] = (const double(*)[2])transfer->opacity;
  const size_t count = transfer->opacity_count;
  if (transfer->clamp && point[0][1] > 0.0) {
    append(list, -INFINITY, nextafter(point[0][0], -INFINITY));
  }
  for (size_t i = 0; i < count; ++i) {
    const bool last = i + 1 == count, step = !last && point[i + 1][0] == point[i][0];
    if (!step && point[i][1] > 0.0) {
      append(list, point[i][0], point[i][0]);
    }
    if (!last && !step && (point[i][1] > 0.0 || point[i + 1][1] > 0.0)) {
      append(list, nextafter(point[i][0], INFINITY), nextafter(point[i + 1][0], -INFINITY));
    }
  }
  if (transfer->clamp && point[count - 1][1] > 0.0) {
    append(list, nextafter(point[count - 1][0], INFINITY), INFINITY);
  }
}

stratus_status stratus_intervals_create(stratus_context* context, const stratus_criterion* criterion, stratus_intervals* intervals)
{
  void* memory;
  const size_t most = criterion->transfer ? 2 * criterion->transfer->opacity_count + 1 : 1;
  TRY(stratus_allocate(context, most, sizeof *intervals->of, &memory));
  *intervals = (stratus_intervals){ .of = memory };
  if (criterion->transfer) {
    append_opacity(intervals, criterion->transfer);
  } else {
    append(intervals, criterion->lower, criterion->upper);
  }
  return STRATUS_OK;
}

/* ---------------------------------------------------------------- intervals of an origin */

/* Fills the narrowest gaps until the list fits. */
static void merge_narrowest(stratus_intervals* list)
{
  while (list->count > STRATUS_INTERVALS_MAX) {
    int64_t narrowest = 0;
    double gap = INFINITY;
    for (int64_t i = 0; i + 1 < list->count; ++i) {
      const double here = list->of[i + 1][0] - list->of[i][1];
      if (here < gap) {
        gap = here;
        narrowest = i;
      }
    }
    list->of[narrowest][1] = list->of[narrowest + 1][1];
    memmove(list->of + narrowest + 1, list->of + narrowest + 2, (size_t)(list->count - narrowest - 2) * sizeof *list->of);
    --list->count;
  }
}

static void keep(stratus_origin* origin, const stratus_intervals* intervals)
{
  origin->intervals = (int32_t)intervals->count;
  memcpy(origin->interval, intervals->of, (size_t)intervals->count * sizeof *intervals->of);
}

void stratus_origin_take(stratus_origin* origin, const stratus_intervals* intervals)
{
  double no_other[1][2] = { { INFINITY, -INFINITY } };
  const stratus_intervals nothing = { 1, no_other };
  origin->cells = 0;
  keep(origin, intervals->count <= STRATUS_INTERVALS_MAX ? intervals : &nothing);
}

/* ---------------------------------------------------------------- values of cells */

/* Value between entries e-1 and e of a table, moved outward by `outward` entries and by the rounding of the bias. */
static double entry_bound(const stratus_table* table, double bias, int e, double outward)
{
  const double value = ((double)e + outward - (double)table->offset) / (double)table->scale + bias;
  return nextafter(value, outward > 0.0 ? INFINITY : -INFINITY);
}

/* Appends the runs of entries with opacity, as values. In a table without scale all values have one entry. */
static void append_runs(stratus_intervals* list, const stratus_table* table, double bias)
{
  const double outward = ENTRY_ROUNDING * table->size;
  for (int e = table->next_shown[0]; e < table->size;) {
    int end = e + 1;
    while (end < table->size && table->next_shown[end] == end) {
      ++end;
    }
    const bool all = table->scale == 0.0f;
    append(list, e == 0 || all ? -INFINITY : entry_bound(table, bias, e, -outward),
      end == table->size || all ? INFINITY : entry_bound(table, bias, end, outward));
    e = table->next_shown[end];
  }
}

/* Appends the union of a and b, both in ascending order, to `both`. */
static void unite(const stratus_intervals* a, const stratus_intervals* b, stratus_intervals* both)
{
  for (int64_t i = 0, j = 0; i < a->count || j < b->count;) {
    const bool first = j == b->count || (i < a->count && a->of[i][0] <= b->of[j][0]);
    const double* next = first ? a->of[i++] : b->of[j++];
    append(both, next[0], next[1]);
  }
}

static stratus_status append_tables(stratus_context* context, const stratus_value_range* ranges, const stratus_transfer* transfer,
  stratus_intervals lists[2], void* memory[2])
{
  const bool any = ranges->whole_lo <= ranges->whole_hi;
  for (int s = 0; s < 2; ++s) {
    stratus_table* table = NULL;
    TRY(stratus_table_create(context, transfer, ranges->bias, any ? ranges->whole_lo : 0.0f, any ? ranges->whole_hi : 0.0f,
      s ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT, LONG_SAMPLE * transfer->unit_distance, &table));
    const stratus_status status = stratus_allocate(context, (size_t)table->size, sizeof *lists->of, &memory[s]);
    if (status == STRATUS_OK) {
      lists[s] = (stratus_intervals){ .of = memory[s] };
      append_runs(&lists[s], table, ranges->bias);
    }
    stratus_table_destroy(table);
    TRY(status);
  }
  return STRATUS_OK;
}

/* Makes ends beyond the volume's values infinite. Such ends carry no information about the volume, and infinite ones compare equal. */
static void open_ends(stratus_intervals* list, const stratus_value_range* ranges)
{
  const double lo = (double)ranges->whole_lo + ranges->bias, hi = (double)ranges->whole_hi + ranges->bias;
  if (list->count > 0 && lo <= hi) {
    double* last = list->of[list->count - 1];
    list->of[0][0] = list->of[0][0] <= lo && list->of[0][1] >= lo ? -INFINITY : list->of[0][0];
    last[1] = last[0] <= hi && last[1] >= hi ? INFINITY : last[1];
  }
}

stratus_status stratus_origin_take_cells(
  stratus_context* context, const stratus_value_range* ranges, const stratus_criterion* criterion, stratus_origin* origin)
{
  stratus_status status = STRATUS_OK;
  stratus_intervals lists[2], both = { 0 };
  void *memory[2] = { NULL, NULL }, *united = NULL;
  if (criterion->transfer) {
    TRY_CLEANUP(append_tables(context, ranges, criterion->transfer, lists, memory));
    TRY_CLEANUP(stratus_allocate(context, (size_t)(lists[0].count + lists[1].count), sizeof *both.of, &united));
    both.of = united;
    unite(&lists[0], &lists[1], &both);
  } else {
    TRY_CLEANUP(stratus_intervals_create(context, criterion, &both));
    united = both.of;
  }
  open_ends(&both, ranges);
  merge_narrowest(&both);
  origin->cells = 1;
  keep(origin, &both);
cleanup:
  stratus_release(context, memory[0]);
  stratus_release(context, memory[1]);
  stratus_release(context, united);
  return status;
}

/* ---------------------------------------------------------------- both uses */

stratus_status stratus_criterion_intervals(
  stratus_context* context, const stratus_volume* volume, const stratus_criterion* criterion, int cells, stratus_origin* origin)
{
  TRY(stratus_criterion_check(context, criterion));
  if (cells) {
    stratus_value_range* ranges = NULL;
    TRY(stratus_value_range_create(context, volume, STRATUS_BRICK, &ranges));
    const stratus_status status = stratus_origin_take_cells(context, ranges, criterion, origin);
    stratus_value_range_destroy(ranges);
    return status;
  }
  stratus_intervals intervals;
  TRY(stratus_intervals_create(context, criterion, &intervals));
  stratus_origin_take(origin, &intervals);
  stratus_release(context, intervals.of);
  return STRATUS_OK;
}

/* True if each wanted interval lies within one of the tree's. */
static bool is_within(const stratus_origin* wanted, const stratus_origin* tree)
{
  for (int32_t i = 0, j = 0; i < wanted->intervals; ++i) {
    while (j < tree->intervals && tree->interval[j][1] < wanted->interval[i][1]) {
      ++j;
    }
    if (j == tree->intervals || tree->interval[j][0] > wanted->interval[i][0]) {
      return false;
    }
  }
  return true;
}

int stratus_origin_covers(const stratus_origin* tree, const stratus_origin* wanted)
{
  if (tree->hash == 0 || tree->hash != wanted->hash || tree->cells != wanted->cells) {
    return 0;
  }
  /* The one interval from INFINITY to -INFINITY stands for more intervals than are kept, which may be any. */
  if (tree->intervals > 0 && tree->interval[0][0] > tree->interval[0][1]) {
    return 0;
  }
  return is_within(wanted, tree) && (tree->cells || is_within(tree, wanted));
}
