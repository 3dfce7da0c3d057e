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
 *   One context serves one thread at a time; different contexts are independent.
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

/* vtkDataSetAttributes' ghost bits, as far as they matter here. */
#define STRATUS_GHOST_DUPLICATE 1u    /* point or cell: another piece owns it */
#define STRATUS_GHOST_HIDDEN_POINT 2u /* point: cells that touch it are transparent */
#define STRATUS_GHOST_HIDDEN_CELL 32u /* cell: transparent */

/* A view of one scalar component on a regular grid.
 * Values may be NaN or infinite: a cell with such a corner is transparent (nearest interpolation: such a voxel). Types of more than 24
 * bits are taken relative to one of their values (the least in magnitude of some thousand), in double, so that an offset costs no digits. */
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
  const uint8_t* cell_ghosts;  /* a flag a cell: dimensions-1 (cell_centered: dimensions) along each axis, NULL: none */
  uint64_t revision;           /* the caller raises it when values or ghosts change under the same pointer. Default 0. */
} stratus_volume;

STRATUS_API stratus_volume stratus_volume_default(void);
/* Checks a view: pointers, dimensions, overflow, finite positive spacing, invertible matrices. */
STRATUS_API stratus_status stratus_volume_check(stratus_context* context, const stratus_volume* volume);

/* A transfer function: piecewise linear between points of non-decreasing value (equal values make a step). */
typedef struct stratus_transfer {
  const double* opacity; /* opacity_count pairs: value, opacity in 0..1 per unit_distance */
  size_t opacity_count;  /* >= 1 */
  const double* color;   /* color_count quadruples: value, red, green, blue in 0..1 */
  size_t color_count;    /* >= 1 */
  double unit_distance;  /* world length that `opacity` is per, > 0. Default 1. */
  int clamp;             /* 1: the end points' opacity holds beyond them. 0: transparent there. Default 1. Colours always hold. */
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
  double near_k; /* >= 0 (parallel: any). Default 0. */
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
/* Range of one block's finite values, low > high if it has none; and whether a value in it is not finite or hidden. */
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
STRATUS_API void stratus_occupancy_destroy(stratus_occupancy* occupancy);
STRATUS_API void stratus_occupancy_blocks(const stratus_occupancy* occupancy, int64_t blocks[3], int* block_size);
STRATUS_API int64_t stratus_occupancy_count(const stratus_occupancy* occupancy); /* occupied blocks */
STRATUS_API int stratus_occupancy_get(const stratus_occupancy* occupancy, int64_t i, int64_t j, int64_t k);
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
 * moves towards + on axis a; ignored by the other kinds. */
STRATUS_API int stratus_distance_map_get(const stratus_distance_map* map, int octant, int64_t i, int64_t j, int64_t k);
STRATUS_API size_t stratus_distance_map_bytes(const stratus_distance_map* map);

/* ---------------------------------------------------------------- ray cast */

typedef enum stratus_structure {
  STRATUS_STRUCTURE_AUTO,
  STRATUS_STRUCTURE_NONE,
  STRATUS_STRUCTURE_BLOCK,
  STRATUS_STRUCTURE_DISTANCE,
  STRATUS_STRUCTURE_OCTANT
} stratus_structure;

STRATUS_API const char* stratus_structure_name(stratus_structure structure);
STRATUS_API const char* stratus_sampling_name(stratus_sampling sampling);

typedef enum stratus_interpolation { STRATUS_INTERPOLATION_LINEAR, STRATUS_INTERPOLATION_NEAREST } stratus_interpolation;

#define STRATUS_CLIP_PLANES_MAX 6

typedef struct stratus_ray_cast_options {
  stratus_structure structure; /* default auto: the cheapest that the scene needs, told in the report */
  stratus_sampling sampling;   /* default auto: by the transfer function's bend against the data. Nearest is never pre-integrated. */
  stratus_interpolation interpolation; /* default linear */
  double sample_distance; /* world length, at most 4096 voxels; 0 (default): from the data's spacing and the transfer function */
  double termination;     /* a ray ends when its alpha passes this, 0..1; default .999 */
  int block_size;         /* 2, 4, 8, 16, 32; 0 (default): 4. More where the maps would outgrow 2e9 bytes. */
  int crop;               /* 1: only inside crop_bounds. Default 0. */
  double crop_bounds[6];  /* xmin xmax ymin ymax zmin zmax along the grid's axes: origin + spacing*index, before direction and matrix */
  int clip_plane_count;   /* 0..6 */
  double clip_planes[STRATUS_CLIP_PLANES_MAX][4]; /* world: a x + b y + c z + d >= 0 is kept */
  int audit;                                      /* 1: also march without structure and count the pixels whose bits differ. Default 0. */
} stratus_ray_cast_options;

STRATUS_API stratus_ray_cast_options stratus_ray_cast_options_default(void);

/* The picture and what bounds it. All buffers are the caller's, width*height pixels, bottom row first. */
typedef struct stratus_image {
  int width;                 /* 1..65536 */
  int height;                /* 1..65536 */
  float* rgba;               /* out: 4 floats a pixel, premultiplied by alpha; 0 where nothing is */
  float* depth;              /* out, may be NULL: world distance along the ray from the eye (parallel: from its plane) to the first segment
                              * that contributes; INFINITY where none does */
  uint32_t* samples;         /* out, may be NULL: samples taken in the pixel */
  const float* opaque_depth; /* in, may be NULL: OpenGL window depth 0..1 of opaque geometry between near_k and far_k (both
                              * finite then); rays end there */
} stratus_image;

typedef struct stratus_ray_cast_report {
  uint64_t rays;             /* that met the volume's bounds, among those of the pixels that what is occupied covers */
  uint64_t samples;          /* values interpolated */
  uint64_t skipped;          /* segments that the structure skipped */
  uint64_t lookups;          /* reads of the structure */
  uint64_t differing_pixels; /* audit only */
  uint64_t blocks, occupied_blocks;
  /* how often each was built since the ray caster was created: a camera move raises none of them */
  uint64_t range_builds, table_builds, occupancy_builds, structure_builds, uploads;
  double range_ms, table_ms, occupancy_ms, structure_ms, upload_ms, cast_ms; /* of this call; 0: not done */
  size_t structure_bytes;
  stratus_structure structure; /* used */
  stratus_sampling sampling;   /* used */
  double sample_distance;      /* used, world */
  char why[256];               /* the reasons for structure, sampling and sample distance, one sentence */
} stratus_ray_cast_report;

typedef struct stratus_ray_caster stratus_ray_caster;

STRATUS_API stratus_status stratus_ray_caster_create(stratus_context* context, stratus_ray_caster** caster);
STRATUS_API void stratus_ray_caster_destroy(stratus_ray_caster* caster);

/* Draws. volume->values and ghosts stay borrowed until the next call with another volume, _release or _destroy. What is built is kept, and built anew only when
 * what it is built from changes: ranges with the volume's pointers, type, dimensions, stride, centring, revision or the block size; tables,
 * occupancy and structure with the transfer function, the sampling, and (tables) the sample distance. Geometry and camera rebuild nothing.
 * report may be NULL. A failed call leaves the picture undefined, and the caster fit for the next call. */
STRATUS_API stratus_status stratus_ray_caster_render(stratus_ray_caster* caster, const stratus_volume* volume,
  const stratus_transfer* transfer, const stratus_camera* camera, const stratus_ray_cast_options* options, const stratus_image* image,
  stratus_ray_cast_report* report);

/* Frees what was built, on host and device; the next render builds anew. */
STRATUS_API void stratus_ray_caster_release(stratus_ray_caster* caster);

/* ---------------------------------------------------------------- scenes of record
 * The volumes that tests, benchmarks, examples and the command line share. */

typedef struct stratus_scene {
  const char* name;
  stratus_volume volume;
  stratus_transfer transfer;
  stratus_transfer edited; /* the second transfer function, for measuring edits */
  int up_axis;             /* 0..2, of the cameras */
  double occupied;         /* fraction of values > 0 */
  double mean;             /* of the values */
} stratus_scene;

/* Names: cloud, plume, fog, haze, peak, voxel. */
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

#ifdef __cplusplus
}
#endif
#endif
