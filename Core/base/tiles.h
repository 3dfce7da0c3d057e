/* SPDX-License-Identifier: BSD-3-Clause
 * The tiles of a picture, shared out among the host's threads. */
#ifndef STRATUS_TILES_H
#define STRATUS_TILES_H

#include "base.h"

/* Counters that a picture's tiles add to. */
#define STRATUS_TILE_COUNTS 4

/* Does one tile and adds what it counts; `counts` is the calling thread's own. */
typedef void stratus_tile_work(const void* job, int tile, uint64_t counts[STRATUS_TILE_COUNTS]);

/* Tiles 0..tiles-1, each handed to the first thread that is free. The calling thread reports progress of `stage` after each of its tiles;
 * once the caller's callback cancels, no other tile is begun, and the status is STRATUS_CANCELLED. counts: sums over all tiles. */
stratus_status stratus_each_tile(
  stratus_context* context, const char* stage, int tiles, stratus_tile_work* work, const void* job, uint64_t counts[STRATUS_TILE_COUNTS]);

#endif
