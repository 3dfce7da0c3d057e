/* SPDX-License-Identifier: BSD-3-Clause
 * Trees of effective voxels, for first hits and for skipping. */
#ifndef STRATUS_PUBLIC_TREE_H
#define STRATUS_PUBLIC_TREE_H

#include "voxels.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum stratus_tree_method {
  STRATUS_TREE_HYBRID,       /* Guo et al. 2025, but splits only where a single distance field would be too large or too empty */
  STRATUS_TREE_HYBRID_PAPER, /* Guo et al. 2025 as published: node test and split at every node, threshold in voxels */
  STRATUS_TREE_DISTANCE,     /* a single distance-field leaf; STRATUS_UNSUPPORTED over 2^14 bricks along x */
  STRATUS_TREE_OCTANT,       /* the same with a distance for each of a ray's eight octants */
  STRATUS_TREE_SAH,          /* bounding volume hierarchy over voxels, binned surface area heuristic */
  STRATUS_TREE_SWEEP,        /* surface area heuristic that tries every split */
  STRATUS_TREE_LBVH,         /* Morton codes (Lauterbach et al. 2009, Karras 2012) */
  STRATUS_TREE_PLOC,         /* parallel locally-ordered clustering (Meister & Bittner 2018) */
  STRATUS_TREE_AC,           /* agglomerative clustering (Walter et al. 2008) */
  STRATUS_TREE_DPC,          /* density peaks (Rodriguez & Laio 2014), split cluster by cluster */
  STRATUS_TREE_KMEANS,       /* k-means (Meister & Bittner 2016) */
  /* A leaf of all bricks, with a hierarchy of up to 16 children a node over them (layout: Ylitie et al. 2017; shape: LBVH). */
  STRATUS_TREE_WIDE,
  /* Default: OCTANT where its bytes are 1 MB or fewer, or no more than those of WIDE; else WIDE. The statistics tell which, and why. */
  STRATUS_TREE_AUTO
} stratus_tree_method;

#define STRATUS_TREE_METHODS 13

STRATUS_EXPERIMENTAL const char* stratus_tree_method_name(
  stratus_tree_method method); /* "auto", "hybrid", "hybrid-paper", "distance", "octant", "sah" and so on */

typedef struct stratus_tree_options {
  stratus_tree_method method; /* default auto */
  /* 1..64; default 32. A node at this depth is a leaf; a baseline splits it at the median from there on. */
  int max_depth;
  int leaf_bricks;        /* hybrid: most bricks (4^3 voxels, a bit mask) in a leaf of the sparse parts, 1..64; default 4 */
  int leaf_voxels;        /* most voxels in a leaf of a baseline, 1..64; default 1 */
  int64_t field_bricks;   /* hybrid: most bricks that a distance-field leaf spans, 1..2^29; default 2^25. hybrid-paper: at most 2^18. */
  double field_emptiness; /* hybrid: most bricks that such a leaf spans for each occupied brick, >= 1; default 512 */
  /* hybrid: a node is uniform if the axes' deviations of eq. 8 differ by at most this, as a fraction of the node's extent; default .1 */
  double uniform;
  double paper_threshold; /* hybrid-paper: the same difference in voxels, as published; default 8 */
  double bandwidth;       /* bandwidth of the density, in voxels; 0 (default): by eq. 3, at least 1 */
  /* 1: the density is summed voxel by voxel. 0: bricks are weights. Default 0; hybrid-paper always 1. */
  int exact_density;
  int density_per_node; /* 1: each node has a bandwidth and density of its own, as in the paper; default 0, hybrid-paper 1 */
  /* ac: the distance of two clusters is the surface area of their union's box, as published (0, default), or the sum of its edges (1),
   * which makes cheaper trees where voxels fill volumes rather than surfaces. */
  int agglomerative_by_edges;
  /* hybrid-paper: a leaf keeps the distances of its adaptive flooding as they come out, and rays step through it by these, as published
   * (1); or exact distances correct how far a ray may leap (0, default). Published steps may lead past voxels: of such a tree
   * stratus_tree_first_hit() misses hits or finds later ones, and stratus_tree_covers() never lets it stand in for another. The other
   * methods ignore the option. */
  int uncorrected_flooding;
} stratus_tree_options;

STRATUS_API stratus_tree_options stratus_tree_options_default(void);

typedef struct stratus_tree stratus_tree;

/* Builds a tree that copies what it needs, so that the voxels may be destroyed. Options out of their ranges give STRATUS_INVALID_ARGUMENT.
 * An empty set makes a tree that no ray hits. The tree does not depend on the device or the number of threads. */
STRATUS_API stratus_status stratus_tree_create(
  stratus_context* context, const stratus_voxels* voxels, const stratus_tree_options* options, stratus_tree** tree);
STRATUS_API void stratus_tree_destroy(stratus_tree* tree);

typedef struct stratus_tree_statistics {
  stratus_tree_method method; /* never auto, but what it took */
  int64_t voxels, bricks;     /* bricks: those that hold an effective voxel */
  int64_t nodes, leaves, field_leaves;
  int64_t field_bricks; /* bricks that distance-field leaves span */
  int depth;            /* of the deepest leaf; the root has depth 0 */
  int64_t wide_nodes;   /* nodes of the hierarchy over the bricks of a WIDE tree, which is one leaf */
  size_t bytes;
  double sah;       /* surface area heuristic, where both costs are 1 and a distance-field leaf counts as one primitive */
  double bandwidth; /* bandwidth of the density; 0 if none was needed */
  int dbscan_splits, density_splits, sah_splits, median_splits; /* number of splits found by each rule */
  int uncorrected; /* 1: made with uncorrected_flooding, so that rays may miss voxels. A saved tree keeps it. */
  double build_ms;
  char why[256]; /* one sentence: why the tree has this shape */
} stratus_tree_statistics;

STRATUS_EXPERIMENTAL void stratus_tree_get_statistics(const stratus_tree* tree, stratus_tree_statistics* statistics);

typedef enum stratus_node_kind { STRATUS_NODE_INNER, STRATUS_NODE_BRICKS, STRATUS_NODE_FIELD } stratus_node_kind;

typedef struct stratus_node_box {
  int64_t lo[3], hi[3]; /* voxels, [lo, hi) */
  int depth;
  stratus_node_kind kind;
  int64_t voxels; /* number of effective voxels in the node */
} stratus_node_box;

/* Fills the boxes of all nodes, statistics.nodes of them, parents before children. */
STRATUS_EXPERIMENTAL void stratus_tree_boxes(const stratus_tree* tree, stratus_node_box* boxes);

/* Returns the size of a tree's bytes, for files and messages. They are little-endian and versioned, and hold a checksum. */
STRATUS_API size_t stratus_tree_bytes(const stratus_tree* tree);
/* Returns the hash of the volume's values, type, dimensions and hidden parts that the tree was built from; 0: it was built from a list. */
STRATUS_API uint64_t stratus_tree_hash(const stratus_tree* tree);
/* Writes stratus_tree_bytes() bytes. */
STRATUS_API void stratus_tree_save(const stratus_tree* tree, void* bytes);
/* Reads a tree from bytes. STRATUS_INVALID_ARGUMENT for bytes that are cut short, changed, or of another version or byte order. */
STRATUS_API stratus_status stratus_tree_load(stratus_context* context, const void* bytes, size_t size, stratus_tree** tree);
/* Sets *covers to 1 if the tree may replace one that would be built for this volume and criterion, else to 0. It may if it was built for
 * the same use (cells or voxels) from a volume with the same values, dimensions and hidden parts, and its criterion covers this one. The
 * volume's position does not matter. The call reads the whole volume once. */
STRATUS_API stratus_status stratus_tree_covers(stratus_context* context, const stratus_tree* tree, const stratus_volume* volume,
  const stratus_criterion* criterion, int cells, int* covers);

/* Finds the first effective voxel along each of `count` rays. Results equal those of stratus_voxels_first_hit() to the bit, edges and
 * corners included (but of trees with uncorrected_flooding), for origins up to some 1e9 voxels away; from farther away they may differ
 * where rays graze edges. A direction of length 0, or a number that is not finite (except t_max), gives STRATUS_INVALID_ARGUMENT with the
 * first such ray's index, and leaves `hits` undefined. Wide hierarchies, and hybrid trees and trees of one leaf up to 52,000 voxels long,
 * are traversed in beams and packets or on the context's device, others ray by ray on the host. Rays go in a beam where 64 that follow each
 * other, counted from the first, run side by side: give those of a picture tile by tile, each of 8 x 8 pixels, which takes half to two
 * thirds of the time of rows. The rays of a beam share `visited`. */
STRATUS_API stratus_status stratus_tree_first_hit(
  stratus_context* context, const stratus_tree* tree, const stratus_ray* rays, size_t count, stratus_hit* hits);

#ifdef __cplusplus
}
#endif

#endif
