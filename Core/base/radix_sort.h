/* SPDX-License-Identifier: BSD-3-Clause
 * Sorts many keys with their values. */
#ifndef STRATUS_RADIX_SORT_H
#define STRATUS_RADIX_SORT_H

#include "base.h"

/* Sorts keys and their values; equal keys keep their order. Only the lowest `bits` of a key may be set. Many keys are sorted on the
 * context's device if it builds, to the same order. */
stratus_status stratus_radix_sort(stratus_context* context, uint64_t* keys, uint32_t* values, uint32_t count, int bits);

/* ---- radix_sort_device.c */
bool stratus_radix_sort_on_device(const stratus_context* context, uint32_t count);
/* Where it fails, keys and values are unchanged. */
stratus_status stratus_device_radix_sort(stratus_context* context, uint64_t* keys, uint32_t* values, uint32_t count, int bits);

#endif
