/* SPDX-License-Identifier: BSD-3-Clause
 * Makes the tables of rectilinear grids. */
#include "ray_grid.h"

#include <string.h>

/* Bins a value. More bins leave fewer steps of search, and take more of the nearest cache. */
#define BINS_A_VALUE 4
/* Where the planes beyond the volume are: farther than any ray's part in the volume, and near enough that its products stay finite. */
#define FAR_PLANE 1e9f

static int64_t coordinate_count(const stratus_volume* volume)
{
  return volume->dimensions[0] + volume->dimensions[1] + volume->dimensions[2] + 3;
}

static bool same_grid(const stratus_ray_grid* grid, const stratus_volume* volume)
{
  bool same = grid->table && grid->cell_centered == (volume->cell_centered != 0) &&
    memcmp(grid->dimensions, volume->dimensions, sizeof grid->dimensions) == 0;
  for (int axis = 0; same && axis < 3; ++axis) {
    const double *mine = grid->coordinates[axis], *other = volume->coordinates[axis];
    const size_t count = (size_t)volume->dimensions[axis] + (volume->cell_centered ? 1 : 0);
    same = (mine != NULL) == (other != NULL) && (!mine || memcmp(mine, other, count * sizeof *mine) == 0);
  }
  return same;
}

/* Copies the coordinates, and makes planes of them. */
static void set_planes(const stratus_volume* volume, double* memory, stratus_ray_grid* grid)
{
  const int64_t cells = volume->cell_centered != 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t n = volume->dimensions[axis], last = n - 1 + cells;
    const double* x = volume->coordinates[axis];
    double* planes = memory + n + 1;
    grid->coordinates[axis] = x ? memcpy(memory, x, (size_t)(last + 1) * sizeof *x) : NULL;
    grid->plane[axis] = planes;
    for (int64_t i = 0; i <= last; ++i) { /* even numbers: borders of cells. Odd ones: points. */
      planes[2 * i + 1 - cells] =
        x ? (x[i] - x[0]) / (x[last] - x[0]) * (double)last - 0.5 * (double)cells : (double)i - 0.5 * (double)cells;
    }
    for (int64_t i = 1 - cells; i < n; ++i) { /* and between them */
      planes[2 * i + cells] = 0.5 * (planes[2 * i + cells - 1] + planes[2 * i + cells + 1]);
    }
    if (!cells) {
      planes[0] = -0.5;
      planes[2 * n] = (double)n - 0.5;
    }
    memory += 3 * n + 2;
  }
}

/* Lays out an axis's part of the table, from word `at` on. Returns where it ends. */
static size_t place_axis(int64_t n, int axis, size_t at, stratus_ray_grid_arguments* a)
{
  a->first_at[axis] = (int)at;
  a->plane_at[axis] = (int)(at + (size_t)(BINS_A_VALUE * n) + 3); /* two planes have numbers below 0 */
  a->inverse_at[axis] = a->plane_at[axis] + (int)(2 * n) + 1;
  a->weight_at[axis] = a->inverse_at[axis] + (int)n;
  return (size_t)a->weight_at[axis] + (size_t)n;
}

static int bin_of(const stratus_ray_grid_arguments* a, int axis, float y)
{
  const float bin = y * a->bins_per_unit[axis];
  return (int)(bin < 0.0f ? 0.0f : bin > a->last_bin[axis] ? a->last_bin[axis] : bin);
}

static void fill_axis(const stratus_ray_grid* grid, int axis, int32_t* table, stratus_ray_grid_arguments* a)
{
  const int n = (int)grid->dimensions[axis], bins = BINS_A_VALUE * n, last_cell = n > 1 ? n - 2 : 0;
  float *plane = (float*)table + a->plane_at[axis], *inverse = (float*)table + a->inverse_at[axis],
        *weight = (float*)table + a->weight_at[axis];
  int32_t* first = table + a->first_at[axis];
  int most = 0;
  plane[-2] = -FAR_PLANE;
  plane[2 * n] = FAR_PLANE;
  a->even[axis] = n > 1;
  a->last_cell[axis] = last_cell;
  for (int p = -1; p < 2 * n; ++p) {
    plane[p] = (float)grid->plane[axis][p + 1];
    a->even[axis] &= plane[p] == 0.5f * (float)p;
  }
  a->bins_per_unit[axis] = (float)((double)bins / (n > 1 ? n - 1 : 1));
  a->last_bin[axis] = (float)(bins - 1);
  for (int bin = 0, value = 0; bin <= bins; ++bin) {
    while (value < last_cell && (bin == bins || bin_of(a, axis, plane[2 * value + 2]) < bin)) {
      ++value;
    }
    first[bin] = value;
    most = bin > 0 && value - first[bin - 1] > most ? value - first[bin - 1] : most;
  }
  a->search_steps[axis] = 0;
  while (1 << a->search_steps[axis] <= most) {
    ++a->search_steps[axis];
  }
  for (int i = 0; i < n; ++i) {
    const double length = i + 1 < n ? (double)plane[2 * i + 2] - (double)plane[2 * i] : 0.0;
    const double before = i > 0 ? (double)plane[2 * i] - (double)plane[2 * i - 2] : 0.0;
    inverse[i] = length > 0.0 ? (float)(1.0 / length) : 0.0f;
    weight[i] = length > 0.0 && before > 0.0 ? (float)(length / (before + length)) : 0.5f;
  }
}

static stratus_status make_tables(stratus_context* context, const stratus_volume* volume, stratus_ray_grid* grid)
{
  void *numbers = NULL, *table = NULL;
  size_t words = 0;
  stratus_status status = STRATUS_OK;
  for (int axis = 0; axis < 3; ++axis) {
    if (volume->dimensions[axis] > STRATUS_RAY_GRID_MOST) {
      return stratus_fail(context, STRATUS_UNSUPPORTED, "%lld coordinates along %c, at most %d", (long long)volume->dimensions[axis],
        "xyz"[axis], STRATUS_RAY_GRID_MOST);
    }
    words = place_axis(volume->dimensions[axis], axis, words, &grid->arguments);
  }
  TRY_CLEANUP(stratus_allocate(context, (size_t)coordinate_count(volume), 3 * sizeof(double), &numbers));
  TRY_CLEANUP(stratus_allocate_zero(context, words, sizeof(int32_t), &table));
  memcpy(grid->dimensions, volume->dimensions, sizeof grid->dimensions);
  grid->cell_centered = volume->cell_centered != 0;
  set_planes(volume, numbers, grid);
  for (int axis = 0; axis < 3; ++axis) {
    fill_axis(grid, axis, table, &grid->arguments);
  }
  grid->arguments.on = 1;
  grid->numbers = numbers;
  grid->table = table;
  grid->bytes = words * sizeof(int32_t);
  ++grid->serial;
  return STRATUS_OK;
cleanup:
  stratus_release(context, numbers);
  stratus_release(context, table);
  return status;
}

void stratus_ray_grid_release(stratus_context* context, stratus_ray_grid* grid)
{
  stratus_release(context, grid->numbers);
  stratus_release(context, grid->table);
  *grid = (stratus_ray_grid){ .serial = grid->serial };
}

stratus_status stratus_ray_grid_update(stratus_context* context, const stratus_volume* volume, stratus_ray_grid* grid, bool* changed)
{
  if (stratus_volume_is_stretched(volume) ? same_grid(grid, volume) : !grid->table) {
    return STRATUS_OK;
  }
  *changed = true;
  stratus_ray_grid_release(context, grid);
  return stratus_volume_is_stretched(volume) ? make_tables(context, volume, grid) : STRATUS_OK;
}

double stratus_ray_grid_at(const stratus_ray_grid* grid, int axis, double index)
{
  const int64_t n = grid->dimensions[axis];
  int64_t cell = (int64_t)index;
  cell = cell > n - 2 ? n - 2 : cell;
  cell = cell < 0 ? 0 : cell;
  const double *planes = grid->plane[axis] + 1, from = planes[2 * cell], to = n > 1 ? planes[2 * cell + 2] : from;
  return from + (index - (double)cell) * (to - from);
}

double stratus_ray_grid_border(const stratus_ray_grid* grid, int axis, int64_t cell)
{
  return grid->plane[axis][2 * cell + (grid->cell_centered ? 0 : 1)];
}
