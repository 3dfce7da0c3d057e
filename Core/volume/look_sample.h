/* SPDX-License-Identifier: BSD-3-Clause
 * A sample of a large volume's values, for guesses. */
#ifndef STRATUS_LOOK_SAMPLE_H
#define STRATUS_LOOK_SAMPLE_H

#include "volume.h"

/* Whether a volume has so many values that guesses take a sample of them. */
bool stratus_look_samples(const stratus_volume* volume);
/* Make a coarser volume of every so manieth value of the first component, in the same place. The caller releases *memory. */
stratus_status stratus_look_sample_make(stratus_context* context, const stratus_volume* volume, stratus_volume* sample, void** memory);

#endif
