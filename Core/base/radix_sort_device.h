/* SPDX-License-Identifier: BSD-3-Clause
 * Sorts keys that are on the context's OpenCL device. */
#ifndef STRATUS_RADIX_SORT_DEVICE_H
#define STRATUS_RADIX_SORT_DEVICE_H

#include "device.h"

/* Keys and their values, and room for as many more: each pass moves them from [0] to [1] and exchanges the two. */
typedef struct stratus_device_keys {
  cl_mem keys[2], values[2];
  uint32_t count; /* at least 1 */
} stratus_device_keys;

stratus_status stratus_device_keys_create(stratus_context* context, uint32_t count, stratus_device_keys* keys);
void stratus_device_keys_release(stratus_device_keys* keys);
/* Sorts [0]; equal keys keep their order. Only the lowest `bits` of a key may be set. */
stratus_status stratus_device_keys_sort(stratus_context* context, stratus_device_keys* keys, int bits);

#endif
