/* SPDX-License-Identifier: BSD-3-Clause
 * The Earth beneath data on a globe. */
#include "stratus/globe.h"

#include "stratus/annotation.h"

#include "base.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Cells between points are chords of the sphere. This is the cosine of 1.4 degrees, half of a wide cell. */
#define CHORD 0.9997

static const float color[3] = { 0.30f, 0.33f, 0.36f }; /* of the sphere where it faces the eye, as of a map's land */

stratus_globe stratus_globe_default(void)
{
  return (stratus_globe){ .innermost = STRATUS_EARTH_RADIUS, .coast = 0, .ink = 0.85 };
}

static stratus_status check(stratus_context* context, const stratus_globe* globe, int width, int height)
{
  if (!(globe->innermost > 0.0) || !isfinite(globe->innermost)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "a globe beneath points at %g from its middle, must be above 0 and finite", globe->innermost);
  }
  if (width < 1 || height < 1 || width > 65536 || height > 65536) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "a picture of %dx%d pixels, each side must be 1..65536", width, height);
  }
  return STRATUS_OK;
}

stratus_status stratus_globe_end_rays(
  stratus_context* context, const stratus_globe* globe, int width, int height, stratus_camera* camera, float* depth, float* light)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!globe || !camera || !depth || !light) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "globe, camera, depth or light is NULL");
  }
  TRY(check(context, globe, width, height));
  const double radius = CHORD * globe->innermost;
  double distance = 0.0, length = 0.0;
  for (int a = 0; a < 3; ++a) {
    distance += camera->eye[a] * camera->eye[a];
    length += camera->forward[a] * camera->forward[a];
  }
  distance = sqrt(distance);
  length = sqrt(length);
  if (!isfinite(distance) || !(length > 0.0)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "a camera at %g from the middle, with a forward vector of length %g", distance, length);
  }
  camera->far_k = 2.0 * (distance + radius) / length; /* behind all data, which are within two radii */
  camera->near_k = camera->parallel ? -camera->far_k : 1e-3 * camera->far_k;
  for (int64_t pixel = 0; pixel < (int64_t)width * height; ++pixel) {
    const double u = (2.0 * (double)(pixel % width) + 1.0) / width - 1.0, v = (2.0 * (double)(pixel / width) + 1.0) / height - 1.0;
    double aa = 0.0, ab = 0.0, bb = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double aside = u * camera->right[a] + v * camera->up[a], from = camera->eye[a] + (camera->parallel ? aside : 0.0),
                   way = camera->forward[a] + (camera->parallel ? 0.0 : aside);
      aa += way * way;
      ab += way * from;
      bb += from * from;
    }
    const double root = ab * ab - aa * (bb - radius * radius);
    const double k = root > 0.0 ? (-ab - sqrt(root)) / aa : INFINITY;
    depth[pixel] = 1.0f;
    light[pixel] = 0.0f;
    if (k > camera->near_k && k < camera->far_k) {
      depth[pixel] = (float)(camera->parallel ? (k - camera->near_k) / (camera->far_k - camera->near_k)
                                              : camera->far_k * (1.0 - camera->near_k / k) / (camera->far_k - camera->near_k));
      light[pixel] = (float)(sqrt(root) / (sqrt(aa) * radius));
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_globe_draw(
  stratus_context* context, const stratus_globe* globe, const stratus_camera* camera, const float* light, const stratus_image* image)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!globe || !camera || !light || !image || !image->rgba) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "globe, camera, light, image or its rgba is NULL");
  }
  TRY(check(context, globe, image->width, image->height));
  const bool below = CHORD * globe->innermost < 0.999 * STRATUS_EARTH_RADIUS;
  const size_t pixels = (size_t)image->width * (size_t)image->height;
  void* memory;
  TRY(stratus_allocate_zero(context, pixels, 4 * sizeof(float), &memory));
  float* const sphere = memory;
  for (size_t pixel = 0; pixel < pixels; ++pixel) {
    for (size_t c = 0; light[pixel] > 0.0f && c < 4; ++c) {
      sphere[4 * pixel + c] = c < 3 ? color[c] * (0.3f + 0.7f * light[pixel]) : 1.0f;
    }
  }
  stratus_image ground = *image;
  ground.rgba = sphere;
  stratus_annotation lines = stratus_annotation_default();
  lines.coast = globe->coast;
  lines.globe = STRATUS_EARTH_RADIUS;
  lines.ink = globe->ink;
  stratus_status status = below ? STRATUS_OK : stratus_annotation_draw(context, &lines, camera, &ground, NULL, 0, NULL);
  if (status == STRATUS_OK) {
    for (size_t i = 0; i < 4 * pixels; ++i) {
      image->rgba[i] += (1.0f - image->rgba[i | 3]) * sphere[i]; /* alpha is the last of four */
    }
    status = below ? stratus_annotation_draw(context, &lines, camera, image, NULL, 0, NULL) : STRATUS_OK;
  }
  stratus_release(context, sphere);
  return status;
}
