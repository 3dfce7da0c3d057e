/* SPDX-License-Identifier: BSD-3-Clause
 * The tetrahedra, points and values of a mesh by their numbers, alike of listed cells and of lattices. */
#ifndef STRATUS_TETRA_CELLS_H
#define STRATUS_TETRA_CELLS_H

#include "tetra_caster.h"

/* The axes along which a tetrahedron goes from the first corner of its hexahedron to the last. */
extern const int stratus_lattice_ways[6][3];
/* The hexahedron of a lattice whose first corner is a point; -1: there is none. */
int64_t stratus_lattice_hexahedron(const stratus_mesh* mesh, int64_t point);
/* The distances between the numbers of points that are neighbours along i, j and k. */
void stratus_lattice_steps(const stratus_mesh* mesh, int64_t step[3]);

/* A mesh, and the structures made of it. */
typedef struct stratus_tetra_cells {
  const stratus_tetra_mesh* tetra;
  const stratus_mesh* mesh;
  int64_t count; /* of tetrahedra, those that do not show included */
} stratus_tetra_cells;

stratus_tetra_cells stratus_tetra_cells_of(const stratus_tetra_mesh* tetra, const stratus_mesh* mesh);
/* Get the points of tetrahedron 0..count-1, as indices into the points of `tetra`, or into the mesh for listed cells. value: index of its
 * own value among the values of `tetra`. Returns false if the cell does not show or has no volume. */
bool stratus_tetra_cell_at(const stratus_tetra_cells* cells, int64_t number, int32_t v[4], int64_t* value);
/* Get the place of a point by the same index. */
void stratus_tetra_point_at(const stratus_tetra_cells* cells, int64_t point, double at[3]);

/* The values of a part of the mesh, see stratus_mesh_part(): the values of `tetra` from `first` on. */
typedef struct stratus_tetra_slots {
  const stratus_mesh* mesh; /* the part */
  int64_t first, count;
} stratus_tetra_slots;

stratus_tetra_slots stratus_tetra_slots_of(const stratus_tetra_cells* cells, int part);
/* The number in the part of its value 0..count-1; -1: there is none. */
int64_t stratus_tetra_value_at(const stratus_tetra_cells* cells, const stratus_tetra_slots* slots, int64_t slot);

int stratus_tetra_component_count(const stratus_mesh* mesh);
/* A component of a mesh's part as values of one. */
stratus_volume stratus_tetra_component(const stratus_mesh* part, int c);
/* stratus_volume_bias() of all parts' values of a component. */
double stratus_tetra_bias(const stratus_mesh* mesh, int c);
/* Return component c's values, reordered to match `tetra`. The caller frees the array. */
stratus_status stratus_tetra_fetch_component(const stratus_tetra_cells* cells, int c, double* bias, float** values);
/* Fetches the first component of a value; NAN where another component is not finite, so that its cells do not show. */
float stratus_tetra_fetch(const stratus_mesh* part, const stratus_volume* volume, double bias, size_t value);

#endif
