/* SPDX-License-Identifier: BSD-3-Clause
 * Rectilinear grids: the tables by which rays find the cell of a position. A ray is straight in mean index coordinates, which are the index
 * coordinates of a grid with the same ends and equal spacing. The tables translate them only for a value, a block or a cell's border. */
#ifndef STRATUS_RAY_GRID_H
#define STRATUS_RAY_GRID_H

#include "ray_cast_arguments.h"
#include "volume.h"

/* Most values along an axis of such a grid: the tables hold numbers of planes in floats' 24 bits. */
#define STRATUS_RAY_GRID_MOST 4000000

typedef struct stratus_ray_grid {
  void* numbers;          /* the memory of coordinates and planes */
  double* coordinates[3]; /* copies of the volume's; NULL along axes without */
  int64_t dimensions[3];  /* of the volume, as the next */
  int cell_centered;
  /* Planes of each axis in mean index coordinates, 2 * dimensions + 1 of them. plane[axis][1 + 2 i] is the position of value i, and
   * plane[axis][2 i] and plane[axis][2 i + 2] are the borders of the box about it: midway between neighbours, or the cell's borders. */
  double* plane[3];
  int32_t* table; /* for rays, in the layout of kernels/field/stretched_grid.h; NULL: the grid has equal spacing */
  size_t bytes;   /* of it */
  stratus_ray_grid_arguments arguments;
  uint64_t serial; /* how many tables were made */
} stratus_ray_grid;

/* Makes the tables of a volume anew if its coordinates are others, by content, than those the tables are of. Without coordinates there are
 * no tables. *changed: set to true if they were made anew, or dropped. */
stratus_status stratus_ray_grid_update(stratus_context* context, const stratus_volume* volume, stratus_ray_grid* grid, bool* changed);
void stratus_ray_grid_release(stratus_context* context, stratus_ray_grid* grid);

/* Return the mean index coordinate of an index coordinate within 0..dimensions-1, which may be between two values. */
double stratus_ray_grid_at(const stratus_ray_grid* grid, int axis, double index);
/* Returns the mean index coordinate of the border below cell number `cell`; a cell is between two values, or about one if cell_centered. */
double stratus_ray_grid_border(const stratus_ray_grid* grid, int axis, int64_t cell);

#endif
