/* SPDX-License-Identifier: BSD-3-Clause
 * Places of points on the sphere of the Earth, and of points that close a lattice. */
#include "stratus/globe.h"

#include "globe_direction.h"

#include "base.h"

#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

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
      stratus_globe_direction(degrees + 2 * point, one);
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
    stratus_globe_direction(degrees + 2 * (first + i * n / 3), three[i]);
  }
  return stratus_globe_pole(three[0], three[1], three[2], pole);
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
      const double height = from->heights[(level * from->count + first) * from->height_stride];
      place p;
      if (count == 1 && known && isfinite(height)) { /* most points */
        memcpy(p.unit, known, sizeof p.unit);
        p.height = height;
        TRY(put(context, from, &p, point));
        *last = point;
      } else if (find_place(from, degrees, level, first, stride, count, known, &p)) {
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
