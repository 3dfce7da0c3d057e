/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Stratus: uneven volumes drawn fast and exactly. This is the only public header of the core, and its comments are
 * the contract.
 *
 * Conventions
 *   Arrays of a grid are indexed a[(k*ny + j)*nx + i]: x runs fastest. Images start at the bottom left, as in OpenGL.
 *   "Index coordinates" put the centre of voxel (i,j,k) at (i,j,k); "world" is what the camera sees.
 *   Inputs are borrowed const views, read during the call unless a comment says longer; what _create makes, _destroy
 *   frees, and _destroy takes NULL. A call that fails returns a status, leaves its outputs as they were, and leaves a
 *   sentence with the value and the allowed range in stratus_context_message().
 *   NULL: options may be, and mean the defaults; else only what a comment says. Otherwise a call that returns a status refuses it with
 *   STRATUS_INVALID_ARGUMENT (without a message where there is no object to leave it in); a call without a status takes an object that is
 * NULL for an empty one, and writes to no address that is. One context serves one thread at a time; different contexts are independent, and
 * several threads may make theirs at once. One lock for the process, the core's only global state, lets a single thread at a time ask
 * OpenCL for its devices, as not every platform's first answer bears more; nothing else is done under it. A thread that calls, and each of
 * OpenMP's, needs 128 KiB of stack on the host; what an OpenCL implementation needs comes on top.
 */
#ifndef STRATUS_H
#define STRATUS_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#if defined(STRATUS_BUILDING)
#define STRATUS_API __declspec(dllexport)
#else
#define STRATUS_API
#endif
#else
#define STRATUS_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define STRATUS_VERSION_MAJOR 0
#define STRATUS_VERSION_MINOR 1

typedef enum stratus_status {
  STRATUS_OK = 0,
  STRATUS_INVALID_ARGUMENT, /* a value out of its range; the message names value and range */
  STRATUS_OVERFLOW,         /* a product of sizes does not fit the address space */
  STRATUS_OUT_OF_MEMORY,    /* the allocator or the device returned nothing */
  STRATUS_CANCELLED,        /* the progress callback asked to stop; outputs are undefined, objects intact */
  STRATUS_NO_DEVICE,        /* no such OpenCL device */
  STRATUS_DEVICE_ERROR,     /* an OpenCL call failed, or the device disappeared */
  STRATUS_UNSUPPORTED       /* understood, but not built */
} stratus_status;

/* English name of a status, never NULL. */
STRATUS_API const char* stratus_status_name(stratus_status status);

/* ---------------------------------------------------------------- context */

typedef struct stratus_context stratus_context;

typedef enum stratus_log_level { STRATUS_LOG_DEBUG, STRATUS_LOG_INFO, STRATUS_LOG_WARNING } stratus_log_level;

typedef void* (*stratus_allocate_function)(void* user, size_t bytes); /* at least 64-byte aligned, or NULL */
typedef void (*stratus_release_function)(void* user, void* memory);   /* takes NULL */
typedef void (*stratus_log_function)(void* user, stratus_log_level level, const char* line);
/* stage: a short name ("value ranges", "ray cast"); fraction 0..1. Return non-zero to cancel. Called on the thread
 * that called the core, never from a worker. */
typedef int (*stratus_progress_function)(void* user, const char* stage, double fraction);

typedef struct stratus_context_options {
  /* "auto" (or NULL): the first OpenCL GPU, else the host; "host": plain C; else the index of stratus_device_name(),
   * or a part of its name, any case. Default "auto". */
  const char* device;
  int threads;                        /* of the host, 1..1024; 0: as many as OpenMP would take. Default 0. */
  stratus_allocate_function allocate; /* both or neither; default: the C library */
  stratus_release_function release;
  void* allocator_user;
  stratus_log_function log; /* default: silent */
  void* log_user;
  stratus_progress_function progress; /* default: none */
  void* progress_user;
} stratus_context_options;

STRATUS_API stratus_context_options stratus_context_options_default(void);

/* options may be NULL. On failure *context is NULL and `message`, if not NULL, gets up to `capacity` bytes of reason. */
STRATUS_API stratus_status stratus_context_create(
  const stratus_context_options* options, stratus_context** context, char* message, size_t capacity);
STRATUS_API void stratus_context_destroy(stratus_context* context);

/* Why the last failing call on this context failed; "" before any failure. Valid until the next call. */
STRATUS_API const char* stratus_context_message(const stratus_context* context);
/* Name of the device in use, "host (AVX-512, 2 threads)" for plain C. */
STRATUS_API const char* stratus_context_device(const stratus_context* context);
/* 1 if an OpenCL device draws, 0 if the host does. */
STRATUS_API int stratus_context_on_device(const stratus_context* context);
STRATUS_API int stratus_context_threads(const stratus_context* context);

/* All OpenCL devices of all platforms, in the loader's order; 0 where there is no platform. */
STRATUS_API int stratus_device_count(void);
/* Copies the name of device 0..count-1, cut to capacity; returns STRATUS_NO_DEVICE beyond. */
STRATUS_API stratus_status stratus_device_name(int index, char* name, size_t capacity);

/* ---------------------------------------------------------------- inputs */

typedef enum stratus_type {
  STRATUS_INT8,
  STRATUS_UINT8,
  STRATUS_INT16,
  STRATUS_UINT16,
  STRATUS_INT32,
  STRATUS_UINT32,
  STRATUS_INT64,
  STRATUS_UINT64,
  STRATUS_FLOAT32,
  STRATUS_FLOAT64
} stratus_type;

STRATUS_API size_t stratus_type_size(stratus_type type); /* bytes; 0 for no type */

#define STRATUS_COMPONENTS_MAX 4

/* vtkDataSetAttributes' ghost bits, as far as they matter here. */
#define STRATUS_GHOST_DUPLICATE 1u    /* point or cell: another piece owns it */
#define STRATUS_GHOST_HIDDEN_POINT 2u /* point: cells that touch it are transparent */
#define STRATUS_GHOST_HIDDEN_CELL 32u /* cell: transparent */

/* A view of values on a regular grid.
 * Values may be NaN or infinite: a cell with such a corner is transparent (nearest interpolation: such a voxel). Types of more than 24
 * bits are taken relative to one of their values (the least in magnitude of some thousand), in double, so that an offset costs no digits.
 */
typedef struct stratus_volume {
  const void* values; /* dimensions[0]*[1]*[2] values, x fastest, value_stride apart */
  stratus_type type;
  int64_t dimensions[3];       /* values along x, y, z; each >= 1 */
  int64_t value_stride;        /* distance between consecutive values, in values, >= 1; default 1 */
  double origin[3];            /* local position of voxel (0,0,0), or of the corner of the first cell if cell_centered */
  double spacing[3];           /* > 0 */
  double direction[9];         /* row-major rotation: local = origin + direction * (spacing * index); default identity */
  double matrix[16];           /* row-major affine: world = matrix * local; default identity; mirror and shear allowed */
  int cell_centered;           /* 1: a value belongs to a cell: the volume is dimensions*spacing wide and, where linear, clamps
                                * within half a cell of its border. Default 0: values sit on points, the volume is (dimensions-1)*spacing wide. */
  const uint8_t* point_ghosts; /* dimensions[] flags, NULL: none; not used if cell_centered */
  const uint8_t* cell_ghosts; /* a flag a cell, NULL: none. Cells along an axis: dimensions-1, but 1 where that is 0, as VTK counts those of
                               * flat images; cell_centered: dimensions. */
  uint64_t revision;          /* the caller raises it when values or ghosts change under the same pointer. Default 0. */
  int components; /* 1..4, default 1 (0 is 1): value v's component c is values[v*value_stride + c]. More than 1: ray casts in composite
                   * mode only; everything else takes component 0. */
} stratus_volume;

STRATUS_API stratus_volume stratus_volume_default(void);
/* Checks a view: pointers, dimensions, overflow, finite positive spacing, invertible matrices. */
STRATUS_API stratus_status stratus_volume_check(stratus_context* context, const stratus_volume* volume);

/* A transfer function: piecewise linear between points of non-decreasing value (equal values make a step). */
typedef struct stratus_transfer {
  const double* opacity; /* opacity_count pairs: value, opacity in 0..1 per unit_distance; 1 is opaque, however short the way
                          * through it. A single value at which the function is 1 is passed on the way to others. */
  size_t opacity_count;  /* >= 1 */
  const double* color;   /* color_count quadruples: value, red, green, blue in 0..1 */
  size_t color_count;    /* >= 1 */
  double unit_distance;  /* world length that `opacity` is per, > 0. Default 1. */
  int clamp;             /* 1: the end points' opacity holds beyond them. 0: transparent there. Default 1. Colours always hold. */
  /* Ray cast, composite: gradient_count pairs: the gradient's magnitude, and what the optical depth is multiplied by there, in 0..1 (above
   * 0, opacity 1 stays opaque); the ends hold beyond. The magnitude is in values per mean spacing of the grid (as VTK's mappers have it),
   * whatever the volume's matrix. Default NULL, 0: none. */
  const double* gradient;
  size_t gradient_count;
  double weight; /* independent components: what their optical depth is multiplied by, 0..1. Default 1. */
} stratus_transfer;

STRATUS_API stratus_transfer stratus_transfer_default(void);
STRATUS_API stratus_status stratus_transfer_check(stratus_context* context, const stratus_transfer* transfer);

/* Rays of the picture. With u, v in -1..1 at the window's edges (pixel i of n has its centre at (2i+1)/n - 1), the
 * ray is, for near_k <= k <= far_k,
 *   perspective: eye + k (forward + u right + v up)      parallel: eye + u right + v up + k forward.
 * So with |forward| = 1 and right, up orthogonal to it, k is the distance to the eye's plane. Samples lie at (n + 1/2)
 * sample distances from the eye (parallel: from its plane), n an integer. */
typedef struct stratus_camera {
  double eye[3];
  double forward[3];
  double right[3];
  double up[3];
  double near_k; /* >= 0 (parallel: any), finite. Default 0. */
  double far_k;  /* > near_k, may be INFINITY. Default INFINITY. */
  int parallel;  /* default 0 */
} stratus_camera;

/* Perspective camera: view_angle is the full vertical angle, degrees in (0,180); aspect is width/height. */
STRATUS_API stratus_status stratus_camera_perspective(stratus_context* context, const double eye[3], const double focal[3],
  const double view_up[3], double view_angle, double aspect, stratus_camera* camera);
/* Parallel camera: parallel_scale is half the height of the window in world units, > 0. */
STRATUS_API stratus_status stratus_camera_parallel(stratus_context* context, const double eye[3], const double focal[3],
  const double view_up[3], double parallel_scale, double aspect, stratus_camera* camera);

/* ---------------------------------------------------------------- structures
 * Block b of size B (a power of two) owns the cells [b B, (b+1) B) along each axis, so its range covers voxels b B .. (b+1) B:
 * the halo that interpolation reads is inside. Built structures are immutable. */

typedef struct stratus_value_range stratus_value_range;

/* block_size: 2, 4, 8, 16 or 32; 0 takes the default, 4. */
STRATUS_API stratus_status stratus_value_range_create(
  stratus_context* context, const stratus_volume* volume, int block_size, stratus_value_range** ranges);
STRATUS_API void stratus_value_range_destroy(stratus_value_range* ranges);
/* Blocks along each axis, and their size. Any pointer may be NULL. */
STRATUS_API void stratus_value_range_blocks(const stratus_value_range* ranges, int64_t blocks[3], int* block_size);
/* Range of the finite values of the whole volume; STRATUS_INVALID_ARGUMENT if there is none. */
STRATUS_API stratus_status stratus_value_range_whole(const stratus_value_range* ranges, double* low, double* high);
/* Range of one block's finite values, low > high if it has none or is none; and whether a value in it is not finite or hidden. */
STRATUS_API void stratus_value_range_block(
  const stratus_value_range* ranges, int64_t i, int64_t j, int64_t k, double* low, double* high, int* gaps);

typedef enum stratus_sampling {
  STRATUS_SAMPLING_AUTO,
  STRATUS_SAMPLING_MIDPOINT,     /* one value in the middle of each segment */
  STRATUS_SAMPLING_PREINTEGRATED /* the transfer function integrated between the values at a segment's ends (Engel, Kraus & Ertl
                                  * 2001), from cumulative tables, sub-stepped where a segment is opaque */
} stratus_sampling;

typedef struct stratus_occupancy stratus_occupancy;

/* A block is occupied if the transfer function, as it is sampled, shows anything over the hull of the block's range. */
STRATUS_API stratus_status stratus_occupancy_create(stratus_context* context, const stratus_value_range* ranges,
  const stratus_transfer* transfer, stratus_sampling sampling, stratus_occupancy** occupancy);
/* A block is occupied if a value from the least to the largest in it lies in lower..upper, ends included, lower <= upper, infinities
 * allowed. Compared exactly, but types of more than 24 bits as the floats that stand for them, the ends rounded as the values are: such a
 * float counts if any value that it may stand for does. */
STRATUS_API stratus_status stratus_occupancy_create_between(
  stratus_context* context, const stratus_value_range* ranges, double lower, double upper, stratus_occupancy** occupancy);
STRATUS_API void stratus_occupancy_destroy(stratus_occupancy* occupancy);
STRATUS_API void stratus_occupancy_blocks(const stratus_occupancy* occupancy, int64_t blocks[3], int* block_size);
STRATUS_API int64_t stratus_occupancy_count(const stratus_occupancy* occupancy);                            /* occupied blocks */
STRATUS_API int stratus_occupancy_get(const stratus_occupancy* occupancy, int64_t i, int64_t j, int64_t k); /* 0 beyond the blocks */
/* Smallest box of occupied blocks, [lo, hi) in blocks; lo = hi = 0 if none. */
STRATUS_API void stratus_occupancy_bounds(const stratus_occupancy* occupancy, int64_t lo[3], int64_t hi[3]);

typedef enum stratus_distance_kind {
  STRATUS_DISTANCE_BLOCK, /* 1 in every empty block: plain block skipping */
  STRATUS_DISTANCE_FULL,  /* Chebyshev distance to the nearest occupied block (Deakin & Knackstedt 2019), O(n) sweeps */
  STRATUS_DISTANCE_PAPER, /* the same by the paper's O(n D) transform: the baseline, equal to the bit */
  STRATUS_DISTANCE_OCTANT /* eight maps: distance to the nearest occupied block among those a ray of that octant can reach */
} stratus_distance_kind;

typedef struct stratus_distance_map stratus_distance_map;

STRATUS_API stratus_status stratus_distance_map_create(
  stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_kind kind, stratus_distance_map** map);
STRATUS_API void stratus_distance_map_destroy(stratus_distance_map* map);
/* Distance in blocks from block (i,j,k), 0 in occupied ones, at most 127 (a longer one is told as 127). octant 0..7, bit a set: the ray
 * moves towards + on axis a; ignored by the other kinds. 0 beyond the blocks. */
STRATUS_API int stratus_distance_map_get(const stratus_distance_map* map, int octant, int64_t i, int64_t j, int64_t k);
STRATUS_API size_t stratus_distance_map_bytes(const stratus_distance_map* map);

/* ---------------------------------------------------------------- effective voxels
 * The voxels that a criterion makes visible (Guo et al. 2025, section 3). Voxel (i,j,k) is the cube of edge 1 about (i,j,k) in index
 * coordinates. At most 2^18 voxels along an axis. */

typedef struct stratus_criterion {
  const stratus_transfer* transfer; /* not NULL: values of opacity > 0. Default NULL. */
  double lower, upper;              /* else values in lower..upper, ends included, lower <= upper, infinities allowed. Default: all. */
} stratus_criterion;

STRATUS_API stratus_criterion stratus_criterion_default(void);

typedef struct stratus_voxels stratus_voxels;

/* Finite values that meet the criterion, but none that is hidden or owned by another piece (cell flags count where cell_centered). */
STRATUS_API stratus_status stratus_voxels_create(
  stratus_context* context, const stratus_volume* volume, const stratus_criterion* criterion, stratus_voxels** voxels);
/* For ray casting: every voxel of the 4^3 blocks of cells whose value range shows anything (a block's ranges as stratus_value_range has
 * them; what a criterion without transfer function tells is rounded outward). A tree of it may serve structure HYBRID. Voxel (i,j,k) is
 * cell (i,j,k), between the values of that place and the next; brick (a 4^3 of voxels) b is block b; dimensions: 4 times the ranges'
 * blocks. */
STRATUS_API stratus_status stratus_voxels_create_cells(
  stratus_context* context, const stratus_volume* volume, const stratus_criterion* criterion, stratus_voxels** voxels);
/* `count` triples of i, j, k, each in 0..dimensions-1; one that comes twice counts once. Index (i,j,k) is world (i+.5, j+.5, k+.5): the
 * voxel fills [i,i+1] and so on. */
STRATUS_API stratus_status stratus_voxels_create_list(
  stratus_context* context, const int64_t dimensions[3], const int32_t* positions, size_t count, stratus_voxels** voxels);
STRATUS_API void stratus_voxels_destroy(stratus_voxels* voxels);
STRATUS_API int64_t stratus_voxels_count(const stratus_voxels* voxels);
STRATUS_API void stratus_voxels_dimensions(const stratus_voxels* voxels, int64_t dimensions[3]);
STRATUS_API int stratus_voxels_get(const stratus_voxels* voxels, int64_t i, int64_t j, int64_t k); /* 0 beyond the dimensions */
/* Tight box [lo, hi) in voxels; lo = hi = 0 if there is none. */
STRATUS_API void stratus_voxels_bounds(const stratus_voxels* voxels, int64_t lo[3], int64_t hi[3]);

/* ---------------------------------------------------------------- density
 * Kernel density of effective voxels (eq. 2 to 5) with the quartic kernel, whose constant in three dimensions is 105 / (32 pi) for
 * densities a voxel to add up to 1. Lengths are voxels, at voxel centres. */

/* Bandwidth by eq. 3 and 4, never below 1 voxel (a shell's deviation of radii is next to nothing, and below 1 a voxel sees only itself);
 * 1 for fewer than two voxels. `raw`, may be NULL: as printed, unbounded below. */
STRATUS_API stratus_status stratus_density_bandwidth(
  stratus_context* context, const stratus_voxels* voxels, double* bandwidth, double* raw);
/* Density at a point in index coordinates, with its first (eq. 10) and second (eq. 11) partial derivatives. first, second: may be NULL. */
STRATUS_API stratus_status stratus_density_at(stratus_context* context, const stratus_voxels* voxels, double bandwidth,
  const double point[3], double* density, double first[3], double second[3]);

/* ---------------------------------------------------------------- distance field
 * Euclidean distance, voxel centre to voxel centre, from each voxel to the nearest effective one. */

typedef enum stratus_field_method {
  STRATUS_FIELD_EXACT,       /* separable, squared distances as integers; zigzag or envelope, whichever is cheaper for the set */
  STRATUS_FIELD_ZIGZAG,      /* rows searched outward from each voxel, up to the best so far */
  STRATUS_FIELD_ENVELOPE,    /* lower envelope of parabolas (Felzenszwalb & Huttenlocher 2012) */
  STRATUS_FIELD_JFA,         /* jump flooding (Rong & Tan 2006): steps n/2, n/4 .. 1 */
  STRATUS_FIELD_JFA_1,       /* JFA+1: one more pass of step 1 */
  STRATUS_FIELD_JFA_2,       /* JFA+2: passes of steps 2 and 1 more */
  STRATUS_FIELD_1_JFA,       /* 1+JFA: a pass of step 1 first */
  STRATUS_FIELD_JFA_SQUARED, /* JFA^2: all passes twice */
  STRATUS_FIELD_AJFA,        /* adaptive: E1 (1 - E2) of a pass (eq. 6 and 7) of .05 or more lets the step fall to 3/4, else to 1/2 */
  STRATUS_FIELD_AJFA_FIG5    /* the paper's figure 5: 64, 48, 15, 10, 3, 1, scaled to the grid; leaves voxels unfilled */
} stratus_field_method;

STRATUS_API const char* stratus_field_method_name(stratus_field_method method);

typedef struct stratus_field_options {
  stratus_field_method method; /* default exact */
  int is_signed;               /* 1: inside effective voxels minus the distance to the nearest voxel that is not one. Default 0. */
  int first_step;              /* floodings: cap on the first step, >= 1; 0 (default): half the longest edge */
} stratus_field_options;

STRATUS_API stratus_field_options stratus_field_options_default(void);

typedef struct stratus_field_report {
  int passes;            /* over the grid; exact: 3, signed too, for both halves share them; signed floodings: both of them */
  uint64_t updated;      /* voxels that a flooding pass brought nearer, all passes */
  int steps[64];         /* floodings: step of each of the first 64 passes */
  double e1[64], e2[64]; /* floodings: eq. 6 and 7 of each, over the voxels that are not sought; e2 is 1 where none came nearer */
  double build_ms;
} stratus_field_report;

typedef struct stratus_field stratus_field;

/* Over all of the voxels' dimensions. report: may be NULL. Exact fields take 2 bytes a voxel where all distances are below 176, 8 where the
 * grid's diagonal is 46339 or longer, else 4; none where no voxel or every one is effective. STRATUS_OVERFLOW where 4 bytes a voxel do not
 * fit the address space, or where a flooding would need more than 31 bits to name a voxel. Floodings err on the long side only. */
STRATUS_API stratus_status stratus_field_create(stratus_context* context, const stratus_voxels* voxels,
  const stratus_field_options* options, stratus_field** field, stratus_field_report* report);
STRATUS_API void stratus_field_destroy(stratus_field* field);
/* Distance in voxels; INFINITY where no effective voxel is known (none at all, or a flooding left it unfilled), -INFINITY inside a signed
 * field that is all effective; INFINITY beyond the dimensions. */
STRATUS_API double stratus_field_get(const stratus_field* field, int64_t i, int64_t j, int64_t k);
/* dimensions[0]*[1]*[2] distances, x fastest. */
STRATUS_API void stratus_field_distances(const stratus_field* field, float* distances);
/* The paper's layout (2.3): four floats a voxel, the nearest effective voxel's position and the distance; -1, -1, -1, INFINITY where
 * unknown. A signed field names the voxel that its distance goes to; of several equally near ones, the one of the smallest index (a
 * flooding: of those that it found). voxels: those of the field; others of another size or count are STRATUS_INVALID_ARGUMENT. */
STRATUS_API stratus_status stratus_field_rgba(const stratus_field* field, const stratus_voxels* voxels, float* rgba);

/* ---------------------------------------------------------------- trees for first hits */

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

STRATUS_API const char* stratus_tree_method_name(
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

STRATUS_API void stratus_tree_get_statistics(const stratus_tree* tree, stratus_tree_statistics* statistics);

typedef enum stratus_node_kind { STRATUS_NODE_INNER, STRATUS_NODE_BRICKS, STRATUS_NODE_FIELD } stratus_node_kind;

typedef struct stratus_node_box {
  int64_t lo[3], hi[3]; /* voxels, [lo, hi) */
  int depth;
  stratus_node_kind kind;
  int64_t voxels; /* effective ones in it */
} stratus_node_box;

/* Boxes of all nodes, statistics.nodes of them, parents before children. */
STRATUS_API void stratus_tree_boxes(const stratus_tree* tree, stratus_node_box* boxes);

/* Every voxel in exactly one leaf, boxes tight, distances never too long: checked against the voxels. STRATUS_INVALID_ARGUMENT, and what is
 * wrong in the message. */
STRATUS_API stratus_status stratus_tree_check(stratus_context* context, const stratus_tree* tree, const stratus_voxels* voxels);

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

typedef struct stratus_ray {
  double origin[3];    /* world */
  double direction[3]; /* world, any length > 0 (longest component at least 1e-290 voxels) */
  double t_min, t_max; /* origin + t direction, t_min <= t <= t_max; t_max may be INFINITY */
} stratus_ray;

typedef struct stratus_hit {
  double t;         /* where the ray enters the voxel, t_min if it begins inside; INFINITY: no hit */
  int32_t voxel[3]; /* -1: no hit */
  int32_t face; /* 2*axis + (1 if it is the upper one) of the voxel's face that the ray enters by; -1 where it begins inside, or no hit */
  float normal[3];  /* outward, world, of that face (of length 1); begun inside: against the direction */
  uint32_t visited; /* nodes and steps in distance fields */
} stratus_hit;

/* The first effective voxel along each of `count` rays: that of stratus_voxels_first_hit() to the bit, edges and corners included, for
 * origins up to some 1e9 voxels away (farther ones may differ where rays graze edges). Rays with a direction of length 0, or with a number
 * that is not finite (t_max aside): STRATUS_INVALID_ARGUMENT with the first one's index, and `hits` undefined. Threads and device: the
 * context's; trees of one leaf go in packets, or on the device, others ray by ray on the host. */
STRATUS_API stratus_status stratus_tree_first_hit(
  stratus_context* context, const stratus_tree* tree, const stratus_ray* rays, size_t count, stratus_hit* hits);
/* The same answer by a plain walk from voxel to voxel in double precision, one thread: slow, and the measure of the other. */
STRATUS_API stratus_status stratus_voxels_first_hit(
  stratus_context* context, const stratus_voxels* voxels, const stratus_ray* rays, size_t count, stratus_hit* hits);

/* ---------------------------------------------------------------- ray cast */

typedef enum stratus_structure {
  STRATUS_STRUCTURE_AUTO,
  STRATUS_STRUCTURE_NONE,
  STRATUS_STRUCTURE_BLOCK,
  STRATUS_STRUCTURE_DISTANCE,
  STRATUS_STRUCTURE_OCTANT,
  STRATUS_STRUCTURE_HYBRID /* a hybrid tree */
} stratus_structure;

STRATUS_API const char* stratus_structure_name(stratus_structure structure);
STRATUS_API const char* stratus_sampling_name(stratus_sampling sampling);

typedef enum stratus_interpolation { STRATUS_INTERPOLATION_LINEAR, STRATUS_INTERPOLATION_NEAREST } stratus_interpolation;

typedef enum stratus_mode {
  STRATUS_MODE_COMPOSITE, /* light through the whole of a ray */
  STRATUS_MODE_FIRST_HIT, /* effective voxels (opacity > 0) as lit solids, opaque. Structure none walks from voxel to voxel, block and
                           * distance read one distance field, octant eight of them, hybrid and auto a hybrid tree: all the same picture. */
  STRATUS_MODE_MAXIMUM,   /* the largest value sampled along the ray, in its colour and its opacity (not per length) */
  STRATUS_MODE_MINIMUM,   /* the smallest */
  STRATUS_MODE_AVERAGE,   /* grey: the mean of opacity (not per length) times value, over the part of the ray whose values lie in
                             average_range */
  STRATUS_MODE_ADDITIVE,  /* grey: the integral of opacity times value along the ray, lengths in unit_distance */
  STRATUS_MODE_ISOSURFACE /* surfaces where the field has a contour value, in that value's colour and opacity (not per length), one behind
                           * the other. Linear interpolation only. Exact: the field is a cubic along the ray in each cell, and all its roots
                           * are met. */
} stratus_mode;

/* Means and sums take a value as a part of the whole volume's range of finite values, are cut off at 1, and are opaque: sums wherever a ray
 * meets the volume's bounds, means where anything counts. */

/* "composite", "first-hit", "maximum", "minimum", "average", "additive", "isosurface" */
STRATUS_API const char* stratus_mode_name(stratus_mode mode);

typedef enum stratus_normals {
  STRATUS_NORMALS_FACES,   /* of the voxel's face that the ray enters by */
  STRATUS_NORMALS_GRADIENT /* of the field, by central differences, turned towards the ray's begin; where it is 0, the face's */
} stratus_normals;

#define STRATUS_LIGHTS_MAX 8
#define STRATUS_LIGHT_MAX 1e15 /* of a light's colour and a shading's numbers: their products and sums are floats */

typedef struct stratus_light {
  double vector[3]; /* world; positional: where it stands, else the direction from the scene to it, of any length > 0 */
  double color[3];  /* red, green, blue, each 0..STRATUS_LIGHT_MAX */
  int positional;
} stratus_light;

/* Phong's: with the transfer function's colour C, c = ambient C + sum over lights of l (diffuse max(0, N L) C + specular max(0, R
 * V)^power). Samples of volumes (composite) are lit as VTK's mappers light them: N H in place of R V, H half way between L and V (Blinn),
 * and specular where N L > 0 only; N against the gradient by central differences, 0 where that is 0. Where nothing is lit (first hit: on is
 * 0; composite and isosurface: shade is 0; other modes), no other number of it is read or refused. */
typedef struct stratus_shading {
  int on;                /* first hit; 0: c = C. Default 1. Composite: see stratus_ray_cast_options.shade */
  double ambient;        /* 0..STRATUS_LIGHT_MAX, as the next three; default .1 */
  double diffuse;        /* default .9 */
  double specular;       /* default 0 */
  double specular_power; /* default 10 */
  int light_count;       /* 0..8, or -1 (default): one white light at the eye (parallel: from its plane) */
  stratus_light lights[STRATUS_LIGHTS_MAX];
  int one_sided; /* composite; 1: only sides that face the light, against the gradient, are lit. Default 0: N is turned towards the eye. */
} stratus_shading;

#define STRATUS_CLIP_PLANES_MAX 6
#define STRATUS_CONTOURS_MAX 16
#define STRATUS_CROP_INSIDE 0x2000u
#define STRATUS_CROP_ALL 0x7ffffffu

typedef struct stratus_ray_cast_options {
  stratus_structure structure; /* default auto: the cheapest that the scene needs, told in the report */
  stratus_sampling sampling;   /* default auto: by the transfer function's bend against the data. Nearest is never pre-integrated. */
  stratus_interpolation interpolation; /* default linear */
  double sample_distance; /* world length, at most 4096 voxels; 0 (default): from the data's spacing and the transfer function */
  double termination;     /* a ray ends when its alpha passes this, 0..1; default .999 */
  int block_size;         /* 2, 4, 8, 16, 32; 0 (default): 4. More where the maps would outgrow 2e9 bytes. */
  int crop;               /* 1: only the regions of crop_regions. Default 0. */
  double crop_bounds[6];  /* xmin xmax ymin ymax zmin zmax along the grid's axes: origin + spacing*index, before direction and matrix */
  uint32_t
    crop_regions; /* of the 27 that the bounds' six planes divide space into: bit x + 3 y + 9 z is set where region (x, y, z) is shown, each
                   * 0 (below the lower plane), 1 (between the planes) or 2. Default STRATUS_CROP_INSIDE: between all planes. */
  int clip_plane_count;                           /* 0..6 */
  double clip_planes[STRATUS_CLIP_PLANES_MAX][4]; /* world: a x + b y + c z + d >= 0 is kept */
  int audit;                                      /* 1: also march without structure and count the pixels whose bits differ. Default 0. */
  stratus_mode mode;                              /* default composite */
  stratus_normals normals; /* first hit; default faces. A ray that a clip plane or the crop cuts within a voxel has their normal. */
  stratus_shading shading; /* first hit; composite and isosurface with shade */
  int shade;               /* composite and isosurface; 1: samples are lit by `shading`. Default 0 */
  int dependent;           /* composite, volumes of several components. 0 (default): each is a medium of its own, with a transfer function
                            * each; where they mix, their optical depths add up, and so does the light that they send. 1: together they are
                            * one medium: of 2, the first has the colour and the second the opacity of the one transfer function; of 4
                            * (STRATUS_UINT8 only), the first three are red, green, blue in 0..255, and the fourth has its opacity. The last
                            * one's gradient counts. */
  double average_range[2]; /* average: values that count, ends included, first <= last, infinities allowed. Default: all. */
  int contour_count;       /* isosurface: 1..16; other modes: not used. Default 0. */
  double contours[STRATUS_CONTOURS_MAX]; /* finite, in any order */
  /* A byte a value of the volume, NULL: none. A sample is transparent where the byte of the nearest value is 0; pre-integrated, a segment
   * is where one of its ends is. Not for first hits. Copied when it, its revision or the volume's data changes. */
  const uint8_t* mask;
  uint64_t mask_revision; /* the caller raises it when the bytes change under the same pointer. Default 0. */
  int label_count;        /* composite, one component. 1..255: the mask's bytes hide nothing but are labels: l in 1..label_count has the
                           * colour and opacity of transfer[l] (the nearest value's label; the value as it is sampled), all others those of
                           * transfer[0], whose gradient opacity counts for all. Never pre-integrated. 0 (default): no labels. */
  int jitter;             /* 1: each ray's samples are moved along it by 0..1 sample distances, by a number from pixel and jitter_seed, so
                           * that wood grain turns into noise. Default 0. */
  uint32_t jitter_seed;   /* default 0 */
} stratus_ray_cast_options;

STRATUS_API stratus_ray_cast_options stratus_ray_cast_options_default(void);

/* The picture and what bounds it. All buffers are the caller's, width*height pixels, bottom row first. */
typedef struct stratus_image {
  int width;                 /* 1..65536 */
  int height;                /* 1..65536 */
  float* rgba;               /* out: 4 floats a pixel, premultiplied by alpha; 0 where nothing is */
  float* depth;              /* out, may be NULL: world distance along the ray from the eye (parallel: from its plane) to the first segment
                              * that contributes; INFINITY where none does */
  uint8_t* rgba8;            /* out, may be NULL: rgba in 0..255, rounded to the nearest; above 1 is 255 */
  uint32_t* samples;         /* out, may be NULL: samples taken in the pixel */
  const float* opaque_depth; /* in, may be NULL: OpenGL window depth 0..1 of opaque geometry between near_k and far_k (both
                              * finite then); rays end there */
} stratus_image;

typedef struct stratus_ray_cast_report {
  uint64_t rays;             /* that met the volume's bounds, among those of the pixels that what is occupied covers */
  uint64_t samples;          /* values interpolated; isosurfaces: cells visited */
  uint64_t skipped;          /* segments that the structure skipped */
  uint64_t lookups;          /* reads of the structure */
  uint64_t differing_pixels; /* audit only */
  uint64_t blocks, occupied_blocks;
  /* how often each was built since the ray caster was created: a camera move raises none of them */
  uint64_t range_builds, table_builds, occupancy_builds, structure_builds, uploads;
  double range_ms, table_ms, occupancy_ms, structure_ms, upload_ms, cast_ms; /* of this call; 0: not done */
  size_t structure_bytes;
  int window[4];               /* x0, x1, y0, y1: pixels outside [x0, x1) x [y0, y1) show nothing */
  stratus_structure structure; /* used */
  stratus_sampling sampling;   /* used */
  double sample_distance;      /* used, world */
  char why[256];               /* the reasons for structure, sampling and sample distance, one sentence */
  int offered_tree;            /* 1: the structure is the tree of stratus_ray_caster_offer_tree() */
} stratus_ray_cast_report;

typedef struct stratus_ray_caster stratus_ray_caster;

STRATUS_API stratus_status stratus_ray_caster_create(stratus_context* context, stratus_ray_caster** caster);
STRATUS_API void stratus_ray_caster_destroy(stratus_ray_caster* caster);

/* Draws. volume->values and ghosts stay borrowed until the next call with another volume, _release or _destroy. What is built is kept, and
 * built anew only when what it is built from changes: ranges with the volume's pointers, type, dimensions, stride, centring, revision or
 * the block size; tables, occupancy and structure with the transfer function, the sampling, and (tables) the sample distance. Geometry and
 * camera rebuild nothing. report may be NULL. A failed call leaves the picture undefined, and the caster fit for the next call. */
STRATUS_API stratus_status stratus_ray_caster_render(stratus_ray_caster* caster, const stratus_volume* volume,
  const stratus_transfer* transfer, const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image,
  stratus_ray_cast_report* report);

/* First hits (STRATUS_MODE_FIRST_HIT): voxels count as cubes about their values, so the solid reaches half a voxel beyond a volume of
 * points. In the report, samples are hits, lookups what trees visited, blocks and occupied_blocks bricks of 4^3 voxels with any effective
 * one, occupancy_builds the making of voxels; sampling, sample distance, termination and block size are not used. A change of colours alone
 * rebuilds nothing. */

/* Offers a tree that comes with the data, as stratus_tree_save() wrote it: structure hybrid, and auto in first hits, use it in place of one
 * of the caster's own where it serves (stratus_tree_covers(); first hits: with the same voxels exactly). The bytes are copied. NULL: none
 * any more. Bytes that stratus_tree_load() refuses: its status, and none is offered any more. */
STRATUS_API stratus_status stratus_ray_caster_offer_tree(stratus_ray_caster* caster, const void* bytes, size_t size);

/* Frees what was built, on host and device; the next render builds anew. An offered tree stays. */
STRATUS_API void stratus_ray_caster_release(stratus_ray_caster* caster);

/* ---------------------------------------------------------------- frustum
 * What a camera sees, as six half-spaces: a x + b y + c z + d >= 0 is inside. Normals of any length. A plane {0, 0, 0, d} is none if d >= 0
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

/* ---------------------------------------------------------------- octree of objects
 * Thousands to millions of boxes, and which of them a frustum sees: Li & Huang 2024 (layered linear octree, split on demand). Each level is
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
/* Every object where its placement has it, once a place, and all counts right; STRATUS_INVALID_ARGUMENT, and what is wrong in the message.
 */
STRATUS_API stratus_status stratus_octree_check(const stratus_octree* octree);

/* ---------------------------------------------------------------- tetrahedra */

/* A view of a mesh of linear tetrahedra. */
typedef struct stratus_mesh {
  const double* points;    /* point_count triples, local coordinates, finite */
  int64_t point_count;     /* 0..2^31-1; points that no cell uses are allowed */
  const int32_t* vertices; /* cell_count quadruples of point numbers; any orientation */
  int64_t cell_count;      /* 0..2^30-1 */
  const void* values;      /* a value a point, or a cell, value_stride apart; NULL where only geometry counts */
  stratus_type type;
  int64_t value_stride;  /* in values, >= 1. Default 1. */
  int cell_values;       /* 1: a value belongs to a cell, constant in it. Default 0. */
  const uint8_t* hidden; /* a flag a cell, not 0: transparent; NULL: none. Values that are not finite hide their cells, too. */
  double matrix[16];     /* row-major affine: world = matrix * local; default identity; mirror and shear allowed */
  uint64_t revision;     /* the caller raises it when anything changes under the same pointers. Default 0. */
} stratus_mesh;

STRATUS_API stratus_mesh stratus_mesh_default(void);
/* Checks a view: pointers, counts, point numbers, finite points, invertible matrix. */
STRATUS_API stratus_status stratus_mesh_check(stratus_context* context, const stratus_mesh* mesh);

/* ---------------------------------------------------------------- partition of a mesh
 * A mesh cut along planes into the leaves of a K-D tree (Li et al. 2012, section 2), so that each cell lies in one leaf and leaves can be
 * sorted apart. Points keep their numbers; a point on a cut edge comes behind them, once, whoever asks for it: pieces of neighbours meet in
 * the same points and faces. A point within 2^-46 of the cells' largest coordinate of a plane lies on it, for all cells alike: it is not
 * cut off, stays where it is, and its cells reach over the plane by so much. A cell that has a volume leaves no piece without one. */

typedef enum stratus_partition_rule {
  STRATUS_PARTITION_MEDIAN, /* of the planes through the mesh's own points between the 40 % and the 60 % quantile, the one that cuts fewest
                               cells */
  STRATUS_PARTITION_PAPER   /* of evenly spaced planes, the one that adds fewest cells among those that growth and imbalance admit */
} stratus_partition_rule;

typedef struct stratus_partition_options {
  stratus_partition_rule rule; /* default median */
  int depth;                   /* 0..16: at most 2^depth leaves. Default 3. */
  int planes;                  /* tried an axis and node, 1..4096. Default 64. */
  double growth;      /* the paper's Phi: most new cells per cell of the node, > 0, may be INFINITY. Default INFINITY (paper: .3). */
  double imbalance;   /* the paper's epsilon: |l - r| / ((l + r)/2) is below it, > 0. Default .5. */
  int rotations;      /* where no plane is admissible at the root the mesh is turned this many times at most, and cut again,
                       * 0..64. Default 0. */
  int64_t leaf_cells; /* a node of so many or fewer is not cut, >= 1. Default 1024. */
} stratus_partition_options;

STRATUS_API stratus_partition_options stratus_partition_options_default(void);

/* Node 0 is the root. */
typedef struct stratus_partition_node {
  int32_t axis;     /* 0..2; -1: a leaf */
  int32_t below;    /* child with the points whose coordinate is <= value; of a leaf: its number */
  int32_t above;    /* child with those >= value */
  int32_t reserved; /* 0 */
  double value;     /* of the coordinate along row `axis` of the frame */
} stratus_partition_node;

/* A tree over a mesh: what a partition gives, and what an order takes. */
typedef struct stratus_leaves {
  const stratus_partition_node* nodes;
  int32_t node_count;  /* >= 1 */
  int32_t leaf_count;  /* 1..65536 */
  const int32_t* leaf; /* of each cell, 0..leaf_count-1 */
  double frame[9];     /* rows: the axes along which the tree cuts, in the mesh's local coordinates. The identity unless it was rotated. */
} stratus_leaves;

typedef struct stratus_partition stratus_partition;

/* options may be NULL. The mesh is read during the call only; its values, hidden flags and matrix don't count. */
STRATUS_API stratus_status stratus_partition_create(
  stratus_context* context, const stratus_mesh* mesh, const stratus_partition_options* options, stratus_partition** partition);
STRATUS_API void stratus_partition_destroy(stratus_partition* partition);

typedef struct stratus_partition_result {
  const double* points; /* point_count triples: the mesh's, then those on cut edges */
  int64_t point_count;
  const int32_t* vertices; /* cell_count quadruples, leaf by leaf; each with the orientation of the cell that it comes from */
  int64_t cell_count;
  const int32_t* cells; /* the mesh's cell that each comes from */
  stratus_leaves leaves;
  int64_t old_points;    /* points of the mesh */
  const int32_t* ends;   /* 2 for each new point old_points + i: the ends of its edge, lower numbers than its own (one may be new, too) */
  const double* weights; /* 1 for each: value = (1 - weight)*value(ends[0]) + weight*value(ends[1]), 0 < weight < 1 */
  int64_t cut_cells;     /* of the mesh, that are not whole any more */
  int64_t tiny_pieces;   /* left out: of cells with a volume, but rounding left them none */
  int64_t largest_leaf;  /* cells */
  int rotations;         /* made */
} stratus_partition_result;

/* Valid while the partition lives. */
STRATUS_API void stratus_partition_get(const stratus_partition* partition, stratus_partition_result* result);

/* ---------------------------------------------------------------- visibility order
 * The cells of a mesh in an order in which none hides one before it. Which of two neighbours lies in front follows from the side of their
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

/* ---------------------------------------------------------------- tetrahedra picture
 * Rays march from cell to cell through faces. Every cell that a ray meets counts with its exact thickness, its field linear between where
 * the ray enters and leaves (a cell's own value: constant), the transfer function pre-integrated over it. No order is needed, and gaps,
 * hollows and several parts are walked in the order in which the ray meets their borders. Which faces a ray meets is decided exactly, in
 * one plane for all cells, so that no ray slips between two cells or meets a face twice. Folded and inverted cells are drawn as parts of
 * their own: where cells overlap, both count, one after the other. */

typedef enum stratus_tetra_mode {
  STRATUS_TETRA_COMPOSITE, /* light through the whole of a ray */
  STRATUS_TETRA_MAXIMUM    /* the largest value on a ray: its colour, at the opacity of one unit distance */
} stratus_tetra_mode;

/* Two ways to one picture: the same faces are met at the same depths, and pieces of cells shaded by the same sums. They differ by the
 * rounding of floats: below .01 of 255 on the mean (root mean square), from whatever distance, and however a parallel camera's right and up
 * lean towards its forward. (A perspective one's are taken as they are: beyond 60 degrees off the right angle thickness loses digits.) A
 * pixel in which projection finds its cells out of order is drawn again, nearest piece first, so that no order of cells is trusted. Only
 * where cells overlap do the ways differ: pieces in order of depth, or one way through neighbours after the other. */
typedef enum stratus_tetra_method {
  STRATUS_TETRA_METHOD_AUTO,   /* the one that should cost less, by counts of cells, pixels and segments; a camera that stands still never
                                * changes it.   Where the context has a device: march */
  STRATUS_TETRA_METHOD_MARCH,  /* rays march from cell to cell */
  STRATUS_TETRA_METHOD_PROJECT /* cells that can show something are sorted, dealt to tiles of pixels, and composited there */
} stratus_tetra_method;

STRATUS_API const char* stratus_tetra_method_name(stratus_tetra_method method);

typedef struct stratus_tetra_options {
  stratus_tetra_mode mode; /* default composite */
  double termination; /* a ray ends when its alpha passes this, 0..1; default .9999: what is left out is a fortieth of a step of 8 bits.
                       * Not in mode maximum. */
  stratus_tetra_method method;  /* default auto */
  const stratus_leaves* leaves; /* of the mesh, for the order that projection needs: leaves are sorted in parallel. Borrowed until the
                                 * caster draws with others or is released. Default NULL: one leaf. */
} stratus_tetra_options;

STRATUS_API stratus_tetra_options stratus_tetra_options_default(void);

typedef struct stratus_tetra_report {
  stratus_tetra_method method; /* march or project */
  char why[256];               /* the reason, one sentence */
  uint64_t rays;    /* march: pixels whose ray meets a cell, in front of the eye or behind it; project: that meet a cell which can show */
  uint64_t entries; /* march: faces through which rays came in from outside */
  uint64_t
    segments;     /* march: cells that rays passed, those before the near plane included; project: pieces of cells that were composited */
  uint64_t stuck; /* ways through cells that ended inside, for no face could be told: 0 unless coordinates underflow */
  int64_t cells, shown_cells; /* of the mesh; those neither hidden nor blanked */
  int64_t blanked;            /* left out though not hidden: of values that are not finite floats, or that name a point more than once */
  int64_t repeated;           /* of those: that name a point more than once, and so have no volume */
  int64_t border_faces;       /* of shown cells */
  int64_t flat, inverted, broken_faces, folded_faces; /* cells without volume, of negative orientation; faces shared by more than two; by
                                                       * two on the same side */
  uint64_t mesh_builds, table_builds;                 /* since the caster was created: a camera move raises none */
  double build_ms, table_ms, transform_ms, entries_ms, march_ms; /* of this call; 0: not done */
  int64_t cells_in_view;                                         /* project: that can show something in some pixel */
  uint64_t pairs;                                                /* project: of a cell and a tile */
  int32_t leaves;                                                /* project: sorted in parallel */
  int64_t cycles;                                                /* project: of the order, see stratus_visibility_result */
  uint64_t again;                                                /* project: pixels drawn twice, as their cells had come in a wrong order */
  double sort_ms, bin_ms, project_ms;                            /* project: order, outlines and tiles of cells, pixels */
  size_t bytes;                                                  /* of what is kept for the mesh, and a frame's */
} stratus_tetra_report;

typedef struct stratus_tetra_caster stratus_tetra_caster;

/* World lengths between the camera and what it draws are at most the first, 1.2e27, and a mesh is at least one over it long (or a point),
 * so that lengths and optical depths over them are floats with all their digits. A parallel camera's window is at most the second, 1.1e12,
 * times narrower than what it draws lies off its middle, so that products of two such coordinates, and a value, are floats. The first holds
 * for coordinates in units of a perspective camera's right and up, too, times forward's length, and for how far a parallel one's lean along
 * forward; the second for how much longer than forward a perspective one's are. Others are STRATUS_INVALID_ARGUMENT, with the number in the
 * message. */
#define STRATUS_TETRA_REACH 1237940039285380274899124224.0 /* 2^90 */
#define STRATUS_TETRA_WINDOWS 1099511627776.0              /* 2^40 */

STRATUS_API stratus_status stratus_tetra_caster_create(stratus_context* context, stratus_tetra_caster** caster);
STRATUS_API void stratus_tetra_caster_destroy(stratus_tetra_caster* caster);

/* Marches on the context's device, or on the host where there is none or the mesh is too large for it; projects on the host, whatever the
 * device. The mesh must have values; it is read when pointers, counts, type, stride or revision differ from the last call's, else only its
 * matrix. Opacity is per world length. image: samples gets the segments of the pixel; depth the world distance to the first segment that
 * contributes (maximum: to where the largest value is). options, report may be NULL. A failed call leaves the picture undefined, and the
 * caster fit for the next call. At most INT32_MAX/8 cells, INT32_MAX/4 points and INT32_MAX/8 faces at the border: more are
 * STRATUS_UNSUPPORTED. */
STRATUS_API stratus_status stratus_tetra_caster_render(stratus_tetra_caster* caster, const stratus_mesh* mesh,
  const stratus_transfer* transfer, const stratus_camera* camera, const stratus_tetra_options* options, const stratus_image* image,
  stratus_tetra_report* report);
/* Frees what was built; the next render builds anew. */
STRATUS_API void stratus_tetra_caster_release(stratus_tetra_caster* caster);

/* ---------------------------------------------------------------- scenes of record
 * The volumes that tests, benchmarks, examples and the command line share. */

typedef struct stratus_scene {
  const char* name;
  stratus_volume volume;
  stratus_transfer transfer;
  stratus_transfer edited;           /* the second transfer function, for measuring edits */
  const stratus_transfer* transfers; /* as many as the volume has components: the first is `transfer` */
  int up_axis;                       /* 0..2, of the cameras */
  double occupied;                   /* fraction of values > 0 */
  double mean;                       /* of the values */
} stratus_scene;

/* Names: cloud, plume, fog, haze, peak, voxel; plume2: the plume as two pollutants, of which the first turns into the second on the way. */
STRATUS_API int stratus_scene_count(void);
STRATUS_API const char* stratus_scene_name(int index); /* NULL beyond */
STRATUS_API stratus_status stratus_scene_create(stratus_context* context, const char* name, stratus_scene** scene);
STRATUS_API void stratus_scene_destroy(stratus_context* context, stratus_scene* scene);
/* Camera `view` 0..7 of record around bounds xmin xmax ymin ymax zmin zmax: distance R / sin 15 deg, view angle 21.6 deg, elevation 25 deg,
 * azimuth 30 + 45 view deg about up_axis; parallel scale .72 R. */
STRATUS_API stratus_status stratus_scene_camera(
  stratus_context* context, const double bounds[6], int up_axis, int view, int parallel, double aspect, stratus_camera* camera);
/* World bounds of a volume. */
STRATUS_API stratus_status stratus_volume_bounds(stratus_context* context, const stratus_volume* volume, double bounds[6]);

/* Voxel sets of record: 17K 24K 30K 35K u225 u367 u571 u640 1M 10M; and their rays, 512*512 of each kind: kind 0 primary, 1 random from
 * empty voxels, in world coordinates of stratus_voxels_create_list(). */
STRATUS_API int stratus_voxel_scene_count(void);
STRATUS_API const char* stratus_voxel_scene_name(int index); /* NULL beyond */
/* *positions: *count triples, freed with stratus_voxel_scene_release(). */
STRATUS_API stratus_status stratus_voxel_scene_create(
  stratus_context* context, const char* name, int64_t dimensions[3], int32_t** positions, size_t* count);
STRATUS_API void stratus_voxel_scene_release(stratus_context* context, int32_t* positions);
STRATUS_API stratus_status stratus_voxel_scene_rays(stratus_context* context, const stratus_voxels* voxels, int kind, stratus_ray* rays);

/* Meshes of record that are made: holes (a plate with 24 of them) and wavelet (998,250 tetrahedra of a lattice). */
typedef struct stratus_mesh_scene {
  const char* name;
  stratus_mesh mesh;    /* wavelet: tetrahedra and a float a point. holes: points of a closed surface, no cells and no values */
  const int32_t* quads; /* holes: its faces, 4 point numbers each, planar, counterclockwise from outside; else NULL */
  int64_t quad_count;
  double maximum_volume; /* of a tetrahedron when a mesher fills the surface: about 800 thousand of them by TetGen; else 0 */
} stratus_mesh_scene;

STRATUS_API int stratus_mesh_scene_count(void);
STRATUS_API const char* stratus_mesh_scene_name(int index); /* NULL beyond */
STRATUS_API stratus_status stratus_mesh_scene_create(stratus_context* context, const char* name, stratus_mesh_scene** scene);
STRATUS_API void stratus_mesh_scene_destroy(stratus_context* context, stratus_mesh_scene* scene);
/* The field of a mesh of record, for points that a mesher adds; NaN for an unknown name. */
STRATUS_API double stratus_mesh_scene_value(const char* name, const double point[3]);

#ifdef __cplusplus
}
#endif
#endif
