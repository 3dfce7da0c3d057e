/* SPDX-License-Identifier: BSD-3-Clause
 * How much heights of flat data are exaggerated. */
#include "stratus/look.h"

#include <math.h>
#include <stddef.h>

#define FLAT 0.1
#define HEIGHT_BY_WIDTH 0.2

double stratus_look_height_factor(const double bounds[6], int up)
{
  if (!bounds || up < 0 || up > 2) {
    return 1.0;
  }
  double extents[3];
  for (int a = 0; a < 3; ++a) {
    extents[a] = bounds[2 * a + 1] - bounds[2 * a];
  }
  const double height = extents[up], width = fmax(extents[(up + 1) % 3], extents[(up + 2) % 3]);
  const double factor = HEIGHT_BY_WIDTH * width / height;
  if (!(height > 0.0) || !isfinite(factor) || height >= FLAT * width) {
    return 1.0;
  }
  const double digit = pow(10.0, floor(log10(factor)) - 1.0); /* of the second digit */
  return round(factor / digit) * digit;
}
