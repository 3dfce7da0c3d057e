/* SPDX-License-Identifier: BSD-3-Clause
 * Cameras, pictures to draw into, and checks that any picture must pass. */
#include "fuzz.h"

#include <stdlib.h>

/* Difference that the rounding of colours and of alphas may cause: a fortieth of a step of 8 bits. */
#define PREMULTIPLIED_SLACK 1e-4f

/* ---- cameras */

static void spoil_camera(fuzz* f, stratus_camera* camera)
{
  double* const numbers[] = { camera->eye, camera->forward, camera->right, camera->up };
  for (int i = 0; i < 12; ++i) {
    numbers[i / 3][i % 3] = fuzz_odd(f) ? fuzz_odd_real(f) : numbers[i / 3][i % 3];
  }
  camera->near_k = fuzz_odd(f) ? fuzz_odd_real(f) : camera->near_k;
  camera->far_k = fuzz_odd(f) ? fuzz_odd_real(f) : camera->far_k;
  camera->parallel = fuzz_odd(f) ? (int)(uint32_t)(uint64_t)fuzz_odd_integer(f) : camera->parallel;
}

/* Axes that are neither orthogonal nor of one length, as in off-axis projections and parts of windows, and beyond. */
static void skew(fuzz* f, stratus_camera* camera)
{
  for (int axis = 0; axis < 3; ++axis) {
    const double r = camera->right[axis], u = camera->up[axis];
    camera->forward[axis] += fuzz_between(f, -0.5, 0.5) * r + fuzz_between(f, -0.5, 0.5) * u;
    camera->right[axis] += fuzz_between(f, -0.5, 0.5) * u;
  }
}

stratus_camera fuzz_camera(fuzz* f, const double bounds[6])
{
  stratus_camera camera = { .forward = { 0, 0, 1 }, .right = { 1, 0, 0 }, .up = { 0, 1, 0 }, .far_k = INFINITY };
  double eye[3], focal[3], view_up[3], radius = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    radius = fmax(radius, 0.5 * (bounds[2 * axis + 1] - bounds[2 * axis]));
  }
  radius = radius > 0.0 && isfinite(radius) ? radius : 1.0;
  const double distance = radius *
    (fuzz_chance(f, 0.2)       ? fuzz_between(f, 0.0, 1.5)
        : fuzz_chance(f, 0.85) ? fuzz_between(f, 1.5, 8.0)
                               : fuzz_scale(f, 8.0, 1e5));
  for (int axis = 0; axis < 3; ++axis) {
    focal[axis] = 0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]) + 0.3 * radius * fuzz_between(f, -1.0, 1.0);
    const double along = fuzz_chance(f, 0.15) ? 0.0 : fuzz_between(f, -1.0, 1.0); /* 0: along the grid's axes */
    eye[axis] = focal[axis] + distance * along;
    view_up[axis] = fuzz_between(f, -1.0, 1.0);
  }
  const double aspect = fuzz_chance(f, 0.8) ? fuzz_between(f, 0.5, 2.0) : fuzz_scale(f, 1e-2, 1e2);
  stratus_status status;
  if (fuzz_chance(f, 0.6)) {
    const double angle = fuzz_chance(f, 0.9) ? 2.0 * atan(1.3 * radius / fmax(distance, 0.5 * radius)) * 57.29 : fuzz_scale(f, 1e-3, 179.0);
    status = STATUS(stratus_camera_perspective(f->context, eye, focal, view_up, angle, aspect, &camera));
  } else {
    status = STATUS(stratus_camera_parallel(f->context, eye, focal, view_up, radius * fuzz_between(f, 0.3, 2.0), aspect, &camera));
  }
  if (status == STRATUS_OK && fuzz_chance(f, 0.2)) {
    skew(f, &camera);
  }
  if (fuzz_chance(f, 0.3)) {
    camera.near_k = fmax(0.0, distance - radius * fuzz_between(f, -0.5, 1.5));
    camera.near_k = camera.parallel && fuzz_chance(f, 0.2) ? -radius : camera.near_k;
    camera.far_k = camera.near_k + radius * fuzz_between(f, 0.1, 4.0);
  }
  spoil_camera(f, &camera);
  return camera;
}

/* ---- pictures */

stratus_image fuzz_image(fuzz* f, int width, int height, const stratus_camera* camera)
{
  const size_t pixels = (size_t)width * (size_t)height;
  stratus_image image = { .width = width, .height = height, .rgba = fuzz_output(f, pixels * 4 * sizeof(float)) };
  image.depth = fuzz_chance(f, 0.7) ? fuzz_output(f, pixels * sizeof(float)) : NULL;
  image.rgba8 = fuzz_chance(f, 0.4) ? fuzz_output(f, pixels * 4) : NULL;
  image.samples = fuzz_chance(f, 0.5) ? fuzz_output(f, pixels * sizeof(uint32_t)) : NULL;
  const bool bounded = isfinite(camera->far_k) && (camera->parallel || camera->near_k > 0.0);
  if ((bounded && fuzz_chance(f, 0.5)) || fuzz_odd(f)) {
    float* opaque = malloc(pixels * sizeof *opaque);
    for (size_t i = 0; opaque && i < pixels; ++i) {
      opaque[i] = (float)(fuzz_odd(f) ? fuzz_odd_real(f) : fuzz_chance(f, 0.3) ? 1.0 : fuzz_unit(f));
    }
    image.opaque_depth = fuzz_input(f, opaque, pixels * sizeof *opaque);
    free(opaque);
  }
  return image;
}

stratus_image fuzz_image_like(fuzz* f, const stratus_image* image)
{
  const size_t pixels = (size_t)image->width * (size_t)image->height;
  stratus_image other = *image;
  other.rgba = fuzz_output(f, pixels * 4 * sizeof(float));
  other.depth = image->depth ? fuzz_output(f, pixels * sizeof(float)) : NULL;
  other.rgba8 = image->rgba8 ? fuzz_output(f, pixels * 4) : NULL;
  other.samples = image->samples ? fuzz_output(f, pixels * sizeof(uint32_t)) : NULL;
  return other;
}

static void check_bytes(fuzz* f, const float pixel[4], const uint8_t bytes[4], int x, int y)
{
  for (int c = 0; c < 4; ++c) {
    const float wanted = 255.0f * fminf(pixel[c], 1.0f);
    EXPECT(fabsf((float)bytes[c] - wanted) <= 0.501f, "pixel %d, %d: byte %d is %d, its float %g", x, y, c, bytes[c], (double)pixel[c]);
  }
}

void fuzz_check_image(fuzz* f, const stratus_image* image, fuzz_limits limits)
{
  for (int i = 0; i < image->width * image->height; ++i) {
    const float* p = image->rgba + 4 * (size_t)i;
    const int x = i % image->width, y = i / image->width;
    for (int c = 0; c < 4; ++c) {
      const float most = c == 3 ? 1.0f : limits.lit ? INFINITY : p[3] * (1.0f + PREMULTIPLIED_SLACK) + PREMULTIPLIED_SLACK;
      EXPECT(isfinite(p[c]) && p[c] >= 0.0f && p[c] <= most, "pixel %d, %d is (%g, %g, %g, %g)", x, y, (double)p[0], (double)p[1],
        (double)p[2], (double)p[3]);
    }
    if (image->depth) {
      const float depth = image->depth[i];
      EXPECT(!isnan(depth) && (limits.behind || depth >= 0.0f), "pixel %d, %d has depth %g", x, y, (double)depth);
      EXPECT(!limits.surfaces || p[3] == 0.0f || depth < INFINITY, "pixel %d, %d shows %g at depth %g", x, y, (double)p[3], (double)depth);
    }
    if (image->rgba8) {
      check_bytes(f, p, image->rgba8 + 4 * (size_t)i, x, y);
    }
  }
}

void fuzz_check_same(fuzz* f, const stratus_image* a, const stratus_image* b, bool samples, const char* what)
{
  const size_t pixels = (size_t)a->width * (size_t)a->height;
  size_t differing = 0;
  int first = -1;
  for (size_t i = 0; i < pixels; ++i) {
    const bool same = memcmp(a->rgba + 4 * i, b->rgba + 4 * i, 4 * sizeof(float)) == 0 &&
      (!a->depth || memcmp(a->depth + i, b->depth + i, sizeof(float)) == 0) &&
      (!a->rgba8 || memcmp(a->rgba8 + 4 * i, b->rgba8 + 4 * i, 4) == 0) && (!samples || !a->samples || a->samples[i] == b->samples[i]);
    first = !same && first < 0 ? (int)i : first;
    differing += !same;
  }
  if (differing > 0) {
    const float *p = a->rgba + 4 * first, *q = b->rgba + 4 * first;
    fuzz_finding(f,
      "%s: %zu of %zu pixels differ, first %d, %d: (%g, %g, %g, %g) depth %g samples %u, (%g, %g, %g, %g) depth %g samples %u", what,
      differing, pixels, first % a->width, first / a->width, (double)p[0], (double)p[1], (double)p[2], (double)p[3],
      a->depth ? (double)a->depth[first] : 0.0, a->samples ? a->samples[first] : 0u, (double)q[0], (double)q[1], (double)q[2], (double)q[3],
      b->depth ? (double)b->depth[first] : 0.0, b->samples ? b->samples[first] : 0u);
  }
  ++f->tally->compared;
}
