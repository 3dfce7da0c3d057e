/* SPDX-License-Identifier: BSD-3-Clause
 * Counts of a view's cells, pixels and segments, estimated from a sample of the cells. */
#include "tetra_costs.h"

#include "mesh.h"
#include "matrix.h"

/* Cells in the sample. Its counts are right to some percent, and it takes less than a tenth of a millisecond. */
#define SAMPLE 2048
/* Area of a convex body's bounding rectangle on the screen over the area that the body covers, averaged over directions. */
#define BOX_OVER_COVERED 2.5
#define PACKET_EDGE 4.0

static double triangle_area(const double a[3], const double b[3], const double c[3])
{
  double u[3], v[3], square = 0.0;
  for (int i = 0; i < 3; ++i) {
    u[i] = b[i] - a[i];
    v[i] = c[i] - a[i];
  }
  for (int i = 0; i < 3; ++i) {
    const double normal = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
    square += normal * normal;
  }
  return 0.5 * sqrt(square);
}

static double length_of(const double v[3])
{
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Returns how many pixels a cell covers, averaged over its orientations: a quarter of its surface (Cauchy). 0: it is out of view. */
static double covered_pixels(
  const stratus_mesh* mesh, const stratus_camera* camera, const stratus_image* image, const double inverse[16], int64_t cell)
{
  double p[4][3], middle[3] = { 0.0 }, from[3], seen[3], surface = 0.0;
  for (int i = 0; i < 4; ++i) {
    stratus_matrix_point(mesh->matrix, mesh->points + 3 * (int64_t)mesh->vertices[4 * cell + i], p[i]);
    for (int axis = 0; axis < 3; ++axis) {
      middle[axis] += 0.25 * p[i][axis];
    }
  }
  for (int i = 0; i < 4; ++i) {
    surface += triangle_area(p[i], p[(i + 1) % 4], p[(i + 2) % 4]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = middle[axis] - camera->eye[axis];
  }
  stratus_matrix_vector(inverse, from, seen); /* a, b, c: eye + a right + b up + c forward */
  const double depth = camera->parallel ? 1.0 : seen[2];
  if (!(seen[2] >= camera->near_k && seen[2] <= camera->far_k && fabs(seen[0]) <= depth && fabs(seen[1]) <= depth)) {
    return 0.0;
  }
  const double pixels = (double)image->width * image->height;
  const double pixel = 4.0 * length_of(camera->right) * length_of(camera->up) * depth * depth / pixels;
  return pixel > 0.0 ? fmin(0.25 * surface / pixel, pixels) : 0.0;
}

static bool can_show(const stratus_tetra_shown* shown, const stratus_mesh* mesh, const stratus_volume* values, int64_t cell, bool* hidden)
{
  float lo = INFINITY, hi = -INFINITY;
  *hidden = mesh->hidden && mesh->hidden[cell];
  for (int i = 0; i < 4; ++i) {
    const float value = shown->tetra->values ? shown->tetra->values[mesh->vertices[4 * cell + i]]
                                             : stratus_volume_fetch(values, shown->tetra->bias, (size_t)cell);
    *hidden = *hidden || !isfinite(value);
    lo = fminf(lo, value);
    hi = fmaxf(hi, value);
  }
  return !*hidden && (shown->mode == STRATUS_TETRA_MAXIMUM || stratus_table_shows(shown->table, lo, hi));
}

bool stratus_tetra_count_view(const stratus_tetra_shown* shown, const stratus_mesh* mesh, const stratus_camera* camera,
  const stratus_image* image, stratus_tetra_view* counts)
{
  double basis[16] = { [15] = 1.0 }, inverse[16];
  for (int row = 0; row < 3; ++row) {
    basis[4 * row] = camera->right[row];
    basis[4 * row + 1] = camera->up[row];
    basis[4 * row + 2] = camera->forward[row];
  }
  if (!stratus_matrix_invert_affine(basis, inverse)) {
    return false;
  }
  const int64_t sample = mesh->cell_count < SAMPLE ? mesh->cell_count : SAMPLE;
  const double each = (double)mesh->cell_count / (double)sample;
  const stratus_volume values = stratus_mesh_values(mesh);
  *counts = (stratus_tetra_view){ 0 };
  for (int64_t i = 0; i < sample; ++i) {
    /* steps of nearly the golden section do not fall in with the regular order of a generated mesh */
    const int64_t place = (int64_t)(((uint64_t)i * 2654435769u) & 0xffffffffu);
    const int64_t cell = sample == mesh->cell_count ? i : (int64_t)((double)place * 0x1p-32 * (double)mesh->cell_count);
    const double pixels = covered_pixels(mesh, camera, image, inverse, cell);
    bool hidden;
    const bool shows = can_show(shown, mesh, &values, cell, &hidden);
    if (pixels > 0.0 && !hidden) {
      const double edge = sqrt(BOX_OVER_COVERED * pixels) / PACKET_EDGE + 1.0;
      counts->passed += each * pixels;
      counts->shown += shows ? each : 0.0;
      counts->pieces += shows ? each * pixels : 0.0;
      counts->packets += shows ? each * edge * edge : 0.0;
    }
  }
  return true;
}
