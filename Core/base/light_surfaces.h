/* SPDX-License-Identifier: BSD-3-Clause
 * Opaque surfaces that hide lights: the depth at which light first meets one, at nodes as in the light's map but closer to each other. */
#ifndef STRATUS_LIGHT_SURFACES_H
#define STRATUS_LIGHT_SURFACES_H

#include "base.h"
#include "light_frame.h"
#include "stratus/ray_cast.h"

/* Depths at the nodes of each face, across first: along the light's way, in the world. STRATUS_LIGHT_FREE: light meets nothing. */
typedef struct stratus_light_depths {
  int size[2];
  float* depth; /* NULL: there are no surfaces */
} stratus_light_depths;

#define STRATUS_LIGHT_FREE 1e30f

/* Fails if a number of the surfaces is not finite. surfaces: NULL: there are none. */
stratus_status stratus_surfaces_check(stratus_context* context, const stratus_surfaces* surfaces);

/* Finds the depths at nodes `size`, which are at least 2 across and up. surfaces: NULL: there are none. */
stratus_status stratus_light_surfaces_draw(stratus_context* context, const stratus_light_frame* frame, const stratus_surfaces* surfaces,
  const int size[2], stratus_light_depths* depths);
/* The part of light, between the four nodes about it, that surfaces let pass to a place in the world. */
double stratus_light_surfaces_passing(const stratus_light_frame* frame, const stratus_light_depths* depths, const double world[3]);

/* The same depths at every `step`-th node. */
stratus_status stratus_light_surfaces_coarsen(
  stratus_context* context, const stratus_light_frame* frame, const stratus_light_depths* fine, int step, stratus_light_depths* coarse);
/* The error of the picture from the light if only every `step`-th node of the depths is kept, root mean square where matter is. words: of
 * the light's map, of `layers`, which say where matter is lit. */
double stratus_light_surfaces_error(
  const stratus_light_frame* frame, const stratus_light_depths* fine, int step, const int size[3], const int32_t* words);

#endif
