/* SPDX-License-Identifier: BSD-3-Clause
 * Shading: samples that are lit, thinned by the gradient, of several components or labelled. */
#ifndef STRATUS_RAY_SHADING_RENDER_H
#define STRATUS_RAY_SHADING_RENDER_H

#include "ray_optics.h"

stratus_status stratus_ray_shading_check(stratus_context* context, const stratus_ray_cast_options* options);
stratus_status stratus_ray_shading_check_materials(
  stratus_context* context, const stratus_volume* volume, const stratus_ray_cast_options* options);
bool stratus_ray_shading_wanted(const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options);
void stratus_ray_shading_arguments(const stratus_ray_optics* optics, const stratus_ray_field* field, double sample_distance,
  const stratus_volume* volume, const stratus_camera* camera, const stratus_ray_cast_options* options,
  stratus_ray_cast_arguments* arguments);

#endif
