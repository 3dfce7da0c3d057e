/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of several grids in the modes whose rays keep numbers, or one hit, and not light: maximum, minimum, average, additive, first
 * hit, quantities. Each grid is drawn by itself, and stores what its rays keep. A pixel's numbers are joined, whatever the order and
 * overlap of the grids, and coloured at the end. */
#ifndef STRATUS_RAY_KEPT_H
#define STRATUS_RAY_KEPT_H

#include "stratus/ray_cast.h"
#include "base.h"
#include "ray_caster.h"

/* The joint state of a pixel's rays in the grids so far. */
typedef struct stratus_kept_pixel {
  double value;       /* extremes: the best value; sums: the integral of opacity times grey, or times value less `base` */
  double length;      /* means: the world length on which values count */
  double weight;      /* sums of one field: the integral of opacity */
  float depth, cells; /* cells: quantities, whose `value` is the largest, and `weight` the integral of the field */
  float color[3];     /* extremes of dependent components */
  int of;             /* extremes: the input that has the best value; sums: 0; -1: nothing is kept */
} stratus_kept_pixel;

typedef struct stratus_kept {
  stratus_context* context;
  stratus_mode mode;
  /* true: the inputs are parts of one field, with one function. A value's grey is its part of the range of all, and the best value counts
   * even if it is transparent. false: each input has its own range, and only best values that show count. */
  bool one_field;
  const stratus_ray_cast_input* inputs;
  int component; /* that is drawn now */
  const stratus_image* image;
  stratus_kept_pixel* pixels;
  double low, high, base;           /* one field: the range of all values so far; what `value` is relative to */
  double part_low, part_high, bias; /* of the part that was drawn last */
  bool any;
} stratus_kept;

/* Whether rays of the mode keep a number or a hit. */
bool stratus_kept_is(stratus_mode mode);
/* The mode of an input, also of a mesh. */
stratus_mode stratus_kept_mode(const stratus_ray_cast_input* input);
stratus_status stratus_kept_create(stratus_kept* kept); /* sets pixels and what follows; the rest is set */
void stratus_kept_destroy(stratus_kept* kept);
/* Makes room for a part, with depths, whether the image has them or not. */
stratus_status stratus_kept_part_create(const stratus_kept* kept, stratus_image* part);
/* Forgets all pixels, to begin with a component. */
void stratus_kept_begin(stratus_kept* kept, int component);
/* Draws what rays keep of the component of input n, a volume. */
stratus_status stratus_kept_draw(stratus_kept* kept, int n, const stratus_camera* camera, const stratus_ray_cast_options* options,
  const stratus_image* part, stratus_ray_cast_report* report);
/* The same of a mesh. */
stratus_status stratus_kept_draw_mesh(
  stratus_kept* kept, int n, const stratus_camera* camera, const stratus_image* part, stratus_ray_cast_report* report);
/* Joins a part, whose lower left pixel is at x0, y0 of the image, and of which only the pixels `inside` (x0, x1, y0, y1 of the part) show
 * anything. */
void stratus_kept_join(stratus_kept* kept, int n, const stratus_image* part, int x0, int y0, const int inside[4]);
/* Adds the component's colours to the image. */
void stratus_kept_finish(const stratus_kept* kept);

#endif
