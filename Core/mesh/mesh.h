/* SPDX-License-Identifier: BSD-3-Clause
 * Data derived from a mesh of tetrahedra: neighbours through faces, and exact orientations. */
#ifndef STRATUS_MESH_H
#define STRATUS_MESH_H

#include "face_points.h"
#include "stratus/mesh.h"
#include "volume.h"

/* Times the largest coordinate: points nearer than this to a partition's plane count as on it. It exceeds the rounding errors of a point
 * computed to be there. */
#define STRATUS_PLANE_TOLERANCE 0x1p-46

/* Face f of a cell is opposite its vertex f, and neighbours[4*cell + f] is the cell behind it, -1 at the border. A face that more than two
 * cells share, or two on the same side, is a border for all of them, and is counted. A cell that names a point twice has no neighbours. The
 * result is the same at any number of threads and on any device. */
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
/* stratus_mesh_check(), which also refuses lattices. */
stratus_status stratus_mesh_check_listed(stratus_context* context, const stratus_mesh* mesh);

/* Whether it is a lattice, or several. */
static inline bool stratus_mesh_is_lattice(const stratus_mesh* mesh)
{
  return mesh->lattice[0] != 0 || mesh->lattice[1] != 0 || mesh->lattice[2] != 0 || mesh->block_count != 0;
}

/* The parts of a mesh with points and values of their own: its blocks, or the mesh itself. */
static inline int stratus_mesh_part_count(const stratus_mesh* mesh)
{
  return mesh->block_count > 0 ? mesh->block_count : 1;
}

static inline const stratus_mesh* stratus_mesh_part(const stratus_mesh* mesh, int part)
{
  return mesh->block_count > 0 ? mesh->blocks + part : mesh;
}

static inline void stratus_mesh_point(const stratus_mesh* mesh, int64_t point, double at[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = mesh->points ? mesh->points[3 * point + axis] : (double)mesh->float_points[3 * point + axis];
  }
}

/* The mesh has passed stratus_mesh_check(). */
stratus_status stratus_adjacency_create(stratus_context* context, const stratus_mesh* mesh, stratus_adjacency** adjacency);
void stratus_adjacency_destroy(stratus_adjacency* adjacency); /* takes NULL */

/* The sign of the volume of tetrahedron abcd, det(b-a, c-a, d-a) (Shewchuk 1997). It is exact unless a difference overflows, or is below
 * 2^-250 of the largest along its axis. */
int stratus_orientation(const double a[3], const double b[3], const double c[3], const double d[3]);
/* The same for a point d at infinity: the sign of det(b-a, c-a, direction). */
int stratus_orientation_along(const double a[3], const double b[3], const double c[3], const double direction[3]);

#endif
