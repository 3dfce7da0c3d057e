/* SPDX-License-Identifier: BSD-3-Clause
 * Distributes the tiles of a picture over the host's threads. */
#ifndef STRATUS_TILES_H
#define STRATUS_TILES_H

#include "base.h"

/* Number of counters that a picture's tiles add to. */
#define STRATUS_TILE_COUNTS 4

/* Draws one tile and adds to the counters; `counts` belongs to the calling thread. */
typedef void stratus_tile_work(const void* job, int tile, uint64_t counts[STRATUS_TILE_COUNTS]);

/* Processes tiles 0..tiles-1; each goes to the first free thread. The calling thread reports progress of `stage` after each of its tiles.
 * When the caller's callback cancels, no further tile begins, and the status is STRATUS_CANCELLED. counts: receives the sums over all
 * tiles. */
stratus_status stratus_each_tile(
  stratus_context* context, const char* stage, int tiles, stratus_tile_work* work, const void* job, uint64_t counts[STRATUS_TILE_COUNTS]);

#endif
