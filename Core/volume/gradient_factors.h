/* SPDX-License-Identifier: BSD-3-Clause
 * Gradient opacity as rays read it. */
#ifndef STRATUS_GRADIENT_FACTORS_H
#define STRATUS_GRADIENT_FACTORS_H

#include "volume.h"

/* Steps of a sampled gradient opacity, which is linear between them. */
#define STRATUS_SHADING_FACTORS 4096

/* Sample a transfer function's gradient opacity from magnitude 0 to the function's last point: out receives the factor at each step, and
 * the last one twice more. out may be NULL. Returns the number of steps in a unit of magnitude, 0 if the last point is at 0. */
float stratus_gradient_factors(const stratus_transfer* transfer, float out[STRATUS_SHADING_FACTORS + 2]);

#endif
