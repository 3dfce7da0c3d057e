/* SPDX-License-Identifier: BSD-3-Clause
 * Structure HYBRID: uses the tree that came with the data if it serves, else one that the caster builds. */
#include "ray_tree.h"

#include "tree.h"
#include "tree_map_build.h"
#include "volume_hash.h"

/* Returns the offered tree if it is of cells, for the march, or of voxels, for first hits. It cannot be both, so structure->tree_serves
 * holds the answer for either. */
static const stratus_tree* offered_tree(const stratus_ray_structure* structure, bool of_cells)
{
  const stratus_tree* tree = structure->offered;
  return tree && tree->origin.hash && !tree->statistics.uncorrected && (tree->origin.cells != 0) == of_cells ? tree : NULL;
}

stratus_status stratus_ray_tree_serves_first_hits(stratus_context* context, stratus_ray_structure* structure,
  const stratus_volume* in_index, const stratus_criterion* criterion, bool* serves, double* ms)
{
  const stratus_tree* tree = offered_tree(structure, false);
  *serves = false;
  if (!tree) {
    return STRATUS_OK;
  }
  if (structure->tree_serves < 0) {
    const double start = stratus_now_ms();
    int covers = 0;
    TRY(stratus_tree_covers(context, tree, in_index, criterion, 0, &covers));
    structure->tree_serves = covers;
    *ms += stratus_now_ms() - start;
  }
  *serves = structure->tree_serves == 1;
  return STRATUS_OK;
}

bool stratus_ray_tree_is_offered(const stratus_ray_structure* structure)
{
  return structure->tree_serves != 0 && offered_tree(structure, true);
}

stratus_status stratus_ray_tree_serves(
  stratus_ray_structure* structure, stratus_ray_field* field, const stratus_criterion* criterion, bool* serves)
{
  const stratus_tree* tree = offered_tree(structure, true);
  stratus_context* context = field->context;
  *serves = false;
  if (!stratus_ray_tree_is_offered(structure)) {
    return STRATUS_OK;
  }
  if (structure->tree_serves < 0) {
    stratus_origin wanted = { .cells = 1 };
    if (field->hash_ranges != field->range_builds) {
      TRY(stratus_volume_hash(context, &field->volume, &field->hash));
      field->hash_ranges = field->range_builds;
    }
    TRY(stratus_origin_take_cells(context, field->ranges, criterion, &wanted));
    wanted.hash = field->hash;
    /* hidden_by_value centres cells on values, but the tree was built of cells between values. */
    structure->tree_serves =
      stratus_tree_fits(tree, &field->volume) && stratus_origin_covers(&tree->origin, &wanted) && !field->hidden_by_value;
  }
  *serves = structure->tree_serves == 1;
  return STRATUS_OK;
}

size_t stratus_ray_tree_blocks(const stratus_ray_structure* structure)
{
  return stratus_tree_map_blocks(offered_tree(structure, true));
}

stratus_status stratus_ray_tree_map(
  stratus_context* context, const stratus_ray_structure* structure, bool offered, stratus_distance_map** map)
{
  if (offered) {
    return stratus_tree_map_create(context, offered_tree(structure, true), STRATUS_BRICK, map);
  }
  stratus_tree* tree = NULL;
  TRY(stratus_tree_of_occupancy(context, structure->occupancy, &tree));
  const stratus_status status = stratus_tree_map_create(context, tree, structure->occupancy->block_size, map);
  stratus_tree_destroy(tree);
  return status;
}
