/* SPDX-License-Identifier: BSD-3-Clause
 * The archipelago: clouds of particles whose sizes and densities differ by orders of magnitude, scattered over a cube that is mostly
 * empty. Particles are counted voxel by voxel. */
#ifndef STRATUS_SCENES_ARCHIPELAGO_H
#define STRATUS_SCENES_ARCHIPELAGO_H

#include "base.h"

#define ARCHIPELAGO_LONGEST 4096 /* voxels along an axis of the set */
#define ARCHIPELAGO_SIDE 1024    /* of the volume */

/* List the voxels of the archipelago, or only of its islets, that hold a particle, in the order of a volume's values. */
stratus_status stratus_archipelago_list(stratus_context* context, bool of_islets, int32_t** positions, size_t* count);
/* Fills the volume: 0 in voxels without a particle, more with each one, at most 255. */
stratus_status stratus_archipelago_fill(stratus_context* context, uint8_t* values);

#endif
