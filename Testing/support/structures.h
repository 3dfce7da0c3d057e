/* SPDX-License-Identifier: BSD-3-Clause
 * Random volumes and grids, and slow, obvious constructions of their structures, for the tests of host and device. */
#ifndef STRATUS_TESTING_STRUCTURES_H
#define STRATUS_TESTING_STRUCTURES_H

#include "volume.h"

#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static inline uint32_t next_random(uint32_t* state)
{
  *state = *state * 1664525u + 1013904223u;
  return *state >> 8;
}

static inline int64_t random_below(uint32_t* state, int64_t n)
{
  return (int64_t)next_random(state) % n;
}

/* ---- volumes */

/* A volume that owns its values. Their memory has exactly their size, so that the address sanitizer catches any read beyond. */
typedef struct sample_volume {
  stratus_volume view;
  void* values;
  uint8_t *point_ghosts, *cell_ghosts;
} sample_volume;

static inline void set_value(void* values, stratus_type type, int64_t at, uint32_t* random)
{
  const uint64_t bits = (uint64_t)next_random(random) << 40 ^ (uint64_t)next_random(random) << 20 ^ next_random(random);
  switch (type) {
    case STRATUS_INT8:
    case STRATUS_UINT8:
      ((uint8_t*)values)[at] = (uint8_t)bits;
      break;
    case STRATUS_INT16:
    case STRATUS_UINT16:
      ((uint16_t*)values)[at] = (uint16_t)bits;
      break;
    case STRATUS_INT32:
    case STRATUS_UINT32:
      ((uint32_t*)values)[at] = (uint32_t)bits;
      break;
    case STRATUS_INT64:
    case STRATUS_UINT64:
      ((uint64_t*)values)[at] = bits;
      break;
    case STRATUS_FLOAT32:
      ((float*)values)[at] = (float)(bits % 2001) / 1000.0f - 1.0f;
      break;
    case STRATUS_FLOAT64:
      ((double*)values)[at] = 6e6 + (double)(bits % 2000003) / 1e6;
      break;
  }
}

/* Replaces one value in `one_in` by NaN, an infinity, a zero of either sign, or a number that overflows a float. */
static inline void spoil(sample_volume* v, int64_t one_in, uint32_t* random)
{
  static const double odd[] = { NAN, INFINITY, -INFINITY, 0.0, -0.0, 1e300, -1e300 };
  const stratus_volume* view = &v->view;
  const int64_t count = view->dimensions[0] * view->dimensions[1] * view->dimensions[2];
  for (int64_t i = 0; i < count; ++i) {
    if (random_below(random, one_in) == 0) {
      const double value = odd[random_below(random, 7)];
      if (view->type == STRATUS_FLOAT32) {
        ((float*)v->values)[i * view->value_stride] = (float)value;
      } else if (view->type == STRATUS_FLOAT64) {
        ((double*)v->values)[i * view->value_stride] = value;
      }
    }
  }
}

static inline sample_volume make_volume(stratus_type type, int64_t nx, int64_t ny, int64_t nz, int64_t stride, uint32_t* random)
{
  sample_volume v = { .view = stratus_volume_default() };
  const int64_t last = (nx * ny * nz - 1) * stride;
  v.values = malloc((size_t)(last + 1) * stratus_type_size(type));
  assert_non_null(v.values);
  for (int64_t i = 0; i <= last; ++i) {
    set_value(v.values, type, i, random);
  }
  v.view.values = v.values;
  v.view.type = type;
  v.view.dimensions[0] = nx;
  v.view.dimensions[1] = ny;
  v.view.dimensions[2] = nz;
  v.view.value_stride = stride;
  return v;
}

/* Sets random flags on one point in `one_in` and one cell in `one_in`. */
static inline void add_ghosts(sample_volume* v, int cell_centered, int64_t one_in, uint32_t* random)
{
  const int64_t* n = v->view.dimensions;
  const int64_t count = n[0] * n[1] * n[2];
  v->point_ghosts = malloc((size_t)count);
  v->cell_ghosts = malloc((size_t)count);
  assert_non_null(v->point_ghosts);
  assert_non_null(v->cell_ghosts);
  for (int64_t i = 0; i < count; ++i) {
    v->point_ghosts[i] = random_below(random, one_in) ? STRATUS_GHOST_DUPLICATE : STRATUS_GHOST_HIDDEN_POINT;
    v->cell_ghosts[i] = random_below(random, one_in) ? STRATUS_GHOST_DUPLICATE : STRATUS_GHOST_HIDDEN_CELL;
  }
  v->view.point_ghosts = v->point_ghosts;
  v->view.cell_ghosts = v->cell_ghosts;
  v->view.cell_centered = cell_centered;
}

static inline void free_volume(sample_volume* v)
{
  free(v->values);
  free(v->point_ghosts);
  free(v->cell_ghosts);
}

/* ---- grids of blocks */

/* fill: 0: empty; 1: full; 2: a single occupied block; else one block in `fill` is occupied. */
static inline stratus_occupancy* make_occupancy(
  stratus_context* context, int64_t nx, int64_t ny, int64_t nz, int64_t fill, uint32_t* random)
{
  const int64_t count = nx * ny * nz;
  void* memory;
  assert_int_equal(stratus_allocate_zero(context, 1, sizeof(stratus_occupancy), &memory), STRATUS_OK);
  stratus_occupancy* o = memory;
  o->context = context;
  o->blocks[0] = nx;
  o->blocks[1] = ny;
  o->blocks[2] = nz;
  o->block_size = 4;
  assert_int_equal(stratus_allocate_zero(context, (size_t)count, 1, &memory), STRATUS_OK);
  o->occupied = memory;
  const int64_t single = random_below(random, count);
  for (int64_t b = 0; b < count; ++b) {
    o->occupied[b] = fill == 0 ? 0 : fill == 1 ? 1 : fill == 2 ? b == single : random_below(random, fill) == 0;
    if (o->occupied[b]) {
      const int64_t at[3] = { b % nx, b / nx % ny, b / nx / ny };
      for (int a = 0; a < 3; ++a) {
        o->lo[a] = o->count == 0 || at[a] < o->lo[a] ? at[a] : o->lo[a];
        o->hi[a] = at[a] >= o->hi[a] ? at[a] + 1 : o->hi[a];
      }
      ++o->count;
    }
  }
  return o;
}

static inline stratus_context* make_context(const char* device, int threads)
{
  stratus_context_options options = stratus_context_options_default();
  options.device = device;
  options.threads = threads;
  stratus_context* context = NULL;
  char message[1024];
  if (stratus_context_create(&options, &context, message, sizeof message) != STRATUS_OK) {
    fail_msg("%s", message);
  }
  return context;
}

#endif
