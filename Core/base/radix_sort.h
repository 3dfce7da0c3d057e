/* SPDX-License-Identifier: BSD-3-Clause
 * Sorts many keys with their values. */
#ifndef STRATUS_RADIX_SORT_H
#define STRATUS_RADIX_SORT_H

#include "base.h"

/* Sorts keys and their values; equal keys keep their order. Only the lowest `bits` of a key may be set. */
stratus_status stratus_radix_sort(stratus_context* context, uint64_t* keys, uint32_t* values, uint32_t count, int bits);

#endif
