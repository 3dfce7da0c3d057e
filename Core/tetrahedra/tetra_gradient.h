/* SPDX-License-Identifier: BSD-3-Clause
 * Gradients at the points of a mesh, for light and gradient opacity. */
#ifndef STRATUS_TETRA_GRADIENT_H
#define STRATUS_TETRA_GRADIENT_H

#include "tetra_cells.h"

/* Fills *gradients from the values of a mesh whose form for rays is `tetra`. mask: bit c where component c's are wanted. The caller
 * releases gradients->vectors, also after a failure. */
stratus_status stratus_tetra_gradients_create(
  const stratus_tetra_mesh* tetra, const stratus_mesh* mesh, unsigned mask, stratus_tetra_gradients* gradients);

/* tetra_seams.c: replace the sums of points of several lattices that are in one place and have one value by the sum over all these points,
 * four numbers for each point. values: of points; NULL: only the place counts. */
stratus_status stratus_tetra_join_sums(const stratus_tetra_cells* cells, const float* values, double* sums);

#endif
