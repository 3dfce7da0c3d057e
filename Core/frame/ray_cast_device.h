/* SPDX-License-Identifier: BSD-3-Clause
 * The traversal on the OpenCL device. */
#ifndef STRATUS_RAY_CAST_DEVICE_H
#define STRATUS_RAY_CAST_DEVICE_H

#include "ray_cast_host.h"
#include "ray_caster.h"

/* stratus_ray_cast_rest() on the OpenCL device. *drawn stays false if the device cannot draw (data too large, no double); the caller then
 * draws on the host. */
stratus_status stratus_ray_cast_device(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, int type,
  stratus_ray_variant variant, stratus_ray_counts* counts, double* upload_ms, bool* drawn);
void stratus_ray_device_destroy(stratus_ray_caster* caster);

#endif
