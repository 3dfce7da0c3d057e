/* SPDX-License-Identifier: BSD-3-Clause
 * The scenes of record. They are a library of their own, Stratus::Scenes. */
#ifndef STRATUS_PUBLIC_SCENES_H
#define STRATUS_PUBLIC_SCENES_H

#include "camera.h"
#include "mesh.h"
#include "voxels.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The volumes that tests, benchmarks, examples and the command line share. */

typedef struct stratus_scene {
  const char* name;
  stratus_volume volume;
  stratus_transfer transfer;
  stratus_transfer edited;           /* the second transfer function, for measuring edits */
  const stratus_transfer* transfers; /* as many as the volume has components: the first is `transfer` */
  int up_axis;                       /* 0..2, of the cameras */
  double occupied;                   /* fraction of values > 0 */
  double mean;                       /* of the values */
} stratus_scene;

/* Names: cloud, plume, fog, haze, peak, voxel; plume2: the plume as two pollutants, of which the first turns into the second on the way. */
STRATUS_EXPERIMENTAL int stratus_scene_count(void);
STRATUS_EXPERIMENTAL const char* stratus_scene_name(int index); /* NULL beyond */
STRATUS_EXPERIMENTAL stratus_status stratus_scene_create(stratus_context* context, const char* name, stratus_scene** scene);
STRATUS_EXPERIMENTAL void stratus_scene_destroy(stratus_context* context, stratus_scene* scene);
/* Camera `view` 0..7 of record around bounds xmin xmax ymin ymax zmin zmax: distance R / sin 15 deg, view angle 21.6 deg, elevation 25 deg,
 * azimuth 30 + 45 view deg about up_axis; parallel scale .72 R. */
STRATUS_EXPERIMENTAL stratus_status stratus_scene_camera(
  stratus_context* context, const double bounds[6], int up_axis, int view, int parallel, double aspect, stratus_camera* camera);
/* Voxel sets of record: 17K 24K 30K 35K u225 u367 u571 u640 1M 10M; and their rays, 512*512 of each kind: kind 0 primary, 1 random from
 * empty voxels, in world coordinates of stratus_voxels_create_list(). */
STRATUS_EXPERIMENTAL int stratus_voxel_scene_count(void);
STRATUS_EXPERIMENTAL const char* stratus_voxel_scene_name(int index); /* NULL beyond */
/* *positions: *count triples, freed with stratus_voxel_scene_release(). */
STRATUS_EXPERIMENTAL stratus_status stratus_voxel_scene_create(
  stratus_context* context, const char* name, int64_t dimensions[3], int32_t** positions, size_t* count);
STRATUS_EXPERIMENTAL void stratus_voxel_scene_release(stratus_context* context, int32_t* positions);
STRATUS_EXPERIMENTAL stratus_status stratus_voxel_scene_rays(
  stratus_context* context, const stratus_voxels* voxels, int kind, stratus_ray* rays);

/* Meshes of record that are made: holes (a plate with 24 of them) and wavelet (998,250 tetrahedra of a lattice). */
typedef struct stratus_mesh_scene {
  const char* name;
  stratus_mesh mesh;    /* wavelet: tetrahedra and a float a point. holes: points of a closed surface, no cells and no values */
  const int32_t* quads; /* holes: its faces, 4 point numbers each, planar, counterclockwise from outside; else NULL */
  int64_t quad_count;
  double maximum_volume; /* of a tetrahedron when a mesher fills the surface: about 800 thousand of them by TetGen; else 0 */
} stratus_mesh_scene;

STRATUS_EXPERIMENTAL int stratus_mesh_scene_count(void);
STRATUS_EXPERIMENTAL const char* stratus_mesh_scene_name(int index); /* NULL beyond */
STRATUS_EXPERIMENTAL stratus_status stratus_mesh_scene_create(stratus_context* context, const char* name, stratus_mesh_scene** scene);
STRATUS_EXPERIMENTAL void stratus_mesh_scene_destroy(stratus_context* context, stratus_mesh_scene* scene);
/* The field of a mesh of record, for points that a mesher adds; NaN for an unknown name. */
STRATUS_EXPERIMENTAL double stratus_mesh_scene_value(const char* name, const double point[3]);

#ifdef __cplusplus
}
#endif

#endif
