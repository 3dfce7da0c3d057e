/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes of tetrahedra and lattices of hexahedra, and the partition of meshes by planes. */
#ifndef STRATUS_PUBLIC_MESH_H
#define STRATUS_PUBLIC_MESH_H

#include "volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A view of a mesh of linear tetrahedra. They are listed in `vertices`, or a lattice of hexahedra (structured, curvilinear, in layers)
 * consists of them. */
typedef struct stratus_mesh {
  const double* points;    /* point_count triples, local coordinates; finite unless the mesh is a lattice */
  int64_t point_count;     /* 0..2^31-1; may include points that no cell uses */
  const int32_t* vertices; /* cell_count quadruples of point numbers; any orientation */
  int64_t cell_count;      /* 0..2^30-1 */
  const void* values;      /* one value for each point or each cell, value_stride apart; NULL where only geometry matters */
  stratus_type type;
  int64_t value_stride; /* in values, >= components. Default 1. */
  /* 1..4, default 1 (0 counts as 1). Component c of value v is values[v*value_stride + c]. Casters draw several; everything else reads the
   * first. */
  int components;
  int cell_values; /* 1: a value belongs to a cell, and is constant in it. Default 0: to a point. */
  /* One flag for each cell: not 0 makes it transparent. NULL: none. A value that is not finite also hides its cells. */
  const uint8_t* hidden;
  /* One label for each cell, by which stratus_tetra_options.label_count chooses a function. NULL (default): none. Only casters read it. */
  const uint8_t* labels;
  double matrix[16]; /* row-major affine: world = matrix * local; default identity; mirror and shear allowed */
  uint64_t revision; /* the caller raises it when anything changes under the same pointers. Default 0. */
  /* The caller's number of the points, vertices and lattice. A caster takes them for the same in all meshes with the same number, under any
   * pointers, and need not compare them. Default 0: not known, so that the caster reads all of them when another mesh comes. */
  uint64_t geometry;
  /* A lattice. lattice: number of points along i, j and k, each at least 2, points[(k*nj + j)*ni + i]. Default 0, 0, 0: cells are listed in
   * `vertices`. In a lattice vertices is NULL, and cells, their values and flags are hexahedra, cell[(k*(nj-1) + j)*(ni-1) + i]. Each
   * hexahedron consists of six tetrahedra, one for each path along three edges from its first corner to its last. Neighbours divide their
   * common face in the same way. The tetrahedra of a layer keep their orientation for any thickness > 0 over any ground. A hexahedron that
   * is hidden, or has a value or a coordinate that is not finite, is transparent as a whole. Corners may coincide. Only casters accept
   * lattices. */
  int32_t lattice[3];
  const float* float_points; /* the points of a lattice whose `points` is NULL; otherwise NULL */
  /* Several lattices as one mesh. Rays pass from one to the next where a face of both has the same corners and the same diagonal. Each
   * block is a view of a lattice, with values of the mesh's type, components and cell_values; its matrix and revision are not read. The
   * mesh's point_count and cell_count are the sums over its blocks. Its points, float_points, vertices, values, hidden and labels are NULL,
   * its lattice is 0, and its value_stride and geometry are not read. Default NULL, 0. Only casters accept blocks. */
  const struct stratus_mesh* blocks;
  int block_count;
} stratus_mesh;

/* Return a view with the defaults. The caller sets at least points, vertices and their counts. */
STRATUS_API stratus_mesh stratus_mesh_default(void);
/* Check a view: pointers, counts, point numbers, finite points, invertible matrix. Other views give STRATUS_INVALID_ARGUMENT. */
STRATUS_API stratus_status stratus_mesh_check(stratus_context* context, const stratus_mesh* mesh);

/* A mesh that is cut along planes into the leaves of a K-D tree (Li et al. 2012, section 2). Each cell is in one leaf, so that leaves can
 * be sorted independently. Points keep their numbers. Each cut edge adds one point after the mesh's points, and all cells at that edge
 * share it: pieces of neighbours meet in the same points and faces. A point closer to a plane than 2^-46 times the cells' largest
 * coordinate counts as on the plane, for all cells: no cut moves it, and its cells may reach over the plane by that distance. A cell with a
 * volume has only pieces with a volume. */

/* The rule chooses the candidates for a node's plane. Among the candidates within the bounds on growth and imbalance, the plane that adds
 * fewest cells cuts the node. Of several such planes it is the most balanced. */
typedef enum stratus_partition_rule {
  STRATUS_PARTITION_MEDIAN, /* planes through the mesh's own points between the 40 % and the 60 % quantile of the cells */
  STRATUS_PARTITION_PAPER   /* evenly spaced planes */
} stratus_partition_rule;

typedef struct stratus_partition_options {
  stratus_partition_rule rule; /* default median */
  int depth;                   /* 0..16: at most 2^depth leaves. Default 3. */
  int planes;                  /* candidates along each axis of each node, 1..4096. Default 64. */
  /* The paper's Phi: upper bound on new cells for each cell of the node, > 0, may be INFINITY. Default INFINITY (paper: .3). */
  double growth;
  double imbalance; /* the paper's epsilon, > 0: bound on |l - r| / ((l + r)/2). Default .5. */
  /* Number of times that the mesh may be turned and cut again if no plane satisfies the bounds at the root, 0..64. Default 0. */
  int rotations;
  int64_t leaf_cells; /* a node of at most this many cells is not cut, >= 1. Default 1024. */
} stratus_partition_options;

/* Return options with their defaults. */
STRATUS_API stratus_partition_options stratus_partition_options_default(void);

/* A node of the tree. Node 0 is the root. */
typedef struct stratus_partition_node {
  int32_t axis;     /* 0..2; -1: a leaf */
  int32_t below;    /* child with the points whose coordinate is <= value; in a leaf: the leaf's number */
  int32_t above;    /* child with the points whose coordinate is >= value */
  int32_t reserved; /* 0 */
  double value;     /* the plane's coordinate along row `axis` of the frame */
} stratus_partition_node;

/* A tree over a mesh. stratus_partition_get() returns one, and a visibility order uses one. */
typedef struct stratus_leaves {
  const stratus_partition_node* nodes;
  int32_t node_count;  /* >= 1 */
  int32_t leaf_count;  /* 1..65536 */
  const int32_t* leaf; /* one number for each cell: its leaf, 0..leaf_count-1 */
  /* Rows: the axes along which the tree cuts, in the mesh's local coordinates. The identity unless the mesh was turned. */
  double frame[9];
} stratus_leaves;

typedef struct stratus_partition stratus_partition;

/* Cut a mesh. options may be NULL. The mesh is read during the call only; its values, hidden flags and matrix do not matter. Its cells must
 * be listed: a lattice, blocks, or options out of their ranges give an error. */
STRATUS_API stratus_status stratus_partition_create(
  stratus_context* context, const stratus_mesh* mesh, const stratus_partition_options* options, stratus_partition** partition);
STRATUS_API void stratus_partition_destroy(stratus_partition* partition);

typedef struct stratus_partition_result {
  const double* points; /* point_count triples: the mesh's points, then those on cut edges */
  int64_t point_count;
  const int32_t* vertices; /* cell_count quadruples, leaf by leaf; each piece has the orientation of its original cell */
  int64_t cell_count;
  const int32_t* cells; /* one number for each piece: its original cell in the mesh */
  stratus_leaves leaves;
  int64_t old_points; /* number of points of the mesh */
  /* 2 for each new point old_points + i: the ends of its edge. Their numbers are below its own; an end may be a new point, too. */
  const int32_t* ends;
  const double* weights; /* 1 for each new point: value = (1 - weight)*value(ends[0]) + weight*value(ends[1]), 0 < weight < 1 */
  int64_t cut_cells;     /* cells of the mesh that were cut */
  int64_t tiny_pieces;   /* pieces that rounding left without a volume, of cells that have one; the result omits them */
  int64_t largest_leaf;  /* number of its cells */
  int rotations;         /* number of times that the mesh was turned */
} stratus_partition_result;

/* Get the result. Its arrays stay valid while the partition exists. */
STRATUS_API void stratus_partition_get(const stratus_partition* partition, stratus_partition_result* result);

#ifdef __cplusplus
}
#endif

#endif
