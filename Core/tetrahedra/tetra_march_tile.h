/* SPDX-License-Identifier: BSD-3-Clause
 * Marches a tile of rays on the host: kernels/tetrahedra/tetra_tile.h compiled for one instruction set, STRATUS_ISA, and one variant,
 * TETRA_LIT, as the function TETRA_TILE_NAME. */
#ifndef STRATUS_TETRA_MARCH_TILE_H
#define STRATUS_TETRA_MARCH_TILE_H

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-function" /* this file uses only some of the headers' functions */
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized" /* a passage has its points' numbers in mode hits, and no other mode reads them */
#endif
#endif

#include "tetra_march_view.h"

void TETRA_TILE_NAME(const stratus_tetra_frame* frame, int tile, bool counting, stratus_tetra_counts* counts)
{
  const stratus_tetra_view view = tetra_view_of(frame);
  uint32_t filled[TETRA_PIXELS];
  uint32_t* first = frame->first + (size_t)tile * TETRA_PIXELS;
  if (counting) {
    find_entries(&view, &frame->arguments, tile, 0, TETRA_PIXELS, 1, first);
    return;
  }
  if (first[0] < first[TETRA_PIXELS]) {
    find_entries(&view, &frame->arguments, tile, 0, TETRA_PIXELS, 0, filled);
  }
  const stratus_tetra_found found = draw_tile(&view, &frame->arguments, tile, 0, TETRA_PIXELS);
  counts->rays += found.rays;
  counts->entries += found.entries;
  counts->segments += found.segments;
  counts->stuck += found.stuck;
}

#endif
