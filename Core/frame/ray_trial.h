/* SPDX-License-Identifier: BSD-3-Clause
 * Measures which structure draws a volume's frames fastest. */
#ifndef STRATUS_RAY_TRIAL_H
#define STRATUS_RAY_TRIAL_H

#include "ray_caster.h"

#include "ray_cast_rest.h"

/* The input and output of a choice for one frame. */
typedef struct stratus_ray_choice_frame {
  const stratus_image* image;
  double tolerance;
  stratus_ray_cast_arguments* arguments; /* with the caster's map at first; set for the structure that is taken */
  stratus_ray_drawn drawn;               /* tiles that were drawn while structures were compared: they are the picture's */
  double drawn_ms;                       /* milliseconds of the image's part in these tiles */
  stratus_structure used;
  bool offered; /* its map is of the tree that came with the data */
} stratus_ray_choice_frame;

/* Decide by which structure this frame is drawn: none, the structure of the caster's map, or another whose map it builds. No structure
 * changes a bit of the image, so timings may decide. why: the reason, with the measured times. */
stratus_status stratus_ray_try(stratus_ray_caster* caster, stratus_ray_choice_frame* frame, char* why, size_t capacity);
/* Counts the milliseconds that a frame has spent. */
void stratus_ray_tried(stratus_ray_caster* caster, double cast_ms);

#endif
