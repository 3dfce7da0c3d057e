/* SPDX-License-Identifier: BSD-3-Clause
 * Lays out a table's entries: a uniform grid, and cells divided where the function has steps or features narrower than cells.
 *
 * Smooth functions have only the grid. Whole numbers are in the middles of cells, and an odd number of cells from one to the next puts a
 * border half-way: label windows need no divided cell. */
#include "table_entries.h"

#include <stdlib.h>
#include <string.h>

#define MOST_CELLS 65536
/* How far sums reach beyond the function's points, in their span, where the function shows. */
#define OUTSIDE_SPANS 4.0
/* Cells that the grid gives to the function's narrowest feature, if it needs more than the minimum for that. */
#define CELLS_A_FEATURE 32
/* A feature over so many cells is taken at their middles. */
#define CELLS_ENOUGH 16
/* A cell that mixes several pieces is not divided if its optical depth changes by less than this share of its largest depth, and each
 * colour by less than this. */
#define CHANGE_SMALL (1.0 / 16.0)
/* A ramp in a divided cell has so many entries at most. */
#define PARTS_A_RAMP 32
/* Whole numbers up to this bound times the cells between two of them are exact in the grid's arithmetic. */
#define EXACT_PLACES 4194304.0
/* Width of 16 floats, relative to their magnitude. */
#define FEW_FLOATS 0x1p-19
/* Optical depth, in units, that stands for opacity 1 where changes are compared. */
#define OPAQUE_TAU 16.0

/* ---------------------------------------------------------------- the grid */

/* Returns the width of the narrowest interval between points where the opacity changes or is 1, at most `range`. */
static double narrowest_feature(const stratus_transfer* transfer, double range)
{
  double narrowest = range;
  for (size_t i = 0; i + 1 < transfer->opacity_count; ++i) {
    const double* p = transfer->opacity + 2 * i;
    if (p[2] > p[0] && (p[3] != p[1] || p[1] >= 1.0) && p[2] - p[0] < narrowest) {
      narrowest = p[2] - p[0];
    }
  }
  return narrowest;
}

/* Shrink lo..hi, the data's values, to the function's points and a margin. Nothing changes beyond that margin. A mean over entries counts
 * the whole range from one value to another. Running sums therefore shrink to the margin only if the function is transparent there, which
 * rays know (*cut). Beyond an end that shows they reach OUTSIDE_SPANS times the points' span, so that a fill value far away makes no entry
 * coarse. */
static void table_span(const stratus_transfer* transfer, bool sums, double* lo, double* hi, bool* cut)
{
  const double* first = transfer->opacity;
  const double* last = transfer->opacity + 2 * (transfer->opacity_count - 1);
  const double* first_color = transfer->color;
  const double* last_color = transfer->color + 4 * (transfer->color_count - 1);
  const double from = fmin(first[0], first_color[0]), to = fmax(last[0], last_color[0]), span = to - from;
  const bool low_clear = !transfer->clamp || first[1] <= 0.0, high_clear = !transfer->clamp || last[1] <= 0.0;
  const double far = OUTSIDE_SPANS * span, margin = span / 64.0;
  const bool limited = sums && ((!low_clear && *lo < from - far) || (!high_clear && *hi > to + far));
  const double low = limited ? from - far : from - margin, high = limited ? to + far : to + margin;
  *cut = false;
  if (!(span > 0.0)) {
    return;
  }
  if (low > *lo && low < *hi && (!sums || limited || low_clear)) {
    *lo = low;
    *cut = sums && !limited;
  }
  if (high < *hi && high > *lo && (!sums || limited || high_clear)) {
    *hi = high;
    *cut = sums && !limited;
  }
}

static int table_cells(const stratus_transfer* transfer, double range, int least)
{
  int cells = least;
  const double wanted = range > 0.0 ? CELLS_A_FEATURE * range / narrowest_feature(transfer, range) : 0.0;
  while (cells < MOST_CELLS && cells < wanted) {
    cells *= 2;
  }
  return cells;
}

/* Places whole numbers in the middles of cells, an odd number of cells apart. Returns whether they are few enough. */
static bool place_whole_numbers(stratus_table_entries* t, const stratus_table_values* values, double from, double to, int cells)
{
  const double bias = values->fetching.bias, lo = floor(from), hi = ceil(to), span = hi - lo;
  const double farthest = fmax(fabs(lo - bias), fabs(hi - bias));
  if (!values->fetching.integer || !(span < MOST_CELLS) || bias != floor(bias)) {
    return false;
  }
  double apart = span > 0.0 ? floor(cells / span) : 1.0;
  apart += fmod(apart, 2.0) == 0.0;
  while (apart > 1.0 && (span * apart >= MOST_CELLS || farthest * apart > EXACT_PLACES)) {
    apart -= 2.0;
  }
  if (farthest * apart > EXACT_PLACES) {
    return false;
  }
  t->from = lo;
  t->width = 1.0 / apart;
  t->cells = (int)(span * apart) + 1;
  t->scale = (float)apart;
  t->offset = (float)(0.5 - (lo - bias) * apart);
  return true;
}

/* Returns whether the middles of cells are at all whole numbers in *whole. */
static stratus_status make_grid(stratus_context* context, const stratus_transfer* transfer, const stratus_table_values* values, int least,
  stratus_table_entries* t, bool* whole)
{
  double from = stratus_fetching_value(&values->fetching, values->lo), to = stratus_fetching_value(&values->fetching, values->hi);
  t->cut = false;
  if (!values->sums || !values->uniform) {
    table_span(transfer, values->sums, &from, &to, &t->cut);
  }
  const int cells = table_cells(transfer, to - from, least);
  *whole = !values->uniform && place_whole_numbers(t, values, from, to, cells);
  if (*whole) {
    return STRATUS_OK;
  }
  const double width = (to - from) / (cells - 1);
  t->from = from;
  t->width = width;
  t->cells = cells;
  t->scale = width > 0.0 ? (float)(1.0 / width) : 0.0f;
  t->offset = (float)(0.5 - (from - values->fetching.bias) * (double)t->scale);
  if (!isfinite(t->scale) || !isfinite(t->offset)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "values from %g to %g are too close together: floats can't separate %d steps between them", from, to, cells);
  }
  return STRATUS_OK;
}

static int cell_of(const stratus_table_entries* t, float value)
{
  return stratus_grid_cell(t->scale, t->offset, t->cells, value);
}

/* Return the least float from lo to hi with a cell of at least `cell`. hi has such a cell. */
static float cell_begin(const stratus_table_entries* t, float lo, float hi, int cell)
{
  int64_t least = stratus_float_rank(lo), most = stratus_float_rank(hi);
  while (least < most) {
    const int64_t middle = least + (most - least) / 2;
    if (cell_of(t, stratus_float_of_rank(middle)) >= cell) {
      most = middle;
    } else {
      least = middle + 1;
    }
  }
  return stratus_float_of_rank(least);
}

/* ---------------------------------------------------------------- cells to divide */

typedef struct dividing {
  stratus_context* context;
  const stratus_pieces* pieces;
  const stratus_table_values* values;
  const stratus_shown* shown;
  stratus_table_entries* t;
  double* points; /* of opacity and colour, ascending; `count` of them */
  size_t count;
  uint8_t* flags; /* of cells: 1: holds a point; 2: meets a piece that is narrow compared with cells; 4: is divided */
  float* bounds;  /* where the entries of a cell begin */
  size_t bound_count, bound_room;
  bool has_few_floats; /* a cell has so few floats that its middle and theirs differ */
} dividing;

static int compare_doubles(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

static int compare_floats(const void* a, const void* b)
{
  const float x = *(const float*)a, y = *(const float*)b;
  return (x > y) - (x < y);
}

static stratus_status gather_points(dividing* d)
{
  void* memory;
  const stratus_curve *opacity = &d->pieces->opacity, *color = &d->pieces->color[0];
  TRY(stratus_allocate(d->context, opacity->count + color->count, sizeof *d->points, &memory));
  d->points = memory;
  d->count = opacity->count + color->count;
  memcpy(d->points, opacity->x, opacity->count * sizeof *d->points);
  memcpy(d->points + opacity->count, color->x, color->count * sizeof *d->points);
  qsort(d->points, d->count, sizeof *d->points, compare_doubles);
  return STRATUS_OK;
}

/* The float of the values that lies next to `value`, from above. */
static float float_at(const dividing* d, double value)
{
  const float above = stratus_fetching_above(&d->values->fetching, value);
  return fminf(fmaxf(above, d->values->lo), d->values->hi);
}

static void flag_cells(dividing* d)
{
  const stratus_table_values* v = d->values;
  for (size_t i = 0; i < d->count; ++i) {
    const int cell = cell_of(d->t, float_at(d, d->points[i]));
    d->flags[cell] |= 1;
    if (i > 0 && d->points[i] > d->points[i - 1] && d->points[i] - d->points[i - 1] < CELLS_ENOUGH * d->t->width) {
      for (int c = cell_of(d->t, float_at(d, d->points[i - 1])); c <= cell; ++c) {
        d->flags[c] |= 2;
      }
    }
  }
  for (int64_t i = stratus_shown_below(d->shown, v->lo); i < d->shown->count && d->shown->of[i][0] <= v->hi; ++i) {
    d->flags[cell_of(d->t, fmaxf(d->shown->of[i][0], v->lo))] |= 1;
    d->flags[cell_of(d->t, fminf(d->shown->of[i][1], v->hi))] |= 1;
  }
}

/* Finds the floats of the values that are in a cell; returns false if there are none. */
static bool floats_of_cell(const dividing* d, int cell, float* first, float* last)
{
  const stratus_table_values* v = d->values;
  const int low = cell_of(d->t, v->lo), high = cell_of(d->t, v->hi);
  if (cell < low || cell > high) {
    return false;
  }
  *first = cell == low ? v->lo : cell_begin(d->t, v->lo, v->hi, cell);
  *last = cell == high ? v->hi : nextafterf(cell_begin(d->t, *first, v->hi, cell + 1), -INFINITY);
  return *first <= *last;
}

/* The value at which the entry of floats first..last takes the function. A float of a wide type that stands for several values takes the
 * one that shows most. */
static double value_of_entry(const dividing* d, float first, float last)
{
  const stratus_fetching* fetching = &d->values->fetching;
  const double lo = stratus_fetching_value(fetching, first), hi = stratus_fetching_value(fetching, last);
  if (first != last || !fetching->wide) {
    return lo + 0.5 * (hi - lo);
  }
  double best = lo;
  double ends[2] = { 0.5 * ((double)nextafterf(first, -INFINITY) + (double)first) + fetching->bias,
    0.5 * ((double)nextafterf(first, INFINITY) + (double)first) + fetching->bias };
  if (fetching->integer) {
    ends[0] = ceil(ends[0]);
    ends[1] = floor(ends[1]);
  }
  const stratus_curve* opacity = &d->pieces->opacity;
  for (int e = 0; e < 2; ++e) {
    if ((float)(ends[e] - fetching->bias) == first && stratus_curve_at(opacity, ends[e]) > stratus_curve_at(opacity, best)) {
      best = ends[e];
    }
  }
  for (size_t i = stratus_points_until(opacity->x, opacity->count, ends[0]); i < opacity->count && opacity->x[i] <= ends[1]; ++i) {
    const double x = fetching->integer ? ceil(opacity->x[i]) : opacity->x[i];
    if ((float)(x - fetching->bias) == first && opacity->at[i] > stratus_curve_at(opacity, best)) {
      best = x;
    }
  }
  return best;
}

/* The value at which an undivided cell takes the function. */
static double middle_of_cell(const dividing* d, int cell)
{
  float first, last;
  return d->has_few_floats && floats_of_cell(d, cell, &first, &last) ? value_of_entry(d, first, last) : d->t->from + cell * d->t->width;
}

/* Return by how much a value may exceed the value of the float that it is fetched as. */
static double reach_of(const dividing* d, float first, float last)
{
  return d->values->fetching.wide ? fmax(fabs((double)first), fabs((double)last)) * 0x1p-23 : 0.0;
}

/* True if the curve has a vertical step in (lo, hi]. */
static bool steps_within(const stratus_curve* curve, double lo, double hi)
{
  for (size_t i = stratus_points_until(curve->x, curve->count, lo); i < curve->count && curve->x[i] <= hi; ++i) {
    if (curve->at[i] != curve->left[i]) {
      return true;
    }
  }
  return false;
}

static double depth_of(double opacity)
{
  return opacity >= 1.0 ? OPAQUE_TAU : -log1p(-opacity);
}

/* True if one entry can't stand for the floats first..last of a cell. middle: the value at which it would take the function. */
static bool is_mixed(const dividing* d, float first, float last, double middle, int flags)
{
  const stratus_curve *opacity = &d->pieces->opacity, *color = d->pieces->color;
  const double lo = stratus_fetching_value(&d->values->fetching, first), hi = stratus_fetching_value(&d->values->fetching, last);
  double range[2];
  if (!stratus_shown_meets(d->shown, first, last) || first == last) {
    return false;
  }
  const double reach = reach_of(d, first, last);
  if (steps_within(opacity, lo - reach, hi + reach)) {
    return true;
  }
  for (int c = 0; c < 3; ++c) {
    stratus_curve_extremes(&color[c], lo, hi, range);
    if (steps_within(&color[c], lo - reach, hi + reach) || range[1] - range[0] > CHANGE_SMALL) {
      return true;
    }
  }
  stratus_curve_extremes(opacity, lo, hi, range);
  if (range[1] >= 1.0 && range[0] < 1.0 && !(stratus_curve_at(opacity, middle) >= 1.0)) {
    return true; /* opacity 1 is another matter than almost 1 */
  }
  const int64_t at = stratus_shown_below(d->shown, first);
  const bool part = d->shown->of[at][0] > first || d->shown->of[at][1] < last;
  return (flags & 2) && (part || depth_of(range[1]) - depth_of(range[0]) > CHANGE_SMALL * depth_of(range[1]));
}

/* ---------------------------------------------------------------- the entries of a divided cell */

static stratus_status add_bound(dividing* d, float bound)
{
  if (d->bound_count == d->bound_room) {
    void* memory;
    const size_t room = 2 * d->bound_room + 64;
    TRY(stratus_allocate(d->context, room, sizeof *d->bounds, &memory));
    if (d->bounds) {
      memcpy(memory, d->bounds, d->bound_count * sizeof *d->bounds);
    }
    stratus_release(d->context, d->bounds);
    d->bounds = memory;
    d->bound_room = room;
  }
  d->bounds[d->bound_count++] = bound;
  return STRATUS_OK;
}

static size_t sort_bounds(float* bounds, size_t count)
{
  size_t kept = 0;
  qsort(bounds, count, sizeof *bounds, compare_floats);
  for (size_t i = 0; i < count; ++i) {
    if (kept == 0 || bounds[i] > bounds[kept - 1]) {
      bounds[kept++] = bounds[i];
    }
  }
  return kept;
}

/* Adds the floats at which pieces of the function begin. Of wide types, floats that stand for values on both sides are entries of their
 * own. */
static stratus_status bound_point(dividing* d, double x, float first, float last)
{
  const stratus_fetching* fetching = &d->values->fetching;
  const float above = stratus_fetching_above(fetching, x);
  float from = above, to = above;
  if (fetching->wide) {
    const double at = fetching->integer ? ceil(x) : x, before = fetching->integer ? at - 1.0 : nextafter(x, -INFINITY);
    from = fminf(above, (float)(at - fetching->bias));
    to = fmaxf(above, nextafterf((float)(before - fetching->bias), INFINITY));
  } else if (stratus_fetching_value(fetching, above) == x) { /* only the point may have opacity 1 or 0 */
    const double opacity = stratus_curve_at(&d->pieces->opacity, x);
    to = opacity <= 0.0 || opacity >= 1.0 ? nextafterf(above, INFINITY) : above;
  }
  for (float bound = from; bound <= to; bound = nextafterf(bound, INFINITY)) {
    if (bound > first && bound <= last) {
      TRY(add_bound(d, bound));
    }
  }
  return STRATUS_OK;
}

/* Add bounds between the floats first..last of one piece, so that its opacity and colours change little in each part. */
static stratus_status bound_ramp(dividing* d, float first, float last)
{
  const double lo = stratus_fetching_value(&d->values->fetching, first), hi = stratus_fetching_value(&d->values->fetching, last);
  double opacity[2], color[2], change = 0.0;
  stratus_curve_extremes(&d->pieces->opacity, lo, hi, opacity);
  if (!(opacity[1] > 0.0) || first == last) {
    return STRATUS_OK;
  }
  for (int c = 0; c < 3; ++c) {
    stratus_curve_extremes(&d->pieces->color[c], lo, hi, color);
    change = fmax(change, color[1] - color[0]);
  }
  change = fmax(change, (depth_of(opacity[1]) - depth_of(opacity[0])) / depth_of(opacity[1]));
  const int parts = (int)fmin(ceil(PARTS_A_RAMP * change), PARTS_A_RAMP);
  for (int part = 1; part < parts; ++part) {
    const float bound = stratus_fetching_above(&d->values->fetching, lo + (hi - lo) * part / parts);
    if (bound > first && bound <= last) {
      TRY(add_bound(d, bound));
    }
  }
  return STRATUS_OK;
}

/* Adds the bounds of the entries in a cell, of which first..last are the floats, beginning with `first`. */
static stratus_status bound_cell(dividing* d, float first, float last)
{
  const double lo = stratus_fetching_value(&d->values->fetching, first), hi = stratus_fetching_value(&d->values->fetching, last);
  const size_t begin = d->bound_count;
  TRY(add_bound(d, first));
  /* Of wide types, the neighbours' points may be fetched as floats of this cell. */
  const double reach = d->values->fetching.wide ? reach_of(d, first, last) + 1.0 : 0.0;
  for (size_t i = stratus_points_until(d->points, d->count, nextafter(lo - reach, -INFINITY)); i < d->count && d->points[i] <= hi + reach;
       ++i) {
    if (i == 0 || d->points[i] > d->points[i - 1]) {
      TRY(bound_point(d, d->points[i], first, last));
    }
  }
  for (int64_t i = stratus_shown_below(d->shown, first); i < d->shown->count && d->shown->of[i][0] <= last; ++i) {
    if (d->shown->of[i][0] > first) {
      TRY(add_bound(d, d->shown->of[i][0]));
    }
    if (d->shown->of[i][1] < last) {
      TRY(add_bound(d, nextafterf(d->shown->of[i][1], INFINITY)));
    }
  }
  d->bound_count = begin + sort_bounds(d->bounds + begin, d->bound_count - begin);
  const size_t whole = d->bound_count;
  for (size_t i = begin; i < whole; ++i) {
    TRY(bound_ramp(d, d->bounds[i], i + 1 < whole ? nextafterf(d->bounds[i + 1], -INFINITY) : last));
  }
  d->bound_count = begin + sort_bounds(d->bounds + begin, d->bound_count - begin);
  return STRATUS_OK;
}

/* ---------------------------------------------------------------- all entries */

static stratus_status choose_cells(dividing* d, int* divided)
{
  void* memory;
  *divided = 0;
  TRY(gather_points(d));
  TRY(stratus_allocate_zero(d->context, (size_t)d->t->cells, 1, &memory));
  d->flags = memory;
  flag_cells(d);
  for (int c = 0; c < d->t->cells; ++c) {
    float first, last;
    if (d->flags[c] && floats_of_cell(d, c, &first, &last) && is_mixed(d, first, last, middle_of_cell(d, c), d->flags[c])) {
      d->flags[c] |= 4;
      ++*divided;
    }
  }
  return STRATUS_OK;
}

static stratus_status allocate_entries(dividing* d, size_t size, bool divided)
{
  stratus_table_entries* t = d->t;
  void* memory;
  TRY(stratus_allocate(d->context, size, sizeof *t->value, &memory));
  t->value = memory;
  TRY(stratus_allocate_zero(d->context, size, sizeof *t->shows, &memory));
  t->shows = memory;
  if (divided) {
    TRY(stratus_allocate(d->context, size, sizeof *t->wide, &memory));
    t->wide = memory;
    TRY(stratus_allocate(d->context, size, sizeof *t->bound, &memory));
    t->bound = memory;
  }
  t->size = (int)size;
  return STRATUS_OK;
}

/* Divides cells: first their bounds, one cell's behind the other's, then the entries. */
static stratus_status divide(dividing* d)
{
  stratus_table_entries* t = d->t;
  void* memory;
  TRY(stratus_allocate(d->context, (size_t)t->cells + 1, sizeof *t->first, &memory));
  t->first = memory;
  size_t size = 0, most = 1;
  for (int c = 0; c < t->cells; ++c) {
    float first, last;
    const size_t before = d->bound_count;
    t->first[c] = (int32_t)size;
    if ((d->flags[c] & 4) && floats_of_cell(d, c, &first, &last)) {
      TRY(bound_cell(d, first, last));
    }
    const size_t here = d->bound_count > before ? d->bound_count - before : 1;
    most = here > most ? here : most;
    size += here;
    if (size > STRATUS_TABLE_MOST) {
      return stratus_fail(d->context, STRATUS_UNSUPPORTED, "the transfer function of %zu points needs more than %d entries of a table",
        d->count, STRATUS_TABLE_MOST);
    }
  }
  t->first[t->cells] = (int32_t)size;
  while ((size_t)1 << t->steps < most) {
    ++t->steps;
  }
  TRY(allocate_entries(d, size, true));
  size_t bound = 0;
  for (int c = 0; c < t->cells; ++c) {
    float first = 0.0f, last = 0.0f;
    const int begin = t->first[c], beyond = t->first[c + 1];
    const bool is_divided = (d->flags[c] & 4) && floats_of_cell(d, c, &first, &last);
    for (int e = begin; e < beyond; ++e) {
      t->bound[e] = is_divided ? d->bounds[bound++] : -INFINITY;
      t->value[e] = middle_of_cell(d, c);
      t->wide[e] = t->width;
    }
    for (int e = begin; is_divided && e < beyond; ++e) {
      const float end = e + 1 < beyond ? t->bound[e + 1] : nextafterf(last, INFINITY);
      t->value[e] = value_of_entry(d, t->bound[e], nextafterf(end, -INFINITY));
      t->wide[e] = (double)end - (double)t->bound[e];
    }
  }
  return STRATUS_OK;
}

static int entry_of(const stratus_table_entries* t, float value)
{
  const int cell = cell_of(t, value);
  if (!t->first) {
    return cell;
  }
  return stratus_entry_within(t->bound, t->first[cell], t->first[cell + 1], value);
}

/* Marks the entries of which all floats show; nearest, and middles that are whole numbers: of which the middle shows. */
static void mark_shown(const dividing* d, bool middles)
{
  stratus_table_entries* t = d->t;
  const stratus_table_values* v = d->values;
  for (int64_t i = stratus_shown_below(d->shown, v->lo); i < d->shown->count && d->shown->of[i][0] <= v->hi; ++i) {
    const float lo = fmaxf(d->shown->of[i][0], v->lo), hi = fminf(d->shown->of[i][1], v->hi);
    int first = entry_of(t, lo), last = entry_of(t, hi);
    if (middles) {
      first += t->value[first] - v->fetching.bias < (double)lo;
      last -= t->value[last] - v->fetching.bias > (double)hi;
    } else {
      first += lo > v->lo && entry_of(t, nextafterf(lo, -INFINITY)) == first;
      last -= hi < v->hi && entry_of(t, nextafterf(hi, INFINITY)) == last;
    }
    for (int e = first; e <= last; ++e) {
      t->shows[e] = 1;
    }
  }
}

stratus_status stratus_table_entries_create(stratus_context* context, const stratus_transfer* transfer, const stratus_pieces* pieces,
  const stratus_table_values* values, int least, stratus_table_entries* t)
{
  stratus_status status = STRATUS_OK;
  stratus_shown shown = { .of = NULL };
  dividing d = { .context = context, .pieces = pieces, .values = values, .shown = &shown, .t = t };
  bool whole;
  int divided = 0;
  *t = (stratus_table_entries){ .cells = 0 };
  TRY_CLEANUP(make_grid(context, transfer, values, least, t, &whole));
  TRY_CLEANUP(stratus_shown_of_transfer(context, &values->fetching, transfer, &shown));
  const bool middles = whole && values->nearest;
  d.has_few_floats = !whole && !values->uniform && t->width < FEW_FLOATS * fmax(fabs((double)values->lo), fabs((double)values->hi));
  if (!middles && !values->uniform) {
    TRY_CLEANUP(choose_cells(&d, &divided));
  }
  if (divided > 0) {
    TRY_CLEANUP(divide(&d));
  } else {
    TRY_CLEANUP(allocate_entries(&d, (size_t)t->cells, false));
    for (int e = 0; e < t->size; ++e) {
      t->value[e] = middle_of_cell(&d, e);
    }
  }
  if (values->uniform) {
    memset(t->shows, 1, (size_t)t->size);
  } else {
    mark_shown(&d, middles);
  }
cleanup:
  stratus_release(context, shown.of);
  stratus_release(context, d.points);
  stratus_release(context, d.flags);
  stratus_release(context, d.bounds);
  if (status != STRATUS_OK) {
    stratus_table_entries_release(context, t);
  }
  return status;
}

void stratus_table_entries_release(stratus_context* context, stratus_table_entries* t)
{
  stratus_release(context, t->first);
  stratus_release(context, t->bound);
  stratus_release(context, t->value);
  stratus_release(context, t->wide);
  stratus_release(context, t->shows);
  *t = (stratus_table_entries){ .cells = 0 };
}
