/* SPDX-License-Identifier: BSD-3-Clause
 * The components of a volume's values. */
#ifndef STRATUS_RAY_COMPONENTS_H
#define STRATUS_RAY_COMPONENTS_H

#include "stratus/ray_cast.h"
#include "volume.h"

int stratus_volume_components(const stratus_volume* volume);
/* The planes of one number for each value that rays read: of each component the values and, if the volume has gradients, the three
 * derivatives behind them. */
static inline int stratus_volume_planes(const stratus_volume* volume)
{
  return stratus_volume_components(volume) * (volume->gradients ? 4 : 1);
}
stratus_volume stratus_volume_component(const stratus_volume* volume, int component); /* a component as a volume of its own */
/* The component that rays follow, see stratus_ray_field. */
int stratus_ray_followed(const stratus_volume* volume, const stratus_ray_cast_options* options);

#endif
