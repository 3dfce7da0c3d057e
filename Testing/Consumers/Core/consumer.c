/* SPDX-License-Identifier: BSD-3-Clause
 * Draws a small picture of the scene "cloud" through the installed header and library; fails if it is empty. */
#include <stratus.h>

#include <stdio.h>

enum { SIZE = 64 };
static float rgba[4 * SIZE * SIZE];

int main(void)
{
  const stratus_image image = { .width = SIZE, .height = SIZE, .rgba = rgba };
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context;
  stratus_scene* scene = NULL;
  stratus_ray_caster* caster = NULL;
  stratus_camera camera;
  double bounds[6];
  char message[256];
  options.device = "host";
  if (stratus_context_create(&options, &context, message, sizeof message) != STRATUS_OK) {
    fprintf(stderr, "%s\n", message);
    return 1;
  }
  double alpha = 0.0;
  if (stratus_scene_create(context, "cloud", &scene) != STRATUS_OK ||
    stratus_volume_bounds(context, &scene->volume, bounds) != STRATUS_OK ||
    stratus_scene_camera(context, bounds, scene->up_axis, 0, 0, 1.0, &camera) != STRATUS_OK ||
    stratus_ray_caster_create(context, &caster) != STRATUS_OK ||
    stratus_ray_caster_render(caster, &scene->volume, &scene->transfer, &camera, NULL, &image, NULL) != STRATUS_OK) {
    fprintf(stderr, "%s\n", stratus_context_message(context));
  } else {
    for (int i = 0; i < SIZE * SIZE; ++i) {
      alpha += rgba[4 * i + 3];
    }
    printf("%s: mean alpha %g\n", stratus_context_device(context), alpha / (SIZE * SIZE));
  }
  stratus_ray_caster_destroy(caster);
  stratus_scene_destroy(context, scene);
  stratus_context_destroy(context);
  return alpha > 0.0 ? 0 : 1;
}
