/* SPDX-License-Identifier: BSD-3-Clause
 * Decides which sampling rules can draw a scene, and which settings the user leaves open. */
#include "ray_sampling.h"

#include "ray_caster.h"
#include "ray_mode.h"

/* The spread of light by default, over the tolerance, where no probe measures it. It is what the probe finds for noisy and for smooth
 * scenes of record. */
#define LIGHT_SHARE 0.25

/* Whether gradient opacity multiplies opacities, which vary within a segment. */
static bool thins_opacity(const stratus_ray_caster* caster, const stratus_ray_cast_options* options)
{
  return options->optics.gradient_distance > 0.0 && caster->optics.transfers[0].gradient_count > 0;
}

/* Whether rays by cells can be lit: they take light at places of their own, after they have composited (lit_places.h). Light must be
 * smooth along a ray, which it is not where clip planes change gradients. Among several volumes each piece has a place of its own, which
 * costs more than samples do: that is done only by hand. */
static bool can_light_places(const stratus_ray_caster* caster, const stratus_ray_cast_options* options)
{
  return options->light.shade && caster->optics.transfers[0].gradient_count == 0 &&
    (!caster->together || options->sampling.rule == STRATUS_SAMPLING_CELLS) && !stratus_ray_clips_gradients(options) &&
    options->sampling.interpolation != STRATUS_INTERPOLATION_NEAREST;
}

/* Rule cells uses only a value's colour and opacity, and light. The rules that pre-integrate treat the field as linear between two values
 * of one medium. A segment of rule local may be four voxels long and belongs to the piece of its middle, so that in a piece of a larger
 * volume it would read beyond one layer of ghosts. */
bool stratus_ray_can_sample(const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_sampling sampling)
{
  const bool one_medium = options->mode == STRATUS_MODE_COMPOSITE && !caster->optics.transfer_2d.on &&
    !stratus_ray_shading_several(&caster->optics, &caster->field);
  const bool by_cells = one_medium && !options->mask.bytes && (!caster->optics.shades || can_light_places(caster, options));
  switch (sampling) {
    case STRATUS_SAMPLING_CELLS:
      return by_cells;
    case STRATUS_SAMPLING_LOCAL:
      return by_cells && options->sampling.interpolation != STRATUS_INTERPOLATION_NEAREST && caster->field.owns_all;
    case STRATUS_SAMPLING_PREINTEGRATED:
      return one_medium && options->sampling.interpolation != STRATUS_INTERPOLATION_NEAREST && !thins_opacity(caster, options);
    default:
      return true;
  }
}

double stratus_ray_tolerance(const stratus_ray_cast_options* options)
{
  const bool cells = options->sampling.rule == STRATUS_SAMPLING_CELLS;
  const bool by_hand =
    options->sampling.rule != STRATUS_SAMPLING_AUTO && (cells ? options->sampling.cell_error : options->sampling.distance) > 0.0;
  return by_hand ? stratus_ray_cast_options_default().sampling.tolerance : options->sampling.tolerance;
}

void stratus_ray_choose(const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_ray_choice* choice)
{
  const bool surfaces =
    options->mode == STRATUS_MODE_ISOSURFACE || options->mode == STRATUS_MODE_SLICE || options->mode == STRATUS_MODE_QUANTITIES;
  const bool by_hand = options->sampling.rule != STRATUS_SAMPLING_AUTO && stratus_ray_can_sample(caster, options, options->sampling.rule);
  *choice = (stratus_ray_choice){ .sampling = by_hand ? options->sampling.rule : STRATUS_SAMPLING_MIDPOINT,
    .cell_error = options->sampling.cell_error,
    .light_spread = options->sampling.light_spread > 0.0 ? options->sampling.light_spread : LIGHT_SHARE * stratus_ray_tolerance(options),
    .expected_error = NAN,
    .met = true };
  const bool cells =
    choice->sampling == STRATUS_SAMPLING_CELLS; /* such rays, rays to surfaces, and rays of quantities pass from cell to cell */
  const bool open_rule = options->sampling.rule == STRATUS_SAMPLING_AUTO && options->mode == STRATUS_MODE_COMPOSITE;
  const bool open_step = cells ? !(options->sampling.cell_error > 0.0) : !(options->sampling.distance > 0.0);
  const bool of_voxels = cells || surfaces || open_step;
  choice->sample_distance = of_voxels ? caster->inputs.voxel : options->sampling.distance;
  choice->follows = of_voxels && stratus_ray_follows_voxels(&caster->field.traversed);
  choice->provisional = !surfaces && (open_rule || open_step);
}
