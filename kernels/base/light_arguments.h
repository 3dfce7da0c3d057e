/* SPDX-License-Identifier: BSD-3-Clause
 * A frame's lights: scalars of four bytes only, the same bytes on host and device. Places are coordinates of the renderer's own, which
 * `place` transforms to the world. */
#ifndef STRATUS_LIGHT_ARGUMENTS_H
#define STRATUS_LIGHT_ARGUMENTS_H

typedef struct stratus_light_arguments {
  int on, two_sided, count;        /* on: bit c where component c is lit */
  float normal[9];                 /* 3x3, by rows: takes a gradient to a normal, of any length */
  float place[9];                  /* 3x3, by rows: takes displacements to world ones, in a unit of length of the renderer's */
  float material[4][4];            /* of each component: ambient, diffuse, specular, specular power */
  float vector[8][3], color[8][3]; /* vector: the direction to the light, of length 1; where positional, its position, as `place` maps it */
  float specular_color[8][3];      /* of highlights */
  int positional[8];
  float attenuation[8][3]; /* in units of `place`; of lights that are not dimmed 1, 0, 0 */
  float cone[8][5];        /* the direction in which the light shines, the cosine at the cone's edge, -1: no cone, and the exponent */
} stratus_light_arguments;

#endif
