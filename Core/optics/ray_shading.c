/* SPDX-License-Identifier: BSD-3-Clause
 * Shading: samples that are lit, thinned by the gradient, of several components or labelled. Decides whether a render has them, and sets
 * the arguments of their rays. */
#include "ray_shading_render.h"

#include "lights.h"
#include "matrix.h"
#include "ray_fetched.h"
#include "ray_voxels.h"

stratus_status stratus_ray_shading_check(stratus_context* context, const stratus_ray_cast_options* options)
{
  return options->light.shade ? stratus_shading_check(context, &options->light.shading) : STRATUS_OK;
}

stratus_status stratus_ray_shading_check_materials(
  stratus_context* context, const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  const int components = stratus_volume_components(volume);
  const bool lit =
    options->mode == STRATUS_MODE_COMPOSITE || options->mode == STRATUS_MODE_ISOSURFACE || options->mode == STRATUS_MODE_FIRST_HIT;
  const bool read = options->light.materials && components > 1 && !options->optics.dependent && lit;
  for (int c = 0; read && c < components; ++c) {
    const stratus_material* m = options->light.materials + c;
    const double numbers[4] = { m->ambient, m->diffuse, m->specular, m->specular_power };
    for (int i = 0; m->shade && i < 4; ++i) {
      if (!(numbers[i] >= 0.0 && numbers[i] <= STRATUS_LIGHT_MAX)) {
        return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "material of component %d has (%g, %g, %g, %g), must be 0..%g", c,
          numbers[0], numbers[1], numbers[2], numbers[3], STRATUS_LIGHT_MAX);
      }
    }
    if (m->shade) {
      TRY(stratus_shading_check(context, &options->light.shading));
    }
  }
  return STRATUS_OK;
}

/* The material of component c: the shading's own where there are none of components. */
static stratus_material material_of(
  const stratus_ray_optics* optics, const stratus_ray_field* field, const stratus_ray_cast_options* options, int c)
{
  const stratus_shading* shading = &options->light.shading;
  const bool own = options->light.materials && !optics->dependent && field->components > 1;
  return own ? options->light.materials[c]
             : (stratus_material){ options->light.shade, shading->ambient, shading->diffuse, shading->specular, shading->specular_power };
}

bool stratus_ray_shading_wanted(const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options)
{
  const bool more = options->light.shade || transfer->gradient_count > 0 || options->mask.label_count > 0;
  return !options->optics.transfer_2d && (stratus_volume_components(volume) > 1 || (options->mode == STRATUS_MODE_COMPOSITE && more));
}

/* Largest number of samples in gradient_distance: products with the optical depth of opacity 1, 1e30, stay floats. */
#define REACH_MOST 1e7

static void set_tables(const stratus_ray_optics* optics, const stratus_ray_field* field, double sample_distance,
  const stratus_ray_cast_options* options, stratus_ray_cast_arguments* a)
{
  const stratus_ray_shading_tables* shading = &optics->shading_tables;
  a->media.components = field->components;
  a->media.dependent = optics->dependent ? a->media.components - 1 : 0;
  a->media.mean = options->optics.mean_components && !optics->dependent;
  a->media.factor_reach = 0.0f;
  a->media.factor_last = (float)STRATUS_SHADING_FACTORS;
  a->media.label_factors = shading->label_tables && shading->label_factors;
  a->media.label_first = shading->label_first;
  a->media.label_steps = shading->label_tables ? shading->label_steps : 0;
  a->media.label_count = shading->label_tables ? shading->label_tables_count - 1 : 0;
  a->media.component_bytes = (int)(uint32_t)stratus_ray_component_bytes(field);
  for (int c = 0; c < 4; ++c) {
    const stratus_table* table = shading->tables[c];
    const bool has = optics->shades && options->mode == STRATUS_MODE_COMPOSITE && c < field->components;
    a->media.factor_first[c] = has ? shading->factor_first[c] : -1;
    if (a->media.factor_first[c] >= 0 || a->media.label_factors) {
      a->media.factor_reach = (float)fmin(options->optics.gradient_distance / sample_distance, REACH_MOST);
    }
    a->media.factor_scale[c] = shading->factor_scale[c];
    a->media.first[c] = shading->first[c];
    a->media.scale[c] = table ? table->scale : 0.0f;
    a->media.offset[c] = table ? table->offset : 0.0f;
    a->media.last[c] = table ? (float)(table->cells - 1) : 0.0f;
    a->media.search_steps[c] = table ? table->search_steps : 0;
    a->media.first_at[c] = shading->first_at[c];
    a->media.bound_at[c] = shading->bound_at[c];
    a->media.weight[c] =
      c < field->components && c < optics->transfer_count && !optics->dependent ? (float)optics->transfers[c].weight : 1.0f;
  }
}

void stratus_ray_shading_arguments(const stratus_ray_optics* optics, const stratus_ray_field* field, double sample_distance,
  const stratus_volume* volume, const stratus_camera* camera, const stratus_ray_cast_options* options, stratus_ray_cast_arguments* a)
{
  const double edge = stratus_ray_voxel_length(volume);
  const bool lit = options->mode == STRATUS_MODE_COMPOSITE || options->mode == STRATUS_MODE_ISOSURFACE;
  double index_to_world[16], world_to_index[16];
  if (!optics->shades && !options->light.shade && !optics->transfer_2d.on) {
    return;
  }
  stratus_volume_index_to_world(volume, index_to_world);
  if (!stratus_matrix_invert_affine(index_to_world, world_to_index)) {
    return; /* stratus_ray_frame_arguments() has refused it */
  }
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) { /* normals transform by the inverse's transpose and point against the gradient */
      a->light.normal[3 * row + axis] = (float)(-world_to_index[4 * axis + row] * edge);
      a->light.place[3 * row + axis] = (float)(index_to_world[4 * row + axis] / edge);
    }
  }
  const double spacing[3] = { fabs(stratus_volume_spacing(volume, 0)), fabs(stratus_volume_spacing(volume, 1)),
    fabs(stratus_volume_spacing(volume, 2)) };
  const double of = options->optics.gradient_length, length = of > 0.0 ? of : (spacing[0] + spacing[1] + spacing[2]) / 3.0;
  for (int axis = 0; axis < 3; ++axis) {
    a->media.gradient_length[axis] = (float)(length / spacing[axis]);
  }
  set_tables(optics, field, sample_distance, options, a);
  stratus_ray_transfer_2d_arguments(&optics->transfer_2d, field, sample_distance, a);
  for (int c = 0; c < 4; ++c) {
    const bool there = c == 0 || c < field->components;
    const stratus_material material = material_of(optics, field, options, there ? c : 0);
    const double numbers[4] = { material.ambient, material.diffuse, material.specular, material.specular_power };
    a->light.on |= lit && there && material.shade ? 1 << c : 0;
    for (int i = 0; i < 4; ++i) {
      a->light.material[c][i] = (float)numbers[i];
    }
  }
  if (!a->light.on) { /* the lights are unchecked and unused */
    return;
  }
  const double origin[3] = { index_to_world[3], index_to_world[7], index_to_world[11] };
  stratus_light lights[STRATUS_LIGHTS_MAX];
  stratus_lights_set(camera, &options->light.shading, origin, edge, lights, &a->light);
  const bool near = options->mode == STRATUS_MODE_COMPOSITE && !stratus_ray_shading_several(optics, field) && !optics->transfer_2d.on;
  stratus_light_maps_arguments(optics->lights, lights, index_to_world, edge, near ? sample_distance : 0.0, &a->light);
}
