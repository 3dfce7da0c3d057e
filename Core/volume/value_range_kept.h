/* SPDX-License-Identifier: BSD-3-Clause
 * Value ranges that are kept in the cache's folder, for volumes with an identity and without ghosts. */
#ifndef STRATUS_VALUE_RANGE_KEPT_H
#define STRATUS_VALUE_RANGE_KEPT_H

#include "volume.h"

/* Fills `ranges`, which has its shape, from the file that an earlier call kept of the volume. Returns false, and
 * nothing is changed, where nothing is kept. */
bool stratus_value_range_recall(const stratus_volume* volume, stratus_value_range* ranges);
void stratus_value_range_keep(const stratus_volume* volume, const stratus_value_range* ranges);

#endif
