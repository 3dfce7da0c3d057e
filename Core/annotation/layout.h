/* SPDX-License-Identifier: BSD-3-Clause
 * Where caption, colour bar and the volume's box are in a picture. */
#ifndef STRATUS_LAYOUT_H
#define STRATUS_LAYOUT_H

#include "base.h"
#include "stratus/annotation.h"

#define STRATUS_LAYOUT_LINES 4
#define STRATUS_LAYOUT_BYTES 512

/* Lines of text, from the top. */
typedef struct stratus_lines {
  char line[STRATUS_LAYOUT_LINES][STRATUS_LAYOUT_BYTES];
  int count;
} stratus_lines;

typedef struct stratus_layout {
  double size, title_size; /* of text in pixels */
  int margin;
  stratus_lines caption, title;
  int caption_height;
  /* of the bar; ticks are at the parts tick_at of its height */
  int bar_left, bar_bottom, bar_wide, bar_tall, column_left;
  char tick_text[STRATUS_AXIS_TICKS][32];
  double tick_at[STRATUS_AXIS_TICKS];
  int tick_count;
  double room[4]; /* as of stratus_annotation_room() */
} stratus_layout;

stratus_status stratus_layout_make(
  stratus_context* context, const stratus_annotation* annotation, int width, int height, stratus_layout* layout);
/* Returns whether any axis of m has numbers of km, for each axis. */
void stratus_layout_kilo(const stratus_annotation* annotation, int kilo[3]);
/* Writes "name (units)"; without units, the name. Exponents in braces, ^{-1}, are written as CF does: -1. */
void stratus_layout_title(const char* name, const char* units, char title[STRATUS_LAYOUT_BYTES]);
bool stratus_layout_has_bar(const stratus_annotation* annotation);

#endif
