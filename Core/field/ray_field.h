/* SPDX-License-Identifier: BSD-3-Clause
 * The field that rays read: a caster's part of the state that says where values are, of which component, and which are hidden. */
#ifndef STRATUS_RAY_FIELD_H
#define STRATUS_RAY_FIELD_H

#include "stratus/ray_cast.h"
#include "ray_components.h"
#include "ray_grid.h"
#include "volume.h"

typedef struct stratus_ray_field {
  stratus_context* context;
  stratus_volume volume;                       /* as last rendered; its coordinates point into `grid` */
  stratus_ray_grid grid;                       /* of volumes with coordinates */
  int64_t owned[2][3];                         /* the cells lo..hi - 1 that this piece owns */
  bool owns_all;                               /* these are all cells */
  stratus_volume traversed;                    /* the values that rays read: the volume itself, or its fetched values */
  stratus_tiles tiles[STRATUS_COMPONENTS_MAX]; /* of each component that is read from tiles */
  float* fetched;                              /* float copy of the values; NULL: none */
  uint64_t samples_since_data;                 /* samples that rays have taken of the data; decides when the copy pays */
  bool copy_failed;                            /* memory ran out for it since the data changed */
  stratus_interpolation interpolation;
  /* The component that rays follow: of dependent components, the last one, but in composite mode and slices; else 0. `ranges` are its own.
   */
  int followed;
  stratus_value_range* ranges;
  int components;                 /* of the volume that the next are of */
  stratus_value_range* others[4]; /* value ranges of each component; NULL of the followed one */
  uint64_t others_of;             /* range_builds when they were made */
  uint8_t* hidden;                /* hidden bytes as traversal reads them; NULL: none */
  bool hidden_by_value;           /* its cells are centred on values */
  int hides;                      /* contents of `hidden`: HIDDEN_CELLS, HIDDEN_BY_MASK, HIDDEN_LABELS */
  const uint8_t* mask;            /* the mask in `hidden`; NULL: none */
  uint64_t mask_revision;
  uint64_t hash;        /* of the volume's values and shape */
  double scan_ms;       /* milliseconds that the value ranges took */
  uint64_t hash_ranges; /* range_builds when `hash` was computed; `hash` is stale if they differ */
  uint64_t data_serial; /* incremented by each change of the values that rays read, so that the device knows which buffers are stale */
  uint64_t range_builds;
} stratus_ray_field;

/* The changes of an update. */
typedef struct stratus_ray_field_change {
  bool values, hidden, grid;
} stratus_ray_field_change;

/* Makes the field of a volume: rebuilds only what its input changes. rays: of the picture to come. *change is set where it fails, too. Adds
 * the milliseconds to *ms. */
stratus_status stratus_ray_field_update(stratus_ray_field* field, const stratus_volume* volume, const stratus_ray_cast_options* options,
  size_t rays, stratus_ray_field_change* change, double* ms);
/* Releases everything; the next update makes it anew. */
void stratus_ray_field_release(stratus_ray_field* field);
/* Whether `others` are of this data; and makes them. */
bool stratus_ray_field_has_components(const stratus_ray_field* field);
stratus_status stratus_ray_field_components(stratus_ray_field* field);
const stratus_value_range* stratus_ray_range_of(const stratus_ray_field* field, int component);

#endif
