/* SPDX-License-Identifier: BSD-3-Clause
 * Distance fields: checks, the choice of the builder, and reading. */
#include "distance_field.h"

#include "device.h"
#include "jump_flooding_passes.h"

#include <string.h>

#define METHOD_LAST STRATUS_FIELD_AJFA_FIG5

const char* stratus_field_method_name(stratus_field_method method)
{
  static const char* const names[] = { "exact", "zigzag", "envelope", "jfa", "jfa+1", "jfa+2", "1+jfa", "jfa2", "ajfa", "ajfa-fig5" };
  return (int)method >= 0 && method <= METHOD_LAST ? names[method] : "unknown";
}

stratus_field_options stratus_field_options_default(void)
{
  return (stratus_field_options){ .method = STRATUS_FIELD_EXACT };
}

/* ---- bits */

/* Index of the first brick at brick plane `plane` or above. */
static int64_t first_brick(const stratus_voxels* voxels, int64_t plane)
{
  int64_t low = 0, high = voxels->brick_count;
  while (low < high) {
    const int64_t middle = low + (high - low) / 2;
    if (voxels->bricks[middle].at[2] < plane) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

static void set_brick(const stratus_brick* brick, const stratus_bits* set)
{
  const int64_t i = (int64_t)brick->at[0] * STRATUS_BRICK, j = (int64_t)brick->at[1] * STRATUS_BRICK;
  const int64_t k = (int64_t)brick->at[2] * STRATUS_BRICK;
  for (int64_t z = 0; z < STRATUS_BRICK && k + z < set->n[2]; ++z) {
    for (int64_t y = 0; y < STRATUS_BRICK && j + y < set->n[1]; ++y) {
      const uint64_t four = brick->mask >> (z * STRATUS_BRICK + y) * STRATUS_BRICK & 0xf;
      set->bits[((k + z) * set->n[1] + j + y) * set->words + (i >> 6)] |= four << (i & 63);
    }
  }
}

static stratus_status create_bits(stratus_context* context, const stratus_voxels* voxels, stratus_bits* set)
{
  size_t count;
  void* memory;
  memcpy(set->n, voxels->dimensions, sizeof set->n);
  set->words = (set->n[0] + 63) / 64;
  TRY(stratus_product(context, "effective voxels", (size_t)set->words, (size_t)set->n[1], (size_t)set->n[2], &count));
  TRY(stratus_allocate_zero(context, count, sizeof(uint64_t), &memory));
  set->bits = memory;
  const int64_t planes = (set->n[2] + STRATUS_BRICK - 1) / STRATUS_BRICK;
#pragma omp parallel for schedule(dynamic, 1) num_threads(context->threads)
  for (int64_t plane = 0; plane < planes; ++plane) {
    const int64_t end = first_brick(voxels, plane + 1);
    for (int64_t b = first_brick(voxels, plane); b < end; ++b) {
      set_brick(&voxels->bricks[b], set);
    }
  }
  return STRATUS_OK;
}

/* ---- building */

static stratus_status check_options(stratus_context* context, const stratus_field_options* options)
{
  if ((int)options->method < STRATUS_FIELD_EXACT || options->method > METHOD_LAST) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "method %d outside %d..%d", (int)options->method, STRATUS_FIELD_EXACT, METHOD_LAST);
  }
  if (options->is_signed != 0 && options->is_signed != 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "is_signed %d outside 0..1", options->is_signed);
  }
  if (options->first_step < 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "first_step %d below 0", options->first_step);
  }
  return STRATUS_OK;
}

/* Without an effective voxel, or without another, all distances are the same and need no array. */
static bool make_uniform(const stratus_voxels* voxels, size_t count, stratus_field* field)
{
  if (voxels->count == 0) {
    field->uniform = INFINITY;
  } else if ((size_t)voxels->count == count) {
    field->uniform = field->is_signed ? -INFINITY : 0.0;
  } else {
    return false;
  }
  return true;
}

static stratus_status fill_exact(stratus_context* context, const stratus_voxels* voxels, const stratus_bits* set, stratus_field* field)
{
  if (stratus_field_on_device(context, set->n, sizeof(int64_t))) {
    const stratus_status status = stratus_device_field_exact(context, set, field);
    if (!stratus_device_hands_back(context, status)) {
      return status;
    }
  }
  return stratus_field_exact(context, voxels, set, field);
}

static stratus_status build(stratus_context* context, const stratus_voxels* voxels, const stratus_field_options* options, size_t count,
  stratus_field* field, stratus_field_report* report)
{
  stratus_status status = STRATUS_OK;
  stratus_bits set = { .bits = NULL };
  const bool flood = options->method >= STRATUS_FIELD_JFA;
  if (!flood) {
    report->passes = 3;
    if (make_uniform(voxels, count, field)) {
      return STRATUS_OK;
    }
  }
  TRY_CLEANUP(create_bits(context, voxels, &set));
  if (flood) {
    TRY_CLEANUP(stratus_flood(context, &set, options, field, report));
    field->set = set;
    set.bits = NULL;
  } else {
    TRY_CLEANUP(fill_exact(context, voxels, &set, field));
  }

cleanup:
  stratus_release(context, set.bits);
  return status;
}

static size_t bytes_of(const stratus_field* field)
{
  const size_t voxels = (size_t)field->n[0] * (size_t)field->n[1] * (size_t)field->n[2];
  const size_t words = (size_t)field->set.n[1] * (size_t)field->set.n[2] * (size_t)field->set.words;
  return (field->values ? voxels * (size_t)field->bytes : 0) + (field->nearest ? voxels * sizeof *field->nearest : 0) +
    words * sizeof *field->set.bits;
}

stratus_status stratus_field_create(stratus_context* context, const stratus_voxels* voxels, const stratus_field_options* options,
  stratus_field** out, stratus_field_report* report)
{
  stratus_status status = STRATUS_OK;
  const stratus_field_options defaults = stratus_field_options_default();
  const double start = stratus_now_ms();
  stratus_field_report made = { .passes = 0 };
  stratus_field* field = NULL;
  size_t count, bytes;
  void* memory;

  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!voxels || !out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", voxels ? "field" : "voxels");
  }
  options = options ? options : &defaults;
  TRY(check_options(context, options));
  const int64_t* n = voxels->dimensions;
  TRY(stratus_product(context, "distance field", (size_t)n[0], (size_t)n[1], (size_t)n[2], &count));
  TRY(stratus_product(context, "distance field", count, sizeof(int32_t), 1, &bytes));
  TRY(stratus_progress(context, "distance field", 0.0));
  TRY(stratus_allocate_zero(context, 1, sizeof *field, &memory));
  field = memory;
  field->context = context;
  field->method = options->method;
  field->is_signed = options->is_signed;
  field->effective = voxels->count;
  memcpy(field->n, n, sizeof field->n);
  const stratus_stage stage = stratus_stage_begin(context);
  TRY_CLEANUP(build(context, voxels, options, count, field, &made));
  stratus_stage_end(context, &stage, "distance field", bytes_of(field));
  TRY_CLEANUP(stratus_progress(context, "distance field", 1.0));
  made.build_ms = stratus_now_ms() - start;
  if (report) {
    *report = made;
  }
  *out = field;
  field = NULL;

cleanup:
  stratus_field_destroy(field);
  return status;
}

void stratus_field_destroy(stratus_field* field)
{
  if (field) {
    stratus_context* context = field->context;
    stratus_release(context, field->values);
    stratus_release(context, field->nearest);
    stratus_release(context, field->set.bits);
    stratus_release(context, field);
  }
}

/* ---- reading */

/* Distance from the voxel to the one that a flooding found nearest. */
static double flooded_distance(const stratus_field* field, flood_layout layout, int64_t i, int64_t j, int64_t k)
{
  const uint32_t nearest = field->nearest[(k * field->n[1] + j) * field->n[0] + i];
  const double sign = field->is_signed && stratus_bits_get(&field->set, i, j, k) ? -1.0 : 1.0;
  if (nearest == FLOOD_UNKNOWN) {
    return sign * INFINITY;
  }
  int64_t at[3];
  flood_unpack(nearest, layout, at);
  const double x = (double)(at[0] - i), y = (double)(at[1] - j), z = (double)(at[2] - k);
  return sign * sqrt(x * x + y * y + z * z);
}

static double signed_root(double squared)
{
  return squared < 0.0 ? -sqrt(-squared) : sqrt(squared);
}

double stratus_field_get(const stratus_field* field, int64_t i, int64_t j, int64_t k)
{
  if (!field || i < 0 || j < 0 || k < 0 || i >= field->n[0] || j >= field->n[1] || k >= field->n[2]) {
    return INFINITY;
  }
  const int64_t at = (k * field->n[1] + j) * field->n[0] + i;
  if (field->nearest) {
    return flooded_distance(field, flood_shifts(field->n), i, j, k);
  }
  switch (field->bytes) {
    case 2:
      return signed_root(((const int16_t*)field->values)[at]);
    case 4:
      return signed_root(((const int32_t*)field->values)[at]);
    case 8:
      return signed_root((double)((const int64_t*)field->values)[at]);
    default:
      return field->uniform;
  }
}

/* Below 2^24 a float holds the square exactly, and its root rounds as the double's root does. roots_4() takes double roots, as its squares
 * may be larger. */
static void roots_2(const int16_t* restrict squared, int64_t n, float* restrict distances)
{
  for (int64_t i = 0; i < n; ++i) {
    const float s = squared[i], root = sqrtf(fabsf(s));
    distances[i] = s < 0.0f ? -root : root;
  }
}

static void roots_4(const int32_t* restrict squared, int64_t n, float* restrict distances)
{
  for (int64_t i = 0; i < n; ++i) {
    const double s = squared[i], root = sqrt(fabs(s));
    distances[i] = (float)(s < 0.0 ? -root : root);
  }
}

/* Reads row (j, k) as floats. */
static void read_row(const stratus_field* field, int64_t j, int64_t k, float* distances)
{
  const int64_t nx = field->n[0], first = (k * field->n[1] + j) * nx;
  if (field->nearest) {
    const flood_layout layout = flood_shifts(field->n);
    for (int64_t i = 0; i < nx; ++i) {
      distances[i] = (float)flooded_distance(field, layout, i, j, k);
    }
  } else if (field->bytes == 2) {
    roots_2((const int16_t*)field->values + first, nx, distances);
  } else if (field->bytes == 4) {
    roots_4((const int32_t*)field->values + first, nx, distances);
  } else {
    for (int64_t i = 0; i < nx; ++i) {
      distances[i] = (float)stratus_field_get(field, i, j, k);
    }
  }
}

void stratus_field_distances(const stratus_field* field, float* distances)
{
  if (!field || !distances) {
    return;
  }
  const int64_t nx = field->n[0], ny = field->n[1], rows = ny * field->n[2];
#pragma omp parallel for schedule(static) num_threads(field->context->threads)
  for (int64_t row = 0; row < rows; ++row) {
    read_row(field, row % ny, row / ny, distances + row * nx);
  }
}

/* ---- the paper's layout */

static void write_flooded(const stratus_field* field, float* rgba)
{
  const flood_layout layout = flood_shifts(field->n);
  const int64_t count = field->n[0] * field->n[1] * field->n[2];
#pragma omp parallel for schedule(static) num_threads(field->context->threads)
  for (int64_t v = 0; v < count; ++v) {
    int64_t at[3] = { -1, -1, -1 };
    if (field->nearest[v] != FLOOD_UNKNOWN) {
      flood_unpack(field->nearest[v], layout, at);
    }
    for (int a = 0; a < 3; ++a) {
      rgba[4 * v + a] = (float)at[a];
    }
  }
}

static void write_distances(const stratus_field* field, float* rgba)
{
  const int64_t nx = field->n[0], rows = field->n[1] * field->n[2];
#pragma omp parallel for schedule(static) num_threads(field->context->threads)
  for (int64_t row = 0; row < rows; ++row) {
    for (int64_t i = 0; i < nx; ++i) {
      rgba[4 * (row * nx + i) + 3] = (float)stratus_field_get(field, i, row % field->n[1], row / field->n[1]);
    }
  }
}

stratus_status stratus_field_rgba(const stratus_field* field, const stratus_voxels* voxels, float* rgba)
{
  if (!field) {
    return STRATUS_INVALID_ARGUMENT;
  }
  stratus_context* context = field->context;
  if (!voxels || !rgba) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", voxels ? "rgba" : "voxels");
  }
  if (memcmp(voxels->dimensions, field->n, sizeof field->n) != 0 || voxels->count != field->effective) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "the field is of other voxels: %lld x %lld x %lld with %lld effective, not %lld x %lld x %lld with %lld", (long long)field->n[0],
      (long long)field->n[1], (long long)field->n[2], (long long)field->effective, (long long)voxels->dimensions[0],
      (long long)voxels->dimensions[1], (long long)voxels->dimensions[2], (long long)voxels->count);
  }
  if (field->nearest) {
    write_flooded(field, rgba);
  } else {
    stratus_bits set = { .bits = NULL };
    TRY(create_bits(context, voxels, &set));
    const stratus_status status = stratus_field_nearest(context, &set, field->is_signed, rgba);
    stratus_release(context, set.bits);
    TRY(status);
  }
  write_distances(field, rgba);
  return STRATUS_OK;
}
