/* SPDX-License-Identifier: BSD-3-Clause
 * Shadows of volumes and meshes. Each caster has one of its own that draws the same matter without light, layer by layer as the lights see
 * it. Volumes are drawn on the host, so that host and device have the same maps. */
#include "ray_light.h"

#include "lights.h"
#include "matrix.h"
#include "ray_sampling.h"
#include "ray_shading_table.h"
#include "ray_shading_render.h"
#include "tetra_caster.h"

#include <string.h>

/* Steps through near matter to a voxel: the field along them counts as straight from end to end. */
#define NEAR_STEPS_A_VOXEL 2.0
/* Cells in which light is scattered again: as many along a voxel follow how light changes in it. */
#define CELLS_A_VOXEL 2.0

/* Materials of the components' own, or NULL. */
static const stratus_material* materials_of(const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  return stratus_volume_components(volume) > 1 && !options->optics.dependent ? options->light.materials : NULL;
}

static bool has_shadows(const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  const bool lit = options->mode == STRATUS_MODE_COMPOSITE || options->mode == STRATUS_MODE_ISOSURFACE;
  return lit &&
    stratus_lights_cast_shadows(
      &options->light.shading, options->light.shade != 0, materials_of(volume, options), stratus_volume_components(volume));
}

static bool input_has_shadows(const stratus_ray_cast_input* in)
{
  return in->tetra ? in->tetra_options && stratus_tetra_has_shadows(in->mesh, in->tetra_options)
                   : in->options && has_shadows(in->volume, in->options);
}

const stratus_ray_cast_input* stratus_ray_light_of(const stratus_ray_cast_input* inputs, int count)
{
  for (int n = 0; n < count; ++n) {
    if (input_has_shadows(&inputs[n])) {
      return &inputs[n];
    }
  }
  return NULL;
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

/* Makes options of matter without light show its albedo: as its ambient light. materials: receives the materials of its components, if they
 * have their own. */
static void show_albedo(
  const stratus_ray_cast_options* options, int components, stratus_material materials[4], stratus_ray_cast_options* dark)
{
  dark->light = options->light;
  dark->light.shade = 1;
  dark->light.materials =
    stratus_lights_show_albedo(&options->light.shading, options->light.materials, components, &dark->light.shading, materials);
}

static double reflectance_of(const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  return stratus_lights_reflectance(&options->light.shading, materials_of(volume, options), stratus_volume_components(volume));
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

static void drop_volume(stratus_ray_caster* caster)
{
  stratus_light_state_drop(&caster->light);
  caster->optics.lights = NULL;
  stratus_ray_caster_destroy(caster->parts[STRATUS_RAY_LIGHT_PART]);
  caster->parts[STRATUS_RAY_LIGHT_PART] = NULL;
}

/* ---- keys */

static uint64_t key_of_function(uint64_t key, const stratus_transfer_2d* f)
{
  const uint64_t counts[3] = { (uint64_t)f->columns, (uint64_t)f->rows, f->revision };
  const double numbers[5] = { f->value_range[0], f->value_range[1], f->second_range[0], f->second_range[1], f->unit_distance };
  key = stratus_light_key(key, &f->rgba, sizeof f->rgba);
  key = stratus_light_key(key, counts, sizeof counts);
  return stratus_light_key(key, numbers, sizeof numbers);
}

static uint64_t key_of_data(uint64_t key, const stratus_volume* v)
{
  const void* data[4] = { v->values, v->point_ghosts, v->cell_ghosts, v->gradients };
  const uint64_t counts[4] = { (uint64_t)v->type, (uint64_t)v->cell_centered, (uint64_t)stratus_volume_components(v), v->revision };
  double to_world[16];
  stratus_volume_index_to_world(v, to_world);
  key = stratus_light_key(key, data, sizeof data);
  key = stratus_light_key(key, counts, sizeof counts);
  key = stratus_light_key(key, v->dimensions, sizeof v->dimensions);
  key = stratus_light_key(key, &v->value_stride, sizeof v->value_stride);
  key = stratus_light_key(key, to_world, sizeof to_world);
  for (int axis = 0; axis < 3; ++axis) {
    const size_t positions = (size_t)v->dimensions[axis] + (v->cell_centered ? 1 : 0);
    key = stratus_light_key(key, v->coordinates[axis], v->coordinates[axis] ? positions * sizeof(double) : 0);
    key = stratus_light_key(key, &axis, sizeof axis); /* so that equal positions along another axis give another key */
  }
  return key;
}

/* Adds all that decides where a volume's matter is and how it scatters to a key. The key depends on no caster, so that pictures of several
 * inputs have one. Bytes under the same address are the same unless their revision has changed. */
static uint64_t key_of_volume(
  uint64_t key, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options)
{
  const stratus_ray_optics_options* optics = &options->optics;
  const stratus_ray_clipping_options* clip = &options->clipping;
  const bool surfaces = options->mode == STRATUS_MODE_ISOSURFACE;
  const uint64_t mask[2] = { options->mask.revision, (uint64_t)options->mask.label_count };
  const double numbers[] = { options->mode, options->sampling.interpolation, options->sampling.tolerance, optics->dependent,
    optics->mean_components, optics->gradient_distance, optics->gradient_length, clip->clip_gradients, clip->clipped_value,
    clip->clip_plane_count, clip->crop ? clip->crop_regions : 0.0, surfaces ? optics->contour_count : 0.0,
    reflectance_of(volume, options) };
  key = key_of_data(key, volume);
  key = stratus_light_key(key, &options->mask.bytes, sizeof options->mask.bytes);
  key = stratus_light_key(key, mask, sizeof mask);
  key = stratus_light_key(key, numbers, sizeof numbers);
  key = stratus_light_key(key, clip->clip_planes, (size_t)clip->clip_plane_count * sizeof clip->clip_planes[0]);
  key = stratus_light_key(key, clip->crop_bounds, clip->crop ? sizeof clip->crop_bounds : 0);
  key = stratus_light_key(key, optics->contours, surfaces ? (size_t)optics->contour_count * sizeof optics->contours[0] : 0);
  if (optics->transfer_2d) {
    return key_of_function(key, optics->transfer_2d);
  }
  const int functions = stratus_ray_shading_media(volume, options);
  key = stratus_light_key_of_albedo(key, transfer, functions, options->light.materials, stratus_volume_components(volume));
  return stratus_light_key_of_transfers(key, transfer, functions);
}

/* ---- one volume */

typedef struct one_volume {
  stratus_ray_draw_one* draw;
  stratus_ray_caster* caster;
  const stratus_volume* volume;
  const stratus_transfer* transfer;
  const stratus_ray_cast_options* lit;
  stratus_ray_cast_options options;
} one_volume;

static stratus_status draw_volume(void* of, const stratus_camera* camera, int layers, const stratus_image* image, bool colors)
{
  const one_volume* m = of;
  stratus_ray_cast_report report;
  stratus_ray_cast_options options = m->options;
  stratus_material materials[4];
  if (colors) {
    show_albedo(m->lit, stratus_volume_components(m->volume), materials, &options);
  }
  m->caster->layers = layers;
  const stratus_status status = m->draw(m->caster, m->volume, m->transfer, camera, &options, image, &report);
  m->caster->layers = 0;
  return status;
}

stratus_status stratus_ray_light_update(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, stratus_ray_draw_one* draw, stratus_ray_cast_report* report)
{
  stratus_light lights[STRATUS_LIGHTS_MAX];
  if (caster->light_given) {
    return STRATUS_OK;
  }
  if (!has_shadows(volume, options)) {
    drop_volume(caster);
    return STRATUS_OK;
  }
  const double start = stratus_now_ms();
  one_volume m = { .draw = draw, .volume = volume, .transfer = transfer, .lit = options, .options = dark_options(options) };
  stratus_light_matter matter = { .draw = draw_volume, .of = &m, .tolerance = options->sampling.tolerance };
  matter.together = true;
  matter.reflectance = reflectance_of(volume, options);
  matter.detail = stratus_ray_voxel_length(volume) / CELLS_A_VOXEL;
  const bool regions = options->clipping.crop && options->clipping.crop_regions != STRATUS_CROP_INSIDE;
  if (stratus_volume_components(volume) == 1 && options->mode == STRATUS_MODE_COMPOSITE && options->mask.label_count == 0 &&
    !options->optics.transfer_2d && transfer->gradient_count == 0 && !regions) { /* near rays know no gradient opacity */
    matter.step = stratus_ray_voxel_length(volume) / NEAR_STEPS_A_VOXEL;
  }
  const int count = stratus_lights_in_world(camera, &options->light.shading, lights);
  const uint64_t key = key_of_volume(stratus_light_key_of_scattering(0, &options->light.shading, lights, count), volume, transfer, options);
  if (!stratus_light_state_serves(&caster->light, key, lights, count)) {
    TRY(dark_caster(caster, &m.caster));
    TRY(stratus_ray_update_transfer_2d(m.caster, volume, options));
    TRY(stratus_volume_bounds(caster->context, volume, matter.bounds));
    TRY(stratus_light_state_build(caster->context, &matter, &options->light.shading, lights, count, &caster->light));
    caster->light.key = key;
  }
  TRY(stratus_light_maps_hide(caster->light.maps, options->light.shading.surfaces));
  caster->optics.lights = caster->light.maps;
  report->light_ms = stratus_now_ms() - start;
  return STRATUS_OK;
}

/* ---- several */

typedef struct several {
  stratus_context* context;
  const stratus_ray_cast_input* given;
  stratus_ray_cast_input* inputs; /* of the matter */
  stratus_ray_cast_options* options;
  stratus_tetra_options* tetra_options;
  stratus_material (*materials)[4];
  int count;
  bool colors; /* whether the options of the matter show its albedo */
  stratus_ray_draw_several* draw;
} several;

/* Sets the options of the matter: without light, or such that they show its albedo. */
static void set_options(several* m, bool colors)
{
  const stratus_ray_cast_options defaults = stratus_ray_cast_options_default();
  const stratus_tetra_options tetra_defaults = stratus_tetra_options_default();
  for (int n = 0; n < m->count; ++n) {
    const stratus_ray_cast_input* in = &m->given[n];
    if (in->tetra) {
      const stratus_tetra_options* options = in->tetra_options ? in->tetra_options : &tetra_defaults;
      m->tetra_options[n] = stratus_tetra_dark_options(options);
      if (colors) {
        stratus_tetra_show_albedo(options, in->mesh->components, m->materials[n], &m->tetra_options[n]);
      }
    } else {
      const stratus_ray_cast_options* options = in->options ? in->options : &defaults;
      m->options[n] = dark_options(options);
      if (colors) {
        show_albedo(options, stratus_volume_components(in->volume), m->materials[n], &m->options[n]);
      }
    }
  }
  m->colors = colors;
}

static stratus_status draw_several(void* of, const stratus_camera* camera, int layers, const stratus_image* image, bool colors)
{
  several* m = of;
  if (colors != m->colors) {
    set_options(m, colors);
  }
  for (int layer = 0; layer < layers; ++layer) {
    const stratus_camera part = stratus_light_layer_camera(camera, layer, layers);
    const stratus_image picture = stratus_light_layer_image(image, layer);
    TRY(m->draw(m->inputs, m->count, &part, &picture, NULL));
  }
  return STRATUS_OK;
}

static uint64_t key_of_inputs(uint64_t key, const stratus_ray_cast_input* inputs, int count)
{
  const stratus_ray_cast_options defaults = stratus_ray_cast_options_default();
  const stratus_tetra_options tetra_defaults = stratus_tetra_options_default();
  for (int n = 0; n < count; ++n) {
    const stratus_ray_cast_input* in = &inputs[n];
    key = in->tetra ? stratus_tetra_shadow_key(key, in->mesh, in->transfer, in->tetra_options ? in->tetra_options : &tetra_defaults)
                    : key_of_volume(key, in->volume, in->transfer, in->options ? in->options : &defaults);
  }
  return key;
}

/* Makes the inputs of the matter. */
static stratus_status darken(several* m, const stratus_ray_cast_input* inputs)
{
  set_options(m, false);
  for (int n = 0; n < m->count; ++n) {
    stratus_ray_cast_input* dark = &m->inputs[n];
    *dark = inputs[n];
    if (inputs[n].tetra) {
      dark->tetra_options = &m->tetra_options[n];
      TRY(stratus_tetra_light_caster(inputs[n].tetra, &dark->tetra));
    } else {
      dark->options = &m->options[n];
      TRY(dark_caster(inputs[n].caster, &dark->caster));
    }
  }
  return STRATUS_OK;
}

static stratus_status bounds_of(const several* m, double bounds[6])
{
  for (int side = 0; side < 6; ++side) {
    bounds[side] = side & 1 ? -INFINITY : INFINITY;
  }
  for (int n = 0; n < m->count; ++n) {
    const stratus_ray_cast_input* in = &m->inputs[n];
    double own[6], lo[3], hi[3];
    if (in->tetra && !stratus_tetra_box(in->mesh, lo, hi)) {
      continue;
    }
    if (in->tetra) {
      stratus_matrix_box(in->mesh->matrix, lo, hi, own);
    } else {
      TRY(stratus_volume_bounds(m->context, in->volume, own));
    }
    for (int side = 0; side < 6; ++side) {
      bounds[side] = side & 1 ? fmax(bounds[side], own[side]) : fmin(bounds[side], own[side]);
    }
  }
  for (int axis = 0; axis < 3; ++axis) { /* without any point there is no matter */
    bounds[2 * axis] = isfinite(bounds[2 * axis]) ? bounds[2 * axis] : 0.0;
    bounds[2 * axis + 1] = isfinite(bounds[2 * axis + 1]) ? bounds[2 * axis + 1] : 0.0;
  }
  return STRATUS_OK;
}

/* The finest cells that the volumes need; of meshes that is not known. */
static double detail_of(const several* m)
{
  double detail = INFINITY;
  for (int n = 0; n < m->count; ++n) {
    detail = fmin(detail, m->inputs[n].tetra ? 0.0 : stratus_ray_voxel_length(m->inputs[n].volume) / CELLS_A_VOXEL);
  }
  return detail;
}

static double reflectance_of_inputs(const stratus_ray_cast_input* inputs, int count)
{
  double most = 0.0;
  for (int n = 0; n < count; ++n) {
    const stratus_ray_cast_input* in = &inputs[n];
    if (input_has_shadows(in)) {
      most = fmax(most, in->tetra ? stratus_tetra_reflectance(in->mesh, in->tetra_options) : reflectance_of(in->volume, in->options));
    }
  }
  return most;
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

/* Drops maps that no picture of these inputs reads. lit: the first input keeps the maps of all, and all keep what draws their matter. */
static void drop_several(const stratus_ray_cast_input* inputs, int count, bool lit)
{
  for (int n = 0; n < count; ++n) {
    if (lit && n > 0) {
      stratus_light_state_drop(inputs[n].tetra ? &inputs[n].tetra->light : &inputs[n].caster->light);
    } else if (!lit && inputs[n].tetra) {
      stratus_tetra_shadow_drop(inputs[n].tetra);
    } else if (!lit) {
      drop_volume(inputs[n].caster);
    }
  }
}

static stratus_status update_several(several* m, const stratus_ray_cast_input* inputs, const stratus_ray_cast_input* lit,
  const stratus_camera* camera, stratus_light_state* state)
{
  const stratus_shading* shading = lit->tetra ? &lit->tetra_options->shading : &lit->options->light.shading;
  stratus_light lights[STRATUS_LIGHTS_MAX];
  stratus_light_matter matter = {
    .draw = draw_several, .of = m, .tolerance = lit->tetra ? lit->tetra_options->tolerance : lit->options->sampling.tolerance
  };
  const int count = stratus_lights_in_world(camera, shading, lights);
  const uint64_t key = key_of_inputs(stratus_light_key_of_scattering(0, shading, lights, count), inputs, m->count);
  if (!stratus_light_state_serves(state, key, lights, count)) {
    TRY(darken(m, inputs));
    TRY(bounds_of(m, matter.bounds));
    matter.detail = detail_of(m);
    matter.reflectance = reflectance_of_inputs(inputs, m->count);
    TRY(stratus_light_state_build(m->context, &matter, shading, lights, count, state));
    state->key = key;
  }
  TRY(stratus_light_maps_hide(state->maps, shading->surfaces));
  return STRATUS_OK;
}

stratus_status stratus_ray_light_update_several(const stratus_ray_cast_input* inputs, int count, bool given, const stratus_camera* camera,
  stratus_ray_draw_several* draw, stratus_ray_cast_report* report)
{
  const double start = stratus_now_ms();
  const stratus_ray_cast_input* lit = stratus_ray_light_of(inputs, count);
  several m = {
    .context = inputs->tetra ? inputs->tetra->context : inputs->caster->context, .given = inputs, .count = count, .draw = draw
  };
  void *memory = NULL, *options = NULL, *tetra_options = NULL, *materials = NULL;
  stratus_status status;
  give(inputs, count, given, NULL);
  drop_several(inputs, count, lit != NULL);
  if (!lit) {
    return STRATUS_OK;
  }
  TRY_CLEANUP(stratus_allocate(m.context, (size_t)count, sizeof *m.inputs, &memory));
  TRY_CLEANUP(stratus_allocate(m.context, (size_t)count, sizeof *m.options, &options));
  TRY_CLEANUP(stratus_allocate(m.context, (size_t)count, sizeof *m.tetra_options, &tetra_options));
  TRY_CLEANUP(stratus_allocate(m.context, (size_t)count, sizeof *m.materials, &materials));
  m.inputs = memory;
  m.materials = materials;
  m.options = options;
  m.tetra_options = tetra_options;
  stratus_light_state* state = inputs->tetra ? &inputs->tetra->light : &inputs->caster->light;
  TRY_CLEANUP(update_several(&m, inputs, lit, camera, state));
  give(inputs, count, given, state->maps);
  report->light_ms = stratus_now_ms() - start;
  report->light_builds = state->builds;
  report->light_bytes = stratus_light_maps_bytes(state->maps);
  report->light_error = stratus_light_maps_error(state->maps);
cleanup:
  stratus_release(m.context, memory);
  stratus_release(m.context, options);
  stratus_release(m.context, tetra_options);
  stratus_release(m.context, materials);
  return status;
}

void stratus_ray_light_report(const stratus_ray_cast_report* light, stratus_ray_cast_report* reports, int count)
{
  for (int n = 0; reports && n < count; ++n) {
    reports[n].light_ms = n == 0 ? light->light_ms : 0.0;
    reports[n].light_builds = n == 0 ? light->light_builds : 0;
    reports[n].light_bytes = light->light_bytes;
    reports[n].light_error = light->light_error;
  }
}

void stratus_ray_light_return(const stratus_ray_cast_input* inputs, int count)
{
  give(inputs, count, false, NULL);
}
