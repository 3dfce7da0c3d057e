/* SPDX-License-Identifier: BSD-3-Clause
 * Gradients at the points of a mesh. In a tetrahedron the field's gradient is constant; a point has the mean of the cells about it,
 * weighted by volume, and between points it is interpolated as values are. Values of cells are averaged at the points first, in the same
 * way. */
#include "tetra_gradient.h"

#include "vector.h"

#include <string.h>

/* The sums of a range of points. Threads share the points, not the cells, and each point adds its cells in their order: the result does not
 * depend on the number of threads. */
typedef struct gradient_build {
  stratus_tetra_cells cells;
  const stratus_tetra_mesh* tetra;
  const stratus_mesh* mesh;
  const float* values;  /* of points, or of cells */
  double* point_values; /* values of cells, averaged at the points; NULL: values belong to points */
  double* sums;         /* four a point: weighted gradients or values, and last the sum of the weights */
} gradient_build;

static int64_t name_of(const gradient_build* b, int32_t point)
{
  return b->tetra->names ? b->tetra->names[point] : point;
}

/* The edges from a cell's first point. Returns six times its volume, with a sign. */
static double cell_edges(const gradient_build* b, const int32_t v[4], double edge[3][3])
{
  double p[4][3], normal[3];
  for (int i = 0; i < 4; ++i) {
    stratus_tetra_point_at(&b->cells, v[i], p[i]);
  }
  for (int i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      edge[i][axis] = p[i + 1][axis] - p[0][axis];
    }
  }
  stratus_vector_cross(edge[1], edge[2], normal);
  return stratus_vector_dot(edge[0], normal);
}

/* A cell's gradient times six times its volume. */
static void weigh_gradient(const gradient_build* b, const int32_t v[4], const double edge[3][3], double volume, double out[3])
{
  double value[4];
  for (int i = 0; i < 4; ++i) {
    value[i] = b->point_values ? b->point_values[name_of(b, v[i])] : (double)b->values[v[i]];
  }
  memset(out, 0, 3 * sizeof *out);
  for (int i = 0; i < 3; ++i) {
    double across[3];
    stratus_vector_cross(edge[(i + 1) % 3], edge[(i + 2) % 3], across);
    for (int axis = 0; axis < 3; ++axis) {
      out[axis] += (volume < 0.0 ? -1.0 : 1.0) * (value[i + 1] - value[0]) * across[axis];
    }
  }
}

/* Adds what all cells give to the points named first..beyond-1: gradients, or values of cells. */
static void gather(const gradient_build* b, int64_t first, int64_t beyond, bool gradients)
{
  for (int64_t number = 0; number < b->cells.count; ++number) {
    int32_t v[4];
    int64_t value, name[4];
    bool mine = false;
    if (!stratus_tetra_cell_at(&b->cells, number, v, &value)) {
      continue;
    }
    for (int i = 0; i < 4; ++i) {
      name[i] = name_of(b, v[i]);
      mine = mine || (name[i] >= first && name[i] < beyond);
    }
    if (!mine) {
      continue;
    }
    double edge[3][3], weighted[3] = { 0.0, 0.0, 0.0 };
    const double volume = cell_edges(b, v, edge);
    if (!(fabs(volume) > 0.0) || !isfinite(volume)) {
      continue;
    }
    if (gradients) {
      weigh_gradient(b, v, (const double(*)[3])edge, volume, weighted);
    } else {
      weighted[0] = fabs(volume) * (double)b->values[value];
    }
    for (int i = 0; i < 4; ++i) {
      double* sum = b->sums + 4 * name[i];
      for (int axis = 0; axis < 3 && name[i] >= first && name[i] < beyond; ++axis) {
        sum[axis] += weighted[axis];
        sum[3] += axis == 0 ? fabs(volume) : 0.0;
      }
    }
  }
}

static stratus_status gather_all(const gradient_build* b, bool gradients)
{
  const int parts = b->tetra->context->threads;
  const int64_t points = b->tetra->point_count;
  memset(b->sums, 0, (size_t)points * 4 * sizeof *b->sums);
#pragma omp parallel for num_threads(parts) schedule(static, 1)
  for (int part = 0; part < parts; ++part) {
    gather(b, points * part / parts, points * (part + 1) / parts, gradients);
  }
  return stratus_tetra_join_sums(&b->cells, b->tetra->values ? b->values : NULL, b->sums);
}

/* The mean of a point's sums; 0 if no cell shows. */
static double mean_of(const double sum[4], int axis)
{
  const double mean = sum[axis] / sum[3];
  return sum[3] > 0.0 && isfinite(mean) ? mean : 0.0;
}

/* Scales the means by a power of 2 so that the largest component is about 1. Returns that power. */
static double store(const gradient_build* b, float* out)
{
  const int64_t points = b->tetra->point_count;
  double largest = 0.0;
  int exponent = 0;
#pragma omp parallel for num_threads(b->tetra->context->threads) reduction(max : largest)
  for (int64_t i = 0; i < points; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      largest = fmax(largest, fabs(mean_of(b->sums + 4 * i, axis)));
    }
  }
  (void)frexp(largest, &exponent);
#pragma omp parallel for num_threads(b->tetra->context->threads)
  for (int64_t i = 0; i < points; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      out[4 * i + axis] = (float)ldexp(mean_of(b->sums + 4 * i, axis), -exponent);
    }
    out[4 * i + 3] = 0.0f;
  }
  return ldexp(1.0, exponent);
}

/* The edge of a cube that six cells of the mean volume fill: the spacing of a lattice of cubes. */
static double spacing_of(const gradient_build* b)
{
  double sum = 0.0, cells = 0.0;
  for (int64_t number = 0; number < b->cells.count; ++number) { /* one after the other: a sum's rounding depends on its order */
    int32_t v[4];
    int64_t value;
    double edge[3][3];
    if (stratus_tetra_cell_at(&b->cells, number, v, &value)) {
      const double volume = fabs(cell_edges(b, v, edge));
      sum += isfinite(volume) ? volume : 0.0;
      cells += volume > 0.0 ? 1.0 : 0.0;
    }
  }
  return cells > 0.0 ? cbrt(sum / cells) : 0.0;
}

/* Values of cells, averaged at the points. */
static stratus_status average(gradient_build* b)
{
  const size_t points = (size_t)b->tetra->point_count;
  void* memory = b->point_values;
  if (!memory) {
    TRY(stratus_allocate(b->tetra->context, points, sizeof(double), &memory));
  }
  b->point_values = memory;
  TRY(gather_all(b, false));
  for (size_t i = 0; i < points; ++i) {
    b->point_values[i] = mean_of(b->sums + 4 * i, 0);
  }
  return STRATUS_OK;
}

static stratus_status make_set(gradient_build* b, int c, stratus_tetra_gradients* gradients)
{
  const size_t points = (size_t)b->tetra->point_count, values = 4 * points;
  float* fetched = NULL;
  double bias;
  stratus_status status = STRATUS_OK;
  b->values = b->tetra->values ? b->tetra->values : b->tetra->cell_values;
  if (c > 0) {
    TRY(stratus_tetra_fetch_component(&b->cells, c, &bias, &fetched));
    b->values = fetched;
  }
  if (!b->tetra->values) {
    TRY_CLEANUP(average(b));
  }
  TRY_CLEANUP(gather_all(b, true));
  gradients->unit[c] = store(b, gradients->vectors + (size_t)gradients->sets * values);
  gradients->set[c] = gradients->sets++;
cleanup:
  stratus_release(b->tetra->context, fetched);
  return status;
}

static stratus_status make(gradient_build* b, unsigned mask, stratus_tetra_gradients* gradients)
{
  stratus_context* context = b->tetra->context;
  const size_t points = (size_t)b->tetra->point_count;
  size_t sets = 0;
  void* memory = NULL;
  for (int c = 0; c < STRATUS_COMPONENTS_MAX; ++c) {
    sets += mask >> c & 1;
    gradients->set[c] = -1;
  }
  TRY(stratus_allocate(context, points, 4 * sizeof(double), &memory));
  b->sums = memory;
  TRY(stratus_allocate(context, points, sets * 4 * sizeof(float), &memory));
  gradients->vectors = memory;
  gradients->mask = mask;
  gradients->bytes = points * sets * 4 * sizeof(float);
  gradients->spacing = spacing_of(b);
  for (int c = 0; c < STRATUS_COMPONENTS_MAX; ++c) {
    if (mask >> c & 1) {
      TRY(make_set(b, c, gradients));
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_tetra_gradients_create(
  const stratus_tetra_mesh* tetra, const stratus_mesh* mesh, unsigned mask, stratus_tetra_gradients* gradients)
{
  gradient_build b = { .cells = stratus_tetra_cells_of(tetra, mesh), .tetra = tetra, .mesh = mesh };
  stratus_context* context = tetra->context;
  const stratus_stage stage = stratus_stage_begin(context);
  const stratus_status status = make(&b, mask, gradients);
  stratus_release(context, b.sums);
  stratus_release(context, b.point_values);
  if (status == STRATUS_OK) {
    stratus_stage_end(context, &stage, "gradients", gradients->bytes);
  }
  return status;
}
