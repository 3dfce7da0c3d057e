/* SPDX-License-Identifier: BSD-3-Clause
 * The double-precision reference renderer: rays, their way through the cells, and the error between two pictures. */
#include "reference.h"

#include "reference_field.h"
#include "reference_pieces.h"
#include "reference_shading.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

typedef struct ray {
  double origin[3], direction[3];             /* world, direction of length 1 */
  double index_origin[3], index_direction[3]; /* the same line in places (reference_axis.h), with the same parameter */
  double begin, end;
} ray;

static void clip(double f0, double slope, ray* r) /* keeps f0 + slope*s >= 0 */
{
  if (slope > 0.0) {
    r->begin = fmax(r->begin, -f0 / slope);
  } else if (slope < 0.0) {
    r->end = fmin(r->end, -f0 / slope);
  } else if (f0 < 0.0) {
    r->end = -(double)INFINITY;
  }
}

static double opaque_k(const stratus_camera* camera, double depth)
{
  const double n = camera->near_k, f = camera->far_k;
  return camera->parallel ? n + depth * (f - n) : n * f / (f - depth * (f - n));
}

static ray make_ray(const reference_scene* scene, const reference_field* f, double u, double v, const float* opaque)
{
  const stratus_camera* camera = scene->camera;
  ray r;
  double length = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double side = u * camera->right[a] + v * camera->up[a];
    r.origin[a] = camera->eye[a] + (camera->parallel ? side : 0.0);
    r.direction[a] = camera->forward[a] + (camera->parallel ? 0.0 : side);
    length += r.direction[a] * r.direction[a];
  }
  length = sqrt(length);
  r.begin = camera->near_k * length;
  r.end = (opaque ? fmin(camera->far_k, opaque_k(camera, (double)*opaque)) : camera->far_k) * length;
  for (int a = 0; a < 3; ++a) {
    r.direction[a] /= length;
  }
  for (int a = 0; a < 3; ++a) {
    r.index_origin[a] = f->shift[a];
    r.index_direction[a] = 0.0;
    for (int b = 0; b < 3; ++b) {
      r.index_origin[a] += f->to_index[a][b] * (r.origin[b] - f->corner[b]);
      r.index_direction[a] += f->to_index[a][b] * r.direction[b];
    }
    clip(r.index_origin[a] - f->lo[a], r.index_direction[a], &r);
    clip(f->hi[a] - r.index_origin[a], -r.index_direction[a], &r);
  }
  for (int i = 0; i < scene->clip_plane_count; ++i) {
    const double* p = scene->clip_planes[i];
    clip(p[0] * r.origin[0] + p[1] * r.origin[1] + p[2] * r.origin[2] + p[3],
      p[0] * r.direction[0] + p[1] * r.direction[1] + p[2] * r.direction[2], &r);
  }
  return r;
}

/* Returns where the ray leaves the block around p, or a negative number if the block shows something. */
static double leave_block(const reference_field* f, const ray* r, const double p[3])
{
  int64_t b[3];
  for (int a = 0; a < 3; ++a) {
    b[a] = reference_axis_find(f->volume, a, p[a]).cell / REFERENCE_BLOCK;
  }
  if (f->shown[(b[2] * f->blocks[1] + b[1]) * f->blocks[0] + b[0]]) {
    return -1.0;
  }
  double leave = r->end;
  for (int a = 0; a < 3; ++a) {
    const double d = r->index_direction[a];
    const bool ahead = (d > 0.0) == (reference_axis_end(f->volume, a, 0) < reference_axis_end(f->volume, a, 1));
    const int64_t n = f->volume->dimensions[a], value = (b[a] + ahead) * REFERENCE_BLOCK;
    const double wall = !f->volume->coordinates[a] || value < n ? reference_axis_place(f->volume, a, value) : d > 0.0 ? f->hi[a] : f->lo[a];
    if (d != 0.0) {
      leave = fmin(leave, fmax((wall - r->index_origin[a]) / d, r->begin));
    }
  }
  return leave;
}

/* Returns the first step from number i on, at p, that may lie outside the transparent block around p. If the block shows something, it is
 * i. */
static int64_t past_block(const reference_field* f, const ray* r, const double p[3], int64_t i, double step)
{
  const double leave = leave_block(f, r, p);
  const int64_t next = leave < 0.0 ? i : (int64_t)floor((leave - r->begin) / step - 0.5);
  return leave < 0.0 || next > i ? next : i + 1;
}

/* Returns the opacity of a step, and finds its colour, with shading or several components. parts, c, gradients: one per
 * component. */
static double look(const reference_scene* scene, const reference_matter* matter, const reference_field* parts, const ray* r, double s,
  const double p[3], reference_cell* c, reference_gradients* gradients, double step, double rgb[3])
{
  const reference_field* f = parts;
  reference_place place = { .gradients = gradients, .matter = matter };
  double values[REFERENCE_COMPONENTS_MAX], tau = 0.0, glow[3];
  memcpy(place.to_index, f->to_index, sizeof place.to_index);
  memcpy(place.direction, r->direction, sizeof place.direction);
  for (int a = 0; a < 3; ++a) {
    place.spot[a] = reference_axis_find(f->volume, a, p[a]);
    place.world[a] = r->origin[a] + s * r->direction[a];
    place.at[a] = p[a];
  }
  for (int i = 0; i < reference_components(scene->volume); ++i) {
    values[i] = reference_field_sample(parts + i, p, &c[i]);
  }
  reference_shade(scene, &place, values, &tau, glow);
  for (int a = 0; a < 3; ++a) {
    rgb[a] = tau > 0.0 ? glow[a] / tau : 0.0;
  }
  return -expm1(-tau * step);
}

/* Finds where the ray crosses the next plane of an axis with coordinates, of values or of borders, beyond s and before `next`. */
static double next_coordinate(const reference_field* f, const ray* r, int axis, double s, double next)
{
  for (int64_t i = 0; r->index_direction[axis] != 0.0 && i < 2 * f->volume->dimensions[axis]; ++i) {
    const double plane = i % 2 ? reference_axis_border(f->volume, axis, i / 2) : reference_axis_place(f->volume, axis, i / 2);
    const double crossed = (plane - r->index_origin[axis]) / r->index_direction[axis];
    next = crossed > s && crossed < next ? crossed : next;
  }
  return next;
}

/* Finds where the ray crosses the next grid plane beyond s. With half, planes between the voxels count, too: there the nearest value
 * changes. */
static double next_plane(const reference_field* f, const ray* r, double s, bool half)
{
  const double planes = half ? 2.0 : 1.0;
  double next = r->end;
  for (int a = 0; a < 3; ++a) {
    const double d = r->index_direction[a];
    if (f->volume->coordinates[a]) {
      next = next_coordinate(f, r, a, s, next);
    } else if (d != 0.0) {
      /* The plane behind s may be met again by rounding; s itself must not. */
      const double at = planes * (r->index_origin[a] + s * d);
      double wall = d > 0.0 ? floor(at) + 1.0 : ceil(at) - 1.0;
      double crossed = (wall / planes - r->index_origin[a]) / d;
      if (crossed <= s) {
        wall += d > 0.0 ? 1.0 : -1.0;
        crossed = (wall / planes - r->index_origin[a]) / d;
      }
      next = fmin(next, crossed);
    }
  }
  return next;
}

/* Composites from grid plane to grid plane. */
static double trace_cells(
  const reference_scene* scene, const reference_field* f, const reference_breaks* breaks, const ray* r, double longest, float pixel[4])
{
  const bool half = !f->linear || (f->volume->cell_ghosts && f->volume->cell_centered);
  reference_light light = { .left = 1.0, .first = (double)INFINITY };
  reference_cell cell = { .at = { -1, -1, -1 } };
  for (double s = r->begin; s < r->end && light.left > 1e-12;) {
    double next = next_plane(f, r, s, half), p[3];
    for (int a = 0; a < 3; ++a) {
      p[a] = r->index_origin[a] + 0.5 * (s + next) * r->index_direction[a];
    }
    const double leave = leave_block(f, r, p);
    if (leave >= 0.0) {
      next = fmax(next, leave);
    } else {
      const reference_line line = { r->index_origin, r->index_direction, s, next };
      reference_add_line(f, scene->transfer, breaks, &line, longest, &cell, &light);
    }
    s = next;
  }
  for (int a = 0; a < 3; ++a) {
    pixel[a] = (float)light.rgb[a];
  }
  pixel[3] = (float)(1.0 - light.left);
  return light.first;
}

/* Composites in midpoint steps, with shading or several components. */
static double trace(const reference_scene* scene, const reference_matter* matter, const ray* r, float pixel[4])
{
  const reference_field* f = matter->field;
  const double longest_step = matter->longest;
  const double length = r->end - r->begin;
  const int64_t count = (int64_t)ceil(length / longest_step);
  const double step = length / (double)count;
  reference_cell c[REFERENCE_COMPONENTS_MAX];
  reference_gradients gradients[REFERENCE_COMPONENTS_MAX];
  reference_field parts[REFERENCE_COMPONENTS_MAX];
  stratus_volume views[REFERENCE_COMPONENTS_MAX];
  for (int i = 0; i < reference_components(scene->volume); ++i) {
    c[i] = (reference_cell){ .at = { -1, -1, -1 } };
    memcpy(gradients[i].at, c[i].at, sizeof gradients[i].at);
    parts[i] = *f;
    views[i] = reference_component(scene->volume, i);
    parts[i].volume = views + i;
  }
  double left = 1.0;
  double sum[3] = { 0.0, 0.0, 0.0 };
  double first = (double)INFINITY;
  for (int64_t i = 0; i < count && left > 1e-12;) {
    const double s = r->begin + ((double)i + 0.5) * step;
    double p[3];
    for (int a = 0; a < 3; ++a) {
      p[a] = r->index_origin[a] + s * r->index_direction[a];
    }
    const int64_t next = past_block(f, r, p, i, step);
    if (next > i) {
      i = next;
      continue;
    }
    ++i;
    double rgb[3];
    const double kept = look(scene, matter, parts, r, s, p, c, gradients, step, rgb);
    if (kept > 0.0) {
      for (int a = 0; a < 3; ++a) {
        sum[a] += left * kept * rgb[a];
      }
      left *= 1.0 - kept;
      first = s < first ? s : first;
    }
  }
  for (int a = 0; a < 3; ++a) {
    pixel[a] = (float)sum[a];
  }
  pixel[3] = (float)(1.0 - left);
  return first;
}

/* Whether a triangle is between a point and a light: where the plane of the triangle is met, and on which side of each edge. */
static bool triangle_hides(const double* corner, const double from[3], const double way[3], double end)
{
  double a[3], b[3], to[3], normal[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = corner[3 + i] - corner[i];
    b[i] = corner[6 + i] - corner[i];
    to[i] = corner[i] - from[i];
  }
  for (int i = 0; i < 3; ++i) {
    normal[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
  }
  const double slope = normal[0] * way[0] + normal[1] * way[1] + normal[2] * way[2];
  const double s = (normal[0] * to[0] + normal[1] * to[1] + normal[2] * to[2]) / slope;
  if (!(s > 0.0 && s < end)) {
    return false;
  }
  for (int edge = 0; edge < 3; ++edge) {
    const double *p = corner + 3 * edge, *q = corner + 3 * ((edge + 1) % 3);
    double side = 0.0;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      side += normal[i] * ((q[j] - p[j]) * (from[k] + s * way[k] - p[k]) - (q[k] - p[k]) * (from[j] + s * way[j] - p[j]));
    }
    if (side < 0.0) {
      return false;
    }
  }
  return true;
}

double reference_passing(const reference_scene* scene, const reference_matter* matter, const stratus_light* light, const double world[3])
{
  reference_scene dark = *scene;
  stratus_camera camera = { .parallel = 1 };
  float pixel[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
  for (int a = 0; a < 3; ++a) {
    camera.eye[a] = world[a];
    camera.forward[a] = light->vector[a] - (light->positional ? world[a] : 0.0);
  }
  camera.far_k = light->positional ? 1.0 : (double)INFINITY;
  const stratus_surfaces* surfaces = scene->shading->surfaces;
  for (size_t i = 0; surfaces && i < surfaces->triangle_count; ++i) {
    if (triangle_hides(surfaces->points + 9 * i, camera.eye, camera.forward, camera.far_k)) {
      return 0.0;
    }
  }
  if (scene->shading->shadow_length > 0.0) {
    const double *w = camera.forward, length = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    camera.far_k = fmin(camera.far_k, scene->shading->shadow_length / length);
  }
  dark.camera = &camera;
  dark.shading = NULL;
  dark.materials = NULL;
  dark.opaque_depth = NULL;
  const ray r = make_ray(&dark, matter->field, 0.0, 0.0, NULL);
  if (r.end > r.begin) {
    if (reference_has_shading(&dark)) {
      trace(&dark, matter, &r, pixel);
    } else {
      trace_cells(&dark, matter->field, matter->breaks, &r, matter->longest, pixel);
    }
  }
  return 1.0 - (double)pixel[3];
}

int reference_picks(int tile, int x, int y)
{
  if (tile <= 1) {
    return 1;
  }
  uint32_t hash = (uint32_t)(x / tile) * 0x9E3779B1u ^ (uint32_t)(y / tile) * 0x85EBCA77u;
  hash = (hash ^ hash >> 15) * 0x2C1B3C6Du;
  hash ^= hash >> 13;
  return (int)(hash % (uint32_t)tile) == x % tile && (int)(hash / (uint32_t)tile % (uint32_t)tile) == y % tile;
}

int reference_render(const reference_scene* scene, int width, int height, double step, float* rgba, float* depth)
{
  reference_field f;
  reference_breaks breaks;
  if (reference_field_create(scene, &f) != 0) {
    return -1;
  }
  if (reference_breaks_create(scene->transfer, &breaks) != 0) {
    reference_field_release(&f);
    return -1;
  }
  const bool shading = reference_has_shading(scene);
  const double length = step * f.edge;
  const reference_matter matter = { &f, &breaks, length };
#pragma omp parallel for schedule(dynamic, 1)
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t at = (size_t)y * (size_t)width + (size_t)x;
      const ray r = make_ray(
        scene, &f, (2.0 * x + 1.0) / width - 1.0, (2.0 * y + 1.0) / height - 1.0, scene->opaque_depth ? scene->opaque_depth + at : NULL);
      double first = (double)INFINITY;
      memset(rgba + 4 * at, 0, 4 * sizeof *rgba);
      if (r.end > r.begin && reference_picks(scene->tile, x, y)) {
        first = shading ? trace(scene, &matter, &r, rgba + 4 * at) : trace_cells(scene, &f, &breaks, &r, length, rgba + 4 * at);
      }
      if (depth) {
        depth[at] = (float)first;
      }
    }
  }
  reference_breaks_release(&breaks);
  reference_field_release(&f);
  return 0;
}

int reference_converged(
  const reference_scene* scene, int width, int height, double wanted_db, float* rgba, float* depth, double* reference_db)
{
  const size_t pixels = (size_t)width * (size_t)height;
  float* coarse = malloc(4 * pixels * sizeof *coarse);
  const double coarsest = reference_has_shading(scene) ? 0.125 : 1.0;
  int result = coarse ? reference_render(scene, width, height, coarsest, rgba, depth) : -1;
  double agreement = -(double)INFINITY;
  for (double step = 0.5 * coarsest; result == 0 && step >= 1.0 / 1024.0 && agreement < wanted_db + 10.0; step *= 0.5) {
    memcpy(coarse, rgba, 4 * pixels * sizeof *coarse);
    result = reference_render(scene, width, height, step, rgba, depth);
    agreement = reference_psnr(coarse, rgba, pixels);
  }
  if (reference_db) {
    *reference_db = agreement;
  }
  free(coarse);
  return result;
}

void reference_error(const float* a, const float* b, size_t pixels, double* squares, double* count, double* largest)
{
  for (size_t p = 0; p < pixels; ++p) {
    if (!(a[4 * p + 3] <= 0.0f) || !(b[4 * p + 3] <= 0.0f)) {
      for (size_t c = 4 * p; c < 4 * p + 4; ++c) {
        const double d = fabs((double)a[c] - (double)b[c]);
        *squares += d * d;
        *largest = d > *largest ? d : *largest;
      }
      *count += 4.0;
    }
  }
}

double reference_psnr(const float* a, const float* b, size_t pixels)
{
  double squares = 0.0;
  double count = 0.0;
  double largest = 0.0;
  reference_error(a, b, pixels, &squares, &count, &largest);
  if (!isfinite(squares)) {
    return -(double)INFINITY;
  }
  return squares > 0.0 ? -10.0 * log10(squares / count) : (double)INFINITY;
}
