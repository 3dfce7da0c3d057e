/* SPDX-License-Identifier: BSD-3-Clause
 * Orders a mesh's cells and points in memory along a Morton curve, so that cells which rays of a tile pass in succession share cache lines,
 * whatever the order of the mesh generator. */
#include "cell_morton.h"
#include "tetra_caster.h"

#include <string.h>

#define AXIS_BITS 12

static void bounds_of(const stratus_mesh* mesh, int threads, double lo[3], double hi[3])
{
  double least[3] = { INFINITY, INFINITY, INFINITY }, most[3] = { -INFINITY, -INFINITY, -INFINITY };
#pragma omp parallel for num_threads(threads) reduction(min : least[:3]) reduction(max : most[:3])
  for (int64_t i = 0; i < mesh->point_count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      least[axis] = fmin(least[axis], mesh->points[3 * i + axis]);
      most[axis] = fmax(most[axis], mesh->points[3 * i + axis]);
    }
  }
  memcpy(lo, least, sizeof least);
  memcpy(hi, most, sizeof most);
}

/* Data of place_cell(). */
typedef struct mesh_places {
  const stratus_mesh* mesh;
  double lo[3], scale[3]; /* scale: from the sum of four points to curve coordinates */
} mesh_places;

static uint32_t place_cell(const void* data, int64_t cell, double at[3])
{
  const mesh_places* places = data;
  const stratus_mesh* mesh = places->mesh;
  for (int axis = 0; axis < 3; ++axis) {
    double sum = -4.0 * places->lo[axis];
    for (int i = 0; i < 4; ++i) {
      sum += mesh->points[3 * (int64_t)mesh->vertices[4 * cell + i] + axis];
    }
    at[axis] = sum * places->scale[axis];
  }
  return 0;
}

static stratus_status list_cells(stratus_context* context, const stratus_mesh* mesh, uint32_t* cells)
{
  mesh_places places = { .mesh = mesh };
  double hi[3];
  bounds_of(mesh, context->threads, places.lo, hi);
  for (int axis = 0; axis < 3; ++axis) {
    const double width = 4.0 * (hi[axis] - places.lo[axis]);
    places.scale[axis] = width > 0.0 && isfinite(width) ? (1 << AXIS_BITS) / width : 0.0;
  }
  const stratus_morton_cells curve = { .count = mesh->cell_count, .axis_bits = AXIS_BITS, .data = &places, .place = place_cell };
  return stratus_morton_order(context, &curve, cells);
}

stratus_status stratus_tetra_order(stratus_context* context, const stratus_mesh* mesh, stratus_tetra_places* places, int32_t** names)
{
  stratus_status status = STRATUS_OK;
  void *memory = NULL, *place = NULL, *name = NULL;
  TRY_CLEANUP(stratus_allocate(context, (size_t)mesh->cell_count, sizeof(uint32_t), &memory));
  TRY_CLEANUP(stratus_allocate(context, (size_t)mesh->cell_count, sizeof(int32_t), &place));
  TRY_CLEANUP(stratus_allocate(context, (size_t)mesh->point_count, sizeof(int32_t), &name));
  uint32_t* const cells = memory;
  int32_t *const to = place, *const called = name;
  TRY_CLEANUP(list_cells(context, mesh, cells));
  memset(called, 0xff, (size_t)mesh->point_count * sizeof *called);
  int32_t next = 0;
  for (int64_t i = 0; i < mesh->cell_count; ++i) {
    const int32_t* v = mesh->vertices + 4 * (int64_t)cells[i];
    to[cells[i]] = (int32_t)i;
    for (int corner = 0; corner < 4; ++corner) {
      if (called[v[corner]] < 0) {
        called[v[corner]] = next++;
      }
    }
  }
  for (int64_t i = 0; i < mesh->point_count; ++i) {
    called[i] = called[i] < 0 ? next++ : called[i];
  }
  places->of = to;
  places->at = cells;
  *names = called;
  memory = place = name = NULL;

cleanup:
  stratus_release(context, memory);
  stratus_release(context, place);
  stratus_release(context, name);
  return status;
}
