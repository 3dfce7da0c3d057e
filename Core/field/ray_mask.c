/* SPDX-License-Identifier: BSD-3-Clause
 * Builds the hidden bytes: a mask byte for each value, and a byte for each hidden cell. */
#include "ray_mask.h"

#include <string.h>

bool stratus_ray_mask_same(const stratus_ray_field* field, const stratus_ray_cast_options* options)
{
  const bool labels = (field->hides & HIDDEN_LABELS) != 0;
  return field->mask == options->mask.bytes && labels == (options->mask.bytes && options->mask.label_count > 0) &&
    (!options->mask.bytes || field->mask_revision == options->mask.revision);
}

size_t stratus_ray_hidden_cells(const stratus_volume* volume, bool by_value)
{
  size_t cells = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const size_t n = (size_t)volume->dimensions[axis];
    cells *= by_value ? n : n > 1 ? n - 1 : 1;
  }
  return cells;
}

/* Converts bytes of values to bytes of the cells between them. Interpolation reads eight values, so any hidden one hides the cell. */
static stratus_status spread_hidden(stratus_context* context, const stratus_volume* volume, uint8_t** hidden)
{
  size_t cells[3], total;
  void* memory = NULL;
  for (int axis = 0; axis < 3; ++axis) {
    cells[axis] = volume->dimensions[axis] > 1 ? (size_t)volume->dimensions[axis] - 1 : 1;
  }
  TRY(stratus_product(context, "cells", cells[0], cells[1], cells[2], &total));
  TRY(stratus_allocate(context, total, 1, &memory));
  uint8_t* spread = memory;
  const size_t nx = (size_t)volume->dimensions[0], ny = (size_t)volume->dimensions[1], nz = (size_t)volume->dimensions[2];
  for (size_t cell = 0; cell < total; ++cell) {
    const size_t i = cell % cells[0], j = cell / cells[0] % cells[1], k = cell / cells[0] / cells[1];
    uint8_t any = 0;
    for (size_t corner = 0; corner < 8; ++corner) {
      const size_t x = i + (corner & 1), y = j + (corner >> 1 & 1), z = k + (corner >> 2);
      any |= x < nx && y < ny && z < nz ? (*hidden)[(z * ny + y) * nx + x] : 0;
    }
    spread[cell] = any;
  }
  stratus_release(context, *hidden);
  *hidden = spread;
  return STRATUS_OK;
}

stratus_status stratus_ray_hidden_make(stratus_context* context, const stratus_volume* volume, bool by_value, uint8_t** hidden)
{
  TRY(stratus_volume_hidden_cells(context, volume, hidden));
  return *hidden && volume->cell_centered && !by_value ? spread_hidden(context, volume, hidden) : STRATUS_OK;
}

stratus_status stratus_ray_mask_join(
  stratus_context* context, const stratus_volume* volume, const uint8_t* mask, bool labels, bool by_value, uint8_t** hidden, int* hides)
{
  const int64_t* n = volume->dimensions;
  const size_t values = (size_t)n[0] * (size_t)n[1] * (size_t)n[2], cells = *hidden ? stratus_ray_hidden_cells(volume, by_value) : 0;
  void* memory = NULL;
  *hides = *hidden ? HIDDEN_CELLS : 0;
  if (!mask) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(context, values + cells, 1, &memory)); /* cannot overflow: cells <= values, whose bytes fit in memory */
  memcpy(memory, mask, values);
  if (cells > 0) {
    memcpy((uint8_t*)memory + values, *hidden, cells);
  }
  stratus_release(context, *hidden);
  *hidden = memory;
  *hides |= labels ? HIDDEN_LABELS : HIDDEN_BY_MASK;
  return STRATUS_OK;
}
