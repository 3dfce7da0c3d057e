/* SPDX-License-Identifier: BSD-3-Clause
 * The ray caster's state. */
#ifndef STRATUS_RAY_CASTER_H
#define STRATUS_RAY_CASTER_H

#include "stratus/tree.h"
#include "stratus/ray_cast.h"
#include "ray_modes_render.h"
#include "ray_sampling.h"
#include "ray_shading_table.h"
#include "volume.h"

typedef struct stratus_ray_device stratus_ray_device;
typedef struct stratus_first_hit stratus_first_hit;

struct stratus_ray_caster {
  stratus_context* context;

  /* what was built, and from what */
  stratus_volume volume;
  stratus_volume traversed; /* what rays read: the volume itself, or its fetched values */
  float* fetched;           /* those, NULL as long as rays have not paid for them */
  uint64_t samples_since_data;
  stratus_value_range* ranges;
  uint8_t* hidden; /* in the form that traversal reads, or NULL */
  bool hidden_by_value;
  int hides;           /* HIDDEN_CELLS, HIDDEN_BY_MASK, HIDDEN_LABELS: what `hidden` holds */
  const uint8_t* mask; /* that it was made from, or NULL */
  uint64_t mask_revision;
  stratus_transfer* transfers; /* copies, transfer_count of them; NULL: none yet */
  int transfer_count;
  stratus_interpolation interpolation; /* with the next three: what the choice was made for */
  stratus_sampling wanted_sampling;
  double wanted_distance, voxel_length;
  stratus_ray_choice choice;
  stratus_table* table;
  double table_distance;   /* the sample distance that the table is for .. */
  stratus_ray_shown shown; /* .. and the values */
  bool shades, dependent;  /* of the render at hand: stratus_ray_shading_wanted() */
  stratus_ray_shading_tables shading_tables;
  stratus_occupancy* occupancy;
  stratus_distance_map* map;
  stratus_tree* offered; /* a tree that came with the data, in index coordinates; NULL: none */
  int tree_serves;       /* whether that tree shows what the transfer function does: 1, 0, or -1 where that is to be asked */
  uint64_t hash;         /* of the volume's values and shape, .. */
  uint64_t hash_ranges;  /* .. if this is range_builds */
  uint64_t lookups_since_edit;

  stratus_first_hit* first_hit; /* NULL until asked for: first_hit_picture.h */

  stratus_ray_device* device;                     /* copies on the OpenCL device, NULL on the host */
  uint64_t data_serial, table_serial, map_serial; /* raised with each build: tells the device what is stale */
  uint64_t range_builds, table_builds, occupancy_builds, structure_builds, uploads;
};

/* ray_caster_drop.c: each drops what was built from it, too. The last drops a map that is an offered tree's. */
void stratus_ray_drop_transfer(stratus_ray_caster* caster);
void stratus_ray_drop_occupancy(stratus_ray_caster* caster);
void stratus_ray_drop_map(stratus_ray_caster* caster);
void stratus_ray_drop_offer_map(stratus_ray_caster* caster);

/* ray_caster_update.c: builds anew what changed and nothing else. */
stratus_status stratus_ray_update_tables(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_ray_cast_options* options, stratus_ray_cast_report* report); /* value ranges, choices, table */
stratus_status stratus_ray_update_structures(stratus_ray_caster* caster, stratus_structure wanted, stratus_structure* used, char* why,
  size_t capacity, stratus_ray_cast_report* report);

#endif
