/* SPDX-License-Identifier: BSD-3-Clause
 * The frequencies of values, for guesses of transfer functions. */
#ifndef STRATUS_LOOK_HISTOGRAM_H
#define STRATUS_LOOK_HISTOGRAM_H

#include "volume.h"
#include "stratus/look.h"

enum { STRATUS_LOOK_BINS = 1024, STRATUS_LOOK_CHUNK = 1024 };

typedef struct stratus_look_histogram {
  stratus_look_values values;
  double first, last;              /* edges of the first and last bin; each of few integers is in the middle of its own bin */
  double count[STRATUS_LOOK_BINS]; /* values in each bin; bins are equally wide */
  int bins;
} stratus_look_histogram;

static inline double stratus_look_bin_width(const stratus_look_histogram* h)
{
  return (h->last - h->first) / h->bins;
}

/* A point on the border of a block that an earlier block has, too. */
typedef struct stratus_look_shared {
  int volume;
  int64_t index;
} stratus_look_shared;

/* Set *shared to the shared points of all blocks. The caller releases it. */
stratus_status stratus_look_find_shared(
  stratus_context* context, const stratus_volume* volumes, int count, stratus_look_shared** shared, size_t* shared_count);
/* Count values. Those outside of `range` are in the first or last bin; range may be NULL, and is narrowed to the values' own range. */
stratus_status stratus_look_histogram_make(stratus_context* context, const stratus_volume* volumes, int count,
  const stratus_look_shared* shared, size_t shared_count, const double range[2], stratus_look_histogram* histogram);
/* Multiply the frequencies, as where each value stands for others. */
void stratus_look_histogram_scale(stratus_look_histogram* histogram, double factor);
/* Whether values are lognormal, by the rule at stratus_look_guess(). zeros: values of 0 are none, instead of a sign that they are not.
 * low: receives the least value above 0, without 1/1000 of these. */
bool stratus_look_is_lognormal(
  stratus_context* context, const stratus_volume* volumes, int count, const stratus_look_histogram* histogram, bool zeros, double* low);
/* Convert `count` values from number `first` on, at most STRATUS_LOOK_CHUNK. */
void stratus_look_values_get(const stratus_volume* volume, int64_t first, int64_t count, double* values);

#endif
