/* SPDX-License-Identifier: BSD-3-Clause
 * Ray modes' names and kinds, and the length that their tables are for. */
#include "ray_mode.h"

const char* stratus_mode_name(stratus_mode mode)
{
  static const char* const names[] = { "composite", "first-hit", "maximum", "minimum", "average", "additive", "isosurface", "slice",
    "quantities" };
  return (unsigned)mode < sizeof names / sizeof *names ? names[mode] : "unknown";
}

bool stratus_mode_is_extreme(stratus_mode mode)
{
  return mode == STRATUS_MODE_MAXIMUM || mode == STRATUS_MODE_MINIMUM;
}

bool stratus_mode_is_sum(stratus_mode mode)
{
  return mode == STRATUS_MODE_AVERAGE || mode == STRATUS_MODE_ADDITIVE;
}

double stratus_ray_modes_table_distance(stratus_mode mode, const stratus_transfer* transfer, double sample_distance)
{
  return mode == STRATUS_MODE_COMPOSITE ? sample_distance : transfer->unit_distance;
}
