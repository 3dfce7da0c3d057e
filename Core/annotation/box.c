/* SPDX-License-Identifier: BSD-3-Clause
 * The volume's box: edges, ticks, numbers and titles. */
#include "box.h"

#include <stdio.h>
#include <string.h>

#define TICK 0.4       /* length of a tick, in sizes of text */
#define NUMBER 0.7     /* distance of a number from its edge */
#define APART 1.5      /* of ticks along an edge, at least */
#define GAP 0.5        /* between two numbers of an edge, at least */
#define AMONG 40.0     /* cost of a title among the numbers */
#define LEAST_EDGE 2.0 /* pixels, of an edge with numbers */

/* An edge of the box in the picture, along which an axis has its numbers. */
typedef struct edge {
  int axis;
  bool seen;
  double from[3];          /* in the world */
  double begin[2], end[2]; /* in pixels */
  double out[2], along[2]; /* across the edge, away from the box, and along it, of length 1 */
  double order;            /* edges of less order are better */
  double length, reach;    /* reach: from the edge to the far ends of its numbers */
  bool upright;
} edge;

static void corner_of(const double bounds[6], int bits, double corner[3])
{
  for (int a = 0; a < 3; ++a) {
    corner[a] = bounds[2 * a + (bits >> a & 1)];
  }
}

void stratus_box_facing(const stratus_annotation* annotation, const stratus_camera* camera, bool facing[6])
{
  for (int face = 0; face < 6; ++face) {
    const double outward = face % 2 ? 1.0 : -1.0;
    facing[face] = outward * (camera->parallel ? -camera->forward[face / 2] : camera->eye[face / 2] - annotation->bounds[face]) > 0.0;
  }
}

/* An edge is in front if one of its two faces looks at the eye. */
stratus_status stratus_box_edges(stratus_sheet* sheet, const stratus_annotation* annotation, const bool facing[6], bool behind)
{
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (int n = 0; n < 4; ++n) {
      const int bits = (n & 1) << a | (n >> 1) << b;
      if ((facing[2 * a + (n & 1)] || facing[2 * b + (n >> 1)]) == behind) {
        continue;
      }
      double from[3], to[3], begin[2], end[2];
      corner_of(annotation->bounds, bits, from);
      corner_of(annotation->bounds, bits | 1 << axis, to);
      stratus_sheet_line_in_world(sheet, from, to);
      if (stratus_sheet_project(sheet, from, begin) && stratus_sheet_project(sheet, to, end)) {
        TRY(stratus_sheet_keep_off(sheet, begin, end));
      }
    }
  }
  return STRATUS_OK;
}

/* The edge on the outline of the box that an axis has its numbers along: the lowest one in the picture, or of an axis that stands upright,
 * the leftmost. beyond_order: of the better edges that are left out, or -INFINITY. */
static edge find_edge(const stratus_sheet* sheet, const stratus_annotation* annotation, int axis, const bool facing[6], double beyond_order)
{
  const double* const bounds = annotation->bounds;
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  edge result;
  memset(&result, 0, sizeof result);
  result.axis = axis;
  double least = INFINITY, middle[2], center[3];
  for (int i = 0; i < 3; ++i) {
    center[i] = 0.5 * (bounds[2 * i] + bounds[2 * i + 1]);
  }
  for (int n = 0; n < 4; ++n) {
    const int bits = (n & 1) << a | (n >> 1) << b;
    double from[3], to[3], begin[2], end[2];
    corner_of(bounds, bits, from);
    corner_of(bounds, bits | 1 << axis, to);
    if (facing[2 * a + (n & 1)] == facing[2 * b + (n >> 1)] || !stratus_sheet_project(sheet, from, begin) ||
      !stratus_sheet_project(sheet, to, end)) {
      continue;
    }
    const bool upright = fabs(end[1] - begin[1]) > 2.0 * fabs(end[0] - begin[0]);
    const double order = upright ? begin[0] + end[0] : begin[1] + end[1];
    if (order < least && order > beyond_order) {
      least = order;
      result.order = order;
      memcpy(result.from, from, sizeof from);
      memcpy(result.begin, begin, sizeof begin);
      memcpy(result.end, end, sizeof end);
      result.upright = upright;
      result.seen = true;
    }
  }
  result.length = stratus_length_2(result.end[0] - result.begin[0], result.end[1] - result.begin[1]);
  result.seen = result.seen && result.length >= LEAST_EDGE && stratus_sheet_project(sheet, center, middle);
  if (result.seen) {
    for (int i = 0; i < 2; ++i) {
      result.along[i] = (result.end[i] - result.begin[i]) / result.length;
    }
    const double across[2] = { result.along[1], -result.along[0] };
    const bool inward = across[0] * (result.begin[0] - middle[0]) + across[1] * (result.begin[1] - middle[1]) < 0.0;
    result.out[0] = inward ? -across[0] : across[0];
    result.out[1] = inward ? -across[1] : across[1];
  }
  return result;
}

/* A point so far from an edge. */
static void beyond(const edge* where, const double at[2], double distance, double to[2])
{
  to[0] = at[0] + distance * where->out[0];
  to[1] = at[1] + distance * where->out[1];
}

static bool place_tick(const stratus_sheet* sheet, const edge* where, const stratus_axis_tick* tick, double at[2], stratus_pixels* text)
{
  double place[3] = { where->from[0], where->from[1], where->from[2] }, number[2];
  place[where->axis] = tick->place;
  const bool seen = stratus_sheet_project(sheet, place, at);
  beyond(where, at, NUMBER * sheet->size, number);
  *text = stratus_sheet_place(stratus_text_width(tick->text, sheet->size), stratus_text_height(tick->text, sheet->size), number,
    0.5 - 0.5 * where->out[0], 0.5 - 0.5 * where->out[1]);
  return seen;
}

static bool keep_apart(const stratus_sheet* sheet, const edge* where, const stratus_axis_tick* ticks, int count)
{
  const int gap = (int)(GAP * sheet->size);
  stratus_pixels last = { 0, 0, -1, -1 };
  for (int i = 0; i < count; ++i) {
    double at[2];
    stratus_pixels text;
    if (place_tick(sheet, where, &ticks[i], at, &text)) {
      if (i > 0 && stratus_pixels_meet(last, text)) {
        return false;
      }
      last = text;
      last.left -= gap;
      last.right += gap;
      last.bottom -= gap / 2;
      last.top += gap / 2;
    }
  }
  return true;
}

/* Finds as many ticks along an edge as have room for their numbers. A short axis has one number at least. `free`: how many numbers meet no
 * other text. */
static stratus_status find_numbers(const stratus_sheet* sheet, const stratus_annotation* annotation, const edge* where, int kilo,
  stratus_axis_tick ticks[STRATUS_AXIS_TICKS], int* count, int* free)
{
  const stratus_axis* const axis = &annotation->axis[where->axis];
  const double low = annotation->bounds[2 * where->axis], high = annotation->bounds[2 * where->axis + 1];
  int most = (int)fmin(where->length / (APART * sheet->size), 12.0);
  for (most = most < 1 ? 1 : most; most >= 1; --most) {
    TRY(stratus_axis_find_ticks(sheet->context, axis, kilo, low, high, most, ticks, count));
    if (*count > 0 && keep_apart(sheet, where, ticks, *count)) {
      break;
    }
  }
  for (most = 2; *count == 0 && most <= STRATUS_AXIS_TICKS; most *= 2) {
    TRY(stratus_axis_find_ticks(sheet->context, axis, kilo, low, high, most, ticks, count));
  }
  *free = 0;
  for (int i = 0; i < *count; ++i) {
    double at[2];
    stratus_pixels text;
    *free += place_tick(sheet, where, &ticks[i], at, &text) && stratus_sheet_is_free(sheet, text, false) ? 1 : 0;
  }
  return STRATUS_OK;
}

/* Draws ticks and numbers along an edge, or if no number is free there, along the next best one. */
static stratus_status draw_numbers(stratus_sheet* sheet, const stratus_annotation* annotation, const bool facing[6], edge* where, int kilo)
{
  stratus_axis_tick ticks[STRATUS_AXIS_TICKS];
  int count = 0, free = 0;
  TRY(find_numbers(sheet, annotation, where, kilo, ticks, &count, &free));
  const edge other = find_edge(sheet, annotation, where->axis, facing, where->order);
  if (free == 0 && other.seen) {
    *where = other;
    TRY(find_numbers(sheet, annotation, where, kilo, ticks, &count, &free));
  }
  for (int i = 0; i < count; ++i) {
    double at[2], end[2];
    stratus_pixels text;
    if (!place_tick(sheet, where, &ticks[i], at, &text)) {
      continue;
    }
    beyond(where, at, TICK * sheet->size, end);
    stratus_sheet_line(sheet, at, end);
    if (stratus_sheet_is_free(sheet, text, false)) {
      where->reach = fmax(where->reach,
        where->out[0] * ((where->out[0] > 0.0 ? text.right : text.left) - at[0]) +
          where->out[1] * ((where->out[1] > 0.0 ? text.top : text.bottom) - at[1]));
      stratus_text image;
      TRY(stratus_text_create(sheet->context, ticks[i].text, sheet->size, &image));
      const stratus_status status = stratus_sheet_write(sheet, &image, text, where->axis, ticks[i].text);
      stratus_text_destroy(sheet->context, &image);
      TRY(status);
    }
  }
  return STRATUS_OK;
}

/* The best place of a title that was found. */
typedef struct choice {
  double cost;
  bool turned;
  stratus_pixels where;
} choice;

static void attempt(
  const stratus_sheet* sheet, const int size[2], bool turned, const double at[2], const double to[2], double cost, choice* best)
{
  const stratus_pixels where = stratus_sheet_place(size[turned ? 1 : 0], size[turned ? 0 : 1], at, 0.5 - 0.5 * to[0], 0.5 - 0.5 * to[1]);
  if (cost < best->cost && stratus_sheet_is_free(sheet, where, true)) {
    best->cost = cost;
    best->turned = turned;
    best->where = where;
  }
}

/* As near to the middle of the edge as there is room outside of the box, along the edge of an upright axis if it can, else beyond one of
 * its ends. Costs are in pixels for text of size 13. */
static choice find_title_place(const stratus_sheet* sheet, const edge* where, const int size[2])
{
  choice best = { INFINITY, false, { 0, 0, 0, 0 } };
  const double unit = sheet->size / 13.0, back[2] = { -where->along[0], -where->along[1] };
  for (double distance = 14.0; distance <= 90.0; distance += 4.0) {
    double at[2], start[2];
    for (int i = 1; i < 20; ++i) {
      const double part = 0.05 * i, cost = distance + 60.0 * fabs(part - 0.5) + (distance * unit < where->reach ? AMONG : 0.0);
      for (int c = 0; c < 2; ++c) {
        start[c] = where->begin[c] + part * (where->end[c] - where->begin[c]);
      }
      beyond(where, start, distance * unit, at);
      attempt(sheet, size, false, at, where->out, cost + (where->upright ? 30.0 : 0.0), &best);
      if (where->upright) {
        attempt(sheet, size, true, at, where->out, cost, &best);
      }
    }
    for (int c = 0; c < 2; ++c) {
      at[c] = where->end[c] + distance * unit * where->along[c];
      start[c] = where->begin[c] + distance * unit * back[c];
    }
    attempt(sheet, size, false, at, where->along, distance + 100.0, &best);
    attempt(sheet, size, false, start, back, distance + 110.0, &best);
  }
  return best;
}

static stratus_status write_title(stratus_sheet* sheet, const char* title, double size, const choice* at, int part)
{
  stratus_text level, turned = { 0, 0, NULL };
  TRY(stratus_text_create(sheet->context, title, size, &level));
  stratus_status status = at->turned ? stratus_text_turn(sheet->context, &level, &turned) : STRATUS_OK;
  if (status == STRATUS_OK) {
    status = stratus_sheet_write(sheet, at->turned ? &turned : &level, at->where, part, title);
  }
  stratus_text_destroy(sheet->context, &level);
  stratus_text_destroy(sheet->context, &turned);
  return status;
}

/* A picture without room for a title has its name without the unit, or none. */
static stratus_status draw_title(
  stratus_sheet* sheet, const stratus_annotation* annotation, const stratus_layout* layout, const edge* where, int kilo)
{
  static const char* const letters[] = { "x", "y", "z" };
  const stratus_axis* const axis = &annotation->axis[where->axis];
  const bool degrees = axis->kind == STRATUS_AXIS_LONGITUDE || axis->kind == STRATUS_AXIS_LATITUDE;
  const char *name = axis->title && axis->title[0] ? axis->title : letters[where->axis], *units = kilo ? "km" : axis->units;
  char title[STRATUS_LAYOUT_BYTES];
  stratus_layout_title(name, degrees ? NULL : units, title);
  double size = layout->title_size;
  for (int smaller = 0; smaller < 2; ++smaller, size = sheet->size) {
    const int extent[2] = { stratus_text_width(title, size), stratus_text_height(title, size) };
    const choice best = find_title_place(sheet, where, extent);
    if (best.cost < INFINITY) {
      return write_title(sheet, title, size, &best, where->axis);
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_box_axes(
  stratus_sheet* sheet, const stratus_annotation* annotation, const stratus_layout* layout, const bool facing[6])
{
  int kilo[3];
  edge edges[3];
  stratus_layout_kilo(annotation, kilo);
  for (int axis = 0; axis < 3; ++axis) {
    edges[axis] = find_edge(sheet, annotation, axis, facing, -INFINITY);
    if (edges[axis].seen) {
      TRY(draw_numbers(sheet, annotation, facing, &edges[axis], kilo[axis]));
    }
  }
  for (int axis = 0; axis < 3; ++axis) { /* last, because titles are where there is room */
    if (edges[axis].seen) {
      TRY(draw_title(sheet, annotation, layout, &edges[axis], kilo[axis]));
    }
  }
  return STRATUS_OK;
}
