/* SPDX-License-Identifier: BSD-3-Clause
 * Shared by the files of the hybrid tree's builder. hybrid_tree.c builds level by level and makes all decisions, from sums over a node's
 * bricks. The sums are whole numbers, made by the host or by the device (hybrid_sums), so that both build the same tree. Planes are between
 * bricks, so that they cut none. */
#ifndef STRATUS_HYBRID_TREE_H
#define STRATUS_HYBRID_TREE_H

#include "hybrid_arguments.h"
#include "tree.h"

#define STRATUS_HYBRID_DEPTH_MAX 64

/* A node to be split or made a leaf. Its bricks are order[first .. first+count-1], ascending. */
typedef struct hybrid_node {
  uint32_t number;
  uint32_t first, count;
  int32_t depth;
  int sparse;           /* paper: the side of a split without the peak, divided by surface area into leaves of bricks */
  int32_t lo[3], hi[3]; /* tight box of its bricks, [lo, hi) in bricks */
} hybrid_node;

typedef struct hybrid_plane {
  int axis;       /* -1: none */
  int32_t brick;  /* bricks with at[axis] < brick are on the lower side */
  uint32_t below; /* their number */
  double cost;    /* surface area heuristic, in faces of bricks */
} hybrid_plane;

/* Bricks in a bin, or on a side of a plane. */
typedef struct hybrid_bin {
  int32_t count;
  int32_t lo[3], hi[3]; /* bricks, [lo, hi) */
} hybrid_bin;

static const hybrid_bin hybrid_no_bricks = { 0, { INT32_MAX, INT32_MAX, INT32_MAX }, { 0, 0, 0 } };

/* The results for a node that is split, in the order in which they are found. */
typedef struct hybrid_work {
  hybrid_node node;
  int32_t lo[3], hi[3]; /* tight box of its voxels */
  bool settled;         /* it became a leaf after all */
  bool measured, even;  /* it has a peak; it passes its method's node test */
  double bandwidth;
  int32_t peak[3];   /* the densest voxel */
  double squares[3]; /* sums over the voxels of the squared distances to the peak along each axis */
  int64_t voxels;
  int axis, side;         /* along which density falls most steeply, and on which side of the peak; axis -1: nowhere */
  int32_t border;         /* the position of that fall, a plane between voxels */
  size_t at;              /* where the sums that are made now begin in their array */
  int32_t offered[2];     /* planes across `axis`, in bricks */
  int offers;             /* their number */
  hybrid_bin sides[2][2]; /* of each offered plane */
  bool clustered;         /* `plane` is a border of the peak's cluster */
  hybrid_plane plane;
  hybrid_node child[2];
  stratus_tree_node box[2]; /* of the children, in voxels */
} hybrid_work;

typedef struct hybrid_build hybrid_build;

/* Makes sums for `count` nodes at once. */
typedef struct hybrid_sums {
  /* Fill peak, squares and voxels. own: the density is of only the node's bricks, in their order. */
  stratus_status (*peaks)(hybrid_build* build, hybrid_work* const* works, uint32_t count, bool own);
  /* Fills the lines through the peaks from lines[work->at] on. */
  stratus_status (*lines)(hybrid_build* build, hybrid_work* const* works, uint32_t count, stratus_density_line* lines, size_t size);
  /* Counts voxels by their coordinate along work->axis, from counts[work->at] on for the first coordinate of the node's bricks. */
  stratus_status (*histograms)(hybrid_build* build, hybrid_work* const* works, uint32_t count, int64_t* counts, size_t size);
  /* Fills sides. */
  stratus_status (*sides)(hybrid_build* build, hybrid_work* const* works, uint32_t count);
  /* Fills the bins of the three axes, HYBRID_BINS or fewer each, from bins[work->at] on. */
  stratus_status (*bins)(hybrid_build* build, hybrid_work* const* works, uint32_t count, hybrid_bin* bins, size_t size);
  /* Moves the bricks below work->plane to the front and keeps the order of each side. Fills first, count and boxes of both children. */
  stratus_status (*divide)(hybrid_build* build, hybrid_work* const* works, uint32_t count);
  /* Writes the node's part of the shape's order, where that is kept elsewhere. */
  stratus_status (*order)(hybrid_build* build, uint32_t first, uint32_t count);
} hybrid_sums;

struct hybrid_build {
  stratus_context* context;
  const stratus_voxels* voxels;
  const stratus_tree_options* options;
  stratus_tree_statistics* statistics;
  stratus_tree_shape* shape;
  const hybrid_sums* sums;
  struct hybrid_device* device; /* NULL: the host makes the sums */
  uint32_t node_max;            /* capacity of shape->nodes */
  uint32_t* scratch;            /* for partitions, one entry per brick */
  stratus_density* density;     /* of all bricks, or of `gathered` */
  stratus_brick* gathered;      /* bricks of one node, if each node gets a density of its own */
  double bandwidth;
  double volume; /* of the root, in bricks */
  int paper;
};

/* Returns whether density is computed for each voxel, not for each brick. */
static inline int hybrid_exact(const hybrid_build* build)
{
  return build->paper || build->options->exact_density;
}

static inline const stratus_brick* hybrid_brick(const hybrid_build* build, const hybrid_node* node, uint32_t i)
{
  return build->voxels->bricks + build->shape->order[node->first + i];
}

/* Returns how many bins an axis of the node has. */
static inline int32_t hybrid_bins_along(const hybrid_node* node, int axis)
{
  const int32_t extent = node->hi[axis] - node->lo[axis];
  return extent < HYBRID_BINS ? extent : HYBRID_BINS;
}

/* hybrid_planes.c */
/* Chooses the plane of least cost by the surface area heuristic, from the bins of the three axes. */
hybrid_plane stratus_hybrid_plane_sah(const hybrid_node* node, const hybrid_bin* bins);
/* Chooses the cheaper one of the offered planes; axis -1 if there is none. */
hybrid_plane stratus_hybrid_plane_offered(const hybrid_work* work);
/* Finds the plane across the longest axis by bisection: the lowest one with at least half of the bricks below it. Reads the order. */
hybrid_plane stratus_hybrid_plane_median(const hybrid_build* build, const hybrid_node* node);

/* hybrid_density.c: planes by density. */
/* Computes peaks and deviations (eq. 8). */
stratus_status stratus_hybrid_measure(hybrid_build* build, hybrid_work* const* works, uint32_t count);
/* Returns the greatest difference between two axes' deviations, relative to the node's extents, or in voxels as in the paper. */
double stratus_hybrid_unevenness(const hybrid_work* work, int paper);
/* Chooses each node's plane by density; axis -1 if there is none. Sets `clustered`. */
stratus_status stratus_hybrid_planes_density(hybrid_build* build, hybrid_work* const* works, uint32_t count);

/* hybrid_host.c */
extern const hybrid_sums stratus_hybrid_sums_host;

/* hybrid_device.c */
/* Returns whether the context's device makes the sums: it builds, and the sums fit its numbers. */
bool stratus_hybrid_on_device(const hybrid_build* build);
stratus_status stratus_hybrid_device_create(hybrid_build* build);
void stratus_hybrid_device_destroy(hybrid_build* build);
extern const hybrid_sums stratus_hybrid_sums_device;

#endif
