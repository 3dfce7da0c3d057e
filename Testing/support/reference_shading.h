/* SPDX-License-Identifier: BSD-3-Clause
 * What the reference renderer's samples show beyond colour and opacity of one value: light, gradient opacity, several components. Private
 * to the reference: everybody else includes reference.h. */
#ifndef STRATUS_TESTING_REFERENCE_LOOKS_H
#define STRATUS_TESTING_REFERENCE_LOOKS_H

#include "reference.h"

#define REFERENCE_COMPONENTS_MAX 4

/* A sample: where it is, and how the ray passes it. */
typedef struct reference_place {
  double index[3];       /* index coordinates, clamped to where values are */
  double world[3];       /* its position */
  double direction[3];   /* of the ray, world, length 1 */
  double to_index[3][3]; /* world vectors to index vectors */
} reference_place;

/* 1 where a sample is more than the colour and opacity of one value. */
int reference_has_shading(const reference_scene* scene);
int reference_components(const stratus_volume* volume);
/* Component c of a volume as a volume of its own. */
stratus_volume reference_component(const stratus_volume* volume, int c);

/* values: a value a component, NAN where there is none. tau: optical depth per unit distance of what is there, glow: the light that it
 * sends, per unit distance. */
void reference_shade(const reference_scene* scene, const reference_place* place, const double* values, double* tau, double glow[3]);

/* reference_field.c */
double reference_opacity(const stratus_transfer* transfer, double value);
void reference_color(const stratus_transfer* transfer, double value, double rgb[3]);

#endif
