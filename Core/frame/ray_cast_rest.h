/* SPDX-License-Identifier: BSD-3-Clause
 * The host's tiles of a picture, where some are drawn before the others. */
#ifndef STRATUS_RAY_CAST_REST_H
#define STRATUS_RAY_CAST_REST_H

#include "ray_cast_host.h"

/* Side of a tile in pixels: small enough to balance the threads, large enough that the tile's rays share voxels. */
#define STRATUS_RAY_TILE 32
#define STRATUS_RAY_DRAWN_MOST 32

/* Tiles that are drawn, in rows from the picture's first pixel on. */
typedef struct stratus_ray_drawn {
  int count;
  int tiles[STRATUS_RAY_DRAWN_MOST];
  stratus_ray_counts counts;
} stratus_ray_drawn;

bool stratus_ray_is_drawn(const stratus_ray_drawn* drawn, int tile);
/* Draws pixels [x0, x1) x [y0, y1), and rounds them to rgba8 if that is wanted. x0 and y0 are multiples of 8. */
void stratus_ray_cast_pixels(
  const stratus_ray_cast_frame* frame, stratus_ray_cast_tile* draw, int x0, int y0, int x1, int y1, stratus_ray_counts* counts);
/* Draws all tiles that are not drawn yet. counts: of these and of the others together. */
stratus_status stratus_ray_cast_rest(stratus_context* context, const stratus_ray_cast_frame* frame, int type, stratus_ray_variant variant,
  const stratus_ray_drawn* drawn, stratus_ray_counts* counts);

#endif
