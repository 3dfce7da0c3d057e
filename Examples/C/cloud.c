/* SPDX-License-Identifier: BSD-3-Clause
 * Draws the scene "cloud" with only the core: cloud [OUT.png] */
#include <stratus.h>

#include <stdio.h>
#include <stdlib.h>

enum { SIZE = 512 };

int main(int argc, char** argv)
{
  const char* path = argc > 1 ? argv[1] : "cloud.png";
  stratus_context* context;
  stratus_scene* scene = NULL;
  stratus_ray_caster* caster = NULL;
  stratus_camera camera;
  stratus_ray_cast_report report;
  double bounds[6];
  char message[256];
  if (stratus_context_create(NULL, &context, message, sizeof message) != STRATUS_OK) {
    fprintf(stderr, "cloud: %s\n", message);
    return EXIT_FAILURE;
  }
  float* rgba = malloc(4 * sizeof(float) * SIZE * SIZE);
  const stratus_image image = { .width = SIZE, .height = SIZE, .rgba = rgba };
  const int drawn = rgba && stratus_scene_create(context, "cloud", &scene) == STRATUS_OK &&
    stratus_volume_bounds(context, &scene->volume, bounds) == STRATUS_OK &&
    stratus_scene_camera(context, bounds, scene->up_axis, 0, 0, 1.0, &camera) == STRATUS_OK &&
    stratus_ray_caster_create(context, &caster) == STRATUS_OK &&
    stratus_ray_caster_render(caster, &scene->volume, &scene->transfer, &camera, NULL, &image, &report) == STRATUS_OK;
  const double dark_grey[3] = { 0.1, 0.1, 0.1 };
  const int written = drawn && stratus_image_write(context, &image, dark_grey, path) == STRATUS_OK;
  if (written) {
    printf("%s: %.1f ms on %s\n", path, report.cast_ms, stratus_context_device(context));
  } else {
    fprintf(stderr, "cloud: %s\n", rgba ? stratus_context_message(context) : "out of memory");
  }
  stratus_ray_caster_destroy(caster);
  stratus_scene_destroy(context, scene);
  stratus_context_destroy(context);
  free(rgba);
  return written ? EXIT_SUCCESS : EXIT_FAILURE;
}
