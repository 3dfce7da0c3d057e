/* SPDX-License-Identifier: BSD-3-Clause
 * From camera, volume and options to the numbers that every ray of a frame shares. */
#ifndef STRATUS_RAY_FRAME_H
#define STRATUS_RAY_FRAME_H

#include "stratus/ray_cast.h"
#include "ray_cast_arguments.h"
#include "volume.h"

/* Fills what camera, volume and options decide. *empty: no ray can meet anything. */
stratus_status stratus_ray_frame_arguments(stratus_context* context, const stratus_volume* volume, const stratus_camera* camera,
  const stratus_ray_cast_options* options, const stratus_image* image, double sample_distance, stratus_ray_cast_arguments* arguments,
  bool* empty);
/* Adds what table and map decide; either NULL leaves it out. */
void stratus_ray_frame_structures(
  const stratus_table* table, const stratus_occupancy* occupancy, const stratus_distance_map* map, stratus_ray_cast_arguments* arguments);

#endif
