/* SPDX-License-Identifier: BSD-3-Clause
 * Draws several volumes and meshes in all modes but composite: one after the other, and joins what rays have kept. */
#include "camera.h"
#include "lights.h"
#include "picture.h"
#include "ray_kept.h"
#include "ray_light.h"
#include "ray_several_picture.h"
#include "ray_shading_table.h"
#include "tetra_cells.h"

#include <math.h>
#include <string.h>

/* The components that are drawn by themselves. */
static int components_of(const stratus_ray_cast_input* input, stratus_mode mode)
{
  const bool together = !stratus_kept_is(mode) || mode == STRATUS_MODE_QUANTITIES ||
    (input->tetra && input->tetra_options && stratus_tetra_draws_last(input->mesh, input->tetra_options));
  return !input->tetra ? stratus_ray_parts(input->volume, input->options) : together ? 1 : stratus_tetra_component_count(input->mesh);
}

static bool asks_for_shadows(const stratus_ray_cast_input* inputs, int count)
{
  bool asks = false;
  for (int n = 0; n < count; ++n) {
    const stratus_ray_cast_input* in = &inputs[n];
    const stratus_shading* shading = in->tetra ? in->tetra_options ? &in->tetra_options->shading : NULL
      : in->options                            ? &in->options->light.shading
                                               : NULL;
    asks = asks || (shading && stratus_lights_want_shadows(shading));
  }
  return asks;
}

static stratus_status check(stratus_context* context, const stratus_ray_cast_input* inputs, int count)
{
  const bool shadows = asks_for_shadows(inputs, count);
  for (int n = 0; n < count; ++n) {
    const stratus_ray_cast_input* in = &inputs[n];
    const stratus_mode mode = stratus_kept_mode(in), first = stratus_kept_mode(inputs);
    if (mode != first) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume %d of several has mode %s, volume 0 has %s: all need the same", n,
        stratus_mode_name(mode), stratus_mode_name(first));
    }
    if (in->tetra && !in->mesh) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume %d of several has no mesh", n);
    }
    if (in->tetra && shadows) { /* maps of light are made before meshes are drawn, and check them */
      TRY(stratus_tetra_shadow_check(context, in->mesh, in->transfer, in->tetra_options));
    } else if (!in->tetra) {
      const stratus_ray_cast_options defaults = stratus_ray_cast_options_default();
      TRY(stratus_ray_check_input(context, in->volume, in->transfer, in->options ? in->options : &defaults));
    }
  }
  return STRATUS_OK;
}

/* Returns the transparency below which nothing is seen behind layers, to the strictest of the inputs. */
static float least_of(const stratus_ray_cast_input* inputs, int count)
{
  const stratus_ray_cast_options defaults = stratus_ray_cast_options_default();
  const stratus_tetra_options mesh_defaults = stratus_tetra_options_default();
  float least = 1.0f;
  for (int n = 0; n < count; ++n) {
    const stratus_ray_cast_input* in = &inputs[n];
    const float mine = in->tetra ? (float)stratus_tetra_termination(in->tetra_options ? in->tetra_options : &mesh_defaults)
                                 : stratus_kept_least(in->options ? in->options : &defaults);
    least = fminf(least, mine);
  }
  return least;
}

/* Draws what rays keep of an input. */
static stratus_status draw_input(
  stratus_kept* kept, int n, int count, const stratus_camera* camera, const stratus_image* part, stratus_ray_cast_report* report)
{
  const stratus_ray_cast_input* in = &kept->inputs[n];
  if (in->tetra) {
    return stratus_kept_draw_mesh(kept, n, camera, part, report);
  }
  stratus_ray_cast_options options = in->options ? *in->options : stratus_ray_cast_options_default();
  options.sampling.tolerance /= stratus_mode_is_sum(kept->mode) ? sqrt((double)count) : 1.0; /* errors add, too, by their squares */
  return stratus_kept_draw(kept, n, camera, &options, part, report);
}

/* Draws a component of all inputs that have it. Of surfaces, the nearest ones first, then the next ones, as long as any may be seen. ends:
 * room for where rays end; numbers need none. */
static stratus_status draw(
  stratus_kept* kept, int count, const stratus_camera* camera, const stratus_image* part, float* ends, stratus_ray_cast_report* reports)
{
  const int all[4] = { 0, part->width, 0, part->height };
  bool more = true;
  for (kept->pass = 0; more; ++kept->pass) {
    more = false;
    for (int n = 0; n < count; ++n) {
      stratus_ray_cast_report report = { .expected_error = NAN, .tolerance_met = 1 };
      stratus_image to = *part;
      if (kept->component >= components_of(&kept->inputs[n], kept->mode)) {
        continue;
      }
      if (kept->pass > 0) {
        bool wanted = false;
        if (!stratus_kept_ends(kept, n, kept->image, camera, all, 0.0f, ends, &wanted)) {
          continue;
        }
        to.opaque_depth = wanted ? ends : NULL;
      }
      TRY(draw_input(kept, n, count, camera, &to, &report));
      TRY(stratus_kept_join(kept, n, &to, 0, 0, all));
      if (reports) {
        stratus_kept_report(kept, &reports[n], &report);
      }
      more = !kept->pixels;
    }
  }
  return STRATUS_OK;
}

static stratus_status draw_all(const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera, const stratus_image* image,
  stratus_ray_cast_report* reports)
{
  stratus_context* context = stratus_several_context(inputs);
  stratus_kept kept = {
    .context = context, .mode = stratus_kept_mode(inputs), .inputs = inputs, .image = image, .layers.least = least_of(inputs, count)
  };
  stratus_image part = { 0 };
  stratus_status status = STRATUS_OK;
  void* ends = NULL;
  int components = 1;
  for (int n = 0; n < count; ++n) {
    const int mine = components_of(&inputs[n], kept.mode);
    components = mine > components ? mine : components;
  }
  stratus_image_clear(image);
  TRY(stratus_kept_create(&kept));
  TRY_CLEANUP(stratus_kept_part_create(&kept, &part));
  if (!kept.pixels) {
    TRY_CLEANUP(stratus_allocate(context, (size_t)image->width * (size_t)image->height, sizeof(float), &ends));
  }
  for (int c = 0; c < components; ++c) {
    stratus_kept_begin(&kept, c);
    TRY_CLEANUP(draw(&kept, count, camera, &part, ends, reports));
    stratus_kept_finish(&kept);
  }
  stratus_image_fill_bytes(image);
  int window[4] = { 0, 0, 0, 0 };
  for (int n = 0; reports && n < count; ++n) {
    stratus_window_join(window, reports[n].window);
  }
  for (int n = 0; reports && n < count; ++n) {
    memcpy(reports[n].window, window, sizeof window);
  }
cleanup:
  stratus_release(context, ends);
  stratus_image_part_destroy(context, &part);
  stratus_kept_destroy(&kept);
  return status;
}

/* ---- surfaces of several components */

/* An independent component as a volume of its own. */
typedef struct component {
  stratus_volume volume;
  stratus_ray_cast_options options;
  stratus_transfer* transfer; /* a copy, whose opacities are multiplied by the component's weight */
  int of;                     /* the input */
} component;

static void take_material(const stratus_material* material, stratus_ray_light_options* light)
{
  stratus_shading* shading = &light->shading;
  light->shade = shading->on = material->shade;
  shading->ambient = material->ambient;
  shading->diffuse = material->diffuse;
  shading->specular = material->specular;
  shading->specular_power = material->specular_power;
  light->materials = NULL;
}

/* The component's caster reads the maps of light of the whole, until it is drawn. */
static void share_light(const stratus_ray_caster* whole, stratus_ray_caster* part)
{
  part->optics.lights = whole ? whole->optics.lights : NULL;
  part->light_given = whole && whole->light_given;
}

static stratus_status take_component(
  stratus_context* context, const stratus_ray_cast_input* in, int c, component* to, stratus_ray_cast_input* input)
{
  stratus_ray_caster* caster = NULL;
  TRY(stratus_ray_part(in->caster, c, &caster));
  TRY(stratus_transfer_copy(context, in->transfer + c, 1, &to->transfer));
  double* opacity = (double*)to->transfer->opacity;
  for (size_t i = 0; i < to->transfer->opacity_count; ++i) {
    opacity[2 * i + 1] *= in->transfer[c].weight;
  }
  share_light(in->caster, caster);
  to->volume = stratus_volume_component(in->volume, c);
  to->options = *in->options;
  if (to->options.light.materials) {
    take_material(to->options.light.materials + c, &to->options.light);
  }
  *input = (stratus_ray_cast_input){ .caster = caster, .volume = &to->volume, .transfer = to->transfer, .options = &to->options };
  return STRATUS_OK;
}

/* Draws `total` inputs: those given, but each independent component as an input of its own. */
static stratus_status draw_components(const stratus_ray_cast_input* inputs, int count, int total, const stratus_camera* camera,
  const stratus_image* image, stratus_ray_cast_report* reports)
{
  stratus_context* context = stratus_several_context(inputs);
  void *memory = NULL, *list = NULL, *results = NULL;
  component* parts = NULL;
  stratus_status status = STRATUS_OK;
  int n = 0;
  TRY_CLEANUP(stratus_allocate_zero(context, (size_t)total, sizeof(component), &memory));
  parts = memory;
  TRY_CLEANUP(stratus_allocate(context, (size_t)total, sizeof(stratus_ray_cast_input), &list));
  TRY_CLEANUP(stratus_allocate_zero(context, (size_t)total, sizeof(stratus_ray_cast_report), &results));
  stratus_ray_cast_input* const all = list;
  stratus_ray_cast_report* const mine = results;
  for (int i = 0; i < count; ++i) {
    const int components = components_of(&inputs[i], stratus_kept_mode(inputs));
    for (int c = 0; c < components; ++c) {
      parts[n].of = i;
      all[n] = inputs[i];
      if (components > 1) {
        TRY_CLEANUP(take_component(context, &inputs[i], c, &parts[n], &all[n]));
      }
      ++n;
    }
  }
  TRY_CLEANUP(draw_all(all, total, camera, image, mine));
  for (n = 0; reports && n < total; ++n) {
    if (n > 0 && parts[n].of == parts[n - 1].of) {
      stratus_ray_cast_report_add(&reports[parts[n].of], &mine[n]);
    } else {
      reports[parts[n].of] = mine[n];
    }
  }
cleanup:
  for (n = 0; parts && n < total; ++n) {
    if (parts[n].transfer) {
      share_light(NULL, ((stratus_ray_cast_input*)list)[n].caster);
    }
    stratus_release(context, parts[n].transfer);
  }
  stratus_release(context, memory);
  stratus_release(context, list);
  stratus_release(context, results);
  return status;
}

stratus_status stratus_several_kept(const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera,
  const stratus_image* image, stratus_ray_cast_report* reports)
{
  stratus_context* context = stratus_several_context(inputs);
  const stratus_mode mode = stratus_kept_mode(inputs);
  int total = 0;
  TRY(stratus_image_check(context, image));
  TRY(stratus_camera_check(context, camera, image));
  TRY(check(context, inputs, count));
  for (int n = 0; n < count; ++n) {
    total += components_of(&inputs[n], mode);
  }
  const bool given = inputs[0].caster && inputs[0].caster->light_given; /* by a picture of blocks, of which this is one */
  stratus_ray_cast_report light = { .light_ms = 0.0 };
  if (!given && mode != STRATUS_MODE_QUANTITIES) { /* quantities leave a picture's maps as they are */
    TRY(stratus_ray_light_update_several(inputs, count, true, camera, stratus_several_kept, &light));
  }
  const stratus_status status = stratus_kept_is(mode) || total == count ? draw_all(inputs, count, camera, image, reports)
                                                                        : draw_components(inputs, count, total, camera, image, reports);
  if (!given) {
    stratus_ray_light_return(inputs, count);
    stratus_ray_light_report(&light, reports, count);
  }
  TRY(status);
  return stratus_several_check_missing(inputs, count);
}
