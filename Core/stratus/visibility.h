/* SPDX-License-Identifier: BSD-3-Clause
 * The order in which a mesh's cells hide one another. */
#ifndef STRATUS_PUBLIC_VISIBILITY_H
#define STRATUS_PUBLIC_VISIBILITY_H

#include "camera.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The cells of a mesh in an order in which none hides one before it. Which of two neighbours lies in front follows from the side of their
 * face on which the eye is: in double where its rounding cannot matter, else in exact arithmetic. So an order is exact where relations pass
 * through faces. Cells on both sides of a gap are ordered by their border faces where these cover one another in the view (nearest first
 * only; layers crosses gaps as it comes). Leaves are in order by their planes. Cells without volume pass relations on; folded ones (two
 * neighbours on the same side of a face) count as not sharing it. Cells with coincident faces count as sharing them, even if they name
 * different points. */

typedef struct stratus_visibility_order stratus_visibility_order;

typedef enum stratus_peeling {
  STRATUS_PEELING_NEAREST, /* one of the nearest, by distance in steps of hundreds of cells, after all that hide it and have not come yet,
                            * which are looked for depth first (Williams 1992). Default. */
  STRATUS_PEELING_LAYERS   /* all that nothing hides, then all that only these hid, ... (Li et al. 2012, section 3.1) */
} stratus_peeling;

/* Borrows the mesh (points, vertices) and what `leaves` points at, for as long as the order lives. leaves NULL: one leaf. A cell that
 * leaves its leaf's box, by more than a partition's cells may, is STRATUS_INVALID_ARGUMENT. Finds the neighbours once. */
STRATUS_API stratus_status stratus_visibility_order_create(
  stratus_context* context, const stratus_mesh* mesh, const stratus_leaves* leaves, stratus_visibility_order** order);
STRATUS_API void stratus_visibility_order_destroy(stratus_visibility_order* order);

typedef struct stratus_visibility_result {
  const uint32_t* cells; /* all cells of the mesh, front to back, without volume included; valid until the order's next call or end */
  int64_t count;
  int layers;     /* peeling layers: of the leaf that has most; else 0 */
  int64_t cycles; /* found, and broken: across a gap if they lead across one, else where the face between two of them is seen
                   * smallest, unless that took too long; those across gaps count if no other was broken in their leaf */
  int64_t
    forced;            /* cells that may have come before some that hide them. Layers: by distance alone, as cycles were too many to follow.
                        * Nearest:      that came without a look across the gaps at them, as those were given up, see `overlaps` and `gate_tests` */
  int64_t overlaps;    /* nearest: rings across gaps, found and broken: what lies across was both before and behind, as where cells overlap.
                        * A leaf of n cells gives up gaps after 64 + sqrt(n), */
  int64_t gate_tests;  /* nearest: tests of border faces, and of boxes around some, against those across a gap: the work that gaps make.
                        * or after 64 g sqrt(g) of these, for its g border faces at gaps, or after parts of both that add up to one */
  int64_t exact_signs; /* that double could not tell */
  int64_t flat, folded, inverted; /* cells without volume; faces with both cells on one side, 2 a pair; cells of negative orientation */
  int reused;   /* 1: the order is the last one, as every cell hides the neighbours that it hid then. Not with gaps, unless the eye
                 * has not moved (parallel: nor the direction turned). */
  size_t bytes; /* the order's own */
  double build_ms, signs_ms, peel_ms; /* of its making; of this call */
} stratus_visibility_result;

/* The order from the camera's eye (parallel: along its forward), whose right and up don't count. matrix: world = matrix * local, as in
 * stratus_mesh, NULL: the mesh's. After the same calls the same at any number of threads and on any device: a GPU with doubles finds the
 * signs of meshes that are not small, the host what rounding leaves open, and the order. */
STRATUS_API stratus_status stratus_visibility_order_sort(stratus_visibility_order* order, const stratus_camera* camera,
  const double matrix[16], stratus_peeling peeling, stratus_visibility_result* result);

#ifdef __cplusplus
}
#endif

#endif
