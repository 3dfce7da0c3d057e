/* SPDX-License-Identifier: BSD-3-Clause
 * Shading of the reference renderer: light, gradient opacity, several components and labels. Private to the reference; tests include
 * reference.h. */
#ifndef STRATUS_TESTING_REFERENCE_SHADING_H
#define STRATUS_TESTING_REFERENCE_SHADING_H

#include "reference.h"
#include "reference_axis.h"

#include <stdbool.h>

#define REFERENCE_COMPONENTS_MAX 4

/* The gradients at the corners of the cell that was asked last, in values per unit of place: a ray takes many samples in each cell. */
typedef struct reference_gradients {
  int64_t at[3]; /* lower corner; -1: of no cell yet */
  double corner[8][3];
} reference_gradients;

struct reference_field;

/* What absorbs light on its way to a sample. */
typedef struct reference_matter {
  const struct reference_field* field;
  const struct reference_breaks* breaks;
  double longest; /* of a step */
} reference_matter;

/* The position of a sample, and the direction of its ray. */
typedef struct reference_place {
  reference_spot spot[3];         /* among the values */
  double world[3];                /* world position */
  double at[3];                   /* the same among places */
  double direction[3];            /* of the ray, in the world, of length 1 */
  double to_index[3][3];          /* from world vectors to vectors of places (reference_axis.h) */
  reference_gradients* gradients; /* one for each component, which the ray keeps */
  const reference_matter* matter; /* read if there are shadows */
} reference_place;

/* Returns 1 if the scene has light, gradient opacity, several components or labels. */
int reference_has_shading(const reference_scene* scene);
int reference_components(const stratus_volume* volume);
/* Returns component c of a volume as a volume of its own. */
stratus_volume reference_component(const stratus_volume* volume, int c);

/* Shades a sample. values: one per component, NAN where it is hidden. *tau: optical depth per unit distance. glow: emitted light per unit
 * distance. */
void reference_shade(const reference_scene* scene, const reference_place* place, const double* values, double* tau, double glow[3]);

/* reference.c: the part of a light that passes to a place in the world. */
double reference_passing(const reference_scene* scene, const reference_matter* matter, const stratus_light* light, const double world[3]);

/* reference_transfer_2d.c: colour (not multiplied by opacity) and opacity of a value and a second number. */
void reference_transfer_2d(const stratus_transfer_2d* of, bool nearest, double value, double second, double rgba[4]);

/* reference_field.c */
double reference_opacity(const stratus_transfer* transfer, double value);
void reference_color(const stratus_transfer* transfer, double value, double rgb[3]);

#endif
