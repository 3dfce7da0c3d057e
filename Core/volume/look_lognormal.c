/* SPDX-License-Identifier: BSD-3-Clause
 * Whether the values of volumes are lognormal, by their frequencies on a logarithmic scale. */
#include "look_histogram.h"

/* Bins of an octave, and octaves on both sides of 1. */
enum { PARTS = 8, OCTAVES = 160, BINS = 2 * OCTAVES * PARTS };

/* The values at each end that do not count, as a share of all. */
#define ENDS 1e-3
#define LEAST_DECADES 2.0
/* Where the median is in the span of the others, at least and at most. */
#define LEAST_MEDIAN (1.0 / 3.0)
#define MOST_MEDIAN (2.0 / 3.0)

/* The bin of a value above 0. Within an octave, bins are equally wide by the value, which is close enough to its logarithm. */
static int bin_of(double value)
{
  int octave = 0;
  const double part = frexp(value, &octave); /* .5 .. 1 */
  const int bin = (octave + OCTAVES) * PARTS + (int)((part - 0.5) * 2 * PARTS);
  return bin < 0 ? 0 : bin < BINS ? bin : BINS - 1;
}

/* The value at a place in bins. */
static double value_of(double place)
{
  const double octave = floor(place / PARTS);
  return ldexp(0.5 + (place - octave * PARTS) / (2 * PARTS), (int)octave - OCTAVES);
}

/* Values outside of the range are outliers. */
static void count_logarithms(stratus_context* context, const stratus_volume* v, const stratus_look_values* range, int64_t total[BINS])
{
  const int64_t all = (int64_t)stratus_volume_count(v), chunks = (all + STRATUS_LOOK_CHUNK - 1) / STRATUS_LOOK_CHUNK;
#pragma omp parallel num_threads(context->threads)
  {
    int64_t mine[BINS] = { 0 };
#pragma omp for nowait
    for (int64_t chunk = 0; chunk < chunks; ++chunk) {
      const int64_t first = chunk * STRATUS_LOOK_CHUNK, left = all - first;
      const int64_t count = left < STRATUS_LOOK_CHUNK ? left : STRATUS_LOOK_CHUNK;
      double values[STRATUS_LOOK_CHUNK];
      stratus_look_values_get(v, first, count, values);
      for (int64_t i = 0; i < count; ++i) {
        if (values[i] > 0.0 && values[i] >= range->low && values[i] <= range->high) {
          ++mine[bin_of(values[i])];
        }
      }
    }
#pragma omp critical
    for (int i = 0; i < BINS; ++i) {
      total[i] += mine[i];
    }
  }
}

/* The place, in bins, below which a share of the values is. */
static double quantile(const int64_t count[BINS], double number)
{
  double below = 0.0;
  for (int i = 0; i < BINS; ++i) {
    if (below + (double)count[i] > number) {
      return i + (number - below) / (double)count[i];
    }
    below += (double)count[i];
  }
  return BINS;
}

bool stratus_look_is_lognormal(
  stratus_context* context, const stratus_volume* volumes, int count, const stratus_look_histogram* h, bool zeros, double* least)
{
  if (!(h->values.high > 0.0) || h->bins < 2 || stratus_type_is_integer(volumes->type) || (!zeros && !(h->values.low > 0.0))) {
    return false;
  }
  int64_t total[BINS] = { 0 };
  double number = 0.0;
  for (int n = 0; n < count; ++n) {
    count_logarithms(context, volumes + n, &h->values, total);
  }
  for (int i = 0; i < BINS; ++i) {
    number += (double)total[i];
  }
  const double low = quantile(total, ENDS * number), high = quantile(total, (1.0 - ENDS) * number), span = high - low;
  const double middle = (quantile(total, 0.5 * number) - low) / span;
  *least = value_of(low);
  return number > 0.0 && span >= LEAST_DECADES * PARTS * log2(10.0) && middle >= LEAST_MEDIAN && middle <= MOST_MEDIAN;
}
