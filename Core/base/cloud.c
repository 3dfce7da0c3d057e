/* SPDX-License-Identifier: BSD-3-Clause
 * Water of clouds: which variables and units it has, its extinction, and the transfer function and the light that draw it. */
#include "stratus/cloud.h"

#include "base.h"

#include <ctype.h>
#include <string.h>

static bool is_one_of(const char* word, const char* const* words)
{
  while (*words && strcmp(word, *words) != 0) {
    ++words;
  }
  return *words != NULL;
}

stratus_cloud_phase stratus_cloud_phase_of(const char* name, const char* standard_name)
{
  static const char* const standard_water[] = { "mass_concentration_of_cloud_liquid_water_in_air",
    "mass_fraction_of_cloud_liquid_water_in_air", "cloud_liquid_water_mixing_ratio",
    "mass_fraction_of_stratiform_cloud_liquid_water_in_air", "mass_fraction_of_convective_cloud_liquid_water_in_air",
    "mass_concentration_of_cloud_condensed_water_in_air", "mass_fraction_of_cloud_condensed_water_in_air", NULL };
  static const char* const standard_ice[] = { "mass_concentration_of_cloud_ice_in_air", "mass_fraction_of_cloud_ice_in_air",
    "cloud_ice_mixing_ratio", "mass_fraction_of_stratiform_cloud_ice_in_air", "mass_fraction_of_convective_cloud_ice_in_air", NULL };
  static const char* const water[] = { "qc", "qcl", "qcloud", "ql", "qliq", "qn", "lwc", "clw", "clwc", "rc", "rl", NULL };
  static const char* const ice[] = { "qi", "qice", "qci", "iwc", "cli", "ciwc", "ri", NULL };
  if (standard_name && *standard_name) {
    return is_one_of(standard_name, standard_water) ? STRATUS_CLOUD_WATER
      : is_one_of(standard_name, standard_ice)      ? STRATUS_CLOUD_ICE
                                                    : STRATUS_CLOUD_NONE;
  }
  const char* const slash = name ? strrchr(name, '/') : NULL;
  const char* const own = slash ? slash + 1 : name ? name : "";
  char lower[8];
  size_t length = 0;
  for (; own[length] && length + 1 < sizeof lower; ++length) {
    lower[length] = (char)tolower((unsigned char)own[length]);
  }
  if (own[length]) {
    return STRATUS_CLOUD_NONE; /* longer than all of these names */
  }
  lower[length] = '\0';
  return is_one_of(lower, water) ? STRATUS_CLOUD_WATER : is_one_of(lower, ice) ? STRATUS_CLOUD_ICE : STRATUS_CLOUD_NONE;
}

/* Writes a unit without blanks and signs of powers: "kg m-3", "kg.m^-3", "kg m**-3" and "kg/m3" become "kgm-3". False: it is too long. */
static bool squeeze_unit(const char* unit, char* text, size_t size)
{
  size_t length = 0;
  bool divided = false;
  for (const char* p = unit; *p; ++p) {
    const bool after_slash = divided && isdigit((unsigned char)*p) != 0;
    if (strchr(" .*^\t", *p)) {
      continue;
    }
    if (*p == '/') {
      divided = true;
      continue;
    }
    if (length + 3 > size) {
      return false;
    }
    if (after_slash) {
      text[length++] = '-';
      divided = false;
    }
    text[length++] = *p;
  }
  if (divided) { /* "g/kg" */
    text[length++] = '-';
    text[length++] = '1';
  }
  text[length] = '\0';
  return true;
}

stratus_cloud_measure stratus_cloud_unit(const char* unit, double* factor)
{
  static const struct {
    const char* symbol;
    double kilograms;
  } masses[] = { { "kg", 1.0 }, { "mg", 1e-6 }, { "ug", 1e-9 }, { "g", 1e-3 } };
  static const struct {
    const char* symbol;
    double amount; /* m3 or kg */
    stratus_cloud_measure measure;
  } airs[] = { { "m-3", 1.0, STRATUS_CLOUD_CONTENT }, { "cm-3", 1e-6, STRATUS_CLOUD_CONTENT }, { "kg-1", 1.0, STRATUS_CLOUD_MIXING_RATIO },
    { "g-1", 1e-3, STRATUS_CLOUD_MIXING_RATIO } };
  char text[32];
  if (!unit || !factor || !squeeze_unit(unit, text, sizeof text)) {
    return STRATUS_CLOUD_UNKNOWN;
  }
  if (strcmp(text, "1") == 0) {
    *factor = 1.0;
    return STRATUS_CLOUD_MIXING_RATIO;
  }
  for (size_t m = 0; m < sizeof masses / sizeof *masses; ++m) {
    const size_t length = strlen(masses[m].symbol);
    for (size_t a = 0; a < sizeof airs / sizeof *airs && strncmp(text, masses[m].symbol, length) == 0; ++a) {
      if (strcmp(text + length, airs[a].symbol) == 0) {
        *factor = masses[m].kilograms / airs[a].amount;
        return airs[a].measure;
      }
    }
  }
  return STRATUS_CLOUD_UNKNOWN;
}

static stratus_status check_within(stratus_context* context, const char* what, double value, double low, double high, const char* unit)
{
  if (!(value >= low && value <= high)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s %g %s, must be in %g..%g %s", what, value, unit, low, high, unit);
  }
  return STRATUS_OK;
}

stratus_status stratus_cloud_extinction(stratus_context* context, double content, double radius, double density, double* extinction)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!extinction) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "extinction is NULL");
  }
  if (!(content >= 0.0 && isfinite(content))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "water content %g kg/m3, must be at least 0 and finite", content);
  }
  TRY(check_within(context, "effective radius", radius * 1e6, 0.1, 10000.0, "um"));
  TRY(check_within(context, "density of the particles", density, 1.0, 1e5, "kg/m3"));
  *extinction = 1.5 * content / (density * radius);
  return STRATUS_OK;
}

stratus_status stratus_cloud_opacity(stratus_context* context, double extinction, double highest, double points[4], double* unit_distance)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!points || !unit_distance) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", points ? "unit_distance" : "points");
  }
  if (!(extinction > 0.0 && isfinite(extinction))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "extinction of the value 1 is %g, must be above 0 and finite", extinction);
  }
  if (!(highest > 0.0 && isfinite(highest))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "largest water content is %g, must be above 0 and finite", highest);
  }
  const double depth = 2.0 * STRATUS_CLOUD_ERROR, distance = depth / extinction / highest;
  if (!(distance > 0.0 && isfinite(distance))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "extinction %g of the largest water content %g gives a unit distance of %g, must be above 0 and finite", extinction, highest,
      distance);
  }
  points[0] = points[1] = 0.0;
  points[2] = highest;
  points[3] = -expm1(-depth);
  *unit_distance = distance;
  return STRATUS_OK;
}

double stratus_screen_level(double linear)
{
  return linear > 0.0031308 ? 1.055 * pow(linear, 1.0 / 2.4) - 0.055 : 12.92 * fmax(linear, 0.0);
}

void stratus_cloud_light(double sun[3], double zenith[3], double horizon[3])
{
  /* A white surface that faces the zenith shows 4 times the colour of a sun there, and the horizon's radiance / 3 + the zenith's 2 / 3:
   * here 4/3. */
  static const double light[3][3] = { { 0.295, 0.271, 0.228 }, { 0.085, 0.19, 0.4 }, { 0.29, 0.37, 0.46 } };
  double* const out[3] = { sun, zenith, horizon };
  for (int i = 0; i < 3; ++i) {
    for (int c = 0; c < 3 && out[i]; ++c) {
      out[i][c] = light[i][c];
    }
  }
}
