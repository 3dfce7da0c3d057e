/* SPDX-License-Identifier: BSD-3-Clause
 * Builders of a volume's structures on the context's OpenCL device, for contexts where stratus_device_builds(). Their results equal the
 * host's to the bit. Each fills arrays that its caller allocated. */
#ifndef STRATUS_VOLUME_DEVICE_H
#define STRATUS_VOLUME_DEVICE_H

#include "volume.h"
#include "device.h"

/* True if the device can hold the volume: it fits an allocation, and the device has doubles for wide types. */
bool stratus_device_takes_volume(const stratus_context* context, const stratus_volume* volume);

/* Fills lo, hi and gaps of `ranges`, whose other fields are set. gaps marks only values that are not finite; the caller adds hidden
 * cells. */
stratus_status stratus_device_value_range(stratus_context* context, const stratus_volume* volume, stratus_value_range* ranges);

/* Fills occupied[]. */
stratus_status stratus_device_occupancy(
  stratus_context* context, const stratus_value_range* ranges, const stratus_shown* shown, bool gaps_show, stratus_occupancy* occupancy);

/* True if the running sums, by which the device counts, fit one of its allocations. */
bool stratus_device_takes_blocks(const stratus_context* context, const int64_t blocks[3]);

/* Fills bytes[] except its padding. `kind` must not be STRATUS_DISTANCE_BLOCK. */
stratus_status stratus_device_distance_map(stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_map* map);

#endif
