/* SPDX-License-Identifier: BSD-3-Clause
 * The ray caster's state. */
#ifndef STRATUS_RAY_CASTER_H
#define STRATUS_RAY_CASTER_H

#include "stratus/tree.h"
#include "stratus/ray_cast.h"
#include "ray_cast_host.h"
#include "ray_grid.h"
#include "ray_modes_render.h"
#include "ray_sampling.h"
#include "ray_shading_table.h"
#include "ray_transfer_2d_host.h"
#include "volume.h"

typedef struct stratus_ray_device stratus_ray_device;
typedef struct stratus_first_hit stratus_first_hit;

/* Casters within a caster: of up to four independent components, and, last, of the quantities of one. */
#define STRATUS_RAY_PARTS 5

/* A table and its inputs. */
typedef struct stratus_ray_made_table {
  stratus_table* table; /* NULL: none */
  double distance;      /* between samples */
  int entries;          /* the requested minimum */
  uint64_t number;      /* of the caster's tables, in the order of their making */
} stratus_ray_made_table;

/* Milliseconds of a frame, and of building, by structure; and the time that a trial wastes. */
typedef struct stratus_ray_costs {
  double frame[STRATUS_STRUCTURE_HYBRID + 1], build[STRATUS_STRUCTURE_HYBRID + 1], trial;
} stratus_ray_costs;

/* The measurements for an automatic choice of the structure since the occupancy changed, see ray_trial.h. */
typedef struct stratus_ray_trial {
  stratus_structure map;                    /* of caster->map; AUTO: none was made yet */
  bool tried[STRATUS_STRUCTURE_HYBRID + 1]; /* maps that were built */
  stratus_structure lost;                   /* the last that was built and was slower than `map`; AUTO: none */
  uint64_t table_serial;                    /* of the table of the frame before */
  stratus_ray_choice choice;                /* its sampling */
  int frames;                               /* drawn with that table and sampling */
  bool timed;                               /* `with` and `without` are of these; else of those before */
  double with, without;                     /* milliseconds of the same pixels, by the map and by none */
  double build_ms;                          /* of the last distance map */
  double spent, built_ms, trial_ms;         /* milliseconds that frames, builds of other maps, and trials of none took */
} stratus_ray_trial;

struct stratus_ray_caster {
  stratus_context* context;

  stratus_volume volume;       /* as last rendered; its coordinates point into `grid` */
  stratus_ray_grid grid;       /* of volumes with coordinates */
  int64_t owned[2][3];         /* the cells lo..hi - 1 that this piece owns */
  bool owns_all;               /* these are all cells */
  stratus_volume traversed;    /* the values that rays read: the volume itself, or its fetched values */
  float* fetched;              /* float copy of the values; NULL: none */
  uint64_t samples_since_data; /* samples that rays have taken of the data; decides when the copy pays */
  bool copy_failed;            /* memory ran out for it since the data changed */
  /* The component that rays follow: of dependent components, the last one, but in composite mode and slices; else 0. `ranges` are its own.
   */
  int followed;
  stratus_value_range* ranges;
  uint8_t* hidden;      /* hidden bytes as traversal reads them; NULL: none */
  bool hidden_by_value; /* its cells are centred on values */
  int hides;            /* contents of `hidden`: HIDDEN_CELLS, HIDDEN_BY_MASK, HIDDEN_LABELS */
  const uint8_t* mask;  /* the mask in `hidden`; NULL: none */
  uint64_t mask_revision;
  stratus_transfer* transfers; /* transfer_count copies; NULL: none yet */
  int transfer_count;
  stratus_ray_shown shown; /* mode and values of `values`, as the next */
  stratus_interpolation interpolation;
  stratus_ray_choice_inputs inputs; /* of `choice` */
  stratus_ray_choice choice;
  stratus_ray_choice measured;            /* the last that the probe made; its sample distance is 0 before the first */
  stratus_ray_choice_inputs measured_for; /* the inputs of `measured`; tolerance -1: data or function have changed since */
  char tried[256];                        /* the settings that the probe tried; empty: there was no probe */
  stratus_ray_made_table made;            /* the table that is drawn by */
  stratus_ray_made_table spare_table; /* of the other kind, samples or running sums: the probe and coarse pictures change between them */
  stratus_shown values;               /* the fetched values that matter; of NULL: not known yet */
  /* of several volumes, by midpoint: colour and optical depth of each table entry over a segment; NULL: none */
  float* layers;
  uint64_t layers_of;     /* that table's number */
  double layers_step;     /* the segment's length */
  bool shades, dependent; /* shades: stratus_ray_shading_wanted() of this render; dependent: options->dependent of `transfers` */
  stratus_ray_shading_tables shading_tables;
  stratus_ray_transfer_2d transfer_2d;
  stratus_occupancy* occupancy;
  stratus_distance_map* map;
  stratus_distance_map* rough; /* which blocks rule local takes cell by cell; NULL: none, for it was not taken */
  stratus_tree* offered;       /* a tree that came with the data, in index coordinates; NULL: none */
  int tree_serves;             /* 1: the offered tree serves this render; 0: it does not; -1: not known yet */
  uint64_t hash;               /* of the volume's values and shape */
  double scan_ms;              /* milliseconds that the value ranges took */
  uint64_t hash_ranges;        /* range_builds when `hash` was computed; `hash` is stale if they differ */
  stratus_ray_trial trial;
  const stratus_ray_costs* forced; /* taken instead of all measured times, for tests; NULL: none */

  stratus_ray_caster* parts[STRATUS_RAY_PARTS]; /* of independent components, see ray_caster_parts.c; NULL until such a mode is used */

  bool together; /* it draws in one march with others, which light each sample */

  int keeps; /* > 0: pictures hold what rays keep (ray_kept.h), of surfaces this one of each ray, the nearest is 1 */

  stratus_first_hit* first_hit; /* first_hit_picture.h; NULL until mode FIRST_HIT is used */

  stratus_ray_device* device; /* buffers on the OpenCL device; NULL: none */
  char where[160];            /* how the device drew the last picture, or why the host did; empty where nothing is to be said */
  uint64_t data_serial, table_serial, occupancy_serial, map_serial,
    rough_serial; /* incremented by each build, so that the device knows which buffers are stale */
  uint64_t range_builds, table_builds, occupancy_builds, structure_builds, uploads, probe_builds;
};

/* ray_caster_drop.c: each function also drops the data derived from its own. stratus_ray_forget_offer() makes the caster check an offered
 * tree again if it is of cells, or of voxels. stratus_ray_drop_offer_map() does so for a tree of cells, and drops a map that was made from
 * a tree. */
void stratus_ray_forget_offer(stratus_ray_caster* caster, bool of_cells);
void stratus_ray_drop_transfer(stratus_ray_caster* caster);
void stratus_ray_drop_values(stratus_ray_caster* caster);
void stratus_ray_drop_occupancy(stratus_ray_caster* caster);
void stratus_ray_drop_map(stratus_ray_caster* caster);
void stratus_ray_drop_rough(stratus_ray_caster* caster);
void stratus_ray_drop_offer_map(stratus_ray_caster* caster);

/* ray_caster_update.c: rebuilds only parts whose inputs changed. */
stratus_status stratus_ray_update_tables(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_ray_cast_options* options, size_t rays, stratus_ray_cast_report* report); /* value ranges, choices, table */
/* Returns the size of blocks where the user leaves it open. */
int stratus_ray_block_size(const stratus_volume* volume);
/* Makes caster->occupancy of caster->ranges. */
stratus_status stratus_ray_make_occupancy(stratus_ray_caster* caster);
/* Makes the tables of caster->choice. */
stratus_status stratus_ray_update_table(stratus_ray_caster* caster, const stratus_ray_cast_options* options);
/* Makes a map for a structure other than NONE. offered: of the tree that came with the data. *map: NULL if no block is occupied and the
 * structure is a tree. */
stratus_status stratus_ray_make_map(stratus_ray_caster* caster, stratus_structure structure, bool offered, stratus_distance_map** map);
/* times: measured times may decide if the structure is automatic. */
stratus_status stratus_ray_update_structures(stratus_ray_caster* caster, stratus_structure wanted, bool times, stratus_structure* used,
  char* why, size_t capacity, stratus_ray_cast_report* report);

/* ray_caster_render.c. stratus_ray_check_input() checks the input of an image except camera and image. stratus_ray_fill_report() reports
 * the counts and choices. */
stratus_status stratus_ray_check_input(
  stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options);
void stratus_ray_fill_report(
  const stratus_ray_caster* caster, const stratus_ray_counts* counts, stratus_structure used, stratus_ray_cast_report* report);
/* Returns how many pixels differ in their bits. */
uint64_t stratus_ray_differing(const stratus_image* image, const float* rgba, const float* depth);
/* One picture, of one component or of all that mix along a ray, of input that was checked. */
stratus_status stratus_ray_render_one(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image, stratus_ray_cast_report* report);

/* ray_caster_parts.c. stratus_ray_parts(): the number of components that are drawn by themselves; options NULL: the defaults.
 * stratus_ray_render_kept() draws what rays keep of one of them, in all modes but composite. keeps: as in the caster. *drawn: the caster
 * that has the component's structures. */
int stratus_ray_parts(const stratus_volume* volume, const stratus_ray_cast_options* options);
/* Finds the caster of an independent component, and makes it where there is none yet. */
stratus_status stratus_ray_part(stratus_ray_caster* caster, int component, stratus_ray_caster** part);
stratus_status stratus_ray_render_kept(stratus_ray_caster* caster, const stratus_volume* volume, const stratus_transfer* transfer,
  int component, int keeps, const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image,
  const stratus_ray_caster** drawn, stratus_ray_cast_report* report);

/* ray_frame.c: the arrays that a frame reads and writes, and the table among them with its size. */
const void* stratus_ray_table_of(const stratus_ray_caster* caster, size_t* bytes);
stratus_ray_cast_frame stratus_ray_frame_of(
  const stratus_ray_caster* caster, const stratus_ray_cast_arguments* arguments, const stratus_image* image, bool with_map);

#endif
