/* SPDX-License-Identifier: BSD-3-Clause
 * Coastlines on the box of a volume. */
#include "box.h"

#include "coast_lines.h"

#define DEGREE 0.017453292519943295
#define PIECE 0.5 /* degrees: projections bend lines that are longer */
#define BENT 0.25 /* of the length of a piece: its middle is at most this far from the middle of its ends, otherwise it is torn */

int stratus_coast_face(const stratus_annotation* annotation)
{
  int longitude = annotation->coast_place ? 0 : -1, latitude = annotation->coast_place ? 1 : -1;
  for (int a = 0; a < 3 && !annotation->coast_place; ++a) {
    longitude = annotation->axis[a].kind == STRATUS_AXIS_LONGITUDE ? a : longitude;
    latitude = annotation->axis[a].kind == STRATUS_AXIS_LATITUDE ? a : latitude;
  }
  if (longitude < 0 || latitude < 0) {
    return -1;
  }
  const int third = 3 - longitude - latitude;
  return 2 * third + (annotation->axis[third].kind != STRATUS_AXIS_LEVELS && annotation->axis[third].scale < 0.0 ? 1 : 0);
}

/* Cuts a line to a box of x and y, by Liang and Barsky. Returns false if nothing is left. */
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

/* Coastlines on the plane of a projection. */
typedef struct projected {
  stratus_sheet* sheet;
  const stratus_annotation* annotation;
  int face;
} projected;

static bool place_on_plane(const projected* p, const double from[2], const double to[2], double part, double place[2])
{
  const double degrees[2] = { from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1]) };
  return p->annotation->coast_place(p->annotation->coast_data, degrees, place) && isfinite(place[0]) && isfinite(place[1]);
}

static double length_of(double x, double y)
{
  return sqrt(x * x + y * y);
}

static void draw_projected(void* data, const double from[2], const double to[2])
{
  const projected* const p = data;
  const double longest = fmax(fabs(to[0] - from[0]), fabs(to[1] - from[1]));
  const int count = (int)ceil(longest / PIECE);
  double a[3], b[3], middle[2], next[2];
  bool known = place_on_plane(p, from, to, 0.0, next);
  for (int i = 0; i < count; ++i) {
    const bool begins = known;
    a[0] = next[0];
    a[1] = next[1];
    known = place_on_plane(p, from, to, (i + 1.0) / count, next);
    if (!begins || !known || !place_on_plane(p, from, to, (i + 0.5) / count, middle)) {
      continue;
    }
    const double aside = length_of(middle[0] - 0.5 * (a[0] + next[0]), middle[1] - 0.5 * (a[1] + next[1]));
    b[0] = next[0];
    b[1] = next[1];
    if (aside <= BENT * length_of(b[0] - a[0], b[1] - a[1]) && clip(p->annotation->bounds, a, b)) {
      a[2] = b[2] = p->annotation->bounds[p->face];
      stratus_sheet_line_in_world(p->sheet, a, b);
    }
  }
}

static const double all_of_earth[4] = { -180.0, 180.0, -90.0, 90.0 };

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
  if (annotation->coast_place) {
    projected on = { sheet, annotation, p.face };
    stratus_coast_within(all_of_earth, draw_projected, &on);
    return;
  }
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
  globe g = { sheet, radius };
  stratus_coast_within(all_of_earth, draw_on_globe, &g);
}
