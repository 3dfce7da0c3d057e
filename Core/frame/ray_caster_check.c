/* SPDX-License-Identifier: BSD-3-Clause
 * Checks the input of a frame, except camera and image. */
#include "ray_caster.h"

#include "ray_modes_render.h"
#include "ray_shading_render.h"
#include "ray_shading_table.h"
#include "volume.h"

static stratus_status check_crop(stratus_context* context, const stratus_ray_cast_options* options)
{
  for (int axis = 0; options->clipping.crop && axis < 3; ++axis) {
    const double lo = options->clipping.crop_bounds[2 * axis], hi = options->clipping.crop_bounds[2 * axis + 1];
    if (!(lo <= hi) || !isfinite(lo) || !isfinite(hi)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "crop bounds %g..%g along axis %d are reversed or not finite", lo, hi, axis);
    }
  }
  if (options->clipping.clip_plane_count < 0 || options->clipping.clip_plane_count > STRATUS_CLIP_PLANES_MAX) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "%d clip planes, must be 0..%d", options->clipping.clip_plane_count, STRATUS_CLIP_PLANES_MAX);
  }
  for (int p = 0; p < options->clipping.clip_plane_count; ++p) {
    for (int i = 0; i < 4; ++i) {
      if (!isfinite(options->clipping.clip_planes[p][i])) {
        return stratus_fail(
          context, STRATUS_INVALID_ARGUMENT, "clip plane %d has coefficient %g, must be finite", p, options->clipping.clip_planes[p][i]);
      }
    }
  }
  return STRATUS_OK;
}

/* Gradients at clip planes are differences at a distance of one voxel, which only grids of equal spacing have, of one component. */
static stratus_status check_clip_gradients(stratus_context* context, const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  if (!options->clipping.clip_gradients || options->clipping.clip_plane_count == 0) {
    return STRATUS_OK;
  }
  if (!isfinite(options->clipping.clipped_value)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "clipped value %g, must be finite", options->clipping.clipped_value);
  }
  if (stratus_volume_is_stretched(volume) || volume->gradients || stratus_volume_components(volume) > 1) {
    return stratus_fail(context, STRATUS_UNSUPPORTED,
      "gradients that clip planes change, of %s: only grids of equal spacing, without gradients and of 1 component",
      stratus_volume_components(volume) > 1 ? "several components"
        : volume->gradients                 ? "a volume with gradients"
                                            : "a grid with coordinates");
  }
  return STRATUS_OK;
}

static stratus_status check_options(stratus_context* context, const stratus_ray_cast_options* options)
{
  if ((unsigned)options->mode > STRATUS_MODE_QUANTITIES || (unsigned)options->light.normals > STRATUS_NORMALS_GRADIENT) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mode %d (0..%d) or normals %d (0..%d) are out of range", (int)options->mode,
      STRATUS_MODE_QUANTITIES, (int)options->light.normals, STRATUS_NORMALS_GRADIENT);
  }
  if ((unsigned)options->skipping.structure > STRATUS_STRUCTURE_HYBRID || (unsigned)options->sampling.rule > STRATUS_SAMPLING_CELLS ||
    (unsigned)options->sampling.interpolation > STRATUS_INTERPOLATION_NEAREST) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "structure %d (0..%d), sampling %d (0..%d) or interpolation %d (0..%d) is out of range", (int)options->skipping.structure,
      STRATUS_STRUCTURE_HYBRID, (int)options->sampling.rule, STRATUS_SAMPLING_CELLS, (int)options->sampling.interpolation,
      STRATUS_INTERPOLATION_NEAREST);
  }
  if (!(options->sampling.distance >= 0.0) || !isfinite(options->sampling.distance)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "sample distance %g, must be positive, or 0 for automatic", options->sampling.distance);
  }
  if (!(options->sampling.cell_error >= 0.0) || !isfinite(options->sampling.cell_error)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "cell error %g, must be positive and finite, or 0 for automatic", options->sampling.cell_error);
  }
  if (!(options->sampling.light_spread >= 0.0) || !isfinite(options->sampling.light_spread)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "light spread %g, must be positive and finite, or 0 for automatic",
      options->sampling.light_spread);
  }
  if (!(options->sampling.termination >= 0.0 && options->sampling.termination <= 1.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "termination %g outside 0..1", options->sampling.termination);
  }
  if (!(options->sampling.tolerance >= 0.0) || !isfinite(options->sampling.tolerance)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "tolerance %g, must be at least 0 and finite", options->sampling.tolerance);
  }
  if (!(options->optics.gradient_distance >= 0.0) || !isfinite(options->optics.gradient_distance)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "gradient distance %g, must be positive and finite, or 0 for optical depths",
      options->optics.gradient_distance);
  }
  if (!(options->optics.gradient_length >= 0.0) || !isfinite(options->optics.gradient_length)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "gradient length %g, must be positive and finite, or 0 for the mean spacing",
      options->optics.gradient_length);
  }
  const int size = options->skipping.block_size;
  if (size != 0 && size != 2 && size != 4 && size != 8 && size != 16 && size != 32) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "block size %d, must be 2, 4, 8, 16, 32, or 0 for the default", size);
  }
  TRY(stratus_ray_modes_check(context, options));
  TRY(stratus_ray_shading_check(context, options));
  return check_crop(context, options);
}

stratus_status stratus_ray_check_input(
  stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options)
{
  TRY(stratus_volume_check(context, volume));
  TRY(stratus_transfer_check(context, transfer));
  TRY(stratus_ray_shading_check_volume(context, volume, transfer, options));
  TRY(check_options(context, options));
  TRY(check_clip_gradients(context, volume, options));
  return stratus_ray_shading_check_materials(context, volume, options);
}
