/* SPDX-License-Identifier: BSD-3-Clause
 * The arguments of projection that every tile reads, in addition to a frame's arguments (tetra_arguments.h). The same bytes on host and
 * device. */
#ifndef STRATUS_TETRA_PROJECT_ARGUMENTS_H
#define STRATUS_TETRA_PROJECT_ARGUMENTS_H

/* Pixels along a tile's edge. A tile's state fits a processor's innermost cache, and most cells are in one tile. */
#define PROJECT_TILE 32

/* The pixels whose rays may meet a cell: columns x0..x1, rows y0..y1; none if x0 > x1. near: the cell's smallest z. */
typedef struct stratus_tetra_rect {
  unsigned short x0, x1, y0, y1;
  float near;
} stratus_tetra_rect;

#endif
