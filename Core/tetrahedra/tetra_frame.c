/* SPDX-License-Identifier: BSD-3-Clause
 * Prepares a frame of tetrahedra: points in the rays' coordinates (kernels/tetrahedra/tetra_arguments.h), the rays' parts by row and
 * column of pixels, and for each tile the border faces that may cover it. */
#include "tetra_caster.h"

#include "camera.h"
#include "mesh.h"
#include "vector.h"
#include "matrix.h"

#include <string.h>

/* Faces that come nearer than this to the eye's plane, in units of the largest coordinate, have no safe outline on the screen. Their edge
 * functions are tested in each tile instead, because these are linear in u and v even for points behind the eye. */
#define NEAREST_OUTLINE 0x1p-6
/* Exceeds the float error of an edge function: coordinates are below 1 (parallel: larger ones lie beyond the window and do not matter). */
#define EDGE_SLACK 1e-5
#define RIGHT_ANGLE 0x1p-50 /* cosines below it are rounding errors */

typedef struct frame_build {
  stratus_context* context;
  const stratus_tetra_mesh* tetra;
  const stratus_mesh* mesh;
  stratus_tetra_frame* frame;
  double matrix[16]; /* local -> a, b, c */
  double scale;      /* from a, b, c to the floats' coordinates; parallel: only of z */
  bool mirrored;
  stratus_tetra_border_face* faces;
} frame_build;

stratus_status stratus_tetra_reserve(stratus_context* context, stratus_tetra_buffer* buffer, size_t count, size_t size)
{
  size_t bytes = 0;
  void* memory = NULL;
  TRY(stratus_product(context, "bytes of a frame", count, size, 1, &bytes));
  if (buffer->memory && bytes <= buffer->bytes) {
    return STRATUS_OK;
  }
  stratus_release(context, buffer->memory);
  *buffer = (stratus_tetra_buffer){ 0 };
  TRY(stratus_allocate(context, bytes, 1, &memory));
  *buffer = (stratus_tetra_buffer){ memory, bytes };
  return STRATUS_OK;
}

void stratus_tetra_buffers_release(stratus_context* context, stratus_tetra_buffers* buffers)
{
  stratus_tetra_buffer* all[] = { &buffers->points, &buffers->places, &buffers->faces, &buffers->lines, &buffers->ends, &buffers->bin_begin,
    &buffers->bins, &buffers->first, &buffers->entries };
  for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
    stratus_release(context, all[i]->memory);
    *all[i] = (stratus_tetra_buffer){ 0 };
  }
  buffers->placed = buffers->binned = false;
}

/* Returns the component of a parallel camera's right or up along forward, in units of forward. Rounding errors of a right angle give 0. */
static double lean_of(const double side[3], const double forward[3])
{
  const double along = stratus_vector_dot(side, forward), square = stratus_vector_dot(forward, forward);
  return fabs(along) > RIGHT_ANGLE * sqrt(stratus_vector_dot(side, side) * square) ? along / square : 0.0;
}

/* Finds the basis of a, b and c. Perspective: the camera's own. Parallel: k may count from any point of a ray, so it counts from a plane
 * perpendicular to the rays. A sheared camera's right and up then do not add the mesh's width to its depth. */
static void find_basis(frame_build* build, double basis[16])
{
  stratus_tetra_frame* frame = build->frame;
  const stratus_camera* camera = &frame->camera;
  const double* sides[2] = { camera->right, camera->up };
  for (int side = 0; side < 2; ++side) {
    frame->lean[side] = camera->parallel ? lean_of(sides[side], camera->forward) : 0.0;
  }
  for (int row = 0; row < 3; ++row) {
    basis[4 * row] = camera->right[row] - frame->lean[0] * camera->forward[row];
    basis[4 * row + 1] = camera->up[row] - frame->lean[1] * camera->forward[row];
    basis[4 * row + 2] = camera->forward[row];
  }
}

/* Finds the matrix from local coordinates to a, b and c. Subtracting the eye first avoids cancellation. */
static stratus_status find_matrix(frame_build* build)
{
  const stratus_camera* camera = &build->frame->camera;
  const double* m = build->mesh->matrix;
  double basis[16] = { [15] = 1.0 }, inverse[16];
  find_basis(build, basis);
  if (!stratus_matrix_invert_affine(basis, inverse)) {
    return stratus_fail(build->context, STRATUS_INVALID_ARGUMENT, "camera right, up and forward are in one plane, must not be");
  }
  double* t = build->matrix;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      t[4 * row + column] = 0.0;
      for (int i = 0; i < 3; ++i) {
        t[4 * row + column] += inverse[4 * row + i] * (m[4 * i + column] - (column == 3 ? camera->eye[i] : 0.0));
      }
    }
  }
  t[15] = 1.0;
  build->mirrored = t[0] * (t[5] * t[10] - t[6] * t[9]) - t[1] * (t[4] * t[10] - t[6] * t[8]) + t[2] * (t[4] * t[9] - t[5] * t[8]) < 0.0;
  return STRATUS_OK;
}

/* Refuses a mesh whose numbers exceed the range of floats: world lengths along rays and the optical depths over them; parallel: also edges
 * of faces (products of two coordinates in half windows) times values. *largest is in units of forward. A flat mesh perpendicular to
 * forward is not drawn, but not refused either. */
static stratus_status check_reach(const frame_build* build, double size, double across, double* largest)
{
  const stratus_tetra_frame* frame = build->frame;
  const stratus_camera* c = &frame->camera;
  const double unit = sqrt(stratus_vector_dot(c->forward, c->forward)), lean = fmax(fabs(frame->lean[0]), fabs(frame->lean[1]));
  const double reach = unit * fmax(fmax(*largest, fabs(frame->middle)), lean);
  const double wide = sqrt(fmax(stratus_vector_dot(c->right, c->right), stratus_vector_dot(c->up, c->up))) / unit;
  if (!(reach <= STRATUS_TETRA_REACH)) {
    return stratus_fail(build->context, STRATUS_INVALID_ARGUMENT,
      "mesh reaches %g from the camera, or as far in units of its right and up, must be at most %g", reach, STRATUS_TETRA_REACH);
  }
  if (!(size == 0.0 || size >= 1.0 / STRATUS_TETRA_REACH)) {
    return stratus_fail(build->context, STRATUS_INVALID_ARGUMENT, "mesh is %g long in the world, must be at least %g, or else a point",
      size, 1.0 / STRATUS_TETRA_REACH);
  }
  if (c->parallel && !(across <= STRATUS_TETRA_WINDOWS)) {
    return stratus_fail(build->context, STRATUS_INVALID_ARGUMENT,
      "mesh reaches %g half widths of the parallel camera's window from its middle, must be at most %g", across, STRATUS_TETRA_WINDOWS);
  }
  if (!c->parallel && !(wide <= STRATUS_TETRA_WINDOWS)) {
    return stratus_fail(build->context, STRATUS_INVALID_ARGUMENT, "camera right or up is %g times as long as forward, must be at most %g",
      wide, STRATUS_TETRA_WINDOWS);
  }
  *largest = fmax(*largest, fmax(1.0 / unit, lean) / STRATUS_TETRA_REACH); /* so that a lean in units of *largest is a float */
  return STRATUS_OK;
}

/* Finds the middle depth, and the power of two that scales the largest coordinate into 1/2..1. */
static stratus_status find_scale(frame_build* build)
{
  const double *lo = build->tetra->lo, *hi = build->tetra->hi;
  double nearest = INFINITY, farthest = -INFINITY, largest = 0.0, across = 0.0, size = 0.0, unknown = 0.0;
  const bool parallel = build->frame->camera.parallel != 0;
  for (int corner = 0; corner < 8; ++corner) {
    const double local[3] = { corner & 1 ? hi[0] : lo[0], corner & 2 ? hi[1] : lo[1], corner & 4 ? hi[2] : lo[2] };
    const double diagonal[3] = { corner & 1 ? hi[0] - lo[0] : 0.0, corner & 2 ? hi[1] - lo[1] : 0.0, corner & 4 ? hi[2] - lo[2] : 0.0 };
    double p[3], q[3];
    stratus_matrix_vector(build->mesh->matrix, diagonal, q);
    size = fmax(size, fmax(fmax(fabs(q[0]), fabs(q[1])), fabs(q[2])));
    stratus_matrix_point(build->matrix, local, p);
    unknown += 0.0 * (p[0] + p[1] + p[2]); /* NaN if any is not finite, which fmin and fmax would ignore */
    nearest = fmin(nearest, p[2]);
    farthest = fmax(farthest, p[2]);
    across = fmax(across, fmax(fabs(p[0]), fabs(p[1])));
    largest = fmax(largest, parallel ? 0.0 : fmax(across, fabs(p[2])));
  }
  const double middle = 0.5 * (nearest + farthest);
  largest = !isfinite(unknown) ? INFINITY : parallel ? farthest - middle : largest;
  build->frame->middle = middle;
  TRY(check_reach(build, size, across, &largest));
  int exponent = 0;
  (void)frexp(largest, &exponent);
  build->scale = ldexp(1.0, -exponent);
  build->frame->per_z = 1.0 / build->scale;
  build->frame->arguments.middle = parallel ? 1.0f : (float)(middle * build->scale);
  build->frame->arguments.shear = parallel ? 0.0f : 1.0f;
  double basis[16];
  find_basis(build, basis);
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) {
      build->frame->basis[row][axis] = basis[4 * axis + row] * (parallel && row < 2 ? 1.0 : build->frame->per_z);
    }
  }
  return STRATUS_OK;
}

static inline float shown_value(float value)
{
  return isfinite(value) ? value : 0.0f;
}

static void place_point(const frame_build* build, const double at[3], float value, float point[4])
{
  const double scale = build->scale, lateral = build->frame->camera.parallel ? 1.0 : scale;
  double p[3];
  stratus_matrix_point(build->matrix, at, p);
  point[0] = (float)(p[0] * lateral);
  point[1] = (float)(p[1] * lateral);
  point[2] = (float)((p[2] - build->frame->middle) * scale);
  point[3] = shown_value(value);
}

/* Stores other values of points that stay where they are. */
static void store_values(const frame_build* build, stratus_tetra_buffers* buffers)
{
  const stratus_tetra_mesh* tetra = build->tetra;
  float *points = buffers->points.memory, *places = buffers->places.memory;
  const int parts = tetra->names ? 1 : tetra->lattices;
  for (int part = 0; part < parts; ++part) { /* not the numbers of no point, between lattices */
    const int64_t first = tetra->names ? 0 : tetra->first[part];
    const int64_t beyond = tetra->names ? tetra->point_count : first + stratus_mesh_part(build->mesh, part)->point_count;
#pragma omp parallel for num_threads(build->context->threads)
    for (int64_t i = first; i < beyond; ++i) {
      const float value = tetra->values ? shown_value(tetra->values[i]) : 0.0f;
      if (tetra->names) {
        points[4 * i + 3] = value;
      }
      places[4 * (tetra->names ? (int64_t)tetra->names[i] : i) + 3] = value;
    }
  }
}

/* The points of lattices keep their order. No cell that shows has a point beyond the bounds, but floats cannot hold all of those. */
static stratus_status place_lattices(frame_build* build, stratus_tetra_buffers* buffers)
{
  const stratus_tetra_mesh* tetra = build->tetra;
  TRY(stratus_tetra_reserve(build->context, &buffers->places, (size_t)tetra->point_count, 4 * sizeof(float)));
  float* places = buffers->places.memory;
  for (int part = 0; part < tetra->lattices; ++part) {
    const stratus_mesh* mesh = stratus_mesh_part(build->mesh, part);
    const int64_t first = tetra->first[part], beyond = first + mesh->point_count;
#pragma omp parallel for num_threads(build->context->threads)
    for (int64_t i = first; i < beyond; ++i) {
      double p[3];
      stratus_mesh_point(mesh, i - first, p);
      for (int axis = 0; axis < 3; ++axis) { /* also where p is not a number */
        p[axis] = p[axis] > tetra->lo[axis] ? (p[axis] < tetra->hi[axis] ? p[axis] : tetra->hi[axis]) : tetra->lo[axis];
      }
      place_point(build, p, tetra->values ? tetra->values[i] : 0.0f, places + 4 * i);
    }
    memset(places + 4 * beyond, 0, (size_t)(tetra->first[part + 1] - beyond) * 4 * sizeof *places); /* numbers of no point */
  }
  return STRATUS_OK;
}

static stratus_status place_listed(frame_build* build, stratus_tetra_buffers* buffers)
{
  const stratus_mesh* mesh = build->mesh;
  TRY(stratus_tetra_reserve(build->context, &buffers->points, (size_t)mesh->point_count, 4 * sizeof(float)));
  TRY(stratus_tetra_reserve(build->context, &buffers->places, (size_t)mesh->point_count, 4 * sizeof(float)));
  float *points = buffers->points.memory, *places = buffers->places.memory;
  const float* values = build->tetra->values;
#pragma omp parallel for num_threads(build->context->threads)
  for (int64_t i = 0; i < mesh->point_count; ++i) {
    place_point(build, mesh->points + 3 * i, values ? values[i] : 0.0f, points + 4 * i);
    memcpy(places + 4 * (size_t)build->tetra->names[i], points + 4 * i, 4 * sizeof *points);
  }
  return STRATUS_OK;
}

/* Whether points stay where the frame before has them, whose mesh is the same; faces then do as well. */
static bool stays_placed(const frame_build* build, stratus_tetra_buffers* buffers)
{
  const stratus_image* image = &build->frame->image;
  stratus_tetra_placement now = { .scale = build->scale, .middle = build->frame->middle, .parallel = build->frame->camera.parallel };
  stratus_tetra_placement* before = &buffers->placement;
  memcpy(now.matrix, build->matrix, sizeof now.matrix);
  now.width = image->width;
  now.height = image->height;
  const bool stays = buffers->placed && memcmp(before->matrix, now.matrix, sizeof now.matrix) == 0 && before->scale == now.scale &&
    before->middle == now.middle && before->parallel == now.parallel;
  buffers->placed = stays;
  buffers->binned = stays && buffers->binned && before->width == now.width && before->height == now.height;
  *before = now;
  return stays;
}

static stratus_status place_points(frame_build* build, stratus_tetra_buffers* buffers)
{
  if (stays_placed(build, buffers)) {
    store_values(build, buffers);
  } else {
    TRY((build->tetra->names ? place_listed : place_lattices)(build, buffers));
    buffers->placed = true;
  }
  build->frame->points = build->tetra->names ? buffers->points.memory : NULL;
  build->frame->places = buffers->places.memory;
  return STRATUS_OK;
}

/* Store the parts of rays that depend only on the column or only on the row. The padding beyond the image repeats the last ones. */
static stratus_status place_lines(frame_build* build, stratus_tetra_buffers* buffers)
{
  stratus_tetra_frame* frame = build->frame;
  const int sides[2] = { frame->image.width, frame->image.height };
  const size_t padded[2] = { (size_t)sides[0] + TETRA_PADDING, (size_t)sides[1] + TETRA_PADDING };
  TRY(stratus_tetra_reserve(build->context, &buffers->lines, 2 * (padded[0] + padded[1]), sizeof(float)));
  float* lines = buffers->lines.memory;
  float* places[2][2] = { { lines, lines + padded[0] }, { lines + 2 * padded[0], lines + 2 * padded[0] + padded[1] } };
  const bool parallel = frame->camera.parallel != 0;
  for (int side = 0; side < 2; ++side) {
    for (size_t i = 0; i < padded[side]; ++i) {
      const double u = (2.0 * (double)(i < (size_t)sides[side] ? i : (size_t)sides[side] - 1) + 1.0) / sides[side] - 1.0;
      places[side][0][i] = parallel ? 0.0f : (float)u;
      places[side][1][i] = (float)(parallel ? u : u * (frame->middle * build->scale));
    }
  }
  frame->us = places[0][0];
  frame->uw = places[0][1];
  frame->vs = places[1][0];
  frame->vw = places[1][1];
  return STRATUS_OK;
}

/* Sets the visible part of rays in z, from the near plane to the far plane or to opaque geometry, and their world lengths. */
static stratus_status place_ends(frame_build* build, stratus_tetra_buffers* buffers)
{
  stratus_tetra_frame* frame = build->frame;
  stratus_tetra_arguments* a = &frame->arguments;
  const stratus_camera* c = &frame->camera;
  const stratus_image* image = &frame->image;
  const double *f = c->forward, *r = c->right, *u = c->up, square = stratus_vector_dot(f, f);
  const double products[6] = { square, 2.0 * stratus_vector_dot(f, r), 2.0 * stratus_vector_dot(f, u), stratus_vector_dot(r, r),
    2.0 * stratus_vector_dot(r, u), stratus_vector_dot(u, u) };
  for (int i = 0; i < 6; ++i) { /* parallel rays all have the length of forward */
    a->square[i] = c->parallel && i > 0 ? 0.0f : (float)(products[i] / square);
  }
  for (int side = 0; side < 2; ++side) {
    a->lean[side] = (float)(frame->lean[side] / frame->per_z);
  }
  a->per_z = (float)(sqrt(square) * frame->per_z);
  a->per_frame = (float)(sqrt(square) * frame->middle);
  a->begin = (float)((c->near_k - frame->middle) / frame->per_z);
  a->end = (float)fmin((c->far_k - frame->middle) / frame->per_z, 1e30);
  a->has_ends = image->opaque_depth != NULL;
  if (!image->opaque_depth) {
    return STRATUS_OK;
  }
  const size_t pixels = (size_t)image->width * (size_t)image->height;
  TRY(stratus_tetra_reserve(build->context, &buffers->ends, pixels, sizeof(float)));
  float* ends = buffers->ends.memory;
#pragma omp parallel for num_threads(build->context->threads)
  for (size_t i = 0; i < pixels; ++i) {
    const double end = stratus_camera_place(c, (double)image->opaque_depth[i]);
    const double from = stratus_tetra_middle(frame, (int)(i % (size_t)image->width), (int)(i / (size_t)image->width));
    ends[i] = (float)fmin((end - from) / frame->per_z, 1e30);
  }
  frame->ends = ends;
  return STRATUS_OK;
}

static void face_points(const stratus_tetra_frame* frame, const stratus_tetra_face* face, double p[3][3])
{
  for (int i = 0; i < 3; ++i) {
    const float* point = frame->places + 4 * (size_t)face->point[i];
    p[i][0] = (double)point[0];
    p[i][1] = (double)point[1];
    p[i][2] = (double)frame->arguments.middle + (double)frame->arguments.shear * (double)point[2];
  }
}

/* Finds the first and last pixel that lo..hi covers, one more on each side; -1..1 spans `pixels`. Returns false if there is none. */
static bool pixel_span(double lo, double hi, int pixels, uint16_t span[2])
{
  const double first = floor(0.5 * (lo + 1.0) * pixels - 1.5), last = ceil(0.5 * (hi + 1.0) * pixels + 0.5);
  if (!(last >= 0.0) || !(first < pixels)) {
    return false;
  }
  span[0] = (uint16_t)(first > 0.0 ? (int)first : 0);
  span[1] = (uint16_t)(last < pixels ? (int)last : pixels - 1);
  return true;
}

/* Whether rays surely leave the mesh by this face and never enter: its points turn the other way, seen from the eye. The determinant is the
 * sum of edges times depths, which are positive in front of the eye. Each edge's error is below a millionth of the face's extent. */
static bool faces_away(const double p[3][3])
{
  double extent = 0.0;
  for (int i = 0; i < 3; ++i) {
    extent = fmax(extent, fmax(fmax(fabs(p[1][i] - p[0][i]), fabs(p[2][i] - p[0][i])), fabs(p[2][i] - p[1][i])));
  }
  const double *a = p[0], b[3] = { p[1][0] - a[0], p[1][1] - a[1], p[1][2] - a[2] },
               c[3] = { p[2][0] - a[0], p[2][1] - a[1], p[2][2] - a[2] };
  const double det = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  return det < -1e-6 * extent;
}

/* Finds the pixels that a face may cover. Returns false if there are none. */
static bool outline(const stratus_tetra_frame* frame, stratus_tetra_border_face* face)
{
  double p[3][3], lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
  face_points(frame, &face->face, p);
  const double nearest = fmin(fmin(p[0][2], p[1][2]), p[2][2]), farthest = fmax(fmax(p[0][2], p[1][2]), p[2][2]);
  face->anywhere = nearest < NEAREST_OUTLINE && farthest > -NEAREST_OUTLINE;
  if (face->anywhere) {
    return true;
  }
  for (int i = 0; i < 3; ++i) {
    for (int side = 0; side < 2; ++side) {
      lo[side] = fmin(lo[side], p[i][side] / p[i][2]);
      hi[side] = fmax(hi[side], p[i][side] / p[i][2]);
    }
  }
  return !(nearest > 0.0 && faces_away((const double(*)[3])p)) && pixel_span(lo[0], hi[0], frame->image.width, face->columns) &&
    pixel_span(lo[1], hi[1], frame->image.height, face->rows);
}

/* Whether some ray of the tile may enter by the face. None does if one edge function is negative in all four corners of the tile. */
static bool tile_may_meet(const stratus_tetra_frame* frame, const double p[3][3], int column, int row)
{
  const double u0 = 2.0 * (column * TETRA_TILE) / frame->image.width - 1.0, u1 = u0 + 2.0 * TETRA_TILE / frame->image.width;
  const double v0 = 2.0 * (row * TETRA_TILE) / frame->image.height - 1.0, v1 = v0 + 2.0 * TETRA_TILE / frame->image.height;
  for (int i = 0; i < 3; ++i) {
    const double *a = p[i], *b = p[(i + 1) % 3];
    const double constant = a[0] * b[1] - a[1] * b[0], by_u = a[1] * b[2] - a[2] * b[1], by_v = a[2] * b[0] - a[0] * b[2];
    if (constant + fmax(u0 * by_u, u1 * by_u) + fmax(v0 * by_v, v1 * by_v) < -EDGE_SLACK) {
      return false;
    }
  }
  return true;
}

/* Counts the face in each tile that it may cover and, unless bins is NULL, stores it there. */
static uint64_t deal_face(const frame_build* build, size_t i, uint32_t* begin, int32_t* bins)
{
  const stratus_tetra_frame* frame = build->frame;
  const stratus_tetra_border_face* face = build->faces + i;
  int columns[2] = { face->columns[0] / TETRA_TILE, face->columns[1] / TETRA_TILE };
  int rows[2] = { face->rows[0] / TETRA_TILE, face->rows[1] / TETRA_TILE };
  double p[3][3] = { { 0.0 } };
  uint64_t count = 0;
  if (face->anywhere) {
    columns[0] = rows[0] = 0;
    columns[1] = frame->columns - 1;
    rows[1] = frame->rows - 1;
    face_points(frame, &face->face, p);
  }
  for (int row = rows[0]; row <= rows[1]; ++row) {
    for (int column = columns[0]; column <= columns[1]; ++column) {
      if (!face->anywhere || tile_may_meet(frame, (const double(*)[3])p, column, row)) {
        const int tile = row * frame->columns + column;
        if (bins) {
          bins[begin[tile]] = (int32_t)i;
        }
        ++begin[tile];
        ++count;
      }
    }
  }
  return count;
}

static stratus_status find_bins(frame_build* build, stratus_tetra_buffers* buffers)
{
  const stratus_tetra_frame* frame = build->frame;
  const size_t count = build->tetra->face_count, tiles = (size_t)frame->columns * (size_t)frame->rows;
  TRY(stratus_tetra_reserve(build->context, &buffers->faces, count, sizeof(stratus_tetra_border_face)));
  TRY(stratus_tetra_reserve(build->context, &buffers->bin_begin, tiles + 1, sizeof(uint32_t)));
  stratus_tetra_border_face* faces = buffers->faces.memory;
  uint32_t* begin = buffers->bin_begin.memory;
  build->faces = faces;
#pragma omp parallel for num_threads(build->context->threads)
  for (size_t i = 0; i < count; ++i) {
    const stratus_tetra_face* face = build->tetra->faces + i;
    const int32_t* p = face->point;
    faces[i] =
      (stratus_tetra_border_face){ .face = { { p[0], p[build->mirrored ? 2 : 1], p[build->mirrored ? 1 : 2] }, face->fourth, face->cell } };
    if (!outline(frame, faces + i)) {
      faces[i].columns[0] = UINT16_MAX; /* covers no pixel */
      faces[i].columns[1] = 0;
    }
  }
  memset(begin, 0, (tiles + 1) * sizeof *begin);
  uint64_t total = 0;
  for (size_t i = 0; i < count && total < UINT32_MAX; ++i) {
    total += deal_face(build, i, begin, NULL);
  }
  if (total >= UINT32_MAX) {
    return stratus_fail(
      build->context, STRATUS_OVERFLOW, "%zu border faces cover %d x %d pixels too often", count, frame->image.width, frame->image.height);
  }
  TRY(stratus_tetra_reserve(build->context, &buffers->bins, (size_t)total, sizeof(int32_t)));
  uint32_t place = 0;
  for (size_t tile = 0; tile <= tiles; ++tile) {
    const uint32_t here = tile < tiles ? begin[tile] : 0;
    begin[tile] = place;
    place += here;
  }
  for (size_t i = 0; i < count; ++i) {
    (void)deal_face(build, i, begin, buffers->bins.memory);
  }
  memmove(begin + 1, begin, tiles * sizeof *begin); /* each begin has advanced to its bin's end, the next bin's begin */
  begin[0] = 0;
  buffers->binned = true;
  return STRATUS_OK;
}

static stratus_status bin_faces(frame_build* build, stratus_tetra_buffers* buffers)
{
  if (!buffers->binned) {
    TRY(find_bins(build, buffers));
  }
  build->frame->faces = buffers->faces.memory;
  build->frame->face_count = build->tetra->face_count;
  build->frame->bin_begin = buffers->bin_begin.memory;
  build->frame->bins = buffers->bins.memory;
  return STRATUS_OK;
}

stratus_status stratus_tetra_frame_prepare(stratus_context* context, const stratus_tetra_mesh* tetra, const stratus_mesh* mesh,
  const stratus_camera* camera, const stratus_image* image, bool march, stratus_tetra_buffers* buffers, stratus_tetra_frame* frame)
{
  frame_build build = { .context = context, .tetra = tetra, .mesh = mesh, .frame = frame };
  memset(frame, 0, sizeof *frame);
  frame->camera = *camera;
  frame->image = *image;
  frame->columns = (image->width + TETRA_TILE - 1) / TETRA_TILE;
  frame->rows = (image->height + TETRA_TILE - 1) / TETRA_TILE;
  if ((int64_t)frame->columns * frame->rows > INT32_MAX / (TETRA_TILE * TETRA_TILE)) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "image of %d x %d pixels is too large to draw tetrahedra in: at most %d pixels",
      image->width, image->height, INT32_MAX);
  }
  frame->cells = tetra->turns ? (const int32_t*)tetra->turns : tetra->cells;
  frame->cell_values = tetra->cell_values;
  frame->arguments.picture.width = image->width;
  frame->arguments.picture.height = image->height;
  frame->arguments.columns = frame->columns;
  frame->arguments.cell_values = tetra->values == NULL;
  frame->arguments.lattice = tetra->names ? 0 : tetra->turns ? TETRA_LATTICE_TURNS : TETRA_LATTICE;
  frame->arguments.steps_most = (int)(tetra->cell_count + 1);
  TRY(find_matrix(&build));
  TRY(find_scale(&build));
  TRY(place_points(&build, buffers));
  TRY(place_lines(&build, buffers));
  TRY(place_ends(&build, buffers));
  return march ? bin_faces(&build, buffers) : STRATUS_OK;
}
