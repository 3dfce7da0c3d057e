/* SPDX-License-Identifier: BSD-3-Clause
 * First-hit pictures: effective voxels as lit solids. What a ray caster keeps for them, and what the files that draw one share. */
#ifndef STRATUS_FIRST_HIT_PICTURE_H
#define STRATUS_FIRST_HIT_PICTURE_H

#include "ray_caster.h"
#include "tree.h"

/* Voxels and tree lie in index coordinates, voxel (i,j,k) about (i,j,k), so that no change of geometry makes them stale. */
struct stratus_first_hit {
  /* what voxels and tree were built from */
  stratus_volume volume;
  stratus_transfer* transfer; /* a copy; NULL: nothing is built */
  stratus_voxels* voxels;     /* NULL while only an offered tree is used */
  stratus_tree* tree;         /* NULL, or by `method` */
  stratus_tree_method method;
};

/* The mode of first hits; dropping what it built; the whole of it. */
stratus_status stratus_first_hit_render(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report);
void stratus_first_hit_release(stratus_ray_caster* caster);
void stratus_first_hit_destroy(stratus_ray_caster* caster);

/* What a picture looks through. */
typedef struct stratus_first_hit_scene {
  const stratus_tree* tree;     /* NULL: walk */
  const stratus_voxels* voxels; /* NULL unless asked for */
  double lo[3], hi[3];          /* of all effective voxels, index coordinates; lo > hi: there is none */
  stratus_structure used;
} stratus_first_hit_scene;

/* first_hit_scene.c: builds anew what changed and nothing else. plain: the voxels themselves are needed, too. */
stratus_status stratus_first_hit_update(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  stratus_structure structure, bool plain, stratus_first_hit_scene* scene, stratus_ray_cast_report* report);

/* Why a ray begins where it does: what gives a cut voxel its normal. */
enum { STRATUS_CUT_NEAR = 0, STRATUS_CUT_CROP = 1 /* .. 6: lower x, upper x, lower y .. */, STRATUS_CUT_PLANE = 7 /* .. 12 */ };

typedef struct stratus_first_hit_pixel {
  uint32_t x, y;
  uint32_t cut;
} stratus_first_hit_pixel;

/* All that gives a hit its colour. */
typedef struct stratus_shader {
  const stratus_volume* volume;
  const stratus_transfer* transfer;
  const stratus_ray_cast_options* options;
  double bias;                                   /* of fetched values */
  double index_to_world[16], world_to_index[16]; /* rays are in index coordinates */
  double face[3][3];                             /* world normal of the face towards + along each index axis */
  double plane[STRATUS_CLIP_PLANES_MAX][3];      /* world normals, away from what is kept */
  stratus_light lights[STRATUS_LIGHTS_MAX];      /* directions of length 1 */
  int light_count;
} stratus_shader;

/* first_hit_shading.c */
stratus_status stratus_shading_check(stratus_context* context, const stratus_shading* shading);
void stratus_shader_set(stratus_shader* shader, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const double index_to_world[16], const double world_to_index[16]);
/* Colour (alpha 1) and world distance of a hit; depends on the ray and the voxel alone, so that every way to the voxel gives the same bits.
 */
void stratus_shader_apply(
  const stratus_shader* shader, const stratus_ray* ray, uint32_t cut, const int32_t voxel[3], float rgba[4], float* depth);

#endif
