/* SPDX-License-Identifier: BSD-3-Clause
 * The frequencies of the values of a volume or of its blocks. */
#include "look_histogram.h"

#include <string.h>

#define CONVERT(type)                                                                                                                      \
  for (int64_t i = 0; i < count; ++i) {                                                                                                    \
    values[i] = (double)((const type*)volume->values)[(first + i) * volume->value_stride];                                                 \
  }                                                                                                                                        \
  break

void stratus_look_values_get(const stratus_volume* volume, int64_t first, int64_t count, double* values)
{
  switch (volume->type) {
    case STRATUS_INT8:
      CONVERT(int8_t);
    case STRATUS_UINT8:
      CONVERT(uint8_t);
    case STRATUS_INT16:
      CONVERT(int16_t);
    case STRATUS_UINT16:
      CONVERT(uint16_t);
    case STRATUS_INT32:
      CONVERT(int32_t);
    case STRATUS_UINT32:
      CONVERT(uint32_t);
    case STRATUS_INT64:
      CONVERT(int64_t);
    case STRATUS_UINT64:
      CONVERT(uint64_t);
    case STRATUS_FLOAT32:
      CONVERT(float);
    case STRATUS_FLOAT64:
      CONVERT(double);
  }
}

/* ---- points that blocks share */

typedef struct block_box {
  double low[3], high[3];
} block_box;

/* Local position of a value. The matrix is left out, because all blocks share it. */
static void position_of(const stratus_volume* v, const int64_t at[3], double position[3])
{
  double local[3];
  for (int a = 0; a < 3; ++a) {
    local[a] = v->coordinates[a] ? v->coordinates[a][at[a]] : v->spacing[a] * (double)at[a];
  }
  for (int r = 0; r < 3; ++r) {
    position[r] = v->origin[r] + v->direction[3 * r] * local[0] + v->direction[3 * r + 1] * local[1] + v->direction[3 * r + 2] * local[2];
  }
}

/* With a slack of a millionth of a cell, because the coordinates of two blocks are rounded apart. */
static block_box box_of(const stratus_volume* v)
{
  block_box box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
  const double slack = 1e-6 * fmin(fabs(v->spacing[0]), fmin(fabs(v->spacing[1]), fabs(v->spacing[2])));
  for (int corner = 0; corner < 8; ++corner) {
    int64_t at[3];
    double position[3];
    for (int a = 0; a < 3; ++a) {
      at[a] = corner >> a & 1 ? v->dimensions[a] - 1 : 0;
    }
    position_of(v, at, position);
    for (int a = 0; a < 3; ++a) {
      box.low[a] = fmin(box.low[a], position[a] - slack);
      box.high[a] = fmax(box.high[a], position[a] + slack);
    }
  }
  return box;
}

static bool is_in_earlier(const block_box* boxes, int earlier, const double position[3])
{
  for (int b = 0; b < earlier; ++b) {
    bool inside = true;
    for (int a = 0; a < 3; ++a) {
      inside = inside && boxes[b].low[a] <= position[a] && position[a] <= boxes[b].high[a];
    }
    if (inside) {
      return true;
    }
  }
  return false;
}

/* Lists the shared points of block n if `shared` is not NULL. Returns their number. */
static size_t list_shared(const stratus_volume* volumes, int n, const block_box* boxes, stratus_look_shared* shared)
{
  const stratus_volume* v = volumes + n;
  const int64_t* size = v->dimensions;
  size_t found = 0;
  for (int64_t z = 0; z < size[2] && n > 0 && !v->cell_centered; ++z) {
    for (int64_t y = 0; y < size[1]; ++y) {
      const bool whole_row = z == 0 || z == size[2] - 1 || y == 0 || y == size[1] - 1;
      for (int64_t x = 0; x < size[0]; x += whole_row || size[0] < 2 ? 1 : size[0] - 1) {
        double position[3];
        position_of(v, (const int64_t[3]){ x, y, z }, position);
        if (is_in_earlier(boxes, n, position)) {
          if (shared) {
            shared[found] = (stratus_look_shared){ n, x + size[0] * (y + size[1] * z) };
          }
          ++found;
        }
      }
    }
  }
  return found;
}

stratus_status stratus_look_find_shared(
  stratus_context* context, const stratus_volume* volumes, int count, stratus_look_shared** shared, size_t* shared_count)
{
  void *boxes = NULL, *list = NULL;
  stratus_status status = STRATUS_OK;
  *shared = NULL;
  *shared_count = 0;
  TRY_CLEANUP(stratus_allocate(context, (size_t)count, sizeof(block_box), &boxes));
  size_t total = 0;
  for (int n = 0; n < count; ++n) {
    ((block_box*)boxes)[n] = box_of(volumes + n);
    total += list_shared(volumes, n, boxes, NULL);
  }
  if (total > 0) {
    TRY_CLEANUP(stratus_allocate(context, total, sizeof(stratus_look_shared), &list));
    for (int n = 0; n < count; ++n) {
      *shared_count += list_shared(volumes, n, boxes, (stratus_look_shared*)list + *shared_count);
    }
    *shared = list;
  }
cleanup:
  stratus_release(context, boxes);
  return status;
}

/* ---- counting */

static int64_t chunks_of(const stratus_volume* v)
{
  return ((int64_t)stratus_volume_count(v) + STRATUS_LOOK_CHUNK - 1) / STRATUS_LOOK_CHUNK;
}

static int64_t get_chunk(const stratus_volume* v, int64_t chunk, double values[STRATUS_LOOK_CHUNK])
{
  const int64_t first = chunk * STRATUS_LOOK_CHUNK, left = (int64_t)stratus_volume_count(v) - first;
  const int64_t count = left < STRATUS_LOOK_CHUNK ? left : STRATUS_LOOK_CHUNK;
  stratus_look_values_get(v, first, count, values);
  return count;
}

/* Finds the range of the finite values within `range`. */
static void find_range(stratus_context* context, const stratus_volume* v, const double range[2], double* low, double* high)
{
  double least = *low, most = *high;
#pragma omp parallel for num_threads(context->threads) reduction(min : least) reduction(max : most)
  for (int64_t chunk = 0; chunk < chunks_of(v); ++chunk) {
    double values[STRATUS_LOOK_CHUNK];
    const int64_t count = get_chunk(v, chunk, values);
    for (int64_t i = 0; i < count; ++i) {
      if (isfinite(values[i]) && (!range || (values[i] >= range[0] && values[i] <= range[1]))) {
        least = values[i] < least ? values[i] : least;
        most = values[i] > most ? values[i] : most;
      }
    }
  }
  *low = least;
  *high = most;
}

static int bin_of(const stratus_look_histogram* h, double scale, double value)
{
  if (!isfinite(value)) {
    return h->bins;
  }
  const double place = (value - h->first) * scale;
  return place < 0.0 ? 0 : place < h->bins - 1 ? (int)place : h->bins - 1;
}

static void count_volume(
  stratus_context* context, const stratus_volume* v, const stratus_look_histogram* h, double scale, int64_t total[STRATUS_LOOK_BINS + 1])
{
#pragma omp parallel num_threads(context->threads)
  {
    int64_t mine[STRATUS_LOOK_BINS + 1] = { 0 };
#pragma omp for nowait
    for (int64_t chunk = 0; chunk < chunks_of(v); ++chunk) {
      double values[STRATUS_LOOK_CHUNK];
      const int64_t count = get_chunk(v, chunk, values);
      for (int64_t i = 0; i < count; ++i) {
        ++mine[bin_of(h, scale, values[i])];
      }
    }
#pragma omp critical
    for (int i = 0; i <= STRATUS_LOOK_BINS; ++i) {
      total[i] += mine[i];
    }
  }
}

stratus_status stratus_look_histogram_make(stratus_context* context, const stratus_volume* volumes, int count,
  const stratus_look_shared* shared, size_t shared_count, const double range[2], stratus_look_histogram* h)
{
  double low = INFINITY, high = -INFINITY, number = 0.0;
  for (int n = 0; n < count; ++n) {
    find_range(context, volumes + n, range, &low, &high);
    number += (double)stratus_volume_count(volumes + n);
  }
  memset(h, 0, sizeof *h);
  h->values = (stratus_look_values){ .low = low, .high = high };
  number -= (double)shared_count;
  if (low > high) {
    h->values.not_finite = number;
    return STRATUS_OK;
  }
  /* If the range holds few integers, each gets a bin of its own, so that no bin mixes the background with visible values. */
  const bool integers = stratus_type_is_integer(volumes->type) && high - low < STRATUS_LOOK_BINS;
  h->bins = low == high ? 1 : integers ? (int)(high - low) + 1 : STRATUS_LOOK_BINS;
  h->first = integers ? low - 0.5 : low;
  h->last = integers ? high + 0.5 : high;
  const double scale = low == high ? 0.0 : h->bins / (h->last - h->first);
  int64_t total[STRATUS_LOOK_BINS + 1] = { 0 };
  for (int n = 0; n < count; ++n) {
    count_volume(context, volumes + n, h, scale, total);
  }
  for (size_t i = 0; i < shared_count; ++i) {
    double value = 0.0;
    stratus_look_values_get(volumes + shared[i].volume, shared[i].index, 1, &value);
    --total[bin_of(h, scale, value)];
  }
  for (int i = 0; i < h->bins; ++i) {
    h->count[i] = (double)total[i];
  }
  h->values.not_finite = (double)total[h->bins];
  h->values.finite = number - h->values.not_finite;
  return STRATUS_OK;
}

void stratus_look_histogram_scale(stratus_look_histogram* h, double factor)
{
  for (int i = 0; i < h->bins; ++i) {
    h->count[i] *= factor;
  }
  h->values.finite *= factor;
  h->values.not_finite *= factor;
}
