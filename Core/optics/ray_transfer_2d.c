/* SPDX-License-Identifier: BSD-3-Clause
 * Functions of two variables, the value and the gradient's magnitude or a second value. Everything but the rays uses a function of only the
 * value, which has for each value the largest opacity of its rows: where that is 0 nothing shows, whatever the second variable. */
#include "ray_transfer_2d_host.h"

#include "ray_field.h"

#include <string.h>

#define SIDE_MOST 4096
/* How far rounding may move a value among the columns, as a part of all of them. */
#define COLUMN_SLACK 0x1p-20
/* Stands for the opacity of transparent columns that have visible ones on both sides. */
#define BARELY 1e-6

static bool same_function(const stratus_transfer_2d* a, const stratus_transfer_2d* b)
{
  return a->rgba == b->rgba && a->columns == b->columns && a->rows == b->rows && a->revision == b->revision &&
    a->unit_distance == b->unit_distance && memcmp(a->value_range, b->value_range, sizeof a->value_range) == 0 &&
    memcmp(a->second_range, b->second_range, sizeof a->second_range) == 0;
}

/* ---- checks */

static stratus_status check_range(stratus_context* context, const char* what, const double range[2])
{
  if (!(range[0] < range[1]) || !isfinite(range[0]) || !isfinite(range[1]) || !isfinite(range[1] - range[0])) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "a two-dimensional function's %s %g..%g: must be finite and rise", what, range[0], range[1]);
  }
  return STRATUS_OK;
}

static stratus_status check_function(stratus_context* context, const stratus_transfer_2d* of)
{
  if (!of->rgba || of->columns < 1 || of->columns > SIDE_MOST || of->rows < 1 || of->rows > SIDE_MOST) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "a two-dimensional function of %d x %d entries%s: must be 1..%d each way",
      of->columns, of->rows, of->rgba ? "" : " that are NULL", SIDE_MOST);
  }
  TRY(check_range(context, "range of values", of->value_range));
  TRY(check_range(context, "range of the second variable", of->second_range));
  if (!(of->unit_distance > 0.0) || !isfinite(of->unit_distance)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "a two-dimensional function's unit distance %g, must be positive and finite", of->unit_distance);
  }
  for (size_t i = 0; i < 4 * (size_t)of->columns * (size_t)of->rows; ++i) {
    if (!(of->rgba[i] >= 0.0f && of->rgba[i] <= 1.0f)) {
      const size_t entry = i / 4;
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
        "a two-dimensional function has %g as component %d of entry (%d, %d), outside 0..1", (double)of->rgba[i], (int)(i % 4),
        (int)(entry % (size_t)of->columns), (int)(entry / (size_t)of->columns));
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_ray_transfer_2d_check(
  stratus_context* context, const stratus_ray_transfer_2d* kept, const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  const stratus_transfer_2d* of = options->optics.transfer_2d;
  const bool known = kept->table && same_function(&kept->of, of); /* and checked */
  const int components = stratus_volume_components(volume);
  if (options->mode != STRATUS_MODE_COMPOSITE) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "a two-dimensional function in mode %s: only composite has them", stratus_mode_name(options->mode));
  }
  if (options->sampling.rule == STRATUS_SAMPLING_PREINTEGRATED || options->sampling.rule == STRATUS_SAMPLING_CELLS) {
    return stratus_fail(context, STRATUS_UNSUPPORTED,
      "sampling %s with a two-dimensional function: only midpoint and auto sample both variables",
      stratus_sampling_name(options->sampling.rule));
  }
  if (options->mask.label_count > 0) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "%d labels with a two-dimensional function: labels have functions of only the value",
      options->mask.label_count);
  }
  if (components > 2) {
    return stratus_fail(context, STRATUS_UNSUPPORTED,
      "a two-dimensional function of a volume of %d components: must be 1 (and the gradient) or 2 (and the second)", components);
  }
  return known ? STRATUS_OK : check_function(context, of);
}

/* ---- the caster's copy */

static double middle_of(const double range[2], int entry, int entries)
{
  return range[0] + (entry + 0.5) / entries * (range[1] - range[0]);
}

static float largest_opacity(const stratus_transfer_2d* of, int column)
{
  float largest = 0.0f;
  for (size_t row = 0; row < (size_t)of->rows; ++row) {
    largest = fmaxf(largest, of->rgba[4 * (row * (size_t)of->columns + (size_t)column) + 3]);
  }
  return largest;
}

/* Gives the entries as rays read them; a single column or row stands twice. */
static void fill_table(stratus_ray_transfer_2d* t)
{
  const stratus_transfer_2d* of = &t->of;
  float* opacities = t->table + 4 * (size_t)t->columns * (size_t)t->rows;
  for (int row = 0; row < t->rows; ++row) {
    for (int column = 0; column < t->columns; ++column) {
      const int from_row = row < of->rows ? row : of->rows - 1, from = column < of->columns ? column : of->columns - 1;
      memcpy(t->table + 4 * ((size_t)row * (size_t)t->columns + (size_t)column),
        of->rgba + 4 * ((size_t)from_row * (size_t)of->columns + (size_t)from), 4 * sizeof(float));
    }
  }
  for (int column = 0; column < t->columns; ++column) {
    opacities[column] = largest_opacity(of, column < of->columns ? column : of->columns - 1);
  }
}

/* Gives the largest opacity of each value's rows as points, and the color of the middle row. A transparent column next to a visible one is
 * moved a hair away from it, so that no rounding shows a value that is transparent here. */
static void fill_shown(stratus_ray_transfer_2d* t)
{
  const stratus_transfer_2d* of = &t->of;
  const float* opacities = t->table + 4 * (size_t)t->columns * (size_t)t->rows;
  double *opacity = t->points, *color = t->points + 2 * (size_t)of->columns;
  const double slack = COLUMN_SLACK * (of->value_range[1] - of->value_range[0]);
  for (int column = 0; column < of->columns; ++column) {
    const bool before = column > 0 && opacities[column - 1] > 0.0f, after = column + 1 < of->columns && opacities[column + 1] > 0.0f;
    const bool none = !(opacities[column] > 0.0f);
    const double at = middle_of(of->value_range, column, of->columns);
    const float* entry = of->rgba + 4 * ((size_t)(of->rows / 2) * (size_t)of->columns + (size_t)column);
    opacity[2 * column] = none ? at + (before ? slack : 0.0) - (after ? slack : 0.0) : at;
    opacity[2 * column + 1] = none ? (before && after ? BARELY : 0.0) : (double)opacities[column];
    color[4 * column] = at;
    for (int c = 0; c < 3; ++c) {
      color[4 * column + 1 + c] = (double)entry[c];
    }
  }
  t->shown = stratus_transfer_default();
  t->shown.opacity = opacity;
  t->shown.color = color;
  t->shown.opacity_count = t->shown.color_count = (size_t)of->columns;
  t->shown.unit_distance = of->unit_distance;
}

void stratus_ray_transfer_2d_release(stratus_context* context, stratus_ray_transfer_2d* t)
{
  stratus_release(context, t->table);
  stratus_release(context, t->points);
  memset(t, 0, sizeof *t);
}

bool stratus_ray_transfer_2d_changes(const stratus_ray_transfer_2d* t, const stratus_transfer_2d* of)
{
  return t->on != (of != NULL) || (of && !(t->table && same_function(&t->of, of)));
}

stratus_status stratus_ray_transfer_2d_update(
  stratus_context* context, stratus_ray_transfer_2d* t, const stratus_transfer_2d* of, bool* made)
{
  *made = false;
  t->on = of != NULL;
  if (!of || (t->table && same_function(&t->of, of))) {
    return STRATUS_OK;
  }
  stratus_ray_transfer_2d_release(context, t);
  void *table = NULL, *points = NULL;
  const int columns = of->columns > 1 ? of->columns : 2, rows = of->rows > 1 ? of->rows : 2;
  const size_t floats = 4 * (size_t)columns * (size_t)rows + (size_t)columns;
  TRY(stratus_allocate(context, floats, sizeof(float), &table));
  const stratus_status status = stratus_allocate(context, 6 * (size_t)of->columns, sizeof(double), &points);
  if (status != STRATUS_OK) {
    stratus_release(context, table);
    return status;
  }
  *t = (stratus_ray_transfer_2d){
    .on = true, .of = *of, .table = table, .bytes = floats * sizeof(float), .columns = columns, .rows = rows, .points = points
  };
  fill_table(t);
  fill_shown(t);
  *made = true;
  return STRATUS_OK;
}

void stratus_ray_transfer_2d_arguments(
  const stratus_ray_transfer_2d* t, const stratus_ray_field* field, double sample_distance, stratus_ray_cast_arguments* a)
{
  if (!t->on) {
    return;
  }
  stratus_ray_function_2d* to = &a->transfer_2d;
  const int entries[2] = { t->of.columns, t->of.rows };
  const bool second = stratus_volume_components(&field->volume) > 1;
  const double biases[2] = { field->ranges->bias, second ? stratus_ray_range_of(field, 1)->bias : 0.0 };
  *to = (stratus_ray_function_2d){ .second = second, .columns = t->columns, .rows = t->rows, .opacity_at = 4 * t->columns * t->rows };
  for (int axis = 0; axis < 2; ++axis) {
    const double* range = axis ? t->of.second_range : t->of.value_range;
    to->base[axis] = (float)(range[0] - biases[axis]);
    to->scale[axis] = (float)fmin(entries[axis] / (range[1] - range[0]), 1e30);
    to->last[axis] = (float)(entries[axis] - 1);
  }
  to->reach = (float)fmin(sample_distance / t->of.unit_distance, 1e15);
}
