/* SPDX-License-Identifier: BSD-3-Clause
 * Coastlines of the world. */
#ifndef STRATUS_COAST_LINES_H
#define STRATUS_COAST_LINES_H

#include <stdint.h>

#define STRATUS_COAST_UNITS 180.0 /* numbers of a degree */

/* Lines one after the other: the count of points, then longitude and latitude of each. A count of 0 ends them. */
extern const int16_t stratus_coast_lines[];

#endif
