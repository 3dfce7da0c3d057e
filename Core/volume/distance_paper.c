/* SPDX-License-Identifier: BSD-3-Clause
 * The transform of Deakin & Knackstedt 2019 as published, O(n D). Two scans give the distances along x. Then, along y and z, each block
 * searches as far as its own distance for a nearer block. The map is the paper's, too: 0 in an occupied block, elsewhere 1..255. This is
 * the baseline for the sweeps, which give the same distances up to 127. */
#include "distance_sweep.h"

#include <string.h>

/* Computes distances along a line, from seeds of 0 and DISTANCE_MAX_PAPER. */
static void scan_line(uint8_t* line, int64_t n)
{
  for (int64_t x = 1; x < n; ++x) {
    line[x] = line[x - 1] + 1 < line[x] ? (uint8_t)(line[x - 1] + 1) : line[x];
  }
  for (int64_t x = n - 2; x >= 0; --x) {
    line[x] = line[x + 1] + 1 < line[x] ? (uint8_t)(line[x + 1] + 1) : line[x];
  }
}

/* The paper's second and third pass: returns the least over k of max(|k|, line[x+k]). */
static uint8_t search_line(const uint8_t* line, int64_t x, int64_t n)
{
  int nearest = line[x];
  for (int k = 1; k < nearest; ++k) {
    for (int side = -1; side <= 1; side += 2) {
      const int64_t at = x + side * k;
      if (at >= 0 && at < n) {
        const int distance = line[at] > k ? line[at] : k;
        nearest = distance < nearest ? distance : nearest;
      }
    }
  }
  return (uint8_t)nearest;
}

/* One pass along y or z, from `from` to `to`. lines: scratch, one line for each row of the other axis. */
static void search_axis(const stratus_context* context, const int64_t n[3], int axis, const uint8_t* from, uint8_t* to, uint8_t* lines)
{
  const int64_t length = n[axis], stride = axis == 1 ? n[0] : n[0] * n[1], others = axis == 1 ? n[2] : n[1];
  const int64_t other_stride = axis == 1 ? n[0] * n[1] : n[0];
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t other = 0; other < others; ++other) {
    uint8_t* line = lines + other * length;
    for (int64_t x = 0; x < n[0]; ++x) {
      const int64_t first = other * other_stride + x;
      for (int64_t i = 0; i < length; ++i) {
        line[i] = from[first + i * stride];
      }
      for (int64_t i = 0; i < length; ++i) {
        to[first + i * stride] = search_line(line, i, length);
      }
    }
  }
}

stratus_status stratus_distance_paper(stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_map* map)
{
  stratus_status status = STRATUS_OK;
  const int64_t* n = map->blocks;
  const size_t count = (size_t)(n[0] * n[1] * n[2]);
  void *distance = NULL, *swap = NULL, *lines = NULL;

  TRY_CLEANUP(stratus_allocate(context, count, 1, &distance));
  TRY_CLEANUP(stratus_allocate(context, count, 1, &swap));
  TRY_CLEANUP(stratus_allocate(context, (size_t)(n[1] * n[2]), 1, &lines));
  uint8_t* const along_x = distance;
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t row = 0; row < n[1] * n[2]; ++row) {
    const uint8_t* occupied = occupancy->occupied + row * n[0];
    uint8_t* line = along_x + row * n[0];
    for (int64_t x = 0; x < n[0]; ++x) {
      line[x] = occupied[x] ? 0 : DISTANCE_MAX_PAPER;
    }
    scan_line(line, n[0]);
  }
  search_axis(context, n, 1, distance, swap, lines);
  search_axis(context, n, 2, swap, distance, lines);
  for (int64_t row = 0; row < n[1] * n[2]; ++row) {
    memcpy(map->bytes + (size_t)row * map->pitch, along_x + row * n[0], (size_t)n[0]);
  }

cleanup:
  stratus_release(context, distance);
  stratus_release(context, swap);
  stratus_release(context, lines);
  return status;
}
