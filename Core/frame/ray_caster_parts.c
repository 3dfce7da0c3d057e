/* SPDX-License-Identifier: BSD-3-Clause
 * Casters of the parts of a caster: in modes that find one value for each ray, each independent component has its own, which keeps its
 * structures. */
#include "picture.h"
#include "ray_caster.h"
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
  sum->light_ms += part->light_ms;
  sum->light_builds += part->light_builds;
  sum->light_bytes = sum->light_bytes > part->light_bytes ? sum->light_bytes : part->light_bytes; /* parts share their maps */
  sum->light_error = fmax(sum->light_error, part->light_error);
  sum->structure_bytes += part->structure_bytes;
  sum->probe_builds += part->probe_builds;
  sum->probe_samples += part->probe_samples;
  stratus_window_join(sum->window, part->window);
}

stratus_status stratus_ray_part(stratus_ray_caster* caster, int component, stratus_ray_caster** part)
{
  if (!caster->parts[component]) {
    TRY(stratus_ray_caster_create(caster->context, &caster->parts[component]));
  }
  *part = caster->parts[component];
  (*part)->on_host = caster->on_host;
  return STRATUS_OK;
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
    TRY(stratus_ray_part(caster, STRATUS_RAY_QUANTITIES_PART, &one));
  }
  one->integrator.keeps = keeps;
  const stratus_status status = stratus_ray_render_one(one, &view, transfer + component, camera, options, image, report);
  one->integrator.keeps = 0;
  *drawn = one;
  return status;
}
