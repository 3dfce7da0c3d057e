/* SPDX-License-Identifier: BSD-3-Clause
 * What kernels are told of a batch of rays through a tree. */
#ifndef STRATUS_FIRST_HIT_ARGUMENTS_H
#define STRATUS_FIRST_HIT_ARGUMENTS_H

/* Scalars of four bytes only: the same bytes on host and device. `at`, `cells` and `row_start` are those of the only field, and 0 in a tree
 * of many leaves. */
typedef struct stratus_hit_arguments {
  int at[3], cells[3]; /* the field's first cell, and how many it has along each axis */
  int row_start;       /* the field's first row in rows[] */
  int octants, entry_bytes, cell_log2;
  int count; /* of rays */
  float slack;
} stratus_hit_arguments;

/* What became of a ray: results of the kernel. */
#define STRATUS_HIT_NONE 0
#define STRATUS_HIT_VOXEL 1
#define STRATUS_HIT_DOUBTFUL 2

#endif
