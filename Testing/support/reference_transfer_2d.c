/* SPDX-License-Identifier: BSD-3-Clause
 * Functions of two variables of the reference renderer, in doubles, from the contract of stratus_transfer_2d. */
#include "reference_shading.h"

#include <math.h>

/* Returns where a number lies among the entries of an axis: the entry before it, and in *part the way to the next. */
static int entry_at(const double range[2], int entries, bool nearest, double number, double* part)
{
  const double place = fmin(fmax((number - range[0]) / (range[1] - range[0]) * entries - 0.5, 0.0), entries - 1);
  const int entry = (int)floor(place);
  *part = nearest ? (place - entry < 0.5 ? 0.0 : 1.0) : place - entry;
  return entry;
}

void reference_transfer_2d(const stratus_transfer_2d* of, bool nearest, double value, double second, double rgba[4])
{
  double across, up;
  const int column = entry_at(of->value_range, of->columns, nearest, value, &across),
            row = entry_at(of->second_range, of->rows, nearest, second, &up);
  for (int c = 0; c < 4; ++c) {
    rgba[c] = 0.0;
    for (int corner = 0; corner < 4; ++corner) {
      const int right = corner & 1, above = corner >> 1;
      const int i = column + right < of->columns ? column + right : column, j = row + above < of->rows ? row + above : row;
      rgba[c] += (right ? across : 1.0 - across) * (above ? up : 1.0 - up) * (double)of->rgba[4 * (j * of->columns + i) + c];
    }
  }
}
