/* SPDX-License-Identifier: BSD-3-Clause
 * One probe for all blocks of a volume. */
#ifndef STRATUS_RAY_PROBE_BLOCKS_H
#define STRATUS_RAY_PROBE_BLOCKS_H

#include "ray_caster.h"

/* The blocks of one picture, of whose casters each refers to this while the picture is drawn. */
struct stratus_probe_blocks {
  const stratus_ray_cast_input* inputs;
  int count;
  const stratus_camera* camera; /* of the whole picture */
  const stratus_image* image;
};

/* Returns the tolerance of each of `count` blocks. Errors of as many blocks as a ray may meet add up by their squares. */
double stratus_block_tolerance(double tolerance, int count);

/* Makes all casters of the blocks share, or, if `shared` is NULL, no longer share. */
void stratus_probe_blocks_share(const stratus_probe_blocks* blocks, const stratus_probe_blocks* shared);

/* Makes the choice of a caster whose choice is provisional, as stratus_ray_probe() does, but from the probe of one block for all: of the
 * blocks that have at least half of an even share of the picture's changes, the one whose transfer functions change most in a cell. The
 * step of the others is as many of their own voxels. So the probe is as strict as the roughest block that matters needs. A block that
 * cannot be drawn by that choice has a probe of its own. Deterministic. */
stratus_status stratus_probe_blocks_choose(
  stratus_ray_caster* caster, const stratus_volume* volume, const stratus_ray_cast_options* options, stratus_ray_cast_report* report);

#endif
