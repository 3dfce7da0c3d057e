/* SPDX-License-Identifier: BSD-3-Clause
 * Operations on rows of distances, one byte for each block. No distance exceeds 127, so that one can be added without overflow. Every loop
 * consists of a few unsigned byte minima and additions, which any compiler vectorises. `side` is the side of the other blocks along x: -1,
 * 0 (both sides), +1. */
#ifndef STRATUS_DISTANCE_ROWS_H
#define STRATUS_DISTANCE_ROWS_H

#include "distance_sweep.h"

#include <string.h>

#define ROW_MARGIN 64 /* longest step of row_spread(): a row has so many cells of DISTANCE_MAX on either side */

static inline uint8_t least(uint8_t a, uint8_t b)
{
  return a < b ? a : b;
}

/* Sets seeds to 0 where occupied is `target`, else to DISTANCE_MAX. Returns the number of targets. */
static inline int64_t row_seed(const uint8_t* restrict occupied, uint8_t target, int64_t n, uint8_t* restrict seeds)
{
  int64_t others = 0;
  for (int64_t x = 0; x < n; ++x) {
    const uint8_t other = occupied[x] ^ target;
    seeds[x] = (uint8_t)(DISTANCE_MAX & -other);
    others += other;
  }
  return n - others;
}

/* a[x] = min(b[x], b[x +- step] + step). */
static inline void row_spread_step(const uint8_t* restrict b, int64_t n, int64_t step, int side, uint8_t* restrict a)
{
  const uint8_t* restrict ahead = b + (side < 0 ? -step : step);
  const uint8_t* restrict behind = b - (side > 0 ? -step : step);
  if (side == 0) {
    for (int64_t x = 0; x < n; ++x) {
      a[x] = least(b[x], (uint8_t)(least(ahead[x], behind[x]) + step));
    }
  } else {
    for (int64_t x = 0; x < n; ++x) {
      a[x] = least(b[x], (uint8_t)(ahead[x] + step));
    }
  }
}

/* Distances along x from the seeds in `rows`: steps of 1, 2, 4 .. 64 make up every distance to 127. rows: two rows of n, `apart` bytes
 * apart, with ROW_MARGIN cells of DISTANCE_MAX on either side. Returns the row that holds the result. */
static inline uint8_t* row_spread(uint8_t* rows, size_t apart, int64_t n, int side)
{
  uint8_t *from = rows, *to = rows + apart;
  for (int64_t step = 1; step < n && step <= ROW_MARGIN; step *= 2) {
    row_spread_step(from, n, step, side, to);
    uint8_t* swap = from;
    from = to;
    to = swap;
  }
  return from;
}

/* row[x] = min(row[x], 1 + near[x]). */
static inline void row_step(const uint8_t* restrict near, int64_t n, uint8_t* restrict row)
{
  for (int64_t x = 0; x < n; ++x) {
    row[x] = least(row[x], (uint8_t)(near[x] + 1));
  }
}

/* The same from the least of two rows; row_step3() takes three. */
static inline void row_step2(const uint8_t* restrict a, const uint8_t* restrict b, int64_t n, uint8_t* restrict row)
{
  for (int64_t x = 0; x < n; ++x) {
    row[x] = least(row[x], (uint8_t)(least(a[x], b[x]) + 1));
  }
}

static inline void row_step3(
  const uint8_t* restrict a, const uint8_t* restrict b, const uint8_t* restrict c, int64_t n, uint8_t* restrict row)
{
  for (int64_t x = 0; x < n; ++x) {
    row[x] = least(row[x], (uint8_t)(least(least(a[x], b[x]), c[x]) + 1));
  }
}

/* near[x] = least of row[x] and its neighbours on `side`. Rows above or below step from this. */
static inline void row_near(const uint8_t* restrict row, int64_t n, int side, uint8_t* restrict near)
{
  if (n == 1) {
    near[0] = row[0];
  } else if (side > 0) {
    for (int64_t x = 0; x < n - 1; ++x) {
      near[x] = least(row[x], row[x + 1]);
    }
    near[n - 1] = row[n - 1];
  } else if (side < 0) {
    near[0] = row[0];
    for (int64_t x = 1; x < n; ++x) {
      near[x] = least(row[x], row[x - 1]);
    }
  } else {
    near[0] = least(row[0], row[1]);
    for (int64_t x = 1; x < n - 1; ++x) {
      near[x] = least(row[x], least(row[x - 1], row[x + 1]));
    }
    near[n - 1] = least(row[n - 1], row[n - 2]);
  }
}

/* Merge the distance of empty blocks in `row` with the distance of occupied blocks in `inner`, which gets its mark. One of the two is 0. */
static inline void row_merge(const uint8_t* restrict inner, int64_t n, uint8_t* restrict row)
{
  for (int64_t x = 0; x < n; ++x) {
    row[x] = (uint8_t)(row[x] | inner[x] | (inner[x] ? DISTANCE_OCCUPIED : 0));
  }
}

static inline void row_least(const uint8_t* restrict other, int64_t n, uint8_t* restrict row)
{
  for (int64_t x = 0; x < n; ++x) {
    row[x] = least(row[x], other[x]);
  }
}

#endif
