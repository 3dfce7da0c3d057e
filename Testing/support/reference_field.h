/* SPDX-License-Identifier: BSD-3-Clause
 * A volume as the reference renderer samples it, in index coordinates. Private to the reference; tests include reference.h. */
#ifndef STRATUS_TESTING_REFERENCE_FIELD_H
#define STRATUS_TESTING_REFERENCE_FIELD_H

#include "reference.h"
#include "reference_axis.h"

#include <stdbool.h>

#define REFERENCE_BLOCK 8 /* cells along the edge of a block that is tested as a whole */

typedef struct reference_field {
  const stratus_volume* volume;
  double to_index[3][3]; /* inverse of the linear part of index -> world */
  double corner[3];      /* world position of the volume's origin */
  double shift[3];       /* place of that origin: 0, or -1/2 for values of cells of equal size */
  double lo[3], hi[3];   /* the box that is drawn, in places (reference_axis.h) */
  double edge;           /* shortest edge of a voxel in the world; of its mean, where spacing changes */
  int64_t blocks[3];
  uint8_t* shown; /* per block */
  bool linear;
} reference_field;

typedef struct reference_cell {
  int64_t at[3]; /* lower corner; -1: no cell is loaded yet */
  double corner[8];
  bool shown;
} reference_cell;

/* Returns 0. If memory runs out or the volume has no extent, returns -1, with nothing to release. */
int reference_field_create(const reference_scene* scene, reference_field* f);
void reference_field_release(reference_field* f);

/* Returns the value at p (places, inside the box), or NAN where something is hidden or not finite. c caches the last cell. */
double reference_field_sample(const reference_field* f, const double p[3], reference_cell* c);

/* Returns i clamped to 0..n-1. */
int64_t reference_clamp(int64_t i, int64_t n);

#endif
