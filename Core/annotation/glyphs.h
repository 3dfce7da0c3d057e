/* SPDX-License-Identifier: BSD-3-Clause
 * Letters as strokes of a pen, on a grid of whole numbers: capitals are 14 high, an x is 10, and 0 is the line that they stand on. */
#ifndef STRATUS_GLYPHS_H
#define STRATUS_GLYPHS_H

#include <stdbool.h>
#include <stdint.h>

/* `strokes`: "x,y x,y ...", joined by '|'. A stroke is a chain of lines, or after '~' a smooth curve that starts at the first point, ends
 * at the last, and touches the lines between the others in their middles. */
typedef struct stratus_glyph {
  int width; /* of the strokes; letters are 4 apart */
  const char* strokes;
} stratus_glyph;

typedef struct stratus_letter {
  const stratus_glyph* glyph;
  const char* mark; /* strokes of an accent about the letter's middle, or NULL */
  int mark_up;      /* by so much the mark is moved up */
  bool raised;      /* a superscript: smaller, and above the line */
} stratus_letter;

/* A letter by its number in Unicode: ASCII, letters of Western Europe, signs of units. Any other one is a box. */
stratus_letter stratus_letter_of(uint32_t code);

#endif
