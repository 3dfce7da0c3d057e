/* SPDX-License-Identifier: BSD-3-Clause
 * The order in which a mesh's cells and points lie in memory for rays: along a Morton curve, so that what rays of a tile pass one after
 * the other shares cache lines, whatever order a mesh generator wrote. */
#include "bvh.h"
#include "tetra_caster.h"

#include "../kernels/morton.h"

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

static void find_codes(const stratus_mesh* mesh, int threads, uint64_t* codes, uint32_t* cells)
{
  double lo[3], hi[3], scale[3];
  bounds_of(mesh, threads, lo, hi);
  for (int axis = 0; axis < 3; ++axis) { /* of sums of four */
    const double width = 4.0 * (hi[axis] - lo[axis]);
    scale[axis] = width > 0.0 && isfinite(width) ? (1 << AXIS_BITS) / width : 0.0;
  }
#pragma omp parallel for num_threads(threads)
  for (int64_t cell = 0; cell < mesh->cell_count; ++cell) {
    uint32_t at[3];
    for (int axis = 0; axis < 3; ++axis) {
      double sum = -4.0 * lo[axis];
      for (int i = 0; i < 4; ++i) {
        sum += mesh->points[3 * (int64_t)mesh->vertices[4 * cell + i] + axis];
      }
      const double place = sum * scale[axis];
      at[axis] = place > 0.0 ? (uint32_t)fmin(place, (1 << AXIS_BITS) - 1) : 0;
    }
    codes[cell] = morton_code(at[0], at[1], at[2], 0);
    cells[cell] = (uint32_t)cell;
  }
}

stratus_status stratus_tetra_order(stratus_context* context, const stratus_mesh* mesh, stratus_tetra_places* places, int32_t** names)
{
  stratus_status status = STRATUS_OK;
  void *codes = NULL, *memory = NULL, *place = NULL, *name = NULL;
  TRY_CLEANUP(stratus_allocate(context, (size_t)mesh->cell_count, sizeof(uint64_t), &codes));
  TRY_CLEANUP(stratus_allocate(context, (size_t)mesh->cell_count, sizeof(uint32_t), &memory));
  TRY_CLEANUP(stratus_allocate(context, (size_t)mesh->cell_count, sizeof(int32_t), &place));
  TRY_CLEANUP(stratus_allocate(context, (size_t)mesh->point_count, sizeof(int32_t), &name));
  uint32_t* const cells = memory;
  int32_t *const to = place, *const called = name;
  find_codes(mesh, context->threads, codes, cells);
  TRY_CLEANUP(stratus_radix_sort(context, codes, cells, (uint32_t)mesh->cell_count, 3 * AXIS_BITS));
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
  stratus_release(context, codes);
  stratus_release(context, memory);
  stratus_release(context, place);
  stratus_release(context, name);
  return status;
}
