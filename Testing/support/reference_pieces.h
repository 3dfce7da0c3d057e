/* SPDX-License-Identifier: BSD-3-Clause
 * Integration along a ray that knows where the integrand bends or jumps. Private to the reference; tests include reference.h. */
#ifndef STRATUS_TESTING_REFERENCE_PIECES_H
#define STRATUS_TESTING_REFERENCE_PIECES_H

#include "reference_field.h"

/* Values at which the opacity or the colour bends or jumps, in ascending order without duplicates. */
typedef struct reference_breaks {
  double* values;
  size_t count;
} reference_breaks;

/* Returns 0, or -1 if memory runs out. */
int reference_breaks_create(const stratus_transfer* transfer, reference_breaks* breaks);
void reference_breaks_release(reference_breaks* breaks);

/* A line in index coordinates: origin + s * direction for s in begin..end, world distances. */
typedef struct reference_line {
  const double *origin, *direction;
  double begin, end;
} reference_line;

/* A ray's light so far. */
typedef struct reference_light {
  double left;   /* transparency, at first 1 */
  double rgb[3]; /* premultiplied, at first 0 */
  double first;  /* distance to the first place with opacity, at first INFINITY */
} reference_light;

/* Adds the light of a line on which the field stays within the same cells: no grid plane crosses it between its ends. The field is a cubic
 * there. longest: of a piece of quadrature, world distance. */
void reference_add_line(const reference_field* f, const stratus_transfer* transfer, const reference_breaks* breaks,
  const reference_line* line, double longest, reference_cell* cell, reference_light* light);

#endif
