/* SPDX-License-Identifier: BSD-3-Clause
 * Costs of march and projection: the counts of a view, and the time of each count on this machine. */
#ifndef STRATUS_TETRA_COSTS_H
#define STRATUS_TETRA_COSTS_H

#include "tetra_caster.h"

/* The inputs that decide which cells show. */
typedef struct stratus_tetra_shown {
  const stratus_tetra_mesh* tetra;
  const stratus_table* table;
  stratus_tetra_mode mode;
} stratus_tetra_shown;

typedef struct stratus_tetra_view {
  double passed;                 /* cells that rays pass, counted once per ray */
  double shown, pieces, packets; /* cells in view that can show something, their pieces and packets */
} stratus_tetra_view;

/* tetra_view.c: estimates the counts of a view. Returns false if its camera spans no space. */
bool stratus_tetra_count_view(const stratus_tetra_shown* shown, const stratus_mesh* mesh, const stratus_camera* camera,
  const stratus_image* image, stratus_tetra_view* counts);

/* Nanoseconds by all of a context's threads together. March: per cell that a ray passes. Projection: per piece composited, packet of pixels
 * tested, cell in view, cell sorted. */
struct stratus_tetra_costs {
  double segment, piece, packet, cell, sorted;
};

/* tetra_costs.c: copy the costs on this machine with the context's instruction set and threads. They are kept for the process, and three
 * processes measure them before they are read from a file: see calibration.h.
 *
 * They are measured with one mesh: 25 thousand cells of similar size and shape, all of which show, of an opacity that ends no ray, in
 * images of 96 x 96 and 16 x 16 pixels. So they compare the two methods on this machine, and do not predict the time of a view. A mesh of
 * many millions of cells misses the caches more often by either method, and threads share large images more evenly; slivers and rays that
 * end early make the counts themselves less certain. If the two estimates are close, the slower method may be chosen. */
stratus_status stratus_tetra_costs_here(stratus_context* context, stratus_tetra_costs* costs);

#endif
