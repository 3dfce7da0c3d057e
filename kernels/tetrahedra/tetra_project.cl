/* SPDX-License-Identifier: BSD-3-Clause
 * The projection of tetrahedra on a device. If STRATUS_WIDTH is 16 (a CPU), a work item does a tile of pixels in packets, as the host does.
 * Otherwise (a GPU) a work item does one pixel, and a group does a square of them: each item finds the planes of one cell, and all pixels
 * of the group read these from local memory. Pixels whose pieces came out of order are listed, and tetra_project_again draws them. */
#ifndef STRATUS_DEVICE
#define STRATUS_DEVICE 1
#endif
#ifndef STRATUS_WIDTH
#define STRATUS_WIDTH 1
#endif

#include "tetra_project_draw.h"

#ifdef STRATUS_ARGUMENTS_BYTES
/* An array of negative size, which does not compile, where the host lays the arguments out otherwise. */
typedef char stratus_arguments_agree[sizeof(stratus_tetra_arguments) == STRATUS_ARGUMENTS_BYTES ? 1 : -1];
typedef char stratus_rects_agree[sizeof(stratus_tetra_rect) == 12 ? 1 : -1];
#endif

/* The kernels' parameters. counts: of each tile rays, segments and pixels drawn again; 0 before. wrong: the number of pixels to be drawn
 * again, 0 before, then these pixels, PROJECT_TILE^2 times their tile plus their place in it; used only where a packet is one ray. */
#define PARAMETERS                                                                                                                         \
  __constant stratus_tetra_arguments *a, __global const int *vertices, __global const float *cell_values, __global const int *sums,        \
    __global const float *colors, __global const float *points, __global const float *lines, __global const float *ends,                   \
    __global const stratus_tetra_rect *rects, __global const uint *bin_begin, __global const uint *bins, __global float *rgba,             \
    __global uchar *rgba8, __global float *depth, __global uint *samples, __global uint *counts, __global uint *wrong
#define VIEW                                                                                                                               \
  {                                                                                                                                        \
    .vertices = vertices, .points = points, .cell_values = cell_values, .sums = sums, .colors = colors, .lines = lines, .ends = ends,      \
    .rects = rects, .bin_begin = bin_begin, .bins = bins, .picture = {                                                                     \
      rgba,                                                                                                                                \
      rgba8,                                                                                                                               \
      depth,                                                                                                                               \
      samples                                                                                                                              \
    }                                                                                                                                      \
  }

static void add_counts(__global uint* counts, int tile, const stratus_project_found* found)
{
  if (found->segments > 0) {
    atomic_add(counts + 3 * (size_t)tile, found->rays);
    atomic_add(counts + 3 * (size_t)tile + 1, found->segments);
  }
  if (found->again > 0) {
    atomic_add(counts + 3 * (size_t)tile + 2, found->again);
  }
}

#if STRATUS_WIDTH == 16
static int tile_count(__constant stratus_tetra_arguments* a)
{
  return (a->picture.width + PROJECT_TILE - 1) / PROJECT_TILE * ((a->picture.height + PROJECT_TILE - 1) / PROJECT_TILE);
}

PACKET_KERNEL void tetra_project(PARAMETERS)
{
  const stratus_project_view view = VIEW;
  const int tile = (int)get_global_id(0);
  stratus_project_found found;
  (void)wrong;
  if (tile < tile_count(a)) {
    draw_tile(&view, a, tile, &found);
    add_counts(counts, tile, &found);
  }
}
#else
/* A group's square of pixels, SQUARE on a side: one item a pixel, and one a cell. */
#define SQUARE 8
#define SQUARES (PROJECT_TILE / SQUARE) /* along a tile's edge */
#define GROUP (SQUARE * SQUARE)
#define NO_CELL 0xffffffffu

/* A cell that some pixel of the square may meet. */
typedef struct group_cell {
  one_cell planes;
  uint number; /* NO_CELL: none */
} group_cell;

/* The cell of this item, of those that the group reads together. x, y: the square's first pixel in the tile. */
static void find_cell(
  const stratus_project_view* view, __constant stratus_tetra_arguments* a, int tile, uint number, int x, int y, __local group_cell* out)
{
  const stratus_tetra_rect rect = view->rects[number];
  const int cell = (int)number;
  project_tile t;
  begin_tile(&t, view, a, tile, 0);
  x += t.x0;
  y += t.y0;
  out->number = NO_CELL;
  if (rect.x0 < x + SQUARE && rect.x1 >= x && rect.y0 < y + SQUARE && rect.y1 >= y) {
    cell_planes planes;
    one_cell own;
    find_planes(&t, &cell, &planes);
    take_cell(&t, &planes, 0, &own);
    out->planes = own;
    out->number = number;
  }
}

/* Draw the cells that the group has found. pixel: the state of this item's pixel. Only this state is kept across barriers, and the rest of
 * the tile is made again: PoCL 3.1 mixes up the items' copies of so large a structure. */
static void draw_found(const stratus_project_view* view, __constant stratus_tetra_arguments* a, int tile, int place,
  __local const group_cell* cells, uint count, tile_pixel* pixel)
{
  project_tile t;
  begin_tile(&t, view, a, tile, place);
  resume_pixel(&t, pixel);
  for (uint i = 0; i < count; ++i) {
    const uint number = cells[i].number;
    if (number != NO_CELL) {
      const one_cell planes = cells[i].planes;
      if (planes.fronts == 0) {
        draw_any_cell(&t, number);
      } else {
        draw_taken(&t, &planes, number);
      }
    }
  }
  *pixel = t.pixels[0];
}

PACKET_KERNEL __attribute__((reqd_work_group_size(GROUP, 1, 1))) void tetra_project(PARAMETERS)
{
  __local group_cell cells[GROUP];
  const int group = (int)get_group_id(0), item = (int)get_local_id(0), tile = group / (SQUARES * SQUARES);
  const int x = group % SQUARES * SQUARE, y = group / SQUARES % SQUARES * SQUARE;
  const int place = (y + item / SQUARE) * PROJECT_TILE + x + item % SQUARE;
  tile_pixel pixel = empty_pixel(a);
  for (uint begin = bin_begin[tile], end = bin_begin[tile + 1]; begin < end; begin += GROUP) {
    const stratus_project_view view = VIEW;
    const uint left = end - begin, count = left < GROUP ? left : GROUP;
    if ((uint)item < count) {
      find_cell(&view, a, tile, bins[begin + (uint)item], x, y, cells + item);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    draw_found(&view, a, tile, place, cells, count, &pixel);
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  barrier(CLK_LOCAL_MEM_FENCE); /* PoCL 6 else branches for the whole group as its first item does */
  if (pixel.wrong) {
    wrong[1 + atomic_inc(wrong)] = (uint)(PROJECT_TILE * PROJECT_TILE * tile + place);
  } else {
    const stratus_project_view view = VIEW;
    stratus_project_found found;
    project_tile t;
    begin_tile(&t, &view, a, tile, place);
    t.pixels[0] = pixel;
    store_tile(&t, &found);
    add_counts(counts, tile, &found);
  }
}

/* One item does one pixel of the list. */
PACKET_KERNEL void tetra_project_again(PARAMETERS)
{
  const stratus_project_view view = VIEW;
  const uint item = (uint)get_global_id(0);
  if (item < wrong[0]) {
    const int tile = (int)(wrong[1 + item] / (PROJECT_TILE * PROJECT_TILE)), pixel = (int)(wrong[1 + item] % (PROJECT_TILE * PROJECT_TILE));
    stratus_project_found found;
    project_tile t;
    begin_tile(&t, &view, a, tile, pixel);
    t.pixels[0].wrong = 1;
    draw_again(&t, bins + bin_begin[tile], bin_begin[tile + 1] - bin_begin[tile]);
    store_tile(&t, &found);
    add_counts(counts, tile, &found);
  }
}
#endif
