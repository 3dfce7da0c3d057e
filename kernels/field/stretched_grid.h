/* SPDX-License-Identifier: BSD-3-Clause
 * Grids whose spacing changes. Rays are straight in mean index coordinates, which are the index coordinates of a grid with the same ends
 * and equal spacing. Tables translate them, an axis at a time, to cells and fractions of cells.
 *
 * Planes are numbered: plane 2 i is where value i is, plane 2 i + 1 is the border between the boxes about the values i and i + 1. Plane -1
 * is the border before value 0. Planes -2 and 2 n are far beyond the n values. An axis's bins are equally wide. `first` of a bin is the
 * last value in a bin before it, so that a bisection between a bin's `first` and the next one's finds the value at or below any position.
 * It has search_steps steps, 0 to 2 if spacings differ little, and never more than the logarithm of n.
 *
 * Positions are compared with planes as the floats that they are. So the cell of a position is a monotone function of it, and a position
 * before the float of a plane is in a cell before it. Structures rely on this when they leap up to a plane.
 *
 * Along even axes every plane's float is half its number; most grids of levels have two. Cells and fractions need no table there, and are
 * the same ones. */
#ifndef STRATUS_STRETCHED_GRID_H
#define STRATUS_STRETCHED_GRID_H

#include "gather.h"
#include "ray_cast_arguments.h"

/* The largest float below 1. Fractions of cells stay below 1, as whole positions less their whole part do: interpolation then never leaves
 * the hull of its corners, whatever it rounds. */
#define GRID_FRACTION_MOST 0x1.fffffep-1f

/* Functions of grids are not inlined: most volumes have no such grid, and the march should be compiled as if there were none. */

/* Whether the frame has such a grid. */
#if defined(STRATUS_DEVICE) || !defined(__GNUC__)
#define RAY_STRETCHED(a) RAY_RARE(RAY_GRID, (a)->grid.on)
#else
#define RAY_STRETCHED(a) (int)__builtin_expect((a)->grid.on, 0)
#endif

INLINE vint grid_ints(GLOBAL const int* table, vint at) { return v_gather_ints(table, at, vi_ge(at, vi_set(0))); }
INLINE vfloat grid_floats(GLOBAL const int* table, vint at) { return v_from_bits(grid_ints(table, at)); }

/* The position of a plane, of the nearest that there is. */
INLINE vfloat grid_plane(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* grid, int axis, vint plane)
{
  const vint least = vi_set(-2), most = vi_set(2 * a->values.dimensions[axis]);
  return grid_floats(grid, vi_max(vi_min(plane, most), least) + vi_set(a->grid.plane_at[axis]));
}

/* The same; where the march is compiled for grids of equal spacing, too. */
OUTLINE vfloat grid_plane_rare(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* grid, int axis, vint plane)
{
  return grid_plane(a, grid, axis, plane);
}

/* The cell between values at a position; beyond the border, the border's cell. A bisection needs no bin's end: it uses no plane beyond the
 * position. */
INLINE vint grid_cell(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* grid, int axis, vfloat y)
{
  if (a->grid.even[axis]) {
    return v_to_int(v_clamp(y, 0.0f, (float)a->grid.last_cell[axis]));
  }
  const vint bin = v_to_int(v_clamp(y * v_set(a->grid.bins_per_unit[axis]), 0.0f, a->grid.last_bin[axis])) + vi_set(a->grid.first_at[axis]);
  const vint last = vi_set(a->grid.last_cell[axis]), planes = vi_set(a->grid.plane_at[axis]);
  vint cell = grid_ints(grid, bin);
  for (int ahead = (1 << a->grid.search_steps[axis]) >> 1; ahead > 0; ahead >>= 1) {
    const vint next = cell + vi_set(ahead), at = vi_min(next, last);
    const vmask behind = vi_ge(last, next) & v_le(grid_floats(grid, at + at + planes), y);
    cell = vi_select(behind, next, cell);
  }
  return cell;
}

/* The fraction of a cell at a position; 0 or 1 beyond it. */
INLINE vfloat grid_fraction(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* grid, int axis, vint cell, vfloat y)
{
  if (a->grid.even[axis]) {
    return v_clamp(y - v_from_int(cell), 0.0f, 1.0f);
  }
  const vfloat per_unit = grid_floats(grid, cell + vi_set(a->grid.inverse_at[axis]));
  return v_clamp((y - grid_plane(a, grid, axis, cell + cell)) * per_unit, 0.0f, 1.0f);
}

OUTLINE vfloat grid_fraction_rare(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* grid, int axis, vint cell, vfloat y)
{
  return grid_fraction(a, grid, axis, cell, y);
}

/* Cells and fractions at positions. */
OUTLINE void grid_find(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* grid, const vfloat y[3], vint cell[3], vfloat fraction[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    const vfloat at = v_min(y[axis], v_set(a->values.last[axis]));
    cell[axis] = grid_cell(a, grid, axis, at);
    fraction[axis] = v_min(grid_fraction(a, grid, axis, cell[axis], at), v_set(GRID_FRACTION_MOST));
  }
}

/* The cells at positions. */
OUTLINE void grid_cells(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* grid, const vfloat y[3], vint cell[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    cell[axis] = grid_cell(a, grid, axis, y[axis]);
  }
}

/* Makes positions index coordinates of the same cell and the same nearest value: a quarter of a cell from the value. */
OUTLINE void grid_snap(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* grid, vfloat y[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    const vint cell = grid_cell(a, grid, axis, y[axis]);
    const vmask next = v_le(grid_plane(a, grid, axis, cell + cell + vi_set(1)), y[axis]);
    const vfloat quarter = v_select(next, v_set(0.75f), v_set(0.25f));
    y[axis] = v_from_int(cell) + (a->values.dimensions[axis] > 1 ? quarter : v_set(0.25f));
  }
}

/* The number of the last plane at or before a position: -1 before value 0. */
OUTLINE vint grid_last_plane(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* grid, int axis, vfloat y)
{
  vint plane = grid_cell(a, grid, axis, y);
  plane = plane + plane;
  for (int more = 0; more < 2; ++more) { /* the border in the cell, and the value at its end, where that is the volume's last */
    const vint next = plane + vi_set(1);
    plane = vi_select(v_le(grid_plane(a, grid, axis, next), y), next, plane);
  }
  return vi_select(v_lt(y, grid_plane(a, grid, axis, vi_set(0))), vi_set(-1), plane);
}

#endif
