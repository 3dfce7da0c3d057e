/* SPDX-License-Identifier: BSD-3-Clause
 * Draws one image, or, in modes that find one value for each ray, one image of each independent component. Such a component has its own
 * caster, which keeps its structures, and the images are added. Surfaces of components are joined by depth, as of several volumes. */
#include "picture.h"
#include "ray_caster.h"
#include "ray_several_picture.h"
#include "ray_shading_table.h"

static bool draws_parts(const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  const bool one =
    options->mode == STRATUS_MODE_COMPOSITE || options->mode == STRATUS_MODE_SLICE || options->mode == STRATUS_MODE_QUANTITIES;
  return !one && stratus_volume_components(volume) > 1 && !options->optics.dependent;
}

int stratus_ray_parts(const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  return options && draws_parts(volume, options) ? stratus_volume_components(volume) : 1;
}

void stratus_ray_cast_report_add(stratus_ray_cast_report* sum, const stratus_ray_cast_report* part)
{
  if (!sum || !part) {
    return;
  }
  sum->rays += part->rays;
  sum->samples += part->samples;
  sum->skipped += part->skipped;
  sum->lookups += part->lookups;
  sum->differing_pixels += part->differing_pixels;
  sum->blocks += part->blocks;
  sum->occupied_blocks += part->occupied_blocks;
  sum->range_builds += part->range_builds;
  sum->table_builds += part->table_builds;
  sum->occupancy_builds += part->occupancy_builds;
  sum->structure_builds += part->structure_builds;
  sum->uploads += part->uploads;
  sum->range_ms += part->range_ms;
  sum->table_ms += part->table_ms;
  sum->occupancy_ms += part->occupancy_ms;
  sum->structure_ms += part->structure_ms;
  sum->upload_ms += part->upload_ms;
  sum->cast_ms += part->cast_ms;
  sum->probe_ms += part->probe_ms;
  sum->structure_bytes += part->structure_bytes;
  sum->probe_builds += part->probe_builds;
  sum->probe_samples += part->probe_samples;
  stratus_window_join(sum->window, part->window);
}

/* The finest distance and the largest error count. */
static void add_component(stratus_ray_cast_report* sum, const stratus_ray_cast_report* part)
{
  stratus_ray_cast_report_add(sum, part);
  sum->sample_distance = fmin(sum->sample_distance, part->sample_distance);
  sum->expected_error = fmax(sum->expected_error, part->expected_error);
  sum->tolerance_met = sum->tolerance_met && part->tolerance_met;
}

stratus_status stratus_ray_part(stratus_ray_caster* caster, int component, stratus_ray_caster** part)
{
  if (!caster->parts[component]) {
    TRY(stratus_ray_caster_create(caster->context, &caster->parts[component]));
  }
  *part = caster->parts[component];
  return STRATUS_OK;
}

/* In the report, counts and times are sums; the choices are the first component's. */
static stratus_status draw_parts(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report)
{
  const bool opaque = stratus_mode_is_sum(options->mode);
  stratus_image part;
  stratus_status status = STRATUS_OK;
  TRY(stratus_image_part_create(caster->context, image, &part));
  stratus_image_clear(image);
  for (int c = 0; c < stratus_volume_components(volume); ++c) {
    const stratus_volume view = stratus_volume_component(volume, c);
    stratus_ray_caster* one = NULL;
    stratus_ray_cast_report mine;
    TRY_CLEANUP(stratus_ray_part(caster, c, &one));
    TRY_CLEANUP(stratus_ray_render_one(one, &view, transfer + c, camera, options, &part, &mine));
    stratus_image_add(image, &part, (float)transfer[c].weight, opaque);
    if (c == 0) {
      *report = mine;
    } else {
      add_component(report, &mine);
    }
  }
  stratus_image_fill_bytes(image);
cleanup:
  stratus_image_part_destroy(caster->context, &part);
  return status;
}

/* Draws the volume as one of several: its components' surfaces by depth, or numbers of rays. */
static stratus_status draw_joined(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report)
{
  const stratus_ray_cast_input input = { .caster = caster, .volume = volume, .transfer = transfer, .options = options };
  return stratus_several_kept(&input, 1, camera, image, report);
}

stratus_status stratus_ray_render_kept(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  int component, int keeps, const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image,
  const stratus_ray_caster** drawn, stratus_ray_cast_report* report)
{
  stratus_ray_caster* one = caster;
  stratus_volume view = *volume;
  if (draws_parts(volume, options)) {
    view = stratus_volume_component(volume, component);
    TRY(stratus_ray_part(caster, component, &one));
  }
  if (options->mode == STRATUS_MODE_QUANTITIES) { /* structures of pictures stay as they are */
    TRY(stratus_ray_part(caster, STRATUS_RAY_PARTS - 1, &one));
  }
  one->keeps = keeps;
  const stratus_status status = stratus_ray_render_one(one, &view, transfer + component, camera, options, image, report);
  one->keeps = 0;
  *drawn = one;
  return status;
}

stratus_status stratus_ray_caster_render(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report)
{
  const stratus_ray_cast_options defaults = stratus_ray_cast_options_default();
  stratus_ray_cast_report mine;
  if (!caster) {
    return STRATUS_INVALID_ARGUMENT;
  }
  options = options ? options : &defaults;
  if (options->optics.transfer_2d) {
    TRY(stratus_volume_check(caster->context, volume));
    TRY(stratus_ray_transfer_2d_check(caster, volume, options));
  }
  TRY(stratus_ray_transfer_2d_update(caster, options));
  transfer = options->optics.transfer_2d ? &caster->transfer_2d.shown : transfer;
  TRY(stratus_ray_check_input(caster->context, volume, transfer, options));
  TRY(stratus_image_check(caster->context, image));
  const bool joins = options->mode == STRATUS_MODE_QUANTITIES ||
    (draws_parts(volume, options) && (options->mode == STRATUS_MODE_FIRST_HIT || options->mode == STRATUS_MODE_ISOSURFACE));
  TRY((joins                         ? draw_joined
      : draws_parts(volume, options) ? draw_parts
                                     : stratus_ray_render_one)(caster, volume, transfer, camera, options, image, &mine));
  if (report) {
    *report = mine;
  }
  return STRATUS_OK;
}
