/* SPDX-License-Identifier: BSD-3-Clause
 * Coastlines on the box of a volume. */
#include "box.h"

#include "coast_lines.h"

#define DEGREE 0.017453292519943295

int stratus_coast_face(const stratus_annotation* annotation)
{
  int longitude = -1, latitude = -1;
  for (int a = 0; a < 3; ++a) {
    longitude = annotation->axis[a].kind == STRATUS_AXIS_LONGITUDE ? a : longitude;
    latitude = annotation->axis[a].kind == STRATUS_AXIS_LATITUDE ? a : latitude;
  }
  if (longitude < 0 || latitude < 0) {
    return -1;
  }
  const int third = 3 - longitude - latitude;
  return 2 * third + (annotation->axis[third].kind != STRATUS_AXIS_LEVELS && annotation->axis[third].scale < 0.0 ? 1 : 0);
}

/* Cuts a line to a box, by Liang and Barsky. Returns false if nothing is left. */
static bool clip(const double bounds[4], double from[2], double to[2])
{
  const double d[2] = { to[0] - from[0], to[1] - from[1] }, start[2] = { from[0], from[1] };
  double first = 0.0, last = 1.0;
  for (int a = 0; a < 2; ++a) {
    for (int side = 0; side < 2; ++side) {
      const double into = side ? -d[a] : d[a], beyond = side ? start[a] - bounds[2 * a + 1] : bounds[2 * a] - start[a];
      if (into == 0.0) {
        if (beyond > 0.0) {
          return false;
        }
      } else if (into > 0.0) {
        first = fmax(first, beyond / into);
      } else {
        last = fmin(last, beyond / into);
      }
    }
  }
  for (int a = 0; a < 2; ++a) {
    from[a] = start[a] + first * d[a];
    to[a] = start[a] + last * d[a];
  }
  return first < last;
}

void stratus_coast_within(const double bounds[4], stratus_coast_visit* visit, void* data)
{
  const double first = floor((bounds[0] + 180.0) / 360.0), last = ceil((bounds[1] - 180.0) / 360.0);
  for (double turn = first; turn <= last; turn += 1.0) {
    const int16_t* at = stratus_coast_lines;
    while (at[0] > 0) {
      const int count = at[0];
      for (int i = 1; i < count; ++i) {
        const int16_t* const p = at + 1 + 2 * (i - 1);
        double from[2] = { p[0] / STRATUS_COAST_UNITS + 360.0 * turn, p[1] / STRATUS_COAST_UNITS },
               to[2] = { p[2] / STRATUS_COAST_UNITS + 360.0 * turn, p[3] / STRATUS_COAST_UNITS };
        if (clip(bounds, from, to)) {
          visit(data, from, to);
        }
      }
      at += 1 + 2 * count;
    }
  }
}

typedef struct plane {
  stratus_sheet* sheet;
  const stratus_annotation* annotation;
  int face, axis[2]; /* axes of longitude and latitude */
} plane;

static void draw_piece(void* data, const double from[2], const double to[2])
{
  const plane* const p = data;
  double a[3], b[3];
  a[p->face / 2] = b[p->face / 2] = p->annotation->bounds[p->face];
  for (int i = 0; i < 2; ++i) {
    a[p->axis[i]] = from[i] / p->annotation->axis[p->axis[i]].scale;
    b[p->axis[i]] = to[i] / p->annotation->axis[p->axis[i]].scale;
  }
  stratus_sheet_line_in_world(p->sheet, a, b);
}

void stratus_coast_draw(stratus_sheet* sheet, const stratus_annotation* annotation)
{
  plane p = { sheet, annotation, stratus_coast_face(annotation), { 0, 0 } };
  double bounds[4];
  for (int a = 0; a < 3; ++a) {
    const stratus_axis* const axis = &annotation->axis[a];
    const int i = axis->kind == STRATUS_AXIS_LONGITUDE ? 0 : axis->kind == STRATUS_AXIS_LATITUDE ? 1 : -1;
    if (i >= 0) {
      const double one = annotation->bounds[2 * a] * axis->scale, other = annotation->bounds[2 * a + 1] * axis->scale;
      p.axis[i] = a;
      bounds[2 * i] = fmin(one, other);
      bounds[2 * i + 1] = fmax(one, other);
    }
  }
  stratus_coast_within(bounds, draw_piece, &p);
}

typedef struct globe {
  stratus_sheet* sheet;
  double radius;
} globe;

/* Gives a place on the sphere. Returns whether it is on the side that faces the eye. */
static bool place_on_globe(const globe* g, const double degrees[2], double place[3])
{
  const stratus_sheet* const s = g->sheet;
  const double longitude = degrees[0] * DEGREE, latitude = degrees[1] * DEGREE;
  double faces = 0.0;
  place[0] = g->radius * cos(latitude) * cos(longitude);
  place[1] = g->radius * cos(latitude) * sin(longitude);
  place[2] = g->radius * sin(latitude);
  for (int a = 0; a < 3; ++a) {
    faces += place[a] * (s->parallel ? -s->forward[a] : s->eye[a] - place[a]);
  }
  return faces > 0.0;
}

static void draw_on_globe(void* data, const double from[2], const double to[2])
{
  const globe* const g = data;
  double a[3], b[3];
  if (place_on_globe(g, from, a) && place_on_globe(g, to, b)) {
    stratus_sheet_line_in_world(g->sheet, a, b);
  }
}

void stratus_coast_draw_globe(stratus_sheet* sheet, double radius)
{
  static const double all[4] = { -180.0, 180.0, -90.0, 90.0 };
  globe g = { sheet, radius };
  stratus_coast_within(all, draw_on_globe, &g);
}
