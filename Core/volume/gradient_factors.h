/* SPDX-License-Identifier: BSD-3-Clause
 * Gradient opacity as rays read it. */
#ifndef STRATUS_GRADIENT_FACTORS_H
#define STRATUS_GRADIENT_FACTORS_H

#include "volume.h"

/* Steps of a sampled gradient opacity, which is linear between them. */
#define STRATUS_SHADING_FACTORS 4096

/* Samples the gradient opacity of a transfer function that has one, from magnitude 0 to the function's last point, unless out is NULL: the
 * factor at each step, and the last one twice more. Returns the steps in a unit of magnitude, 0 where the last point lies at 0. */
float stratus_gradient_factors(const stratus_transfer* transfer, float out[STRATUS_SHADING_FACTORS + 2]);

#endif
