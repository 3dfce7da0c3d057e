/* SPDX-License-Identifier: BSD-3-Clause
 * Lights as rays take them, for every renderer that has them. */
#ifndef STRATUS_LIGHTS_H
#define STRATUS_LIGHTS_H

#include "base.h"
#include "light_arguments.h"
#include "stratus/ray_cast.h"

stratus_shading stratus_shading_default(void);
/* Checks what light makes of a medium, and the lights. */
stratus_status stratus_shading_check(stratus_context* context, const stratus_shading* shading);
/* Gives the lights in world coordinates; where a shading has none of its own, one at the eye, a direction where rays are parallel. Returns
 * their number. */
int stratus_lights_in_world(const stratus_camera* camera, const stratus_shading* shading, stratus_light lights[STRATUS_LIGHTS_MAX]);
/* Sets count, sides and lights of the arguments, without maps. Places are relative to `origin` in the world, in units of `unit`. lights:
 * receives the lights in world coordinates. */
void stratus_lights_set(const stratus_camera* camera, const stratus_shading* shading, const double origin[3], double unit,
  stratus_light lights[STRATUS_LIGHTS_MAX], stratus_light_arguments* a);
/* Whether a shading has shadows on, by themselves or because light is scattered more than once. */
bool stratus_lights_want_shadows(const stratus_shading* shading);
/* Whether a picture has shadows: its shading has them on, and matter is lit. materials: of `count` components, which replace `shade`; NULL:
 * none of their own. */
bool stratus_lights_cast_shadows(const stratus_shading* shading, bool shade, const stratus_material* materials, int count);

/* Gives the shading by which matter that is drawn shows its albedo, its colour times the diffuse number: as ambient light. Matter that is
 * not lit scatters nothing. own: materials of `count` components; NULL: none of their own. Returns the materials to draw with, which are in
 * `materials`, or NULL. */
const stratus_material* stratus_lights_show_albedo(
  const stratus_shading* lit, const stratus_material* own, int count, stratus_shading* shading, stratus_material materials[4]);

/* How much of a light matter of colour 1 sends to the eye at most: the diffuse number, and the root mean square of highlights over all
 * normals. own: as above. */
double stratus_lights_reflectance(const stratus_shading* shading, const stratus_material* own, int count);

/* lamps.c: the fraction of a positional light that reaches a point. `to`, of length 1, leads from the point to the light, at `distance`. */
double stratus_lamp_reaching(const stratus_light* light, const double to[3], double distance);

/* The lights of first hits, which are solids. */
typedef struct stratus_lamps {
  const stratus_shading* shading;
  stratus_light lights[STRATUS_LIGHTS_MAX]; /* directions have length 1 */
  int count;
} stratus_lamps;

/* lamps.c: sets the lights; the shading is borrowed. */
void stratus_lamps_set(const stratus_camera* camera, const stratus_shading* shading, stratus_lamps* lamps);
/* Lights the colour of a solid at a point. normal, and the ray's direction: of length 1. */
void stratus_lamps_shine(
  const stratus_lamps* lamps, const double point[3], const double normal[3], const double direction[3], double rgb[3]);

#endif
