/* SPDX-License-Identifier: BSD-3-Clause
 * Whether one gate hides another. Their faces are intersected in the view, and their depths compared in the middle of the intersection. */
#include "visibility_order.h"

#include <string.h>

#define CORNERS_MAX 6    /* corners of two triangles' intersection */
#define LEAST_SHARE 1e-6 /* of a face: faces that share less of the view only touch, but for rounding */
#define LEAST_DEPTH 1e-9 /* from the other's plane, in lengths of the other's edges: a nearer point is on the plane */

/* The size of a triangle in the view, signed by which way round its points come: an area, or in perspective a determinant. */
static double turn_of(const stratus_gates* gates, const stratus_view_point* a, const stratus_view_point* b, const stratus_view_point* c)
{
  if (gates->parallel) {
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
  }
  return a->x * (b->y * c->z - b->z * c->y) + a->y * (b->z * c->x - b->x * c->z) + a->z * (b->x * c->y - b->y * c->x);
}

/* Cuts off the part of a convex polygon where distance[], of its corners, is negative. The polygon has room for one more corner. */
static int clip(stratus_view_point* polygon, int count, const double* distance)
{
  stratus_view_point kept[CORNERS_MAX + 2];
  int made = 0;
  for (int i = 0; i < count; ++i) {
    const int j = i + 1 < count ? i + 1 : 0;
    const stratus_view_point *p = polygon + i, *q = polygon + j;
    if (distance[i] >= 0.0) {
      kept[made++] = *p;
    }
    if ((distance[i] > 0.0 && distance[j] < 0.0) || (distance[i] < 0.0 && distance[j] > 0.0)) {
      const double t = distance[i] / (distance[i] - distance[j]);
      kept[made++] = (stratus_view_point){ p->x + t * (q->x - p->x), p->y + t * (q->y - p->y), p->z + t * (q->z - p->z) };
    }
  }
  memcpy(polygon, kept, (size_t)made * sizeof *kept);
  return made;
}

static stratus_view_point minus(const stratus_view_point* p, const stratus_view_point* q)
{
  return (stratus_view_point){ p->x - q->x, p->y - q->y, p->z - q->z };
}

/* Whether p is on a face's plane or on the eye's side of it. *nearness: the plane's distance along the ray through p, over p's. */
static bool is_before(const stratus_gates* gates, const stratus_view_point* p, const stratus_view_point face[3], double* nearness)
{
  const stratus_view_point u = minus(face + 1, face), v = minus(face + 2, face), from = minus(p, face);
  const stratus_view_point normal = { u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x };
  const double length = sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
  const double size = sqrt(u.x * u.x + u.y * u.y + u.z * u.z) + sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  const double plane = gates->parallel ? normal.z : normal.x * face->x + normal.y * face->y + normal.z * face->z;
  const double beyond = normal.x * from.x + normal.y * from.y + normal.z * from.z;
  *nearness = gates->parallel ? 1.0 : plane / (plane + beyond);
  return (plane > 0.0 ? beyond : -beyond) <= LEAST_DEPTH * length * size;
}

bool stratus_gate_lies_before(const stratus_gates* gates, int64_t a, int64_t b)
{
  stratus_view_point polygon[CORNERS_MAX + 2], front[3], back[3], middle = { 0.0, 0.0, 0.0 };
  double size = 0.0, nearness;
  int count = 3;
  stratus_gate_points(gates, a, front);
  stratus_gate_points(gates, b, back);
  memcpy(polygon, front, sizeof front);
  const double turn = turn_of(gates, back, back + 1, back + 2);
  for (int e = 0; e < 3 && count >= 3; ++e) {
    double distance[CORNERS_MAX + 2];
    for (int i = 0; i < count; ++i) {
      distance[i] = turn_of(gates, back + (e + 1) % 3, back + (e + 2) % 3, polygon + i) * turn;
    }
    count = clip(polygon, count, distance);
  }
  for (int i = 0; i < count; ++i) {
    size += i >= 2 ? fabs(turn_of(gates, polygon, polygon + i - 1, polygon + i)) : 0.0;
    middle.x += polygon[i].x / count;
    middle.y += polygon[i].y / count;
    middle.z += polygon[i].z / count;
  }
  if (count < 3 || !is_before(gates, &middle, back, &nearness)) {
    return false;
  }
  const double front_turn = turn_of(gates, front, front + 1, front + 2), size_behind = size * nearness * nearness * nearness;
  return size > LEAST_SHARE * fabs(front_turn) || size_behind > LEAST_SHARE * fabs(turn);
}
