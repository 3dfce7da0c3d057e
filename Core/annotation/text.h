/* SPDX-License-Identifier: BSD-3-Clause
 * Text as pixels. */
#ifndef STRATUS_TEXT_H
#define STRATUS_TEXT_H

#include "base.h"

/* Coverage in 0..1, bottom row first. */
typedef struct stratus_text {
  int width, height; /* > 0 */
  float* coverage;
} stratus_text;

/* Draws a line of UTF-8. `size` is the height of capitals and lowest letters together, in pixels. Release with stratus_text_destroy(). */
stratus_status stratus_text_create(stratus_context* context, const char* line, double size, stratus_text* text);
void stratus_text_destroy(stratus_context* context, stratus_text* text);
/* Turns text by a right angle, so that it is read from below. */
stratus_status stratus_text_turn(stratus_context* context, const stratus_text* text, stratus_text* turned);
/* The width that stratus_text_create() makes. */
int stratus_text_width(const char* line, double size);

/* The height that stratus_text_create() makes: less for a number, which has neither accents nor low letters, and the most of any line. */
int stratus_text_height(const char* line, double size);
int stratus_line_height(double size);

/* sqrt(x * x + y * y): glibc 2.35 has another hypot() than older ones. */
double stratus_length_2(double x, double y);

/* Reads a character of UTF-8 and moves on. Bytes that are none are characters of Latin-1. */
uint32_t stratus_text_next(const char** at);

#endif
