/* SPDX-License-Identifier: BSD-3-Clause
 * Sets of effective voxels from one byte per voxel, and distances by a search of all voxels, for the tests of distance fields. */
#ifndef STRATUS_TESTING_FIELDS_H
#define STRATUS_TESTING_FIELDS_H

#include "distance_field.h"
#include "structures.h"

typedef struct test_set {
  int64_t n[3], count;
  uint8_t* effective;
  stratus_voxels* voxels;
} test_set;

static inline int64_t set_voxels(const test_set* s)
{
  return s->n[0] * s->n[1] * s->n[2];
}

static inline test_set make_set(int64_t nx, int64_t ny, int64_t nz)
{
  test_set s = { .n = { nx, ny, nz } };
  s.effective = calloc((size_t)set_voxels(&s), 1);
  assert_non_null(s.effective);
  return s;
}

/* Makes s->voxels from the bytes. */
static inline void take_set(stratus_context* context, test_set* s)
{
  const int64_t total = set_voxels(s);
  s->count = 0;
  for (int64_t v = 0; v < total; ++v) {
    s->count += s->effective[v];
  }
  int32_t* positions = malloc((size_t)(3 * s->count + 1) * sizeof *positions);
  int32_t* next = positions;
  assert_non_null(positions);
  for (int64_t v = 0; v < total; ++v) {
    if (s->effective[v]) {
      *next++ = (int32_t)(v % s->n[0]);
      *next++ = (int32_t)(v / s->n[0] % s->n[1]);
      *next++ = (int32_t)(v / (s->n[0] * s->n[1]));
    }
  }
  if (stratus_voxels_create_list(context, s->n, positions, (size_t)s->count, &s->voxels) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  free(positions);
}

/* fill: one voxel in so many is effective; 0: none, 1: all. */
static inline test_set make_random_set(stratus_context* context, int64_t nx, int64_t ny, int64_t nz, int64_t fill, uint32_t* random)
{
  test_set s = make_set(nx, ny, nz);
  for (int64_t v = 0; v < set_voxels(&s); ++v) {
    s.effective[v] = fill > 0 && random_below(random, fill) == 0;
  }
  take_set(context, &s);
  return s;
}

static inline void free_set(test_set* s)
{
  stratus_voxels_destroy(s->voxels);
  free(s->effective);
}

/* Returns the squared distance from voxel v to the nearest effective one, or -1 if there is none. If v is effective and the field is
 * signed, the nearest voxel that is not effective counts instead. *nearest: the nearest of the smallest index. */
static inline int64_t brute_squared(const test_set* s, int64_t v, int is_signed, int64_t* nearest)
{
  const int sought = !(is_signed && s->effective[v]);
  const int64_t nx = s->n[0], ny = s->n[1], total = set_voxels(s);
  int64_t best = -1;
  *nearest = -1;
  for (int64_t o = 0; o < total; ++o) {
    const int64_t x = o % nx - v % nx, y = o / nx % ny - v / nx % ny, z = o / (nx * ny) - v / (nx * ny);
    const int64_t squared = x * x + y * y + z * z;
    if (s->effective[o] == sought && (best < 0 || squared < best)) {
      best = squared;
      *nearest = o;
    }
  }
  return best;
}

/* Returns the value that stratus_field_get() should return for that distance. */
static inline double expected_distance(const test_set* s, int64_t v, int is_signed, int64_t squared)
{
  const double sign = is_signed && s->effective[v] ? -1.0 : 1.0;
  return sign * (squared < 0 ? INFINITY : sqrt((double)squared));
}

static inline double distance_at(const stratus_field* field, int64_t v)
{
  return stratus_field_get(field, v % field->n[0], v / field->n[0] % field->n[1], v / (field->n[0] * field->n[1]));
}

static inline stratus_field* make_field(
  stratus_context* context, const test_set* s, stratus_field_method method, int is_signed, stratus_field_report* report)
{
  stratus_field_options options = stratus_field_options_default();
  stratus_field* field = NULL;
  options.method = method;
  options.is_signed = is_signed;
  if (stratus_field_create(context, s->voxels, &options, &field, report) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  return field;
}

#endif
