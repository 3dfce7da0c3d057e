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
  view->parts = NULL;
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

void stratus_look_sample_part(const stratus_look_sample* sample, const stratus_part* part)
{
  const size_t size = stratus_type_size(sample->view.type);
  const int64_t *m = sample->view.dimensions, *step = sample->step, *lo = part->lo;
  int64_t first[3], beyond[3];
  for (int a = 0; a < 3; ++a) {
    const int64_t end = (lo[a] + part->size[a] + step[a] - 1) / step[a];
    first[a] = (lo[a] + step[a] - 1) / step[a];
    beyond[a] = end < m[a] ? end : m[a];
  }
  for (int64_t k = first[2]; k < beyond[2]; ++k) {
    for (int64_t j = first[1]; j < beyond[1]; ++j) {
      const size_t row = (size_t)(k * step[2] - lo[2]) * part->pitch[2] + (size_t)(j * step[1] - lo[1]) * part->pitch[1];
      char* to = (char*)sample->memory + (size_t)((k * m[1] + j) * m[0] + first[0]) * size;
      for (int64_t i = first[0]; i < beyond[0]; ++i, to += size) {
        if (part->values) {
          memcpy(to, (const char*)part->values + row + (size_t)(i * step[0] - lo[0]) * part->pitch[0], size);
        } else {
          stratus_type_fill(sample->view.type, part->one, to, 1);
        }
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
    const stratus_parts* parts = stratus_volume_parts(volume);
    const int64_t count = parts ? parts->count : sample->view.dimensions[2];
#pragma omp parallel num_threads(context->threads)
    {
      stratus_part part = stratus_volume_whole(volume);
#pragma omp for schedule(dynamic)
      for (int64_t n = 0; n < count; ++n) {
        if (parts) {
          parts->read(parts->user, n, &part);
          stratus_look_sample_part(sample, &part);
        } else {
          const stratus_part layer = stratus_part_rows(&part, 0, volume->dimensions[1], n * sample->step[2], n * sample->step[2] + 1);
          stratus_look_sample_part(sample, &layer);
        }
      }
      free(part.room);
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
