/* SPDX-License-Identifier: BSD-3-Clause
 * A sample of a large volume's values, for guesses: every so manieth value along each axis. A guess follows from the frequencies of values
 * and from their places, and these hardly depend on the values in between, of which each would have to be read. */
#include "look_sample.h"

#include <math.h>
#include <string.h>

/* A volume of more values is sampled; about so many are taken, along no axis fewer than AXIS_LEAST. */
#define VALUES_MOST ((size_t)1 << 26)
#define VALUES_TAKEN ((double)(1 << 24))
#define AXIS_LEAST 64

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

/* Copies one value in `step` along x from rows at the same steps. */
static void take(const stratus_context* context, const stratus_volume* volume, const int64_t step[3], const stratus_volume* sample)
{
  const size_t size = stratus_type_size(volume->type);
  const int64_t *n = volume->dimensions, *m = sample->dimensions, rows = m[1] * m[2];
  const char* from = volume->values;
  char* to = (char*)(uintptr_t)sample->values;
#pragma omp parallel for num_threads(context->threads)
  for (int64_t row = 0; row < rows; ++row) {
    const int64_t j = row % m[1] * step[1], k = row / m[1] * step[2];
    for (int64_t i = 0; i < m[0]; ++i) {
      const int64_t at = ((k * n[1] + j) * n[0] + i * step[0]) * volume->value_stride;
      memcpy(to + (size_t)(row * m[0] + i) * size, from + (size_t)at * size, size);
    }
  }
}

stratus_status stratus_look_sample_make(stratus_context* context, const stratus_volume* volume, stratus_volume* sample, void** memory)
{
  int64_t step[3];
  size_t places = 0;
  *sample = *volume;
  for (int a = 0; a < 3; ++a) {
    step[a] = step_along(volume, a);
    sample->dimensions[a] = (volume->dimensions[a] + step[a] - 1) / step[a];
    sample->spacing[a] *= (double)step[a];
    places += volume->coordinates[a] ? (size_t)sample->dimensions[a] + 1 : 0;
  }
  const size_t size = stratus_type_size(volume->type), at_places = (stratus_volume_count(sample) * size + 7) / 8 * 8;
  TRY(stratus_allocate(context, at_places + places * sizeof(double), 1, memory));
  sample->values = *memory;
  sample->value_stride = sample->components = 1;
  sample->identity = 0;
  sample->point_ghosts = sample->cell_ghosts = NULL;
  double* place = (double*)(void*)((char*)*memory + at_places);
  for (int a = 0; a < 3; ++a) {
    const int64_t count = sample->dimensions[a] + (volume->cell_centered ? 1 : 0);
    const int64_t last = volume->dimensions[a] - (volume->cell_centered ? 0 : 1);
    for (int64_t i = 0; volume->coordinates[a] && i < count; ++i) {
      place[i] = volume->coordinates[a][i * step[a] < last ? i * step[a] : last];
    }
    sample->coordinates[a] = volume->coordinates[a] ? place : NULL;
    place += volume->coordinates[a] ? sample->dimensions[a] + 1 : 0;
  }
  take(context, volume, step, sample);
  return STRATUS_OK;
}
