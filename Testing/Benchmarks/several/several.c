/* SPDX-License-Identifier: BSD-3-Clause
 * stratus-bench-several [PIXELS [FRAMES]]: a picture of several volumes that overlap, compared with the sum of their single pictures, over
 * groups of scenes of record. Lines of CSV contain: median processor milliseconds of a frame, of all volumes together, of each single
 * volume with default options, and of each single volume by the rule and step that it has together; their ratios; and root mean square
 * errors over the lit pixels at a quarter of the size, against the reference in double, of the picture and of the single pictures blended
 * over one another. */
#define _POSIX_C_SOURCE 200809L
#include "reference_several.h"

#include "stratus/scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define MEMBERS 4
#define FRAMES_MOST 99

static const char* const groups[][MEMBERS] = { { "cloud", "plume" }, { "cloud", "haze" }, { "fog", "cloud" }, { "bone", "cloud" },
  { "peak", "cloud" }, { "plate", "plume" }, { "cloud", "plume", "haze", "fog" } };

typedef struct member {
  stratus_scene* scene;
  stratus_volume volume;
  stratus_transfer transfer;
  stratus_ray_cast_options options;
  stratus_ray_caster *caster, *by_default, *alike; /* of the picture, and of single pictures */
} member;

static void check(stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    fprintf(stderr, "%s: %s\n", stratus_status_name(status), stratus_context_message(context));
    exit(1);
  }
}

static double processor_ms(void)
{
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

/* A scene as a box of side 1 about the origin, turned and moved by its number so that the members of a group overlap by half. */
static void create(stratus_context* context, const char* name, int number, member* m)
{
  const double angle = 0.5 * number, c = cos(angle), s = sin(angle);
  const double turn[3][3] = { { c, -s, 0.0 }, { s, c, 0.0 }, { 0.0, 0.0, 1.0 } };
  double bounds[6], largest = 0.0;
  memset(m, 0, sizeof *m);
  check(context, stratus_scene_create(context, name, &m->scene));
  m->volume = m->scene->volume;
  m->transfer = m->scene->transfer;
  m->options = stratus_ray_cast_options_default();
  check(context, stratus_volume_bounds(context, &m->volume, bounds));
  for (int a = 0; a < 3; ++a) {
    largest = fmax(largest, bounds[2 * a + 1] - bounds[2 * a]);
  }
  for (int row = 0; row < 3; ++row) {
    m->volume.matrix[4 * row + 3] = 0.2 * number * (row == 1 ? -1.0 : 1.0);
    for (int a = 0; a < 3; ++a) {
      m->volume.matrix[4 * row + a] = turn[row][a] / largest;
      m->volume.matrix[4 * row + 3] -= turn[row][a] / largest * 0.5 * (bounds[2 * a] + bounds[2 * a + 1]);
    }
  }
  m->transfer.unit_distance /= largest;
  check(context, stratus_ray_caster_create(context, &m->caster));
  check(context, stratus_ray_caster_create(context, &m->by_default));
  check(context, stratus_ray_caster_create(context, &m->alike));
}

static void destroy(stratus_context* context, member* m)
{
  stratus_ray_caster_destroy(m->caster);
  stratus_ray_caster_destroy(m->by_default);
  stratus_ray_caster_destroy(m->alike);
  stratus_scene_destroy(context, m->scene);
}

static double together(stratus_context* context, member* m, int count, const stratus_camera* camera, int size, float* rgba,
  stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX])
{
  stratus_ray_cast_input inputs[STRATUS_SEVERAL_MAX];
  const stratus_image image = { .width = size, .height = size, .rgba = rgba };
  for (int n = 0; n < count; ++n) {
    inputs[n] =
      (stratus_ray_cast_input){ .caster = m[n].caster, .volume = &m[n].volume, .transfer = &m[n].transfer, .options = &m[n].options };
  }
  const double start = processor_ms();
  check(context, stratus_ray_caster_render_several(inputs, count, camera, &image, reports));
  return processor_ms() - start;
}

static double single(stratus_context* context, stratus_ray_caster* caster, const member* m, const stratus_ray_cast_options* options,
  const stratus_camera* camera, int size, float* rgba, uint64_t* samples)
{
  stratus_ray_cast_report report;
  const stratus_image image = { .width = size, .height = size, .rgba = rgba };
  const double start = processor_ms();
  check(context, stratus_ray_caster_render(caster, &m->volume, &m->transfer, camera, options, &image, &report));
  *samples += report.samples;
  return processor_ms() - start;
}

static int ascending(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

static double median(double* of, int count)
{
  qsort(of, (size_t)count, sizeof *of, ascending);
  return of[count / 2];
}

static double error_of(const float* rgba, const float* right, size_t pixels)
{
  double squares = 0.0, count = 0.0, largest = 0.0;
  reference_error(rgba, right, pixels, &squares, &count, &largest);
  return count > 0.0 ? sqrt(squares / count) : 0.0;
}

/* Prints the errors of the picture, and of the single pictures laid over one another, the last one in front. */
static void judge(stratus_context* context, member* m, int count, const stratus_camera* camera, int size, float* rgba)
{
  const size_t pixels = (size_t)size * (size_t)size;
  float* right = calloc(12 * pixels, sizeof *right);
  float *one = right + 4 * pixels, *over = one + 4 * pixels;
  reference_scene scenes[MEMBERS];
  uint64_t samples = 0;
  memset(scenes, 0, sizeof scenes);
  for (int n = 0; n < count; ++n) {
    scenes[n].volume = &m[n].volume;
    scenes[n].transfer = &m[n].transfer;
    scenes[n].camera = camera;
    single(context, m[n].by_default, &m[n], &m[n].options, camera, size, one, &samples);
    for (size_t at = 0; at < 4 * pixels; ++at) {
      over[at] = one[at] + (1.0f - one[at / 4 * 4 + 3]) * over[at];
    }
  }
  together(context, m, count, camera, size, rgba, NULL);
  if (reference_render_several(scenes, count, size, size, 0.015625, right, NULL) == 0) {
    printf(",%.5f,%.5f", error_of(rgba, right, pixels), error_of(over, right, pixels));
  }
  free(right);
}

static void measure(stratus_context* context, const char* const group[MEMBERS], int size, int frames, float* rgba)
{
  static double ms[3][FRAMES_MOST];
  member m[MEMBERS];
  stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX];
  stratus_camera camera;
  uint64_t samples[2] = { 0, 0 };
  const double bounds[6] = { -0.5, 0.9, -0.9, 0.5, -0.5, 0.9 };
  int count = 0;
  while (count < MEMBERS && group[count]) {
    create(context, group[count], count, &m[count]);
    printf("%s%s", count ? "+" : "", group[count]);
    ++count;
  }
  check(context, stratus_scene_camera(context, bounds, 1, 0, 0, 1.0, &camera));
  for (int frame = -4; frame < frames; ++frame) { /* the first ones build and try */
    double sums[2] = { 0.0, 0.0 };
    samples[0] = samples[1] = 0;
    const double all = together(context, m, count, &camera, size, rgba, reports);
    for (int n = 0; n < count; ++n) {
      stratus_ray_cast_options alike = m[n].options;
      if (reports[n].sampling != STRATUS_SAMPLING_LOCAL) { /* options cannot request rule local */
        alike.sampling.rule = reports[n].sampling;
        alike.sampling.distance = reports[n].sample_distance;
      }
      sums[0] += single(context, m[n].by_default, &m[n], &m[n].options, &camera, size, rgba, &samples[0]);
      sums[1] += single(context, m[n].alike, &m[n], &alike, &camera, size, rgba, &samples[1]);
    }
    for (int i = 0; i < 3 && frame >= 0; ++i) {
      ms[i][frame] = i == 0 ? all : sums[i - 1];
    }
  }
  const double of[3] = { median(ms[0], frames), median(ms[1], frames), median(ms[2], frames) };
  const double taken = (double)reports[0].samples;
  printf(",%.2f,%.2f,%.2f,%.3f,%.3f,%.3f,%.3f", of[0], of[1], of[2], of[0] / of[1], of[0] / of[2], taken / (double)samples[0],
    taken / (double)samples[1]);
  judge(context, m, count, &camera, size / 4, rgba);
  printf("\n");
  for (int n = 0; n < count; ++n) {
    printf("# %s: %s\n", group[n], reports[n].why);
    destroy(context, &m[n]);
  }
  fflush(stdout);
}

int main(int argc, char** argv)
{
  const int size = argc > 1 ? atoi(argv[1]) : 256, frames = argc > 2 ? atoi(argv[2]) : 9;
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  char message[256];
  if (size < 16 || size > 4096 || frames < 1 || frames > FRAMES_MOST) {
    fprintf(stderr, "PIXELS must be 16..4096, and FRAMES 1..%d\n", FRAMES_MOST);
    return 2;
  }
  options.device = "host";
  if (stratus_context_create(&options, &context, message, sizeof message) != STRATUS_OK) {
    fprintf(stderr, "%s\n", message);
    return 1;
  }
  float* rgba = malloc(4 * (size_t)size * (size_t)size * sizeof *rgba);
  printf("volumes,together_ms,alone_ms,alike_ms,over_alone,over_alike,samples_over_alone,samples_over_alike,error,error_laid_over\n");
  for (size_t g = 0; rgba && g < sizeof groups / sizeof *groups; ++g) {
    measure(context, groups[g], size, frames, rgba);
  }
  free(rgba);
  stratus_context_destroy(context);
  return 0;
}
