/* SPDX-License-Identifier: BSD-3-Clause
 * The scenes of record, which tests, benchmarks, examples and the command line share. They form a library of their own, Stratus::Scenes. */
#ifndef STRATUS_PUBLIC_SCENES_H
#define STRATUS_PUBLIC_SCENES_H

#include "camera.h"
#include "mesh.h"
#include "voxels.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A volume with its transfer functions. */

typedef struct stratus_scene {
  const char* name;
  stratus_volume volume;
  stratus_transfer transfer;
  stratus_transfer edited;           /* a second transfer function, to measure edits */
  const stratus_transfer* transfers; /* one for each component of the volume; the first is `transfer` */
  int up_axis;                       /* 0..2: the axis that points up in the cameras */
  double occupied;                   /* fraction of the values that are > 0 */
  double mean;                       /* mean of the values */
} stratus_scene;

/* Names:
 * - cloud, plume, fog, haze, peak and voxel;
 * - plume2, the plume as two pollutants: the first turns into the second as it drifts;
 * - bone and skin, a head of computed tomography (uint16): thin tissue and dense bone; a narrow window at the skin, between vertical steps;
 * - stripes, a constant opacity and 20 colours that meet in vertical steps;
 * - shell and plate, thin fog in 95 % of the voxels, with a thin opaque sphere in it, or a plate in .1 % of the blocks of 4^3 cells;
 * - archipelago-1024, clouds of particles whose sizes and densities differ by orders of magnitude, in 1024^3 voxels (uint8, 1 GiB);
 * - cumulus-rectilinear, the cloud on 96 levels whose distance grows with height, from .4 to 6.4;
 * - labels 0 to 10 (uint8), each with its own opacity and colour in a window of width 1 between vertical steps.
 *
 * stratus_scene_count() returns the number of names. */
STRATUS_EXPERIMENTAL int stratus_scene_count(void);
/* Return a scene's name, index 0..count-1. */
STRATUS_EXPERIMENTAL const char* stratus_scene_name(int index); /* NULL for other indices */
/* Create a scene by its name. An unknown name gives STRATUS_INVALID_ARGUMENT. */
STRATUS_EXPERIMENTAL stratus_status stratus_scene_create(stratus_context* context, const char* name, stratus_scene** scene);
STRATUS_EXPERIMENTAL void stratus_scene_destroy(stratus_context* context, stratus_scene* scene);
/* Make a camera of record around a box. R is half the box's diagonal. The camera is R / sin 15 deg away, with view angle 21.6 deg,
 * elevation 25 deg, azimuth 30 + 45 view deg about up_axis, and parallel scale .72 R.
 * - bounds: xmin xmax ymin ymax zmin zmax, finite, with a diagonal > 0.
 * - up_axis: 0..2. view: 0..7. parallel: 1 for parallel rays. aspect: width/height, > 0.
 *
 * Returns STRATUS_INVALID_ARGUMENT for values outside these ranges. */
STRATUS_EXPERIMENTAL stratus_status stratus_scene_camera(
  stratus_context* context, const double bounds[6], int up_axis, int view, int parallel, double aspect, stratus_camera* camera);
/* Voxel sets of record: 17K 24K 30K 35K u225 u367 u571 u640 1M 10M; in 4096^3 voxels archipelago (scattered clouds) and islets (8 dense
 * clouds). stratus_voxel_scene_count() returns the number of names. */
STRATUS_EXPERIMENTAL int stratus_voxel_scene_count(void);
/* Return a set's name, index 0..count-1. */
STRATUS_EXPERIMENTAL const char* stratus_voxel_scene_name(int index); /* NULL for other indices */
/* Make a set's *count triples in *positions, and its dimensions. Free the triples with stratus_voxel_scene_release(). An unknown name gives
 * STRATUS_INVALID_ARGUMENT. */
STRATUS_EXPERIMENTAL stratus_status stratus_voxel_scene_create(
  stratus_context* context, const char* name, int64_t dimensions[3], int32_t** positions, size_t* count);
STRATUS_EXPERIMENTAL void stratus_voxel_scene_release(stratus_context* context, int32_t* positions);
/* Fill 512*512 rays in the world coordinates of stratus_voxels_create_list(). kind 0: primary rays; 1: random rays from empty voxels.
 * Another kind, or random rays in a set without empty voxels, give STRATUS_INVALID_ARGUMENT. */
STRATUS_EXPERIMENTAL stratus_status stratus_voxel_scene_rays(
  stratus_context* context, const stratus_voxels* voxels, int kind, stratus_ray* rays);

/* Meshes of record that are generated: estuary (331,776 tetrahedra of water in layers, under a tide), holes (a plate with 24 holes) and
 * wavelet (998,250 tetrahedra of a lattice). */
typedef struct stratus_mesh_scene {
  const char* name;
  /* estuary, wavelet: tetrahedra and one float for each point. holes: the points of a closed surface, without cells or values. */
  stratus_mesh mesh;
  /* Holes: faces of the surface, 4 point numbers each, planar, counterclockwise from outside. NULL in the other scenes. */
  const int32_t* quads;
  int64_t quad_count;
  /* Holes: largest volume of a tetrahedron for a mesher that fills the surface (TetGen makes about 800 thousand tetrahedra). 0 in the other
   * scenes. */
  double maximum_volume;
} stratus_mesh_scene;

/* Return the number of meshes, and a mesh's name, index 0..count-1. */
STRATUS_EXPERIMENTAL int stratus_mesh_scene_count(void);
STRATUS_EXPERIMENTAL const char* stratus_mesh_scene_name(int index); /* NULL for other indices */
/* Create a mesh by its name. An unknown name gives STRATUS_INVALID_ARGUMENT. */
STRATUS_EXPERIMENTAL stratus_status stratus_mesh_scene_create(stratus_context* context, const char* name, stratus_mesh_scene** scene);
STRATUS_EXPERIMENTAL void stratus_mesh_scene_destroy(stratus_context* context, stratus_mesh_scene* scene);
/* Return the field of a mesh of record at a point that a mesher added; NaN for an unknown name. */
STRATUS_EXPERIMENTAL double stratus_mesh_scene_value(const char* name, const double point[3]);

#ifdef __cplusplus
}
#endif

#endif
