/* SPDX-License-Identifier: BSD-3-Clause
 * Gradients at the points of a mesh. In a tetrahedron the field's gradient is constant; a point has the mean of the cells about it,
 * weighted by volume, and between points it is interpolated as values are. Values of cells are averaged at the points first, in the same
 * way. */
#include "tetra_gradient.h"

#include "tetra_lattice.h"
#include "vector.h"

#include <string.h>

/* What a range of points gathers. Threads share the points, not the cells, and each point adds its cells in their order: the result does
 * not depend on the number of threads. */
typedef struct gradient_build {
  const stratus_tetra_mesh* tetra;
  const stratus_mesh* mesh;
  const float* values;  /* of points, or of cells */
  int64_t step[3];      /* of a lattice */
  int64_t count;        /* of tetrahedra, those that do not show included */
  double* point_values; /* values of cells, averaged at the points; NULL: values belong to points */
  double* sums;         /* four a point: weighted gradients or values, and last the sum of the weights */
} gradient_build;

/* A tetrahedron: numbers of its points in the mesh, and where its own value stands. Returns false if it does not show. */
static bool cell_at(const gradient_build* b, int64_t number, int32_t v[4], int64_t* value)
{
  const stratus_tetra_mesh* tetra = b->tetra;
  if (tetra->names) {
    const int64_t cell = tetra->at ? (int64_t)tetra->at[number] : number;
    memcpy(v, b->mesh->vertices + 4 * cell, 4 * sizeof *v);
    *value = number;
    return tetra->shown[cell] == STRATUS_TETRA_SHOWN;
  }
  const int64_t first = number / 6;
  const int way = (int)(number % 6);
  v[0] = (int32_t)first;
  *value = first;
  if (!((uint32_t)tetra->cells[first / 32] >> (first % 32) & 1)) {
    return false;
  }
  for (int i = 0; i < 3; ++i) {
    v[i + 1] = v[i] + (int32_t)b->step[stratus_lattice_ways[way][i]];
  }
  return true;
}

static int64_t name_of(const gradient_build* b, int32_t point)
{
  return b->tetra->names ? b->tetra->names[point] : point;
}

/* The edges from a cell's first point. Returns six times its volume, with a sign. */
static double cell_edges(const gradient_build* b, const int32_t v[4], double edge[3][3])
{
  double p[4][3], normal[3];
  for (int i = 0; i < 4; ++i) {
    stratus_mesh_point(b->mesh, v[i], p[i]);
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
  for (int64_t number = 0; number < b->count; ++number) {
    int32_t v[4];
    int64_t value, name[4];
    bool mine = false;
    if (!cell_at(b, number, v, &value)) {
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

static void gather_all(const gradient_build* b, bool gradients)
{
  const int parts = b->tetra->context->threads;
  const int64_t points = b->tetra->point_count;
  memset(b->sums, 0, (size_t)points * 4 * sizeof *b->sums);
#pragma omp parallel for num_threads(parts) schedule(static, 1)
  for (int part = 0; part < parts; ++part) {
    gather(b, points * part / parts, points * (part + 1) / parts, gradients);
  }
}

/* The mean of what a point has gathered; 0 where no cell shows. */
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
  for (int64_t number = 0; number < b->count; ++number) { /* one after the other: a sum's rounding depends on its order */
    int32_t v[4];
    int64_t value;
    double edge[3][3];
    if (cell_at(b, number, v, &value)) {
      const double volume = fabs(cell_edges(b, v, edge));
      sum += isfinite(volume) ? volume : 0.0;
      cells += volume > 0.0 ? 1.0 : 0.0;
    }
  }
  return cells > 0.0 ? cbrt(sum / cells) : 0.0;
}

static stratus_status make(gradient_build* b, stratus_tetra_gradients* gradients)
{
  stratus_context* context = b->tetra->context;
  const size_t points = (size_t)b->tetra->point_count;
  void* memory = NULL;
  TRY(stratus_allocate(context, points, 4 * sizeof(double), &memory));
  b->sums = memory;
  if (!b->tetra->values) {
    TRY(stratus_allocate(context, points, sizeof(double), &memory));
    double* averaged = memory;
    gather_all(b, false);
    for (size_t i = 0; i < points; ++i) {
      averaged[i] = mean_of(b->sums + 4 * i, 0);
    }
    b->point_values = averaged;
  }
  gather_all(b, true);
  TRY(stratus_allocate(context, points, 4 * sizeof(float), &memory));
  gradients->vectors = memory;
  gradients->unit = store(b, gradients->vectors);
  gradients->spacing = spacing_of(b);
  gradients->bytes = points * 4 * sizeof(float);
  return STRATUS_OK;
}

stratus_status stratus_tetra_gradients_create(const stratus_tetra_mesh* tetra, const stratus_mesh* mesh, stratus_tetra_gradients* gradients)
{
  gradient_build b = { .tetra = tetra, .mesh = mesh, .values = tetra->values ? tetra->values : tetra->cell_values };
  stratus_context* context = tetra->context;
  const stratus_stage stage = stratus_stage_begin(context);
  if (tetra->names) {
    b.count = tetra->cell_count;
  } else {
    stratus_lattice_steps(mesh, b.step);
    b.count = 6 * tetra->point_count;
  }
  const stratus_status status = make(&b, gradients);
  stratus_release(context, b.sums);
  stratus_release(context, b.point_values);
  if (status == STRATUS_OK) {
    stratus_stage_end(context, &stage, "gradients", gradients->bytes);
  }
  return status;
}
