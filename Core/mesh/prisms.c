/* SPDX-License-Identifier: BSD-3-Clause
 * Prisms in layers above faces, as tetrahedra. */
#include "faces.h"

#define CELLS_MAX ((INT64_C(1) << 30) - 1)

static stratus_status check(stratus_context* context, const stratus_faces* faces, int64_t layer_count)
{
  TRY(stratus_faces_check_nodes(context, faces));
  if (layer_count < 1 || layer_count > INT32_MAX / faces->node_count - 1 || layer_count > INT32_MAX / faces->face_count) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "%lld layers of %lld nodes and %lld faces, must be at least 1 and at most %d points and %d prisms in all", (long long)layer_count,
      (long long)faces->node_count, (long long)faces->face_count, INT32_MAX, INT32_MAX);
  }
  return STRATUS_OK;
}

stratus_status stratus_prisms_hide(
  stratus_context* context, const stratus_faces* faces, int64_t layer_count, const double* z, const uint8_t* none, uint8_t* hidden)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!z || !hidden) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "z or hidden is NULL");
  }
  TRY(check(context, faces, layer_count));
  for (int64_t layer = 0; layer < layer_count; ++layer) {
    const double* const below = z + layer * faces->node_count;
    for (int64_t f = 0; f < faces->face_count; ++f) {
      bool thin = true, dry = faces->absent && faces->absent[f];
      for (int64_t i = faces->offsets[f]; i < faces->offsets[f + 1]; ++i) {
        const int64_t node = faces->nodes[i];
        thin = thin && below[faces->node_count + node] <= below[node];
        dry = dry || (none && none[node]);
      }
      hidden[layer * faces->face_count + f] = thin || dry;
    }
  }
  return STRATUS_OK;
}

/* Where tetrahedra go. */
typedef struct pieces {
  int32_t *vertices, *prisms; /* NULL: tetrahedra are only counted */
  int64_t count;
  int32_t apex, prism;
} pieces;

/* Adds the tetrahedron between a triangle of the prism's border, counterclockwise as seen from outside, and the apex. One with a point that
 * comes twice is left out. */
static void add(pieces* to, int32_t p, int32_t q, int32_t r)
{
  const int32_t s = to->apex;
  if (p == q || p == r || q == r || p == s || q == s || r == s) {
    return;
  }
  if (to->vertices) {
    int32_t* const v = to->vertices + 4 * to->count;
    v[0] = p;
    v[1] = r;
    v[2] = q;
    v[3] = s;
    to->prisms[to->count] = to->prism;
  }
  ++to->count;
}

/* Divides a prism into a fan around its lowest point number, which is below, and its faces into fans around theirs: neighbours divide a
 * common face alike. */
static void divide(pieces* to, const int32_t* nodes, int count, int32_t below, int32_t above)
{
  int lowest = 0;
  for (int i = 1; i < count; ++i) {
    lowest = nodes[i] < nodes[lowest] ? i : lowest;
  }
  to->apex = below + nodes[lowest];
  for (int i = 1; i + 1 < count; ++i) {
    const int32_t a = nodes[(lowest + i) % count], b = nodes[(lowest + i + 1) % count];
    add(to, above + nodes[lowest], above + a, above + b);
    /* the side between both, which is not at the apex */
    if (a < b) {
      add(to, below + a, below + b, above + b);
      add(to, below + a, above + b, above + a);
    } else {
      add(to, below + b, above + b, above + a);
      add(to, below + b, above + a, below + a);
    }
  }
}

stratus_status stratus_prisms_divide(stratus_context* context, const stratus_faces* faces, int64_t layer_count, const uint8_t* hidden,
  int64_t* count, int32_t* vertices, int32_t* prisms)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!count || !vertices != !prisms) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "count, or one of vertices and prisms, is NULL");
  }
  TRY(check(context, faces, layer_count));
  pieces to = { .vertices = vertices, .prisms = prisms };
  for (int64_t layer = 0; layer < layer_count; ++layer) {
    for (int64_t f = 0; f < faces->face_count; ++f) {
      const int64_t prism = layer * faces->face_count + f, begin = faces->offsets[f];
      if (!hidden || !hidden[prism]) {
        to.prism = (int32_t)prism;
        divide(&to, faces->nodes + begin, (int)(faces->offsets[f + 1] - begin), (int32_t)(layer * faces->node_count),
          (int32_t)((layer + 1) * faces->node_count));
      }
    }
  }
  if (to.count > CELLS_MAX) {
    return stratus_fail(
      context, STRATUS_OVERFLOW, "the prisms are %lld tetrahedra, at most %lld are allowed", (long long)to.count, (long long)CELLS_MAX);
  }
  *count = to.count;
  return STRATUS_OK;
}
