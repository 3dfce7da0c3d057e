/* SPDX-License-Identifier: BSD-3-Clause
 * Guesses of transfer functions: kinds of variables, outliers, two-sided values, the optical depth of columns against brute force, blocks,
 * refusals. */
#include "structures.h"

#include "stratus/color_map.h"
#include "stratus/look.h"

#include <math.h>
#include <stdio.h>

enum { NX = 24, NY = 20, NZ = 30, COUNT = NX * NY * NZ };

static stratus_context* context;
static float values[COUNT];

static stratus_volume view(void)
{
  stratus_volume v = stratus_volume_default();
  v.values = values;
  v.type = STRATUS_FLOAT32;
  v.dimensions[0] = NX;
  v.dimensions[1] = NY;
  v.dimensions[2] = NZ;
  return v;
}

static stratus_look guess(const stratus_volume* v, const stratus_look_options* options)
{
  stratus_look look = { .opacity_count = 0 };
  if (stratus_look_guess(context, v, 1, options, &look) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  const stratus_transfer transfer = { .opacity = look.opacity,
    .opacity_count = look.opacity_count,
    .color = (const double[]){ 0, 1, 1, 1 },
    .color_count = 1,
    .unit_distance = look.unit_distance,
    .clamp = 1,
    .weight = 1.0 };
  if (stratus_transfer_check(context, &transfer) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  return look;
}

static double opacity_at(const stratus_look* look, double value)
{
  const double* p = look->opacity;
  const size_t last = look->opacity_count - 1;
  if (value <= p[0] || value >= p[2 * last]) {
    return value <= p[0] ? p[1] : p[2 * last + 1];
  }
  size_t at = 0;
  while (p[2 * at + 2] < value) {
    ++at;
  }
  const double part = (value - p[2 * at]) / (p[2 * at + 2] - p[2 * at]);
  return p[2 * at + 1] + part * (p[2 * at + 3] - p[2 * at + 1]);
}

/* A plume over nothing: 1 at its middle. */
static void fill_plume(double wide)
{
  for (int k = 0, at = 0; k < NZ; ++k) {
    for (int j = 0; j < NY; ++j) {
      for (int i = 0; i < NX; ++i, ++at) {
        const double x = (i - 9.0) / NX, y = (j - 8.0) / NY, z = (k - 12.0) / NZ;
        const double value = 1.0 - (x * x + y * y + z * z) / (wide * wide);
        values[at] = value > 0.0 ? (float)value : 0.0f;
      }
    }
  }
}

static void variables_are_known_by_standard_name_unit_and_name(void** state)
{
  (void)state;
  static const struct {
    const char *name, *standard_name, *units;
    stratus_look_kind kind;
    const char *dark, *bright;
  } cases[] = {
    { "thetao", "sea_water_potential_temperature", "degC", STRATUS_LOOK_STATE, "thermal", "thermal" },
    { "so", "sea_water_salinity", "1e-3", STRATUS_LOOK_STATE, "haline", "haline" },
    { "u", "eastward_wind", "m s-1", STRATUS_LOOK_SIGNED, "cool-warm", "balance" },
    { "ws", "wind_speed", "m s-1", STRATUS_LOOK_AMOUNT, "speed_r", "speed" },
    { "dtdt", "tendency_of_air_temperature", "K s-1", STRATUS_LOOK_SIGNED, "cool-warm", "balance" },
    { "QCLOUD", "", "kg kg-1", STRATUS_LOOK_AMOUNT, "cloud", "ice_r" },
    { "run1/qc", NULL, "g/kg", STRATUS_LOOK_AMOUNT, "cloud", "ice_r" },
    { "q", "specific_humidity", "kg kg-1", STRATUS_LOOK_AMOUNT, "tempo_r", "tempo" },
    { "chl", "mass_concentration_of_chlorophyll_in_sea_water", "mg m-3", STRATUS_LOOK_TRACER, "algae_r", "algae" },
    { "so2", "mass_fraction_of_sulfur_dioxide_in_air", "kg kg-1", STRATUS_LOOK_TRACER, "viridis", "viridis_r" },
    { "x", "", "kg m-3", STRATUS_LOOK_TRACER, "viridis", "viridis_r" },
    { "x", "", "mmol/m3", STRATUS_LOOK_TRACER, "viridis", "viridis_r" },
    { "W", "", "m s-1", STRATUS_LOOK_SIGNED, "cool-warm", "balance" },
    { "a", "", "K", STRATUS_LOOK_STATE, "thermal", "thermal" },
    { "group/temp", "", "", STRATUS_LOOK_STATE, "thermal", "thermal" },
    { "Temp", "", "", STRATUS_LOOK_STATE, "thermal", "thermal" },
    { "dbz", "", "dBZ", STRATUS_LOOK_DECIBELS, "turbo", "turbo" },
    { "cl", "", "%", STRATUS_LOOK_AMOUNT, "cloud", "ice_r" },
    { "template", "", "", STRATUS_LOOK_UNKNOWN, NULL, NULL },
    { "rho", "", "", STRATUS_LOOK_UNKNOWN, NULL, NULL },
    { "x", "", "km", STRATUS_LOOK_UNKNOWN, NULL, NULL },
    { "x", "", "gm", STRATUS_LOOK_UNKNOWN, NULL, NULL },
    { NULL, NULL, NULL, STRATUS_LOOK_UNKNOWN, NULL, NULL },
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    for (int bright = 0; bright < 2; ++bright) {
      const char *map = "unset", *expected = bright ? cases[i].bright : cases[i].dark;
      const stratus_look_kind kind = stratus_look_kind_of(cases[i].name, cases[i].standard_name, cases[i].units, bright, &map);
      if (kind != cases[i].kind || (expected ? !map || strcmp(map, expected) != 0 : map != NULL)) {
        fail_msg("case %zu: kind %d, map %s", i, (int)kind, map ? map : "none");
      }
    }
  }
}

/* Each map that a rule names exists: found by all texts of the rules that the cases above do not contain. */
static void maps_of_known_variables_exist(void** state)
{
  (void)state;
  static const char* const names[] = { "x_anomaly", "vorticity", "divergence", "oxygen", "phytoplankton", "rain", "snow", "sediment",
    "density", "air_pressure", "geopotential", "cloud_area_fraction", "dust" };
  static double points[4 * STRATUS_COLOR_MAP_COLORS];
  for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
    for (int bright = 0; bright < 2; ++bright) {
      const char* map = NULL;
      assert_int_not_equal(stratus_look_kind_of("x", names[i], "", bright, &map), STRATUS_LOOK_UNKNOWN);
      assert_int_equal(stratus_color_map_points(context, map, 0.0, 1.0, points), STRATUS_OK);
    }
  }
}

static void outliers_do_not_eat_the_range(void** state)
{
  (void)state;
  const stratus_volume v = view();
  fill_plume(0.4);
  const stratus_look before = guess(&v, NULL);
  for (int i = 0; i < COUNT / 1000; ++i) {
    values[i * 997] = i % 2 ? 1e6f : 3e4f;
  }
  const stratus_look after = guess(&v, NULL);
  /* The range ends at a bin's edge. Bins are halves at most of the last range, which has 1024 of them: 2/1024. */
  if (fabs(after.high - before.high) > 2.0 / 1024.0 || fabs(after.low - before.low) > 2.0 / 1024.0) {
    fail_msg("%g .. %g with outliers, %g .. %g without", after.low, after.high, before.low, before.high);
  }
  assert_true(opacity_at(&after, 1e6) == opacity_at(&after, after.high)); /* they are not hidden */
  /* Twice as many are no outliers. */
  for (int i = 0; i < COUNT / 1000; ++i) {
    values[i * 997 + 1] = values[i * 997];
    values[i * 997 + 2] = values[i * 997];
  }
  assert_true(guess(&v, NULL).high >= 3e4);
  /* A few large values over a constant are all that there is to see. */
  for (int i = 0; i < COUNT; ++i) {
    values[i] = i == 77 ? 5.0f : 2.0f;
  }
  assert_true(guess(&v, NULL).high == 5.0);
}

static void range_without_outliers_is_that_of_the_values(void** state)
{
  (void)state;
  const stratus_volume v = view();
  fill_plume(0.5);
  stratus_look_values found = { .low = 0 };
  assert_int_equal(stratus_look_count(context, &v, 1, &found), STRATUS_OK);
  assert_true(found.low == 0.0 && found.high == 1.0 && found.finite == COUNT && found.not_finite == 0.0);
  assert_true(guess(&v, NULL).high == 1.0);
  values[3] = NAN;
  values[4] = -INFINITY;
  assert_int_equal(stratus_look_count(context, &v, 1, &found), STRATUS_OK);
  assert_true(found.finite == COUNT - 2 && found.not_finite == 2.0);
  for (int i = 0; i < COUNT; ++i) {
    values[i] = NAN;
  }
  assert_int_equal(stratus_look_count(context, &v, 1, &found), STRATUS_OK);
  assert_true(found.low > found.high && found.finite == 0.0);
  assert_true(guess(&v, NULL).opacity_count == 1);
}

static void two_sided_values_are_centered(void** state)
{
  (void)state;
  const stratus_volume v = view();
  static const struct {
    double low, high, common;
    stratus_look_kind claimed, found;
  } cases[] = {
    { -1.0, 3.0, 0.0, STRATUS_LOOK_UNKNOWN, STRATUS_LOOK_SIGNED },
    { -0.05, 3.0, 0.0, STRATUS_LOOK_UNKNOWN, STRATUS_LOOK_UNKNOWN }, /* undershoots */
    { -1.0, 3.0, -0.9, STRATUS_LOOK_UNKNOWN, STRATUS_LOOK_UNKNOWN }, /* Hounsfield units, with air in the background */
    { 1.0, 3.0, 1.1, STRATUS_LOOK_SIGNED, STRATUS_LOOK_UNKNOWN }, { -0.05, 3.0, 0.0, STRATUS_LOOK_SIGNED, STRATUS_LOOK_SIGNED },
    { -2.0, 30.0, 3.0, STRATUS_LOOK_STATE, STRATUS_LOOK_STATE },      /* degrees Celsius */
    { 390.0, 420.0, 400.0, STRATUS_LOOK_AMOUNT, STRATUS_LOOK_STATE }, /* carbon dioxide */
  };
  for (size_t c = 0; c < sizeof cases / sizeof *cases; ++c) {
    uint32_t random = 5;
    for (int i = 0; i < COUNT; ++i) { /* evenly from low to high, and half of all near the most frequent value */
      const double part = (double)(next_random(&random) % 10001) / 10000.0, wide = cases[c].high - cases[c].low;
      const double value = i % 2 ? cases[c].low + part * wide : cases[c].common + 0.02 * wide * (part - 0.5);
      values[i] = (float)fmin(fmax(value, cases[c].low), cases[c].high);
    }
    stratus_look_options options = stratus_look_options_default();
    options.kind = cases[c].claimed;
    const stratus_look look = guess(&v, &options);
    if (look.kind != cases[c].found) {
      fail_msg("case %zu: kind %d: %s", c, (int)look.kind, look.reason);
    }
    if (look.kind == STRATUS_LOOK_SIGNED) {
      assert_true(look.low == -look.high);
      assert_true(opacity_at(&look, 0.0) == 0.0);
      assert_true(opacity_at(&look, -0.7 * look.high) == opacity_at(&look, 0.7 * look.high));
      assert_true(opacity_at(&look, look.high) > opacity_at(&look, 0.5 * look.high));
    }
  }
}

/* A normal deviate: twelve even ones have a variance of 1. */
static double normal(uint32_t* random)
{
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) {
    sum += (double)(next_random(random) % 100003) / 100003.0;
  }
  return sum;
}

enum { LOGNORMAL, EVEN, PLUME_OVER_FLOOR, POWER, PLUME_AND_OUTLIERS };

/* zeros: of so many values, one is 0 */
static void fill_amounts(int distribution, double wide, int zeros)
{
  uint32_t random = 77;
  fill_plume(0.5);
  for (int i = 0; i < COUNT; ++i) {
    const double even = (double)(next_random(&random) % 10001) / 10001.0;
    const double value = distribution == LOGNORMAL ? 3e-9 * exp(wide * normal(&random))
      : distribution == EVEN                       ? 1e-9 + 3e-9 * even
      : distribution == PLUME_AND_OUTLIERS         ? (i % 1300 ? 3e-9 * (double)values[i] : 1.0)
      : distribution == POWER                      ? 3e-9 * pow(even, wide) + 1e-30
                                                   : 1e-12 + 3e-9 * (double)values[i] * (double)values[i];
    values[i] = (float)(zeros > 0 && i % zeros == 0 ? 0.0 : value);
  }
}

static void lognormal_tracers_are_over_the_logarithm(void** state)
{
  (void)state;
  const stratus_volume v = view();
  enum { TRACER = STRATUS_LOOK_TRACER, AMOUNT = STRATUS_LOOK_AMOUNT, UNKNOWN = STRATUS_LOOK_UNKNOWN };
  static const struct {
    int distribution;
    double wide;
    int zeros, kind, logarithmic, wanted;
  } cases[] = {
    { LOGNORMAL, 1.0, 0, TRACER, 0, 1 }, { LOGNORMAL, 2.0, 0, TRACER, 0, 1 }, { LOGNORMAL, 1.0, 3, TRACER, 0, 1 },
    { LOGNORMAL, 1.5, 0, UNKNOWN, 0, 1 }, { LOGNORMAL, 1.5, 3, UNKNOWN, 0, 0 }, /* zeros of an unknown variable are values */
    { LOGNORMAL, 1.5, 0, AMOUNT, 0, 0 }, { LOGNORMAL, 1.5, 0, AMOUNT, 1, 1 },   /* cloud water; as demanded */
    { LOGNORMAL, 1.5, 0, TRACER, -1, 0 }, { LOGNORMAL, 0.3, 0, TRACER, 0, 0 },  /* as demanded; less than two decades */
    { PLUME_AND_OUTLIERS, 0.0, 0, TRACER, 0, 0 }, { EVEN, 0.0, 0, TRACER, 0, 0 },
    { PLUME_OVER_FLOOR, 0.0, 0, TRACER, 0, 0 }, /* the median is the background */
    { POWER, 12.0, 0, TRACER, 0, 0 },           /* most decades are below the median */
  };
  for (size_t c = 0; c < sizeof cases / sizeof *cases; ++c) {
    stratus_look_options options = stratus_look_options_default();
    options.kind = (stratus_look_kind)cases[c].kind;
    options.logarithmic = cases[c].logarithmic;
    fill_amounts(cases[c].distribution, cases[c].wide, cases[c].zeros);
    const stratus_look look = guess(&v, &options);
    if (look.logarithmic != cases[c].wanted) {
      fail_msg("case %zu: logarithmic %d: %s", c, look.logarithmic, look.reason);
    }
    if (look.logarithmic && cases[c].distribution == LOGNORMAL) {
      assert_true(look.low > 0.0 && look.low >= 0.9e-4 * look.high);
      /* The middle half of the values has a good part of the colours. The quartiles are .67 deviations from the median. */
      const double span = log(look.high / look.low), quartile = 0.67 * cases[c].wide;
      const double low = log(3e-9 / look.low) - quartile, high = log(3e-9 / look.low) + quartile;
      if (!(low > 0.0 && high < span && (high - low) / span > 0.15)) {
        fail_msg("case %zu: quartiles at %g and %g of the colours", c, low / span, high / span);
      }
      assert_true(opacity_at(&look, 3e-9 * exp(2.0 * cases[c].wide)) > 2.0 * opacity_at(&look, 3e-9));
      assert_true(opacity_at(&look, 0.0) == 0.0);
    }
  }
}

static void outliers_do_not_eat_the_range_of_lognormal_values(void** state)
{
  (void)state;
  const stratus_volume v = view();
  stratus_look_options options = stratus_look_options_default();
  options.kind = STRATUS_LOOK_TRACER;
  fill_amounts(LOGNORMAL, 1.0, 0);
  const stratus_look before = guess(&v, &options);
  for (int i = 0; i < COUNT / 2000; ++i) {
    values[i * 1999] = 1.0f;
  }
  const stratus_look after = guess(&v, &options);
  assert_true(before.logarithmic && after.logarithmic);
  /* Half a thousandth is 1, and the other half is left out at that end: from 3.09 to 3.29 deviations. */
  if (!(fabs(log(after.high / before.high)) < 0.5)) {
    fail_msg("up to %g with outliers, %g without", after.high, before.high);
  }
  assert_true(opacity_at(&after, 1.0) == opacity_at(&after, after.high));
}

static void decibels_are_over_four_decades(void** state)
{
  (void)state;
  const stratus_volume v = view();
  stratus_look_options options = stratus_look_options_default();
  options.kind = STRATUS_LOOK_DECIBELS;
  for (int i = 0; i < COUNT; ++i) {
    values[i] = i % 3 ? -35.0f : (float)(i % 991) / 990.0f * 85.0f - 35.0f;
  }
  const stratus_look look = guess(&v, &options);
  assert_true(fabs(look.high - 50.0) < 0.1 && fabs(look.low - 10.0) < 0.1);
  assert_true(opacity_at(&look, -35.0) == 0.0 && opacity_at(&look, 9.8) == 0.0 && opacity_at(&look, 20.0) > 0.0);
  assert_true(opacity_at(&look, 50.0) > 3.0 * opacity_at(&look, 26.0));
  for (int i = 0; i < COUNT; ++i) {
    values[i] = (float)(i % 100) / 99.0f * 20.0f; /* less than four decades */
  }
  assert_true(fabs(guess(&v, &options).low) < 0.1);
}

static void frequent_states_are_more_transparent(void** state)
{
  (void)state;
  const stratus_volume v = view();
  stratus_look_options options = stratus_look_options_default();
  options.kind = STRATUS_LOOK_STATE;
  for (int i = 0; i < COUNT; ++i) { /* nine tenths are 3 .. 3.4 of 0 .. 12 */
    values[i] = (float)(i % 10 ? 3.0 + 0.4 * (i % 997) / 997.0 : 12.0 * (i % 991) / 990.0);
  }
  const stratus_look look = guess(&v, &options);
  const double frequent = opacity_at(&look, 3.5), rare = opacity_at(&look, 9.0); /* the middles of two twelfths */
  /* 1 / (12 .9083) of the extinction, but at least a tenth; opacities are small, and linear in the extinction to 1 %. */
  if (!(fabs(frequent / rare - 0.1) < 0.001 + 0.05 * 0.1)) {
    fail_msg("%g and %g", frequent, rare);
  }
  for (int i = 0; i < COUNT; ++i) {
    values[i] = (float)(i % 1000) / 999.0f;
  }
  const stratus_look even = guess(&v, &options);
  for (double t = 0.0; t <= 1.0; t += 0.1) { /* a part has 85 bins, and one bin or value more or less at each end */
    assert_true(fabs(opacity_at(&even, t) / opacity_at(&even, 0.5) - 1.0) < 2.0 * 2.0 / 85.0);
  }
}

/* Optical depths of columns by the function's points, the lengths of trapezoids, and the mean weighted by itself. */
static double brute_depth(const stratus_look* look, const double thickness[NZ])
{
  double sum = 0.0, squares = 0.0;
  for (int column = 0; column < NX * NY; ++column) {
    double depth = 0.0;
    for (int k = 0; k < NZ; ++k) {
      const float value = values[column + NX * NY * k];
      depth += isfinite(value) ? -log1p(-opacity_at(look, (double)value)) * thickness[k] / look->unit_distance : 0.0;
    }
    sum += depth;
    squares += depth * depth;
  }
  return squares / sum;
}

static void columns_have_their_optical_depth(void** state)
{
  (void)state;
  static double heights[NZ], thickness[NZ], each[COUNT];
  static const double spacings[][3] = { { 1, 1, 1 }, { 1000, 1000, 0.5 }, { 0.1, 0.1, 30 } };
  for (int n = 0; n < 3 * 4 * 3; ++n) {
    const int spacing = n % 3, kind = n / 3 % 4, layout = n / 12;
    stratus_volume v = view();
    fill_plume(0.45);
    for (int i = 0; i < COUNT && kind == STRATUS_LOOK_SIGNED; ++i) {
      values[i] *= i % NX < 12 ? 1.0f : -1.0f;
    }
    for (int i = 0; i < COUNT && kind == STRATUS_LOOK_STATE; ++i) {
      values[i] = i % 13 == 0 ? NAN : values[i] + 5.0f;
    }
    memcpy(v.spacing, spacings[spacing], sizeof v.spacing);
    stratus_look_options options = stratus_look_options_default();
    options.kind = (stratus_look_kind)kind;
    options.column_axis = 2;
    options.column_depth = spacing == 1 ? 0.7 : 1.5;
    const double factor = spacing == 1 ? 700.0 : 1.0;
    v.matrix[10] = factor; /* heights are exaggerated */
    for (int k = 0; k < NZ; ++k) {
      heights[k] = v.spacing[2] * k * (1.0 + 0.05 * k);
    }
    for (int k = 0; k < NZ; ++k) {
      const double even = v.spacing[2] * (k == 0 || k == NZ - 1 ? 0.5 : 1.0);
      const double stretched = 0.5 * (heights[k < NZ - 1 ? k + 1 : k] - heights[k > 0 ? k - 1 : k]);
      thickness[k] = factor * (layout == 0 ? even : stretched);
    }
    if (layout == 1) {
      v.coordinates[2] = heights;
    }
    if (layout == 2) {
      for (int i = 0; i < COUNT; ++i) {
        each[i] = thickness[i / (NX * NY)];
      }
      options.thickness = each;
    }
    const stratus_look look = guess(&v, &options);
    const double depth = brute_depth(&look, thickness);
    /* Between points opacity is linear, not extinction. A segment has 6 pieces, of an optical depth of 3.9 / 6 at most: the chord of 1 -
     * exp(-x) over it is off by less than 2.7 % of the extinction. */
    if (!(fabs(depth / options.column_depth - 1.0) < 0.027)) {
      fail_msg("case %d: optical depth %g, not %g: %s", n, depth, options.column_depth, look.reason);
    }
  }
}

static void blocks_give_the_functions_of_the_whole(void** state)
{
  (void)state;
  fill_plume(0.4);
  stratus_volume whole = view(), blocks[2] = { view(), view() };
  const int64_t cut = 11;
  blocks[0].dimensions[2] = cut + 1; /* the layer `cut` is in both */
  blocks[1].dimensions[2] = NZ - cut;
  blocks[1].values = values + NX * NY * cut;
  blocks[1].origin[2] = (double)cut;
  stratus_look one = { .opacity_count = 0 }, two = { .opacity_count = 0 };
  assert_int_equal(stratus_look_guess(context, &whole, 1, NULL, &one), STRATUS_OK);
  assert_int_equal(stratus_look_guess(context, blocks, 2, NULL, &two), STRATUS_OK);
  assert_memory_equal(&one, &two, sizeof one);
  stratus_look_values counted = { .low = 0 };
  assert_int_equal(stratus_look_count(context, blocks, 2, &counted), STRATUS_OK);
  assert_true(counted.finite == COUNT);
}

static void refused(const stratus_volume* v, int count, const stratus_look_options* options, const char* words)
{
  stratus_look look = { .opacity_count = 7 };
  assert_int_equal(stratus_look_guess(context, v, count, options, &look), STRATUS_INVALID_ARGUMENT);
  assert_true(look.opacity_count == 7);
  if (!strstr(stratus_context_message(context), words)) {
    fail_msg("'%s' is not in the message '%s'", words, stratus_context_message(context));
  }
}

/* A cloud on a grid of n values a side that is `n` long along x. */
static void fill_cloud(uint8_t* cloud, int n)
{
  float* along = malloc((size_t)n * sizeof *along);
  assert_non_null(along);
  for (int i = 0; i < n; ++i) {
    const float place = 6.0f * ((float)i / (float)(n - 1) - 0.45f);
    along[i] = expf(-place * place);
  }
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      uint8_t* row = cloud + ((size_t)k * (size_t)n + (size_t)j) * (size_t)n;
      const float plane = 255.0f * along[j] * along[k];
      for (int i = 0; i < n; ++i) {
        row[i] = (uint8_t)(plane * along[i]);
      }
    }
  }
  free(along);
}

/* The same field on a grid of which all values are taken, and on a finer one of which a sample is. */
static void a_sample_gives_the_functions_of_all_values(void** state)
{
  static const int sides[] = { 400, 424 };
  stratus_look looks[2][3];
  uint8_t* cloud = malloc((size_t)sides[1] * (size_t)sides[1] * (size_t)sides[1]);
  double places[425];
  (void)state;
  assert_non_null(cloud);
  for (int s = 0; s < 2; ++s) {
    stratus_volume v = stratus_volume_default();
    fill_cloud(cloud, sides[s]);
    v.values = cloud;
    v.type = STRATUS_UINT8;
    for (int a = 0; a < 3; ++a) {
      v.dimensions[a] = sides[s];
      v.spacing[a] = 400.0 / (sides[s] - 1);
    }
    stratus_look_options options = stratus_look_options_default();
    looks[s][0] = guess(&v, NULL);
    options.column_axis = 2;
    looks[s][1] = guess(&v, &options);
    for (int i = 0; i < sides[s]; ++i) {
      places[i] = v.spacing[2] * i;
    }
    v.coordinates[2] = places;
    looks[s][2] = guess(&v, &options);
  }
  free(cloud);
  for (int i = 0; i < 3; ++i) {
    const stratus_look *all = &looks[0][i], *sample = &looks[1][i];
    assert_int_equal(all->kind, sample->kind);
    assert_true(fabs(all->low - sample->low) <= 2.0 && fabs(all->high - sample->high) <= 2.0);
    for (double value = 20.0; value < 250.0; value += 40.0) {
      const double right = -log1p(-opacity_at(all, value)) / all->unit_distance,
                   got = -log1p(-opacity_at(sample, value)) / sample->unit_distance;
      if (!(fabs(got - right) <= 0.05 * right + 1e-6)) {
        fail_msg("look %d: extinction %g at %g, not %g", i, got, value, right);
      }
    }
  }
}

static void wrong_options_are_refused(void** state)
{
  (void)state;
  stratus_volume v[2] = { view(), view() };
  stratus_look_options options = stratus_look_options_default();
  refused(v, 0, NULL, "0 volumes, must be at least 1");
  options.column_axis = 3;
  refused(v, 1, &options, "axis of columns 3, must be in -1..2");
  options = stratus_look_options_default();
  options.column_depth = 0.0;
  refused(v, 1, &options, "optical depth of columns 0, must be above 0");
  options.column_depth = NAN;
  refused(v, 1, &options, "must be above 0 and finite");
  options = stratus_look_options_default();
  options.kind = (stratus_look_kind)9;
  refused(v, 1, &options, "kind 9, must be in 0..5");
  options = stratus_look_options_default();
  options.thickness = (const double[]){ 1.0 };
  refused(v, 2, &options, "thickness is for 1 volume, not 2");
  v[1].type = STRATUS_UINT8;
  refused(v, 2, NULL, "volume 1 is of type 1");
  options = stratus_look_options_default();
  options.logarithmic = 1;
  for (int i = 0; i < COUNT; ++i) {
    values[i] = -1.0f - (float)i;
  }
  refused(v, 1, &options, "there is no value above 0");
}

static int make(void** state)
{
  (void)state;
  context = make_context("host", 2);
  return 0;
}

static int destroy(void** state)
{
  (void)state;
  stratus_context_destroy(context);
  return 0;
}

int test_look(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(variables_are_known_by_standard_name_unit_and_name),
    cmocka_unit_test(maps_of_known_variables_exist),
    cmocka_unit_test(outliers_do_not_eat_the_range),
    cmocka_unit_test(range_without_outliers_is_that_of_the_values),
    cmocka_unit_test(two_sided_values_are_centered),
    cmocka_unit_test(lognormal_tracers_are_over_the_logarithm),
    cmocka_unit_test(outliers_do_not_eat_the_range_of_lognormal_values),
    cmocka_unit_test(decibels_are_over_four_decades),
    cmocka_unit_test(frequent_states_are_more_transparent),
    cmocka_unit_test(columns_have_their_optical_depth),
    cmocka_unit_test(blocks_give_the_functions_of_the_whole),
    cmocka_unit_test(a_sample_gives_the_functions_of_all_values),
    cmocka_unit_test(wrong_options_are_refused),
  };
  return cmocka_run_group_tests(tests, make, destroy);
}
