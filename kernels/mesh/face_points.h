/* SPDX-License-Identifier: BSD-3-Clause
 * The points of a tetrahedron's faces, in an order that both cells at a face share. Face f is opposite vertex f. */
#ifndef STRATUS_FACE_POINTS_H
#define STRATUS_FACE_POINTS_H

/* A cell that names a point twice has no volume, shares no faces, and is not drawn. */
static inline int stratus_names_a_point_twice(const int v[4])
{
  return v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] || v[2] == v[3];
}

/* Sets point[] to face f's point numbers, ascending, so that both cells at a face get the same. Returns 1 or -1: times the cell's
 * orientation it is the orientation of (point[0], point[1], point[2], vertex f). */
static inline int stratus_face_points(const int cell[4], int f, int point[3])
{
  /* (1 3 2), (0 2 3), (0 3 1), (0 1 2): followed by f, each is an even permutation of 0 1 2 3. */
  int a = cell[f == 0], b = cell[f == 0 ? 3 : f == 1 ? 2 : f == 2 ? 3 : 1], c = cell[f == 0 ? 2 : f == 1 ? 3 : f == 2 ? 1 : 2];
  int sign = 1;
#define STRATUS_EXCHANGE(p, q)                                                                                                             \
  if (p > q) {                                                                                                                             \
    const int kept = p;                                                                                                                    \
    p = q;                                                                                                                                 \
    q = kept;                                                                                                                              \
    sign = -sign;                                                                                                                          \
  }
  STRATUS_EXCHANGE(a, b)
  STRATUS_EXCHANGE(b, c)
  STRATUS_EXCHANGE(a, b)
#undef STRATUS_EXCHANGE
  point[0] = a;
  point[1] = b;
  point[2] = c;
  return sign;
}

#endif
