/* SPDX-License-Identifier: BSD-3-Clause
 * The ray caster's state, and the steps of a render that have files of their own. */
#ifndef STRATUS_RAY_CASTER_H
#define STRATUS_RAY_CASTER_H

#include "volume.h"
#include "ray_cast_host.h"

typedef struct stratus_ray_device stratus_ray_device;
typedef struct stratus_first_hit stratus_first_hit;

/* What the scene asks for, decided from counts alone, so that the same input always gets the same answer. */
typedef struct stratus_ray_choice {
  stratus_sampling sampling;
  stratus_structure structure;
  double sample_distance;
  double bend;      /* how far the opacity is from linear over a sample, relative to the opacity */
  double sharpness; /* mean change of opacity over a voxel, where something shows */
} stratus_ray_choice;

/* What of the options decides which values matter, beside the transfer function. */
typedef struct stratus_ray_shown {
  stratus_mode mode;
  double average_range[2];
  int contour_count;
  double contours[STRATUS_CONTOURS_MAX];
} stratus_ray_shown;

/* Steps of a gradient opacity function, between which it is taken as linear. */
#define STRATUS_SHADING_FACTORS 4096

/* What samples that are more than one value's colour and opacity are looked up in: ray_shading_table.c. */
typedef struct stratus_ray_shading_tables {
  int components;                 /* of the volume */
  stratus_value_range* ranges[4]; /* of components 1 .. */
  stratus_table* tables[4];       /* of several components: where each has one */
  void* memory;                   /* all tables, and gradient opacity, as rays read them */
  size_t bytes;
  int first[4], factor_first[4]; /* in floats; factor_first -1: none */
  float factor_scale[4];         /* entries per magnitude */
  stratus_table** label_tables;  /* of label 0 and on, NULL: no labels */
  int label_tables_count, label_first;
  uint64_t range_builds, table_builds; /* the caster's, that they belong to */
} stratus_ray_shading_tables;

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

/* ray_fetched.c: decides caster->traversed, and makes what it needs. */
stratus_status stratus_ray_fetched_update(stratus_ray_caster* caster);
void stratus_ray_fetched_drop(stratus_ray_caster* caster);
int stratus_ray_fetch_type(const stratus_volume* volume); /* STRATUS_TYPE that traversal is compiled for, -1 the generic one */

/* first_hit_picture.c, first_hit_scene.c: the mode of first hits; dropping what it built; the whole of it */
stratus_status stratus_first_hit_render(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report);
void stratus_first_hit_release(stratus_ray_caster* caster);
void stratus_first_hit_destroy(stratus_ray_caster* caster);

/* ray_tree.c: structure HYBRID. Whether a tree was offered that shows all that the transfer function does, of this very volume. */
stratus_status stratus_ray_tree_serves(stratus_ray_caster* caster, bool* serves);
/* The same of first hits: whether its voxels are those that the criterion shows. Asked once, which takes *ms more. */
stratus_status stratus_ray_tree_serves_first_hits(
  stratus_ray_caster* caster, const stratus_volume* in_index, const stratus_criterion* criterion, bool* serves, double* ms);
/* That tree, or a new one, as the march asks it; caster->occupancy is there. */
stratus_status stratus_ray_tree_map(stratus_ray_caster* caster, bool offered, stratus_distance_map** map);

/* ray_modes.c: what other modes than composite ask for. */
stratus_status stratus_ray_modes_check(stratus_context* context, const stratus_ray_cast_options* options);
/* The options' part that decides it, with what the mode does not use left out. */
stratus_ray_shown stratus_ray_modes_shown(const stratus_ray_cast_options* options);
bool stratus_ray_modes_same(const stratus_ray_shown* a, const stratus_ray_shown* b);
void stratus_ray_modes_choose(const stratus_ray_cast_options* options, double voxel, stratus_ray_choice* choice);
/* The distance that the table's opacity is taken over: alpha of a mode that takes it as it is, not per length, is that over one unit. */
double stratus_ray_modes_table_distance(const stratus_ray_cast_options* options, const stratus_transfer* transfer, double sample_distance);
/* Marks the entries that the mode can't do without as those that show. */
void stratus_ray_modes_mark(const stratus_ray_shown* shown, const stratus_transfer* transfer, double bias, stratus_table* table);
/* Puts what each block holds at best behind the map's bytes, where the mode asks for it. */
stratus_status stratus_ray_modes_bounds(const stratus_ray_caster* caster, stratus_distance_map* map);
void stratus_ray_modes_arguments(
  const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_ray_cast_arguments* arguments);
stratus_ray_variant stratus_ray_modes_variant(const stratus_ray_caster* caster);
/* Rays show something wherever they meet the bounds, whatever the values. */
bool stratus_ray_modes_covers(const stratus_ray_cast_options* options);

/* ray_shading.c: samples that are more than their value's colour and opacity. */
stratus_status stratus_ray_shading_check(stratus_context* context, const stratus_ray_cast_options* options);
bool stratus_ray_shading_wanted(const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options);
void stratus_ray_shading_arguments(const stratus_ray_caster* caster, const stratus_volume* volume, const stratus_camera* camera,
  const stratus_ray_cast_options* options, stratus_ray_cast_arguments* arguments);

/* ray_shading_table.c */
int stratus_volume_components(const stratus_volume* volume);
stratus_volume stratus_volume_component(const stratus_volume* volume, int component); /* as a volume of its own */
int stratus_ray_shading_media(
  const stratus_volume* volume, const stratus_ray_cast_options* options); /* transfer functions that the render takes */
stratus_status stratus_ray_shading_check_volume(
  stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options);
stratus_status stratus_ray_shading_ranges(stratus_ray_caster* caster); /* of the components beside the first */
void stratus_ray_shading_choose(
  stratus_ray_caster* caster, double voxel, const stratus_transfer* transfer, const stratus_ray_cast_options* options);
stratus_status stratus_ray_shading_tables_update(stratus_ray_caster* caster, bool dependent); /* after caster->table */
bool stratus_ray_shading_several(const stratus_ray_caster* caster);       /* tables, so that one map of opacity is not enough */
bool stratus_ray_shading_show(const stratus_ray_caster* caster);          /* anything at all */
stratus_status stratus_ray_shading_occupancy(stratus_ray_caster* caster); /* caster->occupancy, of several components */
void stratus_ray_shading_release(stratus_ray_caster* caster);

/* ray_mask.c: the bytes of cells that ghosts hide, NULL: none. */
stratus_status stratus_ray_hidden_make(stratus_context* context, const stratus_volume* volume, bool by_value, uint8_t** hidden);
/* Whether the mask is the one that caster->hidden was made from; and one put before the bytes of cells (NULL: none are hidden). */
bool stratus_ray_mask_same(const stratus_ray_caster* caster, const stratus_ray_cast_options* options);
stratus_status stratus_ray_mask_join(
  stratus_context* context, const stratus_volume* volume, const uint8_t* mask, bool labels, bool by_value, uint8_t** hidden, int* hides);
/* Bytes a cell, as traversal reads them. */
size_t stratus_ray_hidden_cells(const stratus_volume* volume, bool by_value);

/* ray_sampling.c */
void stratus_ray_choose(const stratus_value_range* ranges, double voxel, const stratus_transfer* transfer,
  stratus_interpolation interpolation, stratus_sampling sampling, double sample_distance, stratus_ray_choice* choice);
double stratus_ray_voxel_length(const stratus_volume* volume); /* shortest edge of a voxel along which the volume extends, world */

/* ray_frame.c: fills what camera, volume and options decide. *empty: no ray can meet anything. */
stratus_status stratus_ray_frame_arguments(stratus_context* context, const stratus_volume* volume, const stratus_camera* camera,
  const stratus_ray_cast_options* options, const stratus_image* image, double sample_distance, stratus_ray_cast_arguments* arguments,
  bool* empty);
/* Adds what table and map decide; either NULL leaves it out. */
void stratus_ray_frame_structures(
  const stratus_table* table, const stratus_occupancy* occupancy, const stratus_distance_map* map, stratus_ray_cast_arguments* arguments);

/* ray_cast_host.c: all tiles on the host. */
stratus_status stratus_ray_cast_host(
  stratus_context* context, const stratus_ray_cast_frame* frame, int type, stratus_ray_variant variant, stratus_ray_counts* counts);

/* ray_cast_device.c: the same on the OpenCL device. *drawn stays false where the device can't (too large, no double): the host draws then.
 */
stratus_status stratus_ray_cast_device(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, int type,
  stratus_ray_variant variant, stratus_ray_counts* counts, double* upload_ms, bool* drawn);
void stratus_ray_device_destroy(stratus_ray_caster* caster);

#endif
