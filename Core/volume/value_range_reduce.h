/* SPDX-License-Identifier: BSD-3-Clause
 * Value ranges of blocks from a volume's values, on the host. */
#ifndef STRATUS_VALUE_RANGE_REDUCE_H
#define STRATUS_VALUE_RANGE_REDUCE_H

#include "look_sample.h"
#include "volume.h"

/* Sets the ranges of all blocks by all values. sample: NULL, or a coarse copy that is made of them, too. */
stratus_status stratus_value_range_reduce(
  stratus_context* context, const stratus_volume* volume, stratus_value_range* ranges, const stratus_look_sample* sample);

/* Sets all blocks to no values, and widens one by a range of values. */
void stratus_value_range_begin_blocks(const stratus_value_range* ranges);
void stratus_value_range_widen(const stratus_value_range* ranges, int64_t block, float lo, float hi, uint8_t gap);

#endif
