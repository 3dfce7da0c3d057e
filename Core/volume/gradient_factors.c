/* SPDX-License-Identifier: BSD-3-Clause
 * Samples gradient opacities. */
#include "gradient_factors.h"

#include <float.h>
#include <math.h>

float stratus_gradient_factors(const stratus_transfer* transfer, float out[STRATUS_SHADING_FACTORS + 2])
{
  const stratus_transfer function = { .opacity = transfer->gradient,
    .opacity_count = transfer->gradient_count,
    .color = transfer->color,
    .color_count = transfer->color_count,
    .clamp = 1 };
  const double most = transfer->gradient[2 * (transfer->gradient_count - 1)];
  for (int e = 0; out && e < STRATUS_SHADING_FACTORS + 2; ++e) {
    const int at = e < STRATUS_SHADING_FACTORS ? e : STRATUS_SHADING_FACTORS;
    double rgba[4];
    stratus_transfer_at(&function, most > 0.0 ? most * at / STRATUS_SHADING_FACTORS : most, rgba);
    out[e] = (float)rgba[3];
  }
  return most > 0.0 ? (float)fmin(STRATUS_SHADING_FACTORS / most, (double)FLT_MAX) : 0.0f;
}
