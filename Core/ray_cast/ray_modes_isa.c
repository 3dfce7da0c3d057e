/* SPDX-License-Identifier: BSD-3-Clause
 * Maxima, minima and sums along rays, compiled for one instruction set, STRATUS_ISA. */
#include "ray_cast_packets.h"

#define STRATUS_PREINTEGRATED 0

#define STRATUS_RAY_MODE STRATUS_RAY_EXTREMES
#define STRATUS_RAY_SET extremes
#include "ray_cast_tiles.h"
#undef STRATUS_RAY_MODE

#define STRATUS_RAY_MODE STRATUS_RAY_SUMS
#define STRATUS_RAY_SET sums
#include "ray_cast_tiles.h"
#undef STRATUS_RAY_MODE

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_modes_tile)(int type, stratus_ray_variant variant)
{
  return variant == STRATUS_VARIANT_ISOSURFACE ? STRATUS_ISA_NAME(stratus_ray_isosurface_tile)(type)
    : variant == STRATUS_VARIANT_CELLS         ? STRATUS_ISA_NAME(stratus_ray_cells_tile)(type)
    : variant == STRATUS_VARIANT_LOCAL         ? STRATUS_ISA_NAME(stratus_ray_local_tile)(type)
    : variant == STRATUS_VARIANT_TRANSFER_2D   ? STRATUS_ISA_NAME(stratus_ray_transfer_2d_tile)(type)
    : variant == STRATUS_VARIANT_SLICE         ? STRATUS_ISA_NAME(stratus_ray_slice_tile)(type)
    : variant == STRATUS_VARIANT_QUANTITIES    ? STRATUS_ISA_NAME(stratus_ray_quantities_tile)(type)
    : variant == STRATUS_VARIANT_SUMS          ? tiles_sums[type + 1]
                                               : tiles_extremes[type + 1];
}
