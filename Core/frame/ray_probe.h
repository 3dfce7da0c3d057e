/* SPDX-License-Identifier: BSD-3-Clause
 * Measures which sampling a scene needs. */
#ifndef STRATUS_RAY_PROBE_H
#define STRATUS_RAY_PROBE_H

#include "ray_caster.h"
#include "ray_probe_rays.h"

/* Draws a thousand or so rays with the settings that the options leave open and with a finer one, and makes the cheapest setting that keeps
 * the tolerance the caster's choice. Needs value ranges, transfer functions, occupancy and map. Deterministic: counts and errors decide,
 * not timings. If memory runs out, the caster's choice stays as it was. camera: the picture's. Where lights have maps, those that move with
 * the camera stay where it has them, since there are no others; without maps they move with the probe's rays. */
stratus_status stratus_ray_probe(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_camera* camera,
  const stratus_ray_cast_options* options, stratus_ray_cast_report* report);

/* Makes the map by which rule local finds rough blocks, whose classes are below `beyond`. */
stratus_status stratus_ray_make_rough(
  stratus_context* context, const stratus_probe_classes* classes, int beyond, stratus_distance_map** rough);

#endif
