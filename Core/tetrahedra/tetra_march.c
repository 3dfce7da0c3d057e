/* SPDX-License-Identifier: BSD-3-Clause
 * Marches all tiles of a picture of tetrahedra on the host. A first pass counts each pixel's entries into the mesh. A second pass finds
 * them and marches. */
#include "tetra_caster.h"

#include "instruction_set.h"
#include "tiles.h"

#include <string.h>

#define PIXELS ((size_t)TETRA_TILE * TETRA_TILE)

static stratus_tetra_tile* tile_for(int isa, bool lit)
{
  static stratus_tetra_tile* const tiles[] = STRATUS_ISA_EACH(stratus_tetra_tile);
  static stratus_tetra_tile* const lit_tiles[] = STRATUS_ISA_EACH(stratus_tetra_light_tile);
  return (lit ? lit_tiles : tiles)[stratus_isa_at_most(isa)];
}

typedef struct march_job {
  const stratus_tetra_frame* frame;
  stratus_tetra_tile* work;
  bool counting;
} march_job;

static void march_tile(const void* data, int tile, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const march_job* job = data;
  stratus_tetra_counts mine = { 0 };
  job->work(job->frame, tile, job->counting, &mine);
  counts[0] += mine.rays;
  counts[1] += mine.entries;
  counts[2] += mine.segments;
  counts[3] += mine.stuck;
}

static stratus_status each_tile(stratus_context* context, const stratus_tetra_frame* frame, bool counting, stratus_tetra_counts* counts)
{
  const march_job job = { frame, tile_for(context->isa, frame->lit && !counting), counting };
  uint64_t sums[STRATUS_TILE_COUNTS];
  const stratus_status status =
    stratus_each_tile(context, counting ? "entry faces" : "march", frame->columns * frame->rows, march_tile, &job, sums);
  *counts = (stratus_tetra_counts){ .rays = sums[0], .entries = sums[1], .segments = sums[2], .stuck = sums[3] };
  return status;
}

stratus_status stratus_tetra_sum_entries(stratus_context* context, stratus_tetra_frame* frame, size_t pixels, size_t* total)
{
  uint64_t sum = 0;
  for (size_t i = 0; i <= pixels; ++i) {
    const uint32_t here = i < pixels ? frame->first[i] : 0;
    frame->first[i] = (uint32_t)sum;
    sum += here;
  }
  if (sum > INT32_MAX / 2) {
    return stratus_fail(
      context, STRATUS_OVERFLOW, "rays come into the mesh %llu times, at most %d", (unsigned long long)sum, INT32_MAX / 2);
  }
  *total = (size_t)sum;
  return STRATUS_OK;
}

stratus_status stratus_tetra_count_entries(
  stratus_context* context, stratus_tetra_frame* frame, stratus_tetra_buffers* buffers, stratus_tetra_counts* counts)
{
  const size_t pixels = (size_t)frame->columns * (size_t)frame->rows * PIXELS;
  size_t total = 0;
  TRY(stratus_tetra_reserve(context, &buffers->first, pixels + 1, sizeof(uint32_t)));
  frame->first = buffers->first.memory;
  TRY(each_tile(context, frame, true, counts));
  TRY(stratus_tetra_sum_entries(context, frame, pixels, &total));
  TRY(stratus_tetra_reserve(context, &buffers->entries, total, 2 * sizeof(int32_t)));
  frame->entries = buffers->entries.memory;
  return STRATUS_OK;
}

stratus_status stratus_tetra_march(stratus_context* context, stratus_tetra_frame* frame, stratus_tetra_buffers* buffers,
  stratus_tetra_counts* counts, double* entries_ms, double* march_ms)
{
  const double start = stratus_now_ms();
  TRY(stratus_tetra_count_entries(context, frame, buffers, counts));
  const double marching = stratus_now_ms();
  TRY(each_tile(context, frame, false, counts));
  *entries_ms += marching - start;
  *march_ms = stratus_now_ms() - marching;
  return STRATUS_OK;
}

stratus_status stratus_tetra_sums(stratus_context* context, const stratus_table* table, int32_t** sums)
{
  const size_t size = (size_t)table->size;
  void* memory = NULL;
  *sums = NULL;
  if (!table->sums) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(context, STRATUS_TETRA_SUMS * size, sizeof(int32_t), &memory));
  *sums = memory;
  memcpy(*sums + 8 * size, table->sums + 4 * (size + 1), 2 * size * sizeof(int32_t)); /* the rows of opaque entries */
  int64_t moment = 0;
  for (size_t entry = 0; entry < size; ++entry) {
    const int64_t own = (int64_t)(table->sums[4 * (entry + 1) + 3] - table->sums[4 * entry + 3]) * (int64_t)entry,
                  middle = moment + own / 2;
    (*sums)[10 * size + 2 * entry] = (int32_t)(middle >> 16);
    (*sums)[10 * size + 2 * entry + 1] = (int32_t)(middle & 0xffff);
    moment += own;
    for (size_t which = 0; which < 4; ++which) {
      const int64_t below = table->sums[4 * entry + which], above = table->sums[4 * (entry + 1) + which];
      (*sums)[4 * entry + which] = (int32_t)((below + above + 1) / 2);
      (*sums)[4 * (size + entry) + which] = (int32_t)(above - below);
    }
  }
  return STRATUS_OK;
}
