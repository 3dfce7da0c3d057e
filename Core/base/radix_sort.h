/* SPDX-License-Identifier: BSD-3-Clause
 * Sorts many keys, and their values with them. */
#ifndef STRATUS_RADIX_SORT_H
#define STRATUS_RADIX_SORT_H

#include "base.h"

/* Sorts keys by their lowest `bits`, 64 or fewer, and their values; equal ones keep their order. Many keys with values are sorted on the
 * context's device if it builds, to the same order; only the lowest `bits` of such keys may be set. values may be NULL. */
stratus_status stratus_radix_sort(stratus_context* context, uint64_t* keys, uint32_t* values, uint32_t count, int bits);

/* ---- radix_sort_device.c */
bool stratus_radix_sort_on_device(const stratus_context* context, uint32_t count);
/* Where it fails, keys and values are unchanged. */
stratus_status stratus_device_radix_sort(stratus_context* context, uint64_t* keys, uint32_t* values, uint32_t count, int bits);

#endif
