/* SPDX-License-Identifier: BSD-3-Clause
 * What a mesh of tetrahedra is made ready with, once for all views: neighbours through faces. */
#ifndef STRATUS_MESH_H
#define STRATUS_MESH_H

#include "volume.h"

/* Of the largest coordinate: what lies nearer to a partition's plane lies on it. Some roundings of a point that is computed to be there. */
#define STRATUS_PLANE_TOLERANCE 0x1p-46

/* Face f of a cell is opposite its vertex f. neighbours[4*cell + f]: the cell on the other side, -1 at the border. A face that more than
 * two cells share, or two on the same side, is a border to all of them (counted). A cell that names a point twice has no neighbours; what
 * lies on both sides of it has. Threaded; the same at any thread count. */
typedef struct stratus_adjacency {
  stratus_context* context;
  int64_t cell_count;
  int32_t* neighbours;
  int8_t* orientation;                /* a cell: stratus_orientation() of its vertices as they come, +1, -1, 0 */
  int64_t border_faces;               /* without neighbour, whatever the reason */
  int64_t broken_faces, folded_faces; /* of those: shared by more than two; by two on the same side. One count an owner. */
  int64_t flat, inverted;             /* cells of no volume, by the exact sign; of negative orientation */
} stratus_adjacency;

/* mesh.c: a mesh's values as volumes have them, so that fetching is the same. */
stratus_volume stratus_mesh_values(const stratus_mesh* mesh);

/* The mesh is one that stratus_mesh_check() passed. */
stratus_status stratus_adjacency_create(stratus_context* context, const stratus_mesh* mesh, stratus_adjacency** adjacency);
void stratus_adjacency_destroy(stratus_adjacency* adjacency); /* takes NULL */

/* Such a cell has no volume, no faces to share, and nothing to draw. */
static inline bool stratus_names_a_point_twice(const int32_t v[4])
{
  return v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] || v[2] == v[3];
}

/* Face f's vertices in rising order of point number, so that both owners see the same, and where they stand in the cell: returns the sign
 * that turns the cell's orientation into the orientation of (a, b, c, vertex f), 1 or -1. */
static inline int stratus_face_points(const int32_t cell[4], int f, int32_t point[3])
{
  /* With f behind them these are even permutations of 0 1 2 3. */
  static const int8_t others[4][3] = { { 1, 3, 2 }, { 0, 2, 3 }, { 0, 3, 1 }, { 0, 1, 2 } };
  int32_t a = cell[others[f][0]], b = cell[others[f][1]], c = cell[others[f][2]];
  int sign = 1;
#define STRATUS_EXCHANGE(p, q)                                                                                                             \
  if (p > q) {                                                                                                                             \
    const int32_t kept = p;                                                                                                                \
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

/* Sign of the volume of tetrahedron abcd, det(b-a, c-a, d-a): exact for all doubles of which no difference overflows or, along an axis, is
 * below 2^-250 of the largest there (Shewchuk 1997). */
int stratus_orientation(const double a[3], const double b[3], const double c[3], const double d[3]);
/* The same where d lies infinitely far away: det(b-a, c-a, direction). */
int stratus_orientation_along(const double a[3], const double b[3], const double c[3], const double direction[3]);

#endif
