/* SPDX-License-Identifier: BSD-3-Clause
 * Tables of shading: samples that are lit, thinned by the gradient, of several components or labelled. */
#ifndef STRATUS_RAY_SHADING_TABLE_H
#define STRATUS_RAY_SHADING_TABLE_H

#include "gradient_factors.h"
#include "stratus/ray_cast.h"
#include "ray_field.h"
#include "volume.h"

typedef struct stratus_ray_optics stratus_ray_optics;

typedef struct stratus_ray_shading_tables {
  stratus_mode mode; /* that the tables are for, as the next */
  double sample_distance;
  stratus_table* tables[4]; /* table of each component that has one; all NULL if components is 1 */
  void* memory;             /* all tables and gradient opacities, as rays read them */
  size_t bytes;
  int first[4], factor_first[4]; /* where each component's table and gradient opacity begin, in floats; factor_first -1: none */
  int first_at[4], bound_at[4];  /* where what finds a component's entries begins, of tables whose entries are not cells */
  float factor_scale[4];         /* entries of the gradient opacity per unit of magnitude */
  stratus_table** label_tables;  /* of labels 0, 1, 2 and so on; NULL: no labels */
  int label_tables_count, label_first, label_steps;
  bool label_factors;    /* some label has a gradient opacity */
  uint64_t table_number; /* of the table when they were made */
} stratus_ray_shading_tables;

int stratus_ray_shading_media(
  const stratus_volume* volume, const stratus_ray_cast_options* options); /* number of transfer functions that the render takes */
stratus_status stratus_ray_shading_check_volume(
  stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options);
/* Makes the tables of a mode and a step. Call it after optics->made is. */
stratus_status stratus_ray_shading_tables_update(
  stratus_ray_optics* optics, const stratus_ray_field* field, stratus_mode mode, double sample_distance);
/* Whether several tables decide which blocks are occupied. */
bool stratus_ray_shading_several(const stratus_ray_optics* optics, const stratus_ray_field* field);
/* Whether any table shows anything. values: that show by the function of the component that rays follow. */
bool stratus_ray_shading_show(const stratus_ray_optics* optics, const stratus_ray_field* field, const stratus_shown* values);
/* Makes the occupancy from several tables. */
stratus_status stratus_ray_shading_occupancy(
  const stratus_ray_optics* optics, const stratus_ray_field* field, stratus_occupancy** occupancy);
void stratus_ray_shading_release(stratus_ray_optics* optics);

#endif
