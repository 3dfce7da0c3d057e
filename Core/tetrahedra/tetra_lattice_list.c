/* SPDX-License-Identifier: BSD-3-Clause
 * Lists the tetrahedra of a lattice, for projection and for lattices whose cells turn both ways. */
#include "tetra_lattice.h"

#include <string.h>

typedef struct list_build {
  stratus_tetra_list* list;
  const stratus_mesh* lattice;
  int64_t step[3], corner[8];
} list_build;

/* Copies points that are floats. Those that are not finite become 0: their hexahedra are hidden. */
static stratus_status copy_points(const list_build* b)
{
  const stratus_mesh* lattice = b->lattice;
  const int64_t count = 3 * lattice->point_count;
  int64_t wrong = 0;
  for (int64_t i = 0; i < count && lattice->points; ++i) {
    wrong += !isfinite(lattice->points[i]);
  }
  b->list->mesh.points = lattice->points;
  if (lattice->points && wrong == 0) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(b->list->context, (size_t)count, sizeof(double), &b->list->points));
  double* points = b->list->points;
  for (int64_t i = 0; i < lattice->point_count; ++i) {
    stratus_mesh_point(lattice, i, points + 3 * i);
    for (int axis = 0; axis < 3; ++axis) {
      points[3 * i + axis] = isfinite(points[3 * i + axis]) ? points[3 * i + axis] : 0.0;
    }
  }
  b->list->mesh.points = points;
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

static void list_cell(const list_build* b, const stratus_volume* values, double bias, int64_t first, int64_t cell)
{
  const stratus_mesh* lattice = b->lattice;
  const size_t components = (size_t)stratus_tetra_component_count(lattice), size = components * stratus_type_size(lattice->type);
  const bool shows = stratus_lattice_shows(lattice, b->corner, first, cell) && is_finite(b, values, bias, first, cell);
  for (int way = 0; way < 6; ++way) {
    const size_t part = 6 * (size_t)cell + (size_t)way;
    int32_t* v = (int32_t*)b->list->vertices + 4 * part;
    v[0] = (int32_t)first;
    for (int i = 0; i < 3; ++i) {
      v[i + 1] = v[i] + (int32_t)b->step[stratus_lattice_ways[way][i]];
    }
    ((uint8_t*)b->list->hidden)[part] = shows ? 0 : 1;
    if (lattice->cell_values) {
      memcpy((char*)b->list->values + size * part,
        (const char*)lattice->values + stratus_type_size(lattice->type) * (size_t)(lattice->value_stride * cell), size);
    }
  }
}

static stratus_status fill(list_build* b)
{
  stratus_tetra_list* list = b->list;
  const stratus_mesh* lattice = b->lattice;
  const stratus_volume values = stratus_mesh_values(lattice);
  const double bias = stratus_volume_bias(&values);
  const int32_t* n = lattice->lattice;
  const size_t parts = 6 * (size_t)lattice->cell_count;
  TRY(copy_points(b));
  TRY(stratus_allocate(list->context, parts, 4 * sizeof(int32_t), &list->vertices));
  TRY(stratus_allocate(list->context, parts, 1, &list->hidden));
  if (lattice->cell_values) {
    const int components = stratus_tetra_component_count(lattice);
    TRY(stratus_allocate(list->context, parts, (size_t)components * stratus_type_size(lattice->type), &list->values));
    list->mesh.values = list->values;
    list->mesh.value_stride = components;
  }
#pragma omp parallel for num_threads(list->context->threads)
  for (int64_t row = 0; row < (int64_t)(n[1] - 1) * (n[2] - 1); ++row) {
    const int64_t j = row % (n[1] - 1), k = row / (n[1] - 1);
    for (int64_t i = 0; i < n[0] - 1; ++i) {
      list_cell(b, &values, bias, i + j * b->step[1] + k * b->step[2], row * (n[0] - 1) + i);
    }
  }
  list->mesh.vertices = list->vertices;
  list->mesh.hidden = list->hidden;
  return STRATUS_OK;
}

stratus_status stratus_tetra_list_create(stratus_context* context, const stratus_mesh* lattice, stratus_tetra_list** out)
{
  void* memory = NULL;
  if (lattice->cell_count > INT32_MAX / TETRA_CELL / 6) {
    return stratus_fail(context, STRATUS_UNSUPPORTED,
      "lattice of %lld cells is too large to project, or to march through cells that turn both ways: at most %d",
      (long long)lattice->cell_count, INT32_MAX / TETRA_CELL / 6);
  }
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_tetra_list), &memory));
  stratus_tetra_list* list = memory;
  list->context = context;
  list->source = list->mesh = *lattice;
  memset(list->mesh.lattice, 0, sizeof list->mesh.lattice);
  list->mesh.float_points = NULL;
  list->mesh.cell_count = 6 * lattice->cell_count;
  list_build b = { .list = list, .lattice = lattice };
  stratus_lattice_steps(lattice, b.step);
  for (int corner = 0; corner < 8; ++corner) {
    b.corner[corner] = (corner & 1) * b.step[0] + (corner >> 1 & 1) * b.step[1] + (corner >> 2) * b.step[2];
  }
  const stratus_status status = fill(&b);
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
