/* SPDX-License-Identifier: BSD-3-Clause
 * The order in which a mesh's cells hide one another. */
#ifndef STRATUS_PUBLIC_VISIBILITY_H
#define STRATUS_PUBLIC_VISIBILITY_H

#include "camera.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Cells are listed front to back: no cell hides a cell that is listed before it. Of two neighbours, the cell on the eye's side of their
 * common face is in front. This test uses double if rounding cannot change its result, otherwise exact arithmetic. An order is therefore
 * exact for relations through faces. Peeling nearest also orders cells on both sides of a gap, by border faces that overlap in the
 * view. Peeling layers does not: across gaps its order may be wrong, and no counter reports it. The planes of the tree order the leaves.
 * Cells without volume pass relations on. Neighbours on the same side of a face (folded) count as not sharing it. Cells with coincident
 * faces count as sharing them, even if they name different points. */

typedef struct stratus_visibility_order stratus_visibility_order;

typedef enum stratus_peeling {
  /* List the nearest cell next, by distance in steps of hundreds of cells, after a depth-first search has listed all cells that hide it
   * (Williams 1992). Default. */
  STRATUS_PEELING_NEAREST,
  /* List all cells that no cell hides, then all cells that only these hid, and so on (Li et al. 2012, section 3.1). */
  STRATUS_PEELING_LAYERS
} stratus_peeling;

/* Create an order, and find each cell's neighbours once. The order borrows the mesh (points, vertices) and the arrays of `leaves` until it
 * is destroyed. The mesh must list its cells in `vertices`; lattices and blocks are refused. leaves NULL: one leaf.
 * STRATUS_INVALID_ARGUMENT if a cell reaches out of its leaf's box farther than a partition's cells may. */
STRATUS_API stratus_status stratus_visibility_order_create(
  stratus_context* context, const stratus_mesh* mesh, const stratus_leaves* leaves, stratus_visibility_order** order);
STRATUS_API void stratus_visibility_order_destroy(stratus_visibility_order* order);

typedef struct stratus_visibility_result {
  /* All cells of the mesh, front to back, including cells without volume. Valid until the order's next call or its end. */
  const uint32_t* cells;
  int64_t count;
  int layers; /* peeling layers: number of layers of the leaf with most layers; otherwise 0 */
  /* Cycles found and broken. A cycle is broken across a gap if it crosses one, otherwise at the face that is seen smallest, unless the
   * search for that face took too long. If a leaf has cycles through faces, its cycles across gaps are not counted. */
  int64_t cycles;
  /* Cells that may come before cells that hide them. Layers: cells listed by distance only, because a leaf had too many cycles. Nearest:
   * cells listed without regard to gaps, because their leaf had exceeded the limit of `overlaps` and `gate_tests`. */
  int64_t forced;
  /* Nearest: cycles across gaps, found and broken. Two cells were each in front of the other, as happens if cells overlap. A leaf of
   * n cells with g border faces at gaps ignores gaps after 64 + sqrt(n) such cycles, after 64 g sqrt(g) gate tests, or once its fractions
   * of both limits add up to 1. */
  int64_t overlaps;
  /* Nearest: tests of border faces, and of boxes around some of them, against border faces across a gap. They measure the work that gaps
   * cause. */
  int64_t gate_tests;
  int64_t exact_signs; /* signs that double could not decide */
  int64_t flat, folded,
    /* Cells without volume; faces with both cells on one side, 2 for each pair; cells of negative orientation. */
    inverted;
  /* 1: the order is the same as the last one, because every cell hides the same neighbours as before. In a mesh with gaps this needs an eye
   * that has not moved (parallel: a direction that has not turned). */
  int reused;
  size_t bytes;                       /* memory of the order itself */
  double build_ms, signs_ms, peel_ms; /* build_ms: creation of the order; signs_ms, peel_ms: this call */
} stratus_visibility_result;

/* Sort the cells as the camera's eye sees them (parallel: along its forward). right and up do not matter. matrix: world = matrix * local,
 * as in stratus_mesh; NULL: the mesh's. The same sequence of calls gives the same order at any number of threads and on any device. A GPU
 * with doubles computes the signs of meshes that are not small, and a device that builds peels their layers. The host computes the signs
 * that rounding leaves open, peels leaves with rings, and lists the nearest first. STRATUS_INVALID_ARGUMENT for numbers that are not
 * finite, a singular matrix or a forward without length. */
STRATUS_API stratus_status stratus_visibility_order_sort(stratus_visibility_order* order, const stratus_camera* camera,
  const double matrix[16], stratus_peeling peeling, stratus_visibility_result* result);

#ifdef __cplusplus
}
#endif

#endif
