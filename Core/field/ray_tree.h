/* SPDX-License-Identifier: BSD-3-Clause
 * Structure HYBRID: an offered or built tree as a map for the march. */
#ifndef STRATUS_RAY_TREE_H
#define STRATUS_RAY_TREE_H

#include "ray_field.h"
#include "ray_structure.h"
#include "tree.h"

/* Whether a tree of cells was offered that may serve: it passed its check, or was not checked yet. */
bool stratus_ray_tree_is_offered(const stratus_ray_structure* structure);
/* Whether the offered tree covers all cells of this very field that the criterion shows. */
stratus_status stratus_ray_tree_serves(
  stratus_ray_structure* structure, stratus_ray_field* field, const stratus_criterion* criterion, bool* serves);
/* Whether the offered tree holds exactly the voxels that the criterion shows. The first call after a change reads the volume; its time is
 * added to *ms. */
stratus_status stratus_ray_tree_serves_first_hits(stratus_context* context, stratus_ray_structure* structure,
  const stratus_volume* in_index, const stratus_criterion* criterion, bool* serves, double* ms);
/* Returns the number of blocks in the map of the offered tree, which stratus_ray_tree_is_offered(). */
size_t stratus_ray_tree_blocks(const stratus_ray_structure* structure);
/* Makes the map of the offered tree, or of a new tree of the occupied blocks. */
stratus_status stratus_ray_tree_map(
  stratus_context* context, const stratus_ray_structure* structure, bool offered, stratus_distance_map** map);

#endif
