/* SPDX-License-Identifier: BSD-3-Clause
 * Directions of points on a sphere, which finding and placing its lattices share. */
#ifndef STRATUS_GLOBE_DIRECTION_H
#define STRATUS_GLOBE_DIRECTION_H

#include <stdbool.h>

/* Computes the direction, of length 1, of a longitude and latitude. */
void stratus_globe_direction(const double degrees[2], double unit[3]);
/* Finds the pole of the circle that a row is, from three of its points. Returns false if they are not known. */
bool stratus_globe_pole(const double* one, const double* second, const double* third, double pole[3]);

#endif
