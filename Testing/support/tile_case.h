/* SPDX-License-Identifier: BSD-3-Clause
 * The values of a volume copied into tiles, for tests. */
#ifndef STRATUS_TESTING_TILE_CASE_H
#define STRATUS_TESTING_TILE_CASE_H

#include "stratus.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Gives the volume tiles of `side` values along each axis, in falling order, with gaps between them. */
static inline void tile_volume(stratus_volume* volume, const int64_t side[3])
{
  const size_t point = (size_t)volume->value_stride * stratus_type_size(volume->type);
  const size_t used = (size_t)(volume->components > 1 ? volume->components : 1) * stratus_type_size(volume->type);
  const int64_t* n = volume->dimensions;
  uint64_t* at[3];
  size_t row = point, tile = point + 3;
  for (int a = 0; a < 3; ++a) {
    tile *= (size_t)side[a];
  }
  for (int a = 0; a < 3; ++a) {
    const int64_t tiles = (n[a] + side[a] - 1) / side[a];
    at[a] = malloc(((size_t)n[a] + 1) * sizeof *at[a]);
    for (int64_t i = 0; i <= n[a]; ++i) {
      const int64_t here = i < n[a] ? i : n[a] - 1;
      at[a][i] = (uint64_t)(tiles - 1 - here / side[a]) * tile + (uint64_t)(here % side[a]) * row;
    }
    row *= (size_t)side[a];
    tile *= (size_t)tiles;
    volume->tiles.at[a] = at[a];
    volume->tiles.dimensions[a] = n[a];
  }
  char* to = calloc(tile, 1);
  for (int64_t k = 0; k < n[2]; ++k) {
    for (int64_t j = 0; j < n[1]; ++j) {
      for (int64_t i = 0; i < n[0]; ++i) {
        memcpy(to + at[0][i] + at[1][j] + at[2][k], (const char*)volume->values + (size_t)((k * n[1] + j) * n[0] + i) * point, used);
      }
    }
  }
  volume->tiles.values = to;
}

static inline void free_tiles(stratus_volume* volume)
{
  free((void*)(uintptr_t)volume->tiles.values);
  for (int a = 0; a < 3; ++a) {
    free((void*)(uintptr_t)volume->tiles.at[a]);
  }
  volume->tiles = (stratus_tiles){ .values = NULL };
}

#endif
