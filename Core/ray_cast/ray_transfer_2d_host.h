/* SPDX-License-Identifier: BSD-3-Clause
 * Functions of two variables: the caster's copy, and the function of only the value that determines which values can show. */
#ifndef STRATUS_RAY_TRANSFER_2D_HOST_H
#define STRATUS_RAY_TRANSFER_2D_HOST_H

#include "stratus/ray_cast.h"
#include "base.h"
#include "ray_cast_arguments.h"

typedef struct stratus_ray_transfer_2d {
  bool on;                /* this render has one */
  stratus_transfer_2d of; /* as given; changed entries are recognised only by address and revision */
  float* table;           /* entries, and the columns' largest opacities, as rays read them; NULL: none yet */
  size_t bytes;           /* of the table */
  int columns, rows;      /* of the table, which has 2 at least */
  double* points;         /* of `shown` */
  stratus_transfer shown; /* for each value the largest opacity in its rows */
} stratus_ray_transfer_2d;

/* Checks the function, unless the caster has it already, and options that it cannot be combined with. */
stratus_status stratus_ray_transfer_2d_check(
  const stratus_ray_caster* caster, const stratus_volume* volume, const stratus_ray_cast_options* options);
/* Keeps the function of the options, if there is one. Drops what follows from another one. */
stratus_status stratus_ray_transfer_2d_update(stratus_ray_caster* caster, const stratus_ray_cast_options* options);
void stratus_ray_transfer_2d_release(stratus_ray_caster* caster);
void stratus_ray_transfer_2d_arguments(const stratus_ray_caster* caster, stratus_ray_cast_arguments* arguments);

#endif
