/* SPDX-License-Identifier: BSD-3-Clause
 * Faces between nodes from the tables of files, and their orientation. */
#include "faces.h"
#include "globe_direction.h"

#include <string.h>

stratus_status stratus_faces_check(stratus_context* context, const stratus_faces* faces)
{
  if (!faces || !faces->offsets || !faces->nodes) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "faces, their offsets or nodes are NULL");
  }
  if (faces->node_count < 1 || faces->node_count > INT32_MAX || faces->face_count < 1 || faces->face_count > INT32_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "a mesh of %lld nodes and %lld faces, must be 1 to %d each",
      (long long)faces->node_count, (long long)faces->face_count, INT32_MAX);
  }
  return STRATUS_OK;
}

stratus_status stratus_faces_check_nodes(stratus_context* context, const stratus_faces* faces)
{
  TRY(stratus_faces_check(context, faces));
  for (int64_t f = 0; f < faces->face_count; ++f) {
    const int64_t begin = faces->offsets[f], count = faces->offsets[f + 1] - begin;
    if (begin < 0 || count < 3 || count > STRATUS_FACE_NODES_MAX) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "face %lld has %lld nodes, must be 3 to %d", (long long)f, (long long)count,
        STRATUS_FACE_NODES_MAX);
    }
    for (int64_t i = begin; i < begin + count; ++i) {
      if (faces->nodes[i] < 0 || faces->nodes[i] >= faces->node_count) {
        return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "face %lld has the node %d, must be 0 to %lld", (long long)f,
          (int)faces->nodes[i], (long long)faces->node_count - 1);
      }
    }
  }
  return STRATUS_OK;
}

static stratus_status check_table(stratus_context* context, const stratus_face_table* table, const stratus_faces* faces)
{
  if (!table || !table->numbers || !faces || !faces->absent) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "table, its numbers, or faces' absent is NULL");
  }
  TRY(stratus_faces_check(context, faces));
  if (table->columns < 1 || table->columns > STRATUS_FACE_NODES_MAX) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "a table of %lld columns, must be 1 to %d", (long long)table->columns, STRATUS_FACE_NODES_MAX);
  }
  const int64_t rows = table->rows_are_nodes ? faces->node_count : faces->face_count;
  if (table->rows != rows) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "a table of %lld rows, must be %lld, one for each %s", (long long)table->rows,
      (long long)rows, table->rows_are_nodes ? "node" : "face");
  }
  if (table->fewest != 0 && (table->fewest < 3 || table->fewest > STRATUS_FACE_NODES_MAX)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "faces of at least %d nodes, must be 0 or 3 to %d", table->fewest, STRATUS_FACE_NODES_MAX);
  }
  if (!isfinite(table->first)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "a first number of %g, must be finite", table->first);
  }
  return STRATUS_OK;
}

/* Returns the index of a number of the table. */
static stratus_status index_of(
  stratus_context* context, const stratus_face_table* table, const stratus_faces* faces, int64_t row, int64_t column, int64_t* index)
{
  const double number = table->numbers[row * table->columns + column], at = number - table->first;
  const int64_t count = table->rows_are_nodes ? faces->face_count : faces->node_count;
  if (!(at >= 0.0 && at < (double)count) || at != floor(at)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s %lld has the %s %.9g, must be %.9g to %.9g",
      table->rows_are_nodes ? "node" : "face", (long long)row, table->rows_are_nodes ? "face" : "node", number, table->first,
      table->first + (double)count - 1.0);
  }
  *index = (int64_t)at;
  return STRATUS_OK;
}

/* Ends a face of `listed` nodes behind its offset: drops repeated ones, and makes a face of too few nodes absent. */
static stratus_status end_face(
  stratus_context* context, const stratus_face_table* table, stratus_faces* faces, int64_t face, int64_t listed)
{
  int32_t* const nodes = faces->nodes + faces->offsets[face];
  int64_t count = 0;
  for (int64_t i = 0; i < listed; ++i) {
    if (count == 0 || nodes[count - 1] != nodes[i]) {
      nodes[count++] = nodes[i];
    }
  }
  while (count > 1 && nodes[count - 1] == nodes[0]) {
    --count;
  }
  if (table->fewest == 0 && listed < 3) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "face %lld has %lld nodes, at least 3 are needed", (long long)face, (long long)listed);
  }
  if (count > STRATUS_FACE_NODES_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "face %lld has %lld nodes, must be at most %d", (long long)face,
      (long long)count, STRATUS_FACE_NODES_MAX);
  }
  faces->absent[face] = count < (table->fewest > 3 ? table->fewest : 3);
  if (faces->absent[face]) {
    count = 3;
    memset(nodes, 0, 3 * sizeof *nodes);
  }
  faces->offsets[face + 1] = faces->offsets[face] + count;
  return STRATUS_OK;
}

static stratus_status read_faces(stratus_context* context, const stratus_face_table* table, stratus_faces* faces)
{
  for (int64_t f = 0; f < table->rows; ++f) {
    int64_t listed = 0;
    for (int64_t c = 0; c < table->columns; ++c) {
      if (!isnan(table->numbers[f * table->columns + c])) {
        int64_t node = 0;
        TRY(index_of(context, table, faces, f, c, &node));
        faces->nodes[faces->offsets[f] + listed++] = (int32_t)node;
      }
    }
    TRY(end_face(context, table, faces, f, listed));
  }
  return STRATUS_OK;
}

/* Deals nodes to the faces that they name, in ascending order. */
static stratus_status deal_nodes(stratus_context* context, const stratus_face_table* table, stratus_faces* faces, int64_t* places)
{
  const int64_t cells = table->rows * table->columns;
  for (int64_t i = 0; i < cells; ++i) {
    if (!isnan(table->numbers[i])) {
      int64_t face = 0;
      TRY(index_of(context, table, faces, i / table->columns, i % table->columns, &face));
      ++places[face + 1];
    }
  }
  for (int64_t f = 0; f < faces->face_count; ++f) { /* each face has room for three */
    places[f + 1] = places[f] + (places[f + 1] > 3 ? places[f + 1] : 3);
    faces->offsets[f] = places[f];
  }
  faces->offsets[faces->face_count] = places[faces->face_count];
  for (int64_t i = 0; i < cells; ++i) {
    if (!isnan(table->numbers[i])) {
      const int64_t face = (int64_t)(table->numbers[i] - table->first);
      faces->nodes[faces->offsets[face]++] = (int32_t)(i / table->columns);
    }
  }
  int64_t end = 0; /* faces move forward to where the one before them ends */
  for (int64_t f = 0; f < faces->face_count; ++f) {
    const int64_t listed = faces->offsets[f] - places[f];
    memmove(faces->nodes + end, faces->nodes + places[f], (size_t)listed * sizeof *faces->nodes);
    faces->offsets[f] = end;
    const int64_t begin_of_next = faces->offsets[f + 1];
    TRY(end_face(context, table, faces, f, listed));
    end = faces->offsets[f + 1];
    faces->offsets[f + 1] = begin_of_next;
  }
  faces->offsets[faces->face_count] = end;
  return STRATUS_OK;
}

stratus_status stratus_faces_from_table(stratus_context* context, const stratus_face_table* table, stratus_faces* faces)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  TRY(check_table(context, table, faces));
  faces->offsets[0] = 0;
  if (!table->rows_are_nodes) {
    return read_faces(context, table, faces);
  }
  void* places;
  TRY(stratus_allocate_zero(context, (size_t)faces->face_count + 1, sizeof(int64_t), &places));
  const stratus_status status = deal_nodes(context, table, faces, places);
  stratus_release(context, places);
  return status;
}

/* Twice the area of a face, above 0 if it is counterclockwise. */
static double area_of(const stratus_faces* faces, int64_t face, const double* places, int on_sphere)
{
  double at[STRATUS_FACE_NODES_MAX][3], area = 0.0;
  const int64_t begin = faces->offsets[face];
  const int count = (int)(faces->offsets[face + 1] - begin);
  for (int i = 0; i < count; ++i) {
    const double* const place = places + 2 * (int64_t)faces->nodes[begin + i];
    if (on_sphere) {
      stratus_globe_direction(place, at[i]);
    } else {
      at[i][0] = place[0];
      at[i][1] = place[1];
      at[i][2] = 0.0;
    }
  }
  const double up[3] = { on_sphere ? at[0][0] : 0.0, on_sphere ? at[0][1] : 0.0, on_sphere ? at[0][2] : 1.0 };
  for (int i = 1; i + 1 < count; ++i) {
    double a[3], b[3];
    for (int axis = 0; axis < 3; ++axis) {
      a[axis] = at[i][axis] - at[0][axis];
      b[axis] = at[i + 1][axis] - at[0][axis];
    }
    area += up[0] * (a[1] * b[2] - a[2] * b[1]) + up[1] * (a[2] * b[0] - a[0] * b[2]) + up[2] * (a[0] * b[1] - a[1] * b[0]);
  }
  return area;
}

stratus_status stratus_faces_turn(stratus_context* context, const stratus_faces* faces, const double* places, int on_sphere)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!places) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "places is NULL");
  }
  TRY(stratus_faces_check_nodes(context, faces));
  for (int64_t f = 0; f < faces->face_count; ++f) {
    if (area_of(faces, f, places, on_sphere) < 0.0) {
      int32_t *low = faces->nodes + faces->offsets[f], *high = faces->nodes + faces->offsets[f + 1] - 1;
      for (; low < high; ++low, --high) {
        const int32_t kept = *low;
        *low = *high;
        *high = kept;
      }
    }
  }
  return STRATUS_OK;
}
