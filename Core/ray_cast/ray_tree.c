/* SPDX-License-Identifier: BSD-3-Clause
 * Structure HYBRID: uses the tree that came with the data if it serves, else one that the caster builds. */
#include "ray_tree.h"

#include "ray_caster.h"
#include "ray_shading_table.h"
#include "tree.h"
#include "tree_map_build.h"
#include "volume_hash.h"

#include <string.h>

static const double identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };

stratus_status stratus_ray_caster_offer_tree(stratus_ray_caster* caster, const void* bytes, size_t size)
{
  stratus_tree* tree = NULL;
  if (!caster) {
    return STRATUS_INVALID_ARGUMENT;
  }
  stratus_tree_destroy(caster->offered);
  caster->offered = NULL;
  stratus_ray_drop_offer_map(caster);
  if (bytes) {
    TRY(stratus_tree_load(caster->context, bytes, size, &tree));
    /* rays are in index coordinates, so the volume's geometry at the time of the build does not matter */
    memcpy(tree->index_to_world, identity, sizeof identity);
    memcpy(tree->world_to_index, identity, sizeof identity);
    caster->offered = tree;
    caster->tree_serves = -1;
  }
  return STRATUS_OK;
}

/* Returns the offered tree if it is of cells, for the march, or of voxels, for first hits. It cannot be both, so caster->tree_serves holds
 * the answer for either. */
static const stratus_tree* offered_tree(const stratus_ray_caster* caster, bool of_cells)
{
  const stratus_tree* tree = caster->offered;
  return tree && tree->origin.hash && !tree->statistics.uncorrected && (tree->origin.cells != 0) == of_cells ? tree : NULL;
}

stratus_status stratus_ray_tree_serves_first_hits(
  stratus_ray_caster* caster, const stratus_volume* in_index, const stratus_criterion* criterion, bool* serves, double* ms)
{
  const stratus_tree* tree = offered_tree(caster, false);
  *serves = false;
  if (!tree) {
    return STRATUS_OK;
  }
  if (caster->tree_serves < 0) {
    const double start = stratus_now_ms();
    int covers = 0;
    TRY(stratus_tree_covers(caster->context, tree, in_index, criterion, 0, &covers));
    caster->tree_serves = covers;
    *ms += stratus_now_ms() - start;
  }
  *serves = caster->tree_serves == 1;
  return STRATUS_OK;
}

bool stratus_ray_tree_is_offered(const stratus_ray_caster* caster)
{
  /* only here does just one table's opacity decide which cells matter */
  return caster->tree_serves != 0 && offered_tree(caster, true) && caster->shown.mode == STRATUS_MODE_COMPOSITE &&
    !stratus_ray_shading_several(caster);
}

stratus_status stratus_ray_tree_serves(stratus_ray_caster* caster, bool* serves)
{
  const stratus_tree* tree = offered_tree(caster, true);
  *serves = false;
  if (!stratus_ray_tree_is_offered(caster)) {
    return STRATUS_OK;
  }
  if (caster->tree_serves < 0) {
    stratus_origin wanted = { .cells = 1 };
    stratus_criterion criterion = stratus_criterion_default();
    criterion.transfer = caster->transfers;
    if (caster->hash_ranges != caster->range_builds) {
      TRY(stratus_volume_hash(caster->context, &caster->volume, &caster->hash));
      caster->hash_ranges = caster->range_builds;
    }
    TRY(stratus_origin_take_cells(caster->context, caster->ranges, &criterion, &wanted));
    wanted.hash = caster->hash;
    /* hidden_by_value centres cells on values, but the tree was built of cells between values. */
    caster->tree_serves =
      stratus_tree_fits(tree, &caster->volume) && stratus_origin_covers(&tree->origin, &wanted) && !caster->hidden_by_value;
  }
  *serves = caster->tree_serves == 1;
  return STRATUS_OK;
}

size_t stratus_ray_tree_blocks(const stratus_ray_caster* caster)
{
  return stratus_tree_map_blocks(offered_tree(caster, true));
}

stratus_status stratus_ray_tree_map(stratus_ray_caster* caster, bool offered, stratus_distance_map** map)
{
  if (offered) {
    return stratus_tree_map_create(caster->context, offered_tree(caster, true), STRATUS_BRICK, map);
  }
  stratus_tree* tree = NULL;
  TRY(stratus_tree_of_occupancy(caster->context, caster->occupancy, &tree));
  const stratus_status status = stratus_tree_map_create(caster->context, tree, caster->occupancy->block_size, map);
  stratus_tree_destroy(tree);
  return status;
}
