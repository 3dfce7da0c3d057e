/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of volumes by ray casting. */
#ifndef STRATUS_PUBLIC_RAY_CAST_H
#define STRATUS_PUBLIC_RAY_CAST_H

#include "camera.h"
#include "skipping.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum stratus_structure {
  STRATUS_STRUCTURE_AUTO,
  STRATUS_STRUCTURE_NONE,
  STRATUS_STRUCTURE_BLOCK,
  STRATUS_STRUCTURE_DISTANCE,
  STRATUS_STRUCTURE_OCTANT,
  STRATUS_STRUCTURE_HYBRID /* a hybrid tree */
} stratus_structure;

STRATUS_API const char* stratus_structure_name(stratus_structure structure);
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

#ifdef __cplusplus
}
#endif

#endif
