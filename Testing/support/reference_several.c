/* SPDX-License-Identifier: BSD-3-Clause
 * The reference's ray through several volumes. It knows no lattice, no table and no structure: between the places where the ray enters or
 * leaves a volume it takes even steps, and at the middle of each asks every volume. */
#include "reference_several.h"

#include "reference_field.h"
#include "reference_shading.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct medium {
  const reference_scene* scene;
  reference_field field;
  reference_cell cell;
  reference_gradients gradients;
  double origin[3], direction[3]; /* of the ray, in index coordinates */
  double begin, end;
} medium;

typedef struct line {
  double origin[3], direction[3], begin, end;
} line;

static void keep_positive(double f0, double slope, double* begin, double* end)
{
  if (slope > 0.0) {
    *begin = fmax(*begin, -f0 / slope);
  } else if (slope < 0.0) {
    *end = fmin(*end, -f0 / slope);
  } else if (f0 < 0.0) {
    *end = -(double)INFINITY;
  }
}

static line line_of(const reference_scene* scene, double u, double v, const float* opaque)
{
  const stratus_camera* camera = scene->camera;
  const double n = camera->near_k, f = camera->far_k;
  line r;
  double length = 0.0, far_k = f;
  for (int a = 0; a < 3; ++a) {
    const double side = u * camera->right[a] + v * camera->up[a];
    r.origin[a] = camera->eye[a] + (camera->parallel ? side : 0.0);
    r.direction[a] = camera->forward[a] + (camera->parallel ? 0.0 : side);
    length += r.direction[a] * r.direction[a];
  }
  length = sqrt(length);
  if (opaque) {
    const double depth = (double)*opaque;
    far_k = fmin(f, camera->parallel ? n + depth * (f - n) : n * f / (f - depth * (f - n)));
  }
  r.begin = n * length;
  r.end = far_k * length;
  for (int a = 0; a < 3; ++a) {
    r.direction[a] /= length;
  }
  return r;
}

/* Finds where the line is in a volume that is drawn. */
static void meet(medium* m, const line* r)
{
  const reference_field* f = &m->field;
  m->begin = r->begin;
  m->end = r->end;
  m->cell = (reference_cell){ .at = { -1, -1, -1 } };
  memcpy(m->gradients.at, m->cell.at, sizeof m->gradients.at);
  for (int a = 0; a < 3; ++a) {
    m->origin[a] = f->shift[a];
    m->direction[a] = 0.0;
    for (int b = 0; b < 3; ++b) {
      m->origin[a] += f->to_index[a][b] * (r->origin[b] - f->corner[b]);
      m->direction[a] += f->to_index[a][b] * r->direction[b];
    }
    keep_positive(m->origin[a] - f->lo[a], m->direction[a], &m->begin, &m->end);
    keep_positive(f->hi[a] - m->origin[a], -m->direction[a], &m->begin, &m->end);
  }
  for (int i = 0; i < m->scene->clip_plane_count; ++i) {
    const double* p = m->scene->clip_planes[i];
    keep_positive(p[0] * r->origin[0] + p[1] * r->origin[1] + p[2] * r->origin[2] + p[3],
      p[0] * r->direction[0] + p[1] * r->direction[1] + p[2] * r->direction[2], &m->begin, &m->end);
  }
}

/* Adds what one volume has at s: optical depth and light per length. */
static void add_medium(medium* m, const line* r, double s, double* tau, double glow[3])
{
  reference_place place = { .gradients = &m->gradients };
  double p[3], own_tau, own_glow[3];
  memcpy(place.to_index, m->field.to_index, sizeof place.to_index);
  memcpy(place.direction, r->direction, sizeof place.direction);
  for (int a = 0; a < 3; ++a) {
    p[a] = m->origin[a] + s * m->direction[a];
    place.spot[a] = reference_axis_find(m->field.volume, a, p[a]);
    place.world[a] = r->origin[a] + s * r->direction[a];
  }
  const double value = reference_field_sample(&m->field, p, &m->cell);
  reference_shade(m->scene, &place, &value, &own_tau, own_glow);
  *tau += own_tau;
  for (int a = 0; a < 3; ++a) {
    glow[a] += own_glow[a];
  }
}

static int ascending(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

static double trace_several(medium* media, int count, const line* r, double longest, float pixel[4])
{
  double cuts[2 * REFERENCE_SEVERAL_MAX], left = 1.0, sum[3] = { 0.0, 0.0, 0.0 }, first = (double)INFINITY;
  size_t n = 0;
  for (int i = 0; i < count; ++i) {
    meet(&media[i], r);
    if (media[i].begin < media[i].end) {
      cuts[n++] = media[i].begin;
      cuts[n++] = media[i].end;
    }
  }
  qsort(cuts, n, sizeof *cuts, ascending);
  for (size_t c = 1; c < n; ++c) {
    const double length = cuts[c] - cuts[c - 1];
    const int64_t steps = (int64_t)ceil(length / longest);
    for (int64_t i = 0; i < steps && left > 1e-12; ++i) {
      const double s = cuts[c - 1] + ((double)i + 0.5) * length / (double)steps;
      double tau = 0.0, glow[3] = { 0.0, 0.0, 0.0 };
      for (int m = 0; m < count; ++m) {
        if (s > media[m].begin && s < media[m].end) {
          add_medium(&media[m], r, s, &tau, glow);
        }
      }
      if (tau > 0.0) {
        const double kept = -expm1(-tau * length / (double)steps);
        for (int a = 0; a < 3; ++a) {
          sum[a] += left * kept * glow[a] / tau;
        }
        left *= 1.0 - kept;
        first = s < first ? s : first;
      }
    }
  }
  for (int a = 0; a < 3; ++a) {
    pixel[a] = (float)sum[a];
  }
  pixel[3] = (float)(1.0 - left);
  return first;
}

int reference_render_several(const reference_scene* scenes, int count, int width, int height, double step, float* rgba, float* depth)
{
  medium media[REFERENCE_SEVERAL_MAX];
  double edge = (double)INFINITY;
  int made = 0;
  while (made < count && reference_field_create(&scenes[made], &media[made].field) == 0) {
    media[made].scene = &scenes[made];
    edge = fmin(edge, media[made].field.edge);
    ++made;
  }
  if (made == count) {
#pragma omp parallel for schedule(dynamic, 1)
    for (int y = 0; y < height; ++y) {
      medium mine[REFERENCE_SEVERAL_MAX];
      memcpy(mine, media, sizeof mine);
      for (int x = 0; x < width; ++x) {
        const size_t at = (size_t)y * (size_t)width + (size_t)x;
        const line r = line_of(&scenes[0], (2.0 * x + 1.0) / width - 1.0, (2.0 * y + 1.0) / height - 1.0,
          scenes[0].opaque_depth ? scenes[0].opaque_depth + at : NULL);
        const double first = trace_several(mine, count, &r, step * edge, rgba + 4 * at);
        if (depth) {
          depth[at] = (float)first;
        }
      }
    }
  }
  for (int i = 0; i < made; ++i) {
    reference_field_release(&media[i].field);
  }
  return made == count ? 0 : -1;
}

int reference_converged_several(
  const reference_scene* scenes, int count, int width, int height, double wanted_db, float* rgba, float* depth, double* reference_db)
{
  const size_t pixels = (size_t)width * (size_t)height;
  float* coarse = malloc(4 * pixels * sizeof *coarse);
  int result = coarse ? reference_render_several(scenes, count, width, height, 0.25, rgba, depth) : -1;
  double agreement = -(double)INFINITY;
  for (double step = 0.125; result == 0 && step >= 1.0 / 512.0 && agreement < wanted_db + 10.0; step *= 0.5) {
    memcpy(coarse, rgba, 4 * pixels * sizeof *coarse);
    result = reference_render_several(scenes, count, width, height, step, rgba, depth);
    agreement = reference_psnr(coarse, rgba, pixels);
  }
  *reference_db = agreement;
  free(coarse);
  return result;
}
