/* SPDX-License-Identifier: BSD-3-Clause
 * Clouds in physical units: from water content to extinction and transfer function, the density of air, and the position of the sun. */
#ifndef STRATUS_PUBLIC_CLOUD_H
#define STRATUS_PUBLIC_CLOUD_H

#include "calendar.h"
#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Density of the particles, kg/m3. */
#define STRATUS_WATER_DENSITY 1000.0
#define STRATUS_ICE_DENSITY 917.0
/* Usual effective radii, m. */
#define STRATUS_WATER_RADIUS 1.0e-5
#define STRATUS_ICE_RADIUS 3.0e-5
/* Single-scattering albedo, and anisotropy of the phase function of Henyey and Greenstein, of cloud particles in visible light. */
#define STRATUS_CLOUD_ALBEDO 1.0
#define STRATUS_CLOUD_ANISOTROPY 0.85
/* A water content, kg/m3, that no cloud reaches: clouds have some g/m3 at most. */
#define STRATUS_CLOUD_MOST_CONTENT 0.1
/* Largest relative error of the extinction of stratus_cloud_opacity(). */
#define STRATUS_CLOUD_ERROR 0.001
/* Gas constant of dry air, J kg-1 K-1. */
#define STRATUS_DRY_AIR 287.05

typedef enum stratus_cloud_phase {
  STRATUS_CLOUD_NONE, /* not a cloud's water */
  STRATUS_CLOUD_WATER,
  STRATUS_CLOUD_ICE
} stratus_cloud_phase;

typedef enum stratus_cloud_measure {
  STRATUS_CLOUD_UNKNOWN,
  STRATUS_CLOUD_CONTENT,     /* mass of water in a volume of air, such as kg m-3 */
  STRATUS_CLOUD_MIXING_RATIO /* mass of water by mass of air, such as kg kg-1 */
} stratus_cloud_measure;

/* Find out whether a variable of a model's output is the water of clouds.
 * - standard_name: of the CF conventions, such as "mass_fraction_of_cloud_liquid_water_in_air"; NULL or "": none. If there is one, the name
 *   is not read.
 * - name: the variable's, such as "qc", "QCLOUD", "clw" or "QICE", in any case; NULL or "": none. A path before it ("run1/qc") is ignored.
 * Rain, snow, graupel, vapour and totals of all water are not cloud water. */
STRATUS_API stratus_cloud_phase stratus_cloud_phase_of(const char* name, const char* standard_name);

/* Find out what a unit measures, and its factor to kg m-3 or kg kg-1. Known are kg, g, mg and ug by m3, cm3, kg or g, written "kg m-3",
 * "g/m3", "g m^-3", "kg kg**-1" ..., and "1" as kg kg-1. For other texts and NULL return STRATUS_CLOUD_UNKNOWN, and leave *factor. */
STRATUS_API stratus_cloud_measure stratus_cloud_unit(const char* unit, double* factor);

/* Compute the extinction of particles that are much larger than light's wavelength: 3 content / (2 density radius), in 1/m (Stephens 1978,
 * J. Atmos. Sci. 35, 2123, equation 7; each particle removes light from twice its cross-section).
 * - content: of water in air, kg/m3, finite and not negative
 * - radius: the effective radius, m, 1e-7 to 1e-2
 * - density: of the particles, kg/m3, 1 to 1e5 */
STRATUS_API stratus_status stratus_cloud_extinction(
  stratus_context* context, double content, double radius, double density, double* extinction);

/* Make the opacity of a transfer function whose extinction is proportional to the value.
 * - extinction: of the value 1, per world length, finite and above 0
 * - highest: the largest value of the data, finite and above 0
 * - points: two pairs of value and opacity, for stratus_transfer.opacity. Values below 0 get the opacity 0, values above `highest` the
 *   opacity of `highest`.
 * - unit_distance: for stratus_transfer.unit_distance
 * Opacity 1 - exp(-x) is not linear in the optical depth x of a unit distance. The line from 0 to the end x = h has an optical depth of at
 * most x and at least x (1 - exp(-h)) / h > x (1 - h / 2). The unit distance is chosen so that h = 2 STRATUS_CLOUD_ERROR: each value's
 * extinction is too small by at most the share STRATUS_CLOUD_ERROR. */
STRATUS_API stratus_status stratus_cloud_opacity(
  stratus_context* context, double extinction, double highest, double points[4], double* unit_distance);

/* Get light for pictures as a photographer exposes clouds: a surface that reflects 3/4 of all light, as a thick cloud does, and faces the
 * sun at the zenith shows 1 in each colour. Returns the colour of the sun (see stratus_shading: an irradiance of E is a colour of E / (4
 * pi)), and the radiance of a clear sky at the zenith and at the horizon, about a fifth of all light. They are linear, and a screen needs
 * them encoded, as by stratus_screen_level().
 */
STRATUS_API void stratus_cloud_light(double sun[3], double zenith[3], double horizon[3]);

/* Return the level of a screen, 0 for black and 1 for white, that shows a linear level: sRGB (IEC 61966-2-1). Levels below 0 count as 0,
 * levels above 1 are not limited. */
STRATUS_API double stratus_screen_level(double linear);

/* Compute the density of dry air, kg/m3: pressure / (STRATUS_DRY_AIR temperature).
 * - pressure: Pa, 0 to 200000
 * - temperature: K, 100 to 400 */
STRATUS_API stratus_status stratus_air_density(stratus_context* context, double pressure, double temperature, double* density);

/* Compute pressure (Pa) and temperature (K) of the standard atmosphere (ICAO Doc 7488, ISO 2533) at a height above the sea, -5000 to 80000
 * m. */
STRATUS_API stratus_status stratus_air_standard(stratus_context* context, double height, double* pressure, double* temperature);
/* Compute heights above the sea (m) of pressures (Pa) in the standard atmosphere, and temperatures (K) there. Pressures below that at 80000
 * m, 1.05 Pa, are at 80000 m. NaN where a pressure is below 0 or NaN. heights, temperatures: NULL: not wanted. */
STRATUS_API void stratus_air_heights(int64_t count, const double* pressures, double* heights, double* temperatures);

/* Compute where the sun's centre is in the sky, without the air's refraction, which lifts it by .1 degrees at 10 degrees of elevation and
 * by .5 at the horizon. The Astronomical Almanac's formula, by Michalsky 1988 (Solar Energy 40, 227), within .02 degrees.
 * - seconds: as of stratus_time_parse(); years 1900 to 2100
 * - latitude: degrees, -90 to 90; longitude: degrees east, -360 to 360
 * - azimuth: degrees clockwise from north, at least 0 and below 360; elevation: degrees above the horizon, -90 to 90 */
STRATUS_API stratus_status stratus_sun_position(
  stratus_context* context, double seconds, double latitude, double longitude, double* azimuth, double* elevation);

/* Compute the direction to the sun, of length 1, in a world whose axis `up` (0, 1, 2) points upwards, the next one east and the one after
 * that north: x is east and y north if z is up.
 * - azimuth: degrees clockwise from north, -360 to 360; elevation: degrees, -90 to 90 */
STRATUS_API stratus_status stratus_sun_direction(stratus_context* context, double azimuth, double elevation, int up, double direction[3]);

#ifdef __cplusplus
}
#endif

#endif
