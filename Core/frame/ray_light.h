/* SPDX-License-Identifier: BSD-3-Clause
 * Shadows: the maps of the light that passes through the volumes and meshes of a picture. */
#ifndef STRATUS_RAY_LIGHT_H
#define STRATUS_RAY_LIGHT_H

#include "ray_caster.h"

/* Functions as stratus_ray_render_one(), and as stratus_ray_caster_render_several() and stratus_ray_caster_render_blocks(). */
typedef stratus_status stratus_ray_draw_one(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report);
typedef stratus_status stratus_ray_draw_several(const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera,
  const stratus_image* image, stratus_ray_cast_report* reports);

/* Builds the maps of the lights of a picture of one volume where they are stale, and drops them where the picture has no shadows. draw:
 * draws the layers. */
stratus_status stratus_ray_light_update(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, stratus_ray_draw_one* draw, stratus_ray_cast_report* report);
/* The same for a picture of several inputs, or of blocks, which share the maps: all matter casts shadows on all. The lights are those of
 * the first input that has shadows. given: the inputs are then drawn one by one, and keep these maps until stratus_ray_light_return().
 * report: receives its members of light. */
stratus_status stratus_ray_light_update_several(const stratus_ray_cast_input* inputs, int count, bool given, const stratus_camera* camera,
  stratus_ray_draw_several* draw, stratus_ray_cast_report* report);
/* The first input that has shadows; NULL: none has. */
const stratus_ray_cast_input* stratus_ray_light_of(const stratus_ray_cast_input* inputs, int count);
/* Writes that report to the reports of all inputs, which may be NULL: the maps and their error are of all, their making is the first's. */
void stratus_ray_light_report(const stratus_ray_cast_report* light, stratus_ray_cast_report* reports, int count);
/* Takes such maps from the inputs, which do not own them. */
void stratus_ray_light_return(const stratus_ray_cast_input* inputs, int count);

#endif
