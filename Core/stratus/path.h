/* SPDX-License-Identifier: BSD-3-Clause
 * The reference of light that a volume absorbs and scatters: a Monte Carlo path tracer in double precision. */
#ifndef STRATUS_PUBLIC_PATH_H
#define STRATUS_PUBLIC_PATH_H

#include "ray_cast.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The model.
 *
 * - Extinction. A value of opacity A has the extinction -ln(1 - A) / unit_distance per world length. It is at most 4096 per shortest edge
 *   of a voxel. Opacity 1 has 64 / unit_distance or 256 per shortest edge, whichever is more. Edges below a millionth of the longest one
 *   count as a millionth.
 * - Albedo. A collision scatters the part albedo * C of each colour channel, where C is the transfer function's colour, and absorbs the
 *   rest. Nothing emits light.
 * - Phase function. Henyey & Greenstein 1941: p(c) = (1 - g^2) / (4 pi (1 + g^2 - 2 g c)^1.5), where c is the cosine between the directions
 *   in which light travels before and after it scatters. g > 0 scatters forwards.
 * - Lights. A light of colour L adds the in-scattered radiance s L 4 pi p(c) T at a place of scattering coefficient s, where T is the
 *   transmittance from the light to this place. So L is an irradiance of 4 pi L, and a thin sample of colour C that scatters evenly shows
 *   C L, as in unlit images. Distance dims a light only by its attenuation. Lights have no size, and are seen only by their scattered
 * light.
 * - Sky. Radiance from infinity, a mix of sky_horizon and sky_zenith by the cosine to `up`. Below the horizon it is sky_horizon. Camera
 * rays that meet nothing do not show the sky.
 *
 * Free paths: delta tracking (Woodcock et al. 1965). Transmittance: ratio tracking (Novak et al. 2014). Both use the largest extinction of
 * each block or, where that is high, of parts of its cells. Each estimate is unbiased. */
typedef struct stratus_path_options {
  int samples; /* paths that a call adds to each pixel, 1..1000000000. Default 64. */
  /* At least 0, finite. A call ends before it has added `samples` if the standard error of the image (see the report) is at most this. The
   * error is first compared at 16 samples. Default 0: a call adds all samples. */
  double tolerance;
  uint64_t seed;     /* Images of different seeds are independent. Default 0. */
  int bounces;       /* The largest number of scatterings of a path, at least 0. 1: single scattering. 0 (default): no limit. */
  double albedo;     /* 0..1, default 1 */
  double anisotropy; /* g, -.99...99. Default 0: light scatters evenly. */
  int light_count;   /* 0..8, or -1 (default): one white light at the eye (parallel: directed from its plane) */
  stratus_light lights[STRATUS_LIGHTS_MAX]; /* separate_specular and specular_color are not read */
  double sky_zenith[3];                     /* red, green, blue, each 0..STRATUS_LIGHT_MAX. Default 0: no sky. */
  double sky_horizon[3];                    /* red, green, blue, each 0..STRATUS_LIGHT_MAX. Default 0. */
  double up[3];                             /* direction of the zenith in the world, of any length > 0. Default z. */
  stratus_interpolation interpolation;      /* default linear */
  /* Parts that clip planes and crop regions hide neither absorb nor scatter light. clip_gradients and clipped_value are not read. */
  stratus_ray_clipping_options clipping;
  /* Samples whose nearest value has the byte 0 neither absorb nor scatter. bytes is read during each call. label_count > 0 gives
   * STRATUS_UNSUPPORTED. */
  stratus_ray_mask_options mask;
  /* Side in cells of the blocks that have a largest extinction of their own, 1..1000000; 0 (default): 4. It changes the speed, and which
   * random numbers are used. */
  int block_size;
} stratus_path_options;

/* Return options with their defaults. */
STRATUS_EXPERIMENTAL stratus_path_options stratus_path_options_default(void);

typedef struct stratus_path_report {
  uint64_t samples; /* paths of each pixel so far */
  /* Root mean square of the standard errors of red, green, blue and alpha over the pixels with alpha > 0. NaN: not known from 1 sample. */
  double standard_error;
  double largest_error; /* the largest of these standard errors */
  uint64_t vertices;    /* scatterings so far */
  uint64_t lookups;     /* values interpolated so far */
  double seconds;       /* elapsed time of all calls so far */
  int restarted;        /* 1: this call began anew; 0: it continued the last image */
} stratus_path_report;

typedef struct stratus_path_tracer stratus_path_tracer;

/* Create a tracer without an image. Destroy it before its context. */
STRATUS_EXPERIMENTAL stratus_status stratus_path_tracer_create(stratus_context* context, stratus_path_tracer** tracer);
STRATUS_EXPERIMENTAL void stratus_path_tracer_destroy(stratus_path_tracer* tracer);

/* Add paths to each pixel, and write the image of all paths so far. The host computes.
 * - volume: 1 component, without DUPLICATE ghosts. Values, ghosts and coordinates are read during the call only.
 * - transfer: without gradient opacity. Its weight is not read.
 * - camera, image: see camera.h. Rays go through the pixels' centres. near_k, far_k and opaque_depth end only the rays from the camera.
 * They hide nothing from light.
 * - options, report: may be NULL.
 *
 * rgba: the mean radiance, and as alpha the part of the paths that collide. Alpha is thus an estimate by the same paths, of the same random
 * error. A pixel's radiance may exceed 1. depth: the least distance at which a path of the pixel has collided. samples: paths of the pixel.
 *
 * The tracer continues its last image if nothing else has changed: values (by pointer and revision), coordinates, functions, camera, size,
 * opaque depth, options except `samples` and `tolerance`. Otherwise it begins anew. The image depends only on these inputs and on the
 * number of samples: not on the number of threads, nor on how many calls added the samples.
 *
 * The call may be cancelled. The next call then continues, and some pixels may have more paths than the report says. Memory: 80 bytes for
 * each pixel. */
STRATUS_EXPERIMENTAL stratus_status stratus_path_tracer_render(stratus_path_tracer* tracer, const stratus_volume* volume,
  const stratus_transfer* transfer, const stratus_camera* camera, const stratus_path_options* options, const stratus_image* image,
  stratus_path_report* report);

/* Get the standard errors of the last image's pixels: 4 floats for each pixel, in the order of its rgba; NaN after 1 sample.
 * STRATUS_INVALID_ARGUMENT if there is no image. */
STRATUS_EXPERIMENTAL stratus_status stratus_path_tracer_errors(const stratus_path_tracer* tracer, float* errors);

#ifdef __cplusplus
}
#endif

#endif
