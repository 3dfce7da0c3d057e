/* SPDX-License-Identifier: BSD-3-Clause
 * Grids of longitudes and latitudes on a sphere about 0, longitude 0 towards x and north towards z, and the Earth beneath them. */
#ifndef STRATUS_PUBLIC_GLOBE_H
#define STRATUS_PUBLIC_GLOBE_H

#include "camera.h"

#ifdef __cplusplus
extern "C" {
#endif

#define STRATUS_EARTH_RADIUS 6371000.0 /* metres */

/* How a lattice of longitudes and latitudes closes the sphere. Its points are points of the data, whose columns run fastest, and more
 * points where the data leave a gap:
 * - the first column comes again as the last if the data go all the way round;
 * - a row at a pole comes before a row around the pole that is next to it, or behind it;
 * - a row on the seam between two poles comes behind a last row that the seam folds onto itself.
 * Columns and rows that repeat others are left out. */
typedef struct stratus_globe_lattice {
  int64_t data_columns, data_rows;
  int64_t columns, rows;                   /* of the data that are drawn, the first ones */
  int64_t repeated_columns, repeated_rows; /* of the data that are left out, the last ones; a column that is the first one is not counted */
  int closed;                              /* 1: the first column comes again */
  int pole_before, pole_after;             /* 1: a row at a pole comes before the first row, behind the last one */
  int64_t seam; /* a row on the seam comes behind the last one: between its columns i and (seam - i) modulo columns; -1: none */
} stratus_globe_lattice;

/* Find out how a lattice closes the sphere.
 * - columns, rows: of the data, each at least 2; columns * rows at most 2^40
 * - degrees: longitude and latitude of each point, columns fastest; NaN: unknown */
STRATUS_API stratus_status stratus_globe_find_lattice(
  stratus_context* context, int64_t columns, int64_t rows, const double* degrees, stratus_globe_lattice* lattice);
/* Return the columns and rows of the lattice, with those that close it. */
STRATUS_API int64_t stratus_globe_columns(const stratus_globe_lattice* lattice);
STRATUS_API int64_t stratus_globe_rows(const stratus_globe_lattice* lattice);
/* Find the points of the data whose mean is a point of the lattice: itself, or both sides of a seam, or all of the row next to a pole.
 * - column, row: of the lattice
 * - first, stride: receive the index of the first of these points in the data, and the distance to the next one
 *
 * Returns how many points they are; 0 outside of the lattice. */
STRATUS_API int64_t stratus_globe_source(
  const stratus_globe_lattice* lattice, int64_t column, int64_t row, int64_t* first, int64_t* stride);
/* Describe how the lattice is closed, as ", closed at both poles", or "".
 * - text: receives the text, cut to size - 1 bytes */
STRATUS_API void stratus_globe_describe(const stratus_globe_lattice* lattice, char* text, size_t size);

/* Add whole turns to longitudes of a lattice, so that neighbours differ by at most half a turn wherever this is possible. Around a pole it
 * is impossible: where continuous longitudes meet again, neighbours differ by a turn. Neighbours that differ least are joined first, hence
 * they meet where longitudes change fastest, near the pole. Places fall into parts if NaN, which stays, is between them: the first place of
 * the widest part keeps its longitude, and other parts are as near to that part as whole turns allow. stratus_faces_flatten() does this
 * with meshes.
 * - lengths: places along each axis, 1..2^40
 * - strides: from a place to the next along each axis, 0..2^40; 0: the axis has one place, whatever its length
 * - degrees: longitudes; at most 2^40 numbers from the first to the last place
 * - changed: receives 1 if any longitude changed, otherwise 0 */
STRATUS_API stratus_status stratus_longitudes_unwrap(
  stratus_context* context, const int64_t lengths[3], const int64_t strides[3], double* degrees, int* changed);

/* Points of data on the sphere. The arrays are borrowed. */
typedef struct stratus_globe_points {
  const stratus_globe_lattice* lattice; /* NULL: points are those of the data */
  int64_t count;                        /* points of a level of the data; with a lattice data_columns * data_rows */
  int64_t levels;                       /* >= 1 */
  const double* degrees;                /* longitude and latitude of each point of a level */
  int degrees_of_levels;                /* 1: `degrees` are of each level; 0: all levels have the same */
  const double* heights;                /* metres, of each point of each level */
  int64_t height_stride;                /* from a height to the next, >= 1 */
  double factor;                        /* of heights, > 0 and finite */
} stratus_globe_points;

/* Place points on the sphere of the Earth's radius, with heights times `factor` added to the radius. A point whose longitude, latitude or
 * height is not finite, which the caller hides, is where the one before it is.
 * - points: receives x, y, z in metres of each point of each level of the lattice, or of the data. Without a lattice the heights may be
 * every third number of `points`
 *
 * Refuses heights that reach the middle of the Earth, and data of which no point is known. */
STRATUS_API stratus_status stratus_globe_place(stratus_context* context, const stratus_globe_points* from, double* points);
/* Return the factor by which heights low <= high reach over a tenth of the Earth's radius; 1 if they are equal. */
STRATUS_API double stratus_globe_height_factor(double low, double high);

/* The Earth in a picture: a sphere that hides what is behind it. */
typedef struct stratus_globe {
  double innermost; /* distance of the data's innermost point from the middle, > 0, finite; the sphere is as large as that allows */
  int coast;        /* 1: coastlines, on top of data below the sea, otherwise beneath all data. Default 0 */
  double ink;       /* grey of coastlines, 0..1. Default 0.85 */
} stratus_globe;

STRATUS_API stratus_globe stratus_globe_default(void);

/* End the rays of a picture at the sphere.
 * - width, height: of the picture in pixels, 1..65536
 * - camera: its near_k and far_k are set so that all data and the sphere are between them
 * - depth: receives the image's opaque_depth, width * height numbers
 * - light: receives the light of the sphere in each pixel, the cosine to the eye; 0 where the ray passes it */
STRATUS_API stratus_status stratus_globe_end_rays(
  stratus_context* context, const stratus_globe* globe, int width, int height, stratus_camera* camera, float* depth, float* light);
/* Draw the sphere behind a picture.
 * - light: as stratus_globe_end_rays() returned it for the camera
 * - image: width, height and rgba are used: the data's picture, premultiplied */
STRATUS_API stratus_status stratus_globe_draw(
  stratus_context* context, const stratus_globe* globe, const stratus_camera* camera, const float* light, const stratus_image* image);

#ifdef __cplusplus
}
#endif

#endif
