/* SPDX-License-Identifier: BSD-3-Clause
 * Lengths of voxels, in the world. */
#ifndef STRATUS_RAY_VOXELS_H
#define STRATUS_RAY_VOXELS_H

#include "volume.h"

/* Returns the world length of a voxel's shortest edge, among the axes along which the volume extends; less where that would cross a
 * thousand layers of voxels. */
double stratus_ray_voxel_length(const stratus_volume* volume);
/* Whether automatic samples follow each ray's way through the voxels. */
bool stratus_ray_follows_voxels(const stratus_volume* volume);
/* Gives, for samples that follow the voxels and are at least sample_distance long, how many of them a ray takes in passing a voxel along
 * each axis; along an axis without extent a thousandth of that. */
void stratus_ray_samples_a_voxel(const stratus_volume* volume, double sample_distance, double samples[3]);

#endif
