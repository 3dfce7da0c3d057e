/* SPDX-License-Identifier: BSD-3-Clause
 * Checks lights, and converts them to floats. */
#include "lights.h"

#include "vector.h"

#include <string.h>

_Static_assert(STRATUS_LIGHTS_MAX == 8, "as many as the arguments hold");

/* A positional light at least this many units of length away counts as directional. */
#define LIGHT_FAR 1e15
#define DEGREE 0.017453292519943295

stratus_shading stratus_shading_default(void)
{
  return (stratus_shading){ .on = 1, .ambient = 0.1, .diffuse = 0.9, .specular_power = 10.0, .light_count = -1, .up = { 0.0, 0.0, 1.0 } };
}

static stratus_status check_light(stratus_context* context, const stratus_light* light, int number)
{
  for (int i = 0; i < 3; ++i) {
    if (!isfinite(light->vector[i]) || !(light->color[i] >= 0.0 && light->color[i] <= STRATUS_LIGHT_MAX)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
        "light %d has vector (%g, %g, %g) and colour (%g, %g, %g), must be finite and colours 0..%g", number, light->vector[0],
        light->vector[1], light->vector[2], light->color[0], light->color[1], light->color[2], STRATUS_LIGHT_MAX);
    }
  }
  for (int i = 0; light->separate_specular && i < 3; ++i) {
    if (!(light->specular_color[i] >= 0.0 && light->specular_color[i] <= STRATUS_LIGHT_MAX)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "light %d has highlights of colour (%g, %g, %g), must be 0..%g", number,
        light->specular_color[0], light->specular_color[1], light->specular_color[2], STRATUS_LIGHT_MAX);
    }
  }
  if (!light->positional && light->vector[0] == 0.0 && light->vector[1] == 0.0 && light->vector[2] == 0.0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "light %d has the direction (0, 0, 0), must have a length", number);
  }
  if (!light->positional) {
    return STRATUS_OK;
  }
  if (light->follows_camera) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "light %d is positional and follows the camera, must be a direction to follow it", number);
  }
  for (int i = 0; i < 3; ++i) {
    if (!(light->attenuation[i] >= 0.0 && light->attenuation[i] <= STRATUS_LIGHT_MAX)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "light %d has attenuation (%g, %g, %g), must be 0..%g", number,
        light->attenuation[0], light->attenuation[1], light->attenuation[2], STRATUS_LIGHT_MAX);
    }
  }
  if (!(light->cone_angle >= 0.0) || !isfinite(light->cone_angle)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "light %d has a cone of %g degrees, must be 0 or more and finite", number, light->cone_angle);
  }
  if (light->cone_angle == 0.0 || light->cone_angle >= 90.0) {
    return STRATUS_OK;
  }
  const double square = light->axis[0] * light->axis[0] + light->axis[1] * light->axis[1] + light->axis[2] * light->axis[2];
  if (!(square > 0.0) || !isfinite(square) || !(light->cone_exponent >= 0.0 && light->cone_exponent <= STRATUS_LIGHT_MAX)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "light %d has a cone about (%g, %g, %g) of exponent %g, must have a length and be 0..%g", number, light->axis[0], light->axis[1],
      light->axis[2], light->cone_exponent, STRATUS_LIGHT_MAX);
  }
  return STRATUS_OK;
}

static double length_of(const double v[3])
{
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static stratus_status check_multiple(stratus_context* context, const stratus_shading* shading)
{
  bool even = true;
  if (!(shading->scattering > 0.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "multiple scattering with scattering %g, must be above 0", shading->scattering);
  }
  for (int c = 0; c < 3; ++c) {
    const double zenith = shading->sky_zenith[c], horizon = shading->sky_horizon[c];
    if (!(zenith >= 0.0 && zenith <= STRATUS_LIGHT_MAX && horizon >= 0.0 && horizon <= STRATUS_LIGHT_MAX)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the sky's colour is %g at the zenith and %g at the horizon, must be 0..%g",
        zenith, horizon, STRATUS_LIGHT_MAX);
    }
    even = even && zenith == horizon;
  }
  if (!even && !(length_of(shading->up) > 0.0 && isfinite(length_of(shading->up)))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the sky's zenith is at (%g, %g, %g), must be finite and have a length",
      shading->up[0], shading->up[1], shading->up[2]);
  }
  return STRATUS_OK;
}

stratus_status stratus_shading_check(stratus_context* context, const stratus_shading* shading)
{
  const double factors[4] = { shading->ambient, shading->diffuse, shading->specular, shading->specular_power };
  static const char* const names[4] = { "ambient", "diffuse", "specular", "specular power" };
  for (int i = 0; i < 4; ++i) {
    if (!(factors[i] >= 0.0 && factors[i] <= STRATUS_LIGHT_MAX)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "shading's %s is %g, must be 0..%g", names[i], factors[i], STRATUS_LIGHT_MAX);
    }
  }
  if (!(shading->scattering >= 0.0 && shading->scattering <= 1.0) || !(fabs(shading->anisotropy) <= STRATUS_ANISOTROPY_MOST)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "scattering %g must be 0..1, and anisotropy %g -%g..%g", shading->scattering,
      shading->anisotropy, STRATUS_ANISOTROPY_MOST, STRATUS_ANISOTROPY_MOST);
  }
  if (!(shading->shadow_length >= 0.0) || !isfinite(shading->shadow_length)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "shadows have a length of %g, must be 0 or more and finite", shading->shadow_length);
  }
  if (shading->multiple) {
    TRY(check_multiple(context, shading));
  }
  if (shading->light_count < -1 || shading->light_count > STRATUS_LIGHTS_MAX) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "%d lights, must be 0..%d, or -1 for one at the eye", shading->light_count, STRATUS_LIGHTS_MAX);
  }
  for (int i = 0; i < shading->light_count; ++i) {
    TRY(check_light(context, &shading->lights[i], i));
  }
  return STRATUS_OK;
}

static stratus_light light_in_world(const stratus_camera* camera, const stratus_light* light)
{
  stratus_light result = *light;
  if (light->follows_camera) {
    double basis[3][3], vector[3] = { light->vector[0], light->vector[1], light->vector[2] };
    memcpy(basis[0], camera->right, sizeof basis[0]);
    memcpy(basis[1], camera->up, sizeof basis[1]);
    (void)stratus_vector_normalize(basis[0]);
    (void)stratus_vector_normalize(basis[1]);
    stratus_vector_cross(basis[0], basis[1], basis[2]); /* forward may lead to the middle of a part of a picture */
    (void)stratus_vector_normalize(basis[2]);
    (void)stratus_vector_normalize(vector);
    const double turn = stratus_vector_dot(basis[2], camera->forward) > 0.0 ? -1.0 : 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      result.vector[axis] = vector[0] * basis[0][axis] + vector[1] * basis[1][axis] + vector[2] * turn * basis[2][axis];
    }
    result.follows_camera = 0;
  }
  return result;
}

int stratus_lights_in_world(const stratus_camera* camera, const stratus_shading* shading, stratus_light lights[STRATUS_LIGHTS_MAX])
{
  for (int i = 0; i < shading->light_count; ++i) {
    lights[i] = light_in_world(camera, &shading->lights[i]);
  }
  if (shading->light_count >= 0) {
    return shading->light_count;
  }
  lights[0] = (stratus_light){ .color = { 1.0, 1.0, 1.0 }, .positional = !camera->parallel };
  for (int axis = 0; axis < 3; ++axis) {
    lights[0].vector[axis] = camera->parallel ? -camera->forward[axis] : camera->eye[axis];
  }
  return 1;
}

/* Converts a light to floats: a direction of length 1, or a position relative to the origin in units of `unit`. */
static void set_light(const stratus_light* light, const double origin[3], double unit, int number, stratus_light_arguments* a)
{
  double vector[3];
  for (int axis = 0; axis < 3; ++axis) {
    vector[axis] = light->vector[axis] - (light->positional ? origin[axis] : 0.0);
  }
  const double largest = fmax(fmax(fabs(vector[0]), fabs(vector[1])), fabs(vector[2]));
  const bool near = light->positional && largest < LIGHT_FAR * unit;
  for (int axis = 0; axis < 3; ++axis) {
    vector[axis] /= near ? unit : largest;
  }
  const double length = near ? 1.0 : length_of(vector);
  for (int axis = 0; axis < 3; ++axis) {
    a->vector[number][axis] = (float)(vector[axis] / length);
    a->color[number][axis] = (float)light->color[axis];
    a->specular_color[number][axis] = (float)(light->separate_specular ? light->specular_color : light->color)[axis];
  }
  a->positional[number] = near;
  const bool dimmed = near && (light->attenuation[0] != 0.0 || light->attenuation[1] != 0.0 || light->attenuation[2] != 0.0);
  const double units[3] = { 1.0, unit, unit * unit };
  for (int i = 0; i < 3; ++i) {
    a->attenuation[number][i] = dimmed ? (float)fmin(light->attenuation[i] * units[i], 1e30) : i == 0;
    a->cone[number][i] = 0.0f;
  }
  a->cone[number][3] = -1.0f;
  a->cone[number][4] = (float)light->cone_exponent;
  if (near && light->cone_angle > 0.0 && light->cone_angle < 90.0) {
    double axis[3] = { light->axis[0], light->axis[1], light->axis[2] };
    const double axis_length = stratus_vector_normalize(axis);
    for (int i = 0; axis_length > 0.0 && i < 3; ++i) {
      a->cone[number][i] = (float)axis[i];
    }
    a->cone[number][3] = (float)cos(light->cone_angle * DEGREE);
  }
}

void stratus_lights_set(const stratus_camera* camera, const stratus_shading* shading, const double origin[3], double unit,
  stratus_light lights[STRATUS_LIGHTS_MAX], stratus_light_arguments* a)
{
  const double g = shading->anisotropy;
  a->two_sided = !shading->one_sided;
  a->turns = a->two_sided && shading->scattering < 1.0 && shading->light_count >= 0; /* a light at the eye sees both alike */
  a->scattered = (float)shading->scattering;
  a->phase[0] = (float)(1.0 - g * g);
  a->phase[1] = (float)(1.0 + g * g);
  a->phase[2] = (float)(2.0 * g);
  a->count = stratus_lights_in_world(camera, shading, lights);
  a->scatter_at = -1;
  a->scatter_way = (float)g;
  for (int i = 0; i < a->count; ++i) {
    set_light(&lights[i], origin, unit, i, a);
    a->map_at[i] = -1;
  }
}

bool stratus_lights_want_shadows(const stratus_shading* shading)
{
  return shading->shadows || shading->multiple;
}

bool stratus_lights_cast_shadows(const stratus_shading* shading, bool shade, const stratus_material* materials, int count)
{
  for (int c = 0; materials && c < count; ++c) {
    shade = (c > 0 && shade) || materials[c].shade;
  }
  return shade && stratus_lights_want_shadows(shading);
}

const stratus_material* stratus_lights_show_albedo(
  const stratus_shading* lit, const stratus_material* own, int count, stratus_shading* shading, stratus_material materials[4])
{
  *shading = (stratus_shading){ .on = 1, .ambient = lit->diffuse, .scattering = 1.0 };
  for (int c = 0; own && c < count; ++c) {
    materials[c] = (stratus_material){ .shade = 1, .ambient = own[c].shade ? own[c].diffuse : 0.0 };
  }
  return own ? materials : NULL;
}

static double reflectance(double diffuse, double specular, double power)
{
  return diffuse + specular / sqrt(2.0 * power + 1.0);
}

double stratus_lights_reflectance(const stratus_shading* shading, const stratus_material* own, int count)
{
  const double specular = shading->scattering < 1.0 ? 1.0 : 0.0; /* scattered light has no highlights */
  double most = own ? 0.0 : reflectance(shading->diffuse, specular * shading->specular, shading->specular_power);
  for (int c = 0; own && c < count; ++c) {
    most = own[c].shade ? fmax(most, reflectance(own[c].diffuse, specular * own[c].specular, own[c].specular_power)) : most;
  }
  return most;
}
