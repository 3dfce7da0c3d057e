/* SPDX-License-Identifier: BSD-3-Clause
 * The hidden bytes: the mask, and cells that ghosts hide. */
#ifndef STRATUS_RAY_MASK_H
#define STRATUS_RAY_MASK_H

#include "stratus/ray_cast.h"
#include "volume.h"

/* The bytes of cells that ghosts hide, NULL: none. */
stratus_status stratus_ray_hidden_make(stratus_context* context, const stratus_volume* volume, bool by_value, uint8_t** hidden);
/* Whether the mask is the one that caster->hidden was made from; and one put before the bytes of cells (NULL: none are hidden). */
bool stratus_ray_mask_same(const stratus_ray_caster* caster, const stratus_ray_cast_options* options);
stratus_status stratus_ray_mask_join(
  stratus_context* context, const stratus_volume* volume, const uint8_t* mask, bool labels, bool by_value, uint8_t** hidden, int* hides);
/* Bytes a cell, as traversal reads them. */
size_t stratus_ray_hidden_cells(const stratus_volume* volume, bool by_value);

#endif
