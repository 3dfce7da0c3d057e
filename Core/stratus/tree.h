/* SPDX-License-Identifier: BSD-3-Clause
 * Trees of effective voxels, for first hits and for skipping. */
#ifndef STRATUS_PUBLIC_TREE_H
#define STRATUS_PUBLIC_TREE_H

#include "voxels.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum stratus_tree_method {
  STRATUS_TREE_HYBRID,       /* default: splits by density only where one distance field would be a waste */
  STRATUS_TREE_HYBRID_PAPER, /* Guo et al. 2025 as written: node test and split at every node, threshold in voxels */
  STRATUS_TREE_DISTANCE,     /* one distance-field leaf over everything; STRATUS_UNSUPPORTED over 2^14 bricks along x */
  STRATUS_TREE_OCTANT,       /* the same with a distance for each of the eight ray octants */
  STRATUS_TREE_SAH,          /* bounding volume hierarchy over voxels, binned surface area heuristic */
  STRATUS_TREE_SWEEP,        /* SAH, every split tried */
  STRATUS_TREE_LBVH,         /* Morton codes (Lauterbach et al. 2009, Karras 2012) */
  STRATUS_TREE_PLOC,         /* parallel locally-ordered clustering (Meister & Bittner 2018) */
  STRATUS_TREE_AC,           /* agglomerative clustering (Walter et al. 2008) */
  STRATUS_TREE_DPC,          /* density peaks (Rodriguez & Laio 2014), split cluster by cluster */
  STRATUS_TREE_KMEANS        /* k-means (Meister & Bittner 2016) */
} stratus_tree_method;

#define STRATUS_TREE_METHODS 11

STRATUS_EXPERIMENTAL const char* stratus_tree_method_name(
  stratus_tree_method method); /* "hybrid", "hybrid-paper", "distance", "octant", "sah", .. */

typedef struct stratus_tree_options {
  stratus_tree_method method; /* default hybrid */
  int max_depth;              /* 1..64; default 32. A node at it is a leaf; a baseline's is split at the median from there on. */
  int leaf_bricks;            /* bricks (4^3 voxels and a bit mask) in a leaf of the sparse parts, 1..64; default 4 */
  int leaf_voxels;            /* voxels in a leaf of the baselines, 1..64; default 1 */
  int64_t field_bricks;       /* most bricks that a distance-field leaf covers, 1..2^29; default 2^25. hybrid-paper: at most 2^18. */
  double field_emptiness;     /* most bricks that it covers an occupied one, >= 1; default 512 */
  double uniform;             /* hybrid: greatest difference between the axes' deviations of eq. 8, over the node's extent; default .1 */
  double paper_threshold;     /* hybrid-paper: the same difference in voxels, as printed; default 8 */
  double bandwidth;           /* of density, voxels; 0 (default): eq. 3 with its floor */
  int exact_density;          /* 1: density summed voxel by voxel; 0: over bricks as weights. Default 0; hybrid-paper always 1. */
  int density_per_node;       /* 1: bandwidth and density anew in each node, as in the paper; default 0, hybrid-paper 1 */
} stratus_tree_options;

STRATUS_API stratus_tree_options stratus_tree_options_default(void);

typedef struct stratus_tree stratus_tree;

/* A copy of what it needs: the voxels may go. Out-of-range options: STRATUS_INVALID_ARGUMENT. No voxel at all makes a tree that nothing
 * hits. The same tree on host and device, at any thread count. */
STRATUS_API stratus_status stratus_tree_create(
  stratus_context* context, const stratus_voxels* voxels, const stratus_tree_options* options, stratus_tree** tree);
STRATUS_API void stratus_tree_destroy(stratus_tree* tree);

typedef struct stratus_tree_statistics {
  stratus_tree_method method;
  int64_t voxels, bricks; /* bricks: with any effective voxel */
  int64_t nodes, leaves, field_leaves;
  int64_t field_bricks; /* that distance-field leaves cover */
  int depth;            /* of the deepest leaf, the root's is 0 */
  size_t bytes;
  double sah;       /* surface area heuristic, both costs 1; a distance-field leaf counts as one primitive */
  double bandwidth; /* of density; 0: none was needed */
  int dbscan_splits, density_splits, sah_splits, median_splits; /* how each split was found */
  double build_ms;
  char why[256]; /* one sentence: what decided the shape */
} stratus_tree_statistics;

STRATUS_EXPERIMENTAL void stratus_tree_get_statistics(const stratus_tree* tree, stratus_tree_statistics* statistics);

typedef enum stratus_node_kind { STRATUS_NODE_INNER, STRATUS_NODE_BRICKS, STRATUS_NODE_FIELD } stratus_node_kind;

typedef struct stratus_node_box {
  int64_t lo[3], hi[3]; /* voxels, [lo, hi) */
  int depth;
  stratus_node_kind kind;
  int64_t voxels; /* effective ones in it */
} stratus_node_box;

/* Boxes of all nodes, statistics.nodes of them, parents before children. */
STRATUS_EXPERIMENTAL void stratus_tree_boxes(const stratus_tree* tree, stratus_node_box* boxes);

/* A tree as bytes, for files and messages: little-endian, versioned, with a checksum. */
STRATUS_API size_t stratus_tree_bytes(const stratus_tree* tree);
/* Of the volume's values, type, dimensions and hidden parts that it was built from; 0: a list. */
STRATUS_API uint64_t stratus_tree_hash(const stratus_tree* tree);
STRATUS_API void stratus_tree_save(const stratus_tree* tree, void* bytes);
/* STRATUS_INVALID_ARGUMENT for bytes that are cut short, of another version or byte order, or changed. */
STRATUS_API stratus_status stratus_tree_load(stratus_context* context, const void* bytes, size_t size, stratus_tree** tree);
/* 1 if the tree may stand in for one of these voxels' making: it was built for the same use (cells or voxels) from a volume with the same
 * values, dimensions and hidden parts, and its criterion covers this one. Where the volume lies does not count. Reads the whole volume
 * once. */
STRATUS_API stratus_status stratus_tree_covers(stratus_context* context, const stratus_tree* tree, const stratus_volume* volume,
  const stratus_criterion* criterion, int cells, int* covers);

/* The first effective voxel along each of `count` rays: that of stratus_voxels_first_hit() to the bit, edges and corners included, for
 * origins up to some 1e9 voxels away (farther ones may differ where rays graze edges). Rays with a direction of length 0, or with a number
 * that is not finite (t_max aside): STRATUS_INVALID_ARGUMENT with the first one's index, and `hits` undefined. Threads and device: the
 * context's; trees of one leaf go in packets, or on the device, others ray by ray on the host. */
STRATUS_API stratus_status stratus_tree_first_hit(
  stratus_context* context, const stratus_tree* tree, const stratus_ray* rays, size_t count, stratus_hit* hits);

#ifdef __cplusplus
}
#endif

#endif
