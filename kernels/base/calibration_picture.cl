/* SPDX-License-Identifier: BSD-3-Clause
 * The calibration picture on a device: a work item does one ray. */
#ifndef STRATUS_DEVICE
#define STRATUS_DEVICE 1
#endif

#include "calibration_ray.h"

__kernel void calibration_picture(__global const float* values, __global const float* table, __global float* rgba)
{
  const int x = (int)get_global_id(0), y = (int)get_global_id(1);
  if (x < CALIBRATION_PIXELS && y < CALIBRATION_PIXELS) {
    float pixel[4];
    calibration_march(values, table, (float)x, (float)y, pixel);
    vstore4((float4)(pixel[0], pixel[1], pixel[2], pixel[3]), (size_t)y * CALIBRATION_PIXELS + (size_t)x, rgba);
  }
}
