/* SPDX-License-Identifier: BSD-3-Clause
 * A frame of tetrahedra before its rays march: points in the rays' coordinates (kernels/tetra_arguments.h), a line for each row and column of
 * pixels, and for each tile the border faces that may cover it. */
#include "tetra_caster.h"

#include "ray_caster.h"

#include <string.h>

/* Faces that come nearer than this to the eye's plane, in units of the largest coordinate, have no safe outline on the screen: each tile is
 * tried against their edges, which are linear in u and v whatever lies behind the eye. */
#define NEAREST_OUTLINE 0x1p-6
/* More than an edge is wrong by for the floats' sake: coordinates are below 1 (parallel: what is beyond the window need not be found). */
#define EDGE_SLACK 1e-5

/* Tiles that a face may cover: columns x0..x1, rows y0..y1; none if x0 > x1; x0 < 0: any. */
typedef struct face_rect {
  int32_t x0, x1, y0, y1;
} face_rect;

typedef struct frame_build {
  stratus_context* context;
  const stratus_tetra_mesh* tetra;
  const stratus_mesh* mesh;
  stratus_tetra_frame* frame;
  double matrix[16]; /* local -> a, b, c */
  double scale;      /* of what the floats hold; parallel: of z alone */
  bool mirrored;
  face_rect* rects;
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
  stratus_tetra_buffer* all[] = { &buffers->points, &buffers->faces, &buffers->rects, &buffers->lines, &buffers->bin_begin, &buffers->bins,
    &buffers->first, &buffers->entries };
  for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
    stratus_release(context, all[i]->memory);
    *all[i] = (stratus_tetra_buffer){ 0 };
  }
}

/* a, b, c of a local point, the eye subtracted before anything is lost. */
static stratus_status find_matrix(frame_build* build)
{
  const stratus_camera* camera = &build->frame->camera;
  const double* m = build->mesh->matrix;
  double basis[16] = { [15] = 1.0 }, inverse[16];
  for (int row = 0; row < 3; ++row) {
    basis[4 * row] = camera->right[row];
    basis[4 * row + 1] = camera->up[row];
    basis[4 * row + 2] = camera->forward[row];
  }
  if (!stratus_matrix_invert_affine(basis, inverse)) {
    return stratus_fail(build->context, STRATUS_INVALID_ARGUMENT, "camera right, up and forward lie in one plane, must not");
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

/* The middle depth, and a power of two that brings the largest coordinate into 1/2..1. */
static stratus_status find_scale(frame_build* build)
{
  const double *lo = build->tetra->lo, *hi = build->tetra->hi;
  double nearest = INFINITY, farthest = -INFINITY, largest = 0.0;
  const bool parallel = build->frame->camera.parallel != 0;
  for (int corner = 0; corner < 8; ++corner) {
    const double local[3] = { corner & 1 ? hi[0] : lo[0], corner & 2 ? hi[1] : lo[1], corner & 4 ? hi[2] : lo[2] };
    double p[3];
    stratus_matrix_point(build->matrix, local, p);
    nearest = fmin(nearest, p[2]);
    farthest = fmax(farthest, p[2]);
    largest = fmax(largest, parallel ? 0.0 : fmax(fmax(fabs(p[0]), fabs(p[1])), fabs(p[2])));
  }
  const double middle = 0.5 * (nearest + farthest);
  largest = parallel ? farthest - middle : largest;
  int exponent = 0;
  (void)frexp(largest, &exponent);
  build->scale = ldexp(1.0, -exponent);
  build->frame->middle = middle;
  build->frame->per_z = 1.0 / build->scale;
  if (!isfinite(middle) || !isfinite(largest) || !(build->scale > 0.0) || !isfinite(build->scale)) {
    return stratus_fail(build->context, STRATUS_INVALID_ARGUMENT, "mesh lies at depths %g..%g before the camera: out of range", nearest, farthest);
  }
  build->frame->arguments.middle = parallel ? 1.0f : (float)(middle * build->scale);
  build->frame->arguments.shear = parallel ? 0.0f : 1.0f;
  return STRATUS_OK;
}

static stratus_status place_points(frame_build* build, stratus_tetra_buffers* buffers)
{
  const stratus_mesh* mesh = build->mesh;
  TRY(stratus_tetra_reserve(build->context, &buffers->points, (size_t)mesh->point_count, 4 * sizeof(float)));
  float* points = buffers->points.memory;
  const float* values = build->tetra->values;
  const double scale = build->scale, lateral = build->frame->camera.parallel ? 1.0 : scale, middle = build->frame->middle;
#pragma omp parallel for num_threads(build->context->threads)
  for (int64_t i = 0; i < mesh->point_count; ++i) {
    double p[3];
    stratus_matrix_point(build->matrix, mesh->points + 3 * i, p);
    points[4 * i] = (float)(p[0] * lateral);
    points[4 * i + 1] = (float)(p[1] * lateral);
    points[4 * i + 2] = (float)((p[2] - middle) * scale);
    points[4 * i + 3] = values && isfinite(values[i]) ? values[i] : 0.0f;
  }
  build->frame->points = points;
  return STRATUS_OK;
}

/* A row's and a column's part of their rays; those beyond the picture repeat the last. */
static stratus_status place_lines(frame_build* build, stratus_tetra_buffers* buffers)
{
  stratus_tetra_frame* frame = build->frame;
  const int sides[2] = { frame->image.width, frame->image.height };
  const size_t padded[2] = { (size_t)sides[0] + TETRA_TILE + TETRA_WIDTH_MOST, (size_t)sides[1] + TETRA_TILE + TETRA_WIDTH_MOST };
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

static void face_points(const stratus_tetra_frame* frame, const stratus_tetra_face* face, double p[3][3])
{
  for (int i = 0; i < 3; ++i) {
    const float* point = frame->points + 4 * (size_t)face->point[i];
    p[i][0] = (double)point[0];
    p[i][1] = (double)point[1];
    p[i][2] = (double)frame->arguments.middle + (double)frame->arguments.shear * (double)point[2];
  }
}

/* First and last tile along a side of `pixels`, of what spans lo..hi in -1..1, a pixel more each way. False: outside. */
static bool tile_span(double lo, double hi, int pixels, int32_t span[2])
{
  const double first = floor(0.5 * (lo + 1.0) * pixels - 1.5), last = ceil(0.5 * (hi + 1.0) * pixels + 0.5);
  if (!(last >= 0.0) || !(first < pixels)) {
    return false;
  }
  span[0] = (first > 0.0 ? (int32_t)first : 0) / TETRA_TILE;
  span[1] = (last < pixels ? (int32_t)last : pixels - 1) / TETRA_TILE;
  return true;
}

static face_rect outline(const stratus_tetra_frame* frame, const stratus_tetra_face* face)
{
  const face_rect nowhere = { 1, 0, 1, 0 }, anywhere = { -1, -1, -1, -1 };
  double p[3][3], lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
  int32_t x[2], y[2];
  face_points(frame, face, p);
  const double nearest = fmin(fmin(p[0][2], p[1][2]), p[2][2]), farthest = fmax(fmax(p[0][2], p[1][2]), p[2][2]);
  if (nearest < NEAREST_OUTLINE && farthest > -NEAREST_OUTLINE) {
    return anywhere;
  }
  for (int i = 0; i < 3; ++i) {
    for (int side = 0; side < 2; ++side) {
      lo[side] = fmin(lo[side], p[i][side] / p[i][2]);
      hi[side] = fmax(hi[side], p[i][side] / p[i][2]);
    }
  }
  if (!tile_span(lo[0], hi[0], frame->image.width, x) || !tile_span(lo[1], hi[1], frame->image.height, y)) {
    return nowhere;
  }
  return (face_rect){ x[0], x[1], y[0], y[1] };
}

/* Whether some ray of the tile may pass the face turned as it is: none does if an edge is negative in all four corners. */
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

/* Counts the face in each of its tiles, or puts it there. */
static uint64_t deal_face(const frame_build* build, size_t i, uint32_t* begin, int32_t* bins)
{
  const stratus_tetra_frame* frame = build->frame;
  face_rect rect = build->rects[i];
  double p[3][3];
  const bool anywhere = rect.x0 < 0;
  uint64_t count = 0;
  if (anywhere) {
    rect = (face_rect){ 0, frame->columns - 1, 0, frame->rows - 1 };
    face_points(frame, frame->faces + i, p);
  }
  for (int row = rect.y0; row <= rect.y1; ++row) {
    for (int column = rect.x0; column <= rect.x1; ++column) {
      if (!anywhere || tile_may_meet(frame, (const double(*)[3])p, column, row)) {
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

static stratus_status bin_faces(frame_build* build, stratus_tetra_buffers* buffers)
{
  stratus_tetra_frame* frame = build->frame;
  const size_t count = build->tetra->face_count, tiles = (size_t)frame->columns * (size_t)frame->rows;
  TRY(stratus_tetra_reserve(build->context, &buffers->faces, count, sizeof(stratus_tetra_face)));
  TRY(stratus_tetra_reserve(build->context, &buffers->rects, count, sizeof(face_rect)));
  TRY(stratus_tetra_reserve(build->context, &buffers->bin_begin, tiles + 1, sizeof(uint32_t)));
  stratus_tetra_face* faces = buffers->faces.memory;
  uint32_t* begin = buffers->bin_begin.memory;
  build->rects = buffers->rects.memory;
  frame->faces = faces;
  frame->face_count = count;
#pragma omp parallel for num_threads(build->context->threads)
  for (size_t i = 0; i < count; ++i) {
    const stratus_tetra_face* face = build->tetra->faces + i;
    const int32_t* p = face->point;
    faces[i] = (stratus_tetra_face){ face->cell, { p[0], build->mirrored ? p[2] : p[1], build->mirrored ? p[1] : p[2] } };
    build->rects[i] = outline(frame, faces + i);
  }
  memset(begin, 0, (tiles + 1) * sizeof *begin);
  uint64_t total = 0;
  for (size_t i = 0; i < count && total < UINT32_MAX; ++i) {
    total += deal_face(build, i, begin, NULL);
  }
  if (total >= UINT32_MAX) {
    return stratus_fail(build->context, STRATUS_OVERFLOW, "%zu border faces cover %d x %d pixels too often", count, frame->image.width,
      frame->image.height);
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
  memmove(begin + 1, begin, tiles * sizeof *begin); /* each stands at its end now: the next one's begin */
  begin[0] = 0;
  frame->bin_begin = begin;
  frame->bins = buffers->bins.memory;
  return STRATUS_OK;
}

stratus_status stratus_tetra_frame_prepare(stratus_context* context, const stratus_tetra_mesh* tetra, const stratus_mesh* mesh,
  const stratus_camera* camera, const stratus_image* image, stratus_tetra_buffers* buffers, stratus_tetra_frame* frame)
{
  frame_build build = { .context = context, .tetra = tetra, .mesh = mesh, .frame = frame };
  memset(frame, 0, sizeof *frame);
  frame->camera = *camera;
  frame->image = *image;
  frame->columns = (image->width + TETRA_TILE - 1) / TETRA_TILE;
  frame->rows = (image->height + TETRA_TILE - 1) / TETRA_TILE;
  frame->cells = tetra->cells;
  frame->arguments.stride = tetra->stride;
  frame->arguments.cell_values = tetra->values == NULL;
  frame->arguments.steps_most = (int)(tetra->cell_count + 1);
  TRY(find_matrix(&build));
  TRY(find_scale(&build));
  TRY(place_points(&build, buffers));
  TRY(place_lines(&build, buffers));
  return bin_faces(&build, buffers);
}
