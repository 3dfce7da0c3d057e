/* SPDX-License-Identifier: BSD-3-Clause
 * Shadows of volumes and meshes. Each caster has one of its own that draws the same matter without light, layer by layer as the lights see
 * it. Volumes are drawn on the host, so that host and device have the same maps. */
#include "ray_light.h"

#include "lights.h"
#include "matrix.h"
#include "ray_sampling.h"
#include "ray_shading_render.h"
#include "tetra_caster.h"

#include <string.h>

/* Steps through near matter to a voxel: the field along them counts as straight from end to end. */
#define NEAR_STEPS_A_VOXEL 2.0

static bool has_shadows(const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  const bool lit = options->mode == STRATUS_MODE_COMPOSITE || options->mode == STRATUS_MODE_ISOSURFACE;
  return lit &&
    stratus_lights_cast_shadows(&options->light.shading, options->light.shade != 0,
      options->optics.dependent ? NULL : options->light.materials, stratus_volume_components(volume));
}

static bool input_has_shadows(const stratus_ray_cast_input* in)
{
  return in->tetra ? in->tetra_options && stratus_tetra_has_shadows(in->mesh, in->tetra_options)
                   : in->options && has_shadows(in->volume, in->options);
}

/* Options of the same matter without light. */
static stratus_ray_cast_options dark_options(const stratus_ray_cast_options* options)
{
  stratus_ray_cast_options dark = *options;
  dark.light.shade = 0;
  dark.light.materials = NULL;
  dark.sampling.jitter = dark.skipping.audit = 0;
  return dark;
}

/* The caster that draws a volume's matter. */
static stratus_status dark_caster(stratus_ray_caster* caster, stratus_ray_caster** dark)
{
  stratus_ray_caster** part = &caster->parts[STRATUS_RAY_LIGHT_PART];
  if (!*part) {
    TRY(stratus_ray_caster_create(caster->context, part));
  }
  *dark = *part;
  (*dark)->on_host = true;
  return STRATUS_OK;
}

/* Brings the caster of a volume's matter up to date, and adds what decides where its matter is to the key. */
static stratus_status key_of_volume(stratus_ray_caster* dark, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_ray_cast_options* options, uint64_t* key)
{
  stratus_ray_cast_report unused = { .rays = 0 };
  double to_world[16];
  TRY(stratus_ray_update_transfer_2d(dark, volume, options));
  transfer = options->optics.transfer_2d ? &dark->optics.transfer_2d.shown : transfer;
  TRY(stratus_ray_update_tables(dark, volume, transfer, options, 0, &unused));
  const stratus_ray_optics_options* optics = &options->optics;
  const stratus_ray_clipping_options* clip = &options->clipping;
  const uint64_t serials[2] = { dark->field.data_serial, dark->optics.table_serial };
  const double numbers[10] = { options->mode, options->sampling.interpolation, options->sampling.tolerance, optics->gradient_distance,
    optics->gradient_length, optics->mean_components, clip->clip_gradients, clip->clipped_value, clip->clip_plane_count,
    clip->crop ? clip->crop_regions : 0.0 };
  stratus_volume_index_to_world(volume, to_world);
  *key = stratus_light_key(*key, serials, sizeof serials);
  *key = stratus_light_key(*key, numbers, sizeof numbers);
  *key = stratus_light_key(*key, clip->clip_planes, (size_t)clip->clip_plane_count * sizeof clip->clip_planes[0]);
  *key = stratus_light_key(*key, clip->crop_bounds, clip->crop ? sizeof clip->crop_bounds : 0);
  *key = stratus_light_key(*key, to_world, sizeof to_world);
  /* tables of another function are made when the sampling is chosen, and their serial is the old one until then */
  *key = stratus_light_key_of_transfers(*key, transfer, dark->optics.transfer_count);
  return STRATUS_OK;
}

/* ---- one volume */

typedef struct one_volume {
  stratus_ray_draw_one* draw;
  stratus_ray_caster* caster;
  const stratus_volume* volume;
  const stratus_transfer* transfer;
  stratus_ray_cast_options options;
} one_volume;

static stratus_status draw_volume(void* of, const stratus_camera* camera, const stratus_image* image)
{
  const one_volume* m = of;
  stratus_ray_cast_report report;
  return m->draw(m->caster, m->volume, m->transfer, camera, &m->options, image, &report);
}

stratus_status stratus_ray_light_update(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, stratus_ray_draw_one* draw, stratus_ray_cast_report* report)
{
  stratus_light lights[STRATUS_LIGHTS_MAX];
  uint64_t key = 0;
  if (caster->light_given) {
    return STRATUS_OK;
  }
  if (!has_shadows(volume, options)) {
    stratus_light_state_drop(&caster->light);
    caster->optics.lights = NULL;
    stratus_ray_caster_destroy(caster->parts[STRATUS_RAY_LIGHT_PART]);
    caster->parts[STRATUS_RAY_LIGHT_PART] = NULL;
    return STRATUS_OK;
  }
  const double start = stratus_now_ms();
  one_volume m = { .draw = draw, .volume = volume, .transfer = transfer, .options = dark_options(options) };
  stratus_light_matter matter = { .draw = draw_volume, .of = &m, .tolerance = options->sampling.tolerance };
  const bool regions = options->clipping.crop && options->clipping.crop_regions != STRATUS_CROP_INSIDE;
  if (stratus_volume_components(volume) == 1 && options->mode == STRATUS_MODE_COMPOSITE && options->mask.label_count == 0 &&
    !options->optics.transfer_2d && transfer->gradient_count == 0 && !regions) { /* near rays know no gradient opacity */
    matter.step = stratus_ray_voxel_length(volume) / NEAR_STEPS_A_VOXEL;
  }
  TRY(dark_caster(caster, &m.caster));
  TRY(key_of_volume(m.caster, volume, transfer, &m.options, &key));
  const int count = stratus_lights_in_world(camera, &options->light.shading, lights);
  if (stratus_light_state_is_stale(&caster->light, key, lights, count)) {
    TRY(stratus_volume_bounds(caster->context, volume, matter.bounds));
    TRY(stratus_light_state_build(caster->context, &matter, lights, count, &caster->light));
    /* the drawing may have chosen the sampling, and with it made tables */
    TRY(key_of_volume(m.caster, volume, transfer, &m.options, &caster->light.key));
  }
  caster->optics.lights = caster->light.maps;
  report->light_ms = stratus_now_ms() - start;
  return STRATUS_OK;
}

/* ---- several */

typedef struct several {
  stratus_context* context;
  stratus_ray_cast_input* inputs; /* of the matter */
  stratus_ray_cast_options* options;
  stratus_tetra_options* tetra_options;
  int count;
  stratus_ray_draw_several* draw;
} several;

static stratus_status draw_several(void* of, const stratus_camera* camera, const stratus_image* image)
{
  const several* m = of;
  return m->draw(m->inputs, m->count, camera, image, NULL);
}

/* Makes the inputs of the matter, and the key. */
static stratus_status darken(several* m, const stratus_ray_cast_input* inputs, uint64_t* key)
{
  const stratus_ray_cast_options defaults = stratus_ray_cast_options_default();
  *key = 0;
  for (int n = 0; n < m->count; ++n) {
    stratus_ray_cast_input* dark = &m->inputs[n];
    *dark = inputs[n];
    if (inputs[n].tetra) {
      const stratus_tetra_options tetra_defaults = stratus_tetra_options_default();
      m->tetra_options[n] = stratus_tetra_dark_options(inputs[n].tetra_options ? inputs[n].tetra_options : &tetra_defaults);
      dark->tetra_options = &m->tetra_options[n];
      TRY(stratus_tetra_light_caster(inputs[n].tetra, &dark->tetra));
      *key = stratus_tetra_shadow_key(*key, dark->mesh, dark->transfer, dark->tetra_options);
    } else {
      m->options[n] = dark_options(inputs[n].options ? inputs[n].options : &defaults);
      dark->options = &m->options[n];
      TRY(dark_caster(inputs[n].caster, &dark->caster));
      TRY(key_of_volume(dark->caster, dark->volume, dark->transfer, dark->options, key));
    }
  }
  return STRATUS_OK;
}

/* Adds the points of a mesh, or of each of its blocks, to bounds. */
static void add_points(const stratus_mesh* mesh, const double matrix[16], double bounds[6])
{
  for (int n = 0; n < mesh->block_count; ++n) {
    add_points(mesh->blocks + n, matrix, bounds);
  }
  for (int64_t i = 0; (mesh->points || mesh->float_points) && i < mesh->point_count; ++i) {
    double local[3], point[3];
    for (int axis = 0; axis < 3; ++axis) {
      local[axis] = mesh->points ? mesh->points[3 * i + axis] : (double)mesh->float_points[3 * i + axis];
    }
    stratus_matrix_point(matrix, local, point);
    for (int axis = 0; axis < 3 && isfinite(point[0] + point[1] + point[2]); ++axis) {
      bounds[2 * axis] = fmin(bounds[2 * axis], point[axis]);
      bounds[2 * axis + 1] = fmax(bounds[2 * axis + 1], point[axis]);
    }
  }
}

static stratus_status bounds_of(const several* m, double bounds[6])
{
  for (int side = 0; side < 6; ++side) {
    bounds[side] = side & 1 ? -INFINITY : INFINITY;
  }
  for (int n = 0; n < m->count; ++n) {
    double own[6];
    if (m->inputs[n].tetra) {
      add_points(m->inputs[n].mesh, m->inputs[n].mesh->matrix, bounds);
    } else {
      TRY(stratus_volume_bounds(m->context, m->inputs[n].volume, own));
      for (int side = 0; side < 6; ++side) {
        bounds[side] = side & 1 ? fmax(bounds[side], own[side]) : fmin(bounds[side], own[side]);
      }
    }
  }
  for (int axis = 0; axis < 3; ++axis) { /* without any point there is no matter */
    bounds[2 * axis] = isfinite(bounds[2 * axis]) ? bounds[2 * axis] : 0.0;
    bounds[2 * axis + 1] = isfinite(bounds[2 * axis + 1]) ? bounds[2 * axis + 1] : 0.0;
  }
  return STRATUS_OK;
}

/* Gives all inputs the maps. */
static void give(const stratus_ray_cast_input* inputs, int count, bool given, const stratus_light_maps* maps)
{
  for (int n = 0; n < count; ++n) {
    if (inputs[n].tetra) {
      inputs[n].tetra->lights = maps;
    } else {
      inputs[n].caster->optics.lights = maps;
      inputs[n].caster->light_given = given && maps;
    }
  }
}

static stratus_status update_several(several* m, const stratus_ray_cast_input* inputs, const stratus_ray_cast_input* lit,
  const stratus_camera* camera, stratus_light_state* state, stratus_ray_cast_report* report)
{
  const stratus_shading* shading = lit->tetra ? &lit->tetra_options->shading : &lit->options->light.shading;
  stratus_light lights[STRATUS_LIGHTS_MAX];
  stratus_light_matter matter = {
    .draw = draw_several, .of = m, .tolerance = lit->tetra ? lit->tetra_options->tolerance : lit->options->sampling.tolerance
  };
  const double start = stratus_now_ms();
  uint64_t key;
  const int count = stratus_lights_in_world(camera, shading, lights);
  TRY(darken(m, inputs, &key));
  if (stratus_light_state_is_stale(state, key, lights, count)) {
    TRY(bounds_of(m, matter.bounds));
    TRY(stratus_light_state_build(m->context, &matter, lights, count, state));
    TRY(darken(m, inputs, &state->key)); /* the drawing may have chosen the sampling, and with it made tables */
  }
  report->light_ms = stratus_now_ms() - start;
  return STRATUS_OK;
}

stratus_status stratus_ray_light_update_several(const stratus_ray_cast_input* inputs, int count, bool given, const stratus_camera* camera,
  stratus_ray_draw_several* draw, stratus_ray_cast_report* report)
{
  const stratus_ray_cast_input* lit = NULL;
  several m = { .context = inputs->tetra ? inputs->tetra->context : inputs->caster->context, .count = count, .draw = draw };
  void *memory = NULL, *options = NULL, *tetra_options = NULL;
  stratus_status status;
  for (int n = 0; n < count && !lit; ++n) {
    lit = input_has_shadows(&inputs[n]) ? &inputs[n] : NULL;
  }
  give(inputs, count, given, NULL);
  if (!lit) {
    return STRATUS_OK;
  }
  TRY_CLEANUP(stratus_allocate(m.context, (size_t)count, sizeof *m.inputs, &memory));
  TRY_CLEANUP(stratus_allocate(m.context, (size_t)count, sizeof *m.options, &options));
  TRY_CLEANUP(stratus_allocate(m.context, (size_t)count, sizeof *m.tetra_options, &tetra_options));
  m.inputs = memory;
  m.options = options;
  m.tetra_options = tetra_options;
  stratus_light_state* state = inputs->tetra ? &inputs->tetra->light : &inputs->caster->light;
  TRY_CLEANUP(update_several(&m, inputs, lit, camera, state, report));
  give(inputs, count, given, state->maps);
cleanup:
  stratus_release(m.context, memory);
  stratus_release(m.context, options);
  stratus_release(m.context, tetra_options);
  return status;
}

void stratus_ray_light_return(const stratus_ray_cast_input* inputs, int count)
{
  give(inputs, count, false, NULL);
}
