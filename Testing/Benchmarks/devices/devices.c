/* SPDX-License-Identifier: BSD-3-Clause
 * stratus-bench-devices [PIXELS [FRAMES]]: pictures of scenes of record on the host and on each OpenCL device. Lines of CSV: milliseconds
 * of the first picture, kernels and structures included; of a frame (the median over FRAMES of the cameras of record); where it was drawn,
 * which is the host if the device refused; and in the last frame, the pixels whose bits differ from the host's and the largest difference
 * of a channel. Kernels are cached in STRATUS_CACHE_DIR: an empty folder measures the compiler, too. */
#define _POSIX_C_SOURCE 200809L
#include "stratus/ray_cast.h"
#include "stratus/scenes.h"
#include "stratus/tetrahedra.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define FRAMES_MOST 99
#define DEVICES_MOST 8

static const char* const volumes[] = { "cloud", "plume", "fog", "haze", "peak", "bone", "skin", "stripes", "shell", "archipelago-1024" };
static const char* const meshes[] = { "estuary", "wavelet" };
static const struct {
  const char* name;
  stratus_mode mode;
  int shade;
} looks[] = { { "composite", STRATUS_MODE_COMPOSITE, 0 }, { "lit", STRATUS_MODE_COMPOSITE, 1 }, { "maximum", STRATUS_MODE_MAXIMUM, 0 },
  { "first hit", STRATUS_MODE_FIRST_HIT, 0 } };

static int size, frames;
static float *rgba, *of_host;

static double now_ms(void)
{
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

static void check(stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    fprintf(stderr, "%s: %s\n", stratus_status_name(status), stratus_context_message(context));
    exit(1);
  }
}

static int ascending(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

/* A picture of a scene in one look: of a volume, or of a mesh. */
typedef struct picture {
  stratus_context* context;
  const stratus_scene* scene;
  const stratus_mesh* mesh;
  double bounds[6], range[2];
  int look;
  stratus_ray_caster* caster;
  stratus_tetra_caster* tetra_caster;
  const char* where;
} picture;

static double draw(picture* p, int frame)
{
  const stratus_image image = { .width = size, .height = size, .rgba = rgba };
  stratus_camera camera;
  check(p->context, stratus_scene_camera(p->context, p->bounds, p->scene ? p->scene->up_axis : 2, frame % 8, frame / 8 % 2, 1.0, &camera));
  const double start = now_ms();
  if (p->scene) {
    stratus_ray_cast_options options = stratus_ray_cast_options_default();
    stratus_ray_cast_report report;
    options.mode = looks[p->look].mode;
    options.light.shade = looks[p->look].shade;
    check(p->context, stratus_ray_caster_render(p->caster, &p->scene->volume, p->scene->transfers, &camera, &options, &image, &report));
    p->where = strstr(report.why, "drawn on the host") ? "host" : stratus_context_device(p->context);
  } else {
    const double opacity[] = { p->range[0], 0.02, p->range[1], 0.2 };
    const double color[] = { p->range[0], .2, .3, .9, p->range[1], .9, .4, .1 };
    stratus_transfer transfer = stratus_transfer_default();
    stratus_tetra_options options = stratus_tetra_options_default();
    stratus_tetra_report report;
    transfer.opacity = opacity;
    transfer.opacity_count = 2;
    transfer.color = color;
    transfer.color_count = 2;
    options.method = STRATUS_TETRA_METHOD_MARCH;
    options.shade = looks[p->look].shade;
    check(p->context, stratus_tetra_caster_render(p->tetra_caster, p->mesh, &transfer, &camera, &options, &image, &report));
    p->where = stratus_context_device(p->context);
  }
  return now_ms() - start;
}

/* One line: a scene in one look on one device. Keeps the host's last frame for the devices that follow. */
static void measure(stratus_context* context, const char* name, picture* p)
{
  double ms[FRAMES_MOST], largest = 0.0;
  int64_t differing = 0;
  p->context = context;
  p->caster = NULL;
  p->tetra_caster = NULL;
  check(context, p->scene ? stratus_ray_caster_create(context, &p->caster) : stratus_tetra_caster_create(context, &p->tetra_caster));
  const double first = draw(p, 0);
  for (int frame = 0; frame < frames; ++frame) {
    ms[frame] = draw(p, frame);
  }
  qsort(ms, (size_t)frames, sizeof *ms, ascending);
  const bool host = strncmp(stratus_context_device(context), "host", 4) == 0; /* "host (AVX2, 8 threads)" */
  if (host) {
    memcpy(of_host, rgba, 4 * (size_t)size * (size_t)size * sizeof *rgba);
  }
  for (int64_t i = 0; i < (int64_t)size * size; ++i) {
    differing += memcmp(rgba + 4 * i, of_host + 4 * i, 4 * sizeof *rgba) != 0;
    for (int c = 0; c < 4; ++c) {
      largest = fmax(largest, fabs((double)rgba[4 * i + c] - (double)of_host[4 * i + c]));
    }
  }
  printf("%s,%s,\"%s\",\"%s\",%.2f,%.3f,%lld,%.3g\n", name, looks[p->look].name, stratus_context_device(context), p->where, first,
    ms[frames / 2], (long long)differing, largest);
  fflush(stdout);
  stratus_ray_caster_destroy(p->caster);
  stratus_tetra_caster_destroy(p->tetra_caster);
}

int main(int argc, char** argv)
{
  stratus_context* contexts[1 + DEVICES_MOST];
  char message[1024], number[16];
  int count = 0;
  size = argc > 1 ? atoi(argv[1]) : 512;
  frames = argc > 2 ? atoi(argv[2]) : 9;
  if (size < 16 || size > 4096 || frames < 1 || frames > FRAMES_MOST) {
    fprintf(stderr, "PIXELS must be 16..4096, and FRAMES 1..%d\n", FRAMES_MOST);
    return 2;
  }
  for (int d = -1; d < stratus_device_count() && d < DEVICES_MOST; ++d) {
    stratus_context_options options = stratus_context_options_default();
    snprintf(number, sizeof number, "%d", d);
    options.device = d < 0 ? "host" : number;
    if (stratus_context_create(&options, &contexts[count], message, sizeof message) != STRATUS_OK) {
      fprintf(stderr, "%s\n", message);
      return 1;
    }
    ++count;
  }
  rgba = malloc(8 * (size_t)size * (size_t)size * sizeof *rgba);
  if (!rgba) {
    fprintf(stderr, "no memory for a picture of %d x %d\n", size, size);
    return 1;
  }
  of_host = rgba + 4 * (size_t)size * (size_t)size;
  printf("scene,look,device,drawn on,first ms,frame ms,pixels that differ,largest difference\n");
  for (size_t v = 0; v < sizeof volumes / sizeof *volumes; ++v) {
    stratus_scene* scene = NULL;
    picture p = { 0 };
    check(contexts[0], stratus_scene_create(contexts[0], volumes[v], &scene));
    check(contexts[0], stratus_volume_bounds(contexts[0], &scene->volume, p.bounds));
    p.scene = scene;
    for (p.look = 0; p.look < (int)(sizeof looks / sizeof *looks); ++p.look) {
      for (int d = 0; d < count; ++d) {
        measure(contexts[d], volumes[v], &p);
      }
    }
    stratus_scene_destroy(contexts[0], scene);
  }
  for (size_t m = 0; m < sizeof meshes / sizeof *meshes; ++m) {
    stratus_mesh_scene* scene = NULL;
    picture p = { .range = { INFINITY, -INFINITY } };
    check(contexts[0], stratus_mesh_scene_create(contexts[0], meshes[m], &scene));
    p.mesh = &scene->mesh;
    for (int i = 0; i < 6; ++i) {
      p.bounds[i] = i % 2 ? -INFINITY : INFINITY;
    }
    for (int64_t i = 0; i < 3 * scene->mesh.point_count; ++i) {
      p.bounds[2 * (i % 3)] = fmin(p.bounds[2 * (i % 3)], scene->mesh.points[i]);
      p.bounds[2 * (i % 3) + 1] = fmax(p.bounds[2 * (i % 3) + 1], scene->mesh.points[i]);
    }
    for (int64_t i = 0; i < scene->mesh.point_count; ++i) {
      const double value = (double)((const float*)scene->mesh.values)[i];
      p.range[0] = fmin(p.range[0], value);
      p.range[1] = fmax(p.range[1], value);
    }
    for (p.look = 0; p.look < 2; ++p.look) { /* composite, without light and with it */
      for (int d = 0; d < count; ++d) {
        measure(contexts[d], meshes[m], &p);
      }
    }
    stratus_mesh_scene_destroy(contexts[0], scene);
  }
  for (int d = 0; d < count; ++d) {
    stratus_context_destroy(contexts[d]);
  }
  free(rgba);
  return 0;
}
