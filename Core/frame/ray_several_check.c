/* SPDX-License-Identifier: BSD-3-Clause
 * Refuses what one march through several volumes does not draw. */
#include "ray_several_picture.h"

stratus_context* stratus_several_context(const stratus_ray_cast_input* input)
{
  return input->caster ? input->caster->context : input->tetra ? input->tetra->context : NULL;
}

stratus_status stratus_several_check_inputs(const stratus_ray_cast_input* inputs, int count)
{
  stratus_context* context = stratus_several_context(inputs);
  if (count < 1 || count > STRATUS_SEVERAL_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%d volumes, must be 1..%d", count, STRATUS_SEVERAL_MAX);
  }
  for (int n = 0; n < count; ++n) {
    if (!inputs[n].caster && !inputs[n].tetra) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volume %d has no ray caster: caster is NULL, and so is tetra", n);
    }
    if (stratus_several_context(&inputs[n]) != context) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the ray caster of volume %d has another context than the one of volume 0", n);
    }
    if (inputs[n].caster && inputs[n].tetra) {
      return stratus_fail(
        context, STRATUS_INVALID_ARGUMENT, "input %d has a ray caster and one of tetrahedra, must be a volume or a mesh", n);
    }
    for (int other = 0; other < n; ++other) {
      if (inputs[n].caster == inputs[other].caster && inputs[n].tetra == inputs[other].tetra) {
        return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "volumes %d and %d have the same ray caster, each needs its own", other, n);
      }
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_several_check_missing(const stratus_ray_cast_input* inputs, int count)
{
  for (int n = 0; n < count; ++n) {
    TRY(inputs[n].volume ? stratus_volume_check_missing(stratus_several_context(&inputs[n]), inputs[n].volume) : STRATUS_OK);
  }
  return STRATUS_OK;
}

stratus_status stratus_several_check_volume(stratus_context* context, int n, const stratus_several_input* in)
{
  const stratus_ray_cast_options* options = &in->options;
  if (options->mode != STRATUS_MODE_COMPOSITE) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "volume %d of several has mode %s, which does not mix with composite", n,
      stratus_mode_name(options->mode));
  }
  return STRATUS_OK;
}

stratus_status stratus_several_check_mesh(stratus_context* context, int n, const stratus_several_input* in)
{
  const stratus_tetra_options* options = &in->tetra_options;
  if (options->mode != STRATUS_TETRA_COMPOSITE) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "mesh %d of several has mode %s, which does not mix with composite", n,
      stratus_tetra_mode_name(options->mode));
  }
  if (options->method == STRATUS_TETRA_METHOD_PROJECT) {
    return stratus_fail(
      context, STRATUS_UNSUPPORTED, "mesh %d of several is to be projected, which draws whole pictures: its rays can only be marched", n);
  }
  return STRATUS_OK;
}
