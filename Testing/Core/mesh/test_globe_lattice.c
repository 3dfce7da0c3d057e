/* SPDX-License-Identifier: BSD-3-Clause
 * Lattices of longitudes and latitudes fill the shell of a sphere once: cells have one orientation, and their volumes add up to the
 * shell's. */
#include "structures.h"

#include "faulty_allocator.h"

#include "stratus/globe.h"

#include <stdio.h>

#define RADIANS (3.14159265358979323846 / 180.0)
#define LEVELS 3

static stratus_context* context;

typedef struct lattice_case {
  int64_t columns, rows;
  double* degrees;
} lattice_case;

static lattice_case make_case(int64_t columns, int64_t rows)
{
  const lattice_case made = { columns, rows, calloc((size_t)(2 * columns * rows), sizeof(double)) };
  return made;
}

static void put(const lattice_case* c, int64_t i, int64_t j, double longitude, double latitude)
{
  c->degrees[2 * (j * c->columns + i)] = longitude;
  c->degrees[2 * (j * c->columns + i) + 1] = latitude;
}

/* Volume of the cells between points of a lattice; the six tetrahedra of a cell around its diagonal. Fails if cells are turned inside out.
 */
static double volume_of(const double* points, int64_t columns, int64_t rows)
{
  static const int tetrahedra[6][4] = { { 0, 1, 3, 7 }, { 0, 3, 2, 7 }, { 0, 2, 6, 7 }, { 0, 6, 4, 7 }, { 0, 4, 5, 7 }, { 0, 5, 1, 7 } };
  double sum = 0.0, positive = 0.0, negative = 0.0;
  for (int64_t k = 0; k + 1 < LEVELS; ++k) {
    for (int64_t j = 0; j + 1 < rows; ++j) {
      for (int64_t i = 0; i + 1 < columns; ++i) {
        const double* p[8];
        for (int corner = 0; corner < 8; ++corner) {
          p[corner] = points + 3 * (((k + (corner >> 2)) * rows + j + (corner >> 1 & 1)) * columns + i + (corner & 1));
        }
        for (int t = 0; t < 6; ++t) {
          double e[3][3];
          for (int n = 0; n < 3; ++n) {
            for (int a = 0; a < 3; ++a) {
              e[n][a] = p[tetrahedra[t][n + 1]][a] - p[tetrahedra[t][0]][a];
            }
          }
          const double size = (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                                e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
            6.0;
          positive += fmax(size, 0.0);
          negative += fmin(size, 0.0);
          sum += size;
        }
      }
    }
  }
  if (fmin(positive, -negative) > 1e-6 * fabs(sum)) {
    fail_msg("cells have volumes of %g and %g", positive, negative);
  }
  return fabs(sum);
}

/* Share of the shell between the heights that the cells fill. */
static double share_of(const lattice_case* c, const stratus_globe_lattice* lattice, double factor)
{
  static const double heights[LEVELS] = { 0.0, 4000.0, 10000.0 };
  const int64_t count = c->columns * c->rows, columns = stratus_globe_columns(lattice), rows = stratus_globe_rows(lattice);
  double* const height = calloc((size_t)(count * LEVELS), sizeof(double));
  double* const points = calloc((size_t)(3 * columns * rows * LEVELS), sizeof(double));
  for (int64_t i = 0; i < count * LEVELS; ++i) {
    height[i] = heights[i / count];
  }
  const stratus_globe_points from = {
    .lattice = lattice, .count = count, .levels = LEVELS, .degrees = c->degrees, .heights = height, .height_stride = 1, .factor = factor
  };
  assert_int_equal(stratus_globe_place(context, &from, points), STRATUS_OK);
  const double low = STRATUS_EARTH_RADIUS, high = low + factor * 10000.0,
               shell = 4.0 / 3.0 * 180.0 * RADIANS * (high * high * high - low * low * low);
  for (int64_t i = 0; i < columns * rows; ++i) {
    const double* const p = points + 3 * (columns * rows + i); /* the second level */
    assert_true(fabs(sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) / (low + factor * 4000.0) - 1.0) < 1e-12);
  }
  const double share = volume_of(points, columns, rows) / shell;
  free(height);
  free(points);
  return share;
}

static stratus_globe_lattice found_in(const lattice_case* c)
{
  stratus_globe_lattice lattice;
  assert_int_equal(stratus_globe_find_lattice(context, c->columns, c->rows, c->degrees, &lattice), STRATUS_OK);
  return lattice;
}

static void check_closed(const lattice_case* c, const char* name, int64_t columns, int64_t rows, double within, const char* words)
{
  const stratus_globe_lattice lattice = found_in(c);
  char text[256];
  stratus_globe_describe(&lattice, text, sizeof text);
  if (stratus_globe_columns(&lattice) != columns || stratus_globe_rows(&lattice) != rows || !strstr(text, words)) {
    fail_msg("%s: %lld x %lld points, must be %lld x %lld; \"%s\" must have \"%s\"", name, (long long)stratus_globe_columns(&lattice),
      (long long)stratus_globe_rows(&lattice), (long long)columns, (long long)rows, text, words);
  }
  const double share = share_of(c, &lattice, 50.0);
  if (!(fabs(share - 1.0) < within)) {
    fail_msg("%s: cells fill %.5f of the shell", name, share);
  }
}

/* A pole at another place. */
static void turn(double degrees[2], double tilt)
{
  const double a = degrees[0] * RADIANS, b = degrees[1] * RADIANS, t = tilt * RADIANS;
  const double x = cos(b) * cos(a), y = cos(b) * sin(a), z = sin(b), u = cos(t) * x + sin(t) * z, w = cos(t) * z - sin(t) * x;
  degrees[0] = atan2(y, u) / RADIANS;
  degrees[1] = asin(fmax(-1.0, fmin(1.0, w))) / RADIANS;
}

static void rings_are_closed_at_both_poles(void** state)
{
  (void)state;
  for (int tilt = 0; tilt < 90; tilt += 37) {
    lattice_case c = make_case(120, 60);
    for (int64_t j = 0; j < c.rows; ++j) {
      for (int64_t i = 0; i < c.columns; ++i) {
        const double uneven = 1.0 * sin(3.0 * (double)i * RADIANS); /* columns need not be even */
        put(&c, i, j, 3.0 * (double)i + 1.5 + uneven, -88.5 + 3.0 * (double)j);
        if (tilt) {
          turn(c.degrees + 2 * (j * c.columns + i), tilt);
        }
      }
    }
    check_closed(
      &c, tilt ? "rings around another pole" : "rings", 121, 62, 2e-3, "closed from the last column to the first, closed at both poles");
    free(c.degrees);
  }
}

/* Rows at the poles, and columns that repeat the first ones, as files have them. */
static void rows_at_poles_and_repeated_columns_stay_single(void** state)
{
  (void)state;
  for (int repeated = 0; repeated < 5; ++repeated) {
    lattice_case c = make_case(180 + repeated, 91);
    for (int64_t j = 0; j < c.rows; ++j) {
      for (int64_t i = 0; i < c.columns; ++i) {
        put(&c, i, j, 2.0 * (double)i, -90.0 + 2.0 * (double)j);
      }
    }
    check_closed(&c, "rows at poles", 181, 91, 2e-3, repeated < 2 ? "" : "columns that repeat the first ones");
    free(c.degrees);
  }
}

/* A lattice with two poles in the north, by confocal ellipses in stereographic projection, which shrink to the line between the poles. Rows
 * are at whole steps of it, so that the last row is on the line, or at half steps, so that the line is between rows. beyond: rows behind
 * the line. around: columns that repeat the first ones. */
static lattice_case folded(bool half, int beyond, int around)
{
  enum { COLUMNS = 180, SOUTH = 55, CAP = 45 };
  const int rows = SOUTH + CAP + (half ? 0 : 1) + beyond;
  lattice_case c = make_case(COLUMNS + around, rows);
  for (int64_t j = 0; j < rows; ++j) {
    for (int64_t i = 0; i < c.columns; ++i) {
      const double step = 360.0 / COLUMNS, longitude = step * ((double)i + 0.5);
      if (j < SOUTH) {
        put(&c, i, j, longitude, -89.0 + 2.0 * (double)j); /* to 19 degrees north */
        continue;
      }
      /* s: from 1 at 20 degrees to 0 at the line, and on to the other side of it */
      const double s = 1.0 - ((double)(j - SOUTH) + (half ? 0.5 : 0.0)) / CAP, shape = sin(s * 90.0 * RADIANS);
      const double x = cos(longitude * RADIANS), y = shape * sin(longitude * RADIANS), distance = tan(35.0 * RADIANS) * sqrt(x * x + y * y);
      put(&c, i, j, atan2(y, x) / RADIANS, 90.0 - 2.0 * atan(distance) / RADIANS);
    }
  }
  return c;
}

/* T-point pivots of NEMO have the seam on a row, F-point pivots, and the lattices of POP and MOM, between rows. Files have the rows beyond
 * the seam or not. */
static void tripolar_lattices_are_closed_at_the_seam(void** state)
{
  (void)state;
  for (int around = 0; around < 3; around += 2) {
    lattice_case on = folded(false, 0, around), beyond = folded(false, 1, around), between = folded(true, 0, around),
                 both = folded(true, 1, around);
    const int64_t columns = 181;
    check_closed(&on, "the seam on the last row", columns, 55 + 46 + 1, 2e-3, "closed at a pole");
    check_closed(&beyond, "a row beyond the seam", columns, 55 + 46 + 1, 2e-3, "without the last row");
    check_closed(&between, "the seam behind the last row", columns, 55 + 45 + 1 + 1, 2e-3, "closed at the seam between two poles");
    check_closed(&both, "a row beyond a seam between rows", columns, 55 + 45 + 1 + 1, 2e-3,
      "without the last row, which repeats another one, closed at the seam between two poles");
    const stratus_globe_lattice lattice = found_in(&both);
    int64_t first, stride;
    /* both sides of the seam are the same distance from it: their sum turns a column by a half */
    assert_int_equal(stratus_globe_source(&lattice, 7, stratus_globe_rows(&lattice) - 1, &first, &stride), 2);
    assert_int_equal(first, 99 * both.columns + 7);
    assert_int_equal(first + stride, 99 * both.columns + 172);
    assert_int_equal(stratus_globe_source(&lattice, 180, 1, &first, &stride), 1);
    assert_int_equal(first, 0);
    assert_int_equal(stratus_globe_source(&lattice, 5, 0, &first, &stride), 180);
    assert_int_equal(first, 0);
    assert_int_equal(stratus_globe_source(&lattice, 181, 0, &first, &stride), 0);
    free(on.degrees);
    free(beyond.degrees);
    free(between.degrees);
    free(both.degrees);
  }
}

/* Parts of the Earth stay as they are: nothing is added that would be no part of the data. */
static void regions_are_not_closed(void** state)
{
  (void)state;
  static const struct {
    int64_t columns, rows;
    double west, east, south, north;
  } regions[] = { { 61, 81, 170.0, 200.0, 10.0, 50.0 }, { 2, 5, 10.0, 12.0, 10.0, 50.0 }, { 5, 2, 10.0, 50.0, 10.0, 12.0 },
    { 30, 20, -30.0, 30.0, 70.0, 89.5 } };
  for (size_t n = 0; n < sizeof regions / sizeof *regions; ++n) {
    lattice_case c = make_case(regions[n].columns, regions[n].rows);
    for (int64_t j = 0; j < c.rows; ++j) {
      for (int64_t i = 0; i < c.columns; ++i) {
        put(&c, i, j, regions[n].west + (regions[n].east - regions[n].west) * (double)i / (double)(c.columns - 1),
          regions[n].south + (regions[n].north - regions[n].south) * (double)j / (double)(c.rows - 1));
      }
    }
    const stratus_globe_lattice lattice = found_in(&c);
    assert_int_equal(stratus_globe_columns(&lattice), c.columns);
    assert_int_equal(stratus_globe_rows(&lattice), c.rows);
    free(c.degrees);
  }
  /* bands that go round have no pole and no seam, however few columns they have */
  for (int64_t columns = 3; columns < 9; ++columns) {
    lattice_case c = make_case(columns, 6);
    for (int64_t j = 0; j < 6; ++j) {
      for (int64_t i = 0; i < columns; ++i) {
        put(&c, i, j, 360.0 * (double)i / (double)columns, -50.0 + 20.0 * (double)j);
      }
    }
    const stratus_globe_lattice lattice = found_in(&c);
    assert_int_equal(stratus_globe_columns(&lattice), columns + 1);
    assert_int_equal(stratus_globe_rows(&lattice), 6);
    free(c.degrees);
  }
}

static void unknown_points_are_where_the_last_known_one_is(void** state)
{
  (void)state;
  const double degrees[8] = { NAN, 0.0, 0.0, 90.0, NAN, NAN, 90.0, 0.0 };
  double points[24];
  for (int i = 0; i < 8; ++i) {
    points[3 * i + 2] = i == 7 ? NAN : 1000.0;
  }
  const stratus_globe_points from = {
    .count = 4, .levels = 2, .degrees = degrees, .heights = points + 2, .height_stride = 3, .factor = 2.0
  };
  assert_int_equal(stratus_globe_place(context, &from, points), STRATUS_OK);
  const double radius = STRATUS_EARTH_RADIUS + 2000.0;
  for (int i = 0; i < 8; ++i) {
    const int axis = i == 3 || i == 4 ? 1 : 2; /* 90 degrees east, otherwise the pole */
    for (int a = 0; a < 3; ++a) {
      assert_true(fabs(points[3 * i + a] - (a == axis ? radius : 0.0)) < 1e-6);
    }
  }
}

static void refused(stratus_status status, const char* words)
{
  assert_int_equal(status, STRATUS_INVALID_ARGUMENT);
  if (!strstr(stratus_context_message(context), words)) {
    fail_msg("'%s' is not in the message '%s'", words, stratus_context_message(context));
  }
}

static void wrong_globes_are_refused(void** state)
{
  (void)state;
  const double degrees[4] = { 0.0, 0.0, 1.0, 1.0 }, heights[2] = { 0.0, -5000.0 }, unknown[2] = { NAN, NAN };
  double points[6];
  stratus_globe_lattice lattice;
  refused(stratus_globe_find_lattice(context, 1, 5, degrees, &lattice), "1 x 5 points, must be at least 2 x 2");
  refused(stratus_globe_find_lattice(context, (int64_t)1 << 39, 8, degrees, &lattice), "at most 1099511627776");
  stratus_globe_points from = { .count = 2, .levels = 1, .degrees = degrees, .heights = heights, .height_stride = 1, .factor = 2000.0 };
  refused(stratus_globe_place(context, &from, points), "the factor of heights must be less than 1274.2");
  from.factor = 0.0;
  refused(stratus_globe_place(context, &from, points), "a factor of heights of 0, must be above 0");
  from.factor = 1.0;
  from.levels = 0;
  refused(stratus_globe_place(context, &from, points), "each must be at least 1");
  from.levels = 1;
  from.heights = unknown;
  refused(stratus_globe_place(context, &from, points), "no point has a longitude");
  const stratus_globe_lattice other = { .data_columns = 3, .data_rows = 3, .columns = 3, .rows = 3, .seam = -1 };
  from.lattice = &other;
  refused(stratus_globe_place(context, &from, points), "2 points of a level of a lattice of 3 x 3 points, must be 9");
  assert_true(stratus_globe_height_factor(5.0, 5.0) == 1.0 && fabs(stratus_globe_height_factor(0.0, 10000.0) - 63.71) < 1e-9);
  char text[4] = "abc";
  stratus_globe_describe(&other, text, sizeof text);
  assert_string_equal(text, "");
}

static void every_allocation_may_fail(void** state)
{
  (void)state;
  const double degrees[8] = { 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0 }, heights[4] = { 0.0 };
  for (int place = 0; place < 2; ++place) {
    faulty_allocator allocator = { 0, 0, 0 };
    const stratus_context_options options = faulty_options(&allocator, "host");
    stratus_context* faulty = NULL;
    char message[256];
    assert_int_equal(stratus_context_create(&options, &faulty, message, sizeof message), STRATUS_OK);
    const int64_t live = allocator.live;
    allocator.fail_at = allocator.calls + 1;
    stratus_globe_lattice lattice;
    double points[12];
    const stratus_globe_points from = {
      .count = 4, .levels = 1, .degrees = degrees, .heights = heights, .height_stride = 1, .factor = 1.0
    };
    assert_int_equal(place ? stratus_globe_place(faulty, &from, points) : stratus_globe_find_lattice(faulty, 2, 2, degrees, &lattice),
      STRATUS_OUT_OF_MEMORY);
    assert_true(allocator.live == live);
    stratus_context_destroy(faulty);
  }
}

static int make(void** state)
{
  (void)state;
  context = make_context("host", 1);
  return 0;
}

static int destroy(void** state)
{
  (void)state;
  stratus_context_destroy(context);
  return 0;
}

int test_globe_lattice(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(rings_are_closed_at_both_poles),
    cmocka_unit_test(rows_at_poles_and_repeated_columns_stay_single),
    cmocka_unit_test(tripolar_lattices_are_closed_at_the_seam),
    cmocka_unit_test(regions_are_not_closed),
    cmocka_unit_test(unknown_points_are_where_the_last_known_one_is),
    cmocka_unit_test(wrong_globes_are_refused),
    cmocka_unit_test(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, make, destroy);
}
