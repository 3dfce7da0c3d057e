/* SPDX-License-Identifier: BSD-3-Clause
 * Copies of transfer functions, which structures keep after the call, and their comparison with the functions of the next call. */
#include "volume.h"

#include <string.h>

bool stratus_transfer_same_opacity(const stratus_transfer* a, const stratus_transfer* b)
{
  return a->opacity_count == b->opacity_count && a->clamp == b->clamp &&
    memcmp(a->opacity, b->opacity, 2 * sizeof(double) * a->opacity_count) == 0;
}

bool stratus_transfer_same_table(const stratus_transfer* a, const stratus_transfer* b)
{
  return stratus_transfer_same_opacity(a, b) && a->unit_distance == b->unit_distance && a->color_count == b->color_count &&
    memcmp(a->color, b->color, 4 * sizeof(double) * a->color_count) == 0;
}

bool stratus_transfer_same(const stratus_transfer* a, const stratus_transfer* b)
{
  return stratus_transfer_same_table(a, b) && a->weight == b->weight && a->gradient_count == b->gradient_count &&
    (a->gradient_count == 0 || memcmp(a->gradient, b->gradient, 2 * sizeof(double) * a->gradient_count) == 0);
}

static const double* copy_points(double** end, const double* points, size_t count)
{
  double* kept = *end;
  if (count > 0) {
    memcpy(kept, points, count * sizeof *points);
  }
  *end += count;
  return kept;
}

stratus_status stratus_transfer_copy(stratus_context* context, const stratus_transfer* transfers, int count, stratus_transfer** copy)
{
  /* The allocation holds the functions, then the points of each: opacity, colour, gradient opacity. */
  const size_t first = ((size_t)count * sizeof *transfers + sizeof(double) - 1) / sizeof(double);
  size_t numbers = first;
  void* memory = NULL;
  for (int i = 0; i < count; ++i) {
    numbers += 2 * transfers[i].opacity_count + 4 * transfers[i].color_count + 2 * transfers[i].gradient_count;
  }
  TRY(stratus_allocate(context, numbers, sizeof(double), &memory));
  stratus_transfer* const kept = memory;
  double* end = (double*)memory + first;
  for (int i = 0; i < count; ++i) {
    kept[i] = transfers[i];
    kept[i].opacity = copy_points(&end, transfers[i].opacity, 2 * transfers[i].opacity_count);
    kept[i].color = copy_points(&end, transfers[i].color, 4 * transfers[i].color_count);
    kept[i].gradient = copy_points(&end, transfers[i].gradient, 2 * transfers[i].gradient_count);
  }
  *copy = kept;
  return STRATUS_OK;
}
