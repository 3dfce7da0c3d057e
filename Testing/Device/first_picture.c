/* SPDX-License-Identifier: BSD-3-Clause
 * stratus-first-picture DEVICE [SCENE [MODE [lit]]]: the cost of the first picture on a device, compiler and child processes included,
 * compared with the second. Prints one line of CSV. STRATUS_CACHE_DIR and POCL_CACHE_DIR name the folders of our and PoCL's program
 * caches. */
#include "stratus/ray_cast.h"
#include "stratus/scenes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#define SIDE 256

typedef struct cost {
  double wall, cpu; /* milliseconds */
} cost;

static double ms_of(struct timeval time)
{
  return 1e3 * (double)time.tv_sec + 1e-3 * (double)time.tv_usec;
}

static cost spent(void)
{
  struct rusage own, children;
  struct timespec now;
  getrusage(RUSAGE_SELF, &own);
  getrusage(RUSAGE_CHILDREN, &children);
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (cost){ 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec,
    ms_of(own.ru_utime) + ms_of(own.ru_stime) + ms_of(children.ru_utime) + ms_of(children.ru_stime) };
}

static void show(void* user, stratus_log_level level, const char* line)
{
  (void)user;
  (void)level;
  fprintf(stderr, "%s\n", line);
}

static int failed(const char* what, const char* why)
{
  fprintf(stderr, "stratus-first-picture: %s: %s\n", what, why);
  return EXIT_FAILURE;
}

static stratus_mode mode_named(const char* name)
{
  int mode = STRATUS_MODE_COMPOSITE;
  while (mode < STRATUS_MODE_ISOSURFACE && strcmp(stratus_mode_name((stratus_mode)mode), name) != 0) {
    ++mode;
  }
  return (stratus_mode)mode;
}

int main(int argc, char** argv)
{
  if (argc < 2) {
    return failed("usage", "stratus-first-picture DEVICE [SCENE [MODE [lit]]]");
  }
  static float rgba[4 * SIDE * SIDE];
  const char* name = argc > 2 ? argv[2] : "cloud";
  stratus_context_options host_options = stratus_context_options_default(), options = host_options;
  stratus_context *host = NULL, *device = NULL;
  stratus_scene* scene = NULL;
  stratus_camera camera;
  stratus_ray_caster* caster = NULL;
  stratus_ray_cast_options draw = stratus_ray_cast_options_default();
  stratus_ray_cast_report report;
  const stratus_image image = { .width = SIDE, .height = SIDE, .rgba = rgba };
  double bounds[6];
  char message[1024];
  host_options.device = "host";
  options.device = argv[1];
  options.log = show;
  draw.mode = mode_named(argc > 3 ? argv[3] : "composite");
  draw.light.shade = argc > 4;
  if (stratus_context_create(&host_options, &host, message, sizeof message) != STRATUS_OK ||
    stratus_scene_create(host, name, &scene) != STRATUS_OK || stratus_volume_bounds(host, &scene->volume, bounds) != STRATUS_OK ||
    stratus_scene_camera(host, bounds, scene->up_axis, 0, 0, 1.0, &camera) != STRATUS_OK) {
    return failed(name, host ? stratus_context_message(host) : message);
  }
  draw.optics.contour_count = 1;
  draw.optics.contours[0] = scene->transfer.opacity[2 * (scene->transfer.opacity_count / 2)];
  cost at[3];
  at[0] = spent();
  if (stratus_context_create(&options, &device, message, sizeof message) != STRATUS_OK) {
    return failed(argv[1], message);
  }
  stratus_status status = stratus_ray_caster_create(device, &caster);
  for (int picture = 1; picture <= 2 && status == STRATUS_OK; ++picture) {
    status = stratus_ray_caster_render(caster, &scene->volume, scene->transfers, &camera, &draw, &image, &report);
    at[picture] = spent();
  }
  if (status != STRATUS_OK) {
    return failed(argv[1], stratus_context_message(device));
  }
  printf("%s,%s,%s%s,%s,first picture,%.0f ms,processor,%.0f ms,second picture,%.0f ms,processor,%.0f ms\n", stratus_context_device(device),
    name, stratus_mode_name(draw.mode), draw.light.shade ? " lit" : "", stratus_sampling_name(report.sampling), at[1].wall - at[0].wall,
    at[1].cpu - at[0].cpu, at[2].wall - at[1].wall, at[2].cpu - at[1].cpu);
  stratus_ray_caster_destroy(caster);
  stratus_context_destroy(device);
  stratus_scene_destroy(host, scene);
  stratus_context_destroy(host);
  return EXIT_SUCCESS;
}
