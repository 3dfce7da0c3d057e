/* SPDX-License-Identifier: BSD-3-Clause
 * The intervals of values that a criterion shows, and the test whether one set of intervals covers another.
 *
 * A piecewise linear opacity is above 0 on a union of open and closed intervals of real numbers. Among doubles, each of them has a closed
 * equivalent. */
#include "criterion.h"

#include <string.h>

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

stratus_status stratus_intervals_create(stratus_context* context, const stratus_criterion* criterion, stratus_intervals* intervals)
{
  void* memory;
  if (criterion->transfer) {
    return stratus_transfer_intervals(context, criterion->transfer, intervals);
  }
  TRY(stratus_allocate(context, 1, sizeof *intervals->of, &memory));
  *intervals = (stratus_intervals){ .of = memory };
  stratus_intervals_append(intervals, criterion->lower, criterion->upper);
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

/* Keeps the intervals that meet the volume's values. An end beyond these becomes infinite: it carries no information about the volume, and
 * infinite ends compare equal. Any end of a volume without values is one. */
static stratus_status keep_within(stratus_context* context, const stratus_value_range* ranges, stratus_intervals* list)
{
  const stratus_fetching fetching = stratus_value_range_fetching(ranges);
  const int64_t count = list->count;
  list->count = 0;
  for (int64_t i = 0; i < count; ++i) {
    stratus_shown fetched;
    double one[1][2] = { { list->of[i][0], list->of[i][1] } };
    TRY(stratus_shown_create(context, &fetching, &(stratus_intervals){ 1, one }, &fetched));
    const float lo = fetched.count ? fetched.of[0][0] : INFINITY, hi = fetched.count ? fetched.of[0][1] : -INFINITY;
    stratus_release(context, fetched.of);
    if (lo <= ranges->whole_hi && hi >= ranges->whole_lo) {
      stratus_intervals_append(list, lo <= ranges->whole_lo ? -INFINITY : one[0][0], hi >= ranges->whole_hi ? INFINITY : one[0][1]);
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_origin_take_cells(
  stratus_context* context, const stratus_value_range* ranges, const stratus_criterion* criterion, stratus_origin* origin)
{
  stratus_intervals intervals;
  TRY(stratus_intervals_create(context, criterion, &intervals));
  const stratus_status status = keep_within(context, ranges, &intervals);
  if (status == STRATUS_OK) {
    merge_narrowest(&intervals);
    origin->cells = 1;
    keep(origin, &intervals);
  }
  stratus_release(context, intervals.of);
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

/* Returns whether each wanted interval is within one of the tree's. */
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
