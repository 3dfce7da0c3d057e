/* SPDX-License-Identifier: BSD-3-Clause
 * Relations through faces: of two neighbours, the one on the eye's side of their face is in front. A cell's four determinants are computed
 * in double and share their minors. Where a determinant is smaller than its error bound, exact arithmetic decides its sign, so that both
 * cells at a face always agree. */
#include "clones.h"
#include "visibility_order.h"

#include "face_signs.h"

#define LANES 8
#define AHEAD 24 /* how many cells ahead the vertices of scattered cells are prefetched */

/* The power of two that scales all points, relative to `from`, to at most 1. */
static double view_scale(const stratus_visibility_order* order, const double from[3])
{
  double largest = 0.0;
  for (int i = 0; i < 6; ++i) {
    largest = fmax(largest, fabs(order->bounds[i] - from[i / 2]));
  }
  return stratus_order_scale(largest);
}

/* Perspective: `seen` is relative to the eye. Parallel: x and y are across the direction, so that the determinant of three points with ones
 * for z is the one along the direction. z is the depth, which the determinant does not use. */
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
  const int x_at = d[k] > 0.0 ? 0 : 1; /* facing the other way swaps x and y */
#pragma omp parallel for schedule(static) num_threads(order->context->threads)
  for (int64_t p = 0; p < order->point_count; ++p) {
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

static face_point seen_point(const stratus_visibility_order* order, int64_t point)
{
  return face_point_at(stratus_order_seen(order, point));
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

/* ---- LANES cells at once, a clone for each instruction set. No clone contracts operations, so all give the same bits. */

typedef struct cell_lanes {
  const double* seen;
  int64_t at[4][LANES]; /* the vertices' places in `seen` */
  int64_t signs[LANES]; /* bit f: face f's determinant is surely positive; bit 4 + f: surely negative; neither: within its error bound */
} cell_lanes;

static ALWAYS_INLINE void find_lanes(cell_lanes* lanes, int parallel)
{
  for (int l = 0; l < LANES; ++l) {
    const double* seen = lanes->seen;
    const int64_t a = lanes->at[0][l], b = lanes->at[1][l], c = lanes->at[2][l], d = lanes->at[3][l];
    const face_point p0 = { seen[a], seen[a + 1], seen[a + 2] }, p1 = { seen[b], seen[b + 1], seen[b + 2] },
                     p2 = { seen[c], seen[c + 1], seen[c + 2] }, p3 = { seen[d], seen[d + 1], seen[d + 2] };
    double det[4];
    int64_t signs = 0;
    face_determinants(p0, p1, p2, p3, parallel, det);
    for (int f = 0; f < 4; ++f) {
      signs |= (det[f] > FACE_SIGNS_ERROR_BOUND ? (int64_t)1 << f : 0) | (det[f] < -FACE_SIGNS_ERROR_BOUND ? (int64_t)16 << f : 0);
    }
    lanes->signs[l] = signs;
  }
}

#define CLONE(name, attribute)                                                                                                             \
  attribute static void find_lanes_##name(cell_lanes* lanes, int parallel)                                                                 \
  {                                                                                                                                        \
    if (parallel) {                                                                                                                        \
      find_lanes(lanes, 1);                                                                                                                \
    } else {                                                                                                                               \
      find_lanes(lanes, 0);                                                                                                                \
    }                                                                                                                                      \
  }
CLONE(portable, )
#if HAVE_CLONES
CLONE(avx2, TARGET_AVX2)
CLONE(avx512, TARGET_AVX512)
#endif

typedef void find_lanes_function(cell_lanes* lanes, int parallel);

static find_lanes_function* choose_clone(const stratus_context* context)
{
#if HAVE_CLONES
  static find_lanes_function* const clones[3] = { find_lanes_portable, find_lanes_avx2, find_lanes_avx512 };
  return clones[context->isa < 2 ? context->isa : 2]; /* set 3 differs where volumes are read */
#else
  (void)context;
  return find_lanes_portable;
#endif
}

/* Sets a cell's state. Exact arithmetic decides faces with a neighbour whose determinant is within its error bound. Returns how many it
 * decided. */
static int64_t take_signs(stratus_visibility_order* order, const stratus_view* view, int64_t cell, unsigned signs, bool* changed)
{
  const int side = stratus_order_side(order, cell);
  unsigned positive = signs & 15u, negative = signs >> 4, open = order->sides[cell] & 15u & ~(positive | negative);
  int64_t exact = 0;
  for (int f = 0; open && side != 0 && f < 4; ++f) {
    if (open >> f & 1) {
      const int sign = stratus_order_exact_sign(order, view, (uint32_t)cell, f);
      positive |= (unsigned)(sign > 0) << f;
      negative |= (unsigned)(sign < 0) << f;
      ++exact;
    }
  }
  /* A positive determinant: the eye is on the face's negative side. A cell on the positive side then has its neighbour before it. */
  const unsigned state = side > 0 ? positive << 4 | negative : side < 0 ? negative << 4 | positive : 0;
  *changed = stratus_order_take_state(order, cell, state) || *changed;
  return exact;
}

int64_t stratus_order_find_signs(stratus_visibility_order* order, const stratus_view* view)
{
  find_lanes_function* const find = choose_clone(order->context);
  int64_t exact = 0;
  bool changed = false;
  stratus_order_see_points(order, view);
#pragma omp parallel for schedule(static) num_threads(order->context->threads) reduction(+ : exact) reduction(|| : changed)
  for (int64_t begin = 0; begin < order->cell_count; begin += LANES) {
    const int count = order->cell_count - begin < LANES ? (int)(order->cell_count - begin) : LANES;
    cell_lanes lanes;
    lanes.seen = order->seen;
    for (int l = 0; l < LANES; ++l) {
      const int64_t cell = begin + (l < count ? l : 0); /* the first cell fills the lanes that have none */
      if (order->listed && cell + AHEAD < order->cell_count) {
        STRATUS_FETCH(order->vertices + 4 * (int64_t)order->listed[cell + AHEAD]);
      }
      const int32_t* v = stratus_order_vertices(order, (uint32_t)cell);
      for (int k = 0; k < 4; ++k) {
        lanes.at[k][l] = stratus_order_seen_at(order, v[k]);
      }
    }
    find(&lanes, view->parallel);
    for (int l = 0; l < count; ++l) {
      exact += take_signs(order, view, begin + l, (unsigned)lanes.signs[l], &changed);
    }
  }
  order->relations_changed = changed;
  return exact;
}

float stratus_order_key(const stratus_visibility_order* order, uint32_t cell)
{
  const int32_t* v = stratus_order_vertices(order, cell);
  double sum[3] = { 0.0, 0.0, 0.0 };
  for (int i = 0; i < 4; ++i) {
    const double* p = stratus_order_seen(order, v[i]);
    sum[0] += p[0];
    sum[1] += p[1];
    sum[2] += p[2];
  }
  return (float)(order->view.parallel ? sum[2] : sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]));
}

double stratus_order_face_size(const stratus_visibility_order* order, uint32_t cell, int face)
{
  const int32_t* v = stratus_order_vertices(order, cell);
  double det[4], size = 1.0;
  face_determinants(
    seen_point(order, v[0]), seen_point(order, v[1]), seen_point(order, v[2]), seen_point(order, v[3]), order->view.parallel, det);
  for (int i = 0; i < 4 && !order->view.parallel; ++i) {
    const double* p = stratus_order_seen(order, v[i]);
    size *= i == face ? 1.0 : sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  }
  return size > 0.0 ? fabs(det[face]) / size : 0.0;
}
