/* SPDX-License-Identifier: BSD-3-Clause
 * Trees of effective voxels, for first hits and for skipping. */
#ifndef STRATUS_PUBLIC_TREE_H
#define STRATUS_PUBLIC_TREE_H

#include "voxels.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Saved trees contain these numbers. SAH to KMEANS must stay consecutive, because they are the hierarchies of room bvh. A new hierarchy is
 * added directly after KMEANS. It raises VERSION in tree_bytes.c, because the numbers of WIDE and AUTO change. */
typedef enum stratus_tree_method {
  STRATUS_TREE_HYBRID,       /* Guo et al. 2025, but splits only where a single distance field would be too large or too empty */
  STRATUS_TREE_HYBRID_PAPER, /* Guo et al. 2025 as published: node test and split at every node, threshold in voxels */
  STRATUS_TREE_DISTANCE,     /* a single distance-field leaf; STRATUS_UNSUPPORTED over 2^14 bricks along x */
  STRATUS_TREE_OCTANT,       /* DISTANCE with one distance for each of a ray's eight octants */
  STRATUS_TREE_SAH,          /* bounding volume hierarchy over voxels, binned surface area heuristic */
  STRATUS_TREE_SWEEP,        /* surface area heuristic that tries every split */
  STRATUS_TREE_LBVH,         /* Morton codes (Lauterbach et al. 2009, Karras 2012) */
  STRATUS_TREE_PLOC,         /* parallel locally-ordered clustering (Meister & Bittner 2018) */
  STRATUS_TREE_AC,           /* agglomerative clustering (Walter et al. 2008) */
  STRATUS_TREE_DPC,          /* density peaks (Rodriguez & Laio 2014), split cluster by cluster */
  STRATUS_TREE_KMEANS,       /* k-means (Meister & Bittner 2016) */
  /* A leaf of all bricks, with a hierarchy over them of up to 16 children for each node (layout: Ylitie et al. 2017; shape: LBVH). */
  STRATUS_TREE_WIDE,
  /* Default: OCTANT if it has at most 1 MB, or at most as many bytes as WIDE; otherwise WIDE. The statistics report the choice and its
   * reason. */
  STRATUS_TREE_AUTO
} stratus_tree_method;

#define STRATUS_TREE_METHODS 13

STRATUS_EXPERIMENTAL const char* stratus_tree_method_name(
  /* a method's name: "auto", "hybrid", "hybrid-paper", "distance", "octant", "sah" and so on; "none" for other numbers */
  stratus_tree_method method);

typedef struct stratus_tree_options {
  stratus_tree_method method; /* default auto */
  /* 1..64; default 32. A node at this depth is a leaf. A baseline instead splits at the median from this depth on. */
  int max_depth;
  int leaf_bricks; /* hybrid: largest number of bricks (4^3 voxels, a bit mask) in a leaf of the sparse parts, 1..64; default 4 */
  int leaf_voxels; /* largest number of voxels in a leaf of a baseline, 1..64; default 1 */
  /* hybrid: largest number of bricks that a distance-field leaf spans, 1..2^29; default 2^25. hybrid-paper: at most 2^18. */
  int64_t field_bricks;
  double field_emptiness; /* hybrid: largest number of bricks that a distance-field leaf spans for each occupied brick, >= 1; default 512 */
  /* hybrid: a node is uniform if the axes' deviations of eq. 8 differ by at most this, as a fraction of the node's extent; default .1 */
  double uniform;
  double paper_threshold; /* hybrid-paper: the limit of the deviations' difference in voxels, as published; default 8 */
  double bandwidth;       /* bandwidth of the density, in voxels; 0 (default): by eq. 3, at least 1 */
  /* 1: the density is summed voxel by voxel. 0 (default): bricks are weights. hybrid-paper always uses 1. */
  int exact_density;
  int density_per_node; /* 1: each node has its own bandwidth and density, as in the paper; default 0, hybrid-paper 1 */
  /* ac: the distance of two clusters. 0 (default): the surface area of their union's box, as published. 1: the sum of its edges, which
   * makes cheaper trees if voxels fill volumes rather than surfaces. */
  int agglomerative_by_edges;
  /* hybrid-paper. 1: a leaf keeps the distances of its adaptive flooding uncorrected, and rays step through it by these distances, as
   * published. 0 (default): exact distances limit how far a ray may leap. Published steps may lead past voxels: stratus_tree_first_hit()
   * then misses hits or finds later ones, and stratus_tree_covers() never lets such a tree replace another. The other methods ignore the
   * option. */
  int uncorrected_flooding;
} stratus_tree_options;

/* Return options with their defaults. */
STRATUS_API stratus_tree_options stratus_tree_options_default(void);

typedef struct stratus_tree stratus_tree;

/* Build a tree. options may be NULL. The tree copies its data, so that the voxels may be destroyed. Options out of their ranges give
 * STRATUS_INVALID_ARGUMENT. An empty set makes a tree that no ray hits. The tree does not depend on the device or the number of threads. */
STRATUS_API stratus_status stratus_tree_create(
  stratus_context* context, const stratus_voxels* voxels, const stratus_tree_options* options, stratus_tree** tree);
STRATUS_API void stratus_tree_destroy(stratus_tree* tree);

typedef struct stratus_tree_statistics {
  stratus_tree_method method; /* the method used, never auto */
  int64_t voxels, bricks;     /* bricks: the bricks that hold an effective voxel */
  int64_t nodes, leaves, field_leaves;
  int64_t field_bricks; /* number of bricks that distance-field leaves span */
  int depth;            /* depth of the deepest leaf; the root has depth 0 */
  int64_t wide_nodes;   /* nodes of the hierarchy over the bricks of a WIDE tree, which is one leaf */
  size_t bytes;
  double sah;       /* surface area heuristic, where both costs are 1 and a distance-field leaf counts as one primitive */
  double bandwidth; /* bandwidth of the density; 0 if none was needed */
  int dbscan_splits, density_splits, sah_splits, median_splits; /* number of splits found by each rule */
  int uncorrected; /* 1: made with uncorrected_flooding, so that rays may miss voxels. A saved tree keeps it. */
  double build_ms;
  char why[256]; /* one sentence: why the tree has this shape */
} stratus_tree_statistics;

/* Get the tree's statistics. */
STRATUS_EXPERIMENTAL void stratus_tree_get_statistics(const stratus_tree* tree, stratus_tree_statistics* statistics);

typedef enum stratus_node_kind { STRATUS_NODE_INNER, STRATUS_NODE_BRICKS, STRATUS_NODE_FIELD } stratus_node_kind;

typedef struct stratus_node_box {
  int64_t lo[3], hi[3]; /* voxels, [lo, hi) */
  int depth;
  stratus_node_kind kind;
  int64_t voxels; /* number of effective voxels in the node */
} stratus_node_box;

/* Fill the boxes of all nodes, statistics.nodes of them, parents before children. */
STRATUS_EXPERIMENTAL void stratus_tree_boxes(const stratus_tree* tree, stratus_node_box* boxes);

/* Return the size of a tree's bytes, for files and messages. The bytes are little-endian and versioned, and contain a checksum. */
STRATUS_API size_t stratus_tree_bytes(const stratus_tree* tree);
/* Return the hash of the volume's values, type, dimensions and hidden parts that the tree was built from; 0: it was built from a list. */
STRATUS_API uint64_t stratus_tree_hash(const stratus_tree* tree);
/* Write stratus_tree_bytes() bytes. */
STRATUS_API void stratus_tree_save(const stratus_tree* tree, void* bytes);
/* Read a tree from bytes. STRATUS_INVALID_ARGUMENT for bytes that are cut short, changed, or of another version or byte order. */
STRATUS_API stratus_status stratus_tree_load(stratus_context* context, const void* bytes, size_t size, stratus_tree** tree);
/* Set *covers to 1 if the tree may replace a tree built for this volume and criterion, otherwise to 0. It may if it was built for the same
 * use (cells 1: cells, 0: voxels) from a volume with the same values, dimensions and hidden parts, and its criterion covers this one. The
 * volume's position does not matter. The call reads the whole volume once. */
STRATUS_API stratus_status stratus_tree_covers(stratus_context* context, const stratus_tree* tree, const stratus_volume* volume,
  const stratus_criterion* criterion, int cells, int* covers);

/* Find the first effective voxel along each of `count` rays.
 *
 * For origins up to about 1e9 voxels away, the results equal stratus_voxels_first_hit()'s results to the bit, edges and corners included,
 * except in trees with uncorrected_flooding. From farther away they may differ where rays graze edges. A direction of length 0, or a number
 * that is not finite (except t_max), gives STRATUS_INVALID_ARGUMENT with the first such ray's index, and leaves `hits` undefined.
 *
 * Beams and packets, or the context's device, traverse wide hierarchies, and also hybrid trees and trees of one leaf up to 52,000 voxels
 * long. The host traverses other trees ray by ray. 64 consecutive rays, counted from the first, form a beam if they run side by side.
 * Therefore order the rays of an image by tiles of 8 x 8 pixels: this needs half to two thirds of the time of rows. The rays of a beam
 * share `visited`. */
STRATUS_API stratus_status stratus_tree_first_hit(
  stratus_context* context, const stratus_tree* tree, const stratus_ray* rays, size_t count, stratus_hit* hits);

#ifdef __cplusplus
}
#endif

#endif
