/* SPDX-License-Identifier: BSD-3-Clause
 * The hidden bytes: the mask, then the cells that ghosts hide. */
#ifndef STRATUS_RAY_MASK_H
#define STRATUS_RAY_MASK_H

#include "stratus/ray_cast.h"
#include "ray_field.h"

/* Makes the bytes of cells that ghosts hide; NULL if there are none. by_value: cells are centred on values. */
stratus_status stratus_ray_hidden_make(stratus_context* context, const stratus_volume* volume, bool by_value, uint8_t** hidden);
/* Whether field->hidden was made from this mask. */
bool stratus_ray_mask_same(const stratus_ray_field* field, const stratus_ray_cast_options* options);
/* Puts the mask (NULL: none) before the bytes of cells (NULL: none). *hides: HIDDEN_* of the result. */
stratus_status stratus_ray_mask_join(
  stratus_context* context, const stratus_volume* volume, const uint8_t* mask, bool labels, bool by_value, uint8_t** hidden, int* hides);
/* The number of cell bytes that traversal reads. */
size_t stratus_ray_hidden_cells(const stratus_volume* volume, bool by_value);

#endif
