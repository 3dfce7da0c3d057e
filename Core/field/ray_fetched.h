/* SPDX-License-Identifier: BSD-3-Clause
 * The values that rays read: the volume's own, or a float copy where that pays. */
#ifndef STRATUS_RAY_FETCHED_H
#define STRATUS_RAY_FETCHED_H

#include "ray_field.h"

/* Sets field->traversed, and makes the copy when it is due. rays: of the picture to come. */
stratus_status stratus_ray_fetched_update(stratus_ray_field* field, size_t rays);
void stratus_ray_fetched_drop(stratus_ray_field* field);
/* Returns what kernels/field/value_source.h calls the value source of field->traversed. */
const void* stratus_ray_values_of(const stratus_ray_field* field);
/* Returns the bytes between the value sources of two neighbouring components. */
size_t stratus_ray_component_bytes(const stratus_ray_field* field);
int stratus_ray_fetch_type(const stratus_volume* volume); /* STRATUS_TYPE of the traversal that reads this volume; -1: generic, or tiles */
/* Whether a type has a fast fetch. */
int stratus_ray_cast_type_is_fast(int type);

#endif
