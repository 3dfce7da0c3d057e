/* SPDX-License-Identifier: BSD-3-Clause
 * What samples that are more than one value's colour and opacity are looked up in, and what of the input their tables need. */
#ifndef STRATUS_RAY_SHADING_TABLE_H
#define STRATUS_RAY_SHADING_TABLE_H

#include "stratus/ray_cast.h"
#include "volume.h"

/* Steps of a gradient opacity function, between which it is taken as linear. */
#define STRATUS_SHADING_FACTORS 4096

typedef struct stratus_ray_shading_tables {
  int components;                 /* of the volume */
  stratus_value_range* ranges[4]; /* of components 1 .. */
  stratus_table* tables[4];       /* of several components: where each has one */
  void* memory;                   /* all tables, and gradient opacity, as rays read them */
  size_t bytes;
  int first[4], factor_first[4]; /* in floats; factor_first -1: none */
  float factor_scale[4];         /* entries per magnitude */
  stratus_table** label_tables;  /* of label 0 and on, NULL: no labels */
  int label_tables_count, label_first;
  uint64_t range_builds, table_builds; /* the caster's, that they belong to */
} stratus_ray_shading_tables;

int stratus_volume_components(const stratus_volume* volume);
stratus_volume stratus_volume_component(const stratus_volume* volume, int component); /* as a volume of its own */
int stratus_ray_shading_media(
  const stratus_volume* volume, const stratus_ray_cast_options* options); /* transfer functions that the render takes */
stratus_status stratus_ray_shading_check_volume(
  stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options);
stratus_status stratus_ray_shading_ranges(stratus_ray_caster* caster); /* of the components beside the first */
void stratus_ray_shading_choose(
  stratus_ray_caster* caster, double voxel, const stratus_transfer* transfer, const stratus_ray_cast_options* options);
stratus_status stratus_ray_shading_tables_update(stratus_ray_caster* caster, bool dependent); /* after caster->table */
bool stratus_ray_shading_several(const stratus_ray_caster* caster);       /* tables, so that one map of opacity is not enough */
bool stratus_ray_shading_show(const stratus_ray_caster* caster);          /* anything at all */
stratus_status stratus_ray_shading_occupancy(stratus_ray_caster* caster); /* caster->occupancy, of several components */
void stratus_ray_shading_release(stratus_ray_caster* caster);

#endif
