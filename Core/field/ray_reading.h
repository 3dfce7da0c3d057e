/* SPDX-License-Identifier: BSD-3-Clause
 * The host's functions that read a field, one row for each type of values. Marches for which a call costs little next to their own work
 * are compiled once, with STRATUS_TYPE -2, and call them. */
#ifndef STRATUS_RAY_READING_H
#define STRATUS_RAY_READING_H

#include "instruction_set.h"
#include "stretched_grid.h"
#include "value_source.h"

#define JOIN_(a, b) a##_##b
#define JOIN(a, b) JOIN_(a, b)

typedef struct ray_reading {
  /* RAY_NAME(ray_value), RAY_NAME(ray_gradient), RAY_NAME(fetch_cell) and RAY_NAME(fetch_nearest) of a type */
  vfloat (*value)(
    const stratus_ray_cast_arguments* a, value_source values, const uchar* hidden, const int* grid, const vfloat x[3], vmask mask);
  void (*gradient)(const stratus_ray_cast_arguments* a, value_source values, const int* grid, const vfloat x[3], vmask mask, vfloat g[3]);
  void (*cell)(const stratus_ray_cast_arguments* a, value_source values, vint i, vint j, vint k, vmask mask, vfloat v[8]);
  vfloat (*nearest)(const stratus_ray_cast_arguments* a, value_source values, vint i, vint j, vint k, vmask mask);
} ray_reading;

#define RAY_READINGS STRATUS_ISA_NAME(stratus_ray_readings)
extern const ray_reading RAY_READINGS[RAY_READING_TILES + 1]; /* ray_reading_isa.c; by values.reading */
#define RAY_READING(a) (&RAY_READINGS[(a)->values.reading])

#endif
