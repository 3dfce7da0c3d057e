/* SPDX-License-Identifier: BSD-3-Clause
 * Drops structures that are stale. */
#include "ray_structure.h"

#include "tree.h"

void stratus_ray_forget_offer(stratus_ray_structure* structure, bool of_cells)
{
  if (structure->offered && (structure->offered->origin.cells != 0) == of_cells) {
    structure->tree_serves = -1;
  }
}

void stratus_ray_drop_map(stratus_ray_structure* structure)
{
  stratus_distance_map_destroy(structure->map);
  structure->map = NULL;
  ++structure->map_serial; /* so that the device returns the map that it may have borrowed */
}

void stratus_ray_drop_rough(stratus_ray_structure* structure)
{
  stratus_distance_map_destroy(structure->rough);
  structure->rough = NULL;
  ++structure->rough_serial;
}

void stratus_ray_drop_blocks(stratus_ray_structure* structure)
{
  stratus_ray_drop_map(structure);
  stratus_ray_forget_offer(structure, true);
  stratus_occupancy_destroy(structure->occupancy);
  structure->occupancy = NULL;
  ++structure->occupancy_serial;
}
