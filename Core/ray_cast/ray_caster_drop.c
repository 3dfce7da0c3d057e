/* SPDX-License-Identifier: BSD-3-Clause
 * Drops stale structures with everything derived from them: data -> transfer function -> values that show, table -> occupancy -> map. */
#include "ray_caster.h"
#include "tree.h"

void stratus_ray_drop_map(stratus_ray_caster* caster)
{
  stratus_distance_map_destroy(caster->map);
  caster->map = NULL;
  ++caster->map_serial; /* so that the device returns the map that it may have borrowed */
}

void stratus_ray_drop_rough(stratus_ray_caster* caster)
{
  stratus_distance_map_destroy(caster->rough);
  caster->rough = NULL;
  ++caster->rough_serial;
}

void stratus_ray_forget_offer(stratus_ray_caster* caster, bool of_cells)
{
  if (caster->offered && (caster->offered->origin.cells != 0) == of_cells) {
    caster->tree_serves = -1;
  }
}

void stratus_ray_drop_offer_map(stratus_ray_caster* caster)
{
  stratus_ray_forget_offer(caster, true);
  caster->trial.tried[STRATUS_STRUCTURE_HYBRID] = false;
  if (caster->map && caster->map->tree_nodes > 0) {
    stratus_ray_drop_map(caster);
    caster->trial = (stratus_ray_trial){ .map = STRATUS_STRUCTURE_AUTO };
  }
}

void stratus_ray_drop_occupancy(stratus_ray_caster* caster)
{
  stratus_ray_drop_map(caster);
  stratus_ray_forget_offer(caster, true);
  caster->trial = (stratus_ray_trial){ .map = STRATUS_STRUCTURE_AUTO };
  stratus_occupancy_destroy(caster->occupancy);
  caster->occupancy = NULL;
  ++caster->occupancy_serial;
}

void stratus_ray_drop_values(stratus_ray_caster* caster)
{
  stratus_ray_drop_occupancy(caster);
  stratus_ray_drop_rough(caster);
  stratus_release(caster->context, caster->values.of);
  stratus_table_destroy(caster->made.table);
  stratus_table_destroy(caster->spare_table.table);
  caster->values = (stratus_shown){ .of = NULL };
  caster->made.table = NULL;
  caster->spare_table.table = NULL;
}

void stratus_ray_drop_transfer(stratus_ray_caster* caster)
{
  stratus_ray_drop_values(caster);
  stratus_release(caster->context, caster->transfers);
  caster->transfers = NULL;
}
