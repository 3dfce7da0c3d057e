/* SPDX-License-Identifier: BSD-3-Clause
 * Draws one image, or, in modes that find one value for each ray, one image of each independent component, and adds the images. Surfaces
 * of components are joined by depth, as of several volumes. */
#include "picture.h"
#include "ray_caster.h"
#include "ray_several_picture.h"
#include "ray_shading_table.h"

/* The finest distance and the largest error count. */
static void add_component(stratus_ray_cast_report* sum, const stratus_ray_cast_report* part)
{
  stratus_ray_cast_report_add(sum, part);
  sum->sample_distance = fmin(sum->sample_distance, part->sample_distance);
  sum->expected_error = fmax(sum->expected_error, part->expected_error);
  sum->tolerance_met = sum->tolerance_met && part->tolerance_met;
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

stratus_status stratus_ray_caster_render(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report)
{
  const stratus_ray_cast_options defaults = stratus_ray_cast_options_default();
  stratus_ray_cast_report mine;
  if (!caster) {
    return STRATUS_INVALID_ARGUMENT;
  }
  options = options ? options : &defaults;
  TRY(stratus_ray_update_transfer_2d(caster, volume, options));
  transfer = options->optics.transfer_2d ? &caster->optics.transfer_2d.shown : transfer;
  TRY(stratus_ray_check_input(caster->context, volume, transfer, options));
  TRY(stratus_image_check(caster->context, image));
  const bool parts = stratus_ray_parts(volume, options) > 1;
  const bool joins = options->mode == STRATUS_MODE_QUANTITIES ||
    (parts && (options->mode == STRATUS_MODE_FIRST_HIT || options->mode == STRATUS_MODE_ISOSURFACE));
  TRY((joins ? draw_joined : parts ? draw_parts : stratus_ray_render_one)(caster, volume, transfer, camera, options, image, &mine));
  TRY(stratus_volume_check_missing(caster->context, volume));
  if (report) {
    *report = mine;
  }
  return STRATUS_OK;
}
