/* SPDX-License-Identifier: BSD-3-Clause
 * Chooses between march and projection by their estimated cost for a view. A sample of the cells gives counts of cells, pixels and
 * segments. Earlier frames have no influence, so a still camera never changes the method. */
#include "tetra_caster.h"

#include "mesh.h"
#include "matrix.h"

#include <stdio.h>

/* Cells in the sample. Its counts are right to some percent, and it takes less than a tenth of a millisecond. */
#define SAMPLE 2048

/* Nanoseconds of one core, measured on three meshes of 190 to 860 thousand cells at 512 x 512. March: per cell that a ray passes.
 * Projection: per piece composited, packet of pixels tested, cell in view, cell sorted. Only the ratios matter. */
#define MARCH_SEGMENT 7.5
#define PROJECT_PIECE 6.0
#define PROJECT_PACKET 14.0
#define PROJECT_CELL 90.0
#define PROJECT_SORT 70.0
/* Area of a convex body's bounding rectangle on the screen over the area that the body covers, averaged over directions. */
#define BOX_OVER_COVERED 2.5
#define PACKET_EDGE 4.0

const char* stratus_tetra_method_name(stratus_tetra_method method)
{
  static const char* const names[] = { "auto", "march", "project" };
  return (unsigned)method < sizeof names / sizeof *names ? names[method] : "unknown";
}

typedef struct view_counts {
  double passed;                 /* cells that rays pass, counted once per ray */
  double shown, pieces, packets; /* cells in view that can show something, their pieces and packets */
} view_counts;

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

static bool can_show(const stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_volume* values, int64_t cell, bool* hidden)
{
  float lo = INFINITY, hi = -INFINITY;
  *hidden = mesh->hidden && mesh->hidden[cell];
  for (int i = 0; i < 4; ++i) {
    const float value = caster->mesh->values ? caster->mesh->values[mesh->vertices[4 * cell + i]]
                                             : stratus_volume_fetch(values, caster->mesh->bias, (size_t)cell);
    *hidden = *hidden || !isfinite(value);
    lo = fminf(lo, value);
    hi = fmaxf(hi, value);
  }
  return !*hidden && (caster->mode == STRATUS_TETRA_MAXIMUM || stratus_table_shows(caster->table, lo, hi));
}

static void count_view(const stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_camera* camera,
  const stratus_image* image, const double inverse[16], view_counts* counts)
{
  const int64_t sample = mesh->cell_count < SAMPLE ? mesh->cell_count : SAMPLE;
  const double each = (double)mesh->cell_count / (double)sample;
  const stratus_volume values = stratus_mesh_values(mesh);
  for (int64_t i = 0; i < sample; ++i) {
    /* steps of nearly the golden section do not fall in with the regular order of a generated mesh */
    const int64_t place = (int64_t)(((uint64_t)i * 2654435769u) & 0xffffffffu);
    const int64_t cell = sample == mesh->cell_count ? i : (int64_t)((double)place * 0x1p-32 * (double)mesh->cell_count);
    const double pixels = covered_pixels(mesh, camera, image, inverse, cell);
    bool hidden;
    const bool shows = can_show(caster, mesh, &values, cell, &hidden);
    if (pixels > 0.0 && !hidden) {
      const double edge = sqrt(BOX_OVER_COVERED * pixels) / PACKET_EDGE + 1.0;
      counts->passed += each * pixels;
      counts->shown += shows ? each : 0.0;
      counts->pieces += shows ? each * pixels : 0.0;
      counts->packets += shows ? each * edge * edge : 0.0;
    }
  }
}

stratus_tetra_method stratus_tetra_choose(const stratus_tetra_caster* caster, const stratus_mesh* mesh, const stratus_camera* camera,
  const stratus_tetra_options* options, const stratus_image* image, char* why, size_t capacity)
{
  double basis[16] = { [15] = 1.0 }, inverse[16];
  view_counts counts = { 0 };
  if (options->method != STRATUS_TETRA_METHOD_AUTO) {
    snprintf(why, capacity, "%s as asked", stratus_tetra_method_name(options->method));
    return options->method;
  }
  for (int row = 0; row < 3; ++row) {
    basis[4 * row] = camera->right[row];
    basis[4 * row + 1] = camera->up[row];
    basis[4 * row + 2] = camera->forward[row];
  }
  if (caster->context->device || !stratus_matrix_invert_affine(basis, inverse)) {
    snprintf(why, capacity, "march: devices march only");
    return STRATUS_TETRA_METHOD_MARCH;
  }
  count_view(caster, mesh, camera, image, inverse, &counts);
  const double sorted = options->mode == STRATUS_TETRA_MAXIMUM ? 0.0 : (double)mesh->cell_count;
  const double march = MARCH_SEGMENT * counts.passed;
  const double project =
    PROJECT_PIECE * counts.pieces + PROJECT_PACKET * counts.packets + PROJECT_CELL * counts.shown + PROJECT_SORT * sorted;
  const stratus_tetra_method method = project < march ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_MARCH;
  snprintf(why, capacity,
    "%s: some %.2g million cells to be passed by rays, against %.2g million pieces of %.2g million cells, %.2g million sorted",
    stratus_tetra_method_name(method), 1e-6 * counts.passed, 1e-6 * counts.pieces, 1e-6 * counts.shown, 1e-6 * sorted);
  return method;
}
