/* SPDX-License-Identifier: BSD-3-Clause
 * The double-precision reference renderer. Kept slow and plain where that makes it easier to believe; the one thing it skips are blocks of
 * cells in which every value maps to an opacity of zero. */
#include "reference.h"

#include "reference_looks.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 8 /* cells along the edge of a block that is tested as a whole */

typedef struct grid {
  const stratus_volume* volume;
  double to_index[3][3]; /* inverse of the linear part of index -> world */
  double corner[3];      /* world position of the volume's origin */
  double shift;          /* index coordinate of that origin: 0, or -1/2 where values sit in cells */
  double lo[3], hi[3];   /* the box that is drawn, in index coordinates */
  double edge;           /* shortest edge of a voxel in the world */
  int64_t blocks[3];
  uint8_t* shown; /* per block */
  bool linear;
} grid;

typedef struct cell {
  int64_t at[3]; /* lower corner, -1 before the first */
  double corner[8];
  bool shown;
} cell;

double reference_value_at(const stratus_volume* volume, int64_t number)
{
  const size_t at = (size_t)(number * volume->value_stride);
  switch (volume->type) {
    case STRATUS_INT8:
      return (double)((const int8_t*)volume->values)[at];
    case STRATUS_UINT8:
      return (double)((const uint8_t*)volume->values)[at];
    case STRATUS_INT16:
      return (double)((const int16_t*)volume->values)[at];
    case STRATUS_UINT16:
      return (double)((const uint16_t*)volume->values)[at];
    case STRATUS_INT32:
      return (double)((const int32_t*)volume->values)[at];
    case STRATUS_UINT32:
      return (double)((const uint32_t*)volume->values)[at];
    case STRATUS_INT64:
      return (double)((const int64_t*)volume->values)[at];
    case STRATUS_UINT64:
      return (double)((const uint64_t*)volume->values)[at];
    case STRATUS_FLOAT32:
      return (double)((const float*)volume->values)[at];
    case STRATUS_FLOAT64:
      return ((const double*)volume->values)[at];
  }
  return (double)NAN;
}

double reference_value(const stratus_volume* volume, int64_t i, int64_t j, int64_t k)
{
  return reference_value_at(volume, (k * volume->dimensions[1] + j) * volume->dimensions[0] + i);
}

double reference_opacity(const stratus_transfer* transfer, double value)
{
  const double* p = transfer->opacity;
  const size_t n = transfer->opacity_count;
  if (value < p[0] || value > p[2 * (n - 1)]) {
    return !transfer->clamp ? 0.0 : value < p[0] ? p[1] : p[2 * n - 1];
  }
  for (size_t i = 1; i < n; ++i) {
    if (value <= p[2 * i] && p[2 * i] > p[2 * i - 2]) {
      return p[2 * i - 1] + (value - p[2 * i - 2]) / (p[2 * i] - p[2 * i - 2]) * (p[2 * i + 1] - p[2 * i - 1]);
    }
  }
  return p[2 * n - 1];
}

void reference_color(const stratus_transfer* transfer, double value, double rgb[3])
{
  const double* p = transfer->color;
  const size_t n = transfer->color_count;
  size_t i = 1;
  while (i < n && !(value <= p[4 * i] && p[4 * i] > p[4 * i - 4])) {
    ++i;
  }
  const double* b = i < n ? p + 4 * i : p + 4 * (n - 1);
  const double* a = i < n ? b - 4 : b;
  double t = b[0] > a[0] ? (value - a[0]) / (b[0] - a[0]) : 0.0;
  t = value <= p[0] ? 0.0 : t;
  a = value <= p[0] ? p : a;
  for (int c = 0; c < 3; ++c) {
    rgb[c] = a[1 + c] + t * (b[1 + c] - a[1 + c]);
  }
}

/* Is the opacity zero on the whole of [lo, hi]? It is piecewise linear: its ends and the points between decide. */
static bool transparent_on(const stratus_transfer* transfer, double lo, double hi)
{
  if (lo > hi) {
    return true;
  }
  if (reference_opacity(transfer, lo) > 0.0 || reference_opacity(transfer, hi) > 0.0) {
    return false;
  }
  for (size_t i = 0; i < transfer->opacity_count; ++i) {
    const double x = transfer->opacity[2 * i];
    if (x >= lo && x <= hi && transfer->opacity[2 * i + 1] > 0.0) {
      return false;
    }
  }
  return true;
}

static int64_t clamp_index(int64_t i, int64_t n)
{
  return i < 0 ? 0 : i >= n ? n - 1 : i;
}

/* Adds the blocks in which the transfer function shows anything of the volume. */
static void find_shown_blocks(const grid* g, const stratus_volume* volume, const stratus_transfer* transfer)
{
  const int64_t* n = volume->dimensions;
  const int64_t count = g->blocks[0] * g->blocks[1] * g->blocks[2];
#pragma omp parallel for schedule(dynamic, 16)
  for (int64_t b = 0; b < count; ++b) {
    const int64_t at[3] = { b % g->blocks[0] * BLOCK, b / g->blocks[0] % g->blocks[1] * BLOCK, b / g->blocks[0] / g->blocks[1] * BLOCK };
    double lo = (double)INFINITY;
    double hi = -(double)INFINITY;
    /* One value more on either side than any interpolation can read. */
    for (int64_t k = at[2] - 1; k <= at[2] + BLOCK + 1; ++k) {
      for (int64_t j = at[1] - 1; j <= at[1] + BLOCK + 1; ++j) {
        for (int64_t i = at[0] - 1; i <= at[0] + BLOCK + 1; ++i) {
          const double value = reference_value(volume, clamp_index(i, n[0]), clamp_index(j, n[1]), clamp_index(k, n[2]));
          if (isfinite(value)) {
            lo = value < lo ? value : lo;
            hi = value > hi ? value : hi;
          }
        }
      }
    }
    g->shown[b] |= (uint8_t)!transparent_on(transfer, lo, hi);
  }
}

static bool invert(double m[3][3], double inverse[3][3])
{
  double determinant = 0.0;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
      inverse[c][r] = m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
    }
  }
  for (int c = 0; c < 3; ++c) {
    determinant += m[0][c] * inverse[c][0];
  }
  for (int i = 0; i < 9; ++i) {
    inverse[i / 3][i % 3] /= determinant;
  }
  return isfinite(1.0 / determinant);
}

static int make_grid(const reference_scene* scene, grid* g)
{
  const stratus_volume* v = scene->volume;
  double linear[3][3];
  *g = (grid){ .volume = v, .shift = v->cell_centered ? -0.5 : 0.0, .edge = (double)INFINITY };
  g->linear = scene->interpolation == STRATUS_INTERPOLATION_LINEAR;
  for (int a = 0; a < 3; ++a) {
    double squares = 0.0;
    g->corner[a] = v->matrix[4 * a + 3];
    for (int r = 0; r < 3; ++r) {
      g->corner[a] += v->matrix[4 * a + r] * v->origin[r];
      linear[r][a] = 0.0;
      for (int m = 0; m < 3; ++m) {
        linear[r][a] += v->matrix[4 * r + m] * v->direction[3 * m + a] * v->spacing[a];
      }
      squares += linear[r][a] * linear[r][a];
    }
    g->edge = fmin(g->edge, sqrt(squares));
    g->lo[a] = g->shift;
    g->hi[a] = (double)v->dimensions[a] - 1.0 - g->shift;
    if (scene->crop) {
      g->lo[a] = fmax(g->lo[a], (scene->crop_bounds[2 * a] - v->origin[a]) / v->spacing[a] + g->shift);
      g->hi[a] = fmin(g->hi[a], (scene->crop_bounds[2 * a + 1] - v->origin[a]) / v->spacing[a] + g->shift);
    }
    g->blocks[a] = (v->dimensions[a] + BLOCK - 1) / BLOCK;
  }
  g->shown = malloc((size_t)(g->blocks[0] * g->blocks[1] * g->blocks[2]));
  if (!g->shown || !invert(linear, g->to_index)) {
    free(g->shown);
    return -1;
  }
  memset(g->shown, 0, (size_t)(g->blocks[0] * g->blocks[1] * g->blocks[2]));
  const int components = reference_components(v);
  for (int c = scene->dependent ? components - 1 : 0; c < components; ++c) {
    const stratus_volume view = reference_component(v, c);
    find_shown_blocks(g, &view, scene->dependent ? scene->transfer : scene->transfer + c);
  }
  for (int l = 1; l <= scene->label_count; ++l) {
    find_shown_blocks(g, v, scene->transfer + l);
  }
  return 0;
}

/* Flags of the cell, and of the points at its corners, that take it out of the picture. */
static bool cell_hidden(const grid* g, const int64_t at[3])
{
  const stratus_volume* v = g->volume;
  const int64_t* n = v->dimensions;
  if (v->cell_ghosts && !v->cell_centered) {
    const int64_t nx = n[0] > 1 ? n[0] - 1 : 1;
    const int64_t ny = n[1] > 1 ? n[1] - 1 : 1;
    if (v->cell_ghosts[(at[2] * ny + at[1]) * nx + at[0]] & (STRATUS_GHOST_HIDDEN_CELL | STRATUS_GHOST_DUPLICATE)) {
      return true;
    }
  }
  int duplicates = 0;
  for (int c = 0; c < 8; ++c) {
    const int64_t i = clamp_index(at[0] + (c & 1), n[0]), j = clamp_index(at[1] + (c >> 1 & 1), n[1]),
                  k = clamp_index(at[2] + (c >> 2), n[2]);
    const int64_t p = (k * n[1] + j) * n[0] + i;
    if (v->cell_ghosts && v->cell_centered && g->linear && (v->cell_ghosts[p] & STRATUS_GHOST_HIDDEN_CELL)) {
      return true;
    }
    if (v->point_ghosts && !v->cell_centered) {
      if (v->point_ghosts[p] & STRATUS_GHOST_HIDDEN_POINT) {
        return true;
      }
      duplicates += !v->cell_ghosts && (v->point_ghosts[p] & STRATUS_GHOST_DUPLICATE);
    }
  }
  return duplicates == 8;
}

static void load_cell(const grid* g, const int64_t at[3], cell* c)
{
  const int64_t* n = g->volume->dimensions;
  memcpy(c->at, at, sizeof c->at);
  c->shown = !((g->volume->point_ghosts || g->volume->cell_ghosts) && cell_hidden(g, at));
  for (int k = 0; k < 8; ++k) {
    c->corner[k] = reference_value(
      g->volume, clamp_index(at[0] + (k & 1), n[0]), clamp_index(at[1] + (k >> 1 & 1), n[1]), clamp_index(at[2] + (k >> 2), n[2]));
    c->shown = c->shown && (!g->linear || isfinite(c->corner[k]));
  }
}

/* Values in cells: is the cell around p another piece's or, where its value alone counts, hidden? */
static bool own_cell_hidden(const grid* g, const double p[3])
{
  const int64_t* n = g->volume->dimensions;
  const int64_t i = clamp_index((int64_t)floor(p[0] + 0.5), n[0]);
  const int64_t j = clamp_index((int64_t)floor(p[1] + 0.5), n[1]);
  const int64_t k = clamp_index((int64_t)floor(p[2] + 0.5), n[2]);
  const unsigned flags = STRATUS_GHOST_DUPLICATE | (g->linear ? 0u : STRATUS_GHOST_HIDDEN_CELL);
  return g->volume->cell_ghosts[(k * n[1] + j) * n[0] + i] & flags;
}

static double lerp(double a, double b, double t)
{
  return a + t * (b - a);
}

/* The value at p (index coordinates inside the box); NAN where it is transparent by rule. c remembers the last cell. */
static double sample(const grid* g, const double p[3], cell* c)
{
  const int64_t* n = g->volume->dimensions;
  int64_t at[3];
  double t[3];
  for (int a = 0; a < 3; ++a) {
    const double top = (double)(n[a] - 1);
    const double q = p[a] < 0.0 ? 0.0 : p[a] > top ? top : p[a];
    at[a] = (int64_t)q;
    at[a] = at[a] > n[a] - 2 && n[a] > 1 ? n[a] - 2 : at[a];
    t[a] = q - (double)at[a];
  }
  if (at[0] != c->at[0] || at[1] != c->at[1] || at[2] != c->at[2]) {
    load_cell(g, at, c);
  }
  if (!c->shown || (g->volume->cell_ghosts && g->volume->cell_centered && own_cell_hidden(g, p))) {
    return (double)NAN;
  }
  if (!g->linear) {
    const double value = c->corner[(t[0] >= 0.5 ? 1 : 0) + (t[1] >= 0.5 ? 2 : 0) + (t[2] >= 0.5 ? 4 : 0)];
    return isfinite(value) ? value : (double)NAN;
  }
  const double* v = c->corner;
  const double y0 = lerp(lerp(v[0], v[1], t[0]), lerp(v[2], v[3], t[0]), t[1]);
  const double y1 = lerp(lerp(v[4], v[5], t[0]), lerp(v[6], v[7], t[0]), t[1]);
  return lerp(y0, y1, t[2]);
}

typedef struct ray {
  double origin[3], direction[3];             /* world, direction of length 1 */
  double index_origin[3], index_direction[3]; /* the same line by the same parameter */
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

static ray make_ray(const reference_scene* scene, const grid* g, double u, double v, const float* opaque)
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
    r.index_origin[a] = g->shift;
    r.index_direction[a] = 0.0;
    for (int b = 0; b < 3; ++b) {
      r.index_origin[a] += g->to_index[a][b] * (r.origin[b] - g->corner[b]);
      r.index_direction[a] += g->to_index[a][b] * r.direction[b];
    }
    clip(r.index_origin[a] - g->lo[a], r.index_direction[a], &r);
    clip(g->hi[a] - r.index_origin[a], -r.index_direction[a], &r);
  }
  for (int i = 0; i < scene->clip_plane_count; ++i) {
    const double* p = scene->clip_planes[i];
    clip(p[0] * r.origin[0] + p[1] * r.origin[1] + p[2] * r.origin[2] + p[3],
      p[0] * r.direction[0] + p[1] * r.direction[1] + p[2] * r.direction[2], &r);
  }
  return r;
}

/* Steps from number i, at p, to the first that may lie outside the transparent block around p; i itself where the block shows something. */
static int64_t past_block(const grid* g, const ray* r, const double p[3], int64_t i, double step)
{
  int64_t b[3];
  for (int a = 0; a < 3; ++a) {
    b[a] = clamp_index((int64_t)floor(p[a] / BLOCK), g->blocks[a]);
  }
  if (g->shown[(b[2] * g->blocks[1] + b[1]) * g->blocks[0] + b[0]]) {
    return i;
  }
  double leave = r->end;
  for (int a = 0; a < 3; ++a) {
    const double d = r->index_direction[a];
    const double wall = (double)((b[a] + (d > 0.0)) * BLOCK);
    if (d != 0.0) {
      leave = fmin(leave, fmax((wall - r->index_origin[a]) / d, r->begin));
    }
  }
  const int64_t next = (int64_t)floor((leave - r->begin) / step - 0.5);
  return next > i ? next : i + 1;
}

/* Opacity of a step, and its colour, where a sample is more than one value's colour and opacity. */
static double look(
  const reference_scene* scene, const grid* g, const ray* r, double s, const double p[3], cell* c, double step, double rgb[3])
{
  reference_place place;
  double values[REFERENCE_COMPONENTS_MAX], tau = 0.0, glow[3];
  memcpy(place.to_index, g->to_index, sizeof place.to_index);
  memcpy(place.direction, r->direction, sizeof place.direction);
  for (int a = 0; a < 3; ++a) {
    place.index[a] = fmin(fmax(p[a], 0.0), (double)(g->volume->dimensions[a] - 1));
    place.world[a] = r->origin[a] + s * r->direction[a];
  }
  for (int i = 0; i < reference_components(scene->volume); ++i) {
    const stratus_volume view = reference_component(scene->volume, i);
    grid part = *g;
    part.volume = &view;
    values[i] = sample(&part, p, &c[i]);
  }
  reference_look(scene, &place, values, &tau, glow);
  for (int a = 0; a < 3; ++a) {
    rgb[a] = tau > 0.0 ? glow[a] / tau : 0.0;
  }
  return -expm1(-tau * step);
}

static double trace(const reference_scene* scene, const grid* g, const ray* r, double longest_step, float pixel[4])
{
  const double length = r->end - r->begin;
  const int64_t count = (int64_t)ceil(length / longest_step);
  const double step = length / (double)count;
  const double share = step / scene->transfer->unit_distance;
  const bool looks = reference_has_looks(scene);
  cell c[REFERENCE_COMPONENTS_MAX];
  for (int i = 0; i < REFERENCE_COMPONENTS_MAX; ++i) {
    c[i] = (cell){ .at = { -1, -1, -1 } };
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
    const int64_t next = past_block(g, r, p, i, step);
    if (next > i) {
      i = next;
      continue;
    }
    ++i;
    double kept = 0.0, rgb[3] = { 0.0, 0.0, 0.0 };
    if (looks) {
      kept = look(scene, g, r, s, p, c, step, rgb);
    } else {
      const double value = sample(g, p, c), opacity = isnan(value) ? 0.0 : reference_opacity(scene->transfer, value);
      kept = opacity < 1.0 ? -expm1(share * log1p(-opacity)) : 1.0;
      if (opacity > 0.0) {
        reference_color(scene->transfer, value, rgb);
      }
    }
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

int reference_render(const reference_scene* scene, int width, int height, double step, float* rgba, float* depth)
{
  grid g;
  if (make_grid(scene, &g) != 0) {
    return -1;
  }
  const double length = step * g.edge;
#pragma omp parallel for schedule(dynamic, 1)
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t at = (size_t)y * (size_t)width + (size_t)x;
      const ray r = make_ray(
        scene, &g, (2.0 * x + 1.0) / width - 1.0, (2.0 * y + 1.0) / height - 1.0, scene->opaque_depth ? scene->opaque_depth + at : NULL);
      double first = (double)INFINITY;
      memset(rgba + 4 * at, 0, 4 * sizeof *rgba);
      if (r.end > r.begin) {
        first = trace(scene, &g, &r, length, rgba + 4 * at);
      }
      if (depth) {
        depth[at] = (float)first;
      }
    }
  }
  free(g.shown);
  return 0;
}

int reference_converged(
  const reference_scene* scene, int width, int height, double wanted_db, float* rgba, float* depth, double* reference_db)
{
  const size_t pixels = (size_t)width * (size_t)height;
  float* coarse = malloc(4 * pixels * sizeof *coarse);
  int result = coarse ? reference_render(scene, width, height, 0.125, rgba, depth) : -1;
  double agreement = -(double)INFINITY;
  for (double step = 0.0625; result == 0 && step >= 1.0 / 1024.0 && agreement < wanted_db + 10.0; step *= 0.5) {
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
