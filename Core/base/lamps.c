/* SPDX-License-Identifier: BSD-3-Clause
 * The light of first hits, which are solids, in double: Phong's formula, with the reflected ray. */
#include "lights.h"

#include "vector.h"

#include <string.h>

void stratus_lamps_set(const stratus_camera* camera, const stratus_shading* shading, stratus_lamps* lamps)
{
  lamps->shading = shading;
  lamps->count = stratus_lights_in_world(camera, shading, lamps->lights);
  for (int i = 0; i < lamps->count; ++i) {
    if (!lamps->lights[i].positional) {
      (void)stratus_vector_normalize(lamps->lights[i].vector);
    }
  }
}

double stratus_lamp_reaching(const stratus_light* light, const double to[3], double distance)
{
  const double* a = light->attenuation;
  double part = a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0 ? 1.0 : 1.0 / fmax(a[0] + distance * (a[1] + distance * a[2]), 1e-35);
  if (light->cone_angle > 0.0 && light->cone_angle < 90.0) {
    double axis[3] = { -light->axis[0], -light->axis[1], -light->axis[2] };
    (void)stratus_vector_normalize(axis);
    const double cosine = stratus_vector_dot(axis, to);
    part *= cosine >= cos(light->cone_angle * 0.017453292519943295) ? pow(cosine, light->cone_exponent) : 0.0;
  }
  return part;
}

void stratus_lamps_shine(
  const stratus_lamps* lamps, const double point[3], const double normal[3], const double direction[3], double rgb[3])
{
  const stratus_shading* shading = lamps->shading;
  double light[3] = { shading->ambient, shading->ambient, shading->ambient }, gloss[3] = { 0.0, 0.0, 0.0 };
  for (int i = 0; i < lamps->count; ++i) {
    double to[3];
    for (int axis = 0; axis < 3; ++axis) {
      to[axis] = lamps->lights[i].vector[axis] - (lamps->lights[i].positional ? point[axis] : 0.0);
    }
    const double distance = lamps->lights[i].positional ? stratus_vector_normalize(to) : 1.0;
    if (distance == 0.0) {
      memcpy(to, normal, sizeof to); /* the light is at the hit */
    }
    const double cosine = stratus_vector_dot(normal, to);
    if (!(cosine > 0.0)) {
      continue;
    }
    const double mirrored =
      stratus_vector_dot(to, direction) - 2.0 * cosine * stratus_vector_dot(normal, direction); /* R . V, with V = -direction */
    const double shine = shading->specular > 0.0 && mirrored > 0.0 ? shading->specular * pow(mirrored, shading->specular_power) : 0.0;
    const double part = lamps->lights[i].positional ? stratus_lamp_reaching(&lamps->lights[i], to, distance) : 1.0;
    const double* specular_color = lamps->lights[i].separate_specular ? lamps->lights[i].specular_color : lamps->lights[i].color;
    for (int c = 0; c < 3; ++c) {
      light[c] += part * shading->diffuse * cosine * lamps->lights[i].color[c];
      gloss[c] += part * shine * specular_color[c];
    }
  }
  for (int c = 0; c < 3; ++c) {
    rgb[c] = rgb[c] * light[c] + gloss[c];
  }
}
