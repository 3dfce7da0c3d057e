/* SPDX-License-Identifier: BSD-3-Clause
 * Checks of a mesh of tetrahedra or of a lattice: they pass before anything is read through its point numbers. */
#include "mesh.h"

#include "matrix.h"

#include <string.h>

#define POINTS_MAX 2147483647LL
#define CELLS_MAX ((1LL << 30) - 1)

stratus_mesh stratus_mesh_default(void)
{
  static const double identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
  stratus_mesh mesh = { .type = STRATUS_FLOAT32, .value_stride = 1, .components = 1 };
  memcpy(mesh.matrix, identity, sizeof identity);
  return mesh;
}

stratus_volume stratus_mesh_values(const stratus_mesh* mesh)
{
  stratus_volume volume = stratus_volume_default();
  volume.values = mesh->values;
  volume.type = mesh->type;
  volume.value_stride = mesh->value_stride;
  volume.dimensions[0] = mesh->cell_values ? mesh->cell_count : mesh->point_count;
  volume.dimensions[1] = volume.dimensions[2] = 1;
  return volume;
}

static stratus_status check_lattice(stratus_context* context, const stratus_mesh* mesh)
{
  const int32_t* n = mesh->lattice;
  int64_t points = 1, cells = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (n[axis] < 2 || points > POINTS_MAX / n[axis]) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
        "mesh lattice of %d x %d x %d points, must be at least 2 along each axis and at most %lld in all", (int)n[0], (int)n[1], (int)n[2],
        POINTS_MAX);
    }
    points *= n[axis];
    cells *= n[axis] - 1;
  }
  if (mesh->point_count != points || mesh->cell_count != cells) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "mesh lattice of %d x %d x %d points with a point_count of %lld and a cell_count of %lld, must be %lld and %lld", (int)n[0],
      (int)n[1], (int)n[2], (long long)mesh->point_count, (long long)mesh->cell_count, (long long)points, (long long)cells);
  }
  if (mesh->vertices || !mesh->points == !mesh->float_points) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh lattice with %s, must have no vertices, and either points or float_points",
      mesh->vertices   ? "vertices"
        : mesh->points ? "points and float_points"
                       : "neither points nor float_points");
  }
  return STRATUS_OK;
}

static stratus_status check_counts(stratus_context* context, const stratus_mesh* mesh)
{
  if (mesh->point_count < 0 || mesh->point_count > POINTS_MAX) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "mesh point_count %lld outside 0..%lld", (long long)mesh->point_count, POINTS_MAX);
  }
  if (mesh->cell_count < 0 || mesh->cell_count > CELLS_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh cell_count %lld outside 0..%lld", (long long)mesh->cell_count, CELLS_MAX);
  }
  if (mesh->block_count != 0) {
    return STRATUS_OK;
  }
  if (stratus_mesh_is_lattice(mesh)) {
    return check_lattice(context, mesh);
  }
  if (!mesh->points && mesh->point_count > 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh points is NULL, with a point_count of %lld", (long long)mesh->point_count);
  }
  if (mesh->float_points) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh float_points is not NULL, must be NULL unless the mesh is a lattice");
  }
  if (!mesh->vertices && mesh->cell_count > 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh vertices is NULL, with a cell_count of %lld", (long long)mesh->cell_count);
  }
  return STRATUS_OK;
}

static stratus_status check_values(stratus_context* context, const stratus_mesh* mesh)
{
  const size_t size = stratus_type_size(mesh->type);
  size_t bytes = 0;
  if (size == 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh type %d outside %d..%d", (int)mesh->type, STRATUS_INT8, STRATUS_FLOAT64);
  }
  if (mesh->components < 0 || mesh->components > 4) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh components %d outside 1..4", mesh->components);
  }
  if (mesh->block_count == 0 && mesh->value_stride < 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh value_stride %lld, must be at least 1", (long long)mesh->value_stride);
  }
  if (mesh->block_count == 0 && mesh->value_stride < mesh->components) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh value_stride %lld, must be at least its %d components",
      (long long)mesh->value_stride, mesh->components);
  }
  if (mesh->cell_values != 0 && mesh->cell_values != 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh cell_values %d, must be 0 or 1", mesh->cell_values);
  }
  if (!mesh->values) {
    return STRATUS_OK;
  }
  const int64_t count = mesh->cell_values ? mesh->cell_count : mesh->point_count;
  return stratus_product(context, "mesh bytes (values, stride, size)", (size_t)count, (size_t)mesh->value_stride, size, &bytes);
}

static stratus_status check_block(stratus_context* context, const stratus_mesh* mesh, int n)
{
  const stratus_mesh* block = mesh->blocks + n;
  if (block->block_count != 0 || !stratus_mesh_is_lattice(block)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh block %d is no lattice, must be one", n);
  }
  if (block->type != mesh->type || block->components != mesh->components || block->cell_values != mesh->cell_values ||
    !block->values != !mesh->blocks->values) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "mesh block %d has type %d, %d components, cell_values %d and %s values, must have the mesh's %d, %d and %d, as all blocks", n,
      (int)block->type, block->components, block->cell_values, block->values ? "some" : "no", (int)mesh->type, mesh->components,
      mesh->cell_values);
  }
  TRY(check_counts(context, block));
  return check_values(context, block);
}

/* Check blocks: each is a lattice, with the mesh's type, components and counts. */
static stratus_status check_blocks(stratus_context* context, const stratus_mesh* mesh)
{
  int64_t points = 0, cells = 0;
  const int32_t* n = mesh->lattice;
  if (mesh->block_count < 0 || !mesh->blocks) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh block_count %d with blocks %s, must be at least 1 with blocks",
      mesh->block_count, mesh->blocks ? "there" : "NULL");
  }
  if (mesh->points || mesh->float_points || mesh->vertices || mesh->values || mesh->hidden || mesh->labels || n[0] != 0 || n[1] != 0 ||
    n[2] != 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "mesh of %d blocks with points, vertices, values, hidden flags, labels or a lattice of its own, must have none", mesh->block_count);
  }
  for (int b = 0; b < mesh->block_count; ++b) {
    TRY(check_block(context, mesh, b));
    points += mesh->blocks[b].point_count;
    cells += mesh->blocks[b].cell_count;
  }
  if (mesh->point_count != points || mesh->cell_count != cells) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "mesh of %d blocks with a point_count of %lld and a cell_count of %lld, must be %lld and %lld", mesh->block_count,
      (long long)mesh->point_count, (long long)mesh->cell_count, (long long)points, (long long)cells);
  }
  return STRATUS_OK;
}

/* Reports the first wrong point, so that the message does not depend on the number of threads. */
static stratus_status check_points(stratus_context* context, const stratus_mesh* mesh)
{
  int64_t wrong = INT64_MAX;
#pragma omp parallel for schedule(static) num_threads(context->threads) reduction(min : wrong)
  for (int64_t i = 0; i < mesh->point_count; ++i) {
    const double* p = mesh->points + 3 * i;
    const int64_t here = isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]) ? INT64_MAX : i;
    wrong = here < wrong ? here : wrong;
  }
  if (wrong != INT64_MAX) {
    const double* p = mesh->points + 3 * wrong;
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "mesh point %lld is (%g, %g, %g), must be finite", (long long)wrong, p[0], p[1], p[2]);
  }
  return STRATUS_OK;
}

static stratus_status check_vertices(stratus_context* context, const stratus_mesh* mesh)
{
  int64_t wrong = INT64_MAX;
#pragma omp parallel for schedule(static) num_threads(context->threads) reduction(min : wrong)
  for (int64_t i = 0; i < 4 * mesh->cell_count; ++i) {
    const int64_t here = mesh->vertices[i] >= 0 && mesh->vertices[i] < mesh->point_count ? INT64_MAX : i;
    wrong = here < wrong ? here : wrong;
  }
  if (wrong != INT64_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh cell %lld has vertex %d, outside 0..%lld", (long long)(wrong / 4),
      (int)mesh->vertices[wrong], (long long)mesh->point_count - 1);
  }
  return STRATUS_OK;
}

static stratus_status check_matrix(stratus_context* context, const stratus_mesh* mesh)
{
  const double* m = mesh->matrix;
  double inverse[16];
  for (int i = 0; i < 16; ++i) {
    if (!isfinite(m[i])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh matrix[%d] is %g, must be finite", i, m[i]);
    }
  }
  if (m[12] != 0.0 || m[13] != 0.0 || m[14] != 0.0 || m[15] != 1.0) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "mesh matrix has the last row %g %g %g %g, must be 0 0 0 1 (affine)", m[12], m[13], m[14], m[15]);
  }
  if (!stratus_matrix_invert_affine(m, inverse)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh matrix is singular, must be invertible");
  }
  return STRATUS_OK;
}

stratus_status stratus_mesh_check(stratus_context* context, const stratus_mesh* mesh)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!mesh) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh is NULL");
  }
  TRY(check_counts(context, mesh));
  TRY(check_values(context, mesh));
  TRY(check_matrix(context, mesh));
  if (mesh->block_count != 0) {
    TRY(check_blocks(context, mesh));
  }
  if (stratus_mesh_is_lattice(mesh)) {
    return STRATUS_OK; /* points that are not finite hide their hexahedra */
  }
  TRY(check_points(context, mesh));
  return check_vertices(context, mesh);
}

stratus_status stratus_mesh_check_listed(stratus_context* context, const stratus_mesh* mesh)
{
  TRY(stratus_mesh_check(context, mesh));
  if (mesh->block_count != 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh has %d blocks, its cells must be listed in vertices", mesh->block_count);
  }
  return stratus_mesh_is_lattice(mesh)
    ? stratus_fail(context, STRATUS_INVALID_ARGUMENT, "mesh is a lattice of %d x %d x %d points, its cells must be listed in vertices",
        (int)mesh->lattice[0], (int)mesh->lattice[1], (int)mesh->lattice[2])
    : STRATUS_OK;
}
