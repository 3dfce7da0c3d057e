/* SPDX-License-Identifier: BSD-3-Clause
 * Facts of a volume with an identity, kept in the cache's folder for later processes. */
#ifndef STRATUS_VOLUME_KEPT_H
#define STRATUS_VOLUME_KEPT_H

#include "volume.h"

/* Whether anything can be kept of the volume: it has an identity, and no ghosts, and there is a place for the folder. */
bool stratus_kept_is_possible(const stratus_volume* volume);
/* Returns the `size` bytes that an earlier call kept of the volume under the same kind ("ranges") and number, which the caller frees; NULL
 * if there are none, or if the volume has no identity, or ghosts. A file that is damaged or of another size is removed, with a warning. */
uint8_t* stratus_kept_recall(stratus_context* context, const stratus_volume* volume, const char* kind, int64_t number, size_t size);
/* Keeps bytes, and drops those that were used longest ago, so that all bytes of a kind are at most 1 GiB. No failure is an error. */
void stratus_kept_keep(const stratus_volume* volume, const char* kind, int64_t number, const void* bytes, size_t size);

#endif
