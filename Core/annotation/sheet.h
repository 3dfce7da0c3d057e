/* SPDX-License-Identifier: BSD-3-Clause
 * A picture that lines and text are drawn onto, and which of its pixels text has taken. */
#ifndef STRATUS_SHEET_H
#define STRATUS_SHEET_H

#include "stratus/annotation.h"
#include "text.h"

/* With the last column and row. */
typedef struct stratus_pixels {
  int left, bottom, right, top;
} stratus_pixels;

typedef struct stratus_pixel_list {
  stratus_pixels* list;
  size_t count, capacity;
} stratus_pixel_list;

typedef struct stratus_sheet {
  stratus_context* context;
  int width, height;
  float* rgba; /* premultiplied */
  float ink;
  double size;     /* of text, pixels */
  float* coverage; /* of lines that are not on the picture yet, one float a pixel */
  stratus_pixel_list taken, lines;
  stratus_annotation_text* texts; /* of the caller */
  size_t most, count;
  double across[3], up[3], forward[3], eye[3]; /* of a place in the world: its u, v and k by scalar products */
  bool parallel;
} stratus_sheet;

stratus_status stratus_sheet_create(
  stratus_context* context, const stratus_camera* camera, const stratus_image* image, double ink, double size, stratus_sheet* sheet);
void stratus_sheet_destroy(stratus_sheet* sheet);

/* Finds a place in pixels. Returns false if it is behind the eye. */
bool stratus_sheet_project(const stratus_sheet* sheet, const double world[3], double at[2]);
/* Draws a line between two places in pixels or in the world. It is on the picture after stratus_sheet_lay(). */
void stratus_sheet_line(stratus_sheet* sheet, const double from[2], const double to[2]);
void stratus_sheet_line_in_world(stratus_sheet* sheet, const double from[3], const double to[3]);
/* Puts all lines behind or onto the picture. */
void stratus_sheet_lay(stratus_sheet* sheet, bool behind);

/* Returns the pixels of text of which the point `at` is at the part (across, along) of its size. */
stratus_pixels stratus_sheet_place(int width, int height, const double at[2], double across, double along);
/* Keeps other text out of these pixels. keep_off: keeps titles off a line. */
stratus_status stratus_sheet_take(stratus_sheet* sheet, stratus_pixels where);
stratus_status stratus_sheet_keep_off(stratus_sheet* sheet, const double from[2], const double to[2]);
bool stratus_pixels_meet(stratus_pixels a, stratus_pixels b);
/* Returns whether text there is whole, and meets neither other text nor, if it is a title, a line. */
bool stratus_sheet_is_free(const stratus_sheet* sheet, stratus_pixels where, bool title);
/* Writes text and takes its pixels. `part` and `line` are for the list of texts. */
stratus_status stratus_sheet_write(stratus_sheet* sheet, const stratus_text* text, stratus_pixels where, int part, const char* line);
/* The same of a line of `size`, if it is free there. */
stratus_status stratus_sheet_write_line(
  stratus_sheet* sheet, const char* line, double size, const double at[2], double across, double along, int part);
void stratus_sheet_put(stratus_sheet* sheet, int x, int y, float coverage, const float rgb[3]);

#endif
