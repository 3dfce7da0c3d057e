/* SPDX-License-Identifier: BSD-3-Clause
 * The values that rays read: the volume's own, or a float copy where that pays. */
#ifndef STRATUS_RAY_FETCHED_H
#define STRATUS_RAY_FETCHED_H

#include "ray_caster.h"

/* Sets caster->traversed, and makes the copy when it is due. rays: of the picture to come. */
stratus_status stratus_ray_fetched_update(stratus_ray_caster* caster, size_t rays);
void stratus_ray_fetched_drop(stratus_ray_caster* caster);
int stratus_ray_fetch_type(const stratus_volume* volume); /* STRATUS_TYPE of the traversal that reads this volume; -1: generic */

#endif
