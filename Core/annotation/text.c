/* SPDX-License-Identifier: BSD-3-Clause
 * Draws letters by the distance of pixels to the strokes. */
#include "text.h"

#include "glyphs.h"

#include <stdlib.h>
#include <string.h>

#define SPACE 4           /* between letters, in units of the glyphs */
#define CAPITAL 14.0      /* height of a capital, in units of the glyphs */
#define SMALL 10.0        /* height of an x */
#define CAPITAL_PART 0.72 /* of the size */
#define HEIGHT 18.0       /* of a capital with its accent, and DEPTH of the lowest letters */
#define DEPTH 4.0
#define RAISED_SIZE 0.62
#define RAISED_BY 6.0
#define CURVE 6 /* lines of each part of a curve */

double stratus_length_2(double x, double y)
{
  return sqrt(x * x + y * y);
}

/* The places of a glyph's units in pixels, so that straight strokes are in the middles of pixels. */
typedef struct pen {
  double unit, wide, small, capital, half; /* half: of the stroke's width */
  int left, base;                          /* pixel of the line's begin */
  double squeeze;                          /* of a raised letter, else 1 */
  int width;                               /* of the glyph */
} pen;

static double place_y(const pen* p, double y)
{
  if (p->squeeze < 1.0) {
    return p->base + (RAISED_BY + y * p->squeeze) * p->unit;
  }
  const double at = y <= 0.0 ? y * p->unit
    : y <= SMALL             ? y / SMALL * p->small
                             : p->small + (y - SMALL) / (CAPITAL - SMALL) * (p->capital - p->small);
  return p->base + at;
}

static double place_x(const pen* p, double x)
{
  return p->left + (p->width > 0 ? x / p->width * p->wide : x * p->unit);
}

static pen pen_of(double size)
{
  pen p = { CAPITAL_PART * size / CAPITAL, 0.0, 0.0, 0.0, 0.0, 0, 0, 1.0, 0 };
  p.small = fmax(round(SMALL * p.unit), 3.0);
  p.capital = fmax(round(CAPITAL * p.unit), p.small + 2.0);
  p.half = fmax(0.5 * 1.65 * p.unit, 0.55);
  return p;
}

static double advance(const pen* p, const stratus_letter* letter)
{
  const double unit = p->unit * (letter->raised ? RAISED_SIZE : 1.0);
  return round(letter->glyph->width * unit) + fmax(round(SPACE * unit), 2.0);
}

uint32_t stratus_text_next(const char** at)
{
  const unsigned char first = (unsigned char)*(*at)++;
  const int more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : first >= 0xc2 ? 1 : 0;
  uint32_t code = more == 3 ? first & 7u : more == 2 ? first & 15u : more == 1 ? first & 31u : first;
  for (int i = 0; i < more; ++i) {
    if (((unsigned char)(*at)[i] & 0xc0) != 0x80) {
      return first;
    }
    code = code << 6 | ((unsigned char)(*at)[i] & 0x3fu);
  }
  *at += more;
  return code;
}

int stratus_text_width(const char* line, double size)
{
  const pen p = pen_of(size);
  const double edge = ceil(p.half);
  double width = 2.0 * edge + 1.0;
  for (const char* at = line; *at;) {
    const stratus_letter letter = stratus_letter_of(stratus_text_next(&at));
    width += advance(&p, &letter);
  }
  return (int)width;
}

static void draw_line(stratus_text* text, const pen* p, const double a[2], const double b[2])
{
  const double reach = p->half + 1.0, dx = b[0] - a[0], dy = b[1] - a[1], square = fmax(dx * dx + dy * dy, 1e-12);
  const int x0 = (int)fmax(floor(fmin(a[0], b[0]) - reach), 0.0), x1 = (int)fmin(ceil(fmax(a[0], b[0]) + reach), text->width - 1);
  const int y0 = (int)fmax(floor(fmin(a[1], b[1]) - reach), 0.0), y1 = (int)fmin(ceil(fmax(a[1], b[1]) + reach), text->height - 1);
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const double t = fmin(fmax(((x - a[0]) * dx + (y - a[1]) * dy) / square, 0.0), 1.0);
      const double distance = stratus_length_2(x - a[0] - t * dx, y - a[1] - t * dy);
      float* const to = &text->coverage[(size_t)y * (size_t)text->width + (size_t)x];
      *to = fmaxf(*to, (float)fmin(fmax(p->half + 0.5 - distance, 0.0), 1.0));
    }
  }
}

static void draw_part(stratus_text* text, const pen* p, const double a[2], const double c[2], const double b[2])
{
  double last[2] = { a[0], a[1] };
  for (int i = 1; i <= CURVE; ++i) {
    const double t = (double)i / CURVE, s = 1.0 - t;
    const double next[2] = { s * s * a[0] + 2.0 * s * t * c[0] + t * t * b[0], s * s * a[1] + 2.0 * s * t * c[1] + t * t * b[1] };
    draw_line(text, p, last, next);
    last[0] = next[0];
    last[1] = next[1];
  }
}

static void draw_stroke(stratus_text* text, const pen* p, const double (*points)[2], int count, bool curve)
{
  if (!curve || count < 3) {
    for (int i = 0; i + 1 < count; ++i) {
      draw_line(text, p, points[i], points[i + 1]);
    }
    return;
  }
  double from[2] = { points[0][0], points[0][1] };
  for (int i = 1; i + 1 < count; ++i) {
    const bool last = i + 2 == count;
    const double to[2] = { last ? points[i + 1][0] : 0.5 * (points[i][0] + points[i + 1][0]),
      last ? points[i + 1][1] : 0.5 * (points[i][1] + points[i + 1][1]) };
    draw_part(text, p, from, points[i], to);
    from[0] = to[0];
    from[1] = to[1];
  }
}

static void draw_strokes(stratus_text* text, const pen* p, const char* strokes, double right, double up)
{
  double points[16][2];
  while (*strokes) {
    const bool curve = *strokes == '~';
    int count = 0;
    strokes += curve ? 1 : 0;
    while (*strokes && *strokes != '|') {
      char* end;
      const double x = (double)strtol(strokes, &end, 10);
      const double y = (double)strtol(end + 1, &end, 10);
      points[count][0] = place_x(p, x + right);
      points[count][1] = place_y(p, y + up);
      count += count < 15 ? 1 : 0;
      strokes = end + (*end == ' ' ? 1 : 0);
    }
    draw_stroke(text, p, (const double(*)[2])points, count, curve);
    strokes += *strokes ? 1 : 0;
  }
}

static int base_of(const pen* p, bool number)
{
  return (int)(ceil((number ? 0.0 : DEPTH) * p->unit) + ceil(p->half));
}

static int height_of(const pen* p, bool number)
{
  return base_of(p, number) + (int)(ceil((number ? 0.0 : HEIGHT - CAPITAL) * p->unit) + p->capital + ceil(p->half)) + 1;
}

int stratus_line_height(double size)
{
  const pen p = pen_of(size);
  return height_of(&p, false);
}

/* Whether a line has only letters of numbers, which are neither higher than a capital nor lower than the line. */
static bool is_number(const char* line)
{
  for (const char* at = line; *at;) {
    const uint32_t code = stratus_text_next(&at);
    if (code != 0xb0 && (code > '~' || !strchr("0123456789.+-eNESW", (int)code))) {
      return false;
    }
  }
  return true;
}

int stratus_text_height(const char* line, double size)
{
  const pen p = pen_of(size);
  return height_of(&p, is_number(line));
}

stratus_status stratus_text_create(stratus_context* context, const char* line, double size, stratus_text* text)
{
  pen p = pen_of(size);
  text->width = stratus_text_width(line, size);
  text->height = stratus_text_height(line, size);
  p.base = base_of(&p, is_number(line));
  void* memory = NULL;
  TRY(stratus_allocate_zero(context, (size_t)text->width * (size_t)text->height, sizeof(float), &memory));
  text->coverage = memory;
  p.left = (int)ceil(p.half) + (int)fmax(round(0.5 * SPACE * p.unit), 1.0);
  for (const char* at = line; *at;) {
    const stratus_letter letter = stratus_letter_of(stratus_text_next(&at));
    p.squeeze = letter.raised ? RAISED_SIZE : 1.0;
    p.width = letter.glyph->width;
    p.wide = round(p.width * p.unit * p.squeeze);
    draw_strokes(text, &p, letter.glyph->strokes, 0.0, 0.0);
    if (letter.mark) {
      draw_strokes(text, &p, letter.mark, 0.5 * p.width, letter.mark_up);
    }
    p.left += (int)advance(&p, &letter);
  }
  return STRATUS_OK;
}

void stratus_text_destroy(stratus_context* context, stratus_text* text)
{
  stratus_release(context, text->coverage);
  text->coverage = NULL;
}

stratus_status stratus_text_turn(stratus_context* context, const stratus_text* text, stratus_text* turned)
{
  turned->width = text->height;
  turned->height = text->width;
  void* memory = NULL;
  TRY(stratus_allocate(context, (size_t)text->width * (size_t)text->height, sizeof(float), &memory));
  turned->coverage = memory;
  for (int j = 0; j < text->height; ++j) {
    for (int i = 0; i < text->width; ++i) {
      turned->coverage[i * turned->width + text->height - 1 - j] = text->coverage[j * text->width + i];
    }
  }
  return STRATUS_OK;
}
