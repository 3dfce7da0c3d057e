/* SPDX-License-Identifier: BSD-3-Clause
 * Kinds of modes, and options that several of them ask. */
#ifndef STRATUS_RAY_MODE_H
#define STRATUS_RAY_MODE_H

#include "stratus/ray_cast.h"

#include <stdbool.h>

/* Whether rays keep the largest or smallest value, or a sum or mean. */
bool stratus_mode_is_extreme(stratus_mode mode);
bool stratus_mode_is_sum(stratus_mode mode);
/* Returns the distance over which the table's opacity accumulates: the sample distance in mode COMPOSITE. Other modes use alpha as given,
 * so theirs is the unit distance. */
double stratus_ray_modes_table_distance(stratus_mode mode, const stratus_transfer* transfer, double sample_distance);
/* Whether gradients take clipped_value in place of values that clip planes hide. */
bool stratus_ray_clips_gradients(const stratus_ray_cast_options* options);

#endif
