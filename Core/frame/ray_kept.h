/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of several grids in all modes but composite. Each grid is drawn by itself, and stores what its rays keep: numbers in maximum,
 * minimum, average, additive and quantities, or a surface in first hit, isosurface and slice. A pixel's numbers are joined, whatever the
 * order and overlap of the grids, and coloured at the end. Its surfaces are composited by depth. */
#ifndef STRATUS_RAY_KEPT_H
#define STRATUS_RAY_KEPT_H

#include "stratus/ray_cast.h"
#include "base.h"
#include "ray_caster.h"
#include "ray_layers.h"

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
  int pass;      /* surfaces: each ray's surface that is drawn now, the nearest is 0; else 0 */
  const stratus_image* image;
  stratus_layers layers;            /* surfaces */
  stratus_kept_pixel* pixels;       /* numbers; NULL: rays keep surfaces */
  double low, high, base;           /* one field: the range of all values so far; what `value` is relative to */
  double part_low, part_high, bias; /* of the part that was drawn last */
  bool any;
} stratus_kept;

/* Whether rays of the mode keep numbers. */
bool stratus_kept_is(stratus_mode mode);
/* The mode of an input, also of a mesh. */
stratus_mode stratus_kept_mode(const stratus_ray_cast_input* input);
/* Sets the members from `layers` on; the rest is set. */
stratus_status stratus_kept_create(stratus_kept* kept);
void stratus_kept_destroy(stratus_kept* kept);
/* Makes room for a part, with depths, whether the image has them or not. */
stratus_status stratus_kept_part_create(const stratus_kept* kept, stratus_image* part);
/* Forgets all pixels, to begin with a component. */
void stratus_kept_begin(stratus_kept* kept, int component);
/* Gives the transparency below which a ray of a volume's picture ends. */
float stratus_kept_least(const stratus_ray_cast_options* options);
/* Sets where the rays of input n end in a window of the image (x0, x1, y0, y1): at opaque geometry, and at once where nothing of the input
 * can be seen. kept NULL: nothing is seen behind pixels whose transparency is `least` or below. Returns whether any ray is left, and in
 * *wanted whether any ends early. */
bool stratus_kept_ends(const stratus_kept* kept, int n, const stratus_image* image, const stratus_camera* camera, const int window[4],
  float least, float* ends, bool* wanted);
/* Draws what rays keep of the component of input n, a volume. */
stratus_status stratus_kept_draw(stratus_kept* kept, int n, const stratus_camera* camera, const stratus_ray_cast_options* options,
  const stratus_image* part, stratus_ray_cast_report* report);
/* The same of a mesh. */
stratus_status stratus_kept_draw_mesh(
  stratus_kept* kept, int n, const stratus_camera* camera, const stratus_image* part, stratus_ray_cast_report* report);
/* Joins a part, whose lower left pixel is at x0, y0 of the image, and of which only the pixels `inside` (x0, x1, y0, y1 of the part) show
 * anything. */
stratus_status stratus_kept_join(stratus_kept* kept, int n, const stratus_image* part, int x0, int y0, const int inside[4]);
/* Adds the report on a picture of an input to its reports before, if there are any. */
void stratus_kept_report(const stratus_kept* kept, stratus_ray_cast_report* sum, const stratus_ray_cast_report* report);
/* Adds the component's colours to the image. */
void stratus_kept_finish(const stratus_kept* kept);

#endif
