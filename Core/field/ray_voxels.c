/* SPDX-License-Identifier: BSD-3-Clause
 * Lengths of voxels, in the world. */
#include "ray_voxels.h"

#include "matrix.h"
#include "vector.h"

/* The length crosses at most this many layers of voxels of any axis: of axes without extent, and of layers that shear has brought together.
 * The longest automatic step is four lengths, and ray_frame.c refuses steps that cross more than 4096 layers. */
#define LAYERS_MOST 1000.0

/* Automatic steps are 1/16 to 4 voxels long. Where voxels are longer than that range is wide, no step of one length for all rays is right:
 * along the long side it would be a small part of a voxel at best. */
#define SIDES_MOST 64.0

/* Gives the lengths of the shortest and of the longest side of a voxel among the axes along which the volume extends. */
static void sides_of(const stratus_volume* volume, const double m[16], double* shortest, double* longest)
{
  *shortest = INFINITY;
  *longest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double length = sqrt(m[axis] * m[axis] + m[4 + axis] * m[4 + axis] + m[8 + axis] * m[8 + axis]);
    if (stratus_volume_extends(volume, axis)) {
      *shortest = fmin(*shortest, length);
      *longest = fmax(*longest, length);
    }
  }
}

bool stratus_ray_follows_voxels(const stratus_volume* volume)
{
  double m[16], shortest, longest;
  stratus_volume_index_to_world(volume, m);
  sides_of(volume, m, &shortest, &longest);
  return longest > SIDES_MOST * shortest;
}

double stratus_ray_voxel_length(const stratus_volume* volume)
{
  double m[16], inverse[16], shortest, longest, thinnest = INFINITY;
  stratus_volume_index_to_world(volume, m);
  sides_of(volume, m, &shortest, &longest);
  if (stratus_matrix_invert_affine(m, inverse)) {
    for (int axis = 0; axis < 3; ++axis) {
      thinnest = fmin(thinnest, 1.0 / sqrt(stratus_vector_dot(inverse + 4 * axis, inverse + 4 * axis)));
    }
  }
  return fmin(shortest, LAYERS_MOST * thinnest);
}

void stratus_ray_samples_a_voxel(const stratus_volume* volume, double sample_distance, double samples[3])
{
  const double rate = stratus_ray_voxel_length(volume) / sample_distance;
  for (int axis = 0; axis < 3; ++axis) {
    samples[axis] = stratus_volume_extends(volume, axis) ? rate : rate / LAYERS_MOST;
  }
}
