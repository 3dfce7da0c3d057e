/* SPDX-License-Identifier: BSD-3-Clause
 * The view of a volume: its checks, its geometry, and the float that the rest of the core sees of a value. */
#include "volume.h"

#include "matrix.h"

#include <float.h>
#include <string.h>

/* Number of values, evenly spread, among which stratus_volume_bias() seeks the one of least magnitude. */
#define BIAS_VALUES_ASKED 4096
/* Neighbouring coordinates are at least this part of the whole extent apart. A ray's position in mean index coordinates is a float: with
 * all roundings before it, its error is 2^-22 of the extent, so that a cell is found at most one off, even if it is halved. */
#define COORDINATES_APART 0x1p-19

static const double identity3[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
static const double identity4[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };

size_t stratus_type_size(stratus_type type)
{
  switch (type) {
    case STRATUS_INT8:
    case STRATUS_UINT8:
      return 1;
    case STRATUS_INT16:
    case STRATUS_UINT16:
      return 2;
    case STRATUS_INT32:
    case STRATUS_UINT32:
    case STRATUS_FLOAT32:
      return 4;
    case STRATUS_INT64:
    case STRATUS_UINT64:
    case STRATUS_FLOAT64:
      return 8;
  }
  return 0;
}

bool stratus_type_is_wide(stratus_type type)
{
  return type == STRATUS_INT32 || type == STRATUS_UINT32 || type == STRATUS_INT64 || type == STRATUS_UINT64 || type == STRATUS_FLOAT64;
}

void stratus_type_fill(stratus_type type, float one, void* values, size_t count)
{
  const size_t bytes = stratus_type_size(type);
  for (size_t i = 0; i < count && bytes == 4; ++i) {
    ((float*)values)[i] = one;
  }
  for (size_t i = 0; i < count && bytes == 2; ++i) {
    ((uint16_t*)values)[i] = (uint16_t)(int)one;
  }
  if (bytes == 1) {
    memset(values, (int)one, count);
  }
}

const stratus_parts* stratus_volume_parts(const stratus_volume* volume)
{
  const stratus_parts* parts = volume->parts;
  const bool whole = parts && parts->values == volume->values && parts->type == volume->type && volume->value_stride == 1 &&
    memcmp(parts->dimensions, volume->dimensions, sizeof parts->dimensions) == 0;
  return whole ? parts : NULL;
}

stratus_part stratus_volume_whole(const stratus_volume* volume)
{
  const int64_t* n = volume->dimensions;
  const size_t pitch = stratus_type_size(volume->type) * (size_t)volume->value_stride;
  return (stratus_part){
    .size = { n[0], n[1], n[2] }, .values = volume->values, .pitch = { pitch, pitch * (size_t)n[0], pitch * (size_t)n[0] * (size_t)n[1] }
  };
}

stratus_part stratus_part_rows(const stratus_part* part, int64_t y0, int64_t y1, int64_t z0, int64_t z1)
{
  stratus_part rows = *part;
  rows.lo[1] = y0;
  rows.lo[2] = z0;
  rows.size[1] = y1 - y0;
  rows.size[2] = z1 - z0;
  rows.room = NULL;
  rows.capacity = 0;
  if (part->values) {
    rows.values = (const char*)part->values + (size_t)(y0 - part->lo[1]) * part->pitch[1] + (size_t)(z0 - part->lo[2]) * part->pitch[2];
  }
  return rows;
}

bool stratus_type_is_integer(stratus_type type)
{
  return type != STRATUS_FLOAT32 && type != STRATUS_FLOAT64;
}

stratus_volume stratus_volume_default(void)
{
  stratus_volume volume = {
    .type = STRATUS_FLOAT32, .dimensions = { 1, 1, 1 }, .value_stride = 1, .spacing = { 1, 1, 1 }, .components = 1
  };
  memcpy(volume.direction, identity3, sizeof identity3);
  memcpy(volume.matrix, identity4, sizeof identity4);
  return volume;
}

/* ---- geometry */

void stratus_volume_cells(const stratus_volume* volume, int64_t cells[3])
{
  for (int a = 0; a < 3; ++a) {
    cells[a] = volume->dimensions[a] > 1 ? volume->dimensions[a] - 1 : 0;
  }
}

double stratus_volume_begin(const stratus_volume* volume, int axis)
{
  return volume->coordinates[axis] ? volume->coordinates[axis][0] : 0.0;
}

/* Returns the number of an axis's last coordinate. */
static int64_t last_coordinate(const stratus_volume* volume, int axis)
{
  return volume->dimensions[axis] - (volume->cell_centered ? 0 : 1);
}

double stratus_volume_spacing(const stratus_volume* volume, int axis)
{
  const double* x = volume->coordinates[axis];
  const int64_t last = last_coordinate(volume, axis);
  return x ? (x[last] - x[0]) / (double)last : volume->spacing[axis];
}

void stratus_volume_index_to_world(const stratus_volume* volume, double matrix[16])
{
  double local[16] = { [15] = 1.0 };
  for (int r = 0; r < 3; ++r) {
    local[4 * r + 3] = volume->origin[r];
    for (int c = 0; c < 3; ++c) {
      local[4 * r + c] = volume->direction[3 * r + c] * stratus_volume_spacing(volume, c);
      if (volume->coordinates[c]) {
        local[4 * r + 3] += volume->direction[3 * r + c] * stratus_volume_begin(volume, c);
      }
      if (volume->cell_centered) {
        local[4 * r + 3] += 0.5 * local[4 * r + c];
      }
    }
  }
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) {
      double sum = 0.0;
      for (int i = 0; i < 4; ++i) {
        sum += volume->matrix[4 * r + i] * local[4 * i + c];
      }
      matrix[4 * r + c] = sum;
    }
  }
}

/* Computes world bounds without checks. */
static void bounds_of(const stratus_volume* volume, double bounds[6])
{
  double matrix[16], lo[3], hi[3];
  stratus_volume_index_to_world(volume, matrix);
  const double margin = volume->cell_centered ? 0.5 : 0.0;
  for (int a = 0; a < 3; ++a) {
    lo[a] = -margin;
    hi[a] = (double)(volume->dimensions[a] - 1) + margin;
  }
  stratus_matrix_box(matrix, lo, hi, bounds);
}

stratus_status stratus_volume_bounds(stratus_context* context, const stratus_volume* volume, double bounds[6])
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!bounds) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "bounds is NULL");
  }
  TRY(stratus_volume_check(context, volume));
  bounds_of(volume, bounds);
  return STRATUS_OK;
}

/* ---- checks */

static stratus_status check_sizes(stratus_context* context, const stratus_volume* volume)
{
  static const char axis[] = "xyz";
  const size_t size = stratus_type_size(volume->type);
  if (size == 0) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "volume type %d outside %d..%d", (int)volume->type, STRATUS_INT8, STRATUS_FLOAT64);
  }
  for (int a = 0; a < 3; ++a) {
    if (volume->dimensions[a] < 1) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume dimension along %c is %lld, must be at least 1", axis[a],
        (long long)volume->dimensions[a]);
    }
  }
  if (volume->value_stride < 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume value_stride %lld, must be at least 1", (long long)volume->value_stride);
  }
  size_t values, bytes;
  TRY(stratus_product(
    context, "volume dimensions", (size_t)volume->dimensions[0], (size_t)volume->dimensions[1], (size_t)volume->dimensions[2], &values));
  TRY(stratus_product(context, "volume bytes (values, stride, size)", values, (size_t)volume->value_stride, size, &bytes));
  if (bytes > PTRDIFF_MAX) {
    return stratus_fail(context, STRATUS_OVERFLOW, "volume of %zu bytes exceeds the largest array of %td", bytes, PTRDIFF_MAX);
  }
  return STRATUS_OK;
}

static stratus_status check_finite(stratus_context* context, const char* what, const double* numbers, int count)
{
  for (int i = 0; i < count; ++i) {
    if (!isfinite(numbers[i])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume %s[%d] is %g, must be finite", what, i, numbers[i]);
    }
  }
  return STRATUS_OK;
}

/* Check that coordinates are finite and rise or fall strictly, by steps that floats distinguish along a ray. */
static stratus_status check_coordinates(stratus_context* context, const stratus_volume* volume, int axis)
{
  const double* x = volume->coordinates[axis];
  const int64_t last = last_coordinate(volume, axis);
  const char name = "xyz"[axis];
  if (last < 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "coordinates along %c are %lld, must be at least 2: a grid of one has no extent there", name, (long long)last + 1);
  }
  for (int64_t i = 0; i <= last; ++i) {
    if (!isfinite(x[i])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "coordinate %lld along %c is %g, must be finite", (long long)i, name, x[i]);
    }
  }
  const double extent = x[last] - x[0], least = COORDINATES_APART * fabs(extent);
  if (!isfinite(extent)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "coordinates along %c go from %g to %g, farther than doubles hold", name, x[0], x[last]);
  }
  for (int64_t i = 0; i < last; ++i) {
    const double step = extent < 0.0 ? x[i] - x[i + 1] : x[i + 1] - x[i];
    if (!(step > 0.0)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
        "coordinates %lld and %lld along %c are %.17g and %.17g, must %s strictly, as from the first, %.17g, to the last, %.17g",
        (long long)i, (long long)i + 1, name, x[i], x[i + 1], extent < 0.0 ? "fall" : "rise", x[0], x[last]);
    }
    if (step < least) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
        "coordinates %lld and %lld along %c, %.17g and %.17g, are %g apart, must be at least %g (2^-19 of the whole extent)", (long long)i,
        (long long)i + 1, name, x[i], x[i + 1], step, least);
    }
  }
  return STRATUS_OK;
}

static stratus_status check_geometry(stratus_context* context, const stratus_volume* volume)
{
  TRY(check_finite(context, "origin", volume->origin, 3));
  for (int a = 0; a < 3; ++a) {
    if (volume->coordinates[a]) {
      TRY(check_coordinates(context, volume, a));
    } else if (!(volume->spacing[a] > 0.0) || !isfinite(volume->spacing[a])) {
      return stratus_fail(
        context, STRATUS_INVALID_ARGUMENT, "volume spacing[%d] is %g, must be positive and finite", a, volume->spacing[a]);
    }
  }
  TRY(check_finite(context, "direction", volume->direction, 9));
  TRY(check_finite(context, "matrix", volume->matrix, 16));
  if (volume->matrix[12] != 0.0 || volume->matrix[13] != 0.0 || volume->matrix[14] != 0.0 || volume->matrix[15] != 1.0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume matrix has the last row %g %g %g %g, must be 0 0 0 1 (affine)",
      volume->matrix[12], volume->matrix[13], volume->matrix[14], volume->matrix[15]);
  }
  double direction[16] = { [15] = 1.0 }, world[16], inverse[16], bounds[6];
  for (int r = 0; r < 3; ++r) {
    memcpy(&direction[4 * r], &volume->direction[3 * r], 3 * sizeof(double));
  }
  if (!stratus_matrix_invert_affine(direction, inverse)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume direction is singular, must be a rotation");
  }
  stratus_volume_index_to_world(volume, world);
  if (!stratus_matrix_invert_affine(volume->matrix, inverse)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume matrix is singular, must be invertible");
  }
  if (!stratus_matrix_invert_affine(world, inverse)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume spacing %g, %g, %g with its matrix has no inverse within doubles",
      volume->spacing[0], volume->spacing[1], volume->spacing[2]);
  }
  bounds_of(volume, bounds);
  return check_finite(context, "bounds", bounds, 6);
}

stratus_status stratus_volume_check_missing(stratus_context* context, const stratus_volume* volume)
{
  const uint64_t missing = volume->missing ? *(const volatile uint64_t*)volume->missing : 0; /* a handler of signals counts them */
  return missing
    ? stratus_fail(context, STRATUS_INVALID_ARGUMENT,
        "%llu bytes of the volume's values are missing: their file was cut short, or could not be read", (unsigned long long)missing)
    : STRATUS_OK;
}

stratus_status stratus_volume_check(stratus_context* context, const stratus_volume* volume)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!volume) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume is NULL");
  }
  for (int a = 0; a < 3 && volume->tiles.values; ++a) {
    if (!volume->tiles.at[a] || volume->tiles.dimensions[a] != volume->dimensions[a]) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
        "volume tiles have %s along axis %d, and %lld values where the volume has %lld", volume->tiles.at[a] ? "offsets" : "no offsets", a,
        (long long)volume->tiles.dimensions[a], (long long)volume->dimensions[a]);
    }
  }
  if (!volume->values) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume values is NULL");
  }
  TRY(check_sizes(context, volume));
  if (volume->components < 0 || volume->components > 4 || volume->components > volume->value_stride) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume of %d components, must be 1..4 and at most the value stride %lld",
      volume->components, (long long)volume->value_stride);
  }
  TRY(stratus_volume_check_missing(context, volume));
  return check_geometry(context, volume);
}

/* ---- values */

static double value_as_double(const stratus_volume* volume, size_t index)
{
  const size_t at = index * (size_t)volume->value_stride;
  switch (volume->type) {
    case STRATUS_INT8:
      return ((const int8_t*)volume->values)[at];
    case STRATUS_UINT8:
      return ((const uint8_t*)volume->values)[at];
    case STRATUS_INT16:
      return ((const int16_t*)volume->values)[at];
    case STRATUS_UINT16:
      return ((const uint16_t*)volume->values)[at];
    case STRATUS_INT32:
      return ((const int32_t*)volume->values)[at];
    case STRATUS_UINT32:
      return ((const uint32_t*)volume->values)[at];
    case STRATUS_INT64:
      return (double)((const int64_t*)volume->values)[at];
    case STRATUS_UINT64:
      return (double)((const uint64_t*)volume->values)[at];
    case STRATUS_FLOAT32:
      return (double)((const float*)volume->values)[at];
    case STRATUS_FLOAT64:
      return ((const double*)volume->values)[at];
  }
  return 0.0;
}

/* The bias of wide types is the value of least magnitude. The first value may be a fill value of 1e36, and relative to it every digit of
 * the others would cancel. */
double stratus_volume_bias(const stratus_volume* volume)
{
  if (!stratus_type_is_wide(volume->type)) {
    return 0.0;
  }
  const size_t count = stratus_volume_count(volume);
  const size_t stride = count / BIAS_VALUES_ASKED + 1;
  double bias = INFINITY;
  for (size_t i = 0; i < count; i += stride) {
    const double value = value_as_double(volume, i);
    bias = fabs(value) < fabs(bias) ? value : bias;
  }
  return isfinite(bias) ? bias : 0.0;
}

float stratus_volume_fetch(const stratus_volume* volume, double bias, size_t index)
{
  return (float)(value_as_double(volume, index) - bias);
}

bool stratus_volume_same_data(const stratus_volume* a, const stratus_volume* b)
{
  return a->values == b->values && a->type == b->type && memcmp(a->dimensions, b->dimensions, sizeof a->dimensions) == 0 &&
    a->value_stride == b->value_stride && a->cell_centered == b->cell_centered && a->point_ghosts == b->point_ghosts &&
    a->cell_ghosts == b->cell_ghosts && a->gradients == b->gradients && a->revision == b->revision;
}

bool stratus_volume_floats_differ(const stratus_volume* volume, double bias)
{
  const size_t count = stratus_volume_count(volume);
  float first = NAN;
  for (size_t i = 0; i < count; ++i) {
    const float value = stratus_volume_fetch(volume, bias, i);
    if (isfinite(value) && isfinite(first) && value != first) {
      return true;
    }
    first = isfinite(value) ? value : first;
  }
  return false;
}

/* Called if all fetched values are equal: the volume is constant, or floats cannot hold the differences. One value beyond floats on either
 * side, however often it is there, is a fill value. */
stratus_status stratus_volume_check_floats(stratus_context* context, const stratus_volume* volume, double bias)
{
  if (volume->type != STRATUS_FLOAT64) {
    return STRATUS_OK;
  }
  const size_t count = stratus_volume_count(volume);
  const size_t stride = count / BIAS_VALUES_ASKED + 1;
  double far[2] = { NAN, NAN }; /* below and above */
  for (size_t i = 0; i < count; i += stride) {
    const double value = value_as_double(volume, i), apart = fabs(value - bias);
    double* fill = &far[value > bias];
    if (!isfinite(value) || value == bias) {
      continue;
    }
    if (apart < (double)FLT_MIN) {
      return stratus_fail(
        context, STRATUS_INVALID_ARGUMENT, "values %g and %g are too close together: floats can't separate them", bias, value);
    }
    if (apart > (double)FLT_MAX && !isnan(*fill) && value != *fill) {
      return stratus_fail(
        context, STRATUS_INVALID_ARGUMENT, "values %g and %g are too far from %g: floats can't separate them", *fill, value, bias);
    }
    *fill = apart > (double)FLT_MAX ? value : *fill;
  }
  return STRATUS_OK;
}
