/* SPDX-License-Identifier: BSD-3-Clause
 * Sorting of many keys. */
#ifndef STRATUS_RADIX_SORT_H
#define STRATUS_RADIX_SORT_H

#include "base.h"

/* Stable sort of keys, of which only the lowest `bits` may be set, and their values. */
stratus_status stratus_radix_sort(stratus_context* context, uint64_t* keys, uint32_t* values, uint32_t count, int bits);

#endif
