/* SPDX-License-Identifier: BSD-3-Clause
 * First-hit pictures, which show effective voxels as lit solids: the state that a ray caster keeps for them, and the declarations that
 * their source files share. */
#ifndef STRATUS_FIRST_HIT_PICTURE_H
#define STRATUS_FIRST_HIT_PICTURE_H

#include "lights.h"
#include "ray_caster.h"
#include "tree.h"
#include "voxels.h"

/* Voxels and tree are in index coordinates, voxel (i,j,k) centred at (i,j,k), so that they stay valid when the geometry changes. */
struct stratus_first_hit {
  stratus_volume volume; /* source of voxels and tree */
  const uint8_t* mask;   /* that hides voxels; NULL: none */
  uint64_t mask_revision;
  uint8_t* hidden;            /* ghost flags of the volume's values that say what the mask hides, too; NULL: no mask */
  stratus_transfer* transfer; /* its copied transfer function; NULL: nothing is built */
  stratus_voxels* voxels;     /* may be NULL while an offered tree serves */
  stratus_tree* tree;         /* NULL: not built */
  stratus_tree_method method; /* of the tree */
};

/* Draws a first-hit picture. */
stratus_status stratus_first_hit_render(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report);
/* Frees voxels, tree and transfer function; the next render rebuilds them. */
void stratus_first_hit_release(stratus_ray_caster* caster);
/* Frees caster->first_hit altogether. */
void stratus_first_hit_destroy(stratus_ray_caster* caster);

/* The structures that a picture's rays traverse. */
typedef struct stratus_first_hit_scene {
  const stratus_tree* tree;     /* NULL: rays walk the voxels */
  const stratus_voxels* voxels; /* may be NULL while an offered tree serves */
  double lo[3], hi[3];          /* bounds of all effective voxels, index coordinates; lo > hi: there is none */
  stratus_structure used;
  const stratus_voxel_borders* borders; /* NULL: the volume has no coordinates */
} stratus_first_hit_scene;

/* first_hit_scene.c: finds where voxels begin along axes that have coordinates: values in the middle between neighbours, cells at their
 * first coordinate. The caller releases *memory. */
stratus_status stratus_first_hit_borders(
  stratus_context* context, const stratus_volume* volume, stratus_voxel_borders* borders, void** memory);

/* Rebuilds only parts whose inputs changed. borders: NULL if the volume has no coordinates. With an audit, scene->voxels is there even if
 * an offered tree serves. */
stratus_status stratus_first_hit_update(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_voxel_borders* borders, const stratus_ray_cast_options* options, stratus_first_hit_scene* scene,
  stratus_ray_cast_report* report);

/* The surface at which a ray begins. A voxel that it cuts open takes its normal. */
enum {
  STRATUS_CUT_NEAR = 0,
  STRATUS_CUT_CROP = 1 /* to 6: lower x, upper x, lower y, upper y, lower z, upper z */,
  STRATUS_CUT_PLANE = 7 /* to 12 */
};

typedef struct stratus_first_hit_pixel {
  uint32_t x, y;
  uint32_t cut;
} stratus_first_hit_pixel;

/* The inputs of a hit's colour. */
typedef struct stratus_shader {
  const stratus_volume* volume;
  const stratus_transfer* transfer;
  /* of dependent components: each as a volume, and their biases; the last is `volume`. color_count 0: there are none */
  stratus_volume colors[3];
  double color_bias[3];
  int color_count;
  const stratus_ray_cast_options* options;
  const stratus_voxel_borders* borders; /* NULL: the volume has no coordinates */
  double bias;                          /* stratus_volume_bias() */
  double index_to_world[16], world_to_index[16];
  double face[3][3];                        /* world normal of a voxel's upper face along each index axis */
  double plane[STRATUS_CLIP_PLANES_MAX][3]; /* world normals, pointing away from the kept side */
  stratus_lamps lamps;
} stratus_shader;

/* first_hit_shading.c; volume: of one component; borders: as in stratus_shader */
void stratus_shader_set(stratus_shader* shader, const stratus_volume* volume, const stratus_voxel_borders* borders,
  const stratus_transfer* transfer, const stratus_camera* camera, const stratus_ray_cast_options* options, const double index_to_world[16],
  const double world_to_index[16]);
/* Gives hits the colours of the dependent components of `whole`, whose last is the shader's volume. */
void stratus_shader_set_colors(stratus_shader* shader, const stratus_volume* whole);
/* Compute colour (alpha 1) and world distance of a hit from only ray and voxel, so that every structure gives the same bits. */
void stratus_shader_apply(
  const stratus_shader* shader, const stratus_ray* ray, uint32_t cut, const int32_t voxel[3], float rgba[4], float* depth);

#endif
