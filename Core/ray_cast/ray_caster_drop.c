/* SPDX-License-Identifier: BSD-3-Clause
 * What becomes stale together is dropped together: data -> transfer function -> occupancy -> map. */
#include "ray_caster.h"

void stratus_ray_drop_map(stratus_ray_caster* caster)
{
  stratus_distance_map_destroy(caster->map);
  caster->map = NULL;
  ++caster->map_serial; /* a device may still borrow it */
}

void stratus_ray_drop_offer_map(stratus_ray_caster* caster)
{
  caster->tree_serves = -1;
  if (caster->map && caster->map->tree_nodes > 0) {
    stratus_ray_drop_map(caster);
  }
}

void stratus_ray_drop_occupancy(stratus_ray_caster* caster)
{
  stratus_ray_drop_map(caster);
  caster->tree_serves = -1;
  stratus_occupancy_destroy(caster->occupancy);
  caster->occupancy = NULL;
}

void stratus_ray_drop_transfer(stratus_ray_caster* caster)
{
  stratus_ray_drop_occupancy(caster);
  stratus_table_destroy(caster->table);
  stratus_release(caster->context, caster->transfers);
  caster->table = NULL;
  caster->transfers = NULL;
}
