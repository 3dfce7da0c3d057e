/* SPDX-License-Identifier: BSD-3-Clause
 * Seams of several lattices: points at their borders that are in one place, and have one value, are one point to gradients. */
#include "tetra_gradient.h"

#include "mesh.h"

#include <stdlib.h>

typedef struct seam_point {
  double at[3];
  float value;
  int32_t point;
} seam_point;

static int compare(const void* left, const void* right)
{
  const seam_point *a = left, *b = right;
  for (int axis = 0; axis < 3; ++axis) {
    if (a->at[axis] < b->at[axis] || a->at[axis] > b->at[axis]) {
      return a->at[axis] < b->at[axis] ? -1 : 1;
    }
  }
  if (a->value < b->value || a->value > b->value) {
    return a->value < b->value ? -1 : 1;
  }
  return (a->point > b->point) - (a->point < b->point);
}

/* Of sorted points, `next` not before `first`. */
static bool is_one(const seam_point* first, const seam_point* next)
{
  seam_point same = *next;
  same.point = first->point;
  return compare(first, &same) == 0;
}

/* Lists the points at the border of a lattice, unless out is NULL, and returns their count. Those that are not finite belong to no cell. */
static size_t list_border(const stratus_tetra_cells* cells, int part, const float* values, seam_point* out)
{
  const stratus_mesh* mesh = stratus_mesh_part(cells->mesh, part);
  const int32_t* n = mesh->lattice;
  size_t count = 0;
  for (int64_t k = 0; k < n[2]; ++k) {
    for (int64_t j = 0; j < n[1]; ++j) {
      const bool inside = k > 0 && k < n[2] - 1 && j > 0 && j < n[1] - 1;
      for (int64_t i = 0; i < n[0]; i += inside ? n[0] - 1 : 1) {
        const int64_t own = (k * n[1] + j) * n[0] + i, point = cells->tetra->first[part] + own;
        seam_point p = { .value = values ? values[point] : 0.0f, .point = (int32_t)point };
        stratus_mesh_point(mesh, own, p.at);
        if (!isfinite(p.at[0]) || !isfinite(p.at[1]) || !isfinite(p.at[2]) || !isfinite(p.value)) {
          continue;
        }
        if (out) {
          out[count] = p;
        }
        ++count;
      }
    }
  }
  return count;
}

stratus_status stratus_tetra_join_sums(const stratus_tetra_cells* cells, const float* values, double* sums)
{
  stratus_context* context = cells->tetra->context;
  const int lattices = cells->tetra->lattices;
  size_t count = 0;
  void* memory = NULL;
  if (lattices < 2) {
    return STRATUS_OK;
  }
  for (int part = 0; part < lattices; ++part) {
    count += list_border(cells, part, values, NULL);
  }
  TRY(stratus_allocate(context, count, sizeof(seam_point), &memory));
  seam_point* points = memory;
  count = 0;
  for (int part = 0; part < lattices; ++part) {
    count += list_border(cells, part, values, points + count);
  }
  qsort(points, count, sizeof *points, compare);
  for (size_t begin = 0, end; begin < count; begin = end) {
    double sum[4] = { 0.0, 0.0, 0.0, 0.0 };
    for (end = begin; end < count && is_one(points + begin, points + end); ++end) {
      for (int i = 0; i < 4; ++i) {
        sum[i] += sums[4 * (int64_t)points[end].point + i];
      }
    }
    for (size_t p = begin; p < end; ++p) {
      for (int i = 0; i < 4; ++i) {
        sums[4 * (int64_t)points[p].point + i] = sum[i];
      }
    }
  }
  stratus_release(context, memory);
  return STRATUS_OK;
}
