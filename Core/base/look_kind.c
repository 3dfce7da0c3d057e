/* SPDX-License-Identifier: BSD-3-Clause
 * Finds the kind of a variable by its standard name, unit and name, and the colour map for it. */
#include "stratus/cloud.h"
#include "stratus/look.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

enum { AMOUNT = STRATUS_LOOK_AMOUNT, STATE = STRATUS_LOOK_STATE, SIGNED = STRATUS_LOOK_SIGNED, TRACER = STRATUS_LOOK_TRACER };

/* A text, what it says about a variable, and colour maps for a dark and a bright background. */
typedef struct look_rule {
  const char* text;
  int kind;
  const char *dark, *bright;
} look_rule;

/* Parts of standard names, the first that fits. */
static const look_rule standard_names[] = {
  { "tendency", SIGNED, "cool-warm", "balance" },
  { "anomaly", SIGNED, "cool-warm", "balance" },
  { "vorticity", SIGNED, "cool-warm", "curl" },
  { "divergence", SIGNED, "cool-warm", "delta" },
  { "wind_speed", AMOUNT, "speed_r", "speed" },
  { "water_speed", AMOUNT, "speed_r", "speed" },
  { "_wind", SIGNED, "cool-warm", "balance" },
  { "velocity", SIGNED, "cool-warm", "balance" },
  { "temperature", STATE, "thermal", "thermal" },
  { "salinity", STATE, "haline", "haline" },
  { "oxygen", STATE, "oxy", "oxy" },
  { "chlorophyll", TRACER, "algae_r", "algae" },
  { "phytoplankton", TRACER, "algae_r", "algae" },
  { "cloud", AMOUNT, "cloud", "ice_r" },
  { "rain", AMOUNT, "rain_r", "rain" },
  { "precipitation", AMOUNT, "rain_r", "rain" },
  { "snow", AMOUNT, "ice", "ice_r" },
  { "graupel", AMOUNT, "ice", "ice_r" },
  { "humidity", AMOUNT, "tempo_r", "tempo" },
  { "water_vapor", AMOUNT, "tempo_r", "tempo" },
  { "sediment", TRACER, "turbid_r", "turbid" },
  { "suspended_matter", TRACER, "turbid_r", "turbid" },
  { "dust", TRACER, "turbid_r", "turbid" },
  { "volcanic_ash", TRACER, "turbid_r", "turbid" },
  { "aerosol", TRACER, "turbid_r", "turbid" },
  { "mass_fraction_of", TRACER, "viridis", "viridis_r" },
  { "mole_fraction_of", TRACER, "viridis", "viridis_r" },
  { "concentration_of", TRACER, "viridis", "viridis_r" },
  { "mixing_ratio", TRACER, "viridis", "viridis_r" },
  { "area_fraction", AMOUNT, "viridis", "viridis_r" },
  { "density", STATE, "dense_r", "dense" },
  { "pressure", STATE, "viridis", "viridis" },
  { "geopotential", STATE, "viridis", "viridis" },
};

/* Whole names in small letters. */
static const look_rule names[] = {
  { "temp", STATE, "thermal", "thermal" },
  { "temperature", STATE, "thermal", "thermal" },
  { "theta", STATE, "thermal", "thermal" },
  { "thetao", STATE, "thermal", "thermal" },
  { "votemper", STATE, "thermal", "thermal" },
  { "salt", STATE, "haline", "haline" },
  { "salinity", STATE, "haline", "haline" },
  { "so", STATE, "haline", "haline" },
  { "vosaline", STATE, "haline", "haline" },
  { "o2", STATE, "oxy", "oxy" },
  { "oxygen", STATE, "oxy", "oxy" },
  { "chl", TRACER, "algae_r", "algae" },
  { "chlorophyll", TRACER, "algae_r", "algae" },
  { "dye", TRACER, "viridis", "viridis_r" },
  { "tracer", TRACER, "viridis", "viridis_r" },
  { "cl", AMOUNT, "cloud", "ice_r" },
  { "cc", AMOUNT, "cloud", "ice_r" },
  { "qr", AMOUNT, "rain_r", "rain" },
  { "qrain", AMOUNT, "rain_r", "rain" },
  { "qs", AMOUNT, "ice", "ice_r" },
  { "qsnow", AMOUNT, "ice", "ice_r" },
  { "qg", AMOUNT, "ice", "ice_r" },
  { "qgraup", AMOUNT, "ice", "ice_r" },
  { "qv", AMOUNT, "tempo_r", "tempo" },
  { "qvapor", AMOUNT, "tempo_r", "tempo" },
};

/* Whole units, without spaces and in small letters. A unit without a kind does not decide. */
static const look_rule units_known[] = {
  { "k", STATE, "thermal", "thermal" },
  { "kelvin", STATE, "thermal", "thermal" },
  { "degc", STATE, "thermal", "thermal" },
  { "celsius", STATE, "thermal", "thermal" },
  { "degreec", STATE, "thermal", "thermal" },
  { "degree_c", STATE, "thermal", "thermal" },
  { "degrees_c", STATE, "thermal", "thermal" },
  { "degree_celsius", STATE, "thermal", "thermal" },
  { "degrees_celsius", STATE, "thermal", "thermal" },
  { "psu", STATE, "haline", "haline" },
  { "pss-78", STATE, "haline", "haline" },
  { "ms-1", SIGNED, "cool-warm", "balance" },
  { "m/s", SIGNED, "cool-warm", "balance" },
  { "ms^-1", SIGNED, "cool-warm", "balance" },
  { "ms**-1", SIGNED, "cool-warm", "balance" },
  { "metersecond-1", SIGNED, "cool-warm", "balance" },
  { "pas-1", SIGNED, "cool-warm", "balance" },
  { "pa/s", SIGNED, "cool-warm", "balance" },
  { "pas**-1", SIGNED, "cool-warm", "balance" },
  { "s-1", SIGNED, "cool-warm", "curl" },
  { "s**-1", SIGNED, "cool-warm", "curl" },
  { "dbz", STRATUS_LOOK_DECIBELS, "turbo", "turbo" },
  { "ppm", TRACER, "viridis", "viridis_r" },
  { "ppb", TRACER, "viridis", "viridis_r" },
};

/* Beginnings of units of a matter's mass or number by that of another matter, or by a volume. */
static const char* const matters[] = { "kg", "g", "mg", "ug", "mol", "mmol", "umol", "nmol" };

static void copy_small(const char* text, bool spaces, char copy[64])
{
  size_t length = 0;
  for (; text && *text && length < 63; ++text) {
    if (spaces || !isspace((unsigned char)*text)) {
      copy[length++] = (char)tolower((unsigned char)*text);
    }
  }
  copy[length] = '\0';
}

static const look_rule* find_rule(const look_rule* rules, size_t count, const char* text, bool whole)
{
  for (size_t i = 0; i < count; ++i) {
    if (whole ? strcmp(text, rules[i].text) == 0 : strstr(text, rules[i].text) != NULL) {
      return rules + i;
    }
  }
  return NULL;
}

static bool is_concentration(const char* units)
{
  for (size_t i = 0; i < sizeof matters / sizeof *matters; ++i) {
    const size_t length = strlen(matters[i]);
    const char* const rest = units + length;
    if (strncmp(units, matters[i], length) == 0 &&
      (strncmp(rest, "kg", 2) == 0 || strncmp(rest, "m-3", 3) == 0 || strncmp(rest, "m^-3", 4) == 0 || strncmp(rest, "m**-3", 5) == 0 ||
        strncmp(rest, "l-1", 3) == 0 || (rest[0] == '/' && strchr("kmlg", rest[1]) && rest[1]))) {
      return true;
    }
  }
  return false;
}

stratus_look_kind stratus_look_kind_of(const char* name, const char* standard_name, const char* units, int bright, const char** color_map)
{
  static const look_rule cloud = { "", AMOUNT, "cloud", "ice_r" }, matter = { "", TRACER, "viridis", "viridis_r" };
  const char* const last = name ? strrchr(name, '/') : NULL;
  char standard[64], unit[64], own[64];
  copy_small(standard_name, false, standard);
  copy_small(units, false, unit);
  copy_small(last ? last + 1 : name, false, own);
  const look_rule* rule = stratus_cloud_phase_of(name, standard_name) != STRATUS_CLOUD_NONE ? &cloud : NULL;
  rule = rule ? rule : find_rule(standard_names, sizeof standard_names / sizeof *standard_names, standard, false);
  rule = rule ? rule : find_rule(units_known, sizeof units_known / sizeof *units_known, unit, true);
  rule = rule ? rule : find_rule(names, sizeof names / sizeof *names, own, true);
  rule = rule ? rule : is_concentration(unit) ? &matter : NULL;
  if (color_map) {
    *color_map = !rule ? NULL : bright ? rule->bright : rule->dark;
  }
  return rule ? (stratus_look_kind)rule->kind : STRATUS_LOOK_UNKNOWN;
}
