/* SPDX-License-Identifier: BSD-3-Clause
 * Where nothing shows in a field: the caster's part of the state that has occupied blocks, maps and an offered tree. */
#ifndef STRATUS_RAY_STRUCTURE_H
#define STRATUS_RAY_STRUCTURE_H

#include "stratus/tree.h"
#include "volume.h"

typedef struct stratus_ray_structure {
  stratus_occupancy* occupancy;
  stratus_distance_map* map;
  stratus_distance_map* rough;                         /* which blocks rule local takes cell by cell; NULL: none, for it was not taken */
  stratus_tree* offered;                               /* a tree that came with the data, in index coordinates; NULL: none */
  int tree_serves;                                     /* 1: the offered tree serves this render; 0: it does not; -1: not known yet */
  uint64_t occupancy_serial, map_serial, rough_serial; /* incremented by each build, so that the device knows which buffers are stale */
  uint64_t occupancy_builds, structure_builds;
} stratus_ray_structure;

/* Makes an offered tree be checked again if it is of cells, or of voxels. */
void stratus_ray_forget_offer(stratus_ray_structure* structure, bool of_cells);
void stratus_ray_drop_map(stratus_ray_structure* structure);
void stratus_ray_drop_rough(stratus_ray_structure* structure);
/* Drops the occupied blocks, and the map that was made of them. */
void stratus_ray_drop_blocks(stratus_ray_structure* structure);

#endif
