/* SPDX-License-Identifier: BSD-3-Clause
 * The ray caster's state, and the steps of a render that have files of their own. */
#ifndef STRATUS_RAY_CASTER_H
#define STRATUS_RAY_CASTER_H

#include "internal.h"
#include "ray_cast.h"

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
} stratus_ray_shown;

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
  double* points; /* the transfer function's, copied: opacity, then colour */
  stratus_transfer transfer;
  stratus_interpolation interpolation; /* with the next three: what the choice was made for */
  stratus_sampling wanted_sampling;
  double wanted_distance, voxel_length;
  stratus_ray_choice choice;
  stratus_table* table;
  double table_distance;   /* the sample distance that the table is for .. */
  stratus_ray_shown shown; /* .. and the values */
  stratus_occupancy* occupancy;
  stratus_distance_map* map;
  int tree_serves;      /* whether an offered tree may stand in for a map: 1, 0, or -1 where that is to be asked */
  uint64_t hash;        /* of the volume's values and shape, .. */
  uint64_t hash_ranges; /* .. if this is range_builds */
  uint64_t lookups_since_edit;

  stratus_first_hit* first_hit; /* NULL until asked for: first_hit_picture.h */

  stratus_ray_device* device;                     /* copies on the OpenCL device, NULL on the host */
  uint64_t data_serial, table_serial, map_serial; /* raised with each build: tells the device what is stale */
  uint64_t range_builds, table_builds, occupancy_builds, structure_builds, uploads;
};

/* ray_caster.c: builds anew what changed and nothing else. */
stratus_status stratus_ray_update_tables(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_ray_cast_options* options, stratus_ray_cast_report* report); /* value ranges, choices, table */
stratus_status stratus_ray_update_structures(stratus_ray_caster* caster, stratus_structure wanted, stratus_structure* used, char* why,
  size_t capacity, stratus_ray_cast_report* report);
int stratus_ray_fetch_type(const stratus_volume* volume); /* STRATUS_TYPE that traversal is compiled for, -1 the generic one */

/* first_hit_picture.c, first_hit_scene.c: the mode of first hits; dropping what it built; that and the offered tree */
stratus_status stratus_first_hit_render(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report);
void stratus_first_hit_release(stratus_ray_caster* caster);
void stratus_first_hit_destroy(stratus_ray_caster* caster);

/* ray_tree.c: structure HYBRID. Whether a tree was offered that shows all that the transfer function does, of this very volume. */
stratus_status stratus_ray_tree_serves(stratus_ray_caster* caster, bool* serves);
/* That tree, or a new one, as the march asks it; caster->occupancy is there. */
stratus_status stratus_ray_tree_map(stratus_ray_caster* caster, bool offered, stratus_distance_map** map);
void stratus_ray_tree_dropped(stratus_ray_caster* caster); /* another tree is offered, or none: ray_caster.c */

/* ray_modes.c: what other modes than composite ask for. */
stratus_status stratus_ray_modes_check(stratus_context* context, const stratus_ray_cast_options* options);
stratus_ray_shown stratus_ray_modes_shown(const stratus_ray_cast_options* options);
bool stratus_ray_modes_same(const stratus_ray_shown* shown, const stratus_ray_cast_options* options);
void stratus_ray_modes_choose(const stratus_ray_cast_options* options, double voxel, stratus_ray_choice* choice);
/* The distance that the table's opacity is taken over: alpha of a mode that takes it as it is, not per length, is that over one unit. */
double stratus_ray_modes_table_distance(const stratus_ray_cast_options* options, const stratus_transfer* transfer, double sample_distance);
/* Marks the entries that the mode can't do without as those that show. */
void stratus_ray_modes_mark(const stratus_ray_cast_options* options, double bias, stratus_table* table);
void stratus_ray_modes_arguments(const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_ray_cast_arguments* arguments);
stratus_ray_variant stratus_ray_modes_variant(const stratus_ray_caster* caster);
/* Rays show something wherever they meet the bounds, whatever the values. */
bool stratus_ray_modes_covers(const stratus_ray_cast_options* options);

/* ray_choice.c */
void stratus_ray_choose(const stratus_value_range* ranges, double voxel, const stratus_transfer* transfer,
  stratus_interpolation interpolation, stratus_sampling sampling, double sample_distance, stratus_ray_choice* choice);
double stratus_ray_voxel_length(const stratus_volume* volume); /* shortest edge of a voxel, world */

/* ray_frame.c: fills what camera, volume and options decide. *empty: no ray can meet anything. */
stratus_status stratus_ray_frame_arguments(stratus_context* context, const stratus_volume* volume, const stratus_camera* camera,
  const stratus_ray_cast_options* options, const stratus_image* image, double sample_distance, stratus_ray_cast_arguments* arguments,
  bool* empty);
/* Adds what table and map decide; either NULL leaves it out. */
void stratus_ray_frame_structures(
  const stratus_table* table, const stratus_occupancy* occupancy, const stratus_distance_map* map, stratus_ray_cast_arguments* arguments);

/* The same checks and window for who draws otherwise. Pixels [window[0], window[1]) x [window[2], window[3]) that the box [lo, hi] covers, and one
 * more each way: all of them where it reaches behind the eye. Vectors as in stratus_camera, in the box's coordinates. */
stratus_status stratus_ray_check_camera(stratus_context* context, const stratus_camera* camera, const stratus_image* image);
void stratus_ray_window(const double eye[3], const double right[3], const double up[3], const double forward[3], bool parallel, const double lo[3],
  const double hi[3], const int sides[2], int window[4]);

/* ray_cast.c: all tiles on the host. */
stratus_status stratus_ray_cast_host(
  stratus_context* context, const stratus_ray_cast_frame* frame, int type, stratus_ray_variant variant, stratus_ray_counts* counts);

/* ray_cast_device.c: the same on the OpenCL device. *drawn stays false where the device can't (too large, no double): the host draws then. */
stratus_status stratus_ray_cast_device(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, int type, stratus_ray_variant variant,
  stratus_ray_counts* counts, double* upload_ms, bool* drawn);
void stratus_ray_device_destroy(stratus_ray_caster* caster);

#endif
