/* SPDX-License-Identifier: BSD-3-Clause
 * The march through tetrahedra on a device. Where STRATUS_WIDTH is 16 (a CPU) a work item does a tile of pixels in packets, as the host
 * does; else (a GPU) it does one pixel. The kernel tetra_count counts the faces by which each ray enters. The host turns counts into
 * places, and the kernel tetra_march sorts the entries into them and marches; tetra_find only sorts them, where another kernel marches. */
#ifndef STRATUS_DEVICE
#define STRATUS_DEVICE 1
#endif
#ifndef STRATUS_WIDTH
#define STRATUS_WIDTH 1
#endif

#include "tetra_tile.h"

#ifdef STRATUS_ARGUMENTS_BYTES
/* An array of negative size, which does not compile, where the host lays the arguments out otherwise. */
typedef char stratus_arguments_agree[sizeof(stratus_tetra_arguments) == STRATUS_ARGUMENTS_BYTES ? 1 : -1];
#endif

/* The tile of this work item, and which of its pixels; false: beyond the picture. */
static bool my_pixels(__constant stratus_tetra_arguments* a, int* tile, int* from, int* beyond)
{
  const int x = (int)get_global_id(0), y = (int)get_global_id(1);
#if STRATUS_WIDTH == 1
  const int column = x / TETRA_PIXELS;
  *from = x % TETRA_PIXELS;
  *beyond = *from + 1;
#else
  const int column = x;
  *from = 0;
  *beyond = TETRA_PIXELS;
#endif
  *tile = y * a->columns + column;
  return column < a->columns && y * TETRA_TILE < a->picture.height;
}

PACKET_KERNEL void tetra_count(__constant stratus_tetra_arguments* a, __global const float* points, __global const float* lines,
  __global const int* faces, __global const uint* bin_begin, __global const int* bins, __global uint* found)
{
  const stratus_tetra_view view = { .scene = { .points = points }, .lines = lines, .faces = faces, .bin_begin = bin_begin, .bins = bins };
  int tile, from, beyond;
  if (my_pixels(a, &tile, &from, &beyond)) {
    find_entries(&view, a, tile, from, beyond, 1, found + TETRA_PIXELS * (size_t)tile);
  }
}

/* found: scratch memory, a number for each pixel of the tiles. */
PACKET_KERNEL void tetra_find(__constant stratus_tetra_arguments* a, __global const float* points, __global const float* lines,
  __global const int* faces, __global const uint* bin_begin, __global const int* bins, __global const uint* first, __global int* entries,
  __global uint* found)
{
  const stratus_tetra_view view = {
    .scene = { .points = points }, .lines = lines, .faces = faces, .bin_begin = bin_begin, .bins = bins, .first = first, .entries = entries
  };
  int tile, from, beyond;
  if (my_pixels(a, &tile, &from, &beyond)) {
    find_entries(&view, a, tile, from, beyond, 0, found + TETRA_PIXELS * (size_t)tile);
  }
}

/* found: as of tetra_find. counts: of each tile rays, entries, segments and stuck rays; 0 before. */
PACKET_KERNEL void tetra_march(
  __constant stratus_tetra_arguments* a, __global const int* cells, __global const float* cell_values, __global const int* sums,
  __global const float* colors, __global const float* points, __global const float* lines, __global const float* ends,
  __global const int* faces, __global const uint* bin_begin, __global const int* bins, __global const uint* first, __global int* entries,
  __global uint* found, __global float* rgba, __global uchar* rgba8, __global float* depth, __global uint* samples, __global uint* counts
#if TETRA_LIT
  ,
  __global const float* gradients, __global const float* factors, __global const float* components, __global const int* media,
  __global const int* lights
#endif
)
{
#if !TETRA_LIT
  __global const float *gradients = 0, *factors = 0, *components = 0;
  __global const int *media = 0, *lights = 0;
#endif
  const stratus_tetra_view view = { .scene = { cells, points, sums, cell_values, gradients, factors, components, media, colors, lights },
    .lines = lines,
    .ends = ends,
    .faces = faces,
    .bin_begin = bin_begin,
    .bins = bins,
    .first = first,
    .entries = entries,
    .picture = { rgba, rgba8, depth, samples } };
  int tile, from, beyond;
  if (my_pixels(a, &tile, &from, &beyond)) {
    find_entries(&view, a, tile, from, beyond, 0, found + TETRA_PIXELS * (size_t)tile);
    const stratus_tetra_found mine = draw_tile(&view, a, tile, from, beyond);
    __global uint* sum = counts + 4 * (size_t)tile;
    atomic_add(sum, mine.rays);
    atomic_add(sum + 1, mine.entries);
    atomic_add(sum + 2, mine.segments);
    atomic_add(sum + 3, mine.stuck);
  }
}
