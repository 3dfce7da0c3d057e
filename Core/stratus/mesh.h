/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes of tetrahedra, and their partition by planes. */
#ifndef STRATUS_PUBLIC_MESH_H
#define STRATUS_PUBLIC_MESH_H

#include "volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A view of a mesh of linear tetrahedra. */
typedef struct stratus_mesh {
  const double* points;    /* point_count triples, local coordinates, finite */
  int64_t point_count;     /* 0..2^31-1; points that no cell uses are allowed */
  const int32_t* vertices; /* cell_count quadruples of point numbers; any orientation */
  int64_t cell_count;      /* 0..2^30-1 */
  const void* values;      /* a value a point, or a cell, value_stride apart; NULL where only geometry counts */
  stratus_type type;
  int64_t value_stride;  /* in values, >= 1. Default 1. */
  int cell_values;       /* 1: a value belongs to a cell, constant in it. Default 0. */
  const uint8_t* hidden; /* a flag a cell, not 0: transparent; NULL: none. Values that are not finite hide their cells, too. */
  double matrix[16];     /* row-major affine: world = matrix * local; default identity; mirror and shear allowed */
  uint64_t revision;     /* the caller raises it when anything changes under the same pointers. Default 0. */
} stratus_mesh;

STRATUS_API stratus_mesh stratus_mesh_default(void);
/* Checks a view: pointers, counts, point numbers, finite points, invertible matrix. */
STRATUS_API stratus_status stratus_mesh_check(stratus_context* context, const stratus_mesh* mesh);

/* A mesh cut along planes into the leaves of a K-D tree (Li et al. 2012, section 2), so that each cell lies in one leaf and leaves can be
 * sorted apart. Points keep their numbers; a point on a cut edge comes behind them, once, whoever asks for it: pieces of neighbours meet in
 * the same points and faces. A point within 2^-46 of the cells' largest coordinate of a plane lies on it, for all cells alike: it is not
 * cut off, stays where it is, and its cells reach over the plane by so much. A cell that has a volume leaves no piece without one. */

typedef enum stratus_partition_rule {
  STRATUS_PARTITION_MEDIAN, /* of the planes through the mesh's own points between the 40 % and the 60 % quantile, the one that cuts fewest
                               cells */
  STRATUS_PARTITION_PAPER   /* of evenly spaced planes, the one that adds fewest cells among those that growth and imbalance admit */
} stratus_partition_rule;

typedef struct stratus_partition_options {
  stratus_partition_rule rule; /* default median */
  int depth;                   /* 0..16: at most 2^depth leaves. Default 3. */
  int planes;                  /* tried an axis and node, 1..4096. Default 64. */
  double growth;      /* the paper's Phi: most new cells per cell of the node, > 0, may be INFINITY. Default INFINITY (paper: .3). */
  double imbalance;   /* the paper's epsilon: |l - r| / ((l + r)/2) is below it, > 0. Default .5. */
  int rotations;      /* where no plane is admissible at the root the mesh is turned this many times at most, and cut again,
                       * 0..64. Default 0. */
  int64_t leaf_cells; /* a node of so many or fewer is not cut, >= 1. Default 1024. */
} stratus_partition_options;

STRATUS_API stratus_partition_options stratus_partition_options_default(void);

/* Node 0 is the root. */
typedef struct stratus_partition_node {
  int32_t axis;     /* 0..2; -1: a leaf */
  int32_t below;    /* child with the points whose coordinate is <= value; of a leaf: its number */
  int32_t above;    /* child with those >= value */
  int32_t reserved; /* 0 */
  double value;     /* of the coordinate along row `axis` of the frame */
} stratus_partition_node;

/* A tree over a mesh: what a partition gives, and what an order takes. */
typedef struct stratus_leaves {
  const stratus_partition_node* nodes;
  int32_t node_count;  /* >= 1 */
  int32_t leaf_count;  /* 1..65536 */
  const int32_t* leaf; /* of each cell, 0..leaf_count-1 */
  double frame[9];     /* rows: the axes along which the tree cuts, in the mesh's local coordinates. The identity unless it was rotated. */
} stratus_leaves;

typedef struct stratus_partition stratus_partition;

/* options may be NULL. The mesh is read during the call only; its values, hidden flags and matrix don't count. */
STRATUS_API stratus_status stratus_partition_create(
  stratus_context* context, const stratus_mesh* mesh, const stratus_partition_options* options, stratus_partition** partition);
STRATUS_API void stratus_partition_destroy(stratus_partition* partition);

typedef struct stratus_partition_result {
  const double* points; /* point_count triples: the mesh's, then those on cut edges */
  int64_t point_count;
  const int32_t* vertices; /* cell_count quadruples, leaf by leaf; each with the orientation of the cell that it comes from */
  int64_t cell_count;
  const int32_t* cells; /* the mesh's cell that each comes from */
  stratus_leaves leaves;
  int64_t old_points;    /* points of the mesh */
  const int32_t* ends;   /* 2 for each new point old_points + i: the ends of its edge, lower numbers than its own (one may be new, too) */
  const double* weights; /* 1 for each: value = (1 - weight)*value(ends[0]) + weight*value(ends[1]), 0 < weight < 1 */
  int64_t cut_cells;     /* of the mesh, that are not whole any more */
  int64_t tiny_pieces;   /* left out: of cells with a volume, but rounding left them none */
  int64_t largest_leaf;  /* cells */
  int rotations;         /* made */
} stratus_partition_result;

/* Valid while the partition lives. */
STRATUS_API void stratus_partition_get(const stratus_partition* partition, stratus_partition_result* result);

#ifdef __cplusplus
}
#endif

#endif
