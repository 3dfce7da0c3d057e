/* SPDX-License-Identifier: BSD-3-Clause
 * Seams: border faces that coincide but name different points, for example where a grid closes on itself. Cells at a seam hide one another
 * as through a shared face, so they become neighbours. Two hash tables find coincident points, then coincident faces. Both are filled in
 * ascending order, so the lowest number stands for all that coincide. */
#include "visibility_order.h"

#include <string.h>

#define NONE UINT32_MAX

typedef struct seam_build {
  stratus_visibility_order* order;
  uint32_t* same;  /* for each point: the lowest border point at its position; NONE: it is not on the border */
  uint32_t* table; /* first of points, a slot each; then of faces, two entries a slot: the first and the second that coincide. NONE: free */
  uint64_t mask;   /* number of slots, a power of two, less 1 */
  int64_t joined;
} seam_build;

static uint64_t mix(uint64_t hash, uint64_t value)
{
  hash = (hash ^ value) * UINT64_C(0x9e3779b97f4a7c15);
  return hash ^ hash >> 29;
}

static uint64_t hash_point(const double* p)
{
  uint64_t hash = 0;
  for (int a = 0; a < 3; ++a) {
    const double number = p[a] + 0.0; /* -0 is 0 */
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    hash = mix(hash, bits);
  }
  return hash;
}

/* Returns how many border points coincide with a lower one. */
static int64_t find_coincident(seam_build* seam)
{
  const stratus_visibility_order* order = seam->order;
  int64_t coincident = 0;
  for (int64_t i = 0; i < order->point_count; ++i) {
    if (seam->same[i] == NONE) {
      continue;
    }
    const double* p = order->points + 3 * i;
    uint64_t slot = hash_point(p) & seam->mask;
    for (;; slot = (slot + 1) & seam->mask) {
      const double* q = seam->table[slot] == NONE ? NULL : order->points + 3 * (int64_t)seam->table[slot];
      if (!q) {
        seam->table[slot] = (uint32_t)i;
        break;
      }
      if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) {
        seam->same[i] = seam->table[slot];
        ++coincident;
        break;
      }
    }
  }
  return coincident;
}

/* A border face's points, each by the lowest number at its position, ascending. Returns the sign of the side on which its cell lies, 0:
 * flat. */
static int seam_face(const seam_build* seam, uint32_t face, int32_t points[3])
{
  const stratus_visibility_order* order = seam->order;
  const int32_t* v = order->vertices + 4 * (int64_t)(face / 4);
  int32_t cell[4];
  for (int i = 0; i < 4; ++i) {
    cell[i] = seam->same[v[i]] == NONE ? v[i] : (int32_t)seam->same[v[i]];
  }
  return stratus_face_points(cell, (int)(face % 4), points) * order->side[face / 4];
}

static void join_face(seam_build* seam, uint32_t face)
{
  stratus_visibility_order* order = seam->order;
  int32_t points[3], other[3];
  const int side = seam_face(seam, face, points);
  if (points[0] == points[1] || points[1] == points[2] || side == 0) {
    return;
  }
  uint64_t slot = mix(mix(mix(0, (uint32_t)points[0]), (uint32_t)points[1]), (uint32_t)points[2]) & seam->mask;
  for (; seam->table[2 * slot] != NONE; slot = (slot + 1) & seam->mask) {
    const uint32_t candidate = seam->table[2 * slot];
    const int candidate_side = seam_face(seam, candidate, other);
    if (memcmp(points, other, sizeof points) != 0) {
      continue;
    }
    int32_t* neighbours = order->adjacency->neighbours;
    if (seam->table[2 * slot + 1] != NONE) { /* a third coincident face: the pairing would be arbitrary, so all three are borders again */
      const uint32_t second = seam->table[2 * slot + 1];
      seam->joined -= neighbours[candidate] == (int32_t)(second / 4);
      neighbours[candidate] = neighbours[second] = -1;
    } else {
      seam->table[2 * slot + 1] = face;
      if (side == -candidate_side && face / 4 != candidate / 4) {
        neighbours[candidate] = (int32_t)(face / 4);
        neighbours[face] = (int32_t)(candidate / 4);
        ++seam->joined;
      }
    }
    return;
  }
  seam->table[2 * slot] = face;
}

/* Marks the points of border faces, and returns how many there are. */
static int64_t mark_border(seam_build* seam)
{
  const stratus_visibility_order* order = seam->order;
  int64_t marked = 0;
  memset(seam->same, 0xff, (size_t)order->point_count * sizeof *seam->same);
  for (int64_t face = 0; face < 4 * order->cell_count; ++face) {
    for (int i = 0; i < 4 && order->adjacency->neighbours[face] < 0; ++i) {
      const int32_t point = order->vertices[4 * (face / 4) + i];
      if (i != face % 4 && seam->same[point] == NONE) {
        seam->same[point] = (uint32_t)point;
        ++marked;
      }
    }
  }
  return marked;
}

/* Makes the table anew: at least twice as many slots as entries, `width` numbers each. */
static stratus_status make_table(seam_build* seam, int64_t entries, size_t width)
{
  void* memory;
  stratus_release(seam->order->context, seam->table);
  seam->table = NULL;
  for (seam->mask = 1; seam->mask < 2 * (uint64_t)entries; seam->mask = 2 * seam->mask + 1) {}
  TRY(stratus_allocate(seam->order->context, seam->mask + 1, width * sizeof *seam->table, &memory));
  seam->table = memory;
  memset(memory, 0xff, (seam->mask + 1) * width * sizeof *seam->table);
  return STRATUS_OK;
}

stratus_status stratus_order_join_seams(stratus_visibility_order* order)
{
  stratus_status status = STRATUS_OK;
  seam_build seam = { .order = order };
  void* memory = NULL;
  TRY_CLEANUP(stratus_allocate(order->context, (size_t)order->point_count, sizeof *seam.same, &memory));
  seam.same = memory;
  TRY_CLEANUP(make_table(&seam, mark_border(&seam), 1));
  if (find_coincident(&seam) > 0) {
    TRY_CLEANUP(make_table(&seam, order->adjacency->border_faces, 2));
    for (int64_t face = 0; face < 4 * order->cell_count; ++face) {
      if (order->adjacency->neighbours[face] < 0) {
        join_face(&seam, (uint32_t)face);
      }
    }
    order->adjacency->border_faces -= 2 * seam.joined;
  }

cleanup:
  stratus_release(order->context, seam.same);
  stratus_release(order->context, seam.table);
  return status;
}
