/* SPDX-License-Identifier: BSD-3-Clause
 * The kernels' arguments for a batch of rays through a tree. */
#ifndef STRATUS_FIRST_HIT_ARGUMENTS_H
#define STRATUS_FIRST_HIT_ARGUMENTS_H

/* Scalars of four bytes only: the same bytes on host and device. `at`, `cells` and `row_start` belong to the only field, and are 0 in a
 * tree of many leaves. */
typedef struct stratus_hit_arguments {
  int at[3], cells[3]; /* the field's first cell, and how many it has along each axis */
  int row_start;       /* the field's first row in rows[] */
  int octants, entry_bytes, cell_log2;
  int count; /* of rays */
  float slack;
} stratus_hit_arguments;

/* The same of a batch among voxels of any widths, through one field of bricks. */
typedef struct stratus_stretched_arguments {
  int at[3], cells[3];
  int border_at[3]; /* where border 0 of an axis is in borders[]; -1: voxel i fills i .. i + 1 */
  int octants, entry_bytes;
  int count; /* of rays */
} stratus_stretched_arguments;

/* Status of a ray, as the kernel writes it. */
#define STRATUS_HIT_NONE 0
#define STRATUS_HIT_VOXEL 1
#define STRATUS_HIT_DOUBTFUL 2

#endif
