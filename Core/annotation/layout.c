/* SPDX-License-Identifier: BSD-3-Clause
 * The one rule of where annotations are, by the size of text, which grows with the picture. */
#include "layout.h"

#include "axis_ticks.h"
#include "text.h"

#include <stdio.h>
#include <string.h>

#define USUAL_SIDE 512.0 /* pixels, of a picture with text of USUAL_SIZE */
#define USUAL_SIZE 13.0
#define LEAST_SIZE 10.0
#define GROWTH 0.75 /* power of the side by which text grows */
#define TITLE 1.15  /* size of titles */
#define TITLE_LINES 3
#define UNBROKEN '\1'    /* drawn as a space */
#define LEAST_ROOM 0.4   /* part of a side that the box has at least */
#define MOST_COLUMN 0.36 /* part of the width that the bar and its text have at most */

bool stratus_layout_has_bar(const stratus_annotation* annotation)
{
  return annotation->color && annotation->color_count > 0;
}

void stratus_layout_kilo(const stratus_annotation* annotation, int kilo[3])
{
  const stratus_axis* const axes = annotation->axis;
  double longest[3] = { 0.0, 0.0, 0.0 };
  bool metres[3];
  for (int a = 0; a < 3; ++a) {
    metres[a] = axes[a].kind == STRATUS_AXIS_NUMBER && axes[a].units && strcmp(axes[a].units, "m") == 0;
  }
  for (int a = 0; a < 3; ++a) {
    for (int side = 0; side < 6; ++side) {
      const stratus_axis* const other = &axes[side / 2];
      if (metres[side / 2] && fabs(fabs(other->scale) - fabs(axes[a].scale)) <= 1e-9 * fabs(axes[a].scale)) {
        longest[a] = fmax(longest[a], fabs(annotation->bounds[side] * other->scale));
      }
    }
    kilo[a] = metres[a] && longest[a] >= 10000.0;
  }
}

/* Shortens a line until it is at most `width` wide. */
static void shorten(char* line, double size, int width)
{
  size_t length = strlen(line);
  while (length > 0 && stratus_text_width(line, size) > width) {
    do {
      --length;
    } while (length > 0 && ((unsigned char)line[length] & 0xc0) == 0x80);
    snprintf(line + length, STRATUS_LAYOUT_BYTES - length, "\xe2\x80\xa6");
  }
  if (stratus_text_width(line, size) > width) {
    line[0] = '\0';
  }
}

/* The bytes of a text up to where a line may break: after a space or an underscore. */
static size_t piece_of(const char* text)
{
  size_t n = 0;
  while (text[n] && text[n] != ' ' && text[n] != '_' && text[n] != '\n') {
    ++n;
  }
  return n + (text[n] ? 1 : 0);
}

/* Adds a line, without the space where it broke. */
static void add_line(stratus_lines* to, char* line, double size, int width)
{
  const size_t length = strlen(line);
  if (length > 0 && line[length - 1] == ' ') {
    line[length - 1] = '\0';
  }
  shorten(line, size, width);
  snprintf(to->line[to->count++], STRATUS_LAYOUT_BYTES, "%s", line);
  line[0] = '\0';
}

/* Breaks a text into at most `most` lines. The last one is shortened if there are more. Returns whether the lines have all of the text. */
static bool break_lines(const char* text, double size, int width, int most, stratus_lines* to)
{
  char line[STRATUS_LAYOUT_BYTES] = "";
  bool all = true;
  to->count = 0;
  while (*text && to->count < most) {
    char longer[2 * STRATUS_LAYOUT_BYTES];
    const size_t piece = piece_of(text);
    const bool ends = piece > 0 && text[piece - 1] == '\n', last = to->count + 1 == most;
    const size_t shown = piece - (ends ? 1 : 0);
    snprintf(longer, sizeof longer, "%s%.*s", line, (int)(shown < 256 ? shown : 256), text);
    const bool fits = stratus_text_width(longer, size) <= width;
    if (line[0] && !fits && !last) {
      add_line(to, line, size, width);
      continue;
    }
    snprintf(line, sizeof line, "%.*s", STRATUS_LAYOUT_BYTES - 8, longer);
    text += piece;
    if (ends || !*text || (last && !fits)) {
      all = all && fits && !(last && *text);
      if (last && *text) {
        strcat(line, "\xe2\x80\xa6"); /* there is more */
      }
      add_line(to, line, size, width);
    }
  }
  return all && !*text;
}

/* Replaces the spaces of a unit, so that no line breaks there. */
static void keep_units_together(char title[STRATUS_LAYOUT_BYTES])
{
  char* const from = strrchr(title, '(');
  for (char* at = from; at && *at; ++at) {
    *at = *at == ' ' ? UNBROKEN : *at;
  }
}

static int width_of(const stratus_lines* lines, double size)
{
  int width = 0;
  for (int i = 0; i < lines->count; ++i) {
    const int one = stratus_text_width(lines->line[i], size);
    width = one > width ? one : width;
  }
  return width;
}

/* Ticks of the bar: powers of ten on a scale by logarithms, if it has two of them, else round numbers. */
static stratus_status find_bar_ticks(stratus_context* context, const stratus_annotation* a, int most, stratus_layout* layout)
{
  const double low = a->low, high = a->high;
  layout->tick_count = 0;
  if (!(low < high)) {
    layout->tick_count = 1;
    layout->tick_at[0] = 0.5;
    stratus_number_text(low, layout->tick_text[0]);
    return STRATUS_OK;
  }
  const double first = a->logarithmic ? ceil(log10(low) - 1e-9) : 0.0, last = a->logarithmic ? floor(log10(high) + 1e-9) : 0.0;
  if (a->logarithmic && last - first >= 1.0) {
    const double step = ceil((last - first + 1.0) / most);
    for (double power = first; power <= last && layout->tick_count < STRATUS_AXIS_TICKS; power += step) {
      layout->tick_at[layout->tick_count] = log(pow(10.0, power) / low) / log(high / low);
      stratus_number_text(pow(10.0, power), layout->tick_text[layout->tick_count++]);
    }
    return STRATUS_OK;
  }
  const stratus_axis plain = stratus_axis_default();
  stratus_axis_tick ticks[STRATUS_AXIS_TICKS];
  TRY(stratus_axis_find_ticks(context, &plain, 0, low, high, most, ticks, &layout->tick_count));
  for (int i = 0; i < layout->tick_count; ++i) {
    const double value = ticks[i].place;
    layout->tick_at[i] = a->logarithmic ? log(value / low) / log(high / low) : (value - low) / (high - low);
    memcpy(layout->tick_text[i], ticks[i].text, sizeof ticks[i].text);
  }
  return STRATUS_OK;
}

void stratus_layout_title(const char* name, const char* units, char title[STRATUS_LAYOUT_BYTES])
{
  const bool has_units = units && units[0] && strcmp(units, "1") != 0;
  const int at = snprintf(title, STRATUS_LAYOUT_BYTES, "%s%s", name ? name : "", has_units ? " (" : "");
  char* to = title + (at < STRATUS_LAYOUT_BYTES ? at : STRATUS_LAYOUT_BYTES - 1);
  bool raised = false;
  for (const char* from = units; has_units && *from && to < title + STRATUS_LAYOUT_BYTES - 2; ++from) {
    const bool begins = from[0] == '^' && from[1] == '{', ends = raised && *from == '}';
    if (!begins && !ends) {
      *to++ = *from;
    }
    from += begins;
    raised = begins || (raised && !ends);
  }
  if (has_units) {
    *to++ = ')';
    *to = '\0';
  }
}

/* The bar is at the right of the picture, under the caption, with its title above it. All are in a column. */
static stratus_status place_bar(stratus_context* context, const stratus_annotation* a, int width, int height, stratus_layout* layout)
{
  const double size = layout->size, title_size = layout->title_size;
  char title[STRATUS_LAYOUT_BYTES];
  stratus_layout_title(a->bar_title, a->bar_units, title);
  keep_units_together(title);
  const int gap = (int)(0.5 * size), below = height - layout->caption_height;
  TRY(find_bar_ticks(context, a, (int)fmin(fmax(0.5 * below / (2.4 * size), 1.0), 12.0), layout));
  int widest = 0, word = 0;
  for (int i = 0; i < layout->tick_count; ++i) {
    const int one = stratus_text_width(layout->tick_text[i], size);
    widest = one > widest ? one : widest;
  }
  for (const char* at = title; *at;) {
    char piece[STRATUS_LAYOUT_BYTES];
    const size_t bytes = piece_of(at);
    snprintf(piece, sizeof piece, "%.*s", (int)bytes, at);
    const int one = stratus_text_width(piece, title_size);
    word = one > word ? one : word;
    at += bytes;
  }
  layout->bar_wide = (int)(1.25 * size);
  const int own = layout->bar_wide + gap + widest, most = (int)(MOST_COLUMN * width);
  /* The narrowest column in which the title has few lines. */
  int column = word < most ? word : most;
  column = own > column ? own : column;
  bool whole = break_lines(title, title_size, column, TITLE_LINES, &layout->title);
  while (!whole && column < most) {
    column += layout->bar_wide;
    whole = break_lines(title, title_size, column, TITLE_LINES, &layout->title);
  }
  if (!whole) {
    break_lines(title, title_size, column, STRATUS_LAYOUT_LINES, &layout->title);
  }
  const int line = stratus_line_height(title_size), titles = layout->title.count * line;
  layout->bar_tall = (int)fmax(0.6 * (below - titles), 2.0);
  layout->bar_bottom = (below - titles - layout->bar_tall) / 2;
  layout->bar_left = width - layout->margin - own;
  const int titles_wide = width_of(&layout->title, title_size);
  layout->column_left = width - layout->margin - (own > titles_wide ? own : titles_wide);
  return STRATUS_OK;
}

/* The widest number of all axes. */
static stratus_status find_widest(stratus_context* context, const stratus_annotation* a, double size, int* widest)
{
  int kilo[3];
  stratus_layout_kilo(a, kilo);
  *widest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    stratus_axis_tick ticks[STRATUS_AXIS_TICKS];
    int count = 0;
    if (a->bounds[2 * axis] < a->bounds[2 * axis + 1]) {
      TRY(stratus_axis_find_ticks(context, &a->axis[axis], kilo[axis], a->bounds[2 * axis], a->bounds[2 * axis + 1], 5, ticks, &count));
    }
    for (int i = 0; i < count; ++i) {
      const int one = stratus_text_width(ticks[i].text, size);
      *widest = one > *widest ? one : *widest;
    }
  }
  return STRATUS_OK;
}

/* Leaves at least LEAST_ROOM of a side between low and high, in proportion. */
static void leave_room(double side, double* low, double* high)
{
  const double most = (1.0 - LEAST_ROOM) * side, all = *low + *high;
  if (all > most) {
    *low *= most / all;
    *high *= most / all;
  }
}

stratus_status stratus_layout_make(
  stratus_context* context, const stratus_annotation* annotation, int width, int height, stratus_layout* layout)
{
  memset(layout, 0, sizeof *layout);
  const int side = width < height ? width : height;
  layout->size = fmax(LEAST_SIZE, USUAL_SIZE * pow(side / USUAL_SIDE, GROWTH));
  layout->title_size = TITLE * layout->size;
  layout->margin = (int)fmin(layout->size, side / 16.0);
  const int line = stratus_line_height(layout->title_size);
  double left = 0.0, right = 0.0, bottom = 0.0, top = 0.0;
  if (annotation->caption && annotation->caption[0]) {
    const int most = (int)fmin(fmax(height / 4.0 / line, 1.0), STRATUS_LAYOUT_LINES);
    break_lines(annotation->caption, layout->title_size, width - 2 * layout->margin, most, &layout->caption);
    layout->caption_height = layout->caption.count * line + layout->margin;
    top = layout->caption_height;
  }
  if (stratus_layout_has_bar(annotation)) {
    TRY(place_bar(context, annotation, width, height, layout));
    right = width - layout->column_left + 0.5 * layout->size;
  }
  if (annotation->axes) {
    int widest = 0;
    TRY(find_widest(context, annotation, layout->size, &widest));
    const double number = widest + 0.8 * layout->size;
    left += number + line + 0.3 * layout->size;
    right += number;
    bottom += 3.4 * line;
    top += line;
  }
  leave_room(width, &left, &right);
  leave_room(height, &bottom, &top);
  layout->room[0] = left;
  layout->room[1] = width - right;
  layout->room[2] = bottom;
  layout->room[3] = height - top;
  return STRATUS_OK;
}
