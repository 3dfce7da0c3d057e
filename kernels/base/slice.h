/* SPDX-License-Identifier: BSD-3-Clause
 * Where lines meet a surface on which a function of second degree is 0: twice at most. */
#ifndef STRATUS_SLICE_H
#define STRATUS_SLICE_H

#include "slice_arguments.h"

/* The function along a line from `d`, which is relative to the center, by steps `e`: of the number s of steps 0, 1 and 2 degrees. */
INLINE void slice_along(CONSTANT stratus_slice_arguments* f, const real d[3], const real e[3], real degree[3])
{
  degree[0] = r_of(f->level);
  degree[1] = degree[2] = r_number(0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    const int next = axis < 2 ? axis + 1 : 0; /* 3: x y, 4: y z, 5: z x */
    const real square = r_of(f->square[axis]), cross = r_of(f->square[3 + axis]), linear = r_of(f->linear[axis]);
    degree[0] = r_add(degree[0], r_mul(d[axis], r_add(linear, r_add(r_mul(square, d[axis]), r_mul(cross, d[next])))));
    degree[1] = r_add(degree[1], r_mul(linear, e[axis]));
    degree[1] = r_add(degree[1], r_mul(square, r_mul(r_number(2.0f), r_mul(d[axis], e[axis]))));
    degree[1] = r_add(degree[1], r_mul(cross, r_add(r_mul(d[axis], e[next]), r_mul(e[axis], d[next]))));
    degree[2] = r_add(degree[2], r_mul(e[axis], r_add(r_mul(square, e[axis]), r_mul(cross, e[next]))));
  }
}

/* Where a function of degree 2 is 0: the lower and the higher number, LARGEST_FLOAT where there is none. The root that would be a
 * difference of nearly equal numbers comes from the product of both. */
INLINE void slice_roots(const real degree[3], real roots[2])
{
  const real zero = r_number(0.0f), none = r_number(LARGEST_FLOAT), one = r_number(1.0f);
  const real inside = r_sub(r_mul(degree[1], degree[1]), r_mul(r_number(4.0f), r_mul(degree[2], degree[0])));
  const rmask meets = r_lt(zero, inside), falls = r_lt(degree[1], zero);
  const real root = r_sqrt(r_select(meets, inside, one));
  const real sum = r_select(falls, r_sub(degree[1], root), r_add(degree[1], root)), half_sum = r_mul(r_number(-0.5f), sum);
  const rmask plane = r_lt(zero, r_max(degree[2], r_neg(degree[2]))), has_sum = r_lt(zero, r_max(sum, r_neg(sum)));
  const real far = r_div(half_sum, r_select(plane, degree[2], one)), near = r_div(degree[0], r_select(has_sum, half_sum, one));
  const real first = r_select(meets, r_select(plane, far, none), none), second = r_select(meets, r_select(has_sum, near, none), none);
  roots[0] = r_min(r_min(first, second), none);
  roots[1] = r_min(r_max(first, second), none);
}

#endif
