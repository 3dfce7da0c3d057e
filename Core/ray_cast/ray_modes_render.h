/* SPDX-License-Identifier: BSD-3-Clause
 * What other modes than composite ask of a render. */
#ifndef STRATUS_RAY_MODES_RENDER_H
#define STRATUS_RAY_MODES_RENDER_H

#include "stratus/ray_cast.h"
#include "ray_cast_host.h"
#include "ray_sampling.h"
#include "volume.h"

/* What of the options decides which values matter, beside the transfer function. */
typedef struct stratus_ray_shown {
  stratus_mode mode;
  double average_range[2];
  int contour_count;
  double contours[STRATUS_CONTOURS_MAX];
} stratus_ray_shown;

stratus_status stratus_ray_modes_check(stratus_context* context, const stratus_ray_cast_options* options);
/* The options' part that decides it, with what the mode does not use left out. */
stratus_ray_shown stratus_ray_modes_shown(const stratus_ray_cast_options* options);
bool stratus_ray_modes_same(const stratus_ray_shown* a, const stratus_ray_shown* b);
void stratus_ray_modes_choose(const stratus_ray_cast_options* options, double voxel, stratus_ray_choice* choice);
/* The distance that the table's opacity is taken over: alpha of a mode that takes it as it is, not per length, is that over one unit. */
double stratus_ray_modes_table_distance(const stratus_ray_cast_options* options, const stratus_transfer* transfer, double sample_distance);
/* Marks the entries that the mode can't do without as those that show. */
void stratus_ray_modes_mark(const stratus_ray_shown* shown, const stratus_transfer* transfer, double bias, stratus_table* table);
/* Puts what each block holds at best behind the map's bytes, where the mode asks for it. */
stratus_status stratus_ray_modes_bounds(const stratus_ray_caster* caster, stratus_distance_map* map);
void stratus_ray_modes_arguments(
  const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_ray_cast_arguments* arguments);
stratus_ray_variant stratus_ray_modes_variant(const stratus_ray_caster* caster);
/* Rays show something wherever they meet the bounds, whatever the values. */
bool stratus_ray_modes_covers(const stratus_ray_cast_options* options);

#endif
