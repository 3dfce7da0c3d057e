/* SPDX-License-Identifier: BSD-3-Clause
 * The view of a volume: checks, geometry, ghosts, and the float that everything later sees of a value. */
#include "internal.h"

#include <string.h>

/* Below this a matrix, its columns brought to length about 1, maps the volume onto what is a plane for all that doubles can tell. */
#define SINGULAR_BELOW 1e-12

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

stratus_volume stratus_volume_default(void)
{
  stratus_volume volume = { .type = STRATUS_FLOAT32, .dimensions = { 1, 1, 1 }, .value_stride = 1, .spacing = { 1, 1, 1 } };
  memcpy(volume.direction, identity3, sizeof identity3);
  memcpy(volume.matrix, identity4, sizeof identity4);
  return volume;
}

/* ---- geometry */

void stratus_volume_cells(const stratus_volume* volume, int64_t cells[3])
{
  for (int a = 0; a < 3; a++) {
    cells[a] = volume->dimensions[a] > 1 ? volume->dimensions[a] - 1 : 0;
  }
}

void stratus_volume_index_to_world(const stratus_volume* volume, double matrix[16])
{
  double local[16] = { [15] = 1.0 };
  for (int r = 0; r < 3; r++) {
    local[4 * r + 3] = volume->origin[r];
    for (int c = 0; c < 3; c++) {
      local[4 * r + c] = volume->direction[3 * r + c] * volume->spacing[c];
      if (volume->cell_centered) {
        local[4 * r + 3] += 0.5 * local[4 * r + c];
      }
    }
  }
  for (int r = 0; r < 4; r++) {
    for (int c = 0; c < 4; c++) {
      double sum = 0.0;
      for (int i = 0; i < 4; i++) {
        sum += volume->matrix[4 * r + i] * local[4 * i + c];
      }
      matrix[4 * r + c] = sum;
    }
  }
}

void stratus_matrix_point(const double matrix[16], const double point[3], double result[3])
{
  double moved[3];
  stratus_matrix_vector(matrix, point, moved);
  for (int r = 0; r < 3; r++) {
    result[r] = moved[r] + matrix[4 * r + 3];
  }
}

void stratus_matrix_vector(const double matrix[16], const double vector[3], double result[3])
{
  double turned[3];
  for (int r = 0; r < 3; r++) {
    turned[r] = matrix[4 * r] * vector[0] + matrix[4 * r + 1] * vector[1] + matrix[4 * r + 2] * vector[2];
  }
  memcpy(result, turned, sizeof turned);
}

bool stratus_matrix_invert_affine(const double matrix[16], double inverse[16])
{
  /* Columns are brought to length about 1 by powers of two, which is exact: a spacing of 1e-120 must not underflow the determinant. */
  double a[3][3];
  int exponent[3];
  for (int c = 0; c < 3; c++) {
    const double longest = fmax(fmax(fabs(matrix[c]), fabs(matrix[4 + c])), fabs(matrix[8 + c]));
    if (!(longest > 0.0) || !isfinite(longest)) {
      return false;
    }
    (void)frexp(longest, &exponent[c]);
    for (int r = 0; r < 3; r++) {
      a[r][c] = ldexp(matrix[4 * r + c], -exponent[c]);
    }
  }
  double cofactor[3][3];
  for (int r = 0; r < 3; r++) {
    for (int c = 0; c < 3; c++) {
      const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
      cofactor[r][c] = a[r1][c1] * a[r2][c2] - a[r1][c2] * a[r2][c1];
    }
  }
  const double determinant = a[0][0] * cofactor[0][0] + a[0][1] * cofactor[0][1] + a[0][2] * cofactor[0][2];
  if (!(fabs(determinant) > SINGULAR_BELOW)) {
    return false;
  }
  double result[16] = { [15] = 1.0 };
  for (int r = 0; r < 3; r++) {
    for (int c = 0; c < 3; c++) {
      result[4 * r + c] = ldexp(cofactor[c][r] / determinant, -exponent[r]);
    }
  }
  const double translation[3] = { -matrix[3], -matrix[7], -matrix[11] };
  double back[3];
  stratus_matrix_vector(result, translation, back);
  for (int r = 0; r < 3; r++) {
    result[4 * r + 3] = back[r];
  }
  for (int i = 0; i < 12; i++) {
    if (!isfinite(result[i])) {
      return false;
    }
  }
  memcpy(inverse, result, sizeof result);
  return true;
}

/* World bounds, without checks. */
static void bounds_of(const stratus_volume* volume, double bounds[6])
{
  double matrix[16];
  stratus_volume_index_to_world(volume, matrix);
  const double margin = volume->cell_centered ? 0.5 : 0.0;
  for (int corner = 0; corner < 8; corner++) {
    double index[3], world[3];
    for (int a = 0; a < 3; a++) {
      index[a] = (corner >> a & 1) ? (double)(volume->dimensions[a] - 1) + margin : -margin;
    }
    stratus_matrix_point(matrix, index, world);
    for (int a = 0; a < 3; a++) {
      bounds[2 * a] = corner == 0 || world[a] < bounds[2 * a] ? world[a] : bounds[2 * a];
      bounds[2 * a + 1] = corner == 0 || world[a] > bounds[2 * a + 1] ? world[a] : bounds[2 * a + 1];
    }
  }
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
  for (int a = 0; a < 3; a++) {
    if (volume->dimensions[a] < 1) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume dimension along %c is %lld, must be at least 1", axis[a],
        (long long)volume->dimensions[a]);
    }
  }
  if (volume->value_stride < 1) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "volume value_stride %lld, must be at least 1", (long long)volume->value_stride);
  }
  size_t values, bytes;
  TRY(stratus_product(context, "volume dimensions", (size_t)volume->dimensions[0], (size_t)volume->dimensions[1],
    (size_t)volume->dimensions[2], &values));
  TRY(stratus_product(context, "volume bytes (values, stride, size)", values, (size_t)volume->value_stride, size, &bytes));
  if (bytes > PTRDIFF_MAX) {
    return stratus_fail(context, STRATUS_OVERFLOW, "volume of %zu bytes exceeds the largest array of %td", bytes, PTRDIFF_MAX);
  }
  return STRATUS_OK;
}

static stratus_status check_finite(stratus_context* context, const char* what, const double* numbers, int count)
{
  for (int i = 0; i < count; i++) {
    if (!isfinite(numbers[i])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume %s[%d] is %g, must be finite", what, i, numbers[i]);
    }
  }
  return STRATUS_OK;
}

static stratus_status check_geometry(stratus_context* context, const stratus_volume* volume)
{
  TRY(check_finite(context, "origin", volume->origin, 3));
  for (int a = 0; a < 3; a++) {
    if (!(volume->spacing[a] > 0.0) || !isfinite(volume->spacing[a])) {
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
  for (int r = 0; r < 3; r++) {
    memcpy(&direction[4 * r], &volume->direction[3 * r], 3 * sizeof(double));
  }
  if (!stratus_matrix_invert_affine(direction, inverse)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume direction is singular, must be a rotation");
  }
  stratus_volume_index_to_world(volume, world);
  if (!stratus_matrix_invert_affine(volume->matrix, inverse) || !stratus_matrix_invert_affine(world, inverse)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume matrix is singular, must be invertible");
  }
  bounds_of(volume, bounds);
  return check_finite(context, "bounds", bounds, 6);
}

stratus_status stratus_volume_check(stratus_context* context, const stratus_volume* volume)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!volume) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume is NULL");
  }
  if (!volume->values) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume values is NULL");
  }
  TRY(check_sizes(context, volume));
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

double stratus_volume_bias(const stratus_volume* volume)
{
  if (!stratus_type_is_wide(volume->type)) {
    return 0.0;
  }
  const size_t count = (size_t)volume->dimensions[0] * (size_t)volume->dimensions[1] * (size_t)volume->dimensions[2];
  for (size_t i = 0; i < count; i++) {
    const double value = value_as_double(volume, i);
    if (isfinite(value)) {
      return value;
    }
  }
  return 0.0;
}

float stratus_volume_fetch(const stratus_volume* volume, double bias, size_t index)
{
  return (float)(value_as_double(volume, index) - bias);
}

/* ---- ghosts */

/* Flags of points and of cells, whichever way the values lie. Along a flat axis VTK counts one cell. */
typedef struct ghosts {
  const uint8_t* points; /* NULL: none */
  const uint8_t* cells;  /* NULL: none */
  int64_t n[3];          /* cells */
  int64_t p[3];          /* points */
} ghosts;

static ghosts ghosts_of(const stratus_volume* volume)
{
  ghosts g = { .points = volume->cell_centered ? NULL : volume->point_ghosts, .cells = volume->cell_ghosts };
  for (int a = 0; a < 3; a++) {
    g.p[a] = volume->dimensions[a];
    g.n[a] = volume->cell_centered || volume->dimensions[a] == 1 ? volume->dimensions[a] : volume->dimensions[a] - 1;
  }
  return g;
}

/* `flag` in any corner of the cell, and in all of them. */
static void corner_flags(const ghosts* g, int64_t i, int64_t j, int64_t k, unsigned flag, bool* any, bool* all)
{
  unsigned some = 0, every = flag;
  for (int64_t z = k; z <= k + 1 && z < g->p[2]; z++) {
    for (int64_t y = j; y <= j + 1 && y < g->p[1]; y++) {
      for (int64_t x = i; x <= i + 1 && x < g->p[0]; x++) {
        const unsigned flags = g->points[(z * g->p[1] + y) * g->p[0] + x];
        some |= flags & flag;
        every &= flags;
      }
    }
  }
  *any = some != 0;
  *all = every != 0;
}

static bool has_flag(const uint8_t* flags, const int64_t n[3], unsigned flag)
{
  const int64_t count = n[0] * n[1] * n[2];
  for (int64_t i = 0; flags && i < count; i++) {
    if (flags[i] & flag) {
      return true;
    }
  }
  return false;
}

stratus_status stratus_volume_hidden_cells(stratus_context* context, const stratus_volume* volume, uint8_t** hidden)
{
  const ghosts g = ghosts_of(volume);
  const bool points = has_flag(g.points, g.p, STRATUS_GHOST_HIDDEN_POINT);
  const bool cells = has_flag(g.cells, g.n, STRATUS_GHOST_HIDDEN_CELL);
  if (!points && !cells) {
    return STRATUS_OK;
  }
  void* memory;
  TRY(stratus_allocate(context, (size_t)(g.n[0] * g.n[1] * g.n[2]), 1, &memory));
  uint8_t* result = memory;
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t k = 0; k < g.n[2]; k++) {
    for (int64_t j = 0; j < g.n[1]; j++) {
      for (int64_t i = 0; i < g.n[0]; i++) {
        const int64_t cell = (k * g.n[1] + j) * g.n[0] + i;
        bool any = false, all = false;
        if (points) {
          corner_flags(&g, i, j, k, STRATUS_GHOST_HIDDEN_POINT, &any, &all);
        }
        result[cell] = any || (cells && g.cells[cell] & STRATUS_GHOST_HIDDEN_CELL);
      }
    }
  }
  *hidden = result;
  return STRATUS_OK;
}

/* Without flags of cells, a cell is another piece's if all its corners are: one corner tells nothing, for pieces share their border. */
static bool is_duplicate(const ghosts* g, int64_t i, int64_t j, int64_t k)
{
  if (g->cells) {
    return g->cells[(k * g->n[1] + j) * g->n[0] + i] & STRATUS_GHOST_DUPLICATE;
  }
  bool any, all;
  corner_flags(g, i, j, k, STRATUS_GHOST_DUPLICATE, &any, &all);
  return all;
}

void stratus_volume_owned(const stratus_volume* volume, int64_t lo[3], int64_t hi[3])
{
  const ghosts g = ghosts_of(volume);
  if (!g.cells && !g.points) {
    for (int a = 0; a < 3; a++) {
      lo[a] = 0;
      hi[a] = g.n[a];
    }
    return;
  }
  for (int a = 0; a < 3; a++) {
    lo[a] = g.n[a];
    hi[a] = 0;
  }
  for (int64_t k = 0; k < g.n[2]; k++) {
    for (int64_t j = 0; j < g.n[1]; j++) {
      for (int64_t i = 0; i < g.n[0]; i++) {
        if (!is_duplicate(&g, i, j, k)) {
          const int64_t at[3] = { i, j, k };
          for (int a = 0; a < 3; a++) {
            lo[a] = at[a] < lo[a] ? at[a] : lo[a];
            hi[a] = at[a] >= hi[a] ? at[a] + 1 : hi[a];
          }
        }
      }
    }
  }
  if (hi[0] == 0) {
    lo[0] = lo[1] = lo[2] = 0;
  }
}
