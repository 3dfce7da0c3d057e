/* SPDX-License-Identifier: BSD-3-Clause
 * The stretches of a transfer function whose opacity is constant between vertical steps, such as windows and label maps. */
#ifndef STRATUS_TABLE_STRETCHES_H
#define STRATUS_TABLE_STRETCHES_H

#include "volume.h"
#include "transfer_pieces.h"

/* A stretch has the values from `begin` to the next stretch's. Its opacity is constant and its colour linear. Kernels read these bytes as
 * table_stretch (transfer_table.h), with an optical depth for the opacity. */
typedef struct stratus_table_stretch {
  float begin, opacity;
  float color[3], slope[3]; /* colour at `begin`, and its change per value */
} stratus_table_stretch;

/* Gives the stretches of the values lo..hi in ascending order, and one more that only ends the last. *count: 0 if the function has other
 * opacities, is opaque somewhere, has too many stretches, or if its values are not the floats that rays read. The caller releases
 * *stretches. */
stratus_status stratus_table_stretches_create(stratus_context* context, const stratus_pieces* pieces, const stratus_table_values* values,
  stratus_table_stretch** stretches, int* count);

#endif
