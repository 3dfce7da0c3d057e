/* SPDX-License-Identifier: BSD-3-Clause
 * Finds how far light goes before it meets an opaque surface: each triangle is drawn into a picture of depths as the light sees it
 * (Williams 1978). Between nodes, the share of those that are lit counts (Reeves, Salesin & Cook 1987). */
#include "light_surfaces.h"

#include "tiles.h"
#include "vector.h"

#define NEAR 1e-9        /* of a position's reach; what is nearer to it hides nothing */
#define EDGE 1e-9        /* of a step of nodes: neighbouring triangles leave no gap between them */
#define BANDS_A_THREAD 4 /* of rows, so that no thread waits long for another */
#define EACH 5           /* so many rows and columns of nodes have one that is compared */

stratus_status stratus_surfaces_check(stratus_context* context, const stratus_surfaces* surfaces)
{
  const size_t count = surfaces ? surfaces->triangle_count : 0;
  if (count > 0 && !surfaces->points) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "surfaces of %zu triangles have no points", count);
  }
  for (size_t i = 0; i < 9 * count; ++i) {
    if (!isfinite(surfaces->points[i])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "triangle %zu of the surfaces has the coordinate %g, must be finite", i / 9,
        surfaces->points[i]);
    }
  }
  return STRATUS_OK;
}

/* ---- drawing */

typedef struct drawing {
  const stratus_light_frame* frame;
  const stratus_surfaces* surfaces;
  const stratus_light_depths* depths;
  double step[2]; /* between nodes, in the light's coordinates */
  int rows;       /* of a band */
} drawing;

/* Draws the part of a triangle that is in some rows of a face. p: corners in steps of nodes, and 1 / depth in perspective, else the depth,
 * which is linear in the picture. */
static void draw_triangle(const drawing* d, float* face, double p[3][3], int first, int beyond)
{
  const int* n = d->depths->size;
  double lo[2], hi[2];
  for (int axis = 0; axis < 2; ++axis) {
    lo[axis] = fmax(fmin(fmin(p[0][axis], p[1][axis]), p[2][axis]) - EDGE, axis ? first : 0);
    hi[axis] = fmin(fmax(fmax(p[0][axis], p[1][axis]), p[2][axis]) + EDGE, (axis ? beyond : n[0]) - 1);
  }
  const double area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
  if (!(lo[0] <= hi[0] && lo[1] <= hi[1]) || area == 0.0) {
    return;
  }
  double edge[3]; /* the weight that a distance of EDGE is, of each corner */
  for (int i = 0; i < 3; ++i) {
    const double *a = p[(i + 1) % 3], *b = p[(i + 2) % 3];
    edge[i] = EDGE * sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1])) / fabs(area);
  }
  for (int y = (int)ceil(lo[1]); y <= (int)floor(hi[1]); ++y) {
    for (int x = (int)ceil(lo[0]); x <= (int)floor(hi[0]); ++x) {
      double sum = 0.0;
      bool inside = true;
      for (int i = 0; i < 3 && inside; ++i) {
        const double *a = p[(i + 1) % 3], *b = p[(i + 2) % 3];
        const double weight = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
        inside = weight >= -edge[i];
        sum += weight * p[i][2];
      }
      if (inside) {
        float* depth = face + (size_t)y * (size_t)n[0] + (size_t)x;
        *depth = fminf(*depth, (float)(d->frame->perspective ? 1.0 / fmax(sum, 1e-30) : sum));
      }
    }
  }
}

/* Takes a point in the light's coordinates, of which `along` is above 0 in perspective, to steps of nodes. */
static void to_nodes(const drawing* d, const double q[3], double p[3])
{
  const stratus_light_frame* f = d->frame;
  const double nearer = f->perspective ? 1.0 / q[2] : 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    p[axis] = (q[axis] * nearer - f->lo[axis]) / d->step[axis];
  }
  p[2] = f->perspective ? nearer : q[2];
}

/* Draws a triangle, of which perspective sees the part in front of the light. */
static void draw_corners(const drawing* d, float* face, double q[3][3], int first, int beyond)
{
  const double near = d->frame->perspective ? NEAR * d->frame->hi[2] : -(double)INFINITY;
  double part[4][3], p[3][3];
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    const double *a = q[i], *b = q[(i + 1) % 3];
    if (a[2] > near) {
      to_nodes(d, a, part[count++]);
    }
    if ((a[2] > near) != (b[2] > near)) {
      const double s = (near - a[2]) / (b[2] - a[2]);
      const double cut[3] = { a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), near };
      to_nodes(d, cut, part[count++]);
    }
  }
  for (int i = 1; i + 1 < count; ++i) {
    memcpy(p[0], part[0], sizeof p[0]);
    memcpy(p[1], part[i], sizeof p[1]);
    memcpy(p[2], part[i + 1], sizeof p[2]);
    draw_triangle(d, face, p, first, beyond);
  }
}

static void draw_band(const void* data, int band, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const drawing* d = data;
  const int *n = d->depths->size, bands = (n[1] + d->rows - 1) / d->rows, number = band / bands;
  const int first = band % bands * d->rows, beyond = first + d->rows < n[1] ? first + d->rows : n[1];
  float* face = d->depths->depth + (size_t)number * (size_t)n[0] * (size_t)n[1];
  double basis[3][3];
  (void)counts;
  stratus_light_face_basis(d->frame, number, basis);
  for (size_t i = (size_t)first * (size_t)n[0]; i < (size_t)beyond * (size_t)n[0]; ++i) {
    face[i] = STRATUS_LIGHT_FREE;
  }
  for (size_t i = 0; i < d->surfaces->triangle_count; ++i) {
    double q[3][3];
    for (int corner = 0; corner < 3; ++corner) {
      const double* at = d->surfaces->points + 9 * i + 3 * corner;
      const double from[3] = { at[0] - d->frame->origin[0], at[1] - d->frame->origin[1], at[2] - d->frame->origin[2] };
      for (int axis = 0; axis < 3; ++axis) {
        q[corner][axis] = stratus_vector_dot(basis[axis], from);
      }
    }
    draw_corners(d, face, q, first, beyond);
  }
}

stratus_status stratus_light_surfaces_draw(stratus_context* context, const stratus_light_frame* frame, const stratus_surfaces* surfaces,
  const int size[2], stratus_light_depths* depths)
{
  void* memory = NULL;
  uint64_t counts[STRATUS_TILE_COUNTS];
  *depths = (stratus_light_depths){ .depth = NULL };
  if (!surfaces || surfaces->triangle_count == 0) {
    return STRATUS_OK;
  }
  const size_t faces = stratus_light_faces(frame);
  TRY(stratus_allocate(context, faces * (size_t)size[0] * (size_t)size[1], sizeof(float), &memory));
  *depths = (stratus_light_depths){ { size[0], size[1] }, memory };
  const int bands_most = BANDS_A_THREAD * context->threads;
  drawing d = { .frame = frame, .surfaces = surfaces, .depths = depths, .rows = (size[1] + bands_most - 1) / bands_most };
  for (int axis = 0; axis < 2; ++axis) {
    d.step[axis] = (frame->hi[axis] - frame->lo[axis]) / (size[axis] - 1);
  }
  const int bands = (size[1] + d.rows - 1) / d.rows;
  const stratus_status status = stratus_each_tile(context, "light", (int)faces * bands, draw_band, &d, counts);
  if (status != STRATUS_OK) {
    stratus_release(context, memory);
    depths->depth = NULL;
  }
  return status;
}

/* ---- reading */

/* The four nodes of a lattice about a place, and the weight of each. */
static void nodes_about(const int size[2], double x, double y, int at[4][2], double weight[4])
{
  const double place[2] = { x, y };
  int low[2];
  double part[2];
  for (int axis = 0; axis < 2; ++axis) {
    const double in = fmin(fmax(place[axis], 0.0), size[axis] - 1.0);
    low[axis] = (int)fmin(in, size[axis] - 2.0);
    part[axis] = in - low[axis];
  }
  for (int i = 0; i < 4; ++i) {
    at[i][0] = low[0] + (i & 1);
    at[i][1] = low[1] + (i >> 1);
    weight[i] = (i & 1 ? part[0] : 1.0 - part[0]) * (i >> 1 ? part[1] : 1.0 - part[1]);
  }
}

double stratus_light_surfaces_passing(const stratus_light_frame* frame, const stratus_light_depths* depths, const double world[3])
{
  const int* n = depths->size;
  double q[3], weight[4], sum = 0.0;
  int at[4][2];
  if (!depths->depth) {
    return 1.0;
  }
  const int face = stratus_light_frame_coordinates(frame, world, q);
  for (int axis = 0; axis < 2; ++axis) {
    q[axis] = (q[axis] - frame->lo[axis]) / (frame->hi[axis] - frame->lo[axis]) * (n[axis] - 1);
  }
  nodes_about(n, q[0], q[1], at, weight);
  for (int i = 0; i < 4; ++i) {
    const size_t node = ((size_t)face * (size_t)n[1] + (size_t)at[i][1]) * (size_t)n[0] + (size_t)at[i][0];
    sum += q[2] <= (double)depths->depth[node] ? weight[i] : 0.0;
  }
  return sum;
}

stratus_status stratus_light_surfaces_coarsen(
  stratus_context* context, const stratus_light_frame* frame, const stratus_light_depths* fine, int step, stratus_light_depths* coarse)
{
  const size_t faces = stratus_light_faces(frame);
  const int size[2] = { (fine->size[0] - 1) / step + 1, (fine->size[1] - 1) / step + 1 };
  void* memory;
  TRY(stratus_allocate(context, faces * (size_t)size[0] * (size_t)size[1], sizeof(float), &memory));
  *coarse = (stratus_light_depths){ { size[0], size[1] }, memory };
  for (size_t row = 0; row < faces * (size_t)size[1]; ++row) {
    const size_t from = row / (size_t)size[1] * (size_t)fine->size[1] + row % (size_t)size[1] * (size_t)step;
    for (size_t x = 0; x < (size_t)size[0]; ++x) {
      coarse->depth[row * (size_t)size[0] + x] = fine->depth[from * (size_t)fine->size[0] + x * (size_t)step];
    }
  }
  return STRATUS_OK;
}

double stratus_light_surfaces_error(
  const stratus_light_frame* frame, const stratus_light_depths* fine, int step, const int size[3], const int32_t* words)
{
  const int* n = fine->size;
  const int coarse[2] = { (n[0] - 1) / step + 1, (n[1] - 1) / step + 1 };
  const double layers = size[2] / (frame->hi[2] - frame->lo[2]);
  double squares = 0.0, pixels = 0.0;
  for (size_t face = 0; face < stratus_light_faces(frame); ++face) {
    const float* depths = fine->depth + face * (size_t)n[0] * (size_t)n[1];
    for (int y = EACH / 2; y < n[1]; y += EACH) {
      for (int x = EACH / 2; x < n[0]; x += EACH) {
        double place[3] = { (double)x / (n[0] - 1) * (size[0] - 1), (double)y / (n[1] - 1) * (size[1] - 1), size[2] }, weight[4];
        double difference = 0.0, here = -1.0; /* here: what passes to the surface; not known yet */
        const float depth = depths[(size_t)y * (size_t)n[0] + (size_t)x];
        int at[4][2];
        pixels += stratus_light_passing(size, words, (int)face, place) < 1.0f;
        nodes_about(coarse, (double)x / step, (double)y / step, at, weight);
        for (int i = 0; i < 4; ++i) { /* the light from matter in front of a surface is what does not pass to it */
          const float other = depths[(size_t)(at[i][1] * step) * (size_t)n[0] + (size_t)(at[i][0] * step)];
          if (weight[i] > 0.0 && other != depth) {
            place[2] = ((double)depth - frame->lo[2]) * layers;
            here = here < 0.0 ? stratus_light_passing(size, words, (int)face, place) : here;
            place[2] = ((double)other - frame->lo[2]) * layers;
            difference += weight[i] * (here - stratus_light_passing(size, words, (int)face, place));
          }
        }
        squares += difference * difference;
      }
    }
  }
  return pixels > 0.0 ? sqrt(squares / pixels) : 0.0;
}
