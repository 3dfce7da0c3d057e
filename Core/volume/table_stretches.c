/* SPDX-License-Identifier: BSD-3-Clause
 * Divides a transfer function whose opacity is constant between vertical steps into stretches. */
#include "table_stretches.h"

#include <float.h>

/* Most stretches. With more, a ray's path through a cell would be cut at too many of them. */
#define STRETCHES_MOST 64

/* The next point of the opacity or the colours above x; INFINITY if there is none. */
static double next_point(const stratus_pieces* pieces, double x)
{
  const stratus_curve* curves[] = { &pieces->opacity, &pieces->color[0], &pieces->color[1], &pieces->color[2] };
  double next = INFINITY;
  for (int c = 0; c < 4; ++c) {
    const size_t until = stratus_points_until(curves[c]->x, curves[c]->count, x);
    next = until < curves[c]->count ? fmin(next, curves[c]->x[until]) : next;
  }
  return next;
}

/* Sets a stretch that holds the values first..last. Returns false if its opacity is not constant, or 1. */
static bool set_stretch(const stratus_pieces* pieces, const stratus_fetching* fetching, double first, double last, stratus_table_stretch* s)
{
  const double opacity = stratus_curve_at(&pieces->opacity, first), width = last - first;
  s->begin = stratus_fetching_above(fetching, first);
  s->opacity = (float)opacity;
  for (int c = 0; c < 3; ++c) {
    const double color = stratus_curve_at(&pieces->color[c], first);
    const double slope = width > 0.0 ? (stratus_curve_at(&pieces->color[c], last) - color) / width : 0.0;
    s->color[c] = (float)color;
    s->slope[c] = isfinite((float)slope) ? (float)slope : 0.0f;
  }
  return opacity < 1.0 && stratus_curve_at(&pieces->opacity, last) == opacity;
}

/* Whether `next` only continues a stretch. */
static bool continues(const stratus_table_stretch* s, const stratus_table_stretch* next)
{
  bool same = s->opacity == next->opacity;
  for (int c = 0; c < 3 && next->opacity > 0.0f; ++c) {
    same = same && s->slope[c] == next->slope[c] && s->color[c] + s->slope[c] * (next->begin - s->begin) == next->color[c];
  }
  return same;
}

stratus_status stratus_table_stretches_create(
  stratus_context* context, const stratus_pieces* pieces, const stratus_table_values* values, stratus_table_stretch** stretches, int* count)
{
  const stratus_fetching* fetching = &values->fetching;
  const double lo = stratus_fetching_value(fetching, values->lo), hi = stratus_fetching_value(fetching, values->hi);
  void* memory = NULL;
  int used = 0;
  *count = 0;
  if (fetching->wide || values->nearest || values->uniform) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(context, STRETCHES_MOST + 1, sizeof **stretches, &memory));
  *stretches = memory;
  for (double first = lo, next; first <= hi; first = next) {
    stratus_table_stretch s;
    next = next_point(pieces, first);
    if (!set_stretch(pieces, fetching, first, fmin(nextafter(next, -INFINITY), fmax(hi, first)), &s)) {
      return STRATUS_OK;
    }
    if (used > 0 && continues(*stretches + used - 1, &s)) {
      continue;
    }
    if (used == STRETCHES_MOST) {
      return STRATUS_OK;
    }
    (*stretches)[used++] = s;
  }
  (*stretches)[used] = (stratus_table_stretch){ .begin = FLT_MAX };
  *count = used;
  return STRATUS_OK;
}
