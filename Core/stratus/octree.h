/* SPDX-License-Identifier: BSD-3-Clause
 * An octree of objects, and what a frustum sees of them. */
#ifndef STRATUS_PUBLIC_OCTREE_H
#define STRATUS_PUBLIC_OCTREE_H

#include "camera.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a camera sees, as six half-spaces: a x + b y + c z + d >= 0 is inside. Normals of any length. A plane {0, 0, 0, d} is none if d >= 0
 * (a far plane at infinity), and lets nothing through if d < 0. So off-centre and stereo cameras, and a window's part, are frusta like
 * others; vtkCamera::GetFrustumPlanes() has this order and sign. */
typedef struct stratus_frustum {
  double planes[6][4]; /* left, right, bottom, top, near, far */
  double eye[3];       /* stop rules by distance measure from here; the planes alone tell what is seen */
} stratus_frustum;

/* Of a camera whose forward, right and up are linearly independent: near_k and far_k finite or not. */
STRATUS_API stratus_status stratus_frustum_from_camera(stratus_context* context, const stratus_camera* camera, stratus_frustum* frustum);
/* Every number finite, or STRATUS_INVALID_ARGUMENT. A frustum of no volume is a frustum: it sees what touches it. */
STRATUS_API stratus_status stratus_frustum_check(stratus_context* context, const stratus_frustum* frustum);

typedef enum stratus_side { STRATUS_SIDE_OUTSIDE, STRATUS_SIDE_CROSSING, STRATUS_SIDE_INSIDE } stratus_side;

/* A box xmin xmax ymin ymax zmin zmax against the six half-spaces, by its nearest and farthest corner (Assarsson & Moller 2000). "Outside"
 * is certain; a box beyond a frustum's edge may be told as crossing, unless `exact` (1) also tries every separating axis. Bounds that are
 * not finite cross. */
STRATUS_API stratus_side stratus_frustum_side(const stratus_frustum* frustum, const double bounds[6], int exact);

/* Thousands to millions of boxes, and which of them a frustum sees: Li & Huang 2024 (layered linear octree, split on demand). Each level is
 * one array in Morton order, eight slots a parent. A node's code is its place: it is not stored, nor is any link; its children are found by
 * counting the split nodes before it. A node is split when a frustum's border (or a query's) crosses it and the stop rule allows, and
 * is whole again when no border has crossed it for long.
 *
 * What is seen does not depend on the tree: an object is visible if its box reaches into each of the six half-spaces (rounded so that a box
 * that touches is seen), at every stop rule, depth, history and number of threads; with `exact`, if it also has no separating axis.
 * Only the order of the list depends on the tree. Touching placement without `exact` is the paper's, and differs where boxes are out of
 * sight: it keeps those whose sphere touches a node that is seen whole, and drops those of which no node crosses the frustum.
 *
 * Objects have ids 0.. that stay theirs until removed; the lowest-numbered freed ids are not necessarily the next. Bounds are xmin xmax
 * ymin ymax zmin zmax, min <= max; an empty interval (min > max) is refused. An object with a bound that is NaN, infinite or beyond 1e30
 * has no bounds: it is in every frustum and box, and in no answer of the other queries. */

typedef enum stratus_octree_placement {
  STRATUS_OCTREE_ENCLOSING, /* in the smallest node that encloses it: once. Default. */
  STRATUS_OCTREE_TOUCHING   /* as in the paper: in every leaf that its bounding sphere touches, told once */
} stratus_octree_placement;

/* A node that is to be seen in part is split while .. */
typedef enum stratus_octree_stop {
  STRATUS_OCTREE_STOP_PIXELS,    /* .. its diameter on screen is above `pixels`: no unit matters, nor the window. Default. */
  STRATUS_OCTREE_STOP_MANHATTAN, /* .. L / (C S) < 1, eye to centre and diagonal measured along the axes: the paper's */
  STRATUS_OCTREE_STOP_EUCLID,    /* the same in straight lines */
  STRATUS_OCTREE_STOP_STATIC     /* .. there are levels left, seen or not: the static octree. Never whole again. */
} stratus_octree_stop;

#define STRATUS_OCTREE_LEVELS_MAX 21

typedef struct stratus_octree_options {
  stratus_octree_placement placement; /* default enclosing */
  stratus_octree_stop stop;           /* default pixels */
  int levels;           /* below the root, 0..21; default 21. 0 is the linear list: every object is tested, and nothing is built. */
  int leaf_objects;     /* a node of so many or fewer is not split, 1..2^20; default 256 */
  double pixels;        /* > 0, of a window 1000 pixels high; default 32 */
  double c;             /* C of the rules by distance, > 0; default 35 */
  double looseness;     /* enclosing: nodes count as this many times wider, 1..2, so that few objects straddle; default 1.25 */
  int collapse_after;   /* calls of stratus_octree_cull() that a node's children outlive unseen, 0: for ever; default 256 */
  int64_t split_budget; /* objects that one call may hand down to children before it leaves the rest for the next one, 0: any; default 0 */
} stratus_octree_options;

STRATUS_API stratus_octree_options stratus_octree_options_default(void);

typedef struct stratus_octree stratus_octree;

STRATUS_API stratus_status stratus_octree_create(stratus_context* context, const stratus_octree_options* options, stratus_octree** octree);
/* Its views first. */
STRATUS_API void stratus_octree_destroy(stratus_octree* octree);

/* bounds: 6*count numbers. ids: out, count. All are inserted or none. The root grows by doubling where an object falls outside. */
STRATUS_API stratus_status stratus_octree_insert(stratus_octree* octree, const double* bounds, size_t count, uint32_t* ids);
/* Boxes that are turned: 12 numbers each, the centre and three half edges, orthogonal or not. */
STRATUS_API stratus_status stratus_octree_insert_oriented(stratus_octree* octree, const double* boxes, size_t count, uint32_t* ids);
/* New bounds for objects that are there; one that stays in its node costs a write. Out of memory: each object is at its old or its new
 * place. An id that is not in use: STRATUS_INVALID_ARGUMENT, and none has moved. */
STRATUS_API stratus_status stratus_octree_move(stratus_octree* octree, const uint32_t* ids, const double* bounds, size_t count);
STRATUS_API stratus_status stratus_octree_move_oriented(stratus_octree* octree, const uint32_t* ids, const double* boxes, size_t count);
/* An id not in use, or twice in the list: STRATUS_INVALID_ARGUMENT, and none is removed. Needs no memory. */
STRATUS_API stratus_status stratus_octree_remove(stratus_octree* octree, const uint32_t* ids, size_t count);
STRATUS_API void stratus_octree_clear(stratus_octree* octree); /* no object is left, and no id in use */
STRATUS_API size_t stratus_octree_count(const stratus_octree* octree);
/* Ids in use are all below this. */
STRATUS_API size_t stratus_octree_id_limit(const stratus_octree* octree);
/* As given (of a turned box: those about it); STRATUS_INVALID_ARGUMENT for an id not in use. */
STRATUS_API stratus_status stratus_octree_bounds(const stratus_octree* octree, uint32_t id, double bounds[6]);

/* A view keeps what one camera or viewport needs from frame to frame. Any number may look at one tree, one at a time. */
typedef struct stratus_octree_view stratus_octree_view;

STRATUS_API stratus_status stratus_octree_view_create(stratus_octree* octree, stratus_octree_view** view);
STRATUS_API void stratus_octree_view_destroy(stratus_octree_view* view);

typedef struct stratus_octree_cull_options {
  int exact;    /* 1: separating axes too, so that nothing beyond the frustum's edges is kept. Default 0. */
  int coverage; /* 1: fill coverage and depth. Default 0. */
} stratus_octree_cull_options;

typedef struct stratus_octree_visible {
  const uint32_t* ids;   /* of what is visible, each once */
  const float* coverage; /* NULL unless asked for: share of the window, 0..1, of the square about the object's bounding sphere, both cut at
                          * the slice through its centre; 1 for objects without bounds, and where there is no slice */
  const float* depth;    /* NULL unless asked for: distance of its centre from the near plane, negative before it; 0 without bounds */
  size_t count;
  /* of this call */
  uint64_t nodes_tested, objects_tested; /* against planes, several at a time */
  uint64_t objects_retested;             /* one by one in double precision: at a border, turned, or exact */
  uint64_t splits, collapses;            /* of nodes */
  uint64_t objects_handed_down;          /* by splits */
} stratus_octree_visible;

/* What the frustum sees; options may be NULL. The arrays stay valid until the view's next call or end. Refines the tree where the frustum's
 * border is. Out of memory leaves the tree whole, and what was visible undefined. */
STRATUS_API stratus_status stratus_octree_cull(
  stratus_octree_view* view, const stratus_frustum* frustum, const stratus_octree_cull_options* options, stratus_octree_visible* visible);

/* Queries refine the tree, too: they split what they cross if it holds more than leaf_objects, whatever the stop rule. Lists are in rising
 * order of id (nearest: of distance, then id). `ids` gets the first `capacity`, *count how many there are. Boxes are closed, a turned one
 * counts as its bounds; distances go to the box, 0 within. Numbers that are not finite, where the comments name none:
 * STRATUS_INVALID_ARGUMENT. */
/* min <= max; bounds may be infinite. */
STRATUS_API stratus_status stratus_octree_query_box(
  stratus_octree* octree, const double bounds[6], uint32_t* ids, size_t capacity, size_t* count);
/* radius >= 0, may be INFINITY. */
STRATUS_API stratus_status stratus_octree_query_sphere(
  stratus_octree* octree, const double center[3], double radius, uint32_t* ids, size_t capacity, size_t* count);
/* Boxes along origin + t direction, 0 <= t <= t_max, in rising order of where it enters (0 if it begins inside), then id. t may be NULL.
 * t_max >= 0, may be INFINITY; the direction has a length. */
STRATUS_API stratus_status stratus_octree_query_ray(stratus_octree* octree, const double origin[3], const double direction[3], double t_max,
  uint32_t* ids, double* t, size_t capacity, size_t* count);
/* The k nearest; *count is less where there are fewer objects. distances may be NULL. */
STRATUS_API stratus_status stratus_octree_query_nearest(
  stratus_octree* octree, const double point[3], size_t k, uint32_t* ids, double* distances, size_t* count);

typedef struct stratus_octree_statistics {
  size_t objects, unbounded; /* unbounded: those without bounds */
  size_t references;         /* objects in nodes' lists: touching placement counts one that is in several lists so many times */
  size_t nodes, split_nodes; /* all slots */
  int depth;                 /* of the deepest node, the root's is 0 */
  size_t object_bytes;       /* a linear list's: boxes as given, boxes as tested, ids, and where each id stands */
  size_t bytes;              /* what the tree adds: nodes, spare room and copies in lists */
  double root[6];            /* bounds; all 0 while everything is in one list */
} stratus_octree_statistics;

STRATUS_API void stratus_octree_get_statistics(const stratus_octree* octree, stratus_octree_statistics* statistics);

typedef struct stratus_octree_node {
  double bounds[6]; /* of the cell */
  int level;
  int split;
  size_t objects;    /* in its own list */
  stratus_side side; /* against the frustum, by its half-spaces; crossing if there is none */
} stratus_octree_node;

/* All nodes, statistics.nodes of them, level by level in Morton order; bounds are 0 while statistics.root is. frustum may be NULL. */
STRATUS_API stratus_status stratus_octree_nodes(const stratus_octree* octree, const stratus_frustum* frustum, stratus_octree_node* nodes);

#ifdef __cplusplus
}
#endif

#endif
