/* SPDX-License-Identifier: BSD-3-Clause
 * Options of the path tracer, and the checks of its inputs. */
#include "path.h"

#include "camera.h"
#include "lights.h"
#include "picture.h"

#define SAMPLES_MOST 1000000000
#define ANISOTROPY_MOST 0.99
#define BLOCK_SIZE_MOST 1000000

stratus_path_options stratus_path_options_default(void)
{
  return (stratus_path_options){
    .samples = 64, .albedo = 1.0, .light_count = -1, .up = { 0.0, 0.0, 1.0 }, .clipping.crop_regions = STRATUS_CROP_INSIDE
  };
}

static stratus_status check_numbers(stratus_context* context, const stratus_path_options* options)
{
  if (options->samples < 1 || options->samples > SAMPLES_MOST) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%d samples a pixel, must be 1..%d", options->samples, SAMPLES_MOST);
  }
  if (!(options->tolerance >= 0.0) || !isfinite(options->tolerance)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "tolerance %g, must be at least 0 and finite", options->tolerance);
  }
  if (options->bounces < 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%d bounces, must be at least 1, or 0 for no limit", options->bounces);
  }
  if (!(options->albedo >= 0.0 && options->albedo <= 1.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "albedo %g, must be 0..1", options->albedo);
  }
  if (!(fabs(options->anisotropy) <= ANISOTROPY_MOST)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "anisotropy %g, must be %g..%g", options->anisotropy, -ANISOTROPY_MOST, ANISOTROPY_MOST);
  }
  if ((unsigned)options->interpolation > STRATUS_INTERPOLATION_NEAREST) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "interpolation %d, must be 0..%d", (int)options->interpolation, STRATUS_INTERPOLATION_NEAREST);
  }
  if (options->block_size < 0 || options->block_size > BLOCK_SIZE_MOST) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "block_size %d, must be 1..%d, or 0 for the default", options->block_size, BLOCK_SIZE_MOST);
  }
  return STRATUS_OK;
}

static stratus_status check_light(stratus_context* context, const stratus_path_options* options)
{
  stratus_shading shading = stratus_shading_default();
  shading.light_count = options->light_count;
  for (int i = 0; i < options->light_count && i < STRATUS_LIGHTS_MAX; ++i) {
    shading.lights[i] = options->lights[i];
    shading.lights[i].separate_specular = 0;
  }
  TRY(stratus_shading_check(context, &shading));
  for (int i = 0; i < 3; ++i) {
    if (!(options->sky_zenith[i] >= 0.0 && options->sky_zenith[i] <= STRATUS_LIGHT_MAX) ||
      !(options->sky_horizon[i] >= 0.0 && options->sky_horizon[i] <= STRATUS_LIGHT_MAX)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "sky of colours %g (zenith) and %g (horizon) in channel %d, must be 0..%g",
        options->sky_zenith[i], options->sky_horizon[i], i, STRATUS_LIGHT_MAX);
    }
  }
  const double* up = options->up;
  if (!isfinite(up[0]) || !isfinite(up[1]) || !isfinite(up[2]) || (up[0] == 0.0 && up[1] == 0.0 && up[2] == 0.0)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "sky's up is (%g, %g, %g), must be finite and have a length", up[0], up[1], up[2]);
  }
  return STRATUS_OK;
}

static stratus_status check_clipping(stratus_context* context, const stratus_path_options* options)
{
  const stratus_ray_clipping_options* clipping = &options->clipping;
  for (int axis = 0; clipping->crop && axis < 3; ++axis) {
    const double lo = clipping->crop_bounds[2 * axis], hi = clipping->crop_bounds[2 * axis + 1];
    if (!(lo <= hi) || !isfinite(lo) || !isfinite(hi)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "crop bounds %g..%g along axis %d are reversed or not finite", lo, hi, axis);
    }
  }
  if (clipping->clip_plane_count < 0 || clipping->clip_plane_count > STRATUS_CLIP_PLANES_MAX) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "%d clip planes, must be 0..%d", clipping->clip_plane_count, STRATUS_CLIP_PLANES_MAX);
  }
  for (int i = 0; i < 4 * clipping->clip_plane_count; ++i) {
    const double coefficient = clipping->clip_planes[i / 4][i % 4];
    if (!isfinite(coefficient)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "clip plane %d has coefficient %g, must be finite", i / 4, coefficient);
    }
  }
  return STRATUS_OK;
}

static stratus_status check_volume(stratus_context* context, const stratus_volume* volume)
{
  int64_t lo[3], hi[3];
  TRY(stratus_volume_check(context, volume));
  if (volume->components > 1) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "paths through a volume of %d components, must be 1 component", volume->components);
  }
  if (!stratus_volume_owned(volume, lo, hi)) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "paths through a volume with DUPLICATE ghosts: light passes through other pieces; join them");
  }
  return STRATUS_OK;
}

stratus_status stratus_path_check(stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_path_options* options, const stratus_image* image)
{
  TRY(stratus_image_check(context, image));
  TRY(stratus_camera_check(context, camera, image));
  TRY(check_numbers(context, options));
  TRY(check_light(context, options));
  TRY(check_clipping(context, options));
  TRY(stratus_transfer_check(context, transfer));
  if (transfer->gradient_count > 0) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "paths with a gradient opacity of %zu points, must have none", transfer->gradient_count);
  }
  if (options->mask.bytes && options->mask.label_count > 0) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "paths through %d labels, must be 0: a mask hides", options->mask.label_count);
  }
  return check_volume(context, volume);
}
