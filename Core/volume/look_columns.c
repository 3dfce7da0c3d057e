/* SPDX-License-Identifier: BSD-3-Clause
 * The lengths of values along the columns of grids. */
#include "look_shapes.h"

double stratus_look_world_step(const stratus_volume* v, int axis)
{
  double square = 0.0;
  for (int r = 0; r < 3; ++r) {
    double part = 0.0;
    for (int c = 0; c < 3; ++c) {
      part += v->matrix[4 * r + c] * v->direction[3 * c + axis];
    }
    square += part * part;
  }
  return sqrt(square);
}

/* World length along the axis that the value at an index stands for. */
static double thickness_at(const stratus_volume* v, int axis, int64_t at)
{
  const double* const x = v->coordinates[axis];
  const int64_t last = v->dimensions[axis] - 1;
  if (!x) {
    return v->spacing[axis] * (v->cell_centered || last == 0 || (at > 0 && at < last) ? 1.0 : 0.5);
  }
  if (v->cell_centered) {
    return fabs(x[at + 1] - x[at]);
  }
  return 0.5 * fabs(x[at < last ? at + 1 : at] - x[at > 0 ? at - 1 : at]);
}

int stratus_look_part_of(const stratus_look_values* range, double value)
{
  const double part = (value - range->low) / (range->high - range->low) * STRATUS_LOOK_PARTS;
  return part < STRATUS_LOOK_PARTS - 1 ? (int)part : STRATUS_LOOK_PARTS - 1;
}

/* Measures the columns at a place of the axis after the next one, and adds to the sums. */
static void measure_row(const stratus_volume* v, const stratus_look_options* o, const stratus_look_values* range,
  const stratus_look_shape* shape, int64_t row, double sums[STRATUS_LOOK_PARTS])
{
  const int axis = o->column_axis, a = (axis + 1) % 3, b = (axis + 2) % 3;
  const int64_t step[3] = { 1, v->dimensions[0], v->dimensions[0] * v->dimensions[1] };
  const double scale = o->thickness ? 1.0 : stratus_look_world_step(v, axis);
  for (int64_t column = 0; column < v->dimensions[a]; ++column) {
    double sum = 0.0;
    for (int64_t i = 0; i < v->dimensions[axis]; ++i) {
      const int64_t at = column * step[a] + row * step[b] + i * step[axis];
      double value = 0.0;
      stratus_look_values_get(v, at, 1, &value);
      const double length = o->thickness ? o->thickness[at] : scale * thickness_at(v, axis, i);
      if (value >= range->low && value <= range->high && isfinite(length)) {
        sum += shape ? stratus_look_height_at(shape, value) * length : 0.0;
        sums[stratus_look_part_of(range, value)] += shape ? 0.0 : length;
      }
    }
    sums[0] += sum;
    sums[1] += sum * sum;
  }
}

stratus_status stratus_look_measure_columns(stratus_context* context, const stratus_volume* volumes, int count,
  const stratus_look_options* o, const stratus_look_values* range, const stratus_look_shape* shape, double sums[STRATUS_LOOK_PARTS])
{
  for (int n = 0; n < count; ++n) {
    const int64_t rows = volumes[n].dimensions[(o->column_axis + 2) % 3];
    void* memory = NULL;
    TRY(stratus_allocate_zero(context, (size_t)rows, STRATUS_LOOK_PARTS * sizeof(double), &memory));
    double* const of_rows = memory;
#pragma omp parallel for num_threads(context->threads)
    for (int64_t row = 0; row < rows; ++row) {
      measure_row(volumes + n, o, range, shape, row, of_rows + row * STRATUS_LOOK_PARTS);
    }
    for (int64_t i = 0; i < rows * STRATUS_LOOK_PARTS; ++i) {
      sums[i % STRATUS_LOOK_PARTS] += of_rows[i];
    }
    stratus_release(context, memory);
  }
  return STRATUS_OK;
}
