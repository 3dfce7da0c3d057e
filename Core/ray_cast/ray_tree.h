/* SPDX-License-Identifier: BSD-3-Clause
 * Structure HYBRID: a tree, offered or made, as the march asks it. */
#ifndef STRATUS_RAY_TREE_H
#define STRATUS_RAY_TREE_H

#include "ray_caster.h"

/* Whether a tree was offered that shows all that the transfer function does, of this very volume. */
stratus_status stratus_ray_tree_serves(stratus_ray_caster* caster, bool* serves);
/* The same of first hits: whether its voxels are those that the criterion shows. Asked once, which takes *ms more. */
stratus_status stratus_ray_tree_serves_first_hits(
  stratus_ray_caster* caster, const stratus_volume* in_index, const stratus_criterion* criterion, bool* serves, double* ms);
/* That tree, or a new one, as the march asks it; caster->occupancy is there. */
stratus_status stratus_ray_tree_map(stratus_ray_caster* caster, bool offered, stratus_distance_map** map);

#endif
