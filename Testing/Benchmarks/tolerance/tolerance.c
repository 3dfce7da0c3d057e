/* SPDX-License-Identifier: BSD-3-Clause
 * stratus-bench-tolerance [PIXELS [SCENE...]]: the error that a report expects, next to the error that the picture has, of scenes of
 * record at four tolerances, unlit and lit. Both are root mean squares over the pixels that either picture lights. The true one is against
 * the picture at tolerance 0, which takes the finest setting.
 *
 * Prints a table of docs/measurements.md's form: the metrics expected and true_error of method stratus:auto~TOLERANCE, and `met`, 1 where
 * the report says that the tolerance is met. A lit scene is NAME+shade. */
#define _POSIX_C_SOURCE 200809L
#include "reference.h"

#include "stratus/scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char* const scenes[] = { "cloud", "plume", "fog", "haze", "peak", "voxel", "plume2", "bone", "skin", "stripes", "shell",
  "plate", "labels" };
static const double tolerances[] = { 0.0003, 0.001, 0.003, 0.0126 };

static void check(stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    fprintf(stderr, "%s: %s\n", stratus_status_name(status), stratus_context_message(context));
    exit(1);
  }
}

static void draw(stratus_context* context, const stratus_scene* scene, int shade, double tolerance, int pixels, float* rgba,
  stratus_ray_cast_report* report)
{
  const stratus_image image = { .width = pixels, .height = pixels, .rgba = rgba };
  stratus_ray_cast_options options = stratus_ray_cast_options_default();
  stratus_ray_caster* caster = NULL;
  stratus_camera camera;
  double bounds[6];
  options.light.shade = shade;
  options.sampling.tolerance = tolerance;
  check(context, stratus_ray_caster_create(context, &caster));
  check(context, stratus_volume_bounds(context, &scene->volume, bounds));
  check(context, stratus_scene_camera(context, bounds, scene->up_axis, 0, 0, 1.0, &camera));
  check(context, stratus_ray_caster_render(caster, &scene->volume, scene->transfers, &camera, &options, &image, report));
  stratus_ray_caster_destroy(caster);
}

/* Prints the errors of one scene, and to stderr the settings that were chosen. */
static void measure(stratus_context* context, const char* name, int shade, int pixels, float* rgba, float* finest)
{
  stratus_scene* scene = NULL;
  stratus_ray_cast_report report;
  check(context, stratus_scene_create(context, name, &scene));
  draw(context, scene, shade, 0.0, pixels, finest, &report);
  for (size_t t = 0; t < sizeof tolerances / sizeof *tolerances; ++t) {
    double squares = 0.0, count = 0.0, largest = 0.0;
    draw(context, scene, shade, tolerances[t], pixels, rgba, &report);
    reference_error(rgba, finest, (size_t)pixels * (size_t)pixels, &squares, &count, &largest);
    const double error = count > 0.0 ? sqrt(squares / count) : 0.0;
    const char* const lit = shade ? "+shade" : "";
    if (!isnan(report.expected_error)) {
      printf("tolerance,%s%s,stratus:auto~%g,expected,%.6g,1\n", name, lit, tolerances[t], report.expected_error);
    }
    printf("tolerance,%s%s,stratus:auto~%g,true_error,%.6g,1\n", name, lit, tolerances[t], error);
    printf("tolerance,%s%s,stratus:auto~%g,met,%d,1\n", name, lit, tolerances[t], report.tolerance_met);
    fprintf(stderr, "%s%s at %g: expected %.3g, true %.3g, ratio %.2f%s; %s\n", name, lit, tolerances[t], report.expected_error, error,
      error / report.expected_error, report.tolerance_met ? "" : ", not met", report.why);
    fflush(stdout);
  }
  stratus_scene_destroy(context, scene);
}

static void print_line_of(const char* path, const char* begin, const char* name)
{
  char line[512];
  FILE* file = fopen(path, "r");
  while (file && fgets(line, sizeof line, file)) {
    const char* colon = strstr(line, ": ");
    if (strncmp(line, begin, strlen(begin)) == 0 && colon) {
      printf("# %s,%s", name, colon + 2);
      break;
    }
  }
  if (file) {
    fclose(file);
  }
}

int main(int argc, char** argv)
{
  const int pixels = argc > 1 ? atoi(argv[1]) : 512;
  stratus_context* context = NULL;
  stratus_context_options options = stratus_context_options_default();
  char message[256], date[16] = "";
  const time_t now = time(NULL);
  if (pixels < 1 || pixels > 4096) {
    fprintf(stderr, "%s pixels a side, must be in 1..4096\n", argv[1]);
    return 2;
  }
  options.device = "host";
  if (stratus_context_create(&options, &context, message, sizeof message) != STRATUS_OK) {
    fprintf(stderr, "%s\n", message);
    return 1;
  }
  float* rgba = calloc(8 * (size_t)pixels * (size_t)pixels, sizeof *rgba);
  if (!rgba) {
    return 1;
  }
  strftime(date, sizeof date, "%Y-%m-%d", gmtime(&now));
  print_line_of("/proc/cpuinfo", "model name", "processor");
  printf("# cores,%d\n# compiler,gcc %s\n# commit,%s\n# date,%s\n# scenes", stratus_context_threads(context), __VERSION__,
    getenv("STRATUS_BENCH_COMMIT") ? getenv("STRATUS_BENCH_COMMIT") : "unknown", date);
  const int count = argc > 2 ? argc - 2 : (int)(sizeof scenes / sizeof *scenes);
  const char* const* names = argc > 2 ? (const char* const*)argv + 2 : scenes;
  for (int n = 0; n < count; ++n) {
    printf(",%s,%s+shade", names[n], names[n]);
  }
  printf("\nbenchmark,scene,method,metric,value,unit\n");
  for (int n = 0; n < count; ++n) {
    for (int shade = 0; shade < 2; ++shade) {
      measure(context, names[n], shade, pixels, rgba, rgba + 4 * (size_t)pixels * (size_t)pixels);
    }
  }
  free(rgba);
  stratus_context_destroy(context);
  return 0;
}
