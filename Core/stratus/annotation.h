/* SPDX-License-Identifier: BSD-3-Clause
 * Text and lines around a picture of a volume: a box with axes, coastlines, a colour bar, a caption. */
#ifndef STRATUS_PUBLIC_ANNOTATION_H
#define STRATUS_PUBLIC_ANNOTATION_H

#include "camera.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How numbers of an axis are written. */
typedef enum stratus_axis_kind {
  STRATUS_AXIS_NUMBER,    /* "-0.5" */
  STRATUS_AXIS_LONGITUDE, /* in degrees, "62.5°W", of any turn */
  STRATUS_AXIS_LATITUDE,  /* in degrees, "12°N" */
  STRATUS_AXIS_LEVELS     /* ticks are only at the numbers of `levels`, the roundest first */
} stratus_axis_kind;

/* An axis of the volume's coordinates. Its numbers are those of the file, whatever the world has: heights that are exaggerated, metres that
 * are degrees in the file, heights that are depths or pressures. The strings and arrays are borrowed. */
typedef struct stratus_axis {
  stratus_axis_kind kind; /* default NUMBER */
  const char* title;      /* UTF-8. NULL or "": x, y or z */
  /* Of the numbers, UTF-8, may be NULL. "m" becomes km if the numbers of one axis in m with the same scale, or the same but for its sign,
   * reach 10000. Titles of longitudes and latitudes have no unit, because their numbers have. */
  const char* units;
  double scale; /* number = world coordinate times scale; finite, not 0, below 0 for depths. Default 1. LEVELS: not used. */
  /* LEVELS: pairs of a world coordinate and a number, level_count of them; coordinates and numbers are finite */
  const double* levels;
  size_t level_count;
} stratus_axis;

STRATUS_API stratus_axis stratus_axis_default(void);

/* A tick of an axis. */
typedef struct stratus_axis_tick {
  double place; /* world coordinate */
  char text[32];
} stratus_axis_tick;

/* Ticks of an axis at most. */
#define STRATUS_AXIS_TICKS 64

/* Find ticks at round numbers.
 * - axis: LEVELS need at least one level
 * - kilo: 1: numbers are in units of 1000, as those of km on an axis of m
 * - low, high: world coordinates of the axis' ends, finite, low < high
 * - most: largest number of ticks, 1..STRATUS_AXIS_TICKS; the step is the smallest round one that keeps it. LEVELS: ticks are at least
 *   (high - low) / most apart
 * - ticks, count: STRATUS_AXIS_TICKS entries, and how many of them were filled, by ascending place. None, if no round number is between
 *   low and high */
STRATUS_API stratus_status stratus_axis_find_ticks(
  stratus_context* context, const stratus_axis* axis, int kilo, double low, double high, int most, stratus_axis_tick* ticks, int* count);

/* Finds x and y in the world of a longitude and latitude in degrees, on the plane of a map projection. Returns 0 if there is no such place,
 * otherwise another number. data: coast_data of the annotation. */
typedef int (*stratus_coast_place)(void* data, const double degrees[2], double place[2]);

/* What is drawn around a picture. Strings and arrays are borrowed. */
typedef struct stratus_annotation {
  int axes;             /* 1: a box around `bounds`, with numbers and titles. Default 0. */
  double bounds[6];     /* of the volume in the world: xmin, xmax, ymin, ymax, zmin, zmax */
  stratus_axis axis[3]; /* x, y, z */
  /* 1: coastlines within `bounds`, on the face where the axis that is neither longitude nor latitude begins; of depths, scale < 0, where it
   * ends. Needs a LONGITUDE, within 3600 degrees, and a LATITUDE, or coast_place. Default 0. */
  int coast;
  /* Above 0 and finite: coastlines are on a sphere of this radius about 0 in the world, longitude 0 towards x and north towards z, on the
   * side that faces the eye; bounds and axes do not count for them. 0 (default): as above. */
  double globe;
  /* Not NULL: coastlines are at these places of x and y, whatever the axes are, on the face where z begins; of depths where it ends. Pieces
   * that the projection tears apart are left out. Not used on a globe. Default NULL. */
  stratus_coast_place coast_place;
  void* coast_data; /* borrowed */
  /* Of the colour bar: quadruples of value, red, green and blue in 0..1, by ascending value, `color_count` of them. Default 0: no bar. */
  const double* color;
  size_t color_count;
  double low, high;      /* values at the ends of the bar, low <= high. logarithmic: low > 0 */
  int logarithmic;       /* 1: the bar's values are even by their logarithms. Default 0. */
  const char* bar_title; /* UTF-8, of the bar; NULL: none */
  const char* bar_units; /* UTF-8, may be NULL */
  const char* caption;   /* UTF-8, lines at the top; NULL or "": none */
  double ink;            /* grey of lines and text, 0..1. Default 0.9. */
} stratus_annotation;

STRATUS_API stratus_annotation stratus_annotation_default(void);

/* Find the part of a picture that bar, caption, and numbers and titles of axes leave to the volume's box.
 * - width, height: of the picture in pixels, 1..65536
 * - room: receives left, right, bottom and top, in pixels from the lower left corner */
STRATUS_API stratus_status stratus_annotation_room(
  stratus_context* context, const stratus_annotation* annotation, int width, int height, double room[4]);

/* Make the camera of a whole picture from one that would draw its part `room` alone. Both see the same there.
 * - part: made for an image of the part's aspect
 * - whole: receives the camera; may be the same struct. Its rays are not symmetric if the part is not in the picture's middle */
STRATUS_API stratus_status stratus_camera_in_room(
  stratus_context* context, const stratus_camera* part, int width, int height, const double room[4], stratus_camera* whole);

/* A text of a picture, in pixels with its last column and row, bottom row first. */
typedef struct stratus_annotation_text {
  int left, bottom, right, top;
  int part; /* 0..2: a number or title of this axis; 3: of the bar; 4: of the caption */
  char text[64];
} stratus_annotation_text;

/* Draw annotations onto a picture. No text is cut off and none covers another: a number or title without room is left out, other text is
 * broken into lines and shortened.
 * - annotation: titles, colours and bounds as above
 * - camera: of the whole picture
 * - image: width, height and rgba are used: the volume's picture, premultiplied, onto which is drawn. Edges of the box that are behind the
 *   volume are drawn behind it
 * - texts: NULL, or receives the first `most` texts; count: NULL, or receives the number of all */
STRATUS_API stratus_status stratus_annotation_draw(stratus_context* context, const stratus_annotation* annotation,
  const stratus_camera* camera, const stratus_image* image, stratus_annotation_text* texts, size_t most, size_t* count);

#ifdef __cplusplus
}
#endif

#endif
