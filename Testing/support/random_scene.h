/* SPDX-License-Identifier: BSD-3-Clause
 * Random volumes, transfer functions and views, of the kinds that users bring: smooth and rough fields, thin shells and plates in fog,
 * labels; ramps, peaks, windows, stripes. The same seed gives the same scene on every machine but for the last bits of sin() and exp(). */
#ifndef STRATUS_TESTING_RANDOM_SCENE_H
#define STRATUS_TESTING_RANDOM_SCENE_H

#include "picture_case.h"

#define RANDOM_POINTS 64

typedef struct random_scene {
  stratus_volume volume;
  stratus_transfer transfer;
  stratus_camera camera;
  stratus_interpolation interpolation;
  double opacity[2 * RANDOM_POINTS], color[4 * RANDOM_POINTS];
  void* values;
  char kind[64];
} random_scene;

/* Smooth noise in -1..1: values at lattice points `cell` voxels apart, blended by a smooth step. */
static inline double random_hash(int64_t x, int64_t y, int64_t z, uint32_t seed)
{
  uint32_t h = (uint32_t)x * 0x9e3779b1u ^ (uint32_t)y * 0x85ebca77u ^ (uint32_t)z * 0xc2b2ae3du ^ seed * 0x27d4eb2fu;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  h = (h ^ h >> 12) * 0x297a2d39u;
  h ^= h >> 15;
  return (double)(h >> 8) / 8388608.0 - 1.0;
}

static inline double random_noise(double x, double y, double z, double cell, uint32_t seed)
{
  const double p[3] = { x / cell, y / cell, z / cell };
  int64_t i[3];
  double f[3], value = 0.0;
  for (int a = 0; a < 3; ++a) {
    i[a] = (int64_t)floor(p[a]);
    f[a] = p[a] - (double)i[a];
    f[a] = f[a] * f[a] * (3.0 - 2.0 * f[a]);
  }
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    for (int a = 0; a < 3; ++a) {
      weight *= corner >> a & 1 ? f[a] : 1.0 - f[a];
    }
    value += weight * random_hash(i[0] + (corner & 1), i[1] + (corner >> 1 & 1), i[2] + (corner >> 2), seed);
  }
  return value;
}

/* A field in 0..1 at a voxel. */
static inline double random_field(int kind, const double n[3], const double p[3], const double shape[8], uint32_t seed)
{
  double q[3], square = 0.0;
  for (int a = 0; a < 3; ++a) {
    q[a] = (p[a] - (n[a] - 1.0) * (0.5 + 0.2 * shape[a])) / (0.5 * n[a]);
    square += q[a] * q[a];
  }
  const double radius = sqrt(square), cell = 3.0 + 14.0 * shape[3] * shape[3];
  const double noise = random_noise(p[0], p[1], p[2], cell, seed), fine = random_noise(p[0], p[1], p[2], 2.0, seed + 1);
  switch (kind) {
    case 0: /* smooth */
      return 0.5 + 0.5 * noise;
    case 1: /* noise of two sizes */
      return 0.5 + 0.35 * noise + 0.15 * fine;
    case 2: /* a cloud in empty space */
      return fmax(0.0, 1.0 - radius / (0.4 + 0.5 * shape[4]) + 0.3 * noise);
    case 3: /* a thin shell in fog */
      return 0.15 + 0.05 * noise + 0.8 * exp(-pow((radius - 0.6) * n[0] / (2.0 + 6.0 * shape[5]), 2.0));
    case 4: /* a plate in fog */
      return 0.15 + 0.05 * noise + 0.8 * (fabs(q[2] + 0.3 * q[0]) * n[2] < 2.0 + 4.0 * shape[5] && fabs(q[1]) < 0.5 ? 1.0 : 0.0);
    case 5: /* labels */
      return floor(5.99 * (0.5 + 0.5 * noise)) / 5.0;
    case 6: /* thin haze and a small rough block */
      return 0.1 + 0.03 * noise + (fabs(q[0]) < 0.15 && fabs(q[1]) < 0.15 && fabs(q[2]) < 0.15 ? 0.4 + 0.4 * fine : 0.0);
    default: /* a steep gradient from side to side, bent by noise */
      return fmin(1.0, fmax(0.0, p[0] / n[0] + 0.1 * noise));
  }
}

static inline void random_point(random_scene* s, double lo, double hi, double x, double opacity)
{
  double* point = s->opacity + 2 * s->transfer.opacity_count++;
  point[0] = lo + x * (hi - lo);
  point[1] = opacity;
}

/* Points in ascending order. lo, hi: the range of the field 0..1 in values. */
static inline void random_functions(random_scene* s, double lo, double hi, uint32_t* state)
{
  static const char* const names[] = { "ramp", "peak", "window", "steps", "points", "constant" };
  const int kind = (int)(case_random(state) % 6);
  const double strength = pow(10.0, case_uniform(state, -2.5, -0.02)), at = case_uniform(state, 0.15, 0.8);
  const double width = pow(10.0, case_uniform(state, -2.5, -0.5));
  s->transfer = stratus_transfer_default();
  s->transfer.opacity = s->opacity;
  s->transfer.color = s->color;
  if (kind == 0) {
    random_point(s, lo, hi, case_uniform(state, 0.0, 0.4), 0.0);
    random_point(s, lo, hi, 1.0, strength);
  } else if (kind == 1) {
    random_point(s, lo, hi, at - width, 0.0);
    random_point(s, lo, hi, at, strength);
    random_point(s, lo, hi, at + width, 0.0);
  } else if (kind == 2) { /* a window with vertical sides over a faint ramp */
    const double faint = case_random(state) % 2 ? 0.0 : 0.01 * strength;
    random_point(s, lo, hi, 0.0, faint);
    random_point(s, lo, hi, at, faint);
    random_point(s, lo, hi, at, strength);
    random_point(s, lo, hi, fmin(at + width, 1.0), strength);
    random_point(s, lo, hi, fmin(at + width, 1.0), faint);
    random_point(s, lo, hi, 1.0, faint);
  } else if (kind == 3 || kind == 4) {
    const int count = 2 + (int)(case_random(state) % 8);
    double opacity = strength * case_uniform(state, 0.0, 1.0);
    for (int i = 0; i < count; ++i) {
      const double x = (i + case_uniform(state, 0.1, 0.9)) / count;
      if (kind == 3) {
        random_point(s, lo, hi, x, opacity);
      }
      opacity = case_random(state) % 3 ? strength * case_uniform(state, 0.0, 1.0) : 0.0;
      random_point(s, lo, hi, x, opacity);
    }
  } else {
    random_point(s, lo, hi, 0.0, strength);
  }
  const int stripes = case_random(state) % 3 == 0, colors = 2 + (int)(case_random(state) % (stripes ? 19 : 6));
  double rgb[3] = { 0.5, 0.5, 0.5 };
  for (int i = 0; i < colors; ++i) {
    const double x = lo + (hi - lo) * (stripes ? (double)i : (double)i + case_uniform(state, 0.0, 0.9)) / colors;
    for (int side = stripes && i > 0 ? 0 : 1; side < 2; ++side) {
      double* point = s->color + 4 * s->transfer.color_count++;
      point[0] = x;
      for (int c = 0; side == 1 && c < 3; ++c) {
        rgb[c] = case_uniform(state, 0.0, 1.0);
      }
      memcpy(point + 1, rgb, sizeof rgb);
    }
  }
  snprintf(s->kind + strlen(s->kind), sizeof s->kind - strlen(s->kind), " %s%s %.2g", names[kind], stripes ? " stripes" : "", strength);
}

static inline void random_scene_create(stratus_context* context, uint32_t seed, double aspect, random_scene* s)
{
  static const char* const names[] = { "smooth", "rough", "cloud", "shell", "plate", "labels", "haze+block", "steep" };
  uint32_t state = seed * 7919u + 17u;
  case_random(&state);
  memset(s, 0, sizeof *s);
  const int kind = (int)(case_random(&state) % 8);
  const stratus_type types[] = { STRATUS_UINT8, STRATUS_UINT16, STRATUS_INT16, STRATUS_FLOAT32, STRATUS_FLOAT32, STRATUS_FLOAT64 };
  const stratus_type type = types[case_random(&state) % 6];
  const double lo = type == STRATUS_INT16 ? -1000.0 : 0.0,
               hi = type == STRATUS_UINT8 ? 255.0
    : type == STRATUS_UINT16              ? 65535.0
    : type == STRATUS_INT16               ? 3000.0
    : case_random(&state) % 2             ? 1.0
                                          : 68.0;
  double n[3], shape[8];
  s->volume = stratus_volume_default();
  s->volume.type = type;
  size_t count = 1;
  const double stretch = case_random(&state) % 4 ? 1.0 : case_uniform(&state, 0.3, 4.0), unit = pow(10.0, case_uniform(&state, -3.0, 3.0));
  for (int a = 0; a < 3; ++a) {
    s->volume.dimensions[a] = 24 + case_random(&state) % 40;
    s->volume.spacing[a] = unit * (a == 2 ? stretch : 1.0);
    n[a] = (double)s->volume.dimensions[a];
    count *= (size_t)s->volume.dimensions[a];
  }
  for (int i = 0; i < 8; ++i) {
    shape[i] = case_uniform(&state, 0.0, 1.0);
  }
  s->values = calloc(count, stratus_type_size(type));
  assert_non_null(s->values);
  s->volume.values = s->values;
  for (size_t at = 0; at < count; ++at) {
    const size_t nx = (size_t)s->volume.dimensions[0], ny = (size_t)s->volume.dimensions[1];
    const double p[3] = { (double)(at % nx), (double)(at / nx % ny), (double)(at / nx / ny) };
    case_store(s->values, type, at, lo + (hi - lo) * fmin(1.0, fmax(0.0, random_field(kind, n, p, shape, seed))));
  }
  snprintf(s->kind, sizeof s->kind, "%s", names[kind]);
  random_functions(s, lo, hi, &state);
  s->transfer.unit_distance = unit * pow(2.0, case_uniform(&state, -1.0, 3.0));
  double bounds[6];
  assert_int_equal(stratus_volume_bounds(context, &s->volume, bounds), STRATUS_OK);
  const double angle = case_uniform(&state, 0.0, 6.28), height = case_uniform(&state, -0.9, 0.9), side = sqrt(1.0 - height * height);
  double eye[3], focal[3], reach = 0.0;
  const double direction[3] = { side * cos(angle), side * sin(angle), height }, up[3] = { 0.1, 0.2, 1.0 };
  for (int a = 0; a < 3; ++a) {
    focal[a] = 0.5 * (bounds[2 * a] + bounds[2 * a + 1]);
    reach += 0.25 * (bounds[2 * a + 1] - bounds[2 * a]) * (bounds[2 * a + 1] - bounds[2 * a]);
  }
  reach = sqrt(reach);
  const double back = reach * case_uniform(&state, 1.6, 5.0);
  for (int a = 0; a < 3; ++a) {
    eye[a] = focal[a] + back * direction[a];
  }
  if (case_random(&state) % 3 == 0) {
    assert_int_equal(stratus_camera_parallel(context, eye, focal, up, 0.8 * reach, aspect, &s->camera), STRATUS_OK);
  } else {
    const double degrees = 2.0 * atan(0.8 * reach / back) * 180.0 / 3.141592653589793;
    assert_int_equal(stratus_camera_perspective(context, eye, focal, up, degrees, aspect, &s->camera), STRATUS_OK);
  }
}

static inline void random_scene_destroy(random_scene* s)
{
  free(s->values);
}

#endif
