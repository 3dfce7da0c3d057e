/* SPDX-License-Identifier: BSD-3-Clause
 * What is derived from a mesh of tetrahedra: neighbours through faces, and exact orientations. */
#ifndef STRATUS_MESH_H
#define STRATUS_MESH_H

#include "stratus/mesh.h"
#include "volume.h"

/* Times the largest coordinate: points nearer than this to a partition's plane lie on it. It exceeds the rounding errors of a point
 * computed to be there. */
#define STRATUS_PLANE_TOLERANCE 0x1p-46

/* Face f of a cell is opposite its vertex f, and neighbours[4*cell + f] is the cell behind it, -1 at the border. A face that more than two
 * cells share, or two on the same side, is a border for all of them, and is counted. A cell that names a point twice has no neighbours. The
 * result is the same at any number of threads. */
typedef struct stratus_adjacency {
  stratus_context* context;
  int64_t cell_count;
  int32_t* neighbours;
  int8_t* orientation;                /* of each cell: stratus_orientation() of its vertices, 1, -1 or 0 */
  int64_t border_faces;               /* faces without a neighbour, for whatever reason */
  int64_t broken_faces, folded_faces; /* border faces that more than two cells share, or two on the same side: each cell's face counts */
  int64_t flat, inverted;             /* cells without volume, exactly; cells of negative orientation */
} stratus_adjacency;

/* mesh.c: a mesh's values as a volume of one row, so that both are fetched alike. */
stratus_volume stratus_mesh_values(const stratus_mesh* mesh);

/* The mesh has passed stratus_mesh_check(). */
stratus_status stratus_adjacency_create(stratus_context* context, const stratus_mesh* mesh, stratus_adjacency** adjacency);
void stratus_adjacency_destroy(stratus_adjacency* adjacency); /* takes NULL */

/* A cell that names a point twice has no volume, shares no faces, and is not drawn. */
static inline bool stratus_names_a_point_twice(const int32_t v[4])
{
  return v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] || v[2] == v[3];
}

/* Sets point[] to face f's point numbers, ascending, so that both cells at a face get the same. Returns 1 or -1: times the cell's
 * orientation it is the orientation of (point[0], point[1], point[2], vertex f). */
static inline int stratus_face_points(const int32_t cell[4], int f, int32_t point[3])
{
  /* Followed by f, each is an even permutation of 0 1 2 3. */
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

/* The sign of the volume of tetrahedron abcd, det(b-a, c-a, d-a) (Shewchuk 1997). It is exact unless a difference overflows, or is below
 * 2^-250 of the largest along its axis. */
int stratus_orientation(const double a[3], const double b[3], const double c[3], const double d[3]);
/* The same for a point d at infinity: the sign of det(b-a, c-a, direction). */
int stratus_orientation_along(const double a[3], const double b[3], const double c[3], const double direction[3]);

#endif
