/* SPDX-License-Identifier: BSD-3-Clause
 * The data that a ray caster keeps on the OpenCL device. */
#ifndef STRATUS_RAY_DEVICE_BUFFERS_H
#define STRATUS_RAY_DEVICE_BUFFERS_H

#include "device_frame.h"
#include "ray_cast_host.h"
#include "ray_caster.h"
#include "ray_pages_device.h"

#define STRATUS_RAY_DEVICE_GROUP 8 /* work items along each side of a group, if a work item is a ray */
/* Pixels along each side of the tile that a work item marches in packets. PoCL hands out the last 64 groups in one piece, so tiles are
 * small. */
#define STRATUS_RAY_DEVICE_TILE 16

typedef enum buffer_name {
  VALUES,
  HIDDEN,
  MAP,
  ROUGH,
  GRID,
  TABLE,
  LAYERS, /* of several volumes: stratus_ray_optics.layers */
  ARGUMENTS,
  PARTS,  /* of several volumes: stratus_several_arguments */
  MESHES, /* of several volumes: stratus_tetra_arguments */
  OPAQUE,
  RGBA,
  RGBA8,
  DEPTH,
  SAMPLES,
  COUNTS,
  BUFFERS
} buffer_name;

struct stratus_ray_device {
  stratus_device_slot slots[BUFFERS];
  stratus_ray_pages pages;
  bool in_pages; /* the values are in pages, and there is no buffer VALUES */
  uint64_t data_serial, table_serial, map_serial, rough_serial, grid_serial, layers_of;
  double layers_step;
  const float* layers; /* what LAYERS holds, of that table and step */
  cl_mem lights;       /* the maps of light of the frame, which own it; NULL: none */
};

/* ray_cast_device.c: return the RAY_HAS bits, the rare features that this frame uses. */
int stratus_ray_rarities(const stratus_ray_cast_arguments* a);
/* Returns how many parts of a picture count for themselves: tiles of packets, or rows of rays. */
size_t stratus_ray_device_parts(size_t width, size_t height, bool packets);
/* Sums the parts' counts, four each. */
void stratus_ray_device_count(const cl_uint* part, size_t parts, stratus_ray_counts* counts);
/* Sends what is stale of the data of one of several volumes. layers: NULL where it has none. *why_not: the reason why the device cannot
 * draw it; NULL where it can. */
stratus_status stratus_ray_device_send(
  stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, const float* layers, const char** why_not);

#endif
