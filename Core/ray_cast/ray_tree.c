/* SPDX-License-Identifier: BSD-3-Clause
 * Structure HYBRID: the tree that came with the data, where it serves, or one of the caster's own. */
#include "first_hit_picture.h"
#include "tree_map_build.h"
#include "voxels_build.h"
#include "volume_hash.h"

static const stratus_tree* offered_tree(const stratus_ray_caster* caster)
{
  const stratus_tree* tree = caster->first_hit ? caster->first_hit->offered : NULL;
  return tree && tree->origin.cells && tree->origin.hash ? tree : NULL;
}

stratus_status stratus_ray_tree_serves(stratus_ray_caster* caster, bool* serves)
{
  const stratus_tree* tree = offered_tree(caster);
  *serves = false;
  if (!tree || caster->shown.mode != STRATUS_MODE_COMPOSITE || stratus_ray_shading_several(caster)) {
    /* what other modes need is not what the opacity shows */
    return STRATUS_OK;
  }
  if (caster->tree_serves < 0) {
    stratus_origin wanted = { .cells = 1 };
    stratus_criterion criterion = stratus_criterion_default();
    criterion.transfer = &caster->transfer;
    if (caster->hash_ranges != caster->range_builds) {
      TRY(stratus_volume_hash(caster->context, &caster->volume, &caster->hash));
      caster->hash_ranges = caster->range_builds;
    }
    TRY(stratus_origin_take_cells(caster->context, caster->ranges, &criterion, &wanted));
    wanted.hash = caster->hash;
    /* Cells of values taken as they are lie apart from those between values: who built the tree knew of the latter only. */
    caster->tree_serves =
      stratus_tree_fits(tree, &caster->volume) && stratus_origin_covers(&tree->origin, &wanted) && !caster->hidden_by_value;
  }
  *serves = caster->tree_serves == 1;
  return STRATUS_OK;
}

stratus_status stratus_ray_tree_map(stratus_ray_caster* caster, bool offered, stratus_distance_map** map)
{
  if (offered) {
    return stratus_tree_map_create(caster->context, offered_tree(caster), STRATUS_BRICK, map);
  }
  stratus_tree* tree = NULL;
  TRY(stratus_tree_of_occupancy(caster->context, caster->occupancy, &tree));
  const stratus_status status = stratus_tree_map_create(caster->context, tree, caster->occupancy->block_size, map);
  stratus_tree_destroy(tree);
  return status;
}
