/* SPDX-License-Identifier: BSD-3-Clause
 * Ray modes other than composite: their part of a render. */
#ifndef STRATUS_RAY_MODES_RENDER_H
#define STRATUS_RAY_MODES_RENDER_H

#include "stratus/ray_cast.h"
#include "ray_cast_host.h"
#include "ray_field.h"
#include "ray_integrator.h"
#include "ray_mode.h"
#include "ray_optics.h"

stratus_status stratus_ray_modes_check(stratus_context* context, const stratus_ray_cast_options* options);
/* Extracts them from the options. Fields that the mode does not use are 0. */
stratus_ray_shown stratus_ray_modes_shown(const stratus_ray_cast_options* options);
bool stratus_ray_modes_same(const stratus_ray_shown* a, const stratus_ray_shown* b);
/* Finds the fetched values that matter to the mode, as those that show. The caller releases values->of. */
stratus_status stratus_ray_modes_values(stratus_context* context, const stratus_ray_shown* shown, const stratus_transfer* transfer,
  const stratus_fetching* fetching, stratus_shown* values);
/* Appends an upper bound of each block's values (MINIMUM: of their negatives) to the map's bytes. Other modes than extremes need none. */
stratus_status stratus_ray_modes_bounds(const stratus_ray_field* field, stratus_mode mode, stratus_distance_map* map);
/* rough: the map of rough blocks; read by rule local only. */
void stratus_ray_modes_arguments(const stratus_ray_integrator* integrator, const stratus_ray_optics* optics, const stratus_ray_field* field,
  const stratus_distance_map* rough, const stratus_ray_cast_options* options, stratus_ray_cast_arguments* arguments);
stratus_ray_variant stratus_ray_modes_variant(const stratus_ray_integrator* integrator, const stratus_ray_optics* optics);
/* Whether rays of the choice take light at places of their own. */
bool stratus_ray_lights_places(const stratus_ray_integrator* integrator, const stratus_ray_optics* optics);
/* Whether rays show something wherever they meet the bounds, whatever the values. */
bool stratus_ray_modes_covers(const stratus_ray_cast_options* options);

#endif
