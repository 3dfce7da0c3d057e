/* SPDX-License-Identifier: BSD-3-Clause
 * A coarse copy of a large volume: every so manieth value along each axis. Guesses follow from the frequencies of values and from their
 * places, and these hardly depend on the values in between, of which each would have to be read. A copy of a volume with an identity is
 * kept, and is the picture that is shown until the values are there. */
#include "look_sample.h"

#include "volume_kept.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A volume of more values is sampled; about so many are taken, along no axis fewer than AXIS_LEAST. */
#define VALUES_MOST ((size_t)1 << 26)
#define VALUES_TAKEN ((double)(1 << 24))
#define AXIS_LEAST 64
#define KIND "coarse" /* of kept files */

static int64_t step_along(const stratus_volume* volume, int axis)
{
  const double step = ceil(cbrt((double)stratus_volume_count(volume) / VALUES_TAKEN));
  const int64_t most = volume->dimensions[axis] / AXIS_LEAST;
  return step > 1.0 && most > 1 ? (int64_t)step < most ? (int64_t)step : most : 1;
}

bool stratus_look_samples(const stratus_volume* volume)
{
  return stratus_volume_count(volume) > VALUES_MOST;
}

static int64_t number_of(const int64_t step[3])
{
  return (step[2] << 20 | step[1]) << 20 | step[0];
}

static size_t bytes_of(const stratus_look_sample* sample)
{
  return stratus_volume_count(&sample->view) * stratus_type_size(sample->view.type);
}

stratus_status stratus_look_sample_begin(stratus_context* context, const stratus_volume* volume, stratus_look_sample* sample)
{
  stratus_volume* const view = &sample->view;
  size_t places = 0;
  *view = *volume;
  for (int a = 0; a < 3; ++a) {
    sample->step[a] = step_along(volume, a);
    view->dimensions[a] = (volume->dimensions[a] + sample->step[a] - 1) / sample->step[a];
    view->spacing[a] *= (double)sample->step[a];
    places += volume->coordinates[a] ? (size_t)view->dimensions[a] + 1 : 0;
  }
  const size_t at_places = (bytes_of(sample) + 7) / 8 * 8;
  TRY(stratus_allocate(context, at_places + places * sizeof(double), 1, &sample->memory));
  view->values = sample->memory;
  view->value_stride = view->components = 1;
  view->identity = 0;
  view->missing = NULL;
  view->tiles = (stratus_tiles){ .values = NULL };
  view->constants = NULL;
  view->gradients = NULL;
  view->point_ghosts = view->cell_ghosts = NULL;
  double* place = (double*)(void*)((char*)sample->memory + at_places);
  for (int a = 0; a < 3; ++a) {
    const int64_t count = view->dimensions[a] + (volume->cell_centered ? 1 : 0);
    const int64_t last = volume->dimensions[a] - (volume->cell_centered ? 0 : 1);
    for (int64_t i = 0; volume->coordinates[a] && i < count; ++i) {
      place[i] = volume->coordinates[a][i * sample->step[a] < last ? i * sample->step[a] : last];
    }
    view->coordinates[a] = volume->coordinates[a] ? place : NULL;
    place += volume->coordinates[a] ? view->dimensions[a] + 1 : 0;
  }
  return STRATUS_OK;
}

/* Copies a value from a tile; one of a constant tile without reading it. */
static void copy_from_tile(const stratus_volume* volume, int64_t x, int64_t y, int64_t z, void* to)
{
  const stratus_constants* parts = volume->constants;
  const int64_t at[3] = { (parts->before[0] + x) / parts->side[0], (parts->before[1] + y) / parts->side[1],
    (parts->before[2] + z) / parts->side[2] };
  const float one = parts->only[(at[2] * parts->across[1] + at[1]) * parts->across[0] + at[0]];
  if (isnan(one)) {
    stratus_volume_copy_row(volume, x, y, z, 1, to);
  } else {
    stratus_type_fill(volume->type, one, to, 1);
  }
}

void stratus_look_sample_rows(
  const stratus_look_sample* sample, const stratus_volume* volume, int64_t y0, int64_t y1, int64_t z0, int64_t z1)
{
  const size_t size = stratus_type_size(volume->type);
  const int64_t *n = volume->dimensions, *m = sample->view.dimensions, *step = sample->step;
  const bool tiled = stratus_volume_has_constants(volume);
  for (int64_t k = (z0 + step[2] - 1) / step[2]; k < m[2] && k * step[2] < z1; ++k) {
    for (int64_t j = (y0 + step[1] - 1) / step[1]; j < m[1] && j * step[1] < y1; ++j) {
      const char* from = (const char*)volume->values + (size_t)((k * step[2] * n[1] + j * step[1]) * n[0] * volume->value_stride) * size;
      char* to = (char*)sample->memory + (size_t)((k * m[1] + j) * m[0]) * size;
      for (int64_t i = 0; i < m[0] && tiled; ++i) {
        copy_from_tile(volume, i * step[0], j * step[1], k * step[2], to + (size_t)i * size);
      }
      for (int64_t i = 0; i < m[0] && !tiled; ++i) {
        memcpy(to + (size_t)i * size, from + (size_t)(i * step[0] * volume->value_stride) * size, size);
      }
    }
  }
}

bool stratus_look_sample_recall(stratus_context* context, const stratus_volume* volume, stratus_look_sample* sample)
{
  uint8_t* const kept = stratus_kept_recall(context, volume, KIND, number_of(sample->step), bytes_of(sample));
  if (kept) {
    memcpy(sample->memory, kept, bytes_of(sample));
  }
  free(kept);
  return kept != NULL;
}

void stratus_look_sample_keep(const stratus_volume* volume, const stratus_look_sample* sample)
{
  stratus_kept_keep(volume, KIND, number_of(sample->step), sample->memory, bytes_of(sample));
}

stratus_status stratus_look_sample_make(stratus_context* context, const stratus_volume* volume, stratus_look_sample* sample)
{
  TRY(stratus_look_sample_begin(context, volume, sample));
  if (!stratus_look_sample_recall(context, volume, sample)) {
    const int64_t rows = sample->view.dimensions[1] * sample->view.dimensions[2];
#pragma omp parallel for num_threads(context->threads)
    for (int64_t row = 0; row < rows; ++row) {
      const int64_t y = row % sample->view.dimensions[1] * sample->step[1], z = row / sample->view.dimensions[1] * sample->step[2];
      stratus_look_sample_rows(sample, volume, y, y + 1, z, z + 1);
    }
    stratus_look_sample_keep(volume, sample);
  }
  return STRATUS_OK;
}

/* ---- the copy as callers see it */

struct stratus_coarse {
  stratus_context* context;
  stratus_look_sample sample;
};

stratus_status stratus_coarse_recall(stratus_context* context, const stratus_volume* volume, stratus_coarse** coarse)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!coarse) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "no place for the coarse volume: its address is NULL");
  }
  TRY(stratus_volume_check(context, volume));
  if (!stratus_look_samples(volume) || volume->identity == 0 || volume->components > 1) {
    return stratus_fail(context, STRATUS_UNSUPPORTED,
      "coarse volumes are kept of volumes of one component, an identity, and more than %zu values", VALUES_MOST);
  }
  void* memory = NULL;
  TRY(stratus_allocate(context, 1, sizeof(stratus_coarse), &memory));
  stratus_coarse* const made = memory;
  made->context = context;
  made->sample.memory = NULL;
  stratus_status status = stratus_look_sample_begin(context, volume, &made->sample);
  if (status == STRATUS_OK && !stratus_look_sample_recall(context, volume, &made->sample)) {
    status = stratus_fail(context, STRATUS_UNSUPPORTED, "no coarse volume is kept of this one: its value ranges were not found yet");
  }
  if (status != STRATUS_OK) {
    stratus_coarse_destroy(made);
    return status;
  }
  *coarse = made;
  return STRATUS_OK;
}

const stratus_volume* stratus_coarse_volume(const stratus_coarse* coarse)
{
  return coarse ? &coarse->sample.view : NULL;
}

void stratus_coarse_destroy(stratus_coarse* coarse)
{
  if (coarse) {
    stratus_context* const context = coarse->context;
    stratus_release(context, coarse->sample.memory);
    stratus_release(context, coarse);
  }
}
