/* SPDX-License-Identifier: BSD-3-Clause
 * Draws a small picture of a ball of its own through the installed header and library; fails if it is empty, or if header and library are
 * of different versions. */
#include <stratus.h>

#include <stdio.h>
#include <string.h>

enum { SIZE = 64, SIDE = 24 };
static float rgba[4 * SIZE * SIZE];
static float values[SIDE * SIDE * SIDE];

/* 1 in the middle, 0 from half the side on. */
static void fill(void)
{
  for (int i = 0; i < SIDE * SIDE * SIDE; ++i) {
    const float x = (float)(i % SIDE) - 11.5f, y = (float)(i / SIDE % SIDE) - 11.5f, z = (float)(i / SIDE / SIDE) - 11.5f;
    const float value = 1.0f - (x * x + y * y + z * z) / 144.0f;
    values[i] = value > 0.0f ? value : 0.0f;
  }
}

int main(void)
{
  const stratus_image image = { .width = SIZE, .height = SIZE, .rgba = rgba };
  const double opacity[] = { 0.0, 0.0, 1.0, 0.2 }, color[] = { 0.0, 1.0, 1.0, 1.0 };
  const double eye[] = { 80.0, 40.0, 20.0 }, focal[] = { 11.5, 11.5, 11.5 }, up[] = { 0.0, 0.0, 1.0 };
  stratus_context_options options = stratus_context_options_default();
  stratus_volume volume = stratus_volume_default();
  stratus_transfer transfer = stratus_transfer_default();
  stratus_context* context;
  stratus_ray_caster* caster = NULL;
  stratus_camera camera;
  char message[256], version[32];
  snprintf(version, sizeof version, "%d.%d.%d", STRATUS_VERSION_MAJOR, STRATUS_VERSION_MINOR, STRATUS_VERSION_PATCH);
  if (strcmp(version, stratus_version()) != 0) {
    fprintf(stderr, "header %s, library %s\n", version, stratus_version());
    return 1;
  }
  options.device = "host";
  if (stratus_context_create(&options, &context, message, sizeof message) != STRATUS_OK) {
    fprintf(stderr, "%s\n", message);
    return 1;
  }
  fill();
  volume.values = values;
  volume.type = STRATUS_FLOAT32;
  volume.dimensions[0] = volume.dimensions[1] = volume.dimensions[2] = SIDE;
  transfer.opacity = opacity;
  transfer.opacity_count = 2;
  transfer.color = color;
  transfer.color_count = 1;
  double alpha = 0.0;
  if (stratus_camera_perspective(context, eye, focal, up, 30.0, 1.0, &camera) != STRATUS_OK ||
    stratus_ray_caster_create(context, &caster) != STRATUS_OK ||
    stratus_ray_caster_render(caster, &volume, &transfer, &camera, NULL, &image, NULL) != STRATUS_OK) {
    fprintf(stderr, "%s\n", stratus_context_message(context));
  } else {
    for (int i = 0; i < SIZE * SIZE; ++i) {
      alpha += rgba[4 * i + 3];
    }
    printf("%s %s: mean alpha %g\n", stratus_version(), stratus_context_device(context), alpha / (SIZE * SIZE));
  }
  stratus_ray_caster_destroy(caster);
  stratus_context_destroy(context);
  return alpha > 0.0 ? 0 : 1;
}
