/* SPDX-License-Identifier: BSD-3-Clause
 * A frustum made ready for many tests. All tests of boxes share these predicates, so that each way through a tree sees the same. */
#ifndef STRATUS_FRUSTUM_H
#define STRATUS_FRUSTUM_H

#include "base.h"
#include "vector.h"

#define STRATUS_PLANES 6
#define STRATUS_DEPENDENT_BELOW 1e-12 /* volume of three unit vectors that no longer span a space */
/* Of a plane's value at a point, relative to the sum of its terms' magnitudes: four products and sums round by less. */
#define STRATUS_PLANE_SLACK 2e-15
#define STRATUS_COORDINATE_MAX 1e30 /* beyond it a box has no bounds */

typedef struct stratus_frustum_plan {
  double planes[STRATUS_PLANES][4]; /* scaled by powers of two, so that the largest coefficient of the normal is in .5..1 */
  double lengths[STRATUS_PLANES];   /* of the normals */
  double eye[3];
  unsigned used; /* bit p: plane p cuts */
  bool empty;    /* a plane lets nothing through */
  /* for separating axes */
  bool solid;           /* the planes make eight corners; else six half-spaces are all that is known */
  double corners[8][3]; /* bit 0: right, 1: top, 2: far */
  bool directions[8];   /* that corner lies at infinity, in this direction */
  double edges[12][3];
  int edge_count;
} stratus_frustum_plan;

/* exact: prepare separating axes, too. */
void stratus_frustum_prepare(const stratus_frustum* frustum, bool exact, stratus_frustum_plan* plan);

/* A box in general: turned by three half edges, or along the axes where they are diagonal. */
typedef struct stratus_solid_box {
  double center[3];
  double half[3][3];
  bool turned;
} stratus_solid_box;

stratus_solid_box stratus_solid_box_of_bounds(const double bounds[6]);
stratus_solid_box stratus_solid_box_of_turned(const double box[12]);

/* Of a sphere about the box: exact where the half edges are orthogonal. */
double stratus_solid_box_radius(const stratus_solid_box* box);

/* True if the six numbers are bounds that a tree can place. */
bool stratus_bounds_finite(const double bounds[6]);
/* Against the planes of `mask` only. */
stratus_side stratus_plan_side(const stratus_frustum_plan* plan, unsigned mask, const double bounds[6]);
stratus_side stratus_plan_side_turned(const stratus_frustum_plan* plan, unsigned mask, const stratus_solid_box* box);
/* ---- frustum_exact.c */
/* Fills corners and edges; false where the planes make no solid of eight corners. */
bool stratus_plan_find_corners(stratus_frustum_plan* plan);
/* True if some axis surely separates the box from a solid plan. */
bool stratus_plan_separated(const stratus_frustum_plan* plan, const stratus_solid_box* box);

#endif
