/* SPDX-License-Identifier: BSD-3-Clause
 * Light along a path: the phase function, the lights that are sampled at each scattering, and the sky that a path escapes to. */
#include "path.h"

#include "lights.h"
#include "vector.h"

#include <string.h>

#define PI 3.141592653589793
#define DEGREE (PI / 180.0)
/* Below this throughput a path ends at random, or is raised to this. */
#define ROULETTE_BELOW 0.25
/* Anisotropies below this scatter evenly. Dividing by a smaller one loses digits, and p differs from even by less than .001%. */
#define EVEN_BELOW 1e-6
/* The smallest divisor of a light's colour, as in the ray caster. */
#define ATTENUATION_LEAST 1e-35

/* ---- the scene */

static void set_light(const stratus_path_field* f, const stratus_light* from, stratus_path_light* light)
{
  memcpy(light->color, from->color, sizeof light->color);
  light->positional = from->positional != 0;
  light->attenuation[0] = 1.0;
  if (!from->positional) {
    memcpy(light->vector, from->vector, sizeof light->vector);
    (void)stratus_vector_normalize(light->vector);
    return;
  }
  stratus_path_to_place(f, from->vector, light->vector);
  if (from->attenuation[0] != 0.0 || from->attenuation[1] != 0.0 || from->attenuation[2] != 0.0) {
    memcpy(light->attenuation, from->attenuation, sizeof light->attenuation);
  }
  if (from->cone_angle > 0.0 && from->cone_angle < 90.0) {
    light->has_cone = 1;
    light->cone_cosine = cos(from->cone_angle * DEGREE);
    light->cone_exponent = from->cone_exponent;
    for (int a = 0; a < 3; ++a) {
      light->axis[a] = -from->axis[a];
    }
    (void)stratus_vector_normalize(light->axis);
  }
}

void stratus_path_scene_set(
  stratus_path_scene* scene, const stratus_path_field* f, const stratus_camera* camera, const stratus_path_options* options)
{
  stratus_light lights[STRATUS_LIGHTS_MAX];
  stratus_shading shading = { .light_count = options->light_count };
  memset(scene, 0, sizeof *scene);
  memcpy(shading.lights, options->lights, sizeof shading.lights);
  scene->light_count = stratus_lights_in_world(camera, &shading, lights);
  for (int i = 0; i < scene->light_count; ++i) {
    set_light(f, &lights[i], &scene->lights[i]);
  }
  scene->bounces = options->bounces;
  scene->albedo = options->albedo;
  scene->anisotropy = options->anisotropy;
  memcpy(scene->zenith, options->sky_zenith, sizeof scene->zenith);
  memcpy(scene->horizon, options->sky_horizon, sizeof scene->horizon);
  memcpy(scene->up, options->up, sizeof scene->up);
  (void)stratus_vector_normalize(scene->up);
  for (int c = 0; c < 3; ++c) {
    scene->has_sky |= scene->zenith[c] > 0.0 || scene->horizon[c] > 0.0;
  }
}

/* ---- the phase function */

/* Returns 4 pi times the phase function. */
static double phase(double g, double cosine)
{
  const double d = 1.0 + g * g - 2.0 * g * cosine;
  return (1.0 - g * g) / (d * sqrt(d));
}

void stratus_path_scatter(double g, stratus_path_random* random, double direction[3])
{
  const double u = stratus_path_uniform(random), around = 2.0 * PI * stratus_path_uniform(random);
  const double ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
  const double cosine = fabs(g) < EVEN_BELOW ? 2.0 * u - 1.0 : fmin(fmax((1.0 + g * g - ratio * ratio) / (2.0 * g), -1.0), 1.0);
  const double sine = sqrt(fmax(1.0 - cosine * cosine, 0.0)), x = sine * cos(around), y = sine * sin(around);
  /* Two directions across it (Duff et al. 2017). */
  const double* d = direction;
  const double sign = copysign(1.0, d[2]), a = -1.0 / (sign + d[2]), b = d[0] * d[1] * a;
  const double first[3] = { 1.0 + sign * d[0] * d[0] * a, sign * b, -sign * d[0] }, second[3] = { b, sign + d[1] * d[1] * a, -d[1] };
  for (int i = 0; i < 3; ++i) {
    direction[i] = x * first[i] + y * second[i] + cosine * direction[i];
  }
  (void)stratus_vector_normalize(direction);
}

/* ---- light */

static void add_sky(const stratus_path_scene* s, const double direction[3], const double throughput[3], double rgba[4])
{
  const double height = fmin(fmax(stratus_vector_dot(direction, s->up), 0.0), 1.0);
  for (int c = 0; c < 3; ++c) {
    rgba[c] += throughput[c] * (s->horizon[c] + height * (s->zenith[c] - s->horizon[c]));
  }
}

/* Gives the direction from a place to the light, its distance, and the fraction of its colour there. Returns false if there is none. */
static bool aim(
  const stratus_path_field* f, const stratus_path_light* light, const double place[3], double to[3], double* distance, double* fraction)
{
  *distance = (double)INFINITY;
  *fraction = 1.0;
  if (!light->positional) {
    memcpy(to, light->vector, 3 * sizeof(double));
    return true;
  }
  const double between[3] = { light->vector[0] - place[0], light->vector[1] - place[1], light->vector[2] - place[2] };
  stratus_path_turn_to_world(f, between, to);
  *distance = stratus_vector_normalize(to);
  const double* a = light->attenuation;
  *fraction = 1.0 / fmax(a[0] + *distance * (a[1] + *distance * a[2]), ATTENUATION_LEAST);
  if (light->has_cone) {
    const double cosine = stratus_vector_dot(light->axis, to);
    *fraction *= cosine >= light->cone_cosine ? pow(cosine, light->cone_exponent) : 0.0;
  }
  return *distance > 0.0 && *fraction > 0.0;
}

/* Adds the light of all lights that scatters at a place into the path. */
static void add_lights(const stratus_path_scene* s, const stratus_path_field* f, const double place[3], const double direction[3],
  const double throughput[3], stratus_path_random* random, double rgba[4], uint64_t* lookups)
{
  for (int i = 0; i < s->light_count; ++i) {
    const stratus_path_light* light = &s->lights[i];
    double to[3], fraction;
    stratus_path_ray ray = { .from = { place[0], place[1], place[2] } };
    if (!aim(f, light, place, to, &ray.end, &fraction)) {
      continue;
    }
    stratus_path_turn_to_place(f, to, ray.along);
    stratus_path_clip(f, &ray);
    const double shown = fraction * phase(s->anisotropy, stratus_vector_dot(direction, to)) * stratus_path_transmittance(f, &ray, random);
    for (int c = 0; c < 3; ++c) {
      rgba[c] += throughput[c] * light->color[c] * shown;
    }
    *lookups += ray.lookups;
  }
}

double stratus_path_trace(const stratus_path_scene* s, const stratus_path_field* f, const stratus_path_ray* first,
  const double first_direction[3], stratus_path_random* random, double rgba[4], uint64_t* vertices, uint64_t* lookups)
{
  stratus_path_ray ray = *first;
  double direction[3] = { first_direction[0], first_direction[1], first_direction[2] }, throughput[3] = { 1.0, 1.0, 1.0 };
  double depth = (double)INFINITY;
  memset(rgba, 0, 4 * sizeof *rgba);
  for (int64_t scattered = 0;; ++scattered) {
    double value = 0.0, color[3];
    const double at = stratus_path_collide(f, &ray, random, &value);
    *lookups += ray.lookups;
    if (!isfinite(at)) {
      if (scattered > 0 && s->has_sky) {
        add_sky(s, direction, throughput, rgba);
      }
      return depth;
    }
    if (scattered == 0) {
      rgba[3] = 1.0;
      depth = at;
    } else if (scattered == s->bounces) {
      return depth;
    }
    ++*vertices;
    stratus_path_color(f, value, color);
    for (int c = 0; c < 3; ++c) {
      throughput[c] *= s->albedo * color[c];
    }
    double most = fmax(fmax(throughput[0], throughput[1]), throughput[2]);
    if (!(most > 0.0)) {
      return depth;
    }
    const double place[3] = { ray.from[0] + at * ray.along[0], ray.from[1] + at * ray.along[1], ray.from[2] + at * ray.along[2] };
    add_lights(s, f, place, direction, throughput, random, rgba, lookups);
    if (scattered + 1 == s->bounces && !s->has_sky) {
      return depth;
    }
    if (most < ROULETTE_BELOW) {
      if (stratus_path_uniform(random) * ROULETTE_BELOW >= most) {
        return depth;
      }
      for (int c = 0; c < 3; ++c) {
        throughput[c] *= ROULETTE_BELOW / most;
      }
    }
    stratus_path_scatter(s->anisotropy, random, direction);
    ray = (stratus_path_ray){ .from = { place[0], place[1], place[2] }, .end = (double)INFINITY };
    stratus_path_turn_to_place(f, direction, ray.along);
    stratus_path_clip(f, &ray);
  }
}
