/* SPDX-License-Identifier: BSD-3-Clause
 * Lattices of longitudes and latitudes that close a sphere without gap or overlap. */
#include "stratus/globe.h"

#include "globe_direction.h"

#include "base.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define SAME 1e-3       /* of a step of the lattice: points are the same but for rounding */
#define NEXT 1.5        /* steps: columns are next to each other */
#define DISTINCT 1e-9   /* of the radius: points of a row are apart; closer ones are at a pole */
#define EXCEPTIONS 3    /* points of a folded row that may be no mirror images, where columns repeat */
#define MOST_REPEATED 3 /* columns that repeat the first ones, in addition to the first */
#define POINTS_MAX ((int64_t)1 << 40)

/* Chord between two points. NaN if one is unknown. */
static double apart(const double* a, const double* b)
{
  const double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
  return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
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
  if (columns < 3 || !is_spread(s, columns, row) ||
    !stratus_globe_pole(at(s, 0, row), at(s, columns / 3, row), at(s, 2 * columns / 3, row), pole)) {
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
    stratus_globe_direction(degrees + 2 * i, unit + 3 * i);
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
