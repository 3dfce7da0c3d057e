/* SPDX-License-Identifier: BSD-3-Clause
 * Tables of shading: samples that are lit, thinned by the gradient, of several components or labelled. */
#ifndef STRATUS_RAY_SHADING_TABLE_H
#define STRATUS_RAY_SHADING_TABLE_H

#include "gradient_factors.h"
#include "stratus/ray_cast.h"
#include "volume.h"

typedef struct stratus_ray_shading_tables {
  int components;                 /* of the volume */
  stratus_value_range* ranges[4]; /* value range of each component; NULL of the one that rays follow: caster->ranges serves */
  stratus_table* tables[4];       /* table of each component that has one; all NULL if components is 1 */
  void* memory;                   /* all tables and gradient opacities, as rays read them */
  size_t bytes;
  int first[4], factor_first[4]; /* where each component's table and gradient opacity begin, in floats; factor_first -1: none */
  int first_at[4], bound_at[4];  /* where what finds a component's entries begins, of tables whose entries are not cells */
  float factor_scale[4];         /* entries of the gradient opacity per unit of magnitude */
  stratus_table** label_tables;  /* of labels 0, 1, 2 and so on; NULL: no labels */
  int label_tables_count, label_first, label_steps;
  bool label_factors;                  /* some label has a gradient opacity */
  uint64_t range_builds, table_number; /* the caster's counts when ranges and tables were made */
} stratus_ray_shading_tables;

int stratus_volume_components(const stratus_volume* volume);
/* The planes of one number for each value that rays read: of each component the values and, if the volume has gradients, the three
 * derivatives behind them. */
static inline int stratus_volume_planes(const stratus_volume* volume)
{
  return stratus_volume_components(volume) * (volume->gradients ? 4 : 1);
}
stratus_volume stratus_volume_component(const stratus_volume* volume, int component); /* a component as a volume of its own */
/* The component that rays follow, see stratus_ray_caster. */
int stratus_ray_followed(const stratus_volume* volume, const stratus_ray_cast_options* options);
int stratus_ray_shading_media(
  const stratus_volume* volume, const stratus_ray_cast_options* options); /* number of transfer functions that the render takes */
stratus_status stratus_ray_shading_check_volume(
  stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options);
stratus_status stratus_ray_shading_ranges(stratus_ray_caster* caster); /* value ranges of all components but the followed one */
const stratus_value_range* stratus_ray_shading_range_of(const stratus_ray_caster* caster, int component);
stratus_status stratus_ray_shading_tables_update(stratus_ray_caster* caster, bool dependent); /* call after caster->made is */
bool stratus_ray_shading_several(const stratus_ray_caster* caster);       /* whether several tables decide which blocks are occupied */
bool stratus_ray_shading_show(const stratus_ray_caster* caster);          /* whether any table shows anything */
stratus_status stratus_ray_shading_occupancy(stratus_ray_caster* caster); /* makes caster->occupancy from several tables */
void stratus_ray_shading_release(stratus_ray_caster* caster);

#endif
