/* SPDX-License-Identifier: BSD-3-Clause
 * A frame's lights: scalars of four bytes only, the same bytes on host and device. Places are coordinates of the renderer's own, which
 * `place` transforms to the world. */
#ifndef STRATUS_LIGHT_ARGUMENTS_H
#define STRATUS_LIGHT_ARGUMENTS_H

#define LIGHT_SCATTER_WORDS 5 /* of a node of light_scatter.h */

typedef struct stratus_light_arguments {
  int on, two_sided, count;        /* on: bit c where component c is lit */
  int turns;                       /* 1: reflected light jumps where a normal is turned round */
  float scattered;                 /* the share of light that matter scatters, 0..1; the rest is reflected as by surfaces */
  float phase[3];                  /* Henyey and Greenstein's 1 - g^2, 1 + g^2 and 2 g */
  float normal[9];                 /* 3x3, by rows: takes a gradient to a normal, of any length */
  float place[9];                  /* 3x3, by rows: takes displacements to world ones, in a unit of length of the renderer's */
  float material[4][4];            /* of each component: ambient, diffuse, specular, specular power */
  float vector[8][3], color[8][3]; /* vector: the direction to the light, of length 1; where positional, its position, as `place` maps it */
  float specular_color[8][3];      /* of highlights */
  int positional[8];
  float attenuation[8][3]; /* in units of `place`; of lights that are not dimmed 1, 0, 0 */
  float cone[8][5];        /* the direction in which the light shines, the cosine at the cone's edge, -1: no cone, and the exponent */
  /* The map of each light (light_map.h). map_at: where it begins; -1: there is none, and all light passes. map_faces: 0 of a direction; of
   * a position 1, or the 6 sides of a cube about it. map_size: nodes across and up, and layers, of a face. map_from: 3x4, by rows, takes
   * places to the map's. map_scale: of a map in perspective, the scale and middle of nodes across and up, and of layers. */
  int map_at[8], map_faces[8], map_size[8][3];
  float map_from[8][12], map_scale[8][6];
  /* Depths of the surfaces that hide each light (light_map.h). surface_at: where they begin; -1: there are none. surface_size: nodes across
   * and up, of a face. surface_scale: takes the map's nodes to these. */
  int surface_at[8], surface_size[8][2];
  float surface_scale[8][2];
  /* On the way to each light, matter next to a place is passed in near_steps steps (light_near.h), which may be 0, of near_length sample
   * distances each, and the map is read where they end. near: whether any light has such steps. The rest is read of lights that have:
   * near_way: the steps together, or a light's position; near_reach: their length in units of `place`. */
  int near, near_steps[8];
  float near_length[8], near_reach[8], near_way[8][3];
  /* Light that is scattered more than once (light_scatter.h). scatter_at: where its words begin; -1: there is none. scatter_from: 3x4, by
   * rows, takes places to nodes. scatter_scale: of red, green and blue. */
  int scatter_at, scatter_size[3];
  float scatter_from[12], scatter_scale[3];
  float scatter_way; /* the part that a scattering sends on along its way; below 0: the phase function's asymmetry */
} stratus_light_arguments;

#endif
