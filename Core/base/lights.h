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
/* Sets count, sides and lights of the arguments. Places are relative to `origin` in the world, in units of `unit`. */
void stratus_lights_set(
  const stratus_camera* camera, const stratus_shading* shading, const double origin[3], double unit, stratus_light_arguments* a);

#endif
