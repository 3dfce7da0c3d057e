/* SPDX-License-Identifier: BSD-3-Clause */
#include "block_window.h"

#include "camera.h"
#include "matrix.h"
#include "volume.h"

void stratus_block_window(const stratus_volume* volume, const stratus_camera* camera, const stratus_image* image, int window[4])
{
  double index_to_world[16], world_to_index[16], eye[3], right[3], up[3], forward[3], lo[3], hi[3];
  const int sides[2] = { image->width, image->height };
  stratus_volume_index_to_world(volume, index_to_world);
  if (!stratus_matrix_invert_affine(index_to_world, world_to_index)) { /* the block's own picture refuses it */
    window[0] = window[2] = 0;
    window[1] = sides[0];
    window[3] = sides[1];
    return;
  }
  stratus_matrix_point(world_to_index, camera->eye, eye);
  stratus_matrix_vector(world_to_index, camera->right, right);
  stratus_matrix_vector(world_to_index, camera->up, up);
  stratus_matrix_vector(world_to_index, camera->forward, forward);
  for (int axis = 0; axis < 3; ++axis) { /* solid voxels reach half a voxel beyond their points */
    lo[axis] = -0.5;
    hi[axis] = (double)volume->dimensions[axis] - 0.5;
  }
  stratus_camera_window(eye, right, up, forward, camera->parallel, lo, hi, sides, window);
}
