/* SPDX-License-Identifier: BSD-3-Clause
 * The outline of a cell that reaches behind the eye. The cell is clipped at the near plane, and the rest is projected. */
#include "tetra_project.h"

/* The clipping plane's least depth, in units of the largest coordinate. It is less than a float's rounding of the depth. */
#define NEAREST_CUT 0x1p-30
#define SLACK 1.0 /* pixels */

typedef struct outline {
  double lo[2], hi[2];
} outline;

static void add_point(outline* box, const double p[3])
{
  for (int side = 0; side < 2; ++side) {
    box->lo[side] = fmin(box->lo[side], p[side] / p[2]);
    box->hi[side] = fmax(box->hi[side], p[side] / p[2]);
  }
}

/* Finds the first and last pixel that lo..hi covers; -1..1 spans `pixels`. Returns false if there is none. */
static bool pixel_span(double lo, double hi, int pixels, uint16_t span[2])
{
  const double first = ceil(0.5 * (lo + 1.0) * pixels - 0.5 - SLACK), last = floor(0.5 * (hi + 1.0) * pixels - 0.5 + SLACK);
  if (!(last >= 0.0) || !(first < pixels)) {
    return false;
  }
  span[0] = first > 0.0 ? (uint16_t)first : 0;
  span[1] = (uint16_t)(last < pixels ? last : pixels - 1);
  return true;
}

stratus_tetra_rect stratus_tetra_outline_cut(const stratus_tetra_projection* projection, int64_t cell)
{
  const stratus_tetra_frame* frame = projection->frame;
  const double middle = (double)frame->arguments.middle, shear = (double)frame->arguments.shear;
  const double nearest = fmax(middle + shear * (double)projection->begin, NEAREST_CUT);
  outline box = { { INFINITY, INFINITY }, { -INFINITY, -INFINITY } };
  double p[4][3];
  float near = INFINITY;
  uint16_t x[2], y[2];
  for (int i = 0; i < 4; ++i) {
    const float* point = frame->points + 4 * (size_t)projection->vertices[4 * cell + i];
    near = fminf(near, point[2]);
    p[i][0] = (double)point[0];
    p[i][1] = (double)point[1];
    p[i][2] = middle + shear * (double)point[2];
    if (p[i][2] >= nearest) {
      add_point(&box, p[i]);
    }
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      if (p[i][2] < nearest && p[j][2] > nearest) {
        const double share = (nearest - p[i][2]) / (p[j][2] - p[i][2]);
        const double cut[3] = { p[i][0] + share * (p[j][0] - p[i][0]), p[i][1] + share * (p[j][1] - p[i][1]), nearest };
        add_point(&box, cut);
      }
    }
  }
  if (!pixel_span(box.lo[0], box.hi[0], frame->image.width, x) || !pixel_span(box.lo[1], box.hi[1], frame->image.height, y)) {
    return (stratus_tetra_rect){ 1, 0, 1, 0, 0.0f };
  }
  return (stratus_tetra_rect){ x[0], x[1], y[0], y[1], near };
}
