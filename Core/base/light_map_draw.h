/* SPDX-License-Identifier: BSD-3-Clause
 * Draws one map of light at given nodes, and says how far pictures by a coarser map are from those by a finer one. */
#ifndef STRATUS_LIGHT_MAP_DRAW_H
#define STRATUS_LIGHT_MAP_DRAW_H

#include "light_frame.h"
#include "light_maps.h"

/* The nodes of a map: of each face, across and up, and the layers between them. */
typedef struct stratus_light_grid {
  stratus_light_frame frame;
  int size[3];
} stratus_light_grid;

/* The lengths on which rays may pass near matter by themselves before they read a map, in near lengths of the map. */
#define STRATUS_LIGHT_NEARS 4
extern const int stratus_light_near_lengths[STRATUS_LIGHT_NEARS];

size_t stratus_light_grid_words(const stratus_light_grid* grid);
/* Draws a map. goes_on: the part of the extinction that light passes as if it were not there. words: receives its memory. */
stratus_status stratus_light_grid_draw(
  stratus_context* context, const stratus_light_matter* matter, double goes_on, const stratus_light_grid* m, int32_t** words);
/* Draws some rows and columns of a map, and compares a coarser one with them. near_layers: of the finer map, in a near length of the
 * coarser one. differences: of pictures of a white light, root mean square over the matter, for each of the near lengths. */
stratus_status stratus_light_grid_compare(stratus_context* context, const stratus_light_matter* matter, double goes_on,
  const stratus_light_grid* m, const stratus_light_grid* coarse, const int32_t* coarse_words, double near_layers,
  double differences[STRATUS_LIGHT_NEARS]);

#endif
