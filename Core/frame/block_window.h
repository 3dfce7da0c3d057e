/* SPDX-License-Identifier: BSD-3-Clause
 * Which pixels of a picture a block of a volume may cover. */
#ifndef STRATUS_BLOCK_WINDOW_H
#define STRATUS_BLOCK_WINDOW_H

#include "stratus/camera.h"
#include "stratus/volume.h"

/* window: columns window[0] to below window[1] and rows window[2] to below window[3]; none if the block is out of sight. */
void stratus_block_window(const stratus_volume* volume, const stratus_camera* camera, const stratus_image* image, int window[4]);

#endif
