/* SPDX-License-Identifier: BSD-3-Clause
 * A small picture that host and devices draw to be compared. */
#ifndef STRATUS_CALIBRATION_PICTURE_H
#define STRATUS_CALIBRATION_PICTURE_H

#include "base.h"

/* Pixels along each side of the picture and of a tile of it, values along each side of the volume, entries of the table. */
#define STRATUS_CALIBRATION_SIDE 512
#define STRATUS_CALIBRATION_TILE 16
#define STRATUS_CALIBRATION_VALUES 64
#define STRATUS_CALIBRATION_ENTRIES 256
/* Floats of the picture. */
#define STRATUS_CALIBRATION_FLOATS (4 * STRATUS_CALIBRATION_SIDE * STRATUS_CALIBRATION_SIDE)

/* Draw the calibration image where the context draws: on its device, or on the host by all its threads. ms: the shortest time of several.
 * It includes copying the image back to `rgba`, but neither copying the volume to a device nor building its kernel. */
stratus_status stratus_calibration_picture(stratus_context* context, float rgba[STRATUS_CALIBRATION_FLOATS], double* ms);

/* calibration_picture_isa.c, once for each instruction set: draws tile `tile`, counted along rows. */
typedef void stratus_calibration_tile(const float* values, const float* table, int tile, float* rgba);
stratus_calibration_tile stratus_calibration_tile_isa0, stratus_calibration_tile_isa1, stratus_calibration_tile_isa2;

#endif
