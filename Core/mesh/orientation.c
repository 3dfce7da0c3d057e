/* SPDX-License-Identifier: BSD-3-Clause
 * The side of a plane on which a point lies, exactly (Shewchuk 1997). A determinant in double with an error bound decides most cases. The
 * rest are decided by expansions: exact sums, kept as several doubles whose bits do not overlap. */
#include "mesh.h"

#include <float.h>
#include <string.h>

/* Times the sum of the six products' magnitudes. Three differences, two products and three sums round by at most DBL_EPSILON/2 each; the
 * bound is twice their sum. */
#define ERROR_BOUND (8.0 * DBL_EPSILON)
/* Six products of three numbers. Each number is a head and a tail, so a product has 8 terms, and a term has 4 components. */
#define COMPONENTS_MAX (6 * 8 * 4)

typedef struct expansion {
  double part[COMPONENTS_MAX]; /* ascending in magnitude, none 0 */
  int count;
} expansion;

/* a + b == *sum + *rest exactly. */
static inline void add_exactly(double a, double b, double* sum, double* rest)
{
  const double s = a + b, b_part = s - a, a_part = s - b_part;
  *rest = (a - a_part) + (b - b_part);
  *sum = s;
}

static void expansion_add(expansion* e, double value)
{
  int kept = 0;
  for (int i = 0; i < e->count; ++i) {
    double rest;
    add_exactly(value, e->part[i], &value, &rest);
    if (rest != 0.0) {
      e->part[kept++] = rest;
    }
  }
  if (value != 0.0) {
    e->part[kept++] = value;
  }
  e->count = kept;
}

static void expansion_add_product(expansion* e, double a, double b, double c)
{
  if (a == 0.0 || b == 0.0 || c == 0.0) {
    return;
  }
  const double ab = a * b, ab_rest = fma(a, b, -ab);
  const double high = ab * c, low = ab_rest * c;
  expansion_add(e, fma(ab_rest, c, -low));
  expansion_add(e, low);
  expansion_add(e, fma(ab, c, -high));
  expansion_add(e, high);
}

/* The sign of the determinant whose rows r are the vectors head[r] + tail[r]. */
static int exact_sign(double head[3][3], double tail[3][3])
{
  static const int order[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 0, 2, 1 }, { 2, 1, 0 },
    { 1, 0, 2 } }; /* three even permutations, three odd */
  expansion sum = { .count = 0 };
  for (int a = 0; a < 3; ++a) {
    /* A power of two scales each axis, lest a product underflow. It does not change the sign. */
    double largest = 0.0;
    int exponent;
    for (int r = 0; r < 3; ++r) {
      largest = fmax(largest, fabs(head[r][a]));
    }
    if (largest == 0.0) {
      return 0;
    }
    (void)frexp(largest, &exponent);
    for (int r = 0; r < 3; ++r) {
      head[r][a] = ldexp(head[r][a], -exponent);
      tail[r][a] = ldexp(tail[r][a], -exponent);
    }
  }
  for (int p = 0; p < 6; ++p) {
    const double sign = p < 3 ? 1.0 : -1.0;
    for (int term = 0; term < 8; ++term) {
      double factor[3];
      for (int a = 0; a < 3; ++a) {
        factor[a] = term >> a & 1 ? tail[order[p][a]][a] : head[order[p][a]][a];
      }
      expansion_add_product(&sum, sign * factor[0], factor[1], factor[2]);
    }
  }
  return sum.count == 0 ? 0 : sum.part[sum.count - 1] > 0.0 ? 1 : -1;
}

/* The determinant of three rows. *size: the sum of its terms' magnitudes. */
static inline double determinant(const double u[3], const double v[3], const double w[3], double* size)
{
  const double yz = v[1] * w[2], zy = v[2] * w[1], zx = v[2] * w[0], xz = v[0] * w[2], xy = v[0] * w[1], yx = v[1] * w[0];
  *size = (fabs(yz) + fabs(zy)) * fabs(u[0]) + (fabs(zx) + fabs(xz)) * fabs(u[1]) + (fabs(xy) + fabs(yx)) * fabs(u[2]);
  return (yz - zy) * u[0] + (zx - xz) * u[1] + (xy - yx) * u[2];
}

/* The sign, or 0: undecided. Near DBL_MIN products underflow, where no relative error bound holds; hence 1e-290. */
static inline int filtered_sign(double value, double size)
{
  const double bound = ERROR_BOUND * size + 1e-290;
  return value > bound ? 1 : value < -bound ? -1 : 0;
}

static void difference(const double a[3], const double b[3], double head[3], double tail[3])
{
  for (int i = 0; i < 3; ++i) {
    add_exactly(a[i], -b[i], &head[i], &tail[i]);
  }
}

int stratus_orientation(const double a[3], const double b[3], const double c[3], const double d[3])
{
  double head[3][3], tail[3][3], size;
  for (int i = 0; i < 3; ++i) {
    head[0][i] = b[i] - a[i];
    head[1][i] = c[i] - a[i];
    head[2][i] = d[i] - a[i];
  }
  const double value = determinant(head[0], head[1], head[2], &size);
  const int sign = filtered_sign(value, size);
  if (sign != 0) {
    return sign;
  }
  difference(b, a, head[0], tail[0]);
  difference(c, a, head[1], tail[1]);
  difference(d, a, head[2], tail[2]);
  return exact_sign(head, tail);
}

/* The axis that a direction is parallel to; -1: none. */
static int axis_of(const double direction[3])
{
  const bool x = direction[0] != 0.0, y = direction[1] != 0.0, z = direction[2] != 0.0;
  return x && !y && !z ? 0 : y && !x && !z ? 1 : z && !x && !y ? 2 : -1;
}

/* The sign of p*q - r*s. Rounding is monotone, so products that round to different doubles are in the right order; for equal ones the
 * errors, which are doubles, decide. *sure is false if a product is so small or large that this may not hold. */
static int compare_products(double p, double q, double r, double s, bool* sure)
{
  const double pq = p * q, rs = r * s;
  const bool small = (fabs(pq) < 1e-250 && p != 0.0 && q != 0.0) || (fabs(rs) < 1e-250 && r != 0.0 && s != 0.0);
  *sure = !small && fabs(pq) <= 1e290 && fabs(rs) <= 1e290;
  if (pq != rs) {
    return pq > rs ? 1 : -1;
  }
  const double pq_rest = fma(p, q, -pq), rs_rest = fma(r, s, -rs);
  return (pq_rest > rs_rest) - (pq_rest < rs_rest);
}

/* A view along an axis sees most faces of a grid edge-on. Their determinants are 0, which expansions are slow to find; this takes two
 * products. Returns false if it cannot decide: a difference is not exact, or a product is too small or large. */
static bool find_sign_along_axis(const double a[3], const double b[3], const double c[3], const double direction[3], int axis, int* sign)
{
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  double u[2], v[2], rest[4];
  bool sure;
  add_exactly(b[i], -a[i], &u[0], &rest[0]);
  add_exactly(b[j], -a[j], &u[1], &rest[1]);
  add_exactly(c[i], -a[i], &v[0], &rest[2]);
  add_exactly(c[j], -a[j], &v[1], &rest[3]);
  *sign = compare_products(u[0], v[1], u[1], v[0], &sure) * (direction[axis] > 0.0 ? 1 : -1);
  return sure && rest[0] == 0.0 && rest[1] == 0.0 && rest[2] == 0.0 && rest[3] == 0.0;
}

int stratus_orientation_along(const double a[3], const double b[3], const double c[3], const double direction[3])
{
  double head[3][3], tail[3][3], size;
  int axis_sign;
  const int axis = axis_of(direction);
  if (axis >= 0 && find_sign_along_axis(a, b, c, direction, axis, &axis_sign)) {
    return axis_sign;
  }
  for (int i = 0; i < 3; ++i) {
    head[0][i] = b[i] - a[i];
    head[1][i] = c[i] - a[i];
  }
  const double value = determinant(head[0], head[1], direction, &size);
  const int sign = filtered_sign(value, size);
  if (sign != 0) {
    return sign;
  }
  difference(b, a, head[0], tail[0]);
  difference(c, a, head[1], tail[1]);
  memcpy(head[2], direction, sizeof head[2]);
  memset(tail[2], 0, sizeof tail[2]);
  return exact_sign(head, tail);
}
