/* SPDX-License-Identifier: BSD-3-Clause
 * Values as rays read them: the volume's own, or copies as floats once rays have paid for them. */
#ifndef STRATUS_RAY_FETCHED_H
#define STRATUS_RAY_FETCHED_H

#include "ray_caster.h"

/* Decides caster->traversed, and makes what it needs. */
stratus_status stratus_ray_fetched_update(stratus_ray_caster* caster);
void stratus_ray_fetched_drop(stratus_ray_caster* caster);
int stratus_ray_fetch_type(const stratus_volume* volume); /* STRATUS_TYPE that traversal is compiled for, -1 the generic one */

#endif
