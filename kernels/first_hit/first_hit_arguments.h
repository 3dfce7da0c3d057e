/* SPDX-License-Identifier: BSD-3-Clause
 * What a batch of rays through one distance field is told by, on host and device. */
#ifndef STRATUS_FIRST_HIT_ARGUMENTS_H
#define STRATUS_FIRST_HIT_ARGUMENTS_H

/* The field and what is known of all rays; 4-byte scalars, the same bytes on host and device. */
typedef struct stratus_hit_arguments {
  int at[3], cells[3]; /* in cells */
  int row_start;       /* first of rows[] */
  int octants, entry_bytes, cell_log2;
  int count; /* rays */
  float slack;
} stratus_hit_arguments;

/* What became of a ray. */
#define STRATUS_HIT_NONE 0
#define STRATUS_HIT_VOXEL 1
#define STRATUS_HIT_DOUBTFUL 2

#endif
