/* SPDX-License-Identifier: BSD-3-Clause
 * Lattices of hexahedra: marched without lists of their cells, or projected as a list of tetrahedra. */
#ifndef STRATUS_TETRA_LATTICE_H
#define STRATUS_TETRA_LATTICE_H

#include "mesh.h"
#include "tetra_cells.h"

/* tetra_lattice.c */
/* Whether a hexahedron shows by its flag and coordinates, whatever its values. first: its first corner; corner: distances of all from it.
 */
bool stratus_lattice_shows(const stratus_mesh* mesh, const int64_t corner[8], int64_t first, int64_t cell);
/* Makes the form that rays read, as stratus_tetra_mesh_create() does. */
stratus_status stratus_tetra_lattice_create(stratus_context* context, const stratus_mesh* mesh, stratus_tetra_mesh** out);
/* stratus_tetra_mesh_take_values() of a lattice. */
stratus_status stratus_tetra_lattice_take_values(stratus_tetra_mesh* tetra, const stratus_mesh* mesh, bool* taken);

/* tetra_lattice_list.c: a lattice as a mesh whose cells are listed. It borrows what it can of the lattice. */
struct stratus_tetra_list {
  stratus_context* context;
  stratus_mesh mesh, source;
  void *points, *vertices, *values, *hidden;
};

stratus_status stratus_tetra_list_create(stratus_context* context, const stratus_mesh* lattice, stratus_tetra_list** out);
void stratus_tetra_list_destroy(stratus_tetra_list* list); /* takes NULL */

#endif
