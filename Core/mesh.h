/* SPDX-License-Identifier: BSD-3-Clause
 * What a mesh of tetrahedra is made ready with, once for all views: neighbours through faces. */
#ifndef STRATUS_MESH_H
#define STRATUS_MESH_H

#include "internal.h"

/* Face f of a cell is opposite its vertex f. neighbours[4*cell + f]: the cell on the other side, -1 at the border. A face that more than two
 * cells share, or two on the same side, is a border to all of them (counted). Threaded; the same at any thread count. */
typedef struct stratus_adjacency {
  stratus_context* context;
  int64_t cell_count;
  int32_t* neighbours;
  int64_t border_faces, broken_faces; /* broken: shared by more than two */
  int64_t flat, inverted;             /* cells of no volume, by the exact sign; of negative orientation */
} stratus_adjacency;

stratus_status stratus_adjacency_create(stratus_context* context, const stratus_mesh* mesh, stratus_adjacency** adjacency);
void stratus_adjacency_destroy(stratus_adjacency* adjacency); /* takes NULL */

/* Sign of the volume of tetrahedron abcd (> 0: d lies on the side from which a, b, c run anticlockwise... the sign of det(b-a, c-a, d-a)): exact for all
 * doubles that do not overflow, by interval filter and expansion arithmetic (Shewchuk 1997, written anew). */
int stratus_orientation(const double a[3], const double b[3], const double c[3], const double d[3]);

#endif
