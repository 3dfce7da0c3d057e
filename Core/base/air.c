/* SPDX-License-Identifier: BSD-3-Clause
 * The density of air, and the standard atmosphere. */
#include "stratus/cloud.h"

#include "base.h"

/* Of the standard atmosphere. Heights are geopotential, m. */
#define GRAVITY 9.80665
#define STANDARD_GAS 287.05287 /* J kg-1 K-1 */
#define EARTH_RADIUS 6356766.0
#define LOWEST (-5000.0)
#define HIGHEST 32000.0

stratus_status stratus_air_density(stratus_context* context, double pressure, double temperature, double* density)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!density) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "density is NULL");
  }
  if (!(pressure >= 0.0 && pressure <= 200000.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "pressure of air %g Pa, must be in 0..200000 Pa", pressure);
  }
  if (!(temperature >= 100.0 && temperature <= 400.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "temperature of air %g K, must be in 100..400 K", temperature);
  }
  *density = pressure / (STRATUS_DRY_AIR * temperature);
  return STRATUS_OK;
}

stratus_status stratus_air_standard(stratus_context* context, double height, double* pressure, double* temperature)
{
  /* Each layer's lower end: height, temperature, and its change with height, K/m. */
  static const struct {
    double height, temperature, gradient;
  } layers[] = { { 0.0, 288.15, -0.0065 }, { 11000.0, 216.65, 0.0 }, { 20000.0, 216.65, 0.001 } };
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!pressure || !temperature) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", pressure ? "temperature" : "pressure");
  }
  if (!(height >= LOWEST && height <= HIGHEST)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "height %g m in the standard atmosphere, must be in %g..%g m", height, LOWEST, HIGHEST);
  }
  const double geopotential = EARTH_RADIUS * height / (EARTH_RADIUS + height);
  double p = 101325.0, t = layers[0].temperature;
  for (int i = 0; i < 3 && (i == 0 || geopotential > layers[i].height); ++i) {
    const double top = i < 2 ? fmin(geopotential, layers[i + 1].height) : geopotential, up = top - layers[i].height;
    t = layers[i].temperature + layers[i].gradient * up;
    p *= layers[i].gradient != 0.0 ? pow(t / layers[i].temperature, -GRAVITY / (layers[i].gradient * STANDARD_GAS))
                                   : exp(-GRAVITY * up / (STANDARD_GAS * t));
  }
  *pressure = p;
  *temperature = t;
  return STRATUS_OK;
}
