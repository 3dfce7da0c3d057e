/* SPDX-License-Identifier: BSD-3-Clause
 * Which of two neighbours is in front: the side of their face on which the eye is. The four determinants of a cell share their minors in double;
 * where one is smaller than what rounding may have done to it the exact sign decides, so that both owners of a face always agree. */
#include "visibility_order.h"

#include "kernels/face_signs.h"

#define AHEAD 24 /* cells that lie scattered in the mesh are asked for so much earlier than they are read */

/* The power of two that brings all points, seen from `from`, to at most 1. */
static double view_scale(const stratus_visibility_order* order, const double from[3])
{
  double largest = 0.0;
  int exponent;
  for (int i = 0; i < 6; i++) {
    largest = fmax(largest, fabs(order->bounds[i] - from[i / 2]));
  }
  (void)frexp(largest, &exponent);
  return ldexp(1.0, exponent < -1000 ? 1000 : -exponent);
}

/* Perspective: points as seen from the eye. Parallel: x and y across the direction, so that the determinant with ones for z is the one along
 * the direction; z, which is not part of it, says how far. */
void stratus_order_see_points(stratus_visibility_order* order, const stratus_view* view)
{
  const double* d = view->direction;
  const double middle[3] = { 0.5 * order->bounds[0] + 0.5 * order->bounds[1], 0.5 * order->bounds[2] + 0.5 * order->bounds[3],
    0.5 * order->bounds[4] + 0.5 * order->bounds[5] };
  const double* origin = view->parallel ? middle : view->eye;
  const double scale = view_scale(order, origin);
  const int k = fabs(d[0]) > fabs(d[1]) ? (fabs(d[0]) > fabs(d[2]) ? 0 : 2) : (fabs(d[1]) > fabs(d[2]) ? 1 : 2);
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const double slope_i = view->parallel ? d[i] / d[k] : 0.0, slope_j = view->parallel ? d[j] / d[k] : 0.0;
  const int x_at = d[k] > 0.0 ? 0 : 1; /* turned round, x and y change places */
#pragma omp parallel for schedule(static) num_threads(order->context->threads)
  for (int64_t p = 0; p < order->point_count; p++) {
    const double* point = order->points + 3 * p;
    double* seen = stratus_order_seen(order, p);
    const double from[3] = { (point[0] - origin[0]) * scale, (point[1] - origin[1]) * scale, (point[2] - origin[2]) * scale };
    if (view->parallel) {
      seen[x_at] = from[i] - slope_i * from[k];
      seen[1 - x_at] = from[j] - slope_j * from[k];
      seen[2] = (from[k] + slope_i * from[i] + slope_j * from[j]) * (x_at ? -1.0 : 1.0);
    } else {
      seen[0] = from[0];
      seen[1] = from[1];
      seen[2] = from[2];
    }
  }
}

int stratus_order_exact_sign(const stratus_visibility_order* order, const stratus_view* view, uint32_t cell, int f)
{
  const int32_t* v = stratus_order_vertices(order, cell);
  int32_t point[3];
  const int parity = stratus_face_points(v, f, point);
  const double *a = order->points + 3 * (int64_t)point[0], *b = order->points + 3 * (int64_t)point[1],
               *c = order->points + 3 * (int64_t)point[2];
  return parity * (view->parallel ? stratus_orientation_along(a, b, c, view->direction) : -stratus_orientation(a, b, c, view->eye));
}

int64_t stratus_order_find_signs(stratus_visibility_order* order, const stratus_view* view)
{
  stratus_order_see_points(order, view);
  int64_t exact = 0;
#pragma omp parallel for schedule(static) num_threads(order->context->threads) reduction(+ : exact)
  for (int64_t cell = 0; cell < order->cell_count; cell++) {
    if (order->listed && cell + AHEAD < order->cell_count) {
      STRATUS_FETCH(order->vertices + 4 * (int64_t)order->listed[cell + AHEAD]);
    }
    const int32_t* v = stratus_order_vertices(order, (uint32_t)cell);
    stratus_ordered_cell* ordered = order->ordered + cell;
    const int32_t* neighbours = ordered->neighbours;
    const double *p0 = stratus_order_seen(order, v[0]), *p1 = stratus_order_seen(order, v[1]), *p2 = stratus_order_seen(order, v[2]),
                 *p3 = stratus_order_seen(order, v[3]);
    double det[4];
    unsigned after = 0, before = 0;
    face_determinants(p0, p1, p2, p3, view->parallel, det);
    for (int f = 0; f < 4; f++) {
      int sign = face_sign(det[f]);
      if (neighbours[f] < 0) {
        continue;
      }
      if (sign == 0 && ordered->side != 0) {
        sign = stratus_order_exact_sign(order, view, (uint32_t)cell, f);
        exact++;
      }
      /* A positive determinant has the eye on the negative side: in front of the face for a cell that lies on the positive one. */
      sign *= ordered->side;
      before |= (unsigned)(sign > 0) << f;
      after |= (unsigned)(sign < 0) << f;
    }
    stratus_order_take_state(ordered, before << 4 | after);
    ordered->key = face_signs_key(p0, p1, p2, p3, view->parallel);
  }
  return exact;
}

float stratus_order_key(const stratus_visibility_order* order, uint32_t cell)
{
  const int32_t* v = stratus_order_vertices(order, cell);
  return face_signs_key(stratus_order_seen(order, v[0]), stratus_order_seen(order, v[1]), stratus_order_seen(order, v[2]),
    stratus_order_seen(order, v[3]), order->view.parallel);
}

int stratus_order_facing(const stratus_visibility_order* order, uint32_t face)
{
  const int32_t* v = stratus_order_vertices(order, face / 4);
  double det[4];
  face_determinants(stratus_order_seen(order, v[0]), stratus_order_seen(order, v[1]), stratus_order_seen(order, v[2]),
    stratus_order_seen(order, v[3]), order->view.parallel, det);
  return -face_sign(det[face % 4]) * order->ordered[face / 4].side;
}

double stratus_order_face_size(const stratus_visibility_order* order, uint32_t cell, int face)
{
  const int32_t* v = stratus_order_vertices(order, cell);
  double det[4], size = 1.0;
  face_determinants(stratus_order_seen(order, v[0]), stratus_order_seen(order, v[1]), stratus_order_seen(order, v[2]),
    stratus_order_seen(order, v[3]), order->view.parallel, det);
  for (int i = 0; i < 4 && !order->view.parallel; i++) {
    const double* p = stratus_order_seen(order, v[i]);
    size *= i == face ? 1.0 : sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  }
  return size > 0.0 ? fabs(det[face]) / size : 0.0;
}
