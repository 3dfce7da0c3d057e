/* SPDX-License-Identifier: BSD-3-Clause
 * The components of a volume's values. */
#include "ray_components.h"

int stratus_volume_components(const stratus_volume* volume)
{
  return volume->components > 1 ? volume->components : 1;
}

stratus_volume stratus_volume_component(const stratus_volume* volume, int component)
{
  stratus_volume view = *volume;
  view.values = (const char*)volume->values + (size_t)component * stratus_type_size(volume->type);
  if (volume->tiles.values) {
    view.tiles.values = (const char*)volume->tiles.values + (size_t)component * stratus_type_size(volume->type);
  }
  view.components = 1;
  view.identity = volume->identity ? volume->identity + (uint64_t)component : 0;
  view.gradients = volume->gradients ? volume->gradients + 3 * (size_t)component * stratus_volume_count(volume) : NULL;
  return view;
}

int stratus_ray_followed(const stratus_volume* volume, const stratus_ray_cast_options* options)
{
  const bool mixes = options->mode == STRATUS_MODE_COMPOSITE || options->mode == STRATUS_MODE_SLICE;
  return options->optics.dependent && !mixes ? stratus_volume_components(volume) - 1 : 0;
}
