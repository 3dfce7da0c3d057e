/* SPDX-License-Identifier: BSD-3-Clause
 * Renders a frame: updates tables and structures, draws on device or host, audits and reports. */
#include "ray_caster.h"

#include "device.h"
#include "first_hit_picture.h"
#include "picture.h"
#include "ray_cast_device.h"
#include "ray_cast_host.h"
#include "ray_fetched.h"
#include "ray_frame.h"
#include "ray_light.h"
#include "ray_modes_render.h"
#include "ray_probe.h"
#include "ray_probe_blocks.h"
#include "ray_shading_render.h"
#include "ray_shading_table.h"
#include "ray_trial.h"
#include "slices.h"

#include <stdio.h>
#include <string.h>

/* Draws the frame. before: tiles that need no drawing. */
static stratus_status draw(stratus_ray_caster* caster, const stratus_ray_cast_arguments* arguments, const stratus_image* image,
  bool with_map, const stratus_ray_drawn* before, stratus_ray_counts* counts, double* upload_ms)
{
  const stratus_ray_variant variant = stratus_ray_modes_variant(&caster->integrator, &caster->optics);
  const stratus_ray_cast_frame frame = stratus_ray_frame_of(caster, arguments, image, with_map);
  const int type = stratus_ray_fetch_type(&caster->field.traversed);
  const stratus_ray_drawn none = { .count = 0 };
  if (caster->context->device && !caster->on_host) {
    bool drawn = false; /* all tiles, those before included */
    const stratus_status status = stratus_ray_cast_device(caster, &frame, type, variant, counts, upload_ms, &drawn);
    if (status != STRATUS_OK) { /* if the host is to draw, the message goes to the log only */
      snprintf(caster->where, sizeof caster->where, "drawn on the host: %s", stratus_context_message(caster->context));
    }
    if (stratus_device_hands_back(caster->context, status)) {
      before = &none; /* the device may have drawn on any tile */
    } else if (status != STRATUS_OK || drawn) {
      return status;
    }
  }
  return stratus_ray_cast_rest(caster->context, &frame, type, variant, before, counts);
}

uint64_t stratus_ray_differing(const stratus_image* image, const float* rgba, const float* depth)
{
  const size_t pixels = (size_t)image->width * (size_t)image->height;
  uint64_t differing = 0;
  for (size_t i = 0; i < pixels; ++i) {
    differing += memcmp(image->rgba + 4 * i, rgba + 4 * i, 4 * sizeof(float)) != 0 ||
      (image->depth && memcmp(image->depth + i, depth + i, sizeof(float)) != 0);
  }
  return differing;
}

/* Draws the frame again without a structure and counts the pixels whose bits differ. */
static stratus_status audit(
  stratus_ray_caster* caster, const stratus_ray_cast_arguments* arguments, const stratus_image* image, uint64_t* differing)
{
  const size_t pixels = (size_t)image->width * (size_t)image->height;
  _Alignas(64) stratus_ray_cast_arguments plain = *arguments;
  stratus_ray_counts counts;
  stratus_image march = *image;
  void *rgba = NULL, *depth = NULL;
  double upload_ms = 0.0;
  stratus_status status;

  stratus_ray_frame_structures(&caster->field.grid, NULL, 0.0, NULL, NULL, &plain);
  plain.picture.want_samples = plain.picture.want_bytes = 0;
  march.samples = NULL;
  march.rgba8 = NULL;
  TRY_CLEANUP(stratus_allocate(caster->context, pixels, 4 * sizeof(float), &rgba));
  march.rgba = rgba;
  if (image->depth) {
    TRY_CLEANUP(stratus_allocate(caster->context, pixels, sizeof(float), &depth));
    march.depth = depth;
  }
  TRY_CLEANUP(draw(caster, &plain, &march, false, &(const stratus_ray_drawn){ .count = 0 }, &counts, &upload_ms));
  *differing = stratus_ray_differing(image, march.rgba, march.depth);
cleanup:
  stratus_release(caster->context, rgba);
  stratus_release(caster->context, depth);
  return status;
}

static void report_window(const int window[4], int reported[4])
{
  const bool any = window[0] < window[1] && window[2] < window[3];
  for (int side = 0; side < 4; ++side) {
    reported[side] = any ? window[side] : 0;
  }
}

void stratus_ray_fill_report(
  const stratus_ray_caster* caster, const stratus_ray_counts* counts, stratus_structure used, stratus_ray_cast_report* report)
{
  report->rays = counts->rays;
  report->samples = counts->samples;
  report->skipped = counts->skipped;
  report->lookups = counts->lookups;
  if (caster->structure.occupancy) {
    const int64_t* n = caster->structure.occupancy->blocks;
    report->blocks = (uint64_t)n[0] * (uint64_t)n[1] * (uint64_t)n[2];
    report->occupied_blocks = (uint64_t)caster->structure.occupancy->count;
  }
  report->range_builds = caster->field.range_builds;
  report->table_builds = caster->optics.table_builds;
  report->occupancy_builds = caster->structure.occupancy_builds;
  report->structure_builds = caster->structure.structure_builds;
  report->uploads = caster->uploads;
  report->structure_bytes = used != STRATUS_STRUCTURE_NONE && caster->structure.map ? stratus_distance_map_bytes(caster->structure.map) : 0;
  report->structure = used;
  report->sampling = caster->integrator.choice.sampling;
  report->sample_distance = caster->integrator.choice.sample_distance;
  report->follows_voxels = caster->integrator.choice.follows;
  report->cell_error = stratus_ray_visits_cells(caster->integrator.choice.sampling) ? caster->integrator.choice.cell_error : 0.0;
  report->light_spread = stratus_ray_lights_places(&caster->integrator, &caster->optics) ? caster->integrator.choice.light_spread : 0.0;
  report->expected_error = caster->integrator.choice.expected_error;
  report->tolerance_met = caster->integrator.choice.met;
  report->probe_builds = caster->probe_builds;
  report->light_builds = caster->light.builds;
  report->light_bytes = stratus_light_maps_bytes(caster->optics.lights);
  report->light_error = stratus_light_maps_error(caster->optics.lights);
}

/* Makes a picture, or all its layers, show nothing. */
static void clear(const stratus_ray_caster* caster, const stratus_image* image)
{
  stratus_image all = *image;
  all.height *= caster->layers > 0 ? caster->layers : 1;
  stratus_image_clear(&all);
}

/* Makes rays store layers of the camera's depth. */
static void set_layers(int layers, const stratus_camera* camera, stratus_ray_camera* rays)
{
  rays->layers = layers;
  if (layers > 0) {
    rays->layer_k = stratus_pair_of((camera->far_k - camera->near_k) / layers);
  }
}

static stratus_status render(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report)
{
  _Alignas(64) stratus_ray_cast_arguments arguments; /* aligned so that a device can borrow them */
  stratus_structure used = STRATUS_STRUCTURE_NONE;
  stratus_ray_counts counts = { 0 };
  char why[192] = "";
  stratus_ray_drawn drawn = { .count = 0 };
  bool empty = false;
  /* An image of samples must not depend on times, because samples depend on the structure. In tiles, samples that a structure skips need
   * not even be read: trying to do without it would read empty space. */
  const bool times = !image->samples && !volume->tiles.values;
  const bool tries =
    times && options->skipping.structure == STRATUS_STRUCTURE_AUTO && caster->integrator.keeps <= 1; /* later pictures have few rays */

  caster->where[0] = '\0';
  caster->together = false;
  TRY(stratus_ray_update_tables(caster, volume, transfer, options, (size_t)image->width * (size_t)image->height, report));
  TRY(stratus_ray_update_structures(caster, options->skipping.structure, times, &used, why, sizeof why, report));
  TRY(stratus_ray_light_update(caster, volume, transfer, camera, options, stratus_ray_render_one, report));
  if (caster->integrator.choice.provisional) {
    TRY(caster->blocks ? stratus_probe_blocks_choose(caster, volume, options, report)
                       : stratus_ray_probe(caster, volume, camera, options, report));
  }
  TRY(stratus_ray_frame_arguments(
    caster, camera, options, image, caster->integrator.choice.sample_distance, caster->integrator.choice.follows, &arguments, &empty));
  set_layers(caster->layers, camera, &arguments.camera);
  const bool covers = stratus_ray_modes_covers(options);
  bool with_map = used != STRATUS_STRUCTURE_NONE && !(covers && caster->structure.occupancy->count == 0);
  double start = stratus_now_ms(), drawn_ms = 0.0;
  if (empty || (!stratus_ray_shading_show(&caster->optics, &caster->field, &caster->integrator.values) && !covers)) {
    clear(caster, image);
    memset(report->window, 0, sizeof report->window);
  } else {
    const bool found = !with_map || caster->structure.occupancy->count > 0;
    arguments.values.has_hidden = caster->field.hides;
    stratus_ray_modes_arguments(&caster->integrator, &caster->optics, &caster->field, caster->structure.rough, options, &arguments);
    arguments.mode.kept = caster->integrator.keeps;
    stratus_ray_shading_arguments(
      &caster->optics, &caster->field, caster->integrator.choice.sample_distance, volume, camera, options, &arguments);
    if (options->mode == STRATUS_MODE_SLICE) {
      double to_world[16];
      stratus_volume_index_to_world(volume, to_world);
      stratus_slice_set(&options->slice, to_world, &arguments.slice);
    }
    stratus_ray_frame_structures(&caster->field.grid, caster->optics.made.table, stratus_ray_tolerance(options),
      caster->structure.occupancy, with_map ? caster->structure.map : NULL, &arguments);
    if (found && with_map && tries) {
      stratus_ray_choice_frame chosen = { .image = image, .tolerance = stratus_ray_tolerance(options), .arguments = &arguments };
      TRY(stratus_ray_try(caster, &chosen, why, sizeof why));
      used = chosen.used;
      with_map = used != STRATUS_STRUCTURE_NONE;
      drawn = chosen.drawn;
      report->offered_tree = chosen.offered;
      drawn_ms = chosen.drawn_ms;
      report->structure_ms += stratus_now_ms() - start - drawn_ms;
      start = stratus_now_ms();
    }
    if (found) {
      TRY(draw(caster, &arguments, image, with_map, &drawn, &counts, &report->upload_ms));
      report_window(arguments.camera.window, report->window);
    } else {
      clear(caster, image);
      memset(report->window, 0, sizeof report->window);
    }
    if (options->skipping.audit) {
      TRY(audit(caster, &arguments, image, &report->differing_pixels));
    }
  }
  report->cast_ms = stratus_now_ms() - start - report->upload_ms + drawn_ms;
  if (tries) {
    stratus_ray_tried(caster, report->cast_ms);
  }
  caster->field.samples_since_data += counts.samples;
  stratus_ray_fill_report(caster, &counts, used, report);
  const bool cells = caster->integrator.choice.sampling == STRATUS_SAMPLING_CELLS; /* which takes no step */
  snprintf(report->why, sizeof report->why, "%s; %s, %s %.4g%s%s%s%s%s", why, stratus_sampling_name(caster->integrator.choice.sampling),
    cells ? "cell error" : "sample distance", cells ? caster->integrator.choice.cell_error : caster->integrator.choice.sample_distance,
    !cells && caster->integrator.choice.follows ? " or longer, as rays pass voxels" : "", *caster->where ? "; " : "", caster->where,
    *caster->tried ? ": " : "", caster->tried);
  return STRATUS_OK;
}

stratus_status stratus_ray_render_one(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report)
{
  *report = (stratus_ray_cast_report){ .expected_error = NAN, .tolerance_met = 1, .window = { 0, image->width, 0, image->height } };
  return options->mode == STRATUS_MODE_FIRST_HIT ? stratus_first_hit_render(caster, volume, transfer, camera, options, image, report)
                                                 : render(caster, volume, transfer, camera, options, image, report);
}
