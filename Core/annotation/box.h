/* SPDX-License-Identifier: BSD-3-Clause
 * The volume's box, its axes, and coastlines on one of its faces. */
#ifndef STRATUS_BOX_H
#define STRATUS_BOX_H

#include "layout.h"
#include "sheet.h"

/* Of each face, x low, x high, y low ...: whether it looks at the eye. */
void stratus_box_facing(const stratus_annotation* annotation, const stratus_camera* camera, bool facing[6]);
/* Draws the edges that are in front of the volume, or those behind it. */
stratus_status stratus_box_edges(stratus_sheet* sheet, const stratus_annotation* annotation, const bool facing[6], bool behind);
/* Draws ticks; its lines are in front of the volume. Numbers and titles. */
stratus_status stratus_box_axes(
  stratus_sheet* sheet, const stratus_annotation* annotation, const stratus_layout* layout, const bool facing[6]);

/* Returns the face that coastlines are on, -1 if the axes are not of longitudes and latitudes. */
int stratus_coast_face(const stratus_annotation* annotation);
/* Draws coastlines on that face. */
void stratus_coast_draw(stratus_sheet* sheet, const stratus_annotation* annotation);
/* Draws coastlines on the side of a sphere about 0 that faces the eye. */
void stratus_coast_draw_globe(stratus_sheet* sheet, double radius);

/* Visits the lines of the coast that are within bounds: longitudes of any turn and latitudes, west, east, south, north. */
typedef void stratus_coast_visit(void* data, const double from[2], const double to[2]);
void stratus_coast_within(const double bounds[4], stratus_coast_visit* visit, void* data);

#endif
