/* SPDX-License-Identifier: BSD-3-Clause
 * The field that the reference renderer samples: values, the transfer function, transparent blocks, and ghosts. Its only acceleration skips
 * blocks of cells in which all values map to an opacity of 0. */
#include "reference_field.h"

#include "reference_shading.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- values and the transfer function */

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

/* The number of the last point at or below the value, of which there is one: of points of equal value, the last counts at that value. */
static size_t point_below(const double* p, size_t count, size_t width, double value)
{
  size_t i = 0;
  while (i + 1 < count && p[(i + 1) * width] <= value) {
    ++i;
  }
  return i;
}

double reference_opacity(const stratus_transfer* transfer, double value)
{
  const double* p = transfer->opacity;
  const size_t n = transfer->opacity_count;
  if (value < p[0] || value > p[2 * (n - 1)]) {
    return !transfer->clamp ? 0.0 : value < p[0] ? p[1] : p[2 * n - 1];
  }
  const double* a = p + 2 * point_below(p, n, 2, value);
  return value > a[0] ? a[1] + (value - a[0]) / (a[2] - a[0]) * (a[3] - a[1]) : a[1];
}

void reference_color(const stratus_transfer* transfer, double value, double rgb[3])
{
  const double* p = transfer->color;
  const size_t n = transfer->color_count, i = value < p[0] ? 0 : point_below(p, n, 4, value);
  const double *a = p + 4 * i, *b = value > a[0] && i + 1 < n ? a + 4 : a;
  const double t = b > a ? (value - a[0]) / (b[0] - a[0]) : 0.0;
  for (int c = 0; c < 3; ++c) {
    rgb[c] = a[1 + c] + t * (b[1 + c] - a[1 + c]);
  }
}

/* Whether the opacity is 0 on all of [lo, hi]. It is piecewise linear, so the ends and the points between them decide. */
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

/* ---- the extent of the field, and the blocks that show anything */

int64_t reference_clamp(int64_t i, int64_t n)
{
  return i < 0 ? 0 : i >= n ? n - 1 : i;
}

/* Marks the blocks in which the transfer function shows anything of the volume. */
static void find_shown_blocks(const reference_field* f, const stratus_volume* volume, const stratus_transfer* transfer)
{
  const int64_t* n = volume->dimensions;
  const int64_t count = f->blocks[0] * f->blocks[1] * f->blocks[2];
#pragma omp parallel for schedule(dynamic, 16)
  for (int64_t b = 0; b < count; ++b) {
    const int64_t at[3] = { b % f->blocks[0] * REFERENCE_BLOCK, b / f->blocks[0] % f->blocks[1] * REFERENCE_BLOCK,
      b / f->blocks[0] / f->blocks[1] * REFERENCE_BLOCK };
    double lo = (double)INFINITY;
    double hi = -(double)INFINITY;
    /* Includes one value more on each side than interpolation can read. */
    for (int64_t k = at[2] - 1; k <= at[2] + REFERENCE_BLOCK + 1; ++k) {
      for (int64_t j = at[1] - 1; j <= at[1] + REFERENCE_BLOCK + 1; ++j) {
        for (int64_t i = at[0] - 1; i <= at[0] + REFERENCE_BLOCK + 1; ++i) {
          const double value = reference_value(volume, reference_clamp(i, n[0]), reference_clamp(j, n[1]), reference_clamp(k, n[2]));
          if (isfinite(value)) {
            lo = value < lo ? value : lo;
            hi = value > hi ? value : hi;
          }
        }
      }
    }
    f->shown[b] |= (uint8_t)!transparent_on(transfer, lo, hi);
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

int reference_field_create(const reference_scene* scene, reference_field* f)
{
  const stratus_volume* v = scene->volume;
  double linear[3][3];
  *f = (reference_field){ .volume = v, .edge = (double)INFINITY };
  f->linear = scene->interpolation == STRATUS_INTERPOLATION_LINEAR;
  for (int a = 0; a < 3; ++a) {
    double squares = 0.0;
    f->corner[a] = v->matrix[4 * a + 3];
    for (int r = 0; r < 3; ++r) {
      f->corner[a] += v->matrix[4 * a + r] * v->origin[r];
      linear[r][a] = 0.0;
      for (int m = 0; m < 3; ++m) {
        linear[r][a] += v->matrix[4 * r + m] * v->direction[3 * m + a] * reference_axis_unit(v, a);
      }
      squares += linear[r][a] * linear[r][a];
    }
    f->edge = fmin(f->edge, sqrt(squares) * reference_axis_mean(v, a) / reference_axis_unit(v, a));
    f->shift[a] = v->cell_centered && !v->coordinates[a] ? -0.5 : 0.0;
    f->lo[a] = fmin(reference_axis_end(v, a, 0), reference_axis_end(v, a, 1));
    f->hi[a] = fmax(reference_axis_end(v, a, 0), reference_axis_end(v, a, 1));
    if (scene->crop && (scene->crop_regions == 0 || scene->crop_regions == STRATUS_CROP_INSIDE)) {
      f->lo[a] = fmax(f->lo[a], reference_axis_crop(v, a, scene->crop_bounds[2 * a]));
      f->hi[a] = fmin(f->hi[a], reference_axis_crop(v, a, scene->crop_bounds[2 * a + 1]));
    }
    f->blocks[a] = (v->dimensions[a] + REFERENCE_BLOCK - 1) / REFERENCE_BLOCK;
  }
  f->shown = malloc((size_t)(f->blocks[0] * f->blocks[1] * f->blocks[2]));
  if (!f->shown || !invert(linear, f->to_index)) {
    free(f->shown);
    return -1;
  }
  memset(f->shown, 0, (size_t)(f->blocks[0] * f->blocks[1] * f->blocks[2]));
  const int components = reference_components(v);
  if (scene->transfer_2d) { /* any block may show */
    memset(f->shown, 1, (size_t)(f->blocks[0] * f->blocks[1] * f->blocks[2]));
    return 0;
  }
  for (int c = scene->dependent ? components - 1 : 0; c < components; ++c) {
    const stratus_volume view = reference_component(v, c);
    find_shown_blocks(f, &view, scene->dependent ? scene->transfer : scene->transfer + c);
  }
  for (int l = 1; l <= scene->label_count; ++l) {
    find_shown_blocks(f, v, scene->transfer + l);
  }
  return 0;
}

void reference_field_release(reference_field* f)
{
  free(f->shown);
  f->shown = NULL;
}

/* ---- a sample */

/* Whether ghost flags of the cell or of the points at its corners hide it. */
static bool cell_hidden(const reference_field* f, const int64_t at[3])
{
  const stratus_volume* v = f->volume;
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
    const int64_t i = reference_clamp(at[0] + (c & 1), n[0]), j = reference_clamp(at[1] + (c >> 1 & 1), n[1]),
                  k = reference_clamp(at[2] + (c >> 2), n[2]);
    const int64_t p = (k * n[1] + j) * n[0] + i;
    if (v->cell_ghosts && v->cell_centered && f->linear && (v->cell_ghosts[p] & STRATUS_GHOST_HIDDEN_CELL)) {
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

static void load_cell(const reference_field* f, const int64_t at[3], reference_cell* c)
{
  const int64_t* n = f->volume->dimensions;
  memcpy(c->at, at, sizeof c->at);
  c->shown = !((f->volume->point_ghosts || f->volume->cell_ghosts) && cell_hidden(f, at));
  for (int k = 0; k < 8; ++k) {
    c->corner[k] = reference_value(f->volume, reference_clamp(at[0] + (k & 1), n[0]), reference_clamp(at[1] + (k >> 1 & 1), n[1]),
      reference_clamp(at[2] + (k >> 2), n[2]));
    c->shown = c->shown && (!f->linear || isfinite(c->corner[k]));
  }
}

/* For values of cells: whether the cell around p belongs to another piece or, with nearest interpolation, is hidden. */
static bool own_cell_hidden(const reference_field* f, const double p[3])
{
  const int64_t* n = f->volume->dimensions;
  const int64_t i = reference_axis_find(f->volume, 0, p[0]).nearest;
  const int64_t j = reference_axis_find(f->volume, 1, p[1]).nearest;
  const int64_t k = reference_axis_find(f->volume, 2, p[2]).nearest;
  const unsigned flags = STRATUS_GHOST_DUPLICATE | (f->linear ? 0u : STRATUS_GHOST_HIDDEN_CELL);
  return f->volume->cell_ghosts[(k * n[1] + j) * n[0] + i] & flags;
}

static double lerp(double a, double b, double t)
{
  return a + t * (b - a);
}

double reference_field_sample(const reference_field* f, const double p[3], reference_cell* c)
{
  int64_t at[3];
  double t[3];
  int nearest = 0;
  for (int a = 0; a < 3; ++a) {
    const reference_spot spot = reference_axis_find(f->volume, a, p[a]);
    at[a] = spot.cell;
    t[a] = spot.fraction;
    nearest |= (spot.nearest > spot.cell) << a;
  }
  if (at[0] != c->at[0] || at[1] != c->at[1] || at[2] != c->at[2]) {
    load_cell(f, at, c);
  }
  if (!c->shown || (f->volume->cell_ghosts && f->volume->cell_centered && own_cell_hidden(f, p))) {
    return (double)NAN;
  }
  if (!f->linear) {
    const double value = c->corner[nearest];
    return isfinite(value) ? value : (double)NAN;
  }
  const double* v = c->corner;
  const double y0 = lerp(lerp(v[0], v[1], t[0]), lerp(v[2], v[3], t[0]), t[1]);
  const double y1 = lerp(lerp(v[4], v[5], t[0]), lerp(v[6], v[7], t[0]), t[1]);
  return lerp(y0, y1, t[2]);
}
