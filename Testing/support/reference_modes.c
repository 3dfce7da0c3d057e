/* SPDX-License-Identifier: BSD-3-Clause
 * The double-precision reference for maxima, minima, means, sums, isosurfaces, crop regions and masks. */
#include "reference_modes.h"

#include "reference.h"
#include "reference_axis.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define PARTS 64 /* parts of a cell on a ray, each searched for an isosurface */
/* The renderer shrinks the bounds of values on points by this fraction of the dimension and two voxels. The reference must, too, to agree
 * on surfaces at the rim. */
#define RIM 0x1p-21
#define CUTS 8

typedef struct line {
  double origin[3], direction[3]; /* places (reference_axis.h) by world distance from the eye (parallel: from its plane) */
  double begin, end;
} line;

typedef struct scene {
  const stratus_volume* volume;
  const stratus_transfer* transfer;
  const stratus_ray_cast_options* options;
  double to_world[3][4]; /* from places */
  double low, high;      /* of all finite values; of dependent components, the first one's */
  /* Of several components, each as a volume. Dependent ones: the last is `volume`, and has the opacity. count 1: there is one. */
  stratus_volume parts[4];
  int count;
  bool dependent;
} scene;

/* ---- the field */

static bool cell_is_hidden(const stratus_volume* v, const int64_t at[3])
{
  const int64_t nx = v->dimensions[0] > 1 ? v->dimensions[0] - 1 : 1, ny = v->dimensions[1] > 1 ? v->dimensions[1] - 1 : 1;
  return v->cell_ghosts && !v->cell_centered && (v->cell_ghosts[(at[2] * ny + at[1]) * nx + at[0]] & STRATUS_GHOST_HIDDEN_CELL);
}

/* Whether crop regions and mask keep position p (places). */
static bool is_kept(const scene* s, const double p[3])
{
  const stratus_volume* v = s->volume;
  const stratus_ray_cast_options* o = s->options;
  int region = 0;
  int64_t nearest[3];
  if (!o->clipping.crop && !o->mask.bytes) {
    return true;
  }
  for (int a = 2; a >= 0; --a) {
    const double low = reference_axis_crop(v, a, o->clipping.crop_bounds[2 * a]),
                 high = reference_axis_crop(v, a, o->clipping.crop_bounds[2 * a + 1]);
    region = 3 * region + (p[a] < low ? 0 : p[a] > high ? 2 : 1);
    nearest[a] = reference_axis_find(v, a, p[a]).nearest;
  }
  return (!o->clipping.crop || (o->clipping.crop_regions >> region & 1)) &&
    (!o->mask.bytes || o->mask.bytes[(nearest[2] * v->dimensions[1] + nearest[1]) * v->dimensions[0] + nearest[0]]);
}

/* The values around the last position, which are read anew where a ray enters another cell. */
typedef struct kept_cell {
  int64_t at[3];
  double corner[8];
  bool hidden; /* a value is not finite */
} kept_cell;

#define NO_CELL                                                                                                                            \
  {                                                                                                                                        \
    .at = { -1, -1, -1 }                                                                                                                   \
  }

static void read_cell(const scene* s, const int64_t at[3], kept_cell* cell)
{
  const stratus_volume* v = s->volume;
  const int corners = s->options->sampling.interpolation == STRATUS_INTERPOLATION_NEAREST ? 1 : 8;
  memcpy(cell->at, at, sizeof cell->at);
  cell->hidden = false;
  for (int corner = 0; corner < corners; ++corner) {
    int64_t c[3];
    for (int a = 0; a < 3; ++a) {
      const int up = corner >> a & 1;
      c[a] = at[a] + up < v->dimensions[a] ? at[a] + up : at[a];
    }
    cell->corner[corner] = reference_value(v, c[0], c[1], c[2]);
    cell->hidden = cell->hidden || !isfinite(cell->corner[corner]);
  }
}

static double mix(double a, double b, double t)
{
  return a + t * (b - a);
}

/* Returns the field at p, or NAN where it is hidden. */
static double field_at(const scene* s, const double p[3], kept_cell* cell)
{
  const bool is_nearest = s->options->sampling.interpolation == STRATUS_INTERPOLATION_NEAREST;
  int64_t at[3], inside[3];
  double t[3];
  for (int a = 0; a < 3; ++a) {
    const reference_spot spot = reference_axis_find(s->volume, a, p[a]);
    inside[a] = spot.cell;
    at[a] = is_nearest ? spot.nearest : spot.cell;
    t[a] = spot.fraction;
  }
  if (at[0] != cell->at[0] || at[1] != cell->at[1] || at[2] != cell->at[2]) {
    read_cell(s, at, cell);
  }
  if (cell->hidden || cell_is_hidden(s->volume, inside) || !is_kept(s, p)) {
    return (double)NAN;
  }
  const double* v = cell->corner;
  if (is_nearest) {
    return v[0];
  }
  const double low = mix(mix(v[0], v[1], t[0]), mix(v[2], v[3], t[0]), t[1]);
  return mix(low, mix(mix(v[4], v[5], t[0]), mix(v[6], v[7], t[0]), t[1]), t[2]);
}

static double between(const double* points, size_t count, size_t width, size_t component, double x)
{
  size_t i = 0;
  if (x < points[0]) {
    return points[component];
  }
  while (i + 1 < count && points[(i + 1) * width] <= x) {
    ++i;
  }
  if (i + 1 == count) {
    return points[i * width + component];
  }
  const double *a = points + i * width, *b = a + width;
  return a[component] + (x - a[0]) / (b[0] - a[0]) * (b[component] - a[component]);
}

static void color_at(const stratus_transfer* transfer, double x, double rgba[4])
{
  const bool outside = x < transfer->opacity[0] || x > transfer->opacity[2 * (transfer->opacity_count - 1)];
  rgba[3] = outside && !transfer->clamp ? 0.0 : between(transfer->opacity, transfer->opacity_count, 2, 1, x);
  for (size_t c = 0; c < 3; ++c) {
    rgba[c] = between(transfer->color, transfer->color_count, 4, c + 1, x);
  }
}

/* The value of component c at a position. */
static double part_at(const scene* s, int c, const double p[3])
{
  scene part = *s;
  kept_cell cell = NO_CELL;
  part.volume = &s->parts[c];
  return field_at(&part, p, &cell);
}

/* Gives the colour and opacity of a value; the colour of dependent components is the others' at p. */
static void look_at(const scene* s, double value, const double p[3], double rgba[4])
{
  color_at(s->transfer, value, rgba);
  if (s->dependent && s->count == 2) {
    double color[4];
    color_at(s->transfer, part_at(s, 0, p), color);
    memcpy(rgba, color, 3 * sizeof *rgba);
  }
  for (int c = 0; s->dependent && s->count == 4 && c < 3; ++c) {
    rgba[c] = part_at(s, c, p) / 255.0;
  }
}

/* Gives what a point of several components shows: optical depths add up, and weigh the colours. Returns false where nothing shows. */
static bool mix_at(const scene* s, double value, const double p[3], double rgba[4])
{
  double depths = 0.0, squares = 0.0, light[3] = { 0.0, 0.0, 0.0 };
  if (s->count == 1 || s->dependent) {
    look_at(s, value, p, rgba);
    return !isnan(value);
  }
  for (int c = 0; c < s->count; ++c) {
    const double here = part_at(s, c, p);
    double own[4];
    color_at(s->transfer + c, here, own);
    const double depth = isnan(here) ? 0.0 : s->transfer[c].weight * fmin(-log1p(-own[3]), 1e15);
    depths += depth;
    squares += depth * depth;
    for (int i = 0; i < 3 && depth > 0.0; ++i) {
      light[i] += depth * own[i];
    }
  }
  const double depth = s->options->optics.mean_components && depths > 0.0 ? squares / depths : depths;
  rgba[3] = -expm1(-depth);
  for (int i = 0; i < 3; ++i) {
    rgba[i] = depth > 0.0 ? light[i] / depth : 0.0;
  }
  return depth > 0.0;
}

/* ---- rays */

static void set_to_world(scene* s)
{
  const stratus_volume* v = s->volume;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) {
      s->to_world[r][c] = c == 3 ? v->matrix[4 * r + 3] : 0.0;
      for (int m = 0; m < 3; ++m) {
        s->to_world[r][c] += v->matrix[4 * r + m] * (c == 3 ? v->origin[m] : v->direction[3 * m + c] * reference_axis_unit(v, c));
      }
    }
  }
  for (int c = 0; v->cell_centered && c < 3; ++c) {
    for (int r = 0; r < 3 && !v->coordinates[c]; ++r) {
      s->to_world[r][3] += 0.5 * s->to_world[r][c];
    }
  }
}

/* Solves to_world x = b by Cramer's rule. */
static void solve(const scene* s, const double b[3], double x[3])
{
  double m[4];
  for (int which = 0; which < 4; ++which) {
    double a[3][3];
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        a[r][c] = which == c ? b[r] : s->to_world[r][c];
      }
    }
    m[which] = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
      a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
  }
  for (int c = 0; c < 3; ++c) {
    x[c] = m[c] / m[3];
  }
}

static line make_line(const scene* s, const stratus_camera* camera, double u, double v)
{
  double from[3], along[3], length = 0.0;
  line l;
  for (int a = 0; a < 3; ++a) {
    const double side = u * camera->right[a] + v * camera->up[a];
    from[a] = camera->eye[a] + (camera->parallel ? side : 0.0) - s->to_world[a][3];
    along[a] = camera->forward[a] + (camera->parallel ? 0.0 : side);
    length += along[a] * along[a];
  }
  length = sqrt(length);
  for (int a = 0; a < 3; ++a) {
    along[a] /= length;
  }
  l.begin = camera->near_k * length;
  l.end = camera->far_k * length;
  solve(s, from, l.origin);
  solve(s, along, l.direction);
  for (int a = 0; a < 3; ++a) {
    const stratus_volume* volume = s->volume;
    const double unit = volume->coordinates[a] ? reference_axis_mean(volume, a) : 1.0;
    const double rim = volume->cell_centered ? 0.0 : RIM * ((double)volume->dimensions[a] + 1.0) * unit;
    const double lo = fmin(reference_axis_end(volume, a, 0), reference_axis_end(volume, a, 1)) + rim,
                 hi = fmax(reference_axis_end(volume, a, 0), reference_axis_end(volume, a, 1)) - rim;
    const double t0 = (lo - l.origin[a]) / l.direction[a], t1 = (hi - l.origin[a]) / l.direction[a];
    l.begin = fmax(l.begin, fmin(t0, t1));
    l.end = fmin(l.end, fmax(t0, t1));
  }
  return l;
}

static void point_on(const line* l, double t, double p[3])
{
  for (int a = 0; a < 3; ++a) {
    p[a] = l->origin[a] + t * l->direction[a];
  }
}

/* ---- the modes that sample */

/* Cuts a ray at the crop's planes, so that each sample's interval is on one side of each plane. Returns the number of pieces. */
static int cut_line(const scene* s, const line* l, double cut[CUTS])
{
  int count = 0;
  cut[count++] = l->begin;
  for (int side = 0; s->options->clipping.crop && side < 6; ++side) {
    const int a = side / 2;
    const double place = reference_axis_crop(s->volume, a, s->options->clipping.crop_bounds[side]);
    const double t = (place - l->origin[a]) / l->direction[a];
    int at = count;
    if (!(t > l->begin && t < l->end)) {
      continue;
    }
    for (; at > 1 && cut[at - 1] > t; --at) {
      cut[at] = cut[at - 1];
    }
    cut[at] = t;
    ++count;
  }
  cut[count] = l->end;
  return count;
}

/* Iterates over the samples of a ray. Each sample is at the middle of its interval. */
typedef struct samples {
  double cut[CUTS], step, t, length;
  int pieces, piece;
  int64_t i, count;
  kept_cell cell;
} samples;

static samples begin_samples(const scene* s, const line* l, double step)
{
  samples all = { .step = step, .piece = -1, .cell = NO_CELL };
  all.pieces = cut_line(s, l, all.cut);
  return all;
}

static bool next_sample(samples* all)
{
  while (all->i == all->count) {
    if (++all->piece == all->pieces) {
      return false;
    }
    const double extent = all->cut[all->piece + 1] - all->cut[all->piece];
    all->i = 0;
    all->count = (int64_t)ceil(extent / all->step);
    all->length = all->count > 0 ? extent / (double)all->count : 0.0;
  }
  all->t = all->cut[all->piece] + ((double)all->i++ + 0.5) * all->length;
  return true;
}

static void draw_light(const scene* s, const line* l, double step, float rgba[4], float* depth)
{
  samples all = begin_samples(s, l, step);
  double left = 1.0, sum[3] = { 0.0, 0.0, 0.0 };
  while (next_sample(&all)) {
    double p[3], color[4];
    point_on(l, all.t, p);
    const double value = field_at(s, p, &all.cell);
    if (isnan(value)) {
      continue;
    }
    color_at(s->transfer, value, color);
    const double alpha = color[3] < 1.0 ? 1.0 - pow(1.0 - color[3], all.length / s->transfer->unit_distance) : 1.0;
    for (int c = 0; c < 3; ++c) {
      sum[c] += left * alpha * color[c];
    }
    left *= 1.0 - alpha;
    *depth = alpha > 0.0 && (double)*depth > all.t ? (float)all.t : *depth;
  }
  for (int c = 0; c < 3; ++c) {
    rgba[c] = (float)sum[c];
  }
  rgba[3] = (float)(1.0 - left);
}

static void draw_extreme(const scene* s, const line* l, double step, float rgba[4], float* depth)
{
  const double sign = s->options->mode == STRATUS_MODE_MINIMUM ? -1.0 : 1.0;
  samples all = begin_samples(s, l, step);
  double best = -(double)INFINITY, at = 0.0, color[4];
  while (next_sample(&all)) {
    double p[3];
    point_on(l, all.t, p);
    const double value = sign * field_at(s, p, &all.cell);
    if (value > best) {
      best = value;
      at = all.t;
    }
  }
  if (isfinite(best)) {
    double p[3];
    point_on(l, at, p);
    look_at(s, sign * best, p, color);
    for (int c = 0; c < 4; ++c) {
      rgba[c] = (float)(color[c] * (c < 3 ? color[3] : 1.0));
    }
    *depth = color[3] > 0.0 ? (float)at : INFINITY;
  }
}

static void draw_sum(const scene* s, const line* l, double step, float rgba[4], float* depth)
{
  const bool mean = s->options->mode == STRATUS_MODE_AVERAGE;
  samples all = begin_samples(s, l, step);
  double sum = 0.0, counted = 0.0;
  while (next_sample(&all)) {
    double p[3], color[4];
    point_on(l, all.t, p);
    const double shown = field_at(s, p, &all.cell), value = s->dependent ? part_at(s, 0, p) : shown;
    if (isnan(shown) || isnan(value) ||
      (mean && !(value >= s->options->optics.average_range[0] && value <= s->options->optics.average_range[1]))) {
      continue;
    }
    color_at(s->transfer, shown, color);
    sum += s->high > s->low ? color[3] * (value - s->low) / (s->high - s->low) * all.length : 0.0;
    counted += all.length;
    *depth = color[3] > 0.0 && (double)*depth > all.t ? (float)all.t : *depth;
  }
  if (mean && counted == 0.0) {
    return;
  }
  const double grey = sum / (mean ? counted : s->transfer->unit_distance);
  rgba[0] = rgba[1] = rgba[2] = (float)fmin(grey, 1.0);
  rgba[3] = 1.0f;
}

/* ---- isosurfaces */

enum { CROSSINGS = 4096 };

typedef struct crossing {
  double t, contour;
} crossing;

static int by_distance(const void* a, const void* b)
{
  const double s = ((const crossing*)a)->t, t = ((const crossing*)b)->t;
  return s < t ? -1 : s > t;
}

static double field_on(const scene* s, const line* l, double t, kept_cell* cell)
{
  double p[3];
  point_on(l, t, p);
  return field_at(s, p, cell);
}

/* The field at the ends of a cell's parts on a ray, and where these are. */
typedef struct part_ends {
  double t[PARTS + 1], value[PARTS + 1];
} part_ends;

/* Finds where the ray crosses a contour inside one cell. before: the field where the ray left the previous cell (NAN: there is none). */
static int cross_cell(const scene* s, const line* l, const part_ends* ends, double contour, double before, kept_cell* cell, crossing* found)
{
  int count = 0;
  const double begin = ends->value[0];
  if (!isnan(before) && !isnan(begin) && (before < contour) != (begin < contour)) {
    found[count++] = (crossing){ ends->t[0], contour }; /* the contour is at the border of the cells */
  }
  for (int part = 0; part < PARTS; ++part) {
    double lo = ends->t[part], hi = ends->t[part + 1];
    const double first = ends->value[part], last = ends->value[part + 1];
    if (isnan(first) || isnan(last) || (first < contour) == (last < contour)) {
      continue;
    }
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (lo + hi);
      if ((field_on(s, l, middle, cell) < contour) == (first < contour)) {
        lo = middle;
      } else {
        hi = middle;
      }
    }
    found[count++] = (crossing){ 0.5 * (lo + hi), contour };
  }
  return count;
}

static int find_surfaces(const scene* s, const line* l, reference_layer* layers, int most)
{
  static _Thread_local crossing planes[CROSSINGS], found[CROSSINGS];
  int plane_count = 0, count = 0;
  planes[plane_count++].t = l->begin;
  planes[plane_count++].t = l->end;
  for (int a = 0; a < 3; ++a) {
    for (int64_t n = -1; n <= s->volume->dimensions[a]; ++n) {
      const bool beyond = s->volume->coordinates[a] && (n < 0 || n == s->volume->dimensions[a]); /* there are no such coordinates */
      const double t = beyond ? l->end : (reference_axis_place(s->volume, a, n) - l->origin[a]) / l->direction[a];
      if (t > l->begin && t < l->end && plane_count < CROSSINGS) {
        planes[plane_count++].t = t;
      }
    }
  }
  qsort(planes, (size_t)plane_count, sizeof *planes, by_distance);
  double before = (double)NAN;
  kept_cell cell = NO_CELL;
  for (int i = 0; i + 1 < plane_count; ++i) {
    const double hair = 1e-9 * (planes[i + 1].t - planes[i].t), from = planes[i].t + hair, to = planes[i + 1].t - hair; /* in this cell */
    part_ends ends;
    for (int part = 0; part <= PARTS; ++part) {
      ends.t[part] = from + (to - from) * part / PARTS;
      ends.value[part] = field_on(s, l, ends.t[part], &cell);
    }
    for (int n = 0; n < s->options->optics.contour_count && count < CROSSINGS - PARTS - 1; ++n) {
      count += cross_cell(s, l, &ends, s->options->optics.contours[n], before, &cell, found + count);
    }
    before = ends.value[PARTS];
  }
  qsort(found, (size_t)count, sizeof *found, by_distance);
  for (int i = 0; i < count && i < most; ++i) {
    double p[3];
    layers[i].t = found[i].t;
    point_on(l, found[i].t, p);
    look_at(s, found[i].contour, p, layers[i].color);
  }
  return count < most ? count : most;
}

/* ---- slices */

/* Returns the function whose zeros are the slice, where the line is at t. */
static double slice_at(const scene* s, const line* l, double t)
{
  const stratus_slice* slice = &s->options->slice;
  double p[3], d[3], sum = slice->constant;
  point_on(l, t, p);
  for (int r = 0; r < 3; ++r) {
    d[r] = s->to_world[r][3] - slice->center[r];
    for (int c = 0; c < 3; ++c) {
      d[r] += s->to_world[r][c] * p[c];
    }
  }
  for (int i = 0; i < 3; ++i) {
    sum += d[i] * (slice->square[i] * d[i] + slice->square[3 + i] * d[(i + 1) % 3] + slice->linear[i]);
  }
  return sum;
}

/* Finds the surface by bisection in small parts of the ray. */
static int find_slices(const scene* s, const line* l, reference_layer* layers, int most)
{
  enum { SLICE_PARTS = 4000 };
  double before = slice_at(s, l, l->begin);
  kept_cell cell = NO_CELL;
  int count = 0;
  for (int part = 0; part < SLICE_PARTS && count < most; ++part) {
    double lo = l->begin + (l->end - l->begin) * part / SLICE_PARTS, hi = l->begin + (l->end - l->begin) * (part + 1) / SLICE_PARTS;
    const double first = before;
    before = slice_at(s, l, hi);
    if ((first < 0.0) == (before < 0.0)) {
      continue;
    }
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (lo + hi);
      *((slice_at(s, l, middle) < 0.0) == (first < 0.0) ? &lo : &hi) = middle;
    }
    double p[3];
    point_on(l, lo, p);
    layers[count].t = lo;
    count += mix_at(s, field_at(s, p, &cell), p, layers[count].color);
  }
  return count;
}

/* ---- layers */

static int find_layers(const scene* s, const line* l, reference_layer* layers, int most)
{
  return (s->options->mode == STRATUS_MODE_SLICE ? find_slices : find_surfaces)(s, l, layers, most);
}

static void draw_layers(const scene* s, const line* l, float rgba[4], float* depth)
{
  static _Thread_local reference_layer layers[CROSSINGS];
  const int count = find_layers(s, l, layers, CROSSINGS);
  double left = 1.0;
  for (int i = 0; i < count; ++i) {
    const double* color = layers[i].color;
    for (int c = 0; c < 3; ++c) {
      rgba[c] += (float)(left * color[3] * color[c]);
    }
    left *= 1.0 - color[3];
    *depth = color[3] > 0.0 && isinf(*depth) ? (float)layers[i].t : *depth;
  }
  rgba[3] = (float)(1.0 - left);
}

/* ---- quantities */

/* Cuts the line where it passes cells' planes, the planes half way between them, and crop planes: in each part the field is a cubic, which
 * two places of Gauss integrate. */
static void draw_quantities(const scene* s, const line* l, float rgba[4], float* depth)
{
  enum { PLANES = 8192, PLACES = 60 };
  static _Thread_local crossing planes[PLANES];
  double cut[CUTS], integral = 0.0, length = 0.0, largest = -(double)INFINITY;
  int count = cut_line(s, l, cut) + 1, cells = 0;
  int64_t last[3] = { -1, -1, -1 };
  kept_cell cell = NO_CELL;
  for (int i = 0; i < count; ++i) {
    planes[i].t = cut[i];
  }
  for (int a = 0; a < 3; ++a) {
    for (int64_t n = 0; n < 2 * s->volume->dimensions[a] - 1; ++n) {
      const int64_t next = (n + 1) / 2 < s->volume->dimensions[a] ? (n + 1) / 2 : n / 2;
      const double place = 0.5 * (reference_axis_place(s->volume, a, n / 2) + reference_axis_place(s->volume, a, next));
      const double t = (place - l->origin[a]) / l->direction[a];
      if (t > l->begin && t < l->end && count < PLANES) {
        planes[count++].t = t;
      }
    }
  }
  qsort(planes, (size_t)count, sizeof *planes, by_distance);
  for (int i = 0; i + 1 < count; ++i) {
    const double from = planes[i].t, extent = planes[i + 1].t - from, off = 0.5 / sqrt(3.0);
    const double one = field_on(s, l, from + (0.5 - off) * extent, &cell), other = field_on(s, l, from + (0.5 + off) * extent, &cell);
    if (isnan(one) || isnan(other) || !(extent > 0.0)) {
      continue;
    }
    integral += 0.5 * (one + other) * extent;
    length += extent;
    cells += memcmp(last, cell.at, sizeof last) != 0;
    memcpy(last, cell.at, sizeof last);
    for (int place = 0; place <= PLACES; ++place) {
      const double t = from + extent * (1e-9 + (1.0 - 2e-9) * place / PLACES), value = field_on(s, l, t, &cell);
      if (value > largest) {
        largest = value;
        *depth = (float)t;
      }
    }
  }
  if (length > 0.0) {
    const double numbers[4] = { largest, integral, length, cells };
    for (int c = 0; c < 4; ++c) {
      rgba[c] = (float)numbers[c];
    }
  }
}

static line line_of(const scene* s, const stratus_camera* camera, int width, int height, int pixel)
{
  return make_line(s, camera, (2.0 * (pixel % width) + 1.0) / width - 1.0, (2.0 * (pixel / width) + 1.0) / height - 1.0);
}

static void set_scene(const stratus_volume* volume, const stratus_transfer* transfer, const stratus_ray_cast_options* options, scene* s)
{
  static const size_t sizes[] = { 1, 1, 2, 2, 4, 4, 8, 8, 4, 8 }; /* of stratus_type */
  *s = (scene){ .transfer = transfer, .options = options, .low = (double)INFINITY, .high = -(double)INFINITY };
  s->count = volume->components > 1 ? volume->components : 1;
  s->dependent = options->optics.dependent && s->count > 1;
  for (int c = 0; c < s->count; ++c) {
    s->parts[c] = *volume;
    s->parts[c].values = (const char*)volume->values + (size_t)c * sizes[volume->type];
  }
  s->volume = &s->parts[s->dependent ? s->count - 1 : 0];
  set_to_world(s);
}

void reference_modes_layers(const stratus_volume* volume, const stratus_transfer* transfer, const stratus_camera* camera,
  const stratus_ray_cast_options* options, int width, int height, int most, reference_layer* layers, int* counts)
{
  scene s;
  set_scene(volume, transfer, options, &s);
#pragma omp parallel for schedule(dynamic, 1)
  for (int pixel = 0; pixel < width * height; ++pixel) {
    const line l = line_of(&s, camera, width, height, pixel);
    counts[pixel] = l.begin < l.end ? find_layers(&s, &l, layers + (size_t)pixel * (size_t)most, most) : 0;
  }
}

void reference_modes_render(const stratus_volume* volume, const stratus_transfer* transfer, const stratus_camera* camera,
  const stratus_ray_cast_options* options, int width, int height, double step, float* rgba, float* depth)
{
  scene s;
  set_scene(volume, transfer, options, &s);
  for (int64_t k = 0; k < volume->dimensions[2]; ++k) {
    for (int64_t j = 0; j < volume->dimensions[1]; ++j) {
      for (int64_t i = 0; i < volume->dimensions[0]; ++i) {
        const double value = reference_value(&s.parts[0], i, j, k);
        s.low = isfinite(value) ? fmin(s.low, value) : s.low;
        s.high = isfinite(value) ? fmax(s.high, value) : s.high;
      }
    }
  }
#pragma omp parallel for schedule(dynamic, 1)
  for (int pixel = 0; pixel < width * height; ++pixel) {
    const line l = line_of(&s, camera, width, height, pixel);
    float *to = rgba + 4 * (size_t)pixel, *far = depth + pixel;
    memset(to, 0, 4 * sizeof *to);
    *far = INFINITY;
    if (!(l.begin < l.end)) {
      continue;
    }
    if (options->mode == STRATUS_MODE_ISOSURFACE || options->mode == STRATUS_MODE_SLICE) {
      draw_layers(&s, &l, to, far);
    } else if (options->mode == STRATUS_MODE_QUANTITIES) {
      draw_quantities(&s, &l, to, far);
    } else if (options->mode == STRATUS_MODE_MAXIMUM || options->mode == STRATUS_MODE_MINIMUM) {
      draw_extreme(&s, &l, step, to, far);
    } else if (options->mode == STRATUS_MODE_COMPOSITE) {
      draw_light(&s, &l, step, to, far);
    } else {
      draw_sum(&s, &l, step, to, far);
    }
  }
}
