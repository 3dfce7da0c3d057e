/* SPDX-License-Identifier: BSD-3-Clause
 * Which of two neighbours is in front: the side of their face on which the eye is. The four determinants of a cell share their minors in double;
 * where one is smaller than what rounding may have done to it the exact sign decides, so that both owners of a face always agree. */
#include "visibility_order.h"

#include <float.h>

/* Coordinates are brought to 1 at most. Perspective: differences with the eye, products of three, six of them: under 100 roundings of
 * DBL_EPSILON/2. Parallel: projected coordinates up to twice as large, with four roundings each: under 250. */
#define ERROR_BOUND (256.0 * DBL_EPSILON)

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
static void see_points(stratus_visibility_order* order, const stratus_view* view)
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

/* Of the triples (1 3 2), (0 2 3), (0 3 1), (0 1 2), one a face, as in stratus_face_points(). */
static inline void face_determinants(const double* p0, const double* p1, const double* p2, const double* p3, int parallel, double det[4])
{
  const double m01 = p0[0] * p1[1] - p0[1] * p1[0], m02 = p0[0] * p2[1] - p0[1] * p2[0], m03 = p0[0] * p3[1] - p0[1] * p3[0];
  const double m12 = p1[0] * p2[1] - p1[1] * p2[0], m13 = p1[0] * p3[1] - p1[1] * p3[0], m23 = p2[0] * p3[1] - p2[1] * p3[0];
  const double z0 = parallel ? 1.0 : p0[2], z1 = parallel ? 1.0 : p1[2], z2 = parallel ? 1.0 : p2[2], z3 = parallel ? 1.0 : p3[2];
  det[0] = m13 * z2 - m12 * z3 - m23 * z1;
  det[1] = m02 * z3 - m03 * z2 + m23 * z0;
  det[2] = m03 * z1 - m01 * z3 - m13 * z0;
  det[3] = m01 * z2 - m02 * z1 + m12 * z0;
}

/* The same as the sign of face_determinants() without rounding. */
static int exact_sign(const stratus_visibility_order* order, const stratus_view* view, const int32_t* v, int f)
{
  int32_t point[3];
  const int parity = stratus_face_points(v, f, point);
  const double *a = order->points + 3 * (int64_t)point[0], *b = order->points + 3 * (int64_t)point[1],
               *c = order->points + 3 * (int64_t)point[2];
  return parity * (view->parallel ? stratus_orientation_along(a, b, c, view->direction) : -stratus_orientation(a, b, c, view->eye));
}

static inline int count_bits(unsigned four)
{
  return (int)((four & 1) + (four >> 1 & 1) + (four >> 2 & 1) + (four >> 3 & 1));
}

static inline float cell_key(const double* p0, const double* p1, const double* p2, const double* p3, int parallel)
{
  if (parallel) {
    return (float)(p0[2] + p1[2] + p2[2] + p3[2]);
  }
  const double x = p0[0] + p1[0] + p2[0] + p3[0], y = p0[1] + p1[1] + p2[1] + p3[1], z = p0[2] + p1[2] + p2[2] + p3[2];
  return (float)sqrt(x * x + y * y + z * z);
}

int64_t stratus_order_find_signs(stratus_visibility_order* order, const stratus_view* view)
{
  see_points(order, view);
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
      int sign = (det[f] > ERROR_BOUND) - (det[f] < -ERROR_BOUND);
      if (neighbours[f] < 0) {
        continue;
      }
      if (sign == 0 && ordered->side != 0) {
        sign = exact_sign(order, view, v, f);
        exact++;
      }
      /* A positive determinant has the eye on the negative side: in front of the face for a cell that lies on the positive one. */
      sign *= ordered->side;
      before |= (unsigned)(sign > 0) << f;
      after |= (unsigned)(sign < 0) << f;
    }
    ordered->state = (uint8_t)(before << 4 | after);
    ordered->waiting = (uint8_t)count_bits(before);
    ordered->key = cell_key(p0, p1, p2, p3, view->parallel);
  }
  return exact;
}

float stratus_order_key(const stratus_visibility_order* order, uint32_t cell)
{
  const int32_t* v = stratus_order_vertices(order, cell);
  return cell_key(stratus_order_seen(order, v[0]), stratus_order_seen(order, v[1]), stratus_order_seen(order, v[2]),
    stratus_order_seen(order, v[3]), order->view.parallel);
}

int stratus_order_facing(const stratus_visibility_order* order, uint32_t face)
{
  const int32_t* v = stratus_order_vertices(order, face / 4);
  double det[4];
  face_determinants(stratus_order_seen(order, v[0]), stratus_order_seen(order, v[1]), stratus_order_seen(order, v[2]),
    stratus_order_seen(order, v[3]), order->view.parallel, det);
  return ((det[face % 4] < -ERROR_BOUND) - (det[face % 4] > ERROR_BOUND)) * order->ordered[face / 4].side;
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
