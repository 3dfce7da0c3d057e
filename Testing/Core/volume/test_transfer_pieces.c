/* SPDX-License-Identifier: BSD-3-Clause
 * The transfer function's pieces and its tables, against the function in double: extremes, the floats that show, the entry of each value.
 */
#include "structures.h"

#include "transfer_pieces.h"
#include "testing.h"

static const double white[4] = { 0, 1, 1, 1 };

#define POINTS 24

typedef struct random_function {
  double opacity[POINTS][2], color[POINTS][4];
  stratus_transfer transfer;
} random_function;

static double random_unit(uint32_t* random)
{
  return (double)random_below(random, 1000001) / 1e6;
}

/* Points on a coarse raster, so that steps, plateaus and stretches of 0 and 1 are frequent; some lie very near each other. */
static void make_function(random_function* f, double scale, uint32_t* random)
{
  const size_t count = 1 + (size_t)random_below(random, POINTS);
  double x = -0.2 * scale;
  for (size_t i = 0; i < count; ++i) {
    const int kind = (int)random_below(random, 4);
    x += kind == 0 ? 0.0 : kind == 1 ? 1e-6 * scale : scale * (double)random_below(random, 8) / 32.0;
    f->opacity[i][0] = f->color[i][0] = x;
    f->opacity[i][1] = random_below(random, 3) ? (random_below(random, 6) ? random_unit(random) : 1.0) : 0.0;
    for (int c = 1; c < 4; ++c) {
      f->color[i][c] = random_unit(random);
    }
  }
  f->transfer = stratus_transfer_default();
  f->transfer.opacity = f->opacity[0];
  f->transfer.opacity_count = count;
  f->transfer.color = f->color[0];
  f->transfer.color_count = count;
  f->transfer.clamp = random_below(random, 4) != 0;
}

/* Bounds of the opacity over lo..hi by all points: those inside count with all that they have on their sides inside. */
static void brute_extremes(const stratus_transfer* t, double lo, double hi, double range[2])
{
  const double(*p)[2] = (const double(*)[2])t->opacity;
  const size_t last = t->opacity_count - 1;
  double rgba[4];
  const double ends[2] = { lo, hi };
  range[0] = INFINITY;
  range[1] = -INFINITY;
  for (int e = 0; e < 2; ++e) {
    stratus_transfer_at(t, ends[e], rgba);
    range[0] = fmin(range[0], rgba[3]);
    range[1] = fmax(range[1], rgba[3]);
  }
  for (size_t i = 0; i <= last; ++i) {
    const bool first_of = i == 0 || p[i - 1][0] < p[i][0], last_of = i == last || p[i + 1][0] > p[i][0];
    const bool below = p[i][0] > lo && p[i][0] <= hi, at = p[i][0] >= lo && p[i][0] <= hi;
    if ((first_of && below && (i > 0 || t->clamp)) || (last_of && at)) {
      range[0] = fmin(range[0], p[i][1]);
      range[1] = fmax(range[1], p[i][1]);
    }
    if (!t->clamp && ((i == 0 && below) || (i == last && at && p[i][0] < hi))) {
      range[0] = 0.0;
      range[1] = fmax(range[1], 0.0);
    }
  }
}

static double random_end(const random_function* f, double scale, uint32_t* random)
{
  const double point = f->opacity[random_below(random, (int64_t)f->transfer.opacity_count)][0];
  switch (random_below(random, 5)) {
    case 0:
      return point;
    case 1:
      return nextafter(point, INFINITY);
    case 2:
      return nextafter(point, -INFINITY);
    case 3:
      return random_below(random, 2) ? INFINITY : -INFINITY;
    default:
      return scale * (2.0 * random_unit(random) - 0.5);
  }
}

static void extremes_are_those_of_all_points(void** state)
{
  uint32_t random = 7;
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (int pass = 0; pass < (few_run() ? 2000 : 10000); ++pass) {
    random_function f;
    stratus_pieces* pieces = NULL;
    make_function(&f, 100.0, &random);
    assert_int_equal(stratus_pieces_create(context, &f.transfer, &pieces), STRATUS_OK);
    for (int i = 0; i < 10; ++i) {
      const double a = random_end(&f, 100.0, &random), b = random_end(&f, 100.0, &random), lo = fmin(a, b), hi = fmax(a, b);
      double got[2], expected[2];
      stratus_curve_extremes(&pieces->opacity, lo, hi, got);
      brute_extremes(&f.transfer, lo, hi, expected);
      if (got[0] != expected[0] || got[1] != expected[1]) {
        fail_msg("pass %d, %.17g..%.17g: %.17g..%.17g, not %.17g..%.17g", pass, lo, hi, got[0], got[1], expected[0], expected[1]);
      }
    }
    stratus_pieces_destroy(pieces);
  }
  stratus_context_destroy(context);
}

static bool table_shows(const stratus_table* table, float value)
{
  const int e = stratus_table_entry(table, value);
  return table->rgba ? table->rgba[4 * e + 3] > 0.0f : table->next_shown[e] == e;
}

/* Random floats, and those about the function's points. */
static float random_value(const random_function* f, const stratus_table_values* v, double scale, uint32_t* random)
{
  const double point = f->opacity[random_below(random, (int64_t)f->transfer.opacity_count)][0];
  float value = random_below(random, 3) ? (float)point : (float)(scale * random_unit(random));
  for (int64_t ulp = random_below(random, 3); ulp > 0; --ulp) {
    value = nextafterf(value, random_below(random, 2) ? INFINITY : -INFINITY);
  }
  return fminf(fmaxf(value, v->lo), v->hi);
}

/* Compares the table with the function: transparent values are transparent in the table, visible ones are visible except within a cell of a
 * smooth foot, and opacity is right to a cell. */
static void tables_take_the_function_at_every_value(void** state)
{
  uint32_t random = 8;
  int64_t hidden = 0, shown = 0;
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (int pass = 0; pass < (few_run() ? 100 : 600); ++pass) {
    random_function f;
    make_function(&f, 100.0, &random);
    for (int sampling = STRATUS_SAMPLING_MIDPOINT; sampling <= STRATUS_SAMPLING_PREINTEGRATED; ++sampling) {
      const stratus_table_values v = { .lo = 0.0f, .hi = 100.0f, .nearest = pass % 2 };
      stratus_table* table = NULL;
      assert_int_equal(stratus_table_create(context, &f.transfer, &v, (stratus_sampling)sampling, 1.0, &table), STRATUS_OK);
      const double cell = 100.0 / 4095.0;
      for (int i = 0; i < 200; ++i) {
        const float value = random_value(&f, &v, 100.0, &random);
        double rgba[4], near[2];
        stratus_transfer_at(&f.transfer, (double)value, rgba);
        brute_extremes(&f.transfer, (double)value - cell, (double)value + cell, near);
        const bool shows = table_shows(table, value);
        if (shows && !(rgba[3] > 0.0)) {
          fail_msg("pass %d, sampling %d: %.9g shows, but is transparent", pass, sampling, (double)value);
        }
        if (!shows && rgba[3] > 0.05) { /* a cell contains no ramp steeper than 1/16 of the values */
          fail_msg("pass %d, sampling %d: %.9g does not show, but is %g", pass, sampling, (double)value, rgba[3]);
        }
        if (table->rgba) {
          const double alpha = (double)table->rgba[4 * stratus_table_entry(table, value) + 3];
          if (shows && !(fabs(alpha - rgba[3]) <= 0.07)) {
            fail_msg("pass %d: %.9g has %g, not %g", pass, (double)value, alpha, rgba[3]);
          }
          assert_true(rgba[3] < 1.0 || alpha == 1.0);
        }
        hidden += !shows;
        shown += shows;
      }
      stratus_table_destroy(table);
    }
  }
  assert_true(hidden > 1000 && shown > 1000);
  stratus_context_destroy(context);
}

/* Points between neighbouring floats: most cells of a table have no float, and their middles are no rising sequence with the floats of the
 * others. No entry has or adds a colour below 0 or above its opacity. */
static void points_between_floats_give_no_colour_beyond_theirs(void** state)
{
  enum { FLOATS = 24 };
  uint32_t random = 11;
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (int pass = 0; pass < (few_run() ? 150 : 1000); ++pass) {
    const stratus_table_values v = { .lo = 6e6f, .hi = 6e6f + 0.5f * FLOATS };
    random_function f;
    make_function(&f, pass % 2 ? 1.0 : 0.5 * FLOATS, &random);
    for (size_t i = 0; i < f.transfer.opacity_count; ++i) {
      f.opacity[i][0] += (double)v.lo + 2.0;
      f.color[i][0] += (double)v.lo + 2.0 + 0.4 * random_unit(&random) * (i + 1 == f.transfer.opacity_count);
    }
    for (int sampling = STRATUS_SAMPLING_MIDPOINT; sampling <= STRATUS_SAMPLING_PREINTEGRATED; ++sampling) {
      stratus_table* table = NULL;
      assert_int_equal(stratus_table_create(context, &f.transfer, &v, (stratus_sampling)sampling, 1.0, &table), STRATUS_OK);
      for (int e = 0; e < table->size; ++e) {
        for (int c = 0; c < 3; ++c) {
          if (table->rgba) {
            const float* entry = table->rgba + 4 * e;
            assert_true(entry[c] >= 0.0f && entry[c] <= entry[3] && entry[3] <= 1.0f);
          } else { /* whole numbers, which are rounded one by one; a faint entry's depth is at least 1 */
            const int32_t *from = table->sums + 4 * e, *to = from + 4;
            assert_true(to[c] >= from[c] && (int64_t)to[c] - from[c] <= (int64_t)to[3] - from[3] + table->size);
          }
        }
      }
      stratus_table_destroy(table);
    }
  }
  stratus_context_destroy(context);
}

/* Between points that are farther apart than the largest double, the function is still a line. */
static void points_at_the_ends_of_doubles_are_joined_by_a_line(void** state)
{
  static const double opacity[] = { -0x1.8p1023, 0.25, 0x1.8p1023, 0.75 };
  static const double color[] = { -0x1.8p1023, 0.0, 1.0, 0.5, 0x1.8p1023, 1.0, 0.0, 0.5 };
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_transfer transfer = stratus_transfer_default();
  stratus_pieces* pieces = NULL;
  transfer.opacity = opacity;
  transfer.color = color;
  transfer.opacity_count = transfer.color_count = 2;
  assert_int_equal(stratus_pieces_create(context, &transfer, &pieces), STRATUS_OK);
  for (int i = -12; i <= 12; ++i) {
    const double x = ldexp(i / 8.0, 1023), t = (i + 12) / 24.0;
    double rgba[4];
    stratus_transfer_at(&transfer, x, rgba);
    assert_true(fabs(rgba[0] - t) < 1e-15 && fabs(rgba[1] - (1.0 - t)) < 1e-15 && rgba[2] == 0.5);
    assert_true(fabs(rgba[3] - (0.25 + 0.5 * t)) < 1e-15 && stratus_curve_at(&pieces->opacity, x) == rgba[3]);
  }
  stratus_pieces_destroy(pieces);
  stratus_context_destroy(context);
}

/* Label windows as VTK's functions give them, with steps at the next number above the half. Their tables equal those with steps at the
 * half, and no cell is divided. Floats may equal the half itself, so their cells are divided. */
static void steps_above_a_half_divide_no_cell_of_whole_numbers(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  const double color[4] = { 0, 1, 0.5, 0.25 };
  double at[16], above[16];
  for (int i = 0; i < 8; ++i) {
    at[2 * i] = 0.5 + i / 2;
    above[2 * i] = nextafter(at[2 * i], INFINITY);
    at[2 * i + 1] = above[2 * i + 1] = (i + 1) / 2 % 2 ? 0.3 : 0.0;
  }
  stratus_transfer t = stratus_transfer_default();
  t.opacity_count = 8;
  t.color = color;
  t.color_count = 1;
  for (int whole = 0; whole < 2; ++whole) {
    const stratus_table_values v = { .fetching = { .integer = whole }, .lo = 0.0f, .hi = 10.0f };
    stratus_table* tables[2];
    for (int kind = 0; kind < 2; ++kind) {
      t.opacity = kind ? above : at;
      assert_int_equal(stratus_table_create(context, &t, &v, STRATUS_SAMPLING_PREINTEGRATED, 1.0, &tables[kind]), STRATUS_OK);
    }
    if (whole) {
      assert_int_equal(tables[1]->search_steps, 0);
      assert_int_equal(stratus_table_words(tables[0]), stratus_table_words(tables[1]));
      assert_memory_equal(tables[0]->sums, tables[1]->sums, stratus_table_words(tables[0]) * sizeof(float));
    } else {
      assert_false(table_shows(tables[1], 0.5f));
      assert_true(table_shows(tables[1], nextafterf(0.5f, 1.0f)));
    }
    stratus_table_destroy(tables[0]);
    stratus_table_destroy(tables[1]);
  }
  stratus_context_destroy(context);
}

/* A plateau of a millionth of the range between vertical steps, or with ramps, has entries of its own. */
static void a_plateau_of_a_millionth_has_entries(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (int kind = 0; kind < 2; ++kind) {
    const double w = 1e-6, at = 0.3712345;
    const double steps[] = { at, 0, at, 0.3, at + w, 0.3, at + w, 0 }, ramps[] = { at, 0, at + w / 4, 0.3, at + w * 3 / 4, 0.3, at + w, 0 };
    stratus_transfer t = stratus_transfer_default();
    t.opacity = kind ? ramps : steps;
    t.opacity_count = 4;
    t.color = white;
    t.color_count = 1;
    for (int sampling = STRATUS_SAMPLING_MIDPOINT; sampling <= STRATUS_SAMPLING_PREINTEGRATED; ++sampling) {
      const stratus_table_values v = { .lo = 0.0f, .hi = 1.0f };
      stratus_table* table = NULL;
      assert_int_equal(stratus_table_create(context, &t, &v, (stratus_sampling)sampling, 1.0, &table), STRATUS_OK);
      assert_true(table_shows(table, (float)(at + w / 2)));
      assert_false(table_shows(table, (float)(at - w / 8)));
      assert_false(table_shows(table, (float)(at + w + w / 8)));
      assert_true(table->size < 70000);
      stratus_table_destroy(table);
    }
  }
  stratus_context_destroy(context);
}

/* Windows of width 1 about each label, between vertical steps: the table shows the label, and no other. */
static void windows_of_labels_show_their_label_alone(void** state)
{
  static const stratus_type types[] = { STRATUS_UINT8, STRATUS_UINT16, STRATUS_INT32, STRATUS_FLOAT32 };
  uint32_t random = 9;
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (int type = 0; type < 4; ++type) {
    for (int n = 0; n < (type == 0 ? 256 : few_run() ? 20 : 120); ++n) {
      const double most = type == 0 ? 255 : type == 1 ? 65535 : type == 2 ? 2e9 : 1e6;
      const double k = type == 0 ? n : floor(most * random_unit(&random));
      const double points[] = { k - 0.5, 0, k - 0.5, 0.7, k + 0.5, 0.7, k + 0.5, 0 };
      stratus_transfer t = stratus_transfer_default();
      t.opacity = points;
      t.opacity_count = 4;
      t.color = white;
      t.color_count = 1;
      for (int nearest = 0; nearest < 2; ++nearest) {
        const stratus_table_values v = { .fetching = { .wide = stratus_type_is_wide(types[type]),
                                           .integer = types[type] != STRATUS_FLOAT32 },
          .lo = 0.0f,
          .hi = (float)most,
          .nearest = nearest };
        for (int sampling = STRATUS_SAMPLING_MIDPOINT; sampling <= STRATUS_SAMPLING_PREINTEGRATED; ++sampling) {
          stratus_table* table = NULL;
          assert_int_equal(stratus_table_create(context, &t, &v, (stratus_sampling)sampling, 1.0, &table), STRATUS_OK);
          const float label = (float)k;
          if (!table_shows(table, label) || (label > 1.0f && table_shows(table, fminf(label - 1.0f, nextafterf(label, 0.0f)))) ||
            (label < v.hi - 1.0f && table_shows(table, fmaxf(label + 1.0f, nextafterf(label, INFINITY))))) {
            fail_msg("type %d, label %.17g, nearest %d, sampling %d: %d %d %d", type, k, nearest, sampling,
              table_shows(table, label - 1.0f), table_shows(table, label), table_shows(table, label + 1.0f));
          }
          if (table->rgba) {
            assert_true(fabsf(table->rgba[4 * stratus_table_entry(table, label) + 3] - 0.7f) < 1e-6f);
          }
          stratus_table_destroy(table);
        }
      }
    }
  }
  stratus_context_destroy(context);
}

int test_transfer_pieces(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(extremes_are_those_of_all_points),
    cmocka_unit_test(tables_take_the_function_at_every_value),
    cmocka_unit_test(points_between_floats_give_no_colour_beyond_theirs),
    cmocka_unit_test(points_at_the_ends_of_doubles_are_joined_by_a_line),
    cmocka_unit_test(steps_above_a_half_divide_no_cell_of_whole_numbers),
    cmocka_unit_test(a_plateau_of_a_millionth_has_entries),
    cmocka_unit_test(windows_of_labels_show_their_label_alone),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
