/* SPDX-License-Identifier: BSD-3-Clause
 * Several volumes as one medium, by the reference renderer: at every place along a ray optical depths and emitted light of all volumes add
 * up. */
#ifndef STRATUS_TESTING_REFERENCE_SEVERAL_H
#define STRATUS_TESTING_REFERENCE_SEVERAL_H

#include "reference.h"

#ifdef __cplusplus
extern "C" {
#endif

#define REFERENCE_SEVERAL_MAX 8

/* A mesh of tetrahedra with a value at each point (float32) or cell, in the world by its matrix. Cells that overlap add up. */
typedef struct reference_mesh {
  const stratus_mesh* mesh;
  const stratus_transfer* transfer;
  int clip_plane_count;
  const double (*clip_planes)[4]; /* world: points with a x + b y + c z + d >= 0 show */
  /* Lights the colour of a cell at a place of a ray, which goes along `along`, and multiplies the optical depth there; NULL: nothing. */
  void (*light)(const void* data, int64_t cell, const double place[3], const double along[3], double rgb[3], double* depth);
  const void* data;
} reference_mesh;

/* The input of a picture of volumes and meshes: at least one of them. */
typedef struct reference_mixture {
  const reference_scene* scenes; /* their cameras and opaque depths are not read */
  int count;                     /* 0..8 */
  const reference_mesh* meshes;
  int mesh_count; /* 0..8 */
  const stratus_camera* camera;
  const float* opaque_depth; /* may be NULL */
} reference_mixture;

/* As reference_render_several(), with meshes among the volumes. step: in units of the world. */
int reference_render_mixture(const reference_mixture* mixture, int width, int height, double step, float* rgba, float* depth);

/* Draws 1..8 scenes, all from the camera and with the opaque depth of the first, as reference_render() does, in midpoint steps between the
 * places where a ray enters or leaves a volume, halved where it shows. step: the largest, in units of the shortest voxel edge of all
 * volumes, > 0. */
int reference_render_several(const reference_scene* scenes, int count, int width, int height, double step, float* rgba, float* depth);

/* As reference_converged(), from a step of 1/4 on to 1/512. */
int reference_converged_several(
  const reference_scene* scenes, int count, int width, int height, double wanted_db, float* rgba, float* depth, double* reference_db);

#ifdef __cplusplus
}
#endif
#endif
