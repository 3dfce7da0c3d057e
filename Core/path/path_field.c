/* SPDX-License-Identifier: BSD-3-Clause
 * The extinction at a place, in double: trilinear interpolation, the transfer function's own points, hidden parts, and the largest
 * extinction of each block. It shares no code with the ray caster, which is compared with it. */
#include "path.h"
#include "vector.h"

#include <float.h>
#include <string.h>

#define BLOCK_SIZE_DEFAULT 4
/* Extinction of opacity 1 instead of infinity, per unit distance and per shortest edge of a voxel. Any other opacity has an extinction of
 * at most 37 per unit distance. */
#define OPAQUE_PER_UNIT 64.0
#define OPAQUE_PER_EDGE 256.0
/* Largest extinction per shortest edge: delta tracking needs as many steps through an edge. */
#define MOST_PER_EDGE 4096.0
/* Edges shorter than this part of the longest one count as that part. */
#define SHORT_EDGE 0x1p-20
/* Rounding of interpolation beyond the values that it is between, relative to the largest of them. */
#define HULL_SLACK 1e-12

/* ---- places */

double stratus_path_value_place(const stratus_path_field* f, int axis, int64_t i)
{
  const double* x = f->volume->coordinates[axis];
  return !x ? (double)i : f->sign[axis] * (f->volume->cell_centered ? 0.5 * (x[i] + x[i + 1]) : x[i]);
}

static void set_axis(stratus_path_field* f, int axis)
{
  const stratus_volume* v = f->volume;
  const double* x = v->coordinates[axis];
  const int64_t n = v->dimensions[axis], last = n - (v->cell_centered ? 0 : 1);
  f->sign[axis] = x && x[last] < x[0] ? -1.0 : 1.0;
  f->lo[axis] = x ? f->sign[axis] * x[0] : v->cell_centered ? -0.5 : 0.0;
  f->hi[axis] = x ? f->sign[axis] * x[last] : v->cell_centered ? (double)n - 0.5 : (double)(n - 1);
  f->cells[axis] = n > 1 ? n - 1 : 1;
  f->blocks[axis] = (f->cells[axis] + f->block_size - 1) / f->block_size;
}

/* Sets the matrices, and returns the shortest edge of a voxel, at least SHORT_EDGE of the longest one. */
static double set_matrices(stratus_path_field* f)
{
  const stratus_volume* v = f->volume;
  double local[4][3], inverse[16], shortest = (double)INFINITY, longest = 0.0; /* local: the axes and the origin, before the matrix */
  memcpy(local[3], v->origin, sizeof local[3]);
  for (int a = 0; a < 3; ++a) {
    const double unit = v->coordinates[a] ? f->sign[a] : v->spacing[a];
    for (int r = 0; r < 3; ++r) {
      local[a][r] = v->direction[3 * r + a] * unit;
      local[3][r] += v->cell_centered && !v->coordinates[a] ? 0.5 * local[a][r] : 0.0;
    }
  }
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) {
      f->to_world[4 * r + c] = r == 3 ? (double)(c == 3) : c == 3 ? v->matrix[4 * r + 3] : 0.0;
      for (int i = 0; r < 3 && i < 3; ++i) {
        f->to_world[4 * r + c] += v->matrix[4 * r + i] * local[c][i];
      }
    }
  }
  (void)stratus_matrix_invert_affine(f->to_world, inverse); /* the volume's check has done so, too */
  for (int a = 0; a < 3; ++a) {
    double side[3] = { f->to_world[a], f->to_world[4 + a], f->to_world[8 + a] };
    const double edge = stratus_vector_normalize(side); /* whose squares do not overflow */
    memcpy(f->to_place + 3 * a, inverse + 4 * a, 3 * sizeof(double));
    double gap = 1.0;
    for (int64_t i = 0; v->coordinates[a] && i < v->dimensions[a] - (v->cell_centered ? 0 : 1); ++i) {
      gap = i == 0 ? (double)INFINITY : gap;
      gap = fmin(gap, fabs(v->coordinates[a][i + 1] - v->coordinates[a][i]));
    }
    shortest = stratus_volume_extends(v, a) ? fmin(shortest, edge * gap) : shortest;
    longest = stratus_volume_extends(v, a) ? fmax(longest, edge * gap) : longest;
  }
  return longest > 0.0 ? fmax(shortest, SHORT_EDGE * longest) : 1.0;
}

/* Sets what clip planes and crop regions show. */
static void set_clipping(stratus_path_field* f, const stratus_ray_clipping_options* clipping)
{
  const stratus_volume* v = f->volume;
  f->plane_count = clipping->clip_plane_count;
  for (int i = 0; i < f->plane_count; ++i) {
    const double* plane = clipping->clip_planes[i];
    for (int c = 0; c < 4; ++c) {
      f->planes[i][c] = c == 3 ? plane[3] : 0.0;
      for (int r = 0; r < 3; ++r) {
        f->planes[i][c] += plane[r] * f->to_world[4 * r + c];
      }
    }
  }
  f->regions = clipping->crop ? 0 : STRATUS_CROP_ALL;
  if (!clipping->crop) {
    return;
  }
  for (int region = 0; region < 27; ++region) {
    const int at[3] = { region % 3, region / 3 % 3, region / 9 };
    int by_place = 0;
    for (int a = 2; a >= 0; --a) {
      by_place = 3 * by_place + (f->sign[a] < 0.0 ? 2 - at[a] : at[a]);
    }
    f->regions |= (clipping->crop_regions >> region & 1u) << by_place;
  }
  for (int a = 0; a < 3; ++a) {
    for (int side = 0; side < 2; ++side) {
      const double from = clipping->crop_bounds[2 * a + side] - v->origin[a];
      f->crop[a][f->sign[a] < 0.0 ? 1 - side : side] =
        v->coordinates[a] ? f->sign[a] * from : from / v->spacing[a] - (v->cell_centered ? 0.5 : 0.0);
    }
    if (f->regions == STRATUS_CROP_INSIDE) {
      f->lo[a] = fmax(f->lo[a], f->crop[a][0]);
      f->hi[a] = fmin(f->hi[a], f->crop[a][1]);
    }
  }
}

void stratus_path_field_set(
  stratus_path_field* f, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_path_options* options)
{
  f->volume = volume;
  f->transfer = transfer;
  f->mask = options->mask.bytes;
  f->linear = options->interpolation == STRATUS_INTERPOLATION_LINEAR;
  f->block_size = options->block_size ? options->block_size : BLOCK_SIZE_DEFAULT;
  f->bias = stratus_volume_bias(volume);
  for (int axis = 0; axis < 3; ++axis) {
    set_axis(f, axis);
  }
  const double edge = set_matrices(f);
  f->opaque = fmin(fmax(OPAQUE_PER_UNIT / transfer->unit_distance, OPAQUE_PER_EDGE / edge), MOST_PER_EDGE / edge);
  set_clipping(f, &options->clipping);
}

void stratus_path_turn_to_place(const stratus_path_field* f, const double world[3], double place[3])
{
  for (int r = 0; r < 3; ++r) {
    place[r] = f->to_place[3 * r] * world[0] + f->to_place[3 * r + 1] * world[1] + f->to_place[3 * r + 2] * world[2];
  }
}

void stratus_path_to_place(const stratus_path_field* f, const double world[3], double place[3])
{
  const double from[3] = { world[0] - f->to_world[3], world[1] - f->to_world[7], world[2] - f->to_world[11] };
  stratus_path_turn_to_place(f, from, place);
}

void stratus_path_turn_to_world(const stratus_path_field* f, const double place[3], double world[3])
{
  stratus_matrix_vector(f->to_world, place, world);
}

int64_t stratus_path_cell(const stratus_path_field* f, int axis, int64_t first, int64_t last, double place)
{
  if (!f->volume->coordinates[axis]) {
    return !(place > (double)first) ? first : place >= (double)last ? last : (int64_t)place;
  }
  while (first < last) {
    const int64_t middle = (first + last + 1) / 2;
    if (stratus_path_value_place(f, axis, middle) <= place) {
      first = middle;
    } else {
      last = middle - 1;
    }
  }
  return first;
}

/* ---- the transfer function */

/* Returns the last point with a value of at most x, or -1. Of points of equal value, the last counts at that value. */
static ptrdiff_t point_below(const double* points, size_t count, size_t width, double x)
{
  size_t lo = 0, hi = count;
  while (lo < hi) {
    const size_t middle = (lo + hi) / 2;
    if (points[middle * width] <= x) {
      lo = middle + 1;
    } else {
      hi = middle;
    }
  }
  return (ptrdiff_t)lo - 1;
}

/* Returns where x is between the points i and i + 1, 0..1; 0 beyond the last point, and below the first. */
static double part_of(const double* points, size_t count, size_t width, ptrdiff_t i, double x)
{
  if (i < 0 || (size_t)i + 1 >= count) {
    return 0.0;
  }
  const double a = points[(size_t)i * width], b = points[((size_t)i + 1) * width];
  return (0.5 * x - 0.5 * a) / (0.5 * b - 0.5 * a); /* differences of halves do not overflow */
}

static double opacity_at(const stratus_transfer* t, double x)
{
  const double* points = t->opacity;
  const size_t n = t->opacity_count;
  if (!t->clamp && (x < points[0] || x > points[2 * (n - 1)])) {
    return 0.0;
  }
  const ptrdiff_t i = point_below(points, n, 2, x);
  const double part = part_of(points, n, 2, i, x), *p = points + 2 * (i < 0 ? 0 : i);
  return part > 0.0 ? p[1] + part * (p[3] - p[1]) : p[1];
}

void stratus_path_color(const stratus_path_field* f, double value, double rgb[3])
{
  const double* points = f->transfer->color;
  const size_t n = f->transfer->color_count;
  const ptrdiff_t i = point_below(points, n, 4, value);
  const double part = part_of(points, n, 4, i, value), *p = points + 4 * (i < 0 ? 0 : i);
  for (int c = 1; c < 4; ++c) {
    rgb[c - 1] = part > 0.0 ? p[c] + part * (p[c + 4] - p[c]) : p[c];
  }
}

/* Returns the extinction, which rises with the opacity. */
static double extinction_of(const stratus_path_field* f, double opacity)
{
  return opacity >= 1.0 ? f->opaque : fmin(-log1p(-opacity) / f->transfer->unit_distance, f->opaque);
}

double stratus_path_extinction(const stratus_path_field* f, double value)
{
  return extinction_of(f, opacity_at(f->transfer, value));
}

/* Returns the largest extinction of values lo..hi. */
static double largest_extinction(const stratus_path_field* f, double lo, double hi)
{
  if (!(lo <= hi)) {
    return 0.0;
  }
  const stratus_transfer* t = f->transfer;
  const double slack = HULL_SLACK * fmax(fabs(lo), fabs(hi)), from = lo - slack, to = hi + slack;
  double opacity = fmax(opacity_at(t, from), opacity_at(t, to));
  /* A vertical step has several points, of which all count: below it, values come as near as one likes to the first. */
  ptrdiff_t i = point_below(t->opacity, t->opacity_count, 2, from);
  while (i > 0 && t->opacity[2 * (i - 1)] >= from) {
    --i;
  }
  for (size_t p = i < 0 || t->opacity[2 * i] < from ? (size_t)(i + 1) : (size_t)i; p < t->opacity_count && t->opacity[2 * p] <= to; ++p) {
    opacity = fmax(opacity, t->opacity[2 * p + 1]);
  }
  return extinction_of(f, opacity);
}

/* ---- values */

/* Reads eight values. */
static void read_values(const stratus_volume* v, const size_t at[8], double values[8])
{
#define READ(type)                                                                                                                         \
  do {                                                                                                                                     \
    for (int c = 0; c < 8; ++c) {                                                                                                          \
      values[c] = (double)((const type*)v->values)[at[c] * (size_t)v->value_stride];                                                       \
    }                                                                                                                                      \
    return;                                                                                                                                \
  } while (0)
  switch (v->type) {
    case STRATUS_INT8:
      READ(int8_t);
    case STRATUS_UINT8:
      READ(uint8_t);
    case STRATUS_INT16:
      READ(int16_t);
    case STRATUS_UINT16:
      READ(uint16_t);
    case STRATUS_INT32:
      READ(int32_t);
    case STRATUS_UINT32:
      READ(uint32_t);
    case STRATUS_INT64:
      READ(int64_t);
    case STRATUS_UINT64:
      READ(uint64_t);
    case STRATUS_FLOAT32:
      READ(float);
    case STRATUS_FLOAT64:
      READ(double);
  }
#undef READ
}

static bool is_finite(const stratus_path_field* f, double value)
{
  return fabs(value - f->bias) <= (double)FLT_MAX;
}

static bool are_finite(const stratus_path_field* f, const double values[8])
{
  for (int c = 0; c < 8; ++c) {
    if (!is_finite(f, values[c])) {
      return false;
    }
  }
  return true;
}

/* Gives the numbers of the cell's corners. The cell of an axis with one value has that value twice. */
static void corners_of(const stratus_path_field* f, const int64_t cell[3], size_t at[8])
{
  const int64_t* n = f->volume->dimensions;
  const size_t stride[3] = { 1, (size_t)n[0], (size_t)n[0] * (size_t)n[1] };
  size_t base = 0, next[3];
  for (int a = 0; a < 3; ++a) {
    base += (size_t)cell[a] * stride[a];
    next[a] = n[a] > 1 ? stride[a] : 0;
  }
  for (int c = 0; c < 8; ++c) {
    at[c] = base + (c & 1 ? next[0] : 0) + (c & 2 ? next[1] : 0) + (c & 4 ? next[2] : 0);
  }
}

/* Whether ghosts hide the place. nearest: which corner is nearest. */
static bool is_hidden(const stratus_path_field* f, const int64_t cell[3], const size_t at[8], int nearest)
{
  if (!f->volume->cell_centered) {
    return f->hidden[(cell[2] * f->cells[1] + cell[1]) * f->cells[0] + cell[0]];
  }
  bool any = false;
  for (int c = 0; c < 8; ++c) {
    any |= f->hidden[at[c]] && (f->linear || c == nearest);
  }
  return any;
}

static int region_of(const stratus_path_field* f, const double place[3])
{
  int region = 0;
  for (int a = 2; a >= 0; --a) {
    region = 3 * region + (place[a] < f->crop[a][0] ? 0 : place[a] > f->crop[a][1] ? 2 : 1);
  }
  return region;
}

static bool is_cropped(const stratus_path_field* f, const double place[3])
{
  return !(f->regions >> region_of(f, place) & 1u);
}

/* Returns the place's position between the cell's two values, 0..1. */
static double part_in_cell(const stratus_path_field* f, int axis, int64_t cell, double place)
{
  if (f->volume->dimensions[axis] == 1) {
    return 0.0;
  }
  const double from = stratus_path_value_place(f, axis, cell), to = stratus_path_value_place(f, axis, cell + 1);
  return fmin(fmax((place - from) / (to - from), 0.0), 1.0);
}

/* Whether the cell's second value is nearer to the place at this part of the cell. */
static bool second_is_nearer(const stratus_path_field* f, int axis, int64_t cell, double place, double part)
{
  const double* x = f->volume->coordinates[axis];
  return f->volume->dimensions[axis] > 1 && (x && f->volume->cell_centered ? place >= f->sign[axis] * x[cell + 1] : part >= 0.5);
}

static double between(double a, double b, double part)
{
  return a + part * (b - a);
}

bool stratus_path_value(const stratus_path_field* f, const int64_t block[3], const double place[3], double* value)
{
  int64_t cell[3];
  double part[3], v[8];
  size_t at[8];
  int nearest = 0;
  if (f->regions != STRATUS_CROP_ALL && is_cropped(f, place)) {
    return false;
  }
  for (int a = 0; a < 3; ++a) {
    const int64_t first = block[a] * f->block_size, beyond = first + f->block_size;
    cell[a] = stratus_path_cell(f, a, first, (beyond < f->cells[a] ? beyond : f->cells[a]) - 1, place[a]);
    part[a] = part_in_cell(f, a, cell[a], place[a]);
    nearest |= second_is_nearer(f, a, cell[a], place[a], part[a]) << a;
  }
  corners_of(f, cell, at);
  if ((f->mask && !f->mask[at[nearest]]) || (f->hidden && is_hidden(f, cell, at, nearest))) {
    return false;
  }
  read_values(f->volume, at, v);
  if (!f->linear) {
    *value = v[nearest];
    return is_finite(f, *value);
  }
  if (!are_finite(f, v)) {
    return false;
  }
  *value = between(between(between(v[0], v[1], part[0]), between(v[2], v[3], part[0]), part[1]),
    between(between(v[4], v[5], part[0]), between(v[6], v[7], part[0]), part[1]), part[2]);
  return true;
}

/* A trilinear function has its extremes over a box at the box's corners. */
double stratus_path_majorant(const stratus_path_field* f, const int64_t cell[3], const double from[3], const double to[3])
{
  double values[8], lo = (double)INFINITY, hi = -(double)INFINITY;
  size_t at[8];
  int nearest[2] = { 0, 0 };
  corners_of(f, cell, at);
  read_values(f->volume, at, values);
  if (f->linear && !are_finite(f, values)) {
    return 0.0;
  }
  for (int a = 0; a < 3; ++a) {
    const double first = part_in_cell(f, a, cell[a], from[a]), second = part_in_cell(f, a, cell[a], to[a]);
    const bool ends[2] = { second_is_nearer(f, a, cell[a], from[a], first), second_is_nearer(f, a, cell[a], to[a], second) };
    const int next = 1 << a;
    nearest[0] |= ends[0] << a;
    nearest[1] |= ends[1] << a;
    for (int c = 0; c < 8; ++c) {
      if (!(c & next)) {
        const double v[2] = { values[c], values[c | next] };
        values[c] = f->linear ? between(v[0], v[1], first) : v[ends[0]];
        values[c | next] = f->linear ? between(v[0], v[1], second) : v[ends[1]];
      }
    }
  }
  const bool one = nearest[0] == nearest[1]; /* value is nearest to all of the box */
  if ((f->regions != STRATUS_CROP_ALL && region_of(f, from) == region_of(f, to) && is_cropped(f, from)) ||
    (f->mask && one && !f->mask[at[nearest[0]]]) || (f->hidden && (one || f->linear) && is_hidden(f, cell, at, nearest[0]))) {
    return 0.0;
  }
  for (int c = 0; c < 8; ++c) {
    lo = is_finite(f, values[c]) ? fmin(lo, values[c]) : lo;
    hi = is_finite(f, values[c]) ? fmax(hi, values[c]) : hi;
  }
  return largest_extinction(f, lo, hi);
}

/* ---- the largest extinction of each block */

static double majorant_of(const stratus_path_field* f, const int64_t block[3])
{
  int64_t first[3], last[3], cell[3];
  double lo = (double)INFINITY, hi = -(double)INFINITY;
  for (int a = 0; a < 3; ++a) {
    first[a] = block[a] * f->block_size;
    last[a] = first[a] + f->block_size < f->cells[a] ? first[a] + f->block_size : f->cells[a];
  }
  for (cell[2] = first[2]; cell[2] < last[2]; ++cell[2]) {
    for (cell[1] = first[1]; cell[1] < last[1]; ++cell[1]) {
      for (cell[0] = first[0]; cell[0] < last[0]; ++cell[0]) {
        size_t at[8];
        double values[8];
        corners_of(f, cell, at);
        read_values(f->volume, at, values);
        for (int c = 0; c < 8; ++c) {
          const bool counts = is_finite(f, values[c]);
          lo = counts && values[c] < lo ? values[c] : lo;
          hi = counts && values[c] > hi ? values[c] : hi;
        }
      }
    }
  }
  return largest_extinction(f, lo, hi);
}

stratus_status stratus_path_field_build(stratus_context* context, stratus_path_field* f)
{
  size_t count;
  void* memory;
  stratus_path_field_release(context, f);
  TRY(stratus_volume_hidden_cells(context, f->volume, &f->hidden));
  TRY(stratus_product(context, "blocks", (size_t)f->blocks[0], (size_t)f->blocks[1], (size_t)f->blocks[2], &count));
  TRY(stratus_allocate(context, count, sizeof *f->majorant, &memory));
  f->majorant = memory;
#pragma omp parallel for schedule(dynamic, 64) num_threads(context->threads)
  for (size_t b = 0; b < count; ++b) {
    const int64_t number = (int64_t)b,
                  block[3] = { number % f->blocks[0], number / f->blocks[0] % f->blocks[1], number / f->blocks[0] / f->blocks[1] };
    f->majorant[b] = majorant_of(f, block);
  }
  return STRATUS_OK;
}

void stratus_path_field_release(stratus_context* context, stratus_path_field* f)
{
  stratus_release(context, f->majorant);
  stratus_release(context, f->hidden);
  f->majorant = NULL;
  f->hidden = NULL;
}
