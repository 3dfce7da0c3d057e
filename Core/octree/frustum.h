/* SPDX-License-Identifier: BSD-3-Clause
 * A frustum prepared for many tests. All tests of boxes share these predicates, so that every way through a tree gives the same answers. */
#ifndef STRATUS_FRUSTUM_H
#define STRATUS_FRUSTUM_H

#include "stratus/octree.h"
#include "base.h"
#include "vector.h"

#define STRATUS_PLANES 6
#define STRATUS_DEPENDENT_BELOW 1e-12 /* triple product of unit vectors that count as linearly dependent */
/* Bound on the rounding error of a plane's value at a point (four products and their sum), relative to the sum of the terms' magnitudes. */
#define STRATUS_PLANE_SLACK 2e-15
#define STRATUS_COORDINATE_MAX 1e30 /* a box with a larger coordinate has no bounds */

typedef struct stratus_frustum_plan {
  double planes[STRATUS_PLANES][4]; /* scaled by powers of two: the normal's largest coefficient is in 0.5..1 */
  double lengths[STRATUS_PLANES];   /* of the normals */
  double eye[3];
  unsigned used; /* bit p: plane p has a normal and is tested */
  bool empty;    /* a plane without a normal rejects everything */
  /* for separating axes only */
  bool solid;           /* the planes bound a solid with eight corners; false: they are only six half-spaces */
  double corners[8][3]; /* bit 0 of the index: right, bit 1: top, bit 2: far */
  bool directions[8];   /* the corner is at infinity, and corners[] holds its direction */
  double edges[12][3];
  int edge_count;
} stratus_frustum_plan;

/* exact: also prepares the separating axes. */
void stratus_frustum_prepare(const stratus_frustum* frustum, bool exact, stratus_frustum_plan* plan);

/* A box: its centre and three half edges. The half edges of a box that is not turned form a diagonal matrix. */
typedef struct stratus_solid_box {
  double center[3];
  double half[3][3];
  bool turned;
} stratus_solid_box;

stratus_solid_box stratus_solid_box_of_bounds(const double bounds[6]);
stratus_solid_box stratus_solid_box_of_turned(const double box[12]);

/* Radius of a sphere about the box, exact where the half edges are orthogonal. */
double stratus_solid_box_radius(const stratus_solid_box* box);

/* True if the tree can place these bounds: six finite numbers of magnitude STRATUS_COORDINATE_MAX at most. */
bool stratus_bounds_finite(const double bounds[6]);
/* Both tests use only the planes of `mask`. */
stratus_side stratus_plan_side(const stratus_frustum_plan* plan, unsigned mask, const double bounds[6]);
stratus_side stratus_plan_side_turned(const stratus_frustum_plan* plan, unsigned mask, const stratus_solid_box* box);
/* ---- frustum_exact.c */
/* Fills corners and edges. Returns false where the planes bound no solid with eight corners. */
bool stratus_plan_find_corners(stratus_frustum_plan* plan);
/* True if some axis certainly separates the box from a solid plan. */
bool stratus_plan_separated(const stratus_frustum_plan* plan, const stratus_solid_box* box);

#endif
