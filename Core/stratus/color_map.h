/* SPDX-License-Identifier: BSD-3-Clause
 * Colour maps by name: 256 colours of 8 bits each, which are the bytes of matplotlib's, cmocean's and ParaView's own maps. */
#ifndef STRATUS_PUBLIC_COLOR_MAP_H
#define STRATUS_PUBLIC_COLOR_MAP_H

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Colours of a map. */
#define STRATUS_COLOR_MAP_COLORS 256

/* Return the name of a map, numbered from 0, or NULL after the last one and below 0.
 * - of matplotlib: viridis, magma, inferno, plasma, cividis, turbo, coolwarm, gray
 * - of cmocean: thermal, haline, solar, ice, oxy, deep, dense, algae, matter, turbid, speed, amp, tempo, rain, phase, topo, balance, delta,
 *   curl, diff, tarn, cmo.gray
 * - of ParaView: cool-warm ("Cool to Warm")
 * - of Stratus: storm, cloud, fire, white */
STRATUS_API const char* stratus_color_map_name(int number);

/* Make the colours of a transfer function from a map. Colours are linear between the points; matplotlib draws the nearest one below.
 * - name: one of the names above; the name of a map of cmocean after "cmo."; or a quantity's: temperature (thermal), salinity (haline),
 *   sediment (turbid), oxygen (oxy), depth (deep). "_r" after any of these reverses the map
 * - low, high: values of the first and last colour, finite, low <= high. If they are equal, each point has the middle colour, number 128
 * - points: 256 quadruples of value, red, green and blue in 0..1, for stratus_transfer.color. 255 times a colour is the byte of the map */
STRATUS_API stratus_status stratus_color_map_points(stratus_context* context, const char* name, double low, double high, double* points);

#ifdef __cplusplus
}
#endif

#endif
