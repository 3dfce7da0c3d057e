/* SPDX-License-Identifier: BSD-3-Clause
 * Masks: values that a byte each takes out of the picture, beside the cells that are hidden. */
#include "ray_caster.h"

#include <string.h>

bool stratus_ray_mask_same(const stratus_ray_caster* caster, const stratus_ray_cast_options* options)
{
  const bool labels = (caster->hides & HIDDEN_LABELS) != 0;
  return caster->mask == options->mask && labels == (options->mask && options->label_count > 0) && (!options->mask || caster->mask_revision == options->mask_revision);
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

stratus_status stratus_ray_mask_join(
  stratus_context* context, const stratus_volume* volume, const uint8_t* mask, bool labels, bool by_value, uint8_t** hidden,
  int* hides)
{
  const int64_t* n = volume->dimensions;
  const size_t values = (size_t)n[0] * (size_t)n[1] * (size_t)n[2], cells = *hidden ? stratus_ray_hidden_cells(volume, by_value) : 0;
  void* memory = NULL;
  *hides = *hidden ? HIDDEN_CELLS : 0;
  if (!mask) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(context, values + cells, 1, &memory)); /* fits: the volume's values do, and take as much at least */
  memcpy(memory, mask, values);
  if (cells > 0) {
    memcpy((uint8_t*)memory + values, *hidden, cells);
  }
  stratus_release(context, *hidden);
  *hidden = memory;
  *hides |= labels ? HIDDEN_LABELS : HIDDEN_BY_MASK;
  return STRATUS_OK;
}
