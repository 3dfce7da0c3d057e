/* SPDX-License-Identifier: BSD-3-Clause
 * The input and output of the host's rays through several volumes. */
#ifndef STRATUS_RAY_SEVERAL_HOST_H
#define STRATUS_RAY_SEVERAL_HOST_H

#include "stratus/ray_cast.h"

#include "ray_cast_host.h"
#include "ray_several_arguments.h"
#include "tetra_march_frame.h"

/* A volume as the rays read it. */
typedef struct stratus_several_part {
  stratus_ray_caster* caster;   /* NULL: a mesh */
  stratus_tetra_caster* tetra;  /* NULL: a volume */
  stratus_tetra_frame* mesh;    /* the tetra's */
  stratus_ray_cast_frame frame; /* its output is not used */
  /* midpoint: colour times optical depth, and optical depth, of each entry over a segment; otherwise NULL */
  const float* layers;
  int type; /* of a volume's fetch, as of stratus_ray_fetch_type() */
  stratus_several_arguments arguments;
} stratus_several_part;

/* The most that the rays of a packet need of memory for a volume, or for a piece of one that crop regions cut. */
#define STRATUS_SEVERAL_PART_BYTES 20480

typedef struct stratus_several_frame {
  stratus_ray_cast_frame picture;        /* output of the rays; the arguments are the first volume's */
  const struct stratus_light_maps* maps; /* of light, that all share; NULL: none */
  unsigned char* rooms;                  /* on the host: memory of `room` bytes for each thread, not on their stacks, which may be small */
  size_t room;
  int count;
  stratus_several_part volumes[STRATUS_SEVERAL_MAX];
} stratus_several_frame;

/* One definition for each instruction set: a stratus_ray_cast_tile that takes the picture of a stratus_several_frame. */
stratus_ray_cast_tile stratus_several_tile_isa0, stratus_several_tile_isa1, stratus_several_tile_isa2, stratus_several_tile_isa3;

#endif
