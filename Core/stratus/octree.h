/* SPDX-License-Identifier: BSD-3-Clause
 * An octree of objects, and its visible objects in a frustum. */
#ifndef STRATUS_PUBLIC_OCTREE_H
#define STRATUS_PUBLIC_OCTREE_H

#include "camera.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The space that a camera sees, as six half-spaces: a point is inside where a x + b y + c z + d >= 0. Normals have any length. A plane {0,
 * 0, 0, d} restricts nothing if d >= 0 (a far plane at infinity), and excludes everything if d < 0. Off-centre and stereo cameras, and
 * parts of a window, are frusta like any other. vtkCamera::GetFrustumPlanes() has the same order and sign. */
typedef struct stratus_frustum {
  double planes[6][4]; /* left, right, bottom, top, near, far */
  double eye[3];       /* stop rules by distance measure from here; visibility depends only on the planes */
} stratus_frustum;

/* Make the frustum of a camera whose forward, right and up are linearly independent. near_k and far_k may be infinite. Another camera gives
 * STRATUS_INVALID_ARGUMENT. */
STRATUS_API stratus_status stratus_frustum_from_camera(stratus_context* context, const stratus_camera* camera, stratus_frustum* frustum);
/* Check that every number is finite; if not, return STRATUS_INVALID_ARGUMENT. A frustum without volume is valid, and sees the boxes that
 * touch it. */
STRATUS_API stratus_status stratus_frustum_check(stratus_context* context, const stratus_frustum* frustum);

typedef enum stratus_side { STRATUS_SIDE_OUTSIDE, STRATUS_SIDE_CROSSING, STRATUS_SIDE_INSIDE } stratus_side;

/* Test a box xmin xmax ymin ymax zmin zmax against the six half-spaces, by its nearest and farthest corner (Assarsson & Moller 2000). The
 * result "outside" is certain. A box beyond an edge of the frustum may count as crossing. exact 1 adds the test of every separating axis,
 * and avoids this. Bounds that are not finite cross. */
STRATUS_API stratus_side stratus_frustum_side(const stratus_frustum* frustum, const double bounds[6], int exact);

/* An octree finds, among thousands to millions of boxes, the boxes that a frustum sees. It is the layered linear octree that is split on
 * demand (Li & Huang 2024). Each level is one array in Morton order, with eight slots for each split parent. A node's index is its code,
 * and the tree stores neither codes nor links: counting the split nodes before a node finds its children. A node is split when the border
 * of a frustum or query crosses it and the stop rule allows it. It is merged again when no border has crossed it for long.
 *
 * Visibility does not depend on the tree. An object is visible if its box reaches into each of the six half-spaces, rounded so that a box
 * that touches is seen. This holds at every stop rule, depth, history and number of threads. With `exact`, the box must also have no
 * separating axis. Only the order of the list depends on the tree.
 *
 * There is one exception: touching placement without `exact` follows the paper and differs for boxes out of sight. It keeps a box whose
 * sphere touches a node that is seen whole, and drops a box if none of its nodes crosses the frustum.
 *
 * An object keeps its id, 0 or above, until it is removed; the next object does not necessarily get the lowest free id. Bounds are xmin
 * xmax ymin ymax zmin zmax, min <= max; an empty interval (min > max) is refused. An object with a bound that is NaN, infinite or beyond
 * 1e30 counts as unbounded: every frustum and box contains it, and no other query finds it. */

typedef enum stratus_octree_placement {
  STRATUS_OCTREE_ENCLOSING, /* in the smallest node that encloses the object's box: once. Default. */
  STRATUS_OCTREE_TOUCHING   /* as in the paper: in every leaf that the object's bounding sphere touches, reported once */
} stratus_octree_placement;

/* The stop rule: a node that is partly visible is split while its condition holds. */
typedef enum stratus_octree_stop {
  /* The node's diameter on screen is above `pixels`, for a window 1000 pixels high. Neither the unit of length nor the window's size
   * matters. Default. */
  STRATUS_OCTREE_STOP_PIXELS,
  /* L / (C S) < 1, where L is the distance from the eye to the node's centre and S its diagonal, both measured along the axes (the paper's
   * rule). */
  STRATUS_OCTREE_STOP_MANHATTAN,
  STRATUS_OCTREE_STOP_EUCLID, /* the rule L / (C S) < 1 with L and S as Euclidean lengths */
  /* The node is above the last level, visible or not: the static octree. Its nodes are never merged. */
  STRATUS_OCTREE_STOP_STATIC
} stratus_octree_stop;

#define STRATUS_OCTREE_LEVELS_MAX 21

typedef struct stratus_octree_options {
  stratus_octree_placement placement; /* default enclosing */
  stratus_octree_stop stop;           /* default pixels */
  int levels;       /* levels below the root, 0..21; default 21. 0 is a linear list: every object is tested, and no tree is built. */
  int leaf_objects; /* a node of at most this many objects is not split, 1..2^20; default 256 */
  double pixels;    /* limit of STRATUS_OCTREE_STOP_PIXELS, > 0; default 32 */
  double c;         /* C of the two rules by distance, > 0; default 35 */
  /* Enclosing: factor by which nodes count as wider, 1..2, so that few objects straddle the borders; default 1.25. */
  double looseness;
  /* Number of stratus_octree_cull() calls for which a node keeps children that no border has crossed; 0: children are kept always. Default
   * 256. */
  int collapse_after;
  /* Largest number of objects that the splits of one call may hand down to children; later calls continue. 0 (default): no limit. */
  int64_t split_budget;
} stratus_octree_options;

/* Return options with their defaults. */
STRATUS_API stratus_octree_options stratus_octree_options_default(void);

typedef struct stratus_octree stratus_octree;

/* Create an empty tree. options may be NULL. Options out of their ranges give STRATUS_INVALID_ARGUMENT. */
STRATUS_API stratus_status stratus_octree_create(stratus_context* context, const stratus_octree_options* options, stratus_octree** octree);
/* Destroy a tree. Destroy its views first. */
STRATUS_API void stratus_octree_destroy(stratus_octree* octree);

/* Insert `count` objects, all or none. bounds: 6*count numbers. ids: receives `count` ids, which mean nothing if the call fails. The root
 * doubles its size until it holds every object. */
STRATUS_API stratus_status stratus_octree_insert(stratus_octree* octree, const double* bounds, size_t count, uint32_t* ids);
/* Insert `count` turned boxes, all or none. boxes: 12 numbers each, the centre and three half edges, orthogonal or not. ids: as above. */
STRATUS_API stratus_status stratus_octree_insert_oriented(stratus_octree* octree, const double* boxes, size_t count, uint32_t* ids);
/* Give new bounds to objects in the tree. An object that stays in its node costs one write. If memory runs out, each object has its old or
 * its new bounds. An id that is not in use gives STRATUS_INVALID_ARGUMENT, and no object moves. */
STRATUS_API stratus_status stratus_octree_move(stratus_octree* octree, const uint32_t* ids, const double* bounds, size_t count);
/* Give new turned boxes, 12 numbers each, to objects in the tree, like stratus_octree_move(). */
STRATUS_API stratus_status stratus_octree_move_oriented(stratus_octree* octree, const uint32_t* ids, const double* boxes, size_t count);
/* Remove objects; needs no memory. An id that is not in use, or twice in the list, gives STRATUS_INVALID_ARGUMENT, and no object is
 * removed. */
STRATUS_API stratus_status stratus_octree_remove(stratus_octree* octree, const uint32_t* ids, size_t count);
STRATUS_API void stratus_octree_clear(stratus_octree* octree); /* removes all objects; no id stays in use */
/* Return the number of objects. */
STRATUS_API size_t stratus_octree_count(const stratus_octree* octree);
/* Return a number above all ids in use. */
STRATUS_API size_t stratus_octree_id_limit(const stratus_octree* octree);
/* Get an object's bounds as they were given (turned: the bounds of its box). STRATUS_INVALID_ARGUMENT for an id that is not in use. */
STRATUS_API stratus_status stratus_octree_bounds(const stratus_octree* octree, uint32_t id, double bounds[6]);

/* A view keeps the data that one camera or viewport needs from frame to frame. A tree may have any number of views. Only one call at a time
 * may use a tree or its views. */
typedef struct stratus_octree_view stratus_octree_view;

STRATUS_API stratus_status stratus_octree_view_create(stratus_octree* octree, stratus_octree_view** view);
STRATUS_API void stratus_octree_view_destroy(stratus_octree_view* view);

typedef struct stratus_octree_cull_options {
  int exact;    /* 1: also test separating axes, so that no object beyond the frustum's edges is kept. Default 0. */
  int coverage; /* 1: fill coverage and depth. Default 0. */
  int hold;     /* 1: the tree stays unchanged, for a call that has no time to split nodes; a later call splits them. Default 0. */
} stratus_octree_cull_options;

typedef struct stratus_octree_visible {
  const uint32_t* ids; /* visible objects, each once */
  /* NULL unless options.coverage is 1. Fraction of the window, 0..1, that the square about the object's bounding sphere covers, both
   * measured in the plane through the sphere's centre. 1 for unbounded objects, and if that plane does not cut the frustum. */
  const float* coverage;
  /* NULL unless options.coverage is 1. Distance of the object's centre from the near plane, negative in front of it; 0 for unbounded
   * objects. */
  const float* depth;
  size_t count;
  /* the counters below cover this call only */
  uint64_t nodes_tested, objects_tested; /* number of tests against planes, several at a time */
  uint64_t objects_retested;             /* objects tested one by one in double precision: at a border, turned, or exact */
  uint64_t splits, collapses;            /* number of nodes split, and of nodes merged */
  uint64_t objects_handed_down;          /* objects that splits handed down to children */
} stratus_octree_visible;

/* Find the objects that the frustum sees; options may be NULL. The arrays stay valid until the view's next call or its end. The call
 * refines the tree where it meets the frustum's border. If memory runs out, the tree stays intact, and *visible is undefined. */
STRATUS_API stratus_status stratus_octree_cull(
  stratus_octree_view* view, const stratus_frustum* frustum, const stratus_octree_cull_options* options, stratus_octree_visible* visible);

/* Queries refine the tree, too: they split each node that their border crosses if it holds more than leaf_objects, whatever the stop rule.
 * Lists are in rising order of id (ray: of t, then id; nearest: of distance, then id). `ids` receives the first `capacity` of them, and
 * *count receives their full number. Boxes include their borders, and a turned box counts as its bounds. Distances are measured to the box,
 * 0 inside. A number that is not finite gives STRATUS_INVALID_ARGUMENT, unless the function's comment allows it. */
/* Find the objects that touch a box: min <= max; bounds may be infinite. */
STRATUS_API stratus_status stratus_octree_query_box(
  stratus_octree* octree, const double bounds[6], uint32_t* ids, size_t capacity, size_t* count);
/* Find the objects that touch a ball: radius >= 0, may be INFINITY. */
STRATUS_API stratus_status stratus_octree_query_sphere(
  stratus_octree* octree, const double center[3], double radius, uint32_t* ids, size_t capacity, size_t* count);
/* Find the objects that meet origin + t direction, 0 <= t <= t_max. They are in rising order of the t at which the ray enters (0 if it
 * begins inside), then of id. `t` receives these numbers, and may be NULL. t_max >= 0, may be INFINITY; direction has a length > 0. */
STRATUS_API stratus_status stratus_octree_query_ray(stratus_octree* octree, const double origin[3], const double direction[3], double t_max,
  uint32_t* ids, double* t, size_t capacity, size_t* count);
/* Find the k nearest objects. *count is less than k if there are fewer. distances may be NULL. */
STRATUS_API stratus_status stratus_octree_query_nearest(
  stratus_octree* octree, const double point[3], size_t k, uint32_t* ids, double* distances, size_t* count);

typedef struct stratus_octree_statistics {
  size_t objects, unbounded; /* unbounded: objects without bounds */
  size_t references;         /* entries of objects in the nodes' lists. Touching placement may list an object several times. */
  size_t nodes, split_nodes; /* all nodes, empty slots included; and the split ones */
  int depth;                 /* depth of the deepest node; the root has depth 0 */
  /* Bytes that a linear list needs, too: boxes as given, boxes as tested, ids, and each id's position. */
  size_t object_bytes;
  size_t bytes;   /* bytes that the tree adds: nodes, spare capacity and repeated entries in lists */
  double root[6]; /* bounds of the root's cell; all 0 while a single list holds everything */
} stratus_octree_statistics;

/* Get the tree's statistics. */
STRATUS_API void stratus_octree_get_statistics(const stratus_octree* octree, stratus_octree_statistics* statistics);

typedef struct stratus_octree_node {
  double bounds[6]; /* bounds of the cell */
  int level;
  int split;
  size_t objects;    /* number of objects in the node's own list */
  stratus_side side; /* relation of the cell to the frustum, by its half-spaces; crossing if no frustum is given */
} stratus_octree_node;

/* Fill all nodes, statistics.nodes of them, level by level in Morton order. Their bounds are 0 as long as statistics.root is 0. frustum may
 * be NULL. */
STRATUS_API stratus_status stratus_octree_nodes(const stratus_octree* octree, const stratus_frustum* frustum, stratus_octree_node* nodes);

#ifdef __cplusplus
}
#endif

#endif
