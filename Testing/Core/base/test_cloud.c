/* SPDX-License-Identifier: BSD-3-Clause
 * Clouds in physical units: extinction, the transfer function's error, units and names, air, and the sun against an ephemeris. */
#include "structures.h"

#include "stratus/cloud.h"

static stratus_context* context;

static void assert_within(double value, double expected, double error)
{
  if (!(fabs(value - expected) <= error)) {
    fail_msg("%.17g, not %.17g within %g", value, expected, error);
  }
}

static void refused(stratus_status status, const char* words)
{
  assert_int_equal(status, STRATUS_INVALID_ARGUMENT);
  if (!strstr(stratus_context_message(context), words)) {
    fail_msg("'%s' is not in the message '%s'", words, stratus_context_message(context));
  }
}

/* Spheres of one radius: their number in a cubic metre times twice their cross-section. */
static void extinction_is_twice_the_cross_section_of_the_droplets(void** state)
{
  static const double contents[] = { 0.0, 1e-6, 3e-4, 2e-3 }, radii[] = { 2e-6, 1e-5, 3e-5 }, densities[] = { 1000.0, 917.0 };
  (void)state;
  const double pi = 3.14159265358979323846;
  for (size_t c = 0; c < 4; ++c) {
    for (size_t r = 0; r < 3; ++r) {
      for (size_t d = 0; d < 2; ++d) {
        const double mass = densities[d] * 4.0 / 3.0 * pi * radii[r] * radii[r] * radii[r];
        const double expected = contents[c] / mass * 2.0 * pi * radii[r] * radii[r];
        double extinction = -1.0;
        assert_int_equal(stratus_cloud_extinction(context, contents[c], radii[r], densities[d], &extinction), STRATUS_OK);
        assert_within(extinction, expected, 1e-14 * expected); /* ten roundings */
      }
    }
  }
  double extinction = 7.0;
  refused(stratus_cloud_extinction(context, -1e-3, 1e-5, 1000.0, &extinction), "water content -0.001 kg/m3");
  refused(stratus_cloud_extinction(context, NAN, 1e-5, 1000.0, &extinction), "water content");
  refused(stratus_cloud_extinction(context, 1e-3, 10.0, 1000.0, &extinction), "effective radius 1e+07 um, must be in 0.1..10000 um");
  refused(stratus_cloud_extinction(context, 1e-3, NAN, 1000.0, &extinction), "effective radius");
  refused(stratus_cloud_extinction(context, 1e-3, 1e-5, 0.0, &extinction), "density of the particles 0 kg/m3");
  assert_true(extinction == 7.0);
}

/* The extinction that a transfer function has at a value, as the header says it: linear opacity between points. */
static double extinction_at(const double points[4], double unit_distance, double value)
{
  const double part = (value - points[0]) / (points[2] - points[0]);
  return -log1p(-(points[1] + part * (points[3] - points[1]))) / unit_distance;
}

static void opacity_keeps_the_extinction_of_every_value(void** state)
{
  (void)state;
  const double extinctions[] = { 1e-9, 0.15, 150.0, 1e12 }, highest[] = { 1e-30, 1e-3, 4.0, 65535.0 };
  for (size_t e = 0; e < 4; ++e) {
    for (size_t h = 0; h < 4; ++h) {
      double points[4], distance = 0.0, worst = 0.0;
      assert_int_equal(stratus_cloud_opacity(context, extinctions[e], highest[h], points, &distance), STRATUS_OK);
      assert_true(points[0] == 0.0 && points[1] == 0.0 && points[2] == highest[h] && points[3] > 0.0 && points[3] < 1.0);
      for (int i = 1; i <= 1000; ++i) {
        const double value = highest[h] * i / 1000.0, expected = extinctions[e] * value;
        const double error = extinction_at(points, distance, value) / expected - 1.0;
        assert_true(error < 1e-12); /* never above, but for roundings */
        worst = fmax(worst, -error);
      }
      assert_true(worst <= STRATUS_CLOUD_ERROR);
      assert_true(worst > 0.9 * STRATUS_CLOUD_ERROR); /* the bound is what the smallest values have */
    }
  }
  double points[4], distance = 0.0;
  refused(stratus_cloud_opacity(context, 0.0, 1.0, points, &distance), "extinction of the value 1 is 0");
  refused(stratus_cloud_opacity(context, INFINITY, 1.0, points, &distance), "extinction of the value 1 is inf");
  refused(stratus_cloud_opacity(context, 1.0, -2.0, points, &distance), "largest water content is -2");
  refused(stratus_cloud_opacity(context, 1e200, 1e200, points, &distance), "unit distance of 0");
  refused(stratus_cloud_opacity(context, 1e-200, 1e-200, points, &distance), "unit distance of inf");
}

static void water_of_clouds_is_known_by_name(void** state)
{
  static const struct {
    const char *name, *standard_name;
    stratus_cloud_phase phase;
  } cases[] = { { "qc", NULL, STRATUS_CLOUD_WATER }, { "QCLOUD", "", STRATUS_CLOUD_WATER }, { "run1/clw", NULL, STRATUS_CLOUD_WATER },
    { "QICE", NULL, STRATUS_CLOUD_ICE }, { "cli", NULL, STRATUS_CLOUD_ICE },
    { "x", "mass_fraction_of_cloud_ice_in_air", STRATUS_CLOUD_ICE },
    { "x", "mass_concentration_of_cloud_liquid_water_in_air", STRATUS_CLOUD_WATER },
    { "qc", "mass_fraction_of_rain_in_air", STRATUS_CLOUD_NONE }, /* the standard name counts */
    { "qr", NULL, STRATUS_CLOUD_NONE }, { "QRAIN", NULL, STRATUS_CLOUD_NONE }, { "QVAPOR", NULL, STRATUS_CLOUD_NONE },
    { "qcloudy", NULL, STRATUS_CLOUD_NONE }, { "qc/", NULL, STRATUS_CLOUD_NONE }, { "", NULL, STRATUS_CLOUD_NONE },
    { NULL, NULL, STRATUS_CLOUD_NONE } };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    if (stratus_cloud_phase_of(cases[i].name, cases[i].standard_name) != cases[i].phase) {
      fail_msg("case %zu, '%s'", i, cases[i].name ? cases[i].name : "NULL");
    }
  }
}

static void units_of_water_are_known(void** state)
{
  static const struct {
    const char* unit;
    stratus_cloud_measure measure;
    double factor;
  } cases[] = { { "kg m-3", STRATUS_CLOUD_CONTENT, 1.0 }, { "g/m3", STRATUS_CLOUD_CONTENT, 1e-3 },
    { "g m^-3", STRATUS_CLOUD_CONTENT, 1e-3 }, { "mg.m**-3", STRATUS_CLOUD_CONTENT, 1e-6 }, { "g cm-3", STRATUS_CLOUD_CONTENT, 1e3 },
    { "kg kg-1", STRATUS_CLOUD_MIXING_RATIO, 1.0 }, { "kg/kg", STRATUS_CLOUD_MIXING_RATIO, 1.0 },
    { "g kg-1", STRATUS_CLOUD_MIXING_RATIO, 1e-3 }, { "g/kg", STRATUS_CLOUD_MIXING_RATIO, 1e-3 },
    { "kg kg**-1", STRATUS_CLOUD_MIXING_RATIO, 1.0 }, { "1", STRATUS_CLOUD_MIXING_RATIO, 1.0 }, { "", STRATUS_CLOUD_UNKNOWN, 7.0 },
    { NULL, STRATUS_CLOUD_UNKNOWN, 7.0 }, { "kg", STRATUS_CLOUD_UNKNOWN, 7.0 }, { "kg m-2", STRATUS_CLOUD_UNKNOWN, 7.0 },
    { "kg m3", STRATUS_CLOUD_UNKNOWN, 7.0 }, { "%", STRATUS_CLOUD_UNKNOWN, 7.0 }, { "kg m-3 s-1", STRATUS_CLOUD_UNKNOWN, 7.0 },
    { "a unit that is longer than any that is known here", STRATUS_CLOUD_UNKNOWN, 7.0 }, { "/", STRATUS_CLOUD_UNKNOWN, 7.0 } };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    double factor = 7.0;
    const stratus_cloud_measure measure = stratus_cloud_unit(cases[i].unit, &factor);
    if (measure != cases[i].measure || !(fabs(factor / cases[i].factor - 1.0) < 1e-15)) {
      fail_msg("unit '%s': %d, %g", cases[i].unit ? cases[i].unit : "NULL", (int)measure, factor);
    }
  }
}

/* Table of the U.S. Standard Atmosphere 1976, which equals ICAO's up to 80 km: geometric height, K, Pa, kg/m3, as many digits as printed.
 */
static void standard_atmosphere_is_that_of_the_tables(void** state)
{
  static const struct {
    double height, temperature, pressure, density;
  } rows[] = { { 0.0, 288.150, 101325.0, 1.2250 }, { 1000.0, 281.651, 89876.0, 1.1117 }, { 5000.0, 255.676, 54048.0, 0.73643 },
    { 10000.0, 223.252, 26500.0, 0.41351 }, { 15000.0, 216.650, 12111.0, 0.19476 }, { 20000.0, 216.650, 5529.3, 0.088910 },
    { 30000.0, 226.509, 1197.0, 0.018410 }, { 40000.0, 250.350, 287.14, 3.9957e-3 }, { 50000.0, 270.650, 79.779, 1.0269e-3 },
    { 60000.0, 247.021, 21.958, 3.0968e-4 }, { 70000.0, 219.585, 5.2209, 8.2829e-5 }, { 80000.0, 198.639, 1.0524, 1.8458e-5 } };
  (void)state;
  double pressure = 0.0, temperature = 0.0, density = 0.0;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; ++i) {
    assert_int_equal(stratus_air_standard(context, rows[i].height, &pressure, &temperature), STRATUS_OK);
    assert_int_equal(stratus_air_density(context, pressure, temperature, &density), STRATUS_OK);
    assert_within(temperature, rows[i].temperature, 0.001);
    assert_within(pressure, rows[i].pressure, 1e-4 * rows[i].pressure);
    assert_within(density, rows[i].density, 1e-4 * rows[i].density);
  }
  /* without jumps where layers meet */
  static const double meetings[] = { 11019.0, 20063.0, 32162.0, 47350.0, 51413.0, 71802.0 };
  for (size_t i = 0; i < sizeof meetings / sizeof *meetings; ++i) {
    const double meeting = meetings[i];
    double above = 0.0, below = 0.0;
    assert_int_equal(stratus_air_standard(context, meeting - 1.0, &below, &temperature), STRATUS_OK);
    assert_int_equal(stratus_air_standard(context, meeting + 1.0, &above, &temperature), STRATUS_OK);
    assert_true(above < below && above > below * (1.0 - 4.0 / 6000.0)); /* a scale height is above 6 km */
  }
  refused(stratus_air_standard(context, 80001.0, &pressure, &temperature),
    "height 80001 m in the standard atmosphere, must be in -5000..80000 m");
  refused(stratus_air_standard(context, NAN, &pressure, &temperature), "height");
  refused(stratus_air_density(context, -1.0, 280.0, &density), "pressure of air -1 Pa");
  refused(stratus_air_density(context, 1e5, 15.0, &density), "temperature of air 15 K, must be in 100..400 K");
}

static void heights_of_pressures_are_those_of_the_standard_atmosphere(void** state)
{
  (void)state;
  double pressure = 0.0, temperature = 0.0, back = 0.0, again = 0.0;
  for (double height = -5000.0; height <= 80000.0; height += 97.0) {
    assert_int_equal(stratus_air_standard(context, height, &pressure, &temperature), STRATUS_OK);
    stratus_air_heights(1, &pressure, &back, &again);
    assert_within(back, height, 1e-6);
    assert_within(again, temperature, 1e-9);
  }
  const double outside[] = { 0.0, 0.5, -1.0, NAN };
  double heights[4];
  stratus_air_heights(4, outside, heights, NULL);
  assert_within(heights[0], 80000.0, 1e-6);
  assert_within(heights[1], 80000.0, 1e-6);
  assert_true(isnan(heights[2]) && isnan(heights[3]));
}

/* The first position is published: 39.872046 degrees above the horizon and azimuth 194.340241 (Reda & Andreas 2004, Solar Energy 76, 577,
 * table A5.1, their e0). The others are PyEphem 4.2.1's, whose VSOP87 is right to an arc second, without refraction. In 25,000 positions
 * the largest distance from them was .0143 degrees. */
static void sun_is_where_an_ephemeris_has_it(void** state)
{
  static const struct {
    const char* time;
    double latitude, longitude, azimuth, elevation;
  } cases[] = { { "2003-10-17 19:30:30", 39.742476, -105.1786, 194.3402, 39.8720 },
    { "1980-05-04 23:25", -3.76, -147.56, 310.1448, 58.5776 }, { "1952-07-18 09:51", 87.22, -158.82, 347.6217, 18.2959 },
    { "2016-09-12 08:49", -58.27, -141.77, 190.4750, -35.2736 }, { "1977-01-27 20:51", -42.67, -82.17, 286.3481, 43.2983 },
    { "1971-05-10 20:55", 41.28, 127.67, 71.7509, 5.9734 }, { "1997-02-28 19:21", 30.56, 2.14, 273.0925, -20.4865 },
    { "1972-04-16 08:05", 79.13, 114.44, 237.8749, 16.1645 }, { "2020-05-01 09:36", 36.47, -67.77, 70.0464, -1.0589 },
    { "2047-09-07 13:27", 17.61, -24.82, 167.4847, 78.0778 }, { "1970-04-10 08:52", 52.94, -150.81, 339.6614, -27.2764 },
    { "2009-11-09 16:34", 26.34, 72.32, 278.7242, -56.1637 }, { "1968-11-07 02:26", 73.61, 48.61, 93.9290, -15.8196 },
    { "2006-05-06 11:27", 43.96, -64.56, 90.0424, 24.3018 }, { "2021-04-11 03:53", -78.03, -97.61, 221.4217, -17.4930 },
    { "1900-03-01 12:00", 51.48, 0.0, 176.3701, 30.8124 }, { "2100-06-21 03:00", -33.9, 151.2, 343.1873, 30.7517 } };
  (void)state;
  double azimuth = 0.0, elevation = 0.0, seconds = 0.0;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    double here[3], there[3];
    assert_int_equal(stratus_time_parse(context, cases[i].time, &seconds), STRATUS_OK);
    assert_int_equal(stratus_sun_position(context, seconds, cases[i].latitude, cases[i].longitude, &azimuth, &elevation), STRATUS_OK);
    assert_true(azimuth >= 0.0 && azimuth < 360.0);
    assert_int_equal(stratus_sun_direction(context, azimuth, elevation, 2, here), STRATUS_OK);
    assert_int_equal(stratus_sun_direction(context, cases[i].azimuth, cases[i].elevation, 2, there), STRATUS_OK);
    const double apart =
      sqrt(pow(here[0] - there[0], 2.0) + pow(here[1] - there[1], 2.0) + pow(here[2] - there[2], 2.0)) * 180.0 / 3.14159265358979323846;
    if (!(apart <= 0.02)) {
      fail_msg("%s: azimuth %g, elevation %g, %g degrees away", cases[i].time, azimuth, elevation, apart);
    }
  }
  refused(stratus_sun_position(context, seconds, 91.0, 0.0, &azimuth, &elevation), "latitude 91 degrees, must be in -90..90");
  refused(stratus_sun_position(context, seconds, 0.0, 400.0, &azimuth, &elevation), "longitude 400 degrees");
  refused(stratus_sun_position(context, 1e12, 0.0, 0.0, &azimuth, &elevation), "must be in 1900..2100");
  refused(stratus_sun_position(context, NAN, 0.0, 0.0, &azimuth, &elevation), "time");
}

static void direction_turns_from_north_to_east(void** state)
{
  (void)state;
  double d[3];
  for (int up = 0; up < 3; ++up) {
    const int east = (up + 1) % 3, north = (up + 2) % 3;
    assert_int_equal(stratus_sun_direction(context, 0.0, 0.0, up, d), STRATUS_OK);
    assert_true(d[north] == 1.0 && d[east] == 0.0 && d[up] == 0.0);
    assert_int_equal(stratus_sun_direction(context, 90.0, 0.0, up, d), STRATUS_OK);
    assert_within(d[east], 1.0, 1e-15);
    assert_int_equal(stratus_sun_direction(context, 123.0, 90.0, up, d), STRATUS_OK);
    assert_within(d[up], 1.0, 1e-15);
    assert_int_equal(stratus_sun_direction(context, -135.0, 30.0, up, d), STRATUS_OK);
    assert_within(d[up], 0.5, 1e-15);
    assert_within(d[east], -sqrt(0.375), 1e-15);
    assert_within(d[north], -sqrt(0.375), 1e-15);
  }
  refused(stratus_sun_direction(context, 361.0, 0.0, 2, d), "azimuth of the sun 361 degrees, must be in -360..360");
  refused(stratus_sun_direction(context, 0.0, 90.5, 2, d), "elevation of the sun 90.5 degrees, must be in -90..90");
  refused(stratus_sun_direction(context, 0.0, 0.0, 3, d), "upward axis 3");
}

/* A white surface that faces the sun at the zenith shows the irradiance of sun and sky over pi. */
static void light_shows_a_thick_cloud_as_white(void** state)
{
  (void)state;
  double sun[3], zenith[3], horizon[3];
  stratus_cloud_light(sun, zenith, horizon);
  for (int c = 0; c < 3; ++c) {
    double sky = 0.0; /* the integral of radiance times the cosine over the half sphere, over pi */
    for (int i = 0; i < 1000; ++i) {
      const double cosine = (i + 0.5) / 1000.0;
      sky += 2.0 * cosine * (horizon[c] + (zenith[c] - horizon[c]) * cosine) / 1000.0;
    }
    assert_within(0.75 * (4.0 * sun[c] + sky), 1.0, 0.005); /* the colours have three digits */
  }
  stratus_cloud_light(NULL, NULL, NULL);
}

/* The levels of bytes by the standard's inverse, which is another formula. */
static void screen_levels_are_those_of_srgb(void** state)
{
  (void)state;
  for (int byte = 0; byte < 256; ++byte) {
    const double level = byte / 255.0, linear = level <= 0.04045 ? level / 12.92 : pow((level + 0.055) / 1.055, 2.4);
    assert_within(stratus_screen_level(linear), level, 1e-6); /* the standard's limits have five digits */
  }
  assert_within(stratus_screen_level(-1.0), 0.0, 0.0);
  assert_within(stratus_screen_level(NAN), 0.0, 0.0);
  assert_true(stratus_screen_level(1.5) > 1.0);
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

int test_cloud(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(extinction_is_twice_the_cross_section_of_the_droplets),
    cmocka_unit_test(opacity_keeps_the_extinction_of_every_value),
    cmocka_unit_test(water_of_clouds_is_known_by_name),
    cmocka_unit_test(units_of_water_are_known),
    cmocka_unit_test(standard_atmosphere_is_that_of_the_tables),
    cmocka_unit_test(heights_of_pressures_are_those_of_the_standard_atmosphere),
    cmocka_unit_test(sun_is_where_an_ephemeris_has_it),
    cmocka_unit_test(direction_turns_from_north_to_east),
    cmocka_unit_test(light_shows_a_thick_cloud_as_white),
    cmocka_unit_test(screen_levels_are_those_of_srgb),
  };
  return cmocka_run_group_tests(tests, make, destroy);
}
