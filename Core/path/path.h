/* SPDX-License-Identifier: BSD-3-Clause
 * The parts of the path tracer. Rays are lines in places: along an axis without coordinates a place is an index coordinate, along one with
 * coordinates it is the coordinate itself, negative where coordinates fall. So places rise with the index, and are affine in the world. */
#ifndef STRATUS_PATH_H
#define STRATUS_PATH_H

#include "stratus/path.h"
#include "path_random.h"
#include "volume.h"

/* ---- path_field.c: the extinction at a place */

typedef struct stratus_path_field {
  const stratus_volume* volume; /* borrowed during a call, as the next two are */
  const stratus_transfer* transfer;
  const uint8_t* mask; /* NULL: none */
  bool linear;
  double sign[3];                            /* -1 along axes whose coordinates fall, otherwise 1 */
  double lo[3], hi[3];                       /* bounds; of a crop box, too */
  double to_world[16];                       /* from places */
  double to_place[9];                        /* takes displacements of the world to displacements of places */
  double opaque;                             /* the extinction of opacity 1, the largest of all */
  double bias;                               /* values farther than floats hold from this one count as infinite */
  double crop[3][2];                         /* places of the crop planes */
  uint32_t regions;                          /* crop regions that show, numbered by rising places */
  int plane_count;                           /* of clip planes */
  double planes[STRATUS_CLIP_PLANES_MAX][4]; /* in places */
  int64_t cells[3], blocks[3], block_size;   /* cells: number of them, at least 1 */
  double* majorant;                          /* the largest extinction of each block */
  uint8_t* hidden;                           /* as stratus_volume_hidden_cells() gives them; NULL: none */
} stratus_path_field;

/* Sets everything but majorant and hidden, which stay. */
void stratus_path_field_set(
  stratus_path_field* field, const stratus_volume* volume, const stratus_transfer* transfer, const stratus_path_options* options);
/* Makes majorant and hidden. */
stratus_status stratus_path_field_build(stratus_context* context, stratus_path_field* field);
void stratus_path_field_release(stratus_context* context, stratus_path_field* field);

void stratus_path_to_place(const stratus_path_field* field, const double world[3], double place[3]);
/* Transform displacements. */
void stratus_path_turn_to_place(const stratus_path_field* field, const double world[3], double place[3]);
void stratus_path_turn_to_world(const stratus_path_field* field, const double place[3], double world[3]);
/* Returns the cell, of first..last, that the place is in. */
int64_t stratus_path_cell(const stratus_path_field* field, int axis, int64_t first, int64_t last, double place);
/* Returns the place of value i. */
double stratus_path_value_place(const stratus_path_field* field, int axis, int64_t i);
/* Finds the value at a place in a block. Returns false if the place is transparent, whatever the transfer function. */
bool stratus_path_value(const stratus_path_field* field, const int64_t block[3], const double place[3], double* value);
/* Returns the largest extinction in the box between two places of a cell. */
double stratus_path_majorant(const stratus_path_field* field, const int64_t cell[3], const double from[3], const double to[3]);
double stratus_path_extinction(const stratus_path_field* field, double value);
void stratus_path_color(const stratus_path_field* field, double value, double rgb[3]);

/* ---- path_walk.c: rays through the blocks */

typedef struct stratus_path_ray {
  double from[3];    /* place */
  double along[3];   /* over one unit of world length */
  double begin, end; /* world lengths from `from` */
  uint64_t lookups;  /* values interpolated */
} stratus_path_ray;

/* Limits begin and end to the part of the ray in the bounds and before the clip planes. */
void stratus_path_clip(const stratus_path_field* field, stratus_path_ray* ray);
/* Returns where the ray collides, and the value there; INFINITY if it passes. */
double stratus_path_collide(const stratus_path_field* field, stratus_path_ray* ray, stratus_path_random* random, double* value);
/* Returns an estimate of the ray's transmittance. */
double stratus_path_transmittance(const stratus_path_field* field, stratus_path_ray* ray, stratus_path_random* random);

/* ---- path_light.c: light along a path */

/* Numbers of eight bytes only, so that lights are compared as bytes. */
typedef struct stratus_path_light {
  double vector[3]; /* positional: the place; otherwise the direction to the light in the world, of length 1 */
  double color[3], attenuation[3];
  double axis[3]; /* direction to the light in the cone's middle, of length 1 */
  double cone_cosine, cone_exponent;
  int64_t positional, has_cone;
} stratus_path_light;

typedef struct stratus_path_scene {
  int64_t light_count, bounces, has_sky;
  stratus_path_light lights[STRATUS_LIGHTS_MAX];
  double albedo, anisotropy, zenith[3], horizon[3], up[3]; /* up: of length 1 */
} stratus_path_scene;

/* Sets all bytes of the scene. */
void stratus_path_scene_set(
  stratus_path_scene* scene, const stratus_path_field* field, const stratus_camera* camera, const stratus_path_options* options);
/* Turns a direction of length 1 by a random angle of the phase function. */
void stratus_path_scatter(double anisotropy, stratus_path_random* random, double direction[3]);
/* Traces a path. ray: clipped; direction: its direction in the world, of length 1. Adds to vertices and lookups. rgba: receives radiance
 * and 1, or zeros if the ray passes. Returns where it collides first, otherwise INFINITY. */
double stratus_path_trace(const stratus_path_scene* scene, const stratus_path_field* field, const stratus_path_ray* ray,
  const double direction[3], stratus_path_random* random, double rgba[4], uint64_t* vertices, uint64_t* lookups);

/* ---- path_check.c */

stratus_status stratus_path_check(stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_path_options* options, const stratus_image* image);

#endif
