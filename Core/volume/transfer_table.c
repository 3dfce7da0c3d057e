/* SPDX-License-Identifier: BSD-3-Clause
 * The transfer function as traversal samples it: a table over the data's values. An entry holds the function at the entry's middle
 * (midpoint sampling), or running sums of it (pre-integration; Engel, Kraus & Ertl 2001, in the cumulative form). */
#include "table_arguments.h"
#include "table_entries.h"
#include "table_stretches.h"

#include <string.h>

/* Least number of the grid's cells by sampling. */
#define MIDPOINT_ENTRIES 4096
#define PREINTEGRATED_ENTRIES 16384
#define MOST_ENTRIES 65536
/* The tolerance for which these are enough. A value is off by up to half an entry, so that half the tolerance needs twice as many. */
#define ENTRIES_TOLERANCE 1e-3
/* The width of all values in units. Running sums hold features as narrow as one unit. */
#define WIDTH_UNITS (1 << 29)
/* Optical depth of a midpoint sample of opacity 1, instead of infinity. Even the smallest part of such a sample stays opaque, as long as it
 * is above 0 as a float. */
#define OPAQUE_DEPTH 1e30f
/* Optical depth per unit distance of entries of opacity 1, instead of infinity, which running sums cannot hold. fill_opaque() marks these
 * entries, since opacities just below 1 may be deeper. */
#define OPAQUE_TAU 16.0
/* Bound on the optical depth per length, which keeps sums finite if the unit of length is tiny. */
#define TAU_MOST 1e290
/* Entries that a thread fills at a time. */
#define ENTRIES_A_THREAD 2048
/* Largest running sum: differences of sums are positive ints. */
#define SUM_MOST 2147483000.0

stratus_transfer stratus_transfer_default(void)
{
  return (stratus_transfer){ .unit_distance = 1.0, .clamp = 1, .weight = 1.0 };
}

static stratus_status check_points(stratus_context* context, const char* what, const double* points, size_t count, size_t width)
{
  if (!points || count == 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s function has %zu points, needs at least 1", what, points ? count : 0);
  }
  TRY(stratus_array_check(context, "points of a transfer function", count, width * sizeof *points));
  for (size_t i = 0; i < count; ++i) {
    const double* point = points + i * width;
    if (!isfinite(point[0])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s point %zu has value %g, must be finite", what, i, point[0]);
    }
    if (i > 0 && point[0] < point[-(ptrdiff_t)width]) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s point %zu has value %g, must be at least its predecessor's %g", what, i,
        point[0], point[-(ptrdiff_t)width]);
    }
    for (size_t c = 1; c < width; ++c) {
      if (!(point[c] >= 0.0 && point[c] <= 1.0)) {
        return stratus_fail(
          context, STRATUS_INVALID_ARGUMENT, "%s point %zu at value %g has component %g outside 0..1", what, i, point[0], point[c]);
      }
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_transfer_check(stratus_context* context, const stratus_transfer* transfer)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!transfer) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "transfer function is NULL");
  }
  TRY(check_points(context, "opacity", transfer->opacity, transfer->opacity_count, 2));
  TRY(check_points(context, "colour", transfer->color, transfer->color_count, 4));
  if (transfer->gradient_count > 0) {
    TRY(check_points(context, "gradient opacity", transfer->gradient, transfer->gradient_count, 2));
  }
  if (!(transfer->unit_distance > 0.0 && isfinite(transfer->unit_distance))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "unit distance %g, must be positive and finite", transfer->unit_distance);
  }
  return STRATUS_OK;
}

/* Move *at to the last point with value <= x, or to -1. Calls mostly have rising x, and *at begins at -1. The values of entries may fall: a
 * cell that no float is in has its own middle, and its neighbours have their floats' middles. */
static void walk_to(const double* points, size_t count, size_t width, double x, ptrdiff_t* at)
{
  while (*at >= 0 && points[(size_t)*at * width] > x) {
    --*at;
  }
  while (*at + 1 < (ptrdiff_t)count && points[(size_t)(*at + 1) * width] <= x) {
    ++*at;
  }
}

/* Returns the piecewise linear function at x. *at: as in walk_to(). */
static double walk(const double* points, size_t count, size_t width, size_t component, double x, ptrdiff_t* at)
{
  walk_to(points, count, width, x, at);
  if (*at < 0) {
    return points[component];
  }
  const double* left = points + (size_t)*at * width;
  if (*at + 1 == (ptrdiff_t)count) {
    return left[component];
  }
  const double* right = left + width;
  const double t = stratus_part_between(x, left[0], right[0]);
  return left[component] + t * (right[component] - left[component]);
}

static bool outside(const stratus_transfer* transfer, double x)
{
  return !transfer->clamp && (x < transfer->opacity[0] || x > transfer->opacity[2 * (transfer->opacity_count - 1)]);
}

/* Returns the last point with value <= x, or -1. */
static ptrdiff_t last_point(const double* points, size_t count, size_t width, double x)
{
  size_t lo = 0, hi = count;
  while (lo < hi) {
    const size_t middle = (lo + hi) / 2;
    if (points[middle * width] <= x) {
      lo = middle + 1;
    } else {
      hi = middle;
    }
  }
  return (ptrdiff_t)lo - 1;
}

void stratus_transfer_at(const stratus_transfer* transfer, double value, double rgba[4])
{
  ptrdiff_t at = last_point(transfer->opacity, transfer->opacity_count, 2, value);
  ptrdiff_t color_at = last_point(transfer->color, transfer->color_count, 4, value);
  for (size_t c = 0; c < 3; ++c) {
    rgba[c] = walk(transfer->color, transfer->color_count, 4, c + 1, value, &color_at);
  }
  rgba[3] = outside(transfer, value) ? 0.0 : walk(transfer->opacity, transfer->opacity_count, 2, 1, value, &at);
}

/* Returns the optical depth per world unit. */
static double tau_of(const stratus_transfer* transfer, double opacity)
{
  return fmin((opacity >= 1.0 ? OPAQUE_TAU : opacity > 0.0 ? -log1p(-opacity) : 0.0) / transfer->unit_distance, TAU_MOST);
}

static void fill_midpoint(
  stratus_table* table, const stratus_transfer* transfer, const stratus_table_entries* entries, double sample_distance)
{
  ptrdiff_t at = -1, color_at[3] = { -1, -1, -1 };
  for (int e = 0; e < table->size; ++e) {
    const double x = entries->value[e];
    double opacity = walk(transfer->opacity, transfer->opacity_count, 2, 1, x, &at);
    opacity = !entries->shows[e] || outside(transfer, x) ? 0.0 : opacity;
    const double alpha = opacity > 0.0 ? -expm1(log1p(-opacity) * sample_distance / transfer->unit_distance) : 0.0;
    float* entry = table->rgba + 4 * (size_t)e;
    for (size_t c = 0; c < 3; ++c) {
      entry[c] = (float)(alpha * walk(transfer->color, transfer->color_count, 4, c + 1, x, &color_at[c]));
    }
    entry[3] = (float)alpha;
    float* depth = table->rgba + 4 * ((size_t)table->size + (size_t)e);
    depth[0] = opacity >= 1.0 ? OPAQUE_DEPTH : (float)fmin(tau_of(transfer, opacity) * sample_distance, (double)OPAQUE_DEPTH);
    depth[1] = depth[2] = depth[3] = 0.0f;
  }
}

int stratus_table_unit(const stratus_table* table)
{
  return table->search_steps ? WIDTH_UNITS / table->cells : 1;
}

/* Fills the row of widths: running sums of whole units, at least 1 an entry. Cell c begins at c units of a cell, unless entries that are
 * too narrow for the unit fill more than the cell. */
static void fill_widths(stratus_table* table, const stratus_table_entries* entries)
{
  int32_t* widths = table->sums + stratus_table_widths_at(table);
  const int unit = stratus_table_unit(table);
  widths[0] = 0;
  for (int c = 0; c < table->cells; ++c) {
    double whole = 0.0, within = 0.0;
    for (int e = entries->first[c]; e < entries->first[c + 1]; ++e) {
      whole += entries->wide[e];
    }
    for (int e = entries->first[c]; e < entries->first[c + 1]; ++e) {
      within += entries->wide[e];
      const int32_t end = c * unit + (int32_t)(whole > 0.0 && isfinite(whole) ? within / whole * unit : unit);
      widths[e + 1] = end > widths[e] ? end : widths[e] + 1;
    }
  }
}

static double width_of(const stratus_table* table, int e)
{
  const int32_t* widths = table->search_steps ? table->sums + stratus_table_widths_at(table) : NULL;
  return widths ? (double)(widths[e + 1] - widths[e]) : 1.0;
}

/* The numbers from which running sums are made, over a part of the entries. */
typedef struct sum_part {
  double least[3], most[3], steepest; /* of colours where the function shows */
} sum_part;

/* Writes what entries first..last-1 add to the four running sums. An entry is the function at one value, not the mean over its width: a
 * transparent value must stay transparent next to one that shows. */
static void fill_addends(const stratus_table* table, const stratus_transfer* transfer, const stratus_table_entries* entries, int first,
  int last, double* sums, sum_part* part)
{
  const double begin = entries->value[first > 0 ? first - 1 : 0];
  ptrdiff_t at = last_point(transfer->opacity, transfer->opacity_count, 2, begin), color_at[3];
  double before[3] = { 0 }, tau_before = 0.0, width_before = 0.0;
  color_at[0] = color_at[1] = color_at[2] = last_point(transfer->color, transfer->color_count, 4, begin);
  *part = (sum_part){ .least = { 1.0, 1.0, 1.0 } };
  for (int e = first > 0 ? first - 1 : 0; e < last; ++e) { /* the entry before the part shows how steep colours are */
    const double x = entries->value[e], opacity = walk(transfer->opacity, transfer->opacity_count, 2, 1, x, &at);
    const double tau = !entries->shows[e] || outside(transfer, x) ? 0.0 : tau_of(transfer, opacity), width = width_of(table, e);
    double addends[4];
    for (size_t c = 0; c < 3; ++c) {
      const double color = walk(transfer->color, transfer->color_count, 4, c + 1, x, &color_at[c]);
      if (e > 0 && e >= first && tau + tau_before > 0.0) {
        part->steepest = fmax(part->steepest, fabs(color - before[c]) / (0.5 * (width + width_before)));
        part->least[c] = fmin(part->least[c], fmin(color, before[c]));
        part->most[c] = fmax(part->most[c], fmax(color, before[c]));
      }
      before[c] = color;
      addends[c] = tau * color * width;
    }
    addends[3] = tau * width;
    if (e >= first) {
      memcpy(sums + 4 * ((size_t)e + 1), addends, sizeof addends);
    }
    tau_before = tau;
    width_before = width;
  }
}

/* Writes the four running sums in doubles, and the table's color_slope and color_most. Threads share the entries; the sums run in order, so
 * that their number changes no bit. */
static void fill_sums(stratus_table* table, const stratus_transfer* transfer, const stratus_table_entries* entries, double* sums)
{
  sum_part whole = { .least = { 1.0, 1.0, 1.0 } };
  const int parts = (table->size + ENTRIES_A_THREAD - 1) / ENTRIES_A_THREAD;
#pragma omp parallel for num_threads(table->context->threads) schedule(static) if (parts > 1)
  for (int p = 0; p < parts; ++p) {
    const int first = p * ENTRIES_A_THREAD, last = first + ENTRIES_A_THREAD;
    sum_part part;
    fill_addends(table, transfer, entries, first, last < table->size ? last : table->size, sums, &part);
#pragma omp critical(stratus_table_parts)
    {
      whole.steepest = fmax(whole.steepest, part.steepest);
      for (int c = 0; c < 3; ++c) {
        whole.least[c] = fmin(whole.least[c], part.least[c]);
        whole.most[c] = fmax(whole.most[c], part.most[c]);
      }
    }
  }
  memset(sums, 0, 4 * sizeof *sums);
  for (size_t i = 4; i < 4 * ((size_t)table->size + 1); ++i) {
    sums[i] += sums[i - 4];
  }
  const double change = fmax(fmax(whole.most[0] - whole.least[0], whole.most[1] - whole.least[1]), whole.most[2] - whole.least[2]);
  table->color_slope = (float)((double)TABLE_COLOR_ERROR_INVERSE * whole.steepest);
  table->color_most = (float)((double)TABLE_COLOR_ERROR_INVERSE * fmax(change, 0.0));
}

/* True if the function is 1 not only at `value`, where it is known to be 1, but over an interval. *at: a point below the value, kept
 * between calls with values that mostly rise. */
static bool stays_opaque(const stratus_transfer* transfer, double value, size_t* at)
{
  const double* p = transfer->opacity;
  const size_t last = transfer->opacity_count - 1;
  while (*at > 0 && p[2 * *at] >= value) { /* as walk_to() */
    --*at;
  }
  while (*at < last && p[2 * *at + 2] < value) {
    ++*at;
  }
  bool stays = transfer->clamp && (value < p[0] || value > p[2 * last]);
  for (size_t i = *at; i < last && p[2 * i] <= value; ++i) {
    stays |= p[2 * i + 1] >= 1.0 && p[2 * i + 3] >= 1.0 && p[2 * i] < p[2 * i + 2];
  }
  return stays;
}

/* Fill the two rows after the sums, which show where rays meet opacity 1. For an entry of opacity 1 both rows hold the entry itself. For
 * any other, the first row holds the next entry upwards where the function stays 1 over an interval, or `size`; the second row holds the
 * next one downwards, or -1. A ray at an entry of opacity 1 stops at once. A ray that passes to other entries stops at the first where the
 * function stays 1. Where the function only touches 1, the optical depth is also infinite, but only logarithmically: it adds little to rays
 * that pass, and everything to rays that stay. */
static void fill_opaque(stratus_table* table, const stratus_transfer* transfer, const stratus_table_entries* entries)
{
  const int size = table->size;
  int32_t *up = table->sums + 4 * ((size_t)size + 1), *down = up + size;
  ptrdiff_t at = -1;
  size_t below = 0;
  for (int e = 0, last = -1; e < size; ++e) {
    const double x = entries->value[e], opacity = walk(transfer->opacity, transfer->opacity_count, 2, 1, x, &at);
    const bool opaque = opacity >= 1.0 && entries->shows[e] && !outside(transfer, x), stays = opaque && stays_opaque(transfer, x, &below);
    last = stays ? e : last;
    down[e] = opaque ? e : last;
    up[e] = stays ? e : size;
    table->has_opaque |= opaque;
  }
  for (int e = size - 1, next = size; e >= 0; --e) {
    next = up[e] == e ? e : next;
    up[e] = down[e] == e ? e : next;
  }
}

/* Copies the stretches behind all other words, with optical depths in units of the running sums. */
static void fill_stretches(stratus_table* table, const stratus_transfer* transfer, const stratus_table_stretch* stretches)
{
  for (int s = 0; table->stretches > 0 && s <= table->stretches; ++s) {
    const double tau = tau_of(transfer, (double)stretches[s].opacity);
    stratus_table_stretch stretch = stretches[s];
    stretch.opacity = table->tau_per_sum > 0.0 ? (float)(tau / table->tau_per_sum) : 0.0f;
    memcpy(table->sums + stratus_table_stretches_at(table) + ((size_t)s << TABLE_STRETCH_LOG2), &stretch, sizeof stretch);
  }
}

void stratus_table_set_distance(stratus_table* table, double sample_distance)
{
  table->sum_scale = (float)fmin(sample_distance * table->tau_per_sum, (double)OPAQUE_DEPTH);
}

static stratus_status fill_preintegrated(
  stratus_table* table, const stratus_transfer* transfer, const stratus_table_entries* entries, double sample_distance)
{
  const size_t words = 4 * ((size_t)table->size + 1);
  void* memory = NULL;
  TRY(stratus_allocate(table->context, words, sizeof(double), &memory));
  double* sums = memory;
  if (table->search_steps) {
    fill_widths(table, entries);
  }
  fill_sums(table, transfer, entries, sums);
  const size_t row = words / 4;
  const double total = sums[words - 1], scale = total > 0.0 ? (SUM_MOST - table->size) / total : 0.0;
  const bool any = total > 0.0 && isfinite(scale);
  int64_t tau = 0;
  for (size_t e = 0; e < row; ++e) {
    for (size_t which = 0; which < 3; ++which) {
      table->sums[4 * e + which] = any ? (int32_t)llrint(sums[4 * e + which] * scale) : 0;
    }
    if (e > 0 && any) { /* an entry that shows raises the sum by at least 1, however faint it is compared with the rest */
      const int64_t rounded = llrint(sums[4 * e + 3] * scale), least = tau + (sums[4 * e + 3] > sums[4 * e - 1]);
      tau = rounded > least ? rounded : least;
    }
    table->sums[4 * e + 3] = (int32_t)tau;
  }
  table->tau_per_sum = any ? 1.0 / scale : 0.0;
  stratus_table_set_distance(table, sample_distance);
  fill_opaque(table, transfer, entries);
  stratus_release(table->context, sums);
  return STRATUS_OK;
}

static bool entry_shows(const stratus_table* table, int e)
{
  const size_t at = 4 * (size_t)e + 3;
  return table->rgba ? table->rgba[at] > 0.0f : table->sums[at + 4] > table->sums[at];
}

static void fill_next_shown(stratus_table* table)
{
  table->shown = 0;
  table->last_shown = -1;
  table->next_shown[table->size] = table->size;
  for (int e = table->size - 1; e >= 0; --e) {
    const bool shows = entry_shows(table, e);
    table->shown += shows;
    table->last_shown = shows && table->last_shown < 0 ? e : table->last_shown;
    table->next_shown[e] = shows ? e : table->next_shown[e + 1];
  }
}

stratus_table_values stratus_table_values_of(const stratus_value_range* ranges, bool nearest)
{
  const bool any = ranges->whole_lo <= ranges->whole_hi;
  return (stratus_table_values){ .fetching = stratus_value_range_fetching(ranges),
    .lo = any ? ranges->whole_lo : 0.0f,
    .hi = any ? ranges->whole_hi : 0.0f,
    .nearest = nearest };
}

int stratus_table_entries_for(stratus_sampling sampling, double tolerance)
{
  int entries = sampling == STRATUS_SAMPLING_PREINTEGRATED ? PREINTEGRATED_ENTRIES : MIDPOINT_ENTRIES;
  for (double allowed = ENTRIES_TOLERANCE; entries < MOST_ENTRIES && tolerance < 0.75 * allowed; allowed *= 0.5) {
    entries *= 2;
  }
  return entries;
}

stratus_status stratus_table_create(stratus_context* context, const stratus_transfer* transfer, const stratus_table_values* values,
  stratus_sampling sampling, double sample_distance, stratus_table** out)
{
  const int entries = stratus_table_entries_for(sampling, ENTRIES_TOLERANCE);
  return stratus_table_create_fine(context, transfer, values, sampling, sample_distance, entries, out);
}

/* Allocates the table's arrays, and copies what finds an entry. */
static stratus_status allocate_table(stratus_table* table, const stratus_table_entries* entries, bool preintegrated)
{
  void* memory = NULL;
  TRY(stratus_allocate(table->context, (size_t)table->size + 1, sizeof *table->next_shown, &memory));
  table->next_shown = memory;
  table->preintegrated = preintegrated;
  TRY(stratus_allocate(table->context, stratus_table_words(table), sizeof *table->sums, &memory));
  table->sums = preintegrated ? memory : NULL;
  table->rgba = preintegrated ? NULL : memory;
  if (table->search_steps) {
    int32_t* words = memory;
    memcpy(words + stratus_table_first_at(table), entries->first, ((size_t)table->cells + 1) * sizeof *words);
    memcpy(words + stratus_table_bound_at(table), entries->bound, (size_t)table->size * sizeof *entries->bound);
    table->first = words + stratus_table_first_at(table);
    table->bound = (const float*)(words + stratus_table_bound_at(table));
  }
  return STRATUS_OK;
}

/* Move points that are at the number above a float, which is not whole, onto that float. */
static void settle(const double* points, size_t count, size_t width)
{
  for (double* x = (double*)points; count > 0; x += width, --count) {
    const double least = (double)(float)*x;
    *x = least < *x && nextafter(least, INFINITY) == *x && least != floor(least) ? least : *x;
  }
}

/* Copy a function for values that are whole numbers. VTK holds the value left of a step at the step, so that a translated function has its
 * step at the next number. Whole numbers make no difference, and between two of them a ray hardly ever meets that one float. But a label
 * window's step is now at the border of the grid's cells, and no cell need be divided. */
static stratus_status copy_settled(stratus_context* context, const stratus_transfer* transfer, stratus_transfer** copy)
{
  TRY(stratus_transfer_copy(context, transfer, 1, copy));
  settle((*copy)->opacity, (*copy)->opacity_count, 2);
  settle((*copy)->color, (*copy)->color_count, 4);
  return STRATUS_OK;
}

/* Whether the function changes between two points that are nearer than `width`. */
static bool has_jumps(const double* points, size_t count, size_t stride, double width)
{
  bool jumps = false;
  for (size_t i = stride; i < count * stride; i += stride) {
    const bool changes = memcmp(points + i - stride + 1, points + i + 1, (stride - 1) * sizeof *points) != 0;
    jumps = jumps || (changes && points[i] - points[i - stride] < width);
  }
  return jumps;
}

stratus_status stratus_table_create_fine(stratus_context* context, const stratus_transfer* transfer, const stratus_table_values* given,
  stratus_sampling sampling, double sample_distance, int least, stratus_table** out)
{
  stratus_table_values values = *given;
  stratus_status status = STRATUS_OK;
  stratus_table* table = NULL;
  stratus_pieces* pieces = NULL;
  stratus_transfer* settled = NULL;
  stratus_table_entries entries = { .cells = 0 };
  stratus_table_stretch* stretches = NULL;
  void* memory = NULL;

  values.sums = sampling == STRATUS_SAMPLING_PREINTEGRATED;
  if (values.fetching.integer && !values.fetching.wide) {
    TRY_CLEANUP(copy_settled(context, transfer, &settled));
    transfer = settled;
  }
  TRY_CLEANUP(stratus_pieces_create(context, transfer, &pieces));
  TRY_CLEANUP(stratus_table_entries_create(context, transfer, pieces, &values, least, &entries));
  TRY_CLEANUP(stratus_allocate_zero(context, 1, sizeof *table, &memory));
  table = memory;
  table->context = context;
  table->size = entries.size;
  table->cells = entries.cells;
  table->scale = entries.scale;
  table->offset = entries.offset;
  table->search_steps = entries.steps;
  table->jumps = entries.steps > 0 || has_jumps(transfer->opacity, transfer->opacity_count, 2, entries.width) ||
    has_jumps(transfer->color, transfer->color_count, 4, entries.width);
  table->cut = entries.cut;
  if (table->jumps && sampling == STRATUS_SAMPLING_PREINTEGRATED) {
    TRY_CLEANUP(stratus_table_stretches_create(context, pieces, &values, &stretches, &table->stretches));
    while (table->stretches > 1 << table->stretch_steps) {
      ++table->stretch_steps;
    }
  }
  TRY_CLEANUP(allocate_table(table, &entries, sampling == STRATUS_SAMPLING_PREINTEGRATED));
  if (table->sums) {
    TRY_CLEANUP(fill_preintegrated(table, transfer, &entries, sample_distance));
    fill_stretches(table, transfer, stretches);
  } else {
    fill_midpoint(table, transfer, &entries, sample_distance);
  }
  fill_next_shown(table);
  *out = table;
  table = NULL;

cleanup:
  stratus_table_entries_release(context, &entries);
  stratus_release(context, stretches);
  stratus_pieces_destroy(pieces);
  stratus_release(context, settled);
  stratus_table_destroy(table);
  return status;
}

size_t stratus_table_widths_at(const stratus_table* table)
{
  return table->preintegrated ? 6 * (size_t)table->size + 4 : 8 * (size_t)table->size;
}

size_t stratus_table_first_at(const stratus_table* table)
{
  return stratus_table_widths_at(table) + (table->preintegrated ? (size_t)table->size + 1 : 0);
}

size_t stratus_table_bound_at(const stratus_table* table)
{
  return stratus_table_first_at(table) + (size_t)table->cells + 1;
}

size_t stratus_table_stretches_at(const stratus_table* table)
{
  return table->search_steps ? stratus_table_bound_at(table) + (size_t)table->size : stratus_table_widths_at(table);
}

size_t stratus_table_words(const stratus_table* table)
{
  const size_t stretches = table->stretches > 0 ? (size_t)table->stretches + 1 : 0;
  return stratus_table_stretches_at(table) + (stretches << TABLE_STRETCH_LOG2);
}

void stratus_table_destroy(stratus_table* table)
{
  if (table) {
    stratus_context* context = table->context;
    stratus_release(context, table->next_shown);
    stratus_release(context, table->rgba);
    stratus_release(context, table->sums);
    stratus_release(context, table);
  }
}
