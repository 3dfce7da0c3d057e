/* SPDX-License-Identifier: BSD-3-Clause
 * Marches a tile of rays on the host. */
#define TETRA_TILE_NAME STRATUS_ISA_NAME(stratus_tetra_tile)
#include "tetra_march_tile.h"
