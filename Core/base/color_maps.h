/* SPDX-License-Identifier: BSD-3-Clause
 * The table of colour maps. */
#ifndef STRATUS_COLOR_MAPS_H
#define STRATUS_COLOR_MAPS_H

enum { STRATUS_COLOR_MAPS = 35 };

/* name: "cmo." and its name for a map of cmocean. digits: 6 for each of STRATUS_COLOR_MAP_COLORS colours, red, green and blue. */
typedef struct stratus_color_map {
  const char* name;
  const char* digits;
} stratus_color_map;

extern const stratus_color_map stratus_color_maps[STRATUS_COLOR_MAPS];

#endif
