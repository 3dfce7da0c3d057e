/* SPDX-License-Identifier: BSD-3-Clause
 * Measures which structure draws a volume's frames fastest. */
#ifndef STRATUS_RAY_TRIAL_H
#define STRATUS_RAY_TRIAL_H

#include "ray_caster.h"

#include "ray_cast_host.h"

/* Decides the structure of this frame: none, the one that the caster's map is of, or one whose map it builds. In frames 1, 2, 4, 8, ...
 * since the transfer function changed, a few tiles of the picture are drawn with the map and without it, and their times are compared. No
 * structure changes a bit of the picture, so timings may decide. frame: with the map; its pictures receive the tiles, over which the frame
 * is drawn afterwards. arguments: those of the frame, with the map; they are set for the structure that is taken. offered: a tree that came
 * with the data serves. used: as stratus_ray_update_structures() gave it. why: the reason, with what was measured. */
stratus_status stratus_ray_try(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, stratus_ray_cast_arguments* arguments,
  double tolerance, stratus_ray_variant variant, bool offered, stratus_structure* used, char* why, size_t capacity);
/* Counts what the frame has spent. cast_ms: its time. */
void stratus_ray_tried(stratus_ray_caster* caster, double cast_ms);

#endif
