/* SPDX-License-Identifier: BSD-3-Clause
 * A hash of a volume's content, of 64 bits. */
#ifndef STRATUS_VOLUME_HASH_H
#define STRATUS_VOLUME_HASH_H

#include "volume.h"

/* Computes the hash of values (not the stride between them), type, dimensions, centring and ghost flags. */
stratus_status stratus_volume_hash(stratus_context* context, const stratus_volume* volume, uint64_t* hash);

/* Returns row (j, k) of the values, contiguous: in place, or gathered into `room`, which holds dimensions[0] values, if they are
 * strided. */
const void* stratus_volume_row(const stratus_volume* volume, int64_t j, int64_t k, void* room);
/* Return the parts of a volume's hash, which is the sum of its rows' hashes, in any order, and its shape's. `row` comes from
 * stratus_volume_row(). */
uint64_t stratus_volume_hash_row(const stratus_volume* volume, int64_t j, int64_t k, const void* row);
uint64_t stratus_volume_hash_shape(const stratus_volume* volume);

#endif
