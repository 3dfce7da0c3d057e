/* SPDX-License-Identifier: BSD-3-Clause
 * Lists the tetrahedra of lattices, for projection. */
#include "tetra_lattice.h"

#include <string.h>

/* A lattice whose tetrahedra are listed after the tetrahedra of the lattices before. */
typedef struct list_build {
  stratus_tetra_list* list;
  const stratus_mesh* lattice;
  int64_t step[3], corner[8];
  int64_t first_point, first_cell; /* in the list, tetrahedra from 6 first_cell on */
} list_build;

/* Copy points that are floats, or points of several lattices. Points that are not finite become 0: their hexahedra are hidden. */
static stratus_status copy_points(stratus_tetra_list* list, const stratus_mesh* whole)
{
  const int64_t count = 3 * whole->point_count;
  int64_t wrong = 0;
  for (int64_t i = 0; i < count && whole->points; ++i) {
    wrong += !isfinite(whole->points[i]);
  }
  list->mesh.points = whole->points;
  if (whole->points && wrong == 0) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(list->context, (size_t)count, sizeof(double), &list->points));
  double* at = list->points;
  for (int part = 0; part < stratus_mesh_part_count(whole); ++part) {
    const stratus_mesh* lattice = stratus_mesh_part(whole, part);
    for (int64_t i = 0; i < lattice->point_count; ++i, at += 3) {
      stratus_mesh_point(lattice, i, at);
      for (int axis = 0; axis < 3; ++axis) {
        at[axis] = isfinite(at[axis]) ? at[axis] : 0.0;
      }
    }
  }
  list->mesh.points = list->points;
  return STRATUS_OK;
}

/* Whether all values of a hexahedron are finite. */
static bool is_finite(const list_build* b, const stratus_volume* values, double bias, int64_t first, int64_t cell)
{
  bool finite = true;
  for (int i = 0; i < (b->lattice->cell_values ? 1 : 8); ++i) {
    finite =
      finite && isfinite(stratus_tetra_fetch(b->lattice, values, bias, (size_t)(b->lattice->cell_values ? cell : first + b->corner[i])));
  }
  return finite;
}

/* Copies a value of the lattice to the list. */
static void copy_value(const list_build* b, int64_t from, size_t to)
{
  const size_t one = stratus_type_size(b->lattice->type), size = (size_t)stratus_tetra_component_count(b->lattice) * one;
  memcpy((char*)b->list->values + size * to, (const char*)b->lattice->values + one * (size_t)(b->lattice->value_stride * from), size);
}

static void list_cell(const list_build* b, const stratus_volume* values, double bias, int64_t first, int64_t cell)
{
  const stratus_mesh* lattice = b->lattice;
  const bool shows = stratus_lattice_shows(lattice, b->corner, first, cell) && is_finite(b, values, bias, first, cell);
  for (int way = 0; way < 6; ++way) {
    const size_t part = 6 * (size_t)(b->first_cell + cell) + (size_t)way;
    int32_t* v = (int32_t*)b->list->vertices + 4 * part;
    v[0] = (int32_t)(b->first_point + first);
    for (int i = 0; i < 3; ++i) {
      v[i + 1] = v[i] + (int32_t)b->step[stratus_lattice_ways[way][i]];
    }
    ((uint8_t*)b->list->hidden)[part] = shows ? 0 : 1;
    if (lattice->cell_values) {
      copy_value(b, cell, part);
    }
  }
}

static void list_lattice(const list_build* b, double bias)
{
  const stratus_mesh* lattice = b->lattice;
  const stratus_volume values = stratus_mesh_values(lattice);
  const int32_t* n = lattice->lattice;
  const int64_t points = b->list->values && !lattice->cell_values ? lattice->point_count : 0;
  for (int64_t i = 0; i < points; ++i) {
    copy_value(b, i, (size_t)(b->first_point + i));
  }
#pragma omp parallel for num_threads(b->list->context->threads)
  for (int64_t row = 0; row < (int64_t)(n[1] - 1) * (n[2] - 1); ++row) {
    const int64_t j = row % (n[1] - 1), k = row / (n[1] - 1);
    for (int64_t i = 0; i < n[0] - 1; ++i) {
      list_cell(b, &values, bias, i + j * b->step[1] + k * b->step[2], row * (n[0] - 1) + i);
    }
  }
}

static stratus_status fill(stratus_tetra_list* list, const stratus_mesh* whole)
{
  const size_t cells = 6 * (size_t)whole->cell_count;
  const double bias = stratus_tetra_bias(whole, 0);
  TRY(copy_points(list, whole));
  TRY(stratus_allocate(list->context, cells, 4 * sizeof(int32_t), &list->vertices));
  TRY(stratus_allocate(list->context, cells, 1, &list->hidden));
  if (whole->cell_values || whole->block_count > 0) {
    const int components = stratus_tetra_component_count(whole);
    TRY(stratus_allocate(list->context, whole->cell_values ? cells : (size_t)whole->point_count,
      (size_t)components * stratus_type_size(whole->type), &list->values));
    list->mesh.values = list->values;
    list->mesh.value_stride = components;
  }
  list_build b = { .list = list };
  for (int part = 0; part < stratus_mesh_part_count(whole); ++part) {
    b.lattice = stratus_mesh_part(whole, part);
    stratus_lattice_steps(b.lattice, b.step);
    for (int corner = 0; corner < 8; ++corner) {
      b.corner[corner] = (corner & 1) * b.step[0] + (corner >> 1 & 1) * b.step[1] + (corner >> 2) * b.step[2];
    }
    list_lattice(&b, bias);
    b.first_point += b.lattice->point_count;
    b.first_cell += b.lattice->cell_count;
  }
  list->mesh.vertices = list->vertices;
  list->mesh.hidden = list->hidden;
  return STRATUS_OK;
}

stratus_status stratus_tetra_list_create(stratus_context* context, const stratus_mesh* lattice, stratus_tetra_list** out)
{
  void* memory = NULL;
  if (lattice->cell_count > INT32_MAX / TETRA_CELL / 6) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "lattice of %lld cells is too large to project: at most %d; it can be marched",
      (long long)lattice->cell_count, INT32_MAX / TETRA_CELL / 6);
  }
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_tetra_list), &memory));
  stratus_tetra_list* list = memory;
  list->context = context;
  list->source = list->mesh = *lattice;
  memset(list->mesh.lattice, 0, sizeof list->mesh.lattice);
  list->mesh.float_points = NULL;
  list->mesh.blocks = NULL;
  list->mesh.block_count = 0;
  list->mesh.geometry = 0; /* the list has other vertices than the lattice */
  list->mesh.cell_count = 6 * lattice->cell_count;
  const stratus_status status = fill(list, lattice);
  if (status != STRATUS_OK) {
    stratus_tetra_list_destroy(list);
    return status;
  }
  *out = list;
  return STRATUS_OK;
}

void stratus_tetra_list_destroy(stratus_tetra_list* list)
{
  if (list) {
    stratus_release(list->context, list->points);
    stratus_release(list->context, list->vertices);
    stratus_release(list->context, list->values);
    stratus_release(list->context, list->hidden);
    stratus_release(list->context, list);
  }
}
