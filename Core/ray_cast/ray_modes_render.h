/* SPDX-License-Identifier: BSD-3-Clause
 * Ray modes other than composite: their part of a render. */
#ifndef STRATUS_RAY_MODES_RENDER_H
#define STRATUS_RAY_MODES_RENDER_H

#include "stratus/ray_cast.h"
#include "ray_cast_host.h"
#include "ray_sampling.h"
#include "volume.h"

/* The options that decide, with the transfer function, which values matter. */
typedef struct stratus_ray_shown {
  stratus_mode mode;
  double average_range[2];
  int contour_count;
  double contours[STRATUS_CONTOURS_MAX];
} stratus_ray_shown;

/* Whether rays keep the largest or smallest value, or a sum or mean. */
bool stratus_mode_is_extreme(stratus_mode mode);
bool stratus_mode_is_sum(stratus_mode mode);
stratus_status stratus_ray_modes_check(stratus_context* context, const stratus_ray_cast_options* options);
/* Extracts them from the options. Fields that the mode does not use are 0. */
stratus_ray_shown stratus_ray_modes_shown(const stratus_ray_cast_options* options);
bool stratus_ray_modes_same(const stratus_ray_shown* a, const stratus_ray_shown* b);
/* Returns the distance over which the table's opacity accumulates: the sample distance in mode COMPOSITE. Other modes use alpha as given,
 * so theirs is the unit distance. */
double stratus_ray_modes_table_distance(stratus_mode mode, const stratus_transfer* transfer, double sample_distance);
/* Finds the fetched values that matter to the mode, as those that show. The caller releases values->of. */
stratus_status stratus_ray_modes_values(stratus_context* context, const stratus_ray_shown* shown, const stratus_transfer* transfer,
  const stratus_fetching* fetching, stratus_shown* values);
/* Appends an upper bound of each block's values (MINIMUM: of their negatives) to the map's bytes. Other modes than extremes need none. */
stratus_status stratus_ray_modes_bounds(const stratus_ray_caster* caster, stratus_distance_map* map);
void stratus_ray_modes_arguments(
  const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_ray_cast_arguments* arguments);
stratus_ray_variant stratus_ray_modes_variant(const stratus_ray_caster* caster);
/* Whether rays show something wherever they meet the bounds, whatever the values. */
bool stratus_ray_modes_covers(const stratus_ray_cast_options* options);

#endif
