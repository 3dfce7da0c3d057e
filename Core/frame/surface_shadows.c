/* SPDX-License-Identifier: BSD-3-Clause
 * Shadows of volumes and meshes on the opaque surfaces behind their picture. Where a surface shows the colour C in full light, it shows T
 * C, where T is the part of the light that passes the matter: over it, a picture of opacity A has the effect of 1 - (1 - A) T. */
#include "camera.h"
#include "lights.h"
#include "picture.h"
#include "ray_light.h"
#include "tetra_caster.h"
#include "tiles.h"
#include "vector.h"

typedef struct scene {
  const stratus_camera* camera;
  const stratus_image* image;
  const stratus_light_maps* maps;
  stratus_light lights[STRATUS_LIGHTS_MAX];
  int count;
} scene;

/* Gives the place of the surface in a pixel. Returns whether there is one. */
static bool surface_at(const scene* s, int x, int y, double place[3])
{
  const int sides[2] = { s->image->width, s->image->height };
  double along[3];
  if (x < 0 || y < 0 || x >= sides[0] || y >= sides[1]) {
    return false;
  }
  const double depth = (double)s->image->opaque_depth[(size_t)y * (size_t)sides[0] + (size_t)x];
  stratus_camera_ray(s->camera, sides, x, y, place, along);
  const double k = stratus_camera_place(s->camera, depth);
  for (int axis = 0; axis < 3; ++axis) {
    place[axis] += s->camera->eye[axis] + k * along[axis];
  }
  return depth < 1.0;
}

/* Gives how the surface goes on from a pixel, x or y, on the side on which it changes less: on the other it may be another surface. */
static bool find_slope(const scene* s, int x, int y, int right, const double place[3], double slope[3])
{
  double least = (double)INFINITY;
  for (int side = -1; side < 2; side += 2) {
    double beside[3], square = 0.0;
    if (surface_at(s, x + (right ? side : 0), y + (right ? 0 : side), beside)) {
      for (int axis = 0; axis < 3; ++axis) {
        beside[axis] = side * (beside[axis] - place[axis]);
        square += beside[axis] * beside[axis];
      }
      if (square < least) {
        least = square;
        slope[0] = beside[0];
        slope[1] = beside[1];
        slope[2] = beside[2];
      }
    }
  }
  return isfinite(least);
}

/* The part of the light of a surface that the matter leaves it. Lights count by their brightness and the angle at which they meet it. */
static double part_of_light(const scene* s, int x, int y, const double place[3])
{
  double slopes[2][3], normal[3] = { 0.0, 0.0, 0.0 }, view[3], sum = 0.0, all = 0.0;
  if (find_slope(s, x, y, 1, place, slopes[0]) && find_slope(s, x, y, 0, place, slopes[1])) {
    stratus_vector_cross(slopes[0], slopes[1], normal);
  }
  for (int axis = 0; axis < 3; ++axis) {
    view[axis] = s->camera->parallel ? s->camera->forward[axis] : place[axis] - s->camera->eye[axis];
  }
  const double facing = stratus_vector_normalize(normal) > 0.0 ? -stratus_vector_dot(normal, view) : 0.0;
  for (int i = 0; i < s->count; ++i) {
    const stratus_light* light = &s->lights[i];
    double way[3];
    for (int axis = 0; axis < 3; ++axis) {
      way[axis] = light->vector[axis] - (light->positional ? place[axis] : 0.0);
    }
    const double distance = stratus_vector_normalize(way), cosine = stratus_vector_dot(normal, way) * (facing < 0.0 ? -1.0 : 1.0);
    double bright = (light->color[0] + light->color[1] + light->color[2]) * (facing == 0.0 ? 1.0 : fmax(cosine, 0.0));
    if (light->positional && bright > 0.0) {
      bright *= stratus_lamp_reaching(light, way, distance);
    }
    all += bright;
    sum += bright > 0.0 ? bright * stratus_light_maps_passing(s->maps, light, i, place) : 0.0;
  }
  return all > 0.0 ? sum / all : 1.0;
}

static void shade_row(const void* data, int y, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const scene* s = data;
  (void)counts;
  for (int x = 0; x < s->image->width; ++x) {
    const size_t alpha = 4 * ((size_t)y * (size_t)s->image->width + (size_t)x) + 3;
    double place[3];
    if (surface_at(s, x, y, place)) {
      const double part = part_of_light(s, x, y, place);
      s->image->rgba[alpha] = (float)(1.0 - (1.0 - (double)s->image->rgba[alpha]) * part);
      if (s->image->rgba8) {
        s->image->rgba8[alpha] = stratus_image_byte(s->image->rgba[alpha]);
      }
    }
  }
}

stratus_status stratus_ray_caster_shade_surfaces(
  const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera, const stratus_image* image)
{
  uint64_t counts[STRATUS_TILE_COUNTS];
  if (!inputs || count < 1 || !(inputs->tetra || inputs->caster)) {
    return STRATUS_INVALID_ARGUMENT;
  }
  stratus_context* context = inputs->tetra ? inputs->tetra->context : inputs->caster->context;
  const stratus_ray_cast_input* lit = stratus_ray_light_of(inputs, count);
  TRY(stratus_image_check(context, image));
  TRY(stratus_camera_check(context, camera, image));
  const stratus_shading* shading = !lit ? NULL : lit->tetra ? &lit->tetra_options->shading : &lit->options->light.shading;
  if (!shading || shading->shadow_length > 0.0 || !image->opaque_depth) {
    return STRATUS_OK;
  }
  scene s = { .camera = camera, .image = image };
  s.maps = inputs->tetra ? inputs->tetra->light.maps : inputs->caster->light.maps;
  s.count = stratus_lights_in_world(camera, shading, s.lights);
  return stratus_each_tile(context, "light", image->height, shade_row, &s, counts);
}
