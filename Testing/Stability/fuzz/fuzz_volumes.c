/* SPDX-License-Identifier: BSD-3-Clause
 * Volumes, transfer functions and matrices. */
#include "fuzz.h"

#include <stdlib.h>

#define POINTS_MOST 7

/* ---- values */

typedef enum pattern { SMOOTH, NOISE, CONSTANT, SPARSE, STEPS, EXTREME, PATTERNS } pattern;

static void store(void* values, stratus_type type, size_t at, double value)
{
#define STORE(number, low, high)                                                                                                           \
  ((number*)values)[at] = (number)(!(value > (double)(low)) ? (low) : value >= (double)(high) ? (high) : (number)value);                   \
  break
  switch (type) {
    case STRATUS_INT8:
      STORE(int8_t, INT8_MIN, INT8_MAX);
    case STRATUS_UINT8:
      STORE(uint8_t, 0, UINT8_MAX);
    case STRATUS_INT16:
      STORE(int16_t, INT16_MIN, INT16_MAX);
    case STRATUS_UINT16:
      STORE(uint16_t, 0, UINT16_MAX);
    case STRATUS_INT32:
      STORE(int32_t, INT32_MIN, INT32_MAX);
    case STRATUS_UINT32:
      STORE(uint32_t, 0, UINT32_MAX);
    case STRATUS_INT64:
      STORE(int64_t, INT64_MIN, INT64_MAX);
    case STRATUS_UINT64:
      STORE(uint64_t, 0, UINT64_MAX);
    case STRATUS_FLOAT32:
      ((float*)values)[at] = fabs(value) > 3.4e38 && isfinite(value) ? copysignf(3.4e38f, (float)(value > 0.0 ? 1.0 : -1.0)) : (float)value;
      break;
    case STRATUS_FLOAT64:
      ((double*)values)[at] = value;
      break;
  }
#undef STORE
}

double fuzz_value_of(const stratus_volume* volume, size_t index)
{
  const void* values = volume->values;
  const size_t at = index * (size_t)volume->value_stride;
  switch (volume->type) {
    case STRATUS_INT8:
      return ((const int8_t*)values)[at];
    case STRATUS_UINT8:
      return ((const uint8_t*)values)[at];
    case STRATUS_INT16:
      return ((const int16_t*)values)[at];
    case STRATUS_UINT16:
      return ((const uint16_t*)values)[at];
    case STRATUS_INT32:
      return ((const int32_t*)values)[at];
    case STRATUS_UINT32:
      return ((const uint32_t*)values)[at];
    case STRATUS_INT64:
      return (double)((const int64_t*)values)[at];
    case STRATUS_UINT64:
      return (double)((const uint64_t*)values)[at];
    case STRATUS_FLOAT32:
      return (double)((const float*)values)[at];
    case STRATUS_FLOAT64:
      return ((const double*)values)[at];
  }
  return NAN;
}

/* Values for `field` in new memory, which the caller frees. */
static void* make_values(fuzz* f, fuzz_field* field)
{
  const stratus_volume* v = &field->view;
  const pattern kind = (pattern)fuzz_below(f, PATTERNS);
  const bool real = v->type == STRATUS_FLOAT32 || v->type == STRATUS_FLOAT64;
  const double low = field->low, high = field->high, step = fuzz_between(f, 0.05, 1.0);
  const double broken = real && fuzz_chance(f, 0.2) ? fuzz_between(f, 0.0, 0.3) : 0.0, filled = fuzz_unit(f);
  const size_t size = stratus_type_size(v->type);
  void* values = calloc(field->bytes / size + 1, size);
  for (size_t i = 0; values && i < field->bytes / size; ++i) {
    const double along = (double)(i % (size_t)(v->dimensions[0] * v->value_stride)), up = (double)i / (double)(v->dimensions[0]);
    double t = fuzz_unit(f);
    t = kind == SMOOTH ? 0.5 + 0.5 * sin(step * along) * cos(step * up) : kind == CONSTANT ? filled : t;
    t = kind == SPARSE ? (t < 0.1 * filled ? 1.0 - t : 0.0) : kind == STEPS ? floor(4.0 * t) / 4.0 : t;
    double value = low + t * (high - low);
    if (kind == EXTREME && t < 0.1) {
      value = fuzz_odd_real(f);
      value = real && fabs(value) < 1e30 && (fabs(value) > 1e-25 || value == 0.0) ? value : low;
    }
    if (fuzz_chance(f, broken)) {
      value = fuzz_chance(f, 0.5) ? (double)NAN : fuzz_chance(f, 0.5) ? INFINITY : -INFINITY;
    }
    store(values, v->type, i, value);
  }
  return values;
}

static void choose_range(fuzz* f, fuzz_field* field)
{
  static const double highest[] = { INT8_MAX, UINT8_MAX, INT16_MAX, UINT16_MAX, INT32_MAX, UINT32_MAX, 9e18, 1.8e19, 1e3, 1e3 };
  const stratus_type type = field->view.type;
  const bool is_signed = type == STRATUS_INT8 || type == STRATUS_INT16 || type == STRATUS_INT32 || type == STRATUS_INT64;
  const double most = (unsigned)type <= STRATUS_FLOAT64 ? highest[type] : 1.0;
  field->low = 0.0;
  field->high = fuzz_chance(f, 0.5) ? fmin(most, 100.0) : most * fuzz_unit(f);
  if (is_signed && fuzz_chance(f, 0.5)) {
    field->low = -field->high;
  }
  if (type >= STRATUS_FLOAT32) {
    const double scale = fuzz_chance(f, 0.8) ? 1.0 : fuzz_scale(f, 1e-30, 1e30);
    const double offset = fuzz_chance(f, 0.8) ? 0.0 : 6e6 * scale;
    field->high = scale * fuzz_unit(f) + offset;
    field->low = offset - (fuzz_chance(f, 0.5) ? scale * fuzz_unit(f) : 0.0);
  }
  field->high = fuzz_chance(f, 0.05) ? field->low : field->high;
}

/* ---- placement */

static void rotation(fuzz* f, double m[9])
{
  double q[4], square = 0.0;
  for (int i = 0; i < 4; ++i) {
    q[i] = fuzz_between(f, -1.0, 1.0);
    square += q[i] * q[i];
  }
  const double w = q[0], x = q[1], y = q[2], z = q[3], s = 2.0 / fmax(square, 1e-12);
  const double turned[9] = { 1.0 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w), s * (x * y + z * w),
    1.0 - s * (x * x + z * z), s * (y * z - x * w), s * (x * z - y * w), s * (y * z + x * w), 1.0 - s * (x * x + y * y) };
  memcpy(m, turned, sizeof turned);
}

void fuzz_matrix(fuzz* f, double matrix[16])
{
  const uint64_t how = fuzz_below(f, 8);
  const double scale = fuzz_chance(f, 0.8) ? 1.0 : fuzz_scale(f, 1e-3, 1e3);
  const double shear = how == 7 ? fuzz_between(f, -1.5, 1.5) : 0.0; /* the other axes lean towards the first */
  double turn[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  if (how >= 4) {
    rotation(f, turn);
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      matrix[4 * row + column] = scale * (turn[3 * row + column] + (column > 0 ? shear * turn[3 * row] : 0.0));
    }
    matrix[4 * row + 3] = how == 0 ? 0.0 : fuzz_between(f, -5.0, 5.0);
  }
  if (how == 3 || how == 6) {
    const int mirrored = (int)fuzz_below(f, 3);
    for (int row = 0; row < 3; ++row) {
      matrix[4 * row + mirrored] *= -1.0;
    }
  }
  for (int i = 0; i < 16; ++i) {
    const double last = i == 15 ? 1.0 : 0.0;
    matrix[i] = i >= 12 ? last : matrix[i];
    matrix[i] = fuzz_odd(f) ? fuzz_odd_real(f) : matrix[i];
  }
}

static void place(fuzz* f, stratus_volume* v)
{
  const double spacing = fuzz_chance(f, 0.7) ? 1.0 : fuzz_scale(f, 1e-6, 1e6);
  const bool even = fuzz_chance(f, 0.5);
  for (int axis = 0; axis < 3; ++axis) {
    v->spacing[axis] = spacing * (even ? 1.0 : fuzz_scale(f, 0.1, 10.0));
    v->spacing[axis] = fuzz_odd(f) ? fuzz_odd_real(f) : v->spacing[axis];
    v->origin[axis] = fuzz_chance(f, 0.5) ? 0.0 : fuzz_between(f, -10.0, 10.0) * (fuzz_chance(f, 0.1) ? 6e5 : spacing);
    v->origin[axis] = fuzz_odd(f) ? fuzz_odd_real(f) : v->origin[axis];
  }
  if (fuzz_chance(f, 0.3)) {
    rotation(f, v->direction);
  }
  for (int i = 0; i < 9; ++i) {
    v->direction[i] = fuzz_odd(f) ? fuzz_odd_real(f) : v->direction[i];
  }
  if (fuzz_chance(f, 0.6)) {
    fuzz_matrix(f, v->matrix);
  }
}

static const uint8_t* flags(fuzz* f, size_t count)
{
  static const uint8_t kinds[] = { 0, 0, 1, 2, 32, 33, 255 };
  uint8_t* bytes = malloc(count + 1);
  const double some = fuzz_chance(f, 0.2) ? 1.0 : 0.3 * fuzz_unit(f);
  for (size_t i = 0; bytes && i < count; ++i) {
    bytes[i] = fuzz_chance(f, some) ? kinds[fuzz_below(f, sizeof kinds)] : 0;
  }
  const uint8_t* result = fuzz_input(f, bytes, count);
  free(bytes);
  return result;
}

static void add_ghosts(fuzz* f, stratus_volume* v)
{
  size_t cells = 1, points = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const size_t n = (size_t)v->dimensions[axis];
    points *= n;
    cells *= v->cell_centered == 1 || n == 1 ? n : n - 1;
  }
  if (fuzz_chance(f, 0.2)) {
    v->point_ghosts = flags(f, points);
  }
  if (fuzz_chance(f, 0.2)) {
    v->cell_ghosts = flags(f, cells);
  }
}

/* Finds the volume's bounds in the world, or a cube if it is refused, and the edges of a voxel. */
static void look_at(fuzz* f, fuzz_field* field)
{
  const stratus_volume* v = &field->view;
  double bounds[6];
  const bool known = STATUS(stratus_volume_bounds(f->context, FUZZ_INPUT(f, *v), bounds)) == STRATUS_OK;
  for (int axis = 0; axis < 3; ++axis) {
    double square = 0.0;
    for (int row = 0; row < 3; ++row) {
      double along = 0.0;
      for (int i = 0; i < 3; ++i) {
        along += v->matrix[4 * row + i] * v->direction[3 * i + axis] * v->spacing[axis];
      }
      square += along * along;
    }
    field->edge = known ? fmax(field->edge, sqrt(square)) : 1.0;
    field->shortest = known && (axis == 0 || sqrt(square) < field->shortest) ? sqrt(square) : field->shortest;
    field->bounds[2 * axis] = known ? bounds[2 * axis] : 0.0;
    field->bounds[2 * axis + 1] = known ? bounds[2 * axis + 1] : 1.0;
  }
}

/* Makes sizes wrong, but only so that a check can notice: their product exceeds any memory, or one is below 1. */
static void spoil_sizes(fuzz* f, fuzz_field* field)
{
  static const int64_t bad[] = { 0, -1, -7, INT64_MIN, INT32_MIN };
  static const int64_t huge[] = { INT64_MAX, (int64_t)1 << 62, (int64_t)1 << 40 };
  stratus_volume* v = &field->view;
  for (int axis = 0; axis < 3; ++axis) {
    if (fuzz_odd(f)) {
      const bool all = fuzz_chance(f, 0.5);
      v->dimensions[axis] = all ? huge[fuzz_below(f, 3)] : bad[fuzz_below(f, 5)];
      v->dimensions[(axis + 1) % 3] = all ? huge[fuzz_below(f, 3)] : v->dimensions[(axis + 1) % 3];
    }
  }
  if (fuzz_odd(f)) {
    v->value_stride = field->values > 4 && fuzz_chance(f, 0.5) ? INT64_MAX : bad[fuzz_below(f, 5)];
  }
  if (fuzz_odd(f)) {
    const int components = (int)(uint32_t)(uint64_t)fuzz_odd_integer(f);
    v->components = components < 0 || components > v->value_stride ? components : v->components;
  }
}

fuzz_field fuzz_volume(fuzz* f, int largest, int components)
{
  fuzz_field field = { .values = 1 };
  stratus_volume* v = &field.view;
  *v = stratus_volume_default();
  v->type = (stratus_type)fuzz_below(f, STRATUS_FLOAT64 + 1);
  v->components = components;
  v->value_stride = components + (fuzz_chance(f, 0.7) ? 0 : (int64_t)fuzz_below(f, 3));
  for (int axis = 0; axis < 3; ++axis) {
    v->dimensions[axis] = fuzz_chance(f, 0.12) ? 1 : 1 + (int64_t)fuzz_below(f, (uint64_t)largest);
    field.values *= (size_t)v->dimensions[axis];
  }
  v->cell_centered = fuzz_chance(f, 0.3);
  v->revision = fuzz_below(f, 3);
  choose_range(f, &field);
  field.bytes = ((field.values - 1) * (size_t)v->value_stride + (size_t)components) * stratus_type_size(v->type);
  void* values = make_values(f, &field);
  v->values = fuzz_input(f, values, field.bytes);
  free(values);
  add_ghosts(f, v);
  place(f, v);
  spoil_sizes(f, &field);
  v->values = fuzz_pointer(f, v->values);
  v->cell_centered = v->cell_ghosts ? v->cell_centered : fuzz_odd(f) ? -3 : v->cell_centered;
  v->type = fuzz_odd(f) ? (stratus_type)(fuzz_chance(f, 0.5) ? -1 : STRATUS_FLOAT64 + 1 + (int)fuzz_below(f, 99)) : v->type;
  look_at(f, &field);
  return field;
}

fuzz_field fuzz_row(fuzz* f, int64_t count)
{
  fuzz_field field = { .values = (size_t)count };
  stratus_volume* v = &field.view;
  *v = stratus_volume_default();
  v->type = (stratus_type)fuzz_below(f, STRATUS_FLOAT64 + 1);
  v->value_stride = 1 + (fuzz_chance(f, 0.7) ? 0 : (int64_t)fuzz_below(f, 3));
  v->dimensions[0] = count;
  choose_range(f, &field);
  field.bytes = ((field.values - 1) * (size_t)v->value_stride + 1) * stratus_type_size(v->type);
  void* values = make_values(f, &field);
  v->values = fuzz_input(f, values, field.bytes);
  free(values);
  return field;
}

void fuzz_row_changes(fuzz* f, fuzz_field* row)
{
  void* values = make_values(f, row);
  fuzz_change(f, row->view.values, values);
  free(values);
}

void fuzz_volume_changes(fuzz* f, fuzz_field* field)
{
  if (field->view.values && fuzz_is_tame(f)) {
    fuzz_row_changes(f, field);
    ++field->view.revision;
  }
}

/* ---- transfer functions */

/* `count` points of a value and `components` numbers in 0..1. */
static const double* points(fuzz* f, size_t count, size_t components, double low, double high)
{
  double numbers[5 * POINTS_MOST], at[POINTS_MOST];
  const double around = 0.2 * (high - low);
  for (size_t i = 0; i < count; ++i) {
    at[i] = i > 0 && fuzz_chance(f, 0.15) ? at[i - 1] : fuzz_between(f, low - around, high + around);
    for (size_t k = i; k > 0 && at[k - 1] > at[k]; --k) {
      const double swapped = at[k];
      at[k] = at[k - 1];
      at[k - 1] = swapped;
    }
  }
  for (size_t i = 0; i < count; ++i) {
    numbers[(components + 1) * i] = fuzz_odd(f) ? fuzz_odd_real(f) : at[i];
    for (size_t c = 1; c <= components; ++c) {
      const double t = fuzz_unit(f);
      numbers[(components + 1) * i + c] = fuzz_odd(f) ? fuzz_odd_real(f) : t < 0.25 ? 0.0 : t > 0.95 ? 1.0 : t * t;
    }
  }
  return fuzz_input(f, numbers, (components + 1) * count * sizeof *numbers);
}

/* A wrong count: 0, or one that no memory holds. */
static size_t count_of(fuzz* f, size_t count)
{
  static const size_t wrong[] = { 0, SIZE_MAX, SIZE_MAX / 2, SIZE_MAX / 8, (size_t)1 << 62 };
  return fuzz_odd(f) ? wrong[fuzz_below(f, sizeof wrong / sizeof *wrong)] : count;
}

stratus_transfer fuzz_transfer(fuzz* f, double low, double high, double edge)
{
  stratus_transfer t = stratus_transfer_default();
  const size_t opacities = 1 + fuzz_below(f, POINTS_MOST), colors = 1 + fuzz_below(f, POINTS_MOST - 2);
  t.opacity = fuzz_pointer(f, points(f, opacities, 1, low, high));
  t.color = fuzz_pointer(f, points(f, colors, 3, low, high));
  t.opacity_count = count_of(f, opacities);
  t.color_count = count_of(f, colors);
  t.unit_distance = fuzz_chance(f, 0.7) ? edge : edge * fuzz_scale(f, 1e-3, 1e3);
  t.unit_distance = fuzz_odd(f) ? fuzz_odd_real(f) : t.unit_distance;
  t.clamp = fuzz_flag(f);
  if (fuzz_chance(f, 0.15)) {
    const size_t gradients = 1 + fuzz_below(f, 3);
    t.gradient = fuzz_pointer(f, points(f, gradients, 1, 0.0, 0.3 * (high - low)));
    t.gradient_count = count_of(f, gradients);
  }
  t.weight = fuzz_chance(f, 0.5) ? 1.0 : fuzz_real(f, 0.0, 1.0);
  return t;
}

const stratus_transfer* fuzz_transfers(fuzz* f, int count, double low, double high, double edge)
{
  stratus_transfer* transfers = calloc((size_t)count, sizeof *transfers);
  for (int i = 0; transfers && i < count; ++i) {
    transfers[i] = fuzz_transfer(f, low, high, edge);
  }
  const stratus_transfer* result = fuzz_input(f, transfers, (size_t)count * sizeof *transfers);
  free(transfers);
  return result;
}

void fuzz_shading(fuzz* f, const double bounds[6], double edge, stratus_shading* shading)
{
  shading->on = fuzz_flag(f);
  shading->ambient = fuzz_real(f, 0.0, 1.0);
  shading->diffuse = fuzz_real(f, 0.0, 1.0);
  shading->specular = fuzz_real(f, 0.0, 1.0);
  shading->specular_power = fuzz_chance(f, 0.5) ? fuzz_real(f, 0.0, 2.0) : fuzz_real(f, 1.0, 128.0);
  shading->light_count = fuzz_integer(f, -1, STRATUS_LIGHTS_MAX);
  for (int i = 0; i < STRATUS_LIGHTS_MAX; ++i) {
    stratus_light* light = shading->lights + i;
    fuzz_vector(f, bounds[0] - 5.0 * edge, bounds[1] + 5.0 * edge, light->vector);
    fuzz_vector(f, 0.0, 1.0, light->color);
    light->separate_specular = fuzz_flag(f);
    fuzz_vector(f, 0.0, 1.0, light->specular_color);
    light->positional = fuzz_flag(f);
    light->follows_camera = !light->positional && fuzz_flag(f);
  }
  shading->one_sided = fuzz_flag(f);
  if (fuzz_chance(f, 0.02)) { /* seldom, since maps and cells take longer than all else */
    shading->shadows = fuzz_flag(f);
    shading->scattering = fuzz_real(f, 0.0, 1.0);
    shading->anisotropy = fuzz_real(f, -0.99, 0.99);
    shading->multiple = shading->scattering > 0.0 && fuzz_flag(f);
    fuzz_vector(f, 0.0, 1.0, shading->sky_zenith);
    fuzz_vector(f, 0.0, 1.0, shading->sky_horizon);
    fuzz_vector(f, -1.0, 1.0, shading->up);
  }
}
