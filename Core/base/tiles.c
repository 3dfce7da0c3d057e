/* SPDX-License-Identifier: BSD-3-Clause
 * Distributes the tiles of a picture over the host's threads. */
#include "tiles.h"

#include <omp.h>
#include <stdatomic.h>

stratus_status stratus_each_tile(
  stratus_context* context, const char* stage, int tiles, stratus_tile_work* work, const void* job, uint64_t counts[STRATUS_TILE_COUNTS])
{
  uint64_t sums[STRATUS_TILE_COUNTS] = { 0 };
  atomic_int next = 0, cancelled = 0;
  stratus_status status = STRATUS_OK;

#pragma omp parallel num_threads(context->threads)
  {
    uint64_t mine[STRATUS_TILE_COUNTS] = { 0 };
    const bool reports = omp_get_thread_num() == 0 && context->options.progress;
    bool reported = false;
    for (int tile; !atomic_load_explicit(&cancelled, memory_order_relaxed) && (tile = atomic_fetch_add(&next, 1)) < tiles;) {
      work(job, tile, mine);
      if (reports) {
        status = stratus_progress(context, stage, (double)(tile + 1) / tiles);
        reported = true;
        if (status != STRATUS_OK) {
          atomic_store(&cancelled, 1);
        }
      }
    }
    if (reports && !reported && tiles > 0) { /* the other threads took all tiles; the caller may want to cancel all the same */
      status = stratus_progress(context, stage, 1.0);
    }
#pragma omp critical(stratus_tile_counts)
    for (int i = 0; i < STRATUS_TILE_COUNTS; ++i) {
      sums[i] += mine[i];
    }
  }
  for (int i = 0; i < STRATUS_TILE_COUNTS; ++i) {
    counts[i] = sums[i];
  }
  return status;
}
