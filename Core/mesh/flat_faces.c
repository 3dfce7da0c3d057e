/* SPDX-License-Identifier: BSD-3-Clause
 * Faces of longitudes and latitudes on a plane: how each face is cut. flat_nodes.c has the nodes that this needs, and the arrays. */
#include "flat_faces.h"
#include "longitudes.h"

#include <string.h>

enum { POLYGON_MAX = 2 * STRATUS_FACE_NODES_MAX + 2, PART_MAX = 3 * POLYGON_MAX };

/* The edges of faces, but for those to a pole, whose longitude means nothing. */
typedef struct face_edges {
  stratus_edges edges; /* its first member */
  const stratus_faces* faces;
  const double* degrees;
} face_edges;

static bool is_pole(double latitude)
{
  return fabs(latitude) > 90.0 - FLAT_NEAR_POLE;
}

static void walk_faces(const stratus_edges* edges, stratus_edge_function call, void* state)
{
  const face_edges* const own = (const face_edges*)edges;
  for (int64_t f = 0; f < own->faces->face_count; ++f) {
    const int64_t begin = own->faces->offsets[f], end = own->faces->offsets[f + 1];
    for (int64_t i = begin; i < end; ++i) {
      const int64_t a = own->faces->nodes[i], b = own->faces->nodes[i + 1 < end ? i + 1 : begin];
      if (!is_pole(own->degrees[2 * a + 1]) && !is_pole(own->degrees[2 * b + 1])) {
        call(state, a, b);
      }
    }
  }
}

/* A corner of a polygon: a node, at the longitude of the node `at` and so many turns. */
typedef struct corner {
  int32_t node, at;
  int64_t turns;
} corner;

static double longitude_of(const flat_builder* b, const corner* c, int64_t turn)
{
  return b->nodes[c->at].x + TURN * (double)(c->turns - turn);
}

static bool is_at_pole(const flat_builder* b, int32_t node)
{
  return is_pole(b->nodes[node].y);
}

/* The node of a part that comes next. */
static void add_node(int32_t* part, int* count, int32_t node)
{
  if (*count == 0 || part[*count - 1] != node) {
    part[(*count)++] = node;
  }
}

/* Adds the part of a polygon that is within a turn. */
static stratus_status add_part(flat_builder* b, int64_t face, const corner* polygon, int corners, int64_t turn)
{
  const double ends[2] = { b->west, b->west + TURN };
  int32_t part[PART_MAX], node;
  int count = 0;
  for (int i = 0; i < corners; ++i) {
    const corner *one = polygon + i, *next = polygon + (i + 1) % corners;
    const double from = longitude_of(b, one, turn), to = longitude_of(b, next, turn);
    if (!b->around || (from >= ends[0] && from <= ends[1])) {
      TRY(stratus_flat_copy(b, one->node, from, &node));
      add_node(part, &count, node);
    }
    for (int n = 0; b->around && n < 2; ++n) {
      const double meridian = ends[n];
      if ((from < meridian && to > meridian) || (from > meridian && to < meridian)) {
        TRY(stratus_flat_between(b, (const int32_t[]){ one->node, next->node }, (const double[]){ from, to }, meridian, &node));
        add_node(part, &count, node);
      }
    }
  }
  while (count > 1 && part[count - 1] == part[0]) {
    --count;
  }
  for (int begin = 0; count - begin >= 3;) { /* one of too many nodes becomes several, which have its first node in common */
    const int left = count - begin, taken = left < STRATUS_FACE_NODES_MAX ? left : STRATUS_FACE_NODES_MAX;
    part[begin] = part[0];
    TRY(stratus_flat_add(b, face, part + begin, taken));
    begin += taken < left ? taken - 2 : left;
  }
  return STRATUS_OK;
}

/* Adds the parts of a polygon in each turn from the meridian on. */
static stratus_status cut(flat_builder* b, int64_t face, const corner* polygon, int corners)
{
  int64_t low = 0, high = 1;
  for (int i = 0; b->around && i < corners; ++i) {
    const int64_t turns = polygon[i].turns, after = turns + (b->nodes[polygon[i].at].x > b->west);
    low = i == 0 || turns < low ? turns : low;
    high = i == 0 || after > high ? after : high;
  }
  for (int64_t turn = low; turn < high; ++turn) {
    TRY(add_part(b, face, polygon, corners, turn));
  }
  return STRATUS_OK;
}

/* Adds a face around a pole, as quadrangles between each of its edges and the pole, whose values are the nearest node's.
 * polygon: `corners` corners, and the first one again, a turn further */
static stratus_status add_cap(flat_builder* b, int64_t face, const corner* polygon, int corners)
{
  int32_t nearest = polygon[0].node, pole;
  for (int i = 1; i < corners; ++i) {
    nearest = fabs(b->nodes[polygon[i].node].y) > fabs(b->nodes[nearest].y) ? polygon[i].node : nearest;
  }
  TRY(stratus_flat_pole(b, nearest, &pole));
  for (int i = 0; i < corners; ++i) {
    corner quadrangle[4] = { polygon[i], polygon[i + 1], polygon[i + 1], polygon[i] };
    quadrangle[2].node = quadrangle[3].node = pole;
    if (longitude_of(b, polygon + i, 0) != longitude_of(b, polygon + i + 1, 0)) {
      TRY(cut(b, face, quadrangle, 4));
    }
  }
  return STRATUS_OK;
}

/* Adds a face. Its corners get continuous longitudes. A corner at a pole becomes an edge as wide as its neighbours are apart, because on
 * the plane a pole is a line. */
static stratus_status add_face(flat_builder* b, int64_t face, const int32_t* nodes, int count)
{
  int start = -1; /* behind a pole, if there is one */
  for (int i = 0; i < count; ++i) {
    const bool behind = is_at_pole(b, nodes[(i + count - 1) % count]);
    if (!is_at_pole(b, nodes[i]) && (start < 0 || behind)) {
      start = i;
    }
  }
  if (start < 0) {
    return STRATUS_OK;
  }
  corner polygon[POLYGON_MAX];
  int corners = 0;
  bool pole = false;
  corner last = { nodes[start], nodes[start], 0 };
  for (int i = 0; i <= count; ++i) { /* the first again, for the turns around the face */
    const int32_t node = nodes[(start + i) % count];
    if (is_at_pole(b, node)) {
      polygon[corners++] = (corner){ node, last.at, last.turns };
      pole = true;
      continue;
    }
    corner own = { node, node, last.turns - (int64_t)stratus_longitudes_turns(b->nodes[node].x - b->nodes[last.at].x) };
    if (i == count && pole) { /* its turn is known, because the pole was between */
      own.turns = 0;
    }
    if (corners > 0 && is_at_pole(b, polygon[corners - 1].node) && longitude_of(b, &own, 0) != longitude_of(b, &last, 0)) {
      polygon[corners] = (corner){ polygon[corners - 1].node, own.at, own.turns };
      ++corners;
    }
    polygon[corners++] = last = own;
  }
  --corners; /* the first one */
  return pole || polygon[corners].turns == 0 ? cut(b, face, polygon, corners) : add_cap(b, face, polygon, corners);
}

static stratus_status check(stratus_context* context, const stratus_faces* faces, const double* degrees)
{
  TRY(stratus_faces_check_nodes(context, faces));
  for (int64_t node = 0; node < faces->node_count; ++node) {
    if (!(fabs(degrees[2 * node]) <= FLAT_FARTHEST && fabs(degrees[2 * node + 1]) <= 90.0 + FLAT_NEAR_POLE)) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
        "node %lld is at %g degrees east, %g degrees north, must be -%g to %g, and -90 to 90", (long long)node, degrees[2 * node],
        degrees[2 * node + 1], FLAT_FARTHEST, FLAT_FARTHEST);
    }
  }
  return STRATUS_OK;
}

/* Makes longitudes continuous, if the mesh spans less than the Earth. Otherwise finds the meridian of the cut, and moves all to its turn.
 */
static stratus_status join_longitudes(flat_builder* b, const stratus_faces* faces, const double* degrees, int* unwrapped)
{
  const face_edges edges = { { faces->node_count, walk_faces }, faces, degrees };
  void* memory = NULL;
  TRY(stratus_allocate(b->context, (size_t)faces->node_count, sizeof(double), &memory));
  double* const x = memory;
  double most = -INFINITY;
  for (int64_t i = 0; i < faces->node_count; ++i) {
    x[i] = degrees[2 * i];
    most = x[i] > most ? x[i] : most;
  }
  b->west = most > 0.5 * TURN ? 0.0 : -0.5 * TURN;
  const stratus_status status = stratus_longitudes_join(b->context, &edges.edges, x, unwrapped);
  b->around = status == STRATUS_OK && stratus_longitudes_jump(&edges.edges, x);
  *unwrapped = *unwrapped && !b->around;
  for (int64_t i = 0; status == STRATUS_OK && i < faces->node_count; ++i) {
    double at = x[i];
    if (b->around) {
      at = degrees[2 * i] - TURN * floor((degrees[2 * i] - b->west) / TURN);
      at = at < b->west + TURN ? at : b->west; /* after rounding */
    }
    b->nodes[i].x = at;
  }
  stratus_release(b->context, memory);
  return status;
}

stratus_status stratus_faces_flatten(stratus_context* context, const stratus_faces* faces, const double* degrees, stratus_flat_faces* flat)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!degrees || !flat) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "degrees or flat is NULL");
  }
  memset(flat, 0, sizeof *flat);
  TRY(check(context, faces, degrees));
  flat_builder b = { .context = context };
  stratus_status status = STRATUS_OK;
  TRY_CLEANUP(stratus_flat_begin(&b, faces, degrees));
  TRY_CLEANUP(join_longitudes(&b, faces, degrees, &flat->unwrapped));
  for (int64_t f = 0; f < faces->face_count; ++f) {
    const int32_t* const nodes = faces->nodes + faces->offsets[f];
    const int count = (int)(faces->offsets[f + 1] - faces->offsets[f]);
    if (!faces->absent || !faces->absent[f]) {
      TRY_CLEANUP(add_face(&b, f, nodes, count));
    }
    if (b.first.count == f) { /* there is nothing of it on the plane */
      TRY_CLEANUP(stratus_flat_add(&b, f, nodes, count));
    }
  }
  flat->cut = b.around;
  flat->meridian = b.around ? b.west : 0.0;
  status = stratus_flat_end(&b, faces, flat);
cleanup:
  stratus_flat_release(&b);
  return status;
}
