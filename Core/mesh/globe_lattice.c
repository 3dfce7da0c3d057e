/* SPDX-License-Identifier: BSD-3-Clause
 * Lattices of longitudes and latitudes that close a sphere without gap or overlap. */
#include "stratus/globe.h"

#include "base.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define DEGREE 0.017453292519943295
#define SAME 1e-3       /* of a step of the lattice: points are the same but for rounding */
#define NEXT 1.5        /* steps: columns are next to each other */
#define DISTINCT 1e-9   /* of the radius: points of a row are apart; closer ones are at a pole */
#define EXCEPTIONS 3    /* points of a folded row that may be no mirror images, where columns repeat */
#define MOST_REPEATED 3 /* columns that repeat the first ones, in addition to the first */
#define POINTS_MAX ((int64_t)1 << 40)

static void on_sphere(const double degrees[2], double unit[3])
{
  const double across = cos(degrees[1] * DEGREE);
  unit[0] = across * cos(degrees[0] * DEGREE);
  unit[1] = across * sin(degrees[0] * DEGREE);
  unit[2] = sin(degrees[1] * DEGREE);
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Chord between two points. NaN if one is unknown. */
static double apart(const double* a, const double* b)
{
  const double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
  return sqrt(dot(d, d));
}

/* Units of all points: `at` returns that of a column and row. */
typedef struct sphere {
  int64_t columns, rows;
  const double* unit;
} sphere;

static const double* at(const sphere* s, int64_t column, int64_t row)
{
  return s->unit + 3 * (row * s->columns + column);
}

/* Returns whether the last column is within `most` steps of another column in all rows that are known, and that there are such rows. */
static bool last_is_near(const sphere* s, int64_t other, double most)
{
  const int64_t last = s->columns - 1;
  bool any = false;
  for (int64_t j = 0; j < s->rows; ++j) {
    const double step = 0.5 * (apart(at(s, 0, j), at(s, 1, j)) + apart(at(s, last - 1, j), at(s, last, j)));
    if (isfinite(step) && step > DISTINCT) { /* else the row is a pole */
      if (!(apart(at(s, last, j), at(s, other, j)) < most * step)) {
        return false;
      }
      any = true;
    }
  }
  return any;
}

/* Finds the columns that go round once. */
static void find_columns(const sphere* s, stratus_globe_lattice* lattice)
{
  lattice->columns = s->columns;
  for (int64_t n = 0; n <= MOST_REPEATED && !lattice->closed; ++n) { /* the last column is the data's column n */
    if (s->columns > n + 3 && last_is_near(s, n, SAME)) {
      lattice->columns = s->columns - n - 1;
      lattice->repeated_columns = n;
      lattice->closed = 1;
    }
  }
  /* two columns are always next to each other */
  if (!lattice->closed && s->columns > 2 && last_is_near(s, 0, NEXT)) {
    lattice->closed = 1;
  }
}

/* Finds the number of which the columns of points in `row` and of their mirror images in `other` are the sum, modulo the columns. A mirror
 * image is the same point, or, if `steps` is not 0, within so many steps of the rows. Returns -1 if there is none. */
static int64_t find_mirror(const sphere* s, int64_t columns, int64_t row, int64_t other, double steps)
{
  for (int64_t sum = 0; sum < columns; ++sum) {
    int64_t known = 0, wrong = 0;
    for (int64_t i = 0; i < columns && wrong <= EXCEPTIONS; ++i) {
      const double* const own = at(s, i, row);
      const double step = steps > 0.0 ? steps * apart(own, at(s, i, row - 1)) : SAME * apart(own, at(s, (i + 1) % columns, row));
      const double distance = apart(own, at(s, (sum - i + columns) % columns, other));
      if (isfinite(step) && step > SAME * DISTINCT && isfinite(distance)) {
        ++known;
        wrong += distance < step ? 0 : 1;
      }
    }
    if (known - wrong > columns / 2 && wrong <= EXCEPTIONS) {
      return sum;
    }
  }
  return -1;
}

/* Finds the pole of the circle that a row is, from three of its points. Returns false if they are not known. */
static bool find_pole(const double* one, const double* second, const double* third, double pole[3])
{
  double u[3], v[3];
  for (int a = 0; a < 3; ++a) {
    u[a] = second[a] - one[a];
    v[a] = third[a] - one[a];
  }
  pole[0] = u[1] * v[2] - u[2] * v[1];
  pole[1] = u[2] * v[0] - u[0] * v[2];
  pole[2] = u[0] * v[1] - u[1] * v[0];
  const double length = (dot(pole, one) < 0.0 ? -1.0 : 1.0) * sqrt(dot(pole, pole));
  for (int a = 0; a < 3; ++a) {
    pole[a] /= length;
  }
  return isfinite(dot(pole, pole));
}

/* Returns whether points of a row are apart; otherwise they are a pole, or unknown. */
static bool is_spread(const sphere* s, int64_t columns, int64_t row)
{
  for (int64_t i = 0; i + 1 < columns; ++i) {
    if (apart(at(s, i, row), at(s, i + 1, row)) > DISTINCT) {
      return true;
    }
  }
  return false;
}

/* Returns whether a row is around a pole and next to it. `next`: the row on its other side. */
static bool is_next_to_pole(const sphere* s, int64_t columns, int64_t row, int64_t next)
{
  double pole[3];
  if (columns < 3 || !is_spread(s, columns, row) || !find_pole(at(s, 0, row), at(s, columns / 3, row), at(s, 2 * columns / 3, row), pole)) {
    return false;
  }
  const double left = asin(fmin(0.5 * apart(at(s, 0, row), pole), 1.0)), beyond = asin(fmin(0.5 * apart(at(s, 0, next), pole), 1.0)),
               step = beyond - left;
  if (!(left > SAME * step && left <= (1.0 + SAME) * step)) {
    return false;
  }
  for (int64_t i = 1; i < columns; ++i) {
    if (!(fabs(asin(fmin(0.5 * apart(at(s, i, row), pole), 1.0)) - left) < SAME * step)) {
      return false;
    }
  }
  return true;
}

/* Finds rows that close a lattice of closed columns. */
static void find_rows(const sphere* s, stratus_globe_lattice* lattice)
{
  const int64_t n = lattice->columns, last = s->rows - 1;
  lattice->rows = s->rows;
  if (s->rows < 2) {
    return;
  }
  lattice->pole_before = is_next_to_pole(s, n, 0, 1);
  lattice->pole_after = is_next_to_pole(s, n, last, last - 1);
  if (s->rows < 4 || lattice->pole_after) {
    return;
  }
  if (find_mirror(s, n, last, last - 2, 0.0) >= 0) { /* the seam goes through points of the last row but one */
    lattice->rows = last;
    lattice->repeated_rows = 1;
    return;
  }
  lattice->seam = find_mirror(s, n, last, last - 1, 0.0);
  if (lattice->seam >= 0) { /* the seam is between the last rows, of which one is enough */
    lattice->rows = last;
    lattice->repeated_rows = 1;
  } else if (is_spread(s, n, last) && find_mirror(s, n, last, last, 0.0) < 0) { /* else the seam goes through points of the last row */
    lattice->seam = find_mirror(s, n, last, last, NEXT);
  }
}

stratus_status stratus_globe_find_lattice(
  stratus_context* context, int64_t columns, int64_t rows, const double* degrees, stratus_globe_lattice* lattice)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!degrees || !lattice) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "degrees or lattice is NULL");
  }
  if (columns < 2 || rows < 2 || columns > POINTS_MAX / rows) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "a globe's lattice of %lld x %lld points, must be at least 2 x 2, at most %lld in all", (long long)columns, (long long)rows,
      (long long)POINTS_MAX);
  }
  const size_t count = (size_t)columns * (size_t)rows;
  void* memory;
  TRY(stratus_allocate(context, 3 * count, sizeof(double), &memory));
  double* const unit = memory;
  for (size_t i = 0; i < count; ++i) {
    on_sphere(degrees + 2 * i, unit + 3 * i);
  }
  const sphere s = { columns, rows, unit };
  stratus_globe_lattice found = { .data_columns = columns, .data_rows = rows, .rows = rows, .seam = -1 };
  find_columns(&s, &found);
  if (found.closed) {
    find_rows(&s, &found);
  }
  stratus_release(context, unit);
  *lattice = found;
  return STRATUS_OK;
}

int64_t stratus_globe_columns(const stratus_globe_lattice* lattice)
{
  return lattice ? lattice->columns + lattice->closed : 0;
}

int64_t stratus_globe_rows(const stratus_globe_lattice* lattice)
{
  return lattice ? lattice->rows + lattice->pole_before + lattice->pole_after + (lattice->seam >= 0) : 0;
}

int64_t stratus_globe_source(const stratus_globe_lattice* lattice, int64_t column, int64_t row, int64_t* first, int64_t* stride)
{
  if (!lattice || !first || !stride || column < 0 || row < 0 || column >= stratus_globe_columns(lattice) ||
    row >= stratus_globe_rows(lattice)) {
    return 0;
  }
  const int64_t own = row - lattice->pole_before, i = column % lattice->columns;
  *stride = 1;
  if (own < 0) {
    *first = 0;
    return lattice->columns;
  }
  if (own < lattice->rows) {
    *first = own * lattice->data_columns + i;
    return 1;
  }
  *first = (lattice->rows - 1) * lattice->data_columns;
  if (lattice->pole_after) {
    return lattice->columns;
  }
  *first += i;
  *stride = (lattice->seam - i + lattice->columns) % lattice->columns - i;
  return 2;
}

void stratus_globe_describe(const stratus_globe_lattice* lattice, char* text, size_t size)
{
  if (!text || size < 1) {
    return;
  }
  text[0] = '\0';
  if (!lattice) {
    return;
  }
  char columns[80] = "";
  if (lattice->repeated_columns > 0) {
    snprintf(columns, sizeof columns, ", without %lld columns that repeat the first ones", (long long)lattice->repeated_columns);
  } else if (lattice->closed && lattice->columns == lattice->data_columns) {
    snprintf(columns, sizeof columns, ", closed from the last column to the first");
  }
  snprintf(text, size, "%s%s%s%s", columns, lattice->repeated_rows > 0 ? ", without the last row, which repeats another one" : "",
    lattice->seam >= 0 ? ", closed at the seam between two poles" : "",
    lattice->pole_before && lattice->pole_after     ? ", closed at both poles"
      : lattice->pole_before || lattice->pole_after ? ", closed at a pole"
                                                    : "");
}

/* ---- places */

double stratus_globe_height_factor(double low, double high)
{
  return high > low ? 0.1 * STRATUS_EARTH_RADIUS / (high - low) : 1.0;
}

/* A point of the lattice: its direction, and the mean of its heights. */
typedef struct place {
  double unit[3], height;
} place;

static bool is_known(const stratus_globe_points* from, const double* degrees, int64_t point, int64_t level)
{
  const double height = from->heights[(level * from->count + point) * from->height_stride];
  return isfinite(degrees[2 * point]) && isfinite(degrees[2 * point + 1]) && isfinite(height);
}

/* Finds the place of the points first, first + stride ... Returns false if none is known. `unit`: NULL, or the known direction. */
static bool find_place(const stratus_globe_points* from, const double* degrees, int64_t level, int64_t first, int64_t stride, int64_t count,
  const double* unit, place* to)
{
  double sum[3] = { 0.0, 0.0, 0.0 }, height = 0.0, known = 0.0;
  for (int64_t n = 0; n < count; ++n) {
    const int64_t point = first + n * stride;
    if (!is_known(from, degrees, point, level)) {
      continue;
    }
    if (!unit) {
      double one[3];
      on_sphere(degrees + 2 * point, one);
      for (int a = 0; a < 3; ++a) {
        sum[a] += one[a];
      }
    }
    height += from->heights[(level * from->count + point) * from->height_stride];
    known += 1.0;
  }
  const double length = count > 1 ? sqrt(dot(sum, sum)) : 1.0;
  for (int a = 0; a < 3; ++a) {
    to->unit[a] = unit ? unit[a] : sum[a] / length;
  }
  to->height = height / known;
  return known > 0.0;
}

/* Finds the pole that the row of the data is around. */
static bool find_pole_of_row(const stratus_globe_points* from, const double* degrees, int64_t row, double pole[3])
{
  const int64_t n = from->lattice->columns, first = row * from->lattice->data_columns;
  double three[3][3];
  for (int i = 0; i < 3; ++i) {
    on_sphere(degrees + 2 * (first + i * n / 3), three[i]);
  }
  return find_pole(three[0], three[1], three[2], pole);
}

/* The directions of a level's poles and of its points, which all levels share if their degrees are the same. */
typedef struct level_units {
  double pole[2][3];
  double* unit; /* of the lattice's points, or of the data's; NaN: unknown */
} level_units;

static int64_t columns_of(const stratus_globe_points* from)
{
  return from->lattice ? stratus_globe_columns(from->lattice) : from->count;
}

static int64_t rows_of(const stratus_globe_points* from)
{
  return from->lattice ? stratus_globe_rows(from->lattice) : 1;
}

/* Returns the number of the data's points that make one of the lattice, as stratus_globe_source(). pole: receives 0, 1, or -1 for none. */
static int64_t source_of(const stratus_globe_points* from, int64_t column, int64_t row, int64_t* first, int64_t* stride, int* pole)
{
  *pole = -1;
  if (!from->lattice) {
    *first = column;
    *stride = 1;
    return 1;
  }
  const stratus_globe_lattice* const l = from->lattice;
  *pole = l->pole_before && row == 0 ? 0 : l->pole_after && row == stratus_globe_rows(l) - 1 ? 1 : -1;
  return stratus_globe_source(l, column, row, first, stride);
}

static stratus_status put(stratus_context* context, const stratus_globe_points* from, const place* p, double* point)
{
  const double radius = STRATUS_EARTH_RADIUS + from->factor * p->height;
  if (!(radius > 0.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "a height of %.9g m times %.9g is below the middle of the Earth: the factor of heights must be less than %.9g", p->height,
      from->factor, -STRATUS_EARTH_RADIUS / p->height);
  }
  for (int a = 0; a < 3; ++a) {
    point[a] = radius * p->unit[a];
  }
  return STRATUS_OK;
}

/* Places a level. `units` receives the directions of all its points, or has them already. last: the last point that is known, or NULL. */
static stratus_status place_level(stratus_context* context, const stratus_globe_points* from, int64_t level, bool has_units,
  level_units* units, double* points, double** last)
{
  const double* const degrees = from->degrees + (from->degrees_of_levels ? 2 * from->count * level : 0);
  const int64_t columns = columns_of(from), rows = rows_of(from);
  if (!has_units && from->lattice) {
    (void)find_pole_of_row(from, degrees, 0, units->pole[0]);
    (void)find_pole_of_row(from, degrees, from->lattice->rows - 1, units->pole[1]);
  }
  for (int64_t j = 0; j < rows; ++j) {
    for (int64_t i = 0; i < columns; ++i) {
      int64_t first, stride;
      int pole;
      const int64_t count = source_of(from, i, j, &first, &stride, &pole), index = j * columns + i;
      double* const unit = units->unit + 3 * index;
      const double* const known = pole >= 0 ? units->pole[pole] : has_units && isfinite(unit[0]) ? unit : NULL;
      double* const point = points + 3 * (level * rows * columns + index);
      place p;
      if (find_place(from, degrees, level, first, stride, count, known, &p)) {
        TRY(put(context, from, &p, point));
        memcpy(unit, p.unit, sizeof p.unit);
        *last = point;
      } else {
        unit[0] = has_units ? unit[0] : NAN;
        point[0] = NAN; /* until a known one is found */
        if (*last) {
          memcpy(point, *last, 3 * sizeof *point);
        }
      }
    }
  }
  return STRATUS_OK;
}

static stratus_status check_points(stratus_context* context, const stratus_globe_points* from, const double* points)
{
  if (!from || !points || !from->degrees || !from->heights) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "from, its degrees, its heights or points is NULL");
  }
  const stratus_globe_lattice* const l = from->lattice;
  if (l &&
    (l->columns < 2 || l->rows < 1 || l->columns > l->data_columns || l->rows > l->data_rows || l->seam >= l->columns ||
      from->count != l->data_columns * l->data_rows)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%lld points of a level of a lattice of %lld x %lld points, must be %lld",
      (long long)from->count, (long long)l->data_columns, (long long)l->data_rows, (long long)(l->data_columns * l->data_rows));
  }
  if (from->count < 1 || from->levels < 1 || from->height_stride < 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%lld points in %lld levels with heights %lld apart, each must be at least 1",
      (long long)from->count, (long long)from->levels, (long long)from->height_stride);
  }
  if (!(from->factor > 0.0) || !isfinite(from->factor)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "a factor of heights of %g, must be above 0 and finite", from->factor);
  }
  return STRATUS_OK;
}

stratus_status stratus_globe_place(stratus_context* context, const stratus_globe_points* from, double* points)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  TRY(check_points(context, from, points));
  const size_t count = (size_t)columns_of(from) * (size_t)rows_of(from);
  void* memory;
  TRY(stratus_allocate(context, 3 * count, sizeof(double), &memory));
  level_units units = { .unit = memory };
  double* last = NULL;
  stratus_status status = STRATUS_OK;
  for (int64_t k = 0; k < from->levels && status == STRATUS_OK; ++k) {
    status = place_level(context, from, k, k > 0 && !from->degrees_of_levels, &units, points, &last);
  }
  stratus_release(context, units.unit);
  TRY(status);
  if (!last) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "no point has a longitude, a latitude and a height that are finite");
  }
  size_t known = 0;
  while (isnan(points[3 * known])) {
    ++known;
  }
  for (size_t i = 0; i < known; ++i) {
    memcpy(points + 3 * i, points + 3 * known, 3 * sizeof *points);
  }
  return STRATUS_OK;
}
