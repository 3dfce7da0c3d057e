/* SPDX-License-Identifier: BSD-3-Clause
 * The density of air, and the standard atmosphere. */
#include "stratus/cloud.h"

#include "base.h"

/* Of the standard atmosphere. Heights are geopotential, m. */
#define GRAVITY 9.80665
#define STANDARD_GAS 287.05287 /* J kg-1 K-1 */
#define EARTH_RADIUS 6356766.0
#define LOWEST (-5000.0)
#define HIGHEST 80000.0

/* Each layer's lower end: height, temperature, its change with height, K/m, and pressure, which follows from the layers below. */
#define LAYERS 7
static const struct {
  double height, temperature, gradient, pressure;
} layers[LAYERS] = { { 0.0, 288.15, -0.0065, 101325.0 }, { 11000.0, 216.65, 0.0, 22632.040095007793 },
  { 20000.0, 216.65, 0.001, 5474.877424281046 }, { 32000.0, 228.65, 0.0028, 868.0157766202153 },
  { 47000.0, 270.65, 0.0, 110.9057733673104 }, { 51000.0, 270.65, -0.0028, 66.93852812117996 },
  { 71000.0, 214.65, -0.002, 3.956392160396618 } };

static double geopotential_of(double height)
{
  return EARTH_RADIUS * height / (EARTH_RADIUS + height);
}

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
  const double geopotential = geopotential_of(height);
  int i = 0;
  while (i + 1 < LAYERS && geopotential > layers[i + 1].height) {
    ++i;
  }
  const double up = geopotential - layers[i].height, base = layers[i].temperature, gradient = layers[i].gradient;
  const double share =
    gradient != 0.0 ? pow((base + gradient * up) / base, -GRAVITY / (gradient * STANDARD_GAS)) : exp(-GRAVITY * up / (STANDARD_GAS * base));
  *pressure = layers[i].pressure * share;
  *temperature = base + gradient * up;
  return STRATUS_OK;
}

void stratus_air_heights(int64_t count, const double* pressures, double* heights, double* temperatures)
{
  const double highest = geopotential_of(HIGHEST);
  for (int64_t n = 0; pressures && n < count; ++n) {
    const double p = pressures[n];
    int i = 0;
    while (i + 1 < LAYERS && p < layers[i + 1].pressure) {
      ++i;
    }
    const double gradient = layers[i].gradient, temperature = layers[i].temperature;
    double up = NAN;
    if (p >= 0.0) {
      up = gradient != 0.0 ? temperature * (pow(p / layers[i].pressure, -gradient * STANDARD_GAS / GRAVITY) - 1.0) / gradient
                           : -log(p / layers[i].pressure) * STANDARD_GAS * temperature / GRAVITY;
      up = fmin(up, highest - layers[i].height);
    }
    const double geopotential = layers[i].height + up;
    if (heights) {
      heights[n] = EARTH_RADIUS * geopotential / (EARTH_RADIUS - geopotential);
    }
    if (temperatures) {
      temperatures[n] = temperature + gradient * up;
    }
  }
}
