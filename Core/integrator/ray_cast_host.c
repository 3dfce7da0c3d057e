/* SPDX-License-Identifier: BSD-3-Clause
 * The table of tile functions: picks the variant and the instruction set. */
#include "ray_cast_host.h"

#include "instruction_set.h"

stratus_ray_cast_tile* stratus_ray_cast_tile_for(int isa, int type, stratus_ray_variant variant)
{
  typedef stratus_ray_cast_tile* tile_of(int type, stratus_ray_variant variant);
  static tile_of* const of_type[] = STRATUS_ISA_EVERY(stratus_ray_cast_tile);
  static stratus_ray_cast_tile* const of_variant[][4] = {
    [STRATUS_VARIANT_EXTREMES] = STRATUS_ISA_EVERY(stratus_ray_extremes_tile),
    [STRATUS_VARIANT_SUMS] = STRATUS_ISA_EVERY(stratus_ray_sums_tile),
    [STRATUS_VARIANT_ISOSURFACE] = STRATUS_ISA_EVERY(stratus_ray_isosurface_tile),
    [STRATUS_VARIANT_CELLS] = STRATUS_ISA_EVERY(stratus_ray_cells_tile),
    [STRATUS_VARIANT_LOCAL] = STRATUS_ISA_EVERY(stratus_ray_local_tile),
    [STRATUS_VARIANT_LIT] = STRATUS_ISA_EVERY(stratus_ray_lit_tile),
    [STRATUS_VARIANT_TRANSFER_2D] = STRATUS_ISA_EVERY(stratus_ray_transfer_2d_tile),
    [STRATUS_VARIANT_SLICE] = STRATUS_ISA_EVERY(stratus_ray_slice_tile),
    [STRATUS_VARIANT_QUANTITIES] = STRATUS_ISA_EVERY(stratus_ray_quantities_tile),
    [STRATUS_VARIANT_SHADING_MIDPOINT] = STRATUS_ISA_EVERY(stratus_ray_shading_tile),
    [STRATUS_VARIANT_SHADING_PREINTEGRATED] = STRATUS_ISA_EVERY(stratus_ray_shading_pre_tile),
  };
  isa = stratus_isa_at_most(isa);
  return variant <= STRATUS_VARIANT_PREINTEGRATED ? of_type[isa](type, variant) : of_variant[variant][isa];
}
