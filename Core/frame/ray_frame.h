/* SPDX-License-Identifier: BSD-3-Clause
 * Computes the arguments that all rays of a frame share, from camera, volume and options. */
#ifndef STRATUS_RAY_FRAME_H
#define STRATUS_RAY_FRAME_H

#include "stratus/ray_cast.h"
#include "ray_cast_arguments.h"
#include "ray_grid.h"
#include "volume.h"

/* Returns the length of a sample in voxels, along the axis where it is longest. */
double stratus_ray_voxels_a_sample(const stratus_ray_caster* caster);
/* Returns the most voxels that a straight way of this world length passes along an axis of the grid, whatever its direction. */
double stratus_ray_voxels_within(const stratus_volume* volume, double length);

/* Sets the arguments by which pixels, the camera's vectors in the world and the sample distance make the lattice. */
void stratus_ray_frame_lattice(
  const stratus_camera* camera, const stratus_image* image, double sample_distance, stratus_ray_cast_arguments* arguments);
/* Set all arguments of the caster's volume except table and map. sample_distance, follows: as in stratus_ray_choice. *empty: no ray can
 * meet the volume. */
stratus_status stratus_ray_frame_arguments(const stratus_ray_caster* caster, const stratus_camera* camera,
  const stratus_ray_cast_options* options, const stratus_image* image, double sample_distance, bool follows,
  stratus_ray_cast_arguments* arguments, bool* empty);
/* Whether floats distinguish the samples of every ray through a volume. */
bool stratus_ray_step_fits(const stratus_volume* volume, double sample_distance, bool follows);
/* Returns the transparency at which a ray may end where only the tolerance says so. */
double stratus_ray_termination(double tolerance);
/* Sets the arguments of the table. */
void stratus_ray_frame_table(const stratus_table* table, double tolerance, stratus_ray_cast_arguments* arguments);
/* Sets the arguments of table and map, each unless NULL, and the window. grid: the caster's; may be NULL if map is. tolerance: decides into
 * how many pieces a deep segment is cut. */
void stratus_ray_frame_structures(const stratus_ray_grid* grid, const stratus_table* table, double tolerance,
  const stratus_occupancy* occupancy, const stratus_distance_map* map, stratus_ray_cast_arguments* arguments);

#endif
