/* SPDX-License-Identifier: BSD-3-Clause
 * The surface of a slice: scalars of four bytes only, the same bytes on host and device. */
#ifndef STRATUS_SLICE_ARGUMENTS_H
#define STRATUS_SLICE_ARGUMENTS_H

#include "real.h"

/* A surface where a function of second degree is 0. With d = x - center, in the coordinates of rays, the function is the sum of
 * square[0..2] times dx dx, dy dy, dz dz, of square[3..5] times dx dy, dy dz, dx dz, of linear times d, and of level. */
typedef struct stratus_slice_arguments {
  stratus_pair center[3], square[6], linear[3], level;
} stratus_slice_arguments;

#endif
