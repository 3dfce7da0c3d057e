/* SPDX-License-Identifier: BSD-3-Clause
 * A volume's content in 64 bits. */
#ifndef STRATUS_VOLUME_HASH_H
#define STRATUS_VOLUME_HASH_H

#include "volume.h"

/* Of the values as they are (not the stride between them), type, dimensions, centring and ghost flags. */
stratus_status stratus_volume_hash(stratus_context* context, const stratus_volume* volume, uint64_t* hash);

/* Row (j, k) of the values, contiguous: in place, or gathered into `room` of dimensions[0] values where they are strided. */
const void* stratus_volume_row(const stratus_volume* volume, int64_t j, int64_t k, void* room);
/* A volume's hash is the sum of its rows' (in any order) and of its shape's. `row` as from stratus_volume_row(). */
uint64_t stratus_volume_hash_row(const stratus_volume* volume, int64_t j, int64_t k, const void* row);
uint64_t stratus_volume_hash_shape(const stratus_volume* volume);

#endif
