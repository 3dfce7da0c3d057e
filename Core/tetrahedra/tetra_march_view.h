/* SPDX-License-Identifier: BSD-3-Clause
 * A frame of tetrahedra as the march's kernels read it on the host. */
#ifndef STRATUS_TETRA_MARCH_VIEW_H
#define STRATUS_TETRA_MARCH_VIEW_H

#include "tetra_march_frame.h"

#include "tetra_tile.h"

INLINE stratus_tetra_view tetra_view_of(const stratus_tetra_frame* frame)
{
  return (stratus_tetra_view){ .scene = { frame->cells, frame->places, frame->march_sums, frame->cell_values, frame->gradients,
                                 frame->factors, frame->components, frame->media, frame->table->rgba, frame->lights },
    .lines = frame->us,
    .ends = frame->ends,
    .faces = (const int32_t*)frame->faces,
    .bin_begin = frame->bin_begin,
    .bins = frame->bins,
    .first = frame->first,
    .entries = frame->entries,
    .picture = { frame->image.rgba, frame->image.rgba8, frame->image.depth, frame->image.samples } };
}

#endif
