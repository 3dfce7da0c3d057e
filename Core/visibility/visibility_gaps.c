/* SPDX-License-Identifier: BSD-3-Clause
 * Gap faces: border faces through which a ray may leave a leaf and come back, because more of the leaf is beyond the face's plane. Cells on
 * both sides of a gap share no face, so relations through faces do not order them. Every other border face is on the leaf's convex hull,
 * and no ray comes back through it. */
#include "visibility_order.h"

#include "vector.h"

#include <string.h>

#define SLACK 1e-13 /* of the mesh's size: a narrower gap is a rounding error */

/* A leaf's border faces, and a tree of boxes: each covers STRATUS_GATE_CHILDREN consecutive faces, or as many boxes of the level before. */
typedef struct gap_search {
  const stratus_visibility_order* order;
  const uint32_t* faces; /* of the leaf */
  int64_t count;
  double* boxes; /* 6 numbers each, level by level, those over faces first */
  int64_t level_begin[STRATUS_GATE_LEVELS_MAX];
  int levels;
  double slack, scale; /* scale: a power of two that makes edges at most 1 long, so that no product of them overflows */
} gap_search;

/* How many boxes the tree over so many faces has. */
static int64_t count_boxes(int64_t faces)
{
  int64_t boxes = 0;
  do {
    faces = (faces + STRATUS_GATE_CHILDREN - 1) / STRATUS_GATE_CHILDREN;
    boxes += faces;
  } while (faces > 1);
  return boxes;
}

static void grow(double box[6], const double low[3], const double high[3])
{
  for (int a = 0; a < 3; ++a) {
    box[2 * a] = fmin(box[2 * a], low[a]);
    box[2 * a + 1] = fmax(box[2 * a + 1], high[a]);
  }
}

static const double* face_point(const stratus_visibility_order* order, uint32_t face, int i)
{
  return order->points + 3 * (int64_t)stratus_order_vertices(order, face / 4)[(face + 1 + (unsigned)i) % 4];
}

static void build_boxes(gap_search* search)
{
  int64_t below = search->count, begin = 0;
  search->levels = 0;
  do {
    const int64_t count = (below + STRATUS_GATE_CHILDREN - 1) / STRATUS_GATE_CHILDREN,
                  children = search->levels > 0 ? search->level_begin[search->levels - 1] : 0;
    for (int64_t b = 0; b < count; ++b) {
      double* box = search->boxes + 6 * (begin + b);
      for (int a = 0; a < 3; ++a) {
        box[2 * a] = INFINITY;
        box[2 * a + 1] = -INFINITY;
      }
      for (int64_t c = STRATUS_GATE_CHILDREN * b; c < STRATUS_GATE_CHILDREN * (b + 1) && c < below; ++c) {
        for (int i = 0; i < 3 && search->levels == 0; ++i) {
          const double* point = face_point(search->order, search->faces[c], i);
          grow(box, point, point);
        }
        if (search->levels > 0) {
          const double* child = search->boxes + 6 * (children + c);
          grow(box, (const double[]){ child[0], child[2], child[4] }, (const double[]){ child[1], child[3], child[5] });
        }
      }
    }
    search->level_begin[search->levels++] = begin;
    begin += count;
    below = count;
  } while (below > 1);
}

/* The plane of a face, its normal outwards: points p with normal*p > *least lie beyond it. Returns false for a face or cell without extent,
 * whose outer side is unknown. */
static bool outer_plane(const gap_search* search, uint32_t face, double normal[3], double* least)
{
  const stratus_visibility_order* order = search->order;
  const double *a = face_point(order, face, 0), *b = face_point(order, face, 1), *c = face_point(order, face, 2),
               *apex = face_point(order, face, 3);
  double inner = 0.0, length = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double bj = (b[j] - a[j]) * search->scale, bk = (b[k] - a[k]) * search->scale;
    normal[i] = bj * ((c[k] - a[k]) * search->scale) - bk * ((c[j] - a[j]) * search->scale);
  }
  for (int i = 0; i < 3; ++i) {
    inner += normal[i] * (apex[i] - a[i]);
    length += fabs(normal[i]);
  }
  if (inner == 0.0 || length == 0.0) {
    return false;
  }
  *least = search->slack * length;
  for (int i = 0; i < 3; ++i) {
    normal[i] = inner > 0.0 ? -normal[i] : normal[i];
    *least += normal[i] * a[i];
  }
  return true;
}

/* Whether any point of the leaf's border lies beyond the face's plane. */
static bool looks_at_others(const gap_search* search, uint32_t face)
{
  struct {
    int level;
    int64_t box;
  } stack[STRATUS_GATE_CHILDREN * STRATUS_GATE_LEVELS_MAX];
  double normal[3], least;
  int pending = 1;
  if (!outer_plane(search, face, normal, &least)) {
    return true;
  }
  stack[0].level = search->levels - 1;
  stack[0].box = 0;
  while (pending > 0) {
    const int level = stack[--pending].level;
    const int64_t number = stack[pending].box;
    const double* box = search->boxes + 6 * (search->level_begin[level] + number);
    if (!(stratus_vector_dot(normal, (const double[]){ box[normal[0] > 0.0], box[2 + (normal[1] > 0.0)], box[4 + (normal[2] > 0.0)] }) >
          least)) {
      continue;
    }
    const int64_t below = level > 0 ? search->level_begin[level] - search->level_begin[level - 1] : search->count;
    for (int64_t i = STRATUS_GATE_CHILDREN * number; i < STRATUS_GATE_CHILDREN * (number + 1) && i < below; ++i) {
      if (level > 0) {
        stack[pending].level = level - 1;
        stack[pending++].box = i;
        continue;
      }
      for (int v = 0; v < 3; ++v) {
        if (stratus_vector_dot(normal, face_point(search->order, search->faces[i], v)) > least) {
          return true;
        }
      }
    }
  }
  return false;
}

/* Lists the border faces, leaf by leaf, ascending. */
static stratus_status list_borders(const stratus_visibility_order* order, int64_t* begin, uint32_t** faces)
{
  void* memory;
  int64_t count = 0;
  for (int32_t leaf = 0; leaf < order->leaf_count; ++leaf) {
    begin[leaf] = count;
    for (int64_t i = order->leaf_begin[leaf]; i < order->leaf_begin[leaf + 1]; ++i) {
      count += stratus_order_count_faces(~(unsigned)order->sides[i]);
    }
  }
  begin[order->leaf_count] = count;
  TRY(stratus_allocate(order->context, (size_t)count, sizeof **faces, &memory));
  *faces = memory;
  count = 0;
  for (int64_t i = 0; i < order->cell_count; ++i) {
    for (uint32_t f = 0; f < 4; ++f) {
      if (!(order->sides[i] >> f & 1)) {
        (*faces)[count++] = 4 * (uint32_t)i + f;
      }
    }
  }
  return STRATUS_OK;
}

/* Moves the leaf's gap faces to the front of its faces, and returns how many there are. */
static int64_t keep_gaps(gap_search* search, uint32_t* faces, uint8_t* kept)
{
  const int threads = search->count > STRATUS_GATE_CHILDREN * STRATUS_GATE_CHILDREN ? search->order->context->threads : 1;
  int64_t count = 0;
  build_boxes(search);
#pragma omp parallel for schedule(dynamic, 256) num_threads(threads)
  for (int64_t i = 0; i < search->count; ++i) {
    kept[i] = stratus_order_side(search->order, faces[i] / 4) != 0 && looks_at_others(search, faces[i]);
  }
  for (int64_t i = 0; i < search->count; ++i) {
    faces[count] = faces[i];
    count += kept[i];
  }
  return count;
}

static double mesh_size(const stratus_visibility_order* order)
{
  const double* b = order->bounds;
  return fmax(fmax(b[1] - b[0], b[3] - b[2]), b[5] - b[4]);
}

static stratus_status take_gaps(stratus_visibility_order* order, const uint32_t* faces, int64_t count)
{
  void* memory;
  TRY(stratus_order_allocate(order, (size_t)count, sizeof *order->gap_faces, &memory));
  order->gap_faces = memory;
  memcpy(order->gap_faces, faces, (size_t)count * sizeof *faces);
  const size_t blocks = (size_t)order->cell_count / STRATUS_GAP_BLOCK + 1;
  TRY(stratus_order_allocate(order, blocks, sizeof *order->gap_at, &memory));
  order->gap_at = memory;
  for (size_t b = 0, face = 0; b < blocks; ++b) {
    while (face < (size_t)count && faces[face] / 4 < b * STRATUS_GAP_BLOCK) {
      ++face;
    }
    order->gap_at[b] = (uint32_t)face;
  }
  return stratus_gates_allocate(order, count);
}

stratus_status stratus_order_find_gaps(stratus_visibility_order* order)
{
  stratus_context* context = order->context;
  stratus_status status = STRATUS_OK;
  const double size = mesh_size(order);
  gap_search search = { .order = order, .slack = SLACK * size, .scale = stratus_order_scale(size) };
  uint32_t* faces = NULL;
  void *begin = NULL, *kept = NULL, *boxes = NULL;
  int64_t largest = 0, count = 0;
  TRY_CLEANUP(stratus_allocate(context, (size_t)order->leaf_count + 1, sizeof(int64_t), &begin));
  order->gap_begin = begin;
  TRY_CLEANUP(list_borders(order, order->gap_begin, &faces));
  for (int32_t leaf = 0; leaf < order->leaf_count; ++leaf) {
    const int64_t here = order->gap_begin[leaf + 1] - order->gap_begin[leaf];
    largest = here > largest ? here : largest;
  }
  TRY_CLEANUP(stratus_allocate(context, (size_t)largest, sizeof(uint8_t), &kept));
  TRY_CLEANUP(stratus_allocate(context, (size_t)count_boxes(largest), 6 * sizeof(double), &boxes));
  search.boxes = boxes;
  for (int32_t leaf = 0; leaf < order->leaf_count; ++leaf) {
    const int64_t first = order->gap_begin[leaf];
    search.faces = faces + first;
    search.count = order->gap_begin[leaf + 1] - first;
    order->gap_begin[leaf] = count;
    const int64_t gaps = search.count > 0 ? keep_gaps(&search, faces + first, kept) : 0;
    memmove(faces + count, faces + first, (size_t)gaps * sizeof *faces);
    count += gaps;
  }
  order->gap_begin[order->leaf_count] = count;
  TRY_CLEANUP(take_gaps(order, faces, count));

cleanup:
  stratus_release(context, kept);
  stratus_release(context, boxes);
  stratus_release(context, faces);
  return status;
}
