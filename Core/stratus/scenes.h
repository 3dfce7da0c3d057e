/* SPDX-License-Identifier: BSD-3-Clause
 * The scenes of record, which tests, benchmarks, examples and the command line share. They are a library of their own, Stratus::Scenes. */
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
 * - plume2, the plume as two pollutants, of which the first turns into the second on the way;
 * - bone and skin, a head of computed tomography (uint16): thin tissue and dense bone; a narrow window at the skin, between vertical steps;
 * - stripes, a constant opacity and 20 colours that meet in vertical steps;
 * - shell and plate, thin fog in 95 % of the voxels, and in it a thin opaque sphere, or a plate in .1 % of the blocks of 4^3 cells;
 * - archipelago-1024, clouds of particles whose sizes and densities differ by orders of magnitude, in 1024^3 voxels (uint8, 1 GiB);
 * - labels 0 to 10 (uint8), each with an opacity and colour of its own in a window of width 1 between vertical steps. */
STRATUS_EXPERIMENTAL int stratus_scene_count(void);
STRATUS_EXPERIMENTAL const char* stratus_scene_name(int index); /* NULL for other indices */
STRATUS_EXPERIMENTAL stratus_status stratus_scene_create(stratus_context* context, const char* name, stratus_scene** scene);
STRATUS_EXPERIMENTAL void stratus_scene_destroy(stratus_context* context, stratus_scene* scene);
/* Makes camera `view` of record, 0..7, around bounds xmin xmax ymin ymax zmin zmax. Its distance is R / sin 15 deg, its view angle 21.6
 * deg, its elevation 25 deg, its azimuth 30 + 45 view deg about up_axis, its parallel scale .72 R. */
STRATUS_EXPERIMENTAL stratus_status stratus_scene_camera(
  stratus_context* context, const double bounds[6], int up_axis, int view, int parallel, double aspect, stratus_camera* camera);
/* Voxel sets of record: 17K 24K 30K 35K u225 u367 u571 u640 1M 10M; in 4096^3 voxels archipelago, scattered clouds, and islets, 8 dense
 * ones. */
STRATUS_EXPERIMENTAL int stratus_voxel_scene_count(void);
STRATUS_EXPERIMENTAL const char* stratus_voxel_scene_name(int index); /* NULL for other indices */
/* Makes *count triples in *positions. Free them with stratus_voxel_scene_release(). */
STRATUS_EXPERIMENTAL stratus_status stratus_voxel_scene_create(
  stratus_context* context, const char* name, int64_t dimensions[3], int32_t** positions, size_t* count);
STRATUS_EXPERIMENTAL void stratus_voxel_scene_release(stratus_context* context, int32_t* positions);
/* Fills 512*512 rays in the world coordinates of stratus_voxels_create_list(). kind 0: primary rays; 1: random rays from empty voxels. */
STRATUS_EXPERIMENTAL stratus_status stratus_voxel_scene_rays(
  stratus_context* context, const stratus_voxels* voxels, int kind, stratus_ray* rays);

/* Meshes of record that are generated: estuary (331,776 tetrahedra of water in layers, under a tide), holes (a plate with 24 holes) and
 * wavelet (998,250 tetrahedra of a lattice). */
typedef struct stratus_mesh_scene {
  const char* name;
  /* estuary, wavelet: tetrahedra and one float for each point. holes: the points of a closed surface, without cells or values. */
  stratus_mesh mesh;
  /* holes: faces of the surface, 4 point numbers each, planar, counterclockwise from outside; else NULL. */
  const int32_t* quads;
  int64_t quad_count;
  /* holes: largest volume of a tetrahedron for a mesher that fills the surface (TetGen makes about 800 thousand tetrahedra); else 0. */
  double maximum_volume;
} stratus_mesh_scene;

STRATUS_EXPERIMENTAL int stratus_mesh_scene_count(void);
STRATUS_EXPERIMENTAL const char* stratus_mesh_scene_name(int index); /* NULL for other indices */
STRATUS_EXPERIMENTAL stratus_status stratus_mesh_scene_create(stratus_context* context, const char* name, stratus_mesh_scene** scene);
STRATUS_EXPERIMENTAL void stratus_mesh_scene_destroy(stratus_context* context, stratus_mesh_scene* scene);
/* Returns the field of a mesh of record at a point that a mesher added; NaN for an unknown name. */
STRATUS_EXPERIMENTAL double stratus_mesh_scene_value(const char* name, const double point[3]);

#ifdef __cplusplus
}
#endif

#endif
