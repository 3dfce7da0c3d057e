/* SPDX-License-Identifier: BSD-3-Clause
 * Frusta as solids: their corners, and every axis that may separate one from a box. The six half-spaces by themselves keep boxes beyond an
 * edge. */
#include "frustum.h"

#include "vector.h"

#include <string.h>

/* Error of a corner's position, relative to its distance: an intersection of three planes is less exact than a plane. */
#define CORNER_SLACK 1e-9

/* ---- corners */

/* Point where three planes meet, or, without the third, the direction of the line in which two meet. Returns false where they do not. */
static bool meet(const double p[4], const double q[4], const double* r, double result[3])
{
  double pq[3], qr[3], rp[3];
  stratus_vector_cross(p, q, pq);
  if (!r) {
    memcpy(result, pq, sizeof pq);
    return stratus_vector_normalize(result) > STRATUS_DEPENDENT_BELOW;
  }
  stratus_vector_cross(q, r, qr);
  stratus_vector_cross(r, p, rp);
  const double volume = stratus_vector_dot(pq, r);
  if (!(fabs(volume) > STRATUS_DEPENDENT_BELOW)) {
    return false;
  }
  for (int a = 0; a < 3; ++a) {
    result[a] = -(p[3] * qr[a] + q[3] * rp[a] + r[3] * pq[a]) / volume;
  }
  return isfinite(result[0]) && isfinite(result[1]) && isfinite(result[2]);
}

/* True if the corner is in the frustum: half-spaces that bound no solid have corners outside. */
static bool corner_is_inside(const stratus_frustum_plan* plan, int corner)
{
  const double* point = plan->corners[corner];
  for (int p = 0; p < STRATUS_PLANES; ++p) {
    const double* n = plan->planes[p];
    const double w = plan->directions[corner] ? 0.0 : n[3];
    const double size = fabs(n[0] * point[0]) + fabs(n[1] * point[1]) + fabs(n[2] * point[2]) + fabs(w);
    if (plan->used >> p & 1 && !(stratus_vector_dot(n, point) + w >= -CORNER_SLACK * size)) {
      return false;
    }
  }
  return true;
}

static void add_edge(stratus_frustum_plan* plan, int from, int to)
{
  double edge[3], along[3];
  if (plan->directions[from] && plan->directions[to]) {
    return; /* both corners are at infinity */
  }
  for (int a = 0; a < 3; ++a) {
    const double* finite = plan->corners[from];
    edge[a] = plan->directions[to] ? plan->corners[to][a] : plan->directions[from] ? finite[a] : plan->corners[to][a] - finite[a];
  }
  if (stratus_vector_normalize(edge) == 0.0) {
    return; /* both corners are the tip of a pyramid */
  }
  for (int e = 0; e < plan->edge_count; ++e) {
    stratus_vector_cross(edge, plan->edges[e], along);
    if (stratus_vector_dot(along, along) < 1e-28) {
      return;
    }
  }
  memcpy(plan->edges[plan->edge_count++], edge, sizeof edge);
}

bool stratus_plan_find_corners(stratus_frustum_plan* plan)
{
  const unsigned ends = plan->used >> 4;
  if ((plan->used & 15) != 15 || ends == 0) {
    return false;
  }
  for (int c = 0; c < 8; ++c) {
    const bool missing = !(ends >> (c >> 2) & 1);
    plan->directions[c] = missing;
    double* corner = plan->corners[c];
    if (!meet(plan->planes[c & 1], plan->planes[2 + (c >> 1 & 1)], missing ? NULL : plan->planes[4 + (c >> 2)], corner)) {
      return false;
    }
    /* Without an end plane, the corner is one end of the line in which two sides meet: the end that lies inside the opposite end plane. */
    if (missing && stratus_vector_dot(corner, plan->planes[4 + !(c >> 2)]) < 0.0) {
      for (int a = 0; a < 3; ++a) {
        corner[a] = -corner[a];
      }
    }
    if (!corner_is_inside(plan, c)) {
      return false;
    }
  }
  for (int c = 0; c < 8; ++c) {
    for (int bit = 1; bit < 8; bit *= 2) {
      if (!(c & bit)) {
        add_edge(plan, c, c | bit);
      }
    }
  }
  return true;
}

/* ---- separating axes */

double stratus_solid_box_radius(const stratus_solid_box* box)
{
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      sum += fabs(stratus_vector_dot(box->half[i], box->half[j]));
    }
  }
  return sqrt(sum);
}

/* Finite corners are relative to the box's centre. */
static bool axis_separates(
  const stratus_frustum_plan* plan, const stratus_solid_box* box, double corners[8][3], const double axis[3], double size)
{
  const double reach = fabs(stratus_vector_dot(axis, box->half[0])) + fabs(stratus_vector_dot(axis, box->half[1])) +
    fabs(stratus_vector_dot(axis, box->half[2]));
  const double length = sqrt(stratus_vector_dot(axis, axis));
  if (!(length > STRATUS_DEPENDENT_BELOW)) {
    return false; /* parallel edges have no common normal */
  }
  double low = INFINITY, high = -INFINITY;
  for (int c = 0; c < 8; ++c) {
    const double value = stratus_vector_dot(axis, corners[c]);
    if (!plan->directions[c]) {
      low = fmin(low, value);
      high = fmax(high, value);
    } else if (value < -STRATUS_DEPENDENT_BELOW * length) {
      low = -INFINITY;
    } else if (value > STRATUS_DEPENDENT_BELOW * length) {
      high = INFINITY;
    }
  }
  const double slack = CORNER_SLACK * length * size;
  return low > reach + slack || high < -reach - slack;
}

bool stratus_plan_separated(const stratus_frustum_plan* plan, const stratus_solid_box* box)
{
  if (!plan->solid) {
    return false;
  }
  double corners[8][3], axis[3], edges[3][3], size = stratus_solid_box_radius(box);
  for (int c = 0; c < 8; ++c) {
    for (int a = 0; a < 3; ++a) {
      corners[c][a] = plan->corners[c][a] - (plan->directions[c] ? 0.0 : box->center[a]);
      size = plan->directions[c] ? size : fmax(size, fabs(corners[c][a]));
    }
  }
  for (int i = 0; i < 3; ++i) {
    /* A box along the axes has edges along all three, even where it is flat. */
    const double unit[3] = { i == 0, i == 1, i == 2 };
    memcpy(edges[i], box->turned ? box->half[i] : unit, sizeof unit);
    (void)stratus_vector_normalize(edges[i]);
  }
  for (int i = 0; i < 3; ++i) {
    stratus_vector_cross(edges[(i + 1) % 3], edges[(i + 2) % 3], axis);
    if (axis_separates(plan, box, corners, axis, size)) {
      return true;
    }
  }
  for (int e = 0; e < plan->edge_count; ++e) {
    for (int i = 0; i < 3; ++i) {
      stratus_vector_cross(plan->edges[e], edges[i], axis);
      if (axis_separates(plan, box, corners, axis, size)) {
        return true;
      }
    }
  }
  return false;
}
