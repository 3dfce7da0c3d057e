/* SPDX-License-Identifier: BSD-3-Clause
 * Marches a tile of rays on the host whose light and opacity depend on the gradient. */
#define TETRA_LIT 1
#define TETRA_TILE_NAME STRATUS_ISA_NAME(stratus_tetra_light_tile)
#include "tetra_march_tile.h"
