/* SPDX-License-Identifier: BSD-3-Clause
 * Corners of cells, of which each cell has its own in a file, as nodes that cells share. */
#include "faces.h"
#include "globe_direction.h"

#define SAME 1e-6 /* radians */

/* Nodes by the box of the edge SAME that they are in. */
typedef struct corner_boxes {
  int32_t* heads; /* the last node of each bucket, -1: none */
  int32_t* next;  /* the node before it in its bucket */
  double* units;  /* directions of nodes */
  uint64_t mask;  /* number of buckets - 1 */
} corner_boxes;

static uint64_t bucket_of(const corner_boxes* boxes, const int64_t box[3])
{
  const uint64_t key =
    (uint64_t)box[0] * 0x9e3779b97f4a7c15u ^ (uint64_t)box[1] * 0xc2b2ae3d27d4eb4fu ^ (uint64_t)box[2] * 0x165667b19e3779f9u;
  return (key ^ key >> 29) & boxes->mask;
}

/* Returns the lowest node at a place, or -1. */
static int32_t find(const corner_boxes* boxes, const double unit[3], const int64_t box[3])
{
  int32_t found = -1;
  for (int i = 0; i < 27; ++i) {
    const int64_t near[3] = { box[0] + i % 3 - 1, box[1] + i / 3 % 3 - 1, box[2] + i / 9 - 1 };
    for (int32_t node = boxes->heads[bucket_of(boxes, near)]; node >= 0; node = boxes->next[node]) {
      const double* const other = boxes->units + 3 * (int64_t)node;
      const double d[3] = { unit[0] - other[0], unit[1] - other[1], unit[2] - other[2] };
      if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < SAME * SAME && (found < 0 || node < found)) {
        found = node;
      }
    }
  }
  return found;
}

static stratus_status join(stratus_context* context, const corner_boxes* boxes, int64_t count, const double* degrees, int32_t* numbers,
  int64_t* first, int64_t* nodes)
{
  for (int64_t i = 0; i < count; ++i) {
    const double* const place = degrees + 2 * i;
    if (!isfinite(place[0]) || !isfinite(place[1])) {
      return stratus_fail(
        context, STRATUS_INVALID_ARGUMENT, "place %lld is at %g, %g degrees, must be finite", (long long)i, place[0], place[1]);
    }
    double* const unit = boxes->units + 3 * *nodes; /* kept if the node is new */
    stratus_globe_direction(place, unit);
    int64_t box[3];
    for (int axis = 0; axis < 3; ++axis) {
      box[axis] = (int64_t)floor(unit[axis] / SAME);
    }
    numbers[i] = find(boxes, unit, box);
    if (numbers[i] < 0) {
      const uint64_t bucket = bucket_of(boxes, box);
      numbers[i] = (int32_t)*nodes;
      boxes->next[*nodes] = boxes->heads[bucket];
      boxes->heads[bucket] = numbers[i];
      first[(*nodes)++] = i;
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_faces_join_corners(
  stratus_context* context, int64_t count, const double* degrees, int32_t* numbers, int64_t* first, int64_t* node_count)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!degrees || !numbers || !first || !node_count) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "degrees, numbers, first or node_count is NULL");
  }
  if (count < 1 || count > INT32_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%lld places, must be 1 to %d", (long long)count, INT32_MAX);
  }
  uint64_t buckets = 1;
  while (buckets < (uint64_t)count) {
    buckets *= 2;
  }
  void *heads = NULL, *next = NULL, *units = NULL;
  stratus_status status = STRATUS_OK;
  TRY_CLEANUP(stratus_allocate(context, (size_t)buckets, sizeof(int32_t), &heads));
  TRY_CLEANUP(stratus_allocate(context, (size_t)count, sizeof(int32_t), &next));
  TRY_CLEANUP(stratus_allocate(context, 3 * (size_t)count, sizeof(double), &units));
  const corner_boxes boxes = { heads, next, units, buckets - 1 };
  for (uint64_t i = 0; i < buckets; ++i) {
    boxes.heads[i] = -1;
  }
  *node_count = 0;
  status = join(context, &boxes, count, degrees, numbers, first, node_count);
cleanup:
  stratus_release(context, heads);
  stratus_release(context, next);
  stratus_release(context, units);
  return status;
}
