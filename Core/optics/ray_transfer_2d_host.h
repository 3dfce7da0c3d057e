/* SPDX-License-Identifier: BSD-3-Clause
 * Functions of two variables: the kept copy, and the function of only the value that determines which values can show. */
#ifndef STRATUS_RAY_TRANSFER_2D_HOST_H
#define STRATUS_RAY_TRANSFER_2D_HOST_H

#include "stratus/ray_cast.h"
#include "base.h"
#include "ray_cast_arguments.h"
#include "ray_field.h"

typedef struct stratus_ray_transfer_2d {
  bool on;                /* this render has one */
  stratus_transfer_2d of; /* as given; changed entries are recognised only by address and revision */
  float* table;           /* entries, and the columns' largest opacities, as rays read them; NULL: none yet */
  size_t bytes;           /* of the table */
  int columns, rows;      /* of the table, which has 2 at least */
  double* points;         /* of `shown` */
  stratus_transfer shown; /* for each value the largest opacity in its rows */
} stratus_ray_transfer_2d;

/* Checks the options' function, unless it is kept already, and options that it cannot be combined with. */
stratus_status stratus_ray_transfer_2d_check(
  stratus_context* context, const stratus_ray_transfer_2d* kept, const stratus_volume* volume, const stratus_ray_cast_options* options);
/* Whether a function (NULL: none) is another one than the kept. */
bool stratus_ray_transfer_2d_changes(const stratus_ray_transfer_2d* t, const stratus_transfer_2d* of);
/* Keeps a function, if there is one. *made: its table was made. */
stratus_status stratus_ray_transfer_2d_update(
  stratus_context* context, stratus_ray_transfer_2d* t, const stratus_transfer_2d* of, bool* made);
void stratus_ray_transfer_2d_release(stratus_context* context, stratus_ray_transfer_2d* t);
void stratus_ray_transfer_2d_arguments(
  const stratus_ray_transfer_2d* t, const stratus_ray_field* field, double sample_distance, stratus_ray_cast_arguments* arguments);

#endif
