/* SPDX-License-Identifier: BSD-3-Clause
 * Gradients at the points of a mesh, for light and gradient opacity. */
#ifndef STRATUS_TETRA_GRADIENT_H
#define STRATUS_TETRA_GRADIENT_H

#include "tetra_caster.h"

/* Fills *gradients from the values of a mesh whose form for rays is `tetra`. The caller releases gradients->vectors. */
stratus_status stratus_tetra_gradients_create(
  const stratus_tetra_mesh* tetra, const stratus_mesh* mesh, stratus_tetra_gradients* gradients);

#endif
