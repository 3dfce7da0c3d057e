/* SPDX-License-Identifier: BSD-3-Clause
 * Drawing tetrahedra on the context's OpenCL device: kernels/tetrahedra/tetra_march.cl and tetra_project.cl. */
#ifndef STRATUS_TETRA_DEVICE_H
#define STRATUS_TETRA_DEVICE_H

#include "device_frame.h"
#include "tetra_project.h"

/* The buffers that the device keeps from frame to frame. Both methods share one set of buffers; each draws with its own part of it. */
typedef enum stratus_tetra_slot {
  /* of the mesh: for the march cells and their values, for projection vertices and values of cells */
  TETRA_CELLS,
  TETRA_CELL_VALUES,
  TETRA_VERTICES,
  TETRA_MESH_VALUES,
  TETRA_GRADIENTS,
  TETRA_COMPONENT_PLACES,
  /* of the table */
  TETRA_SUMS,
  TETRA_COLORS,
  TETRA_FACTORS,
  TETRA_COMPONENT_SUMS,
  TETRA_RUNNING_SUMS, /* among several volumes: the table's own */
  /* of a frame */
  TETRA_ARGUMENTS,
  TETRA_POINTS,
  TETRA_LINES,
  TETRA_ENDS,
  TETRA_FACES,
  TETRA_RECTS,
  TETRA_BIN_BEGIN,
  TETRA_BINS,
  TETRA_FIRST,
  TETRA_ENTRIES,
  TETRA_FOUND,
  TETRA_WRONG,
  TETRA_COUNTS,
  /* of the picture */
  TETRA_RGBA,
  TETRA_RGBA8,
  TETRA_DEPTH,
  TETRA_SAMPLES,
  TETRA_SLOTS
} stratus_tetra_slot;

typedef struct stratus_tetra_device {
  stratus_device_slot slots[TETRA_SLOTS];
  uint64_t march_mesh, march_values, project_mesh, project_values, table, running, gradients,
    components;  /* build numbers of the slots' contents */
  cl_mem lights; /* the maps of light of the frame, which own it; NULL: none */
} stratus_tetra_device;

/* Identifies the mesh, its values and the table of a frame by build numbers > 0 that rise, so that the device copies them only once. A
 * device that shares the host's memory reads them in place: call stratus_tetra_device_drop_table() before freeing the table,
 * stratus_tetra_device_drop_values() before freeing the values, and stratus_tetra_device_destroy() before freeing the mesh. */
typedef struct stratus_tetra_device_source {
  uint64_t mesh, values, table;
  int64_t cell_count, point_count;
  size_t cell_ints, value_count;  /* of the cells that rays march through, and of values, be it of cells or points */
  uint64_t gradients, components; /* build numbers, read only of frames that are lit */
} stratus_tetra_device_source;

/* stratus_tetra_march() on the device. Makes *device if that is NULL. *drawn false: the device cannot draw this mesh; a warning says why.
 */
stratus_status stratus_tetra_march_device(stratus_context* context, stratus_tetra_device** device,
  const stratus_tetra_device_source* source, stratus_tetra_frame* frame, stratus_tetra_buffers* buffers, stratus_tetra_counts* counts,
  double* entries_ms, double* march_ms, bool* drawn);
/* Gives the device what rays through several volumes read of the mesh, with the faces by which they enter it. The buffers of the frame may
 * be lent until stratus_tetra_device_return(). *why_not: the reason why the device cannot draw it; NULL where it can. */
stratus_status stratus_tetra_device_enter(stratus_context* context, stratus_tetra_device** device,
  const stratus_tetra_device_source* source, stratus_tetra_frame* frame, stratus_tetra_buffers* buffers, const char** why_not);
void stratus_tetra_device_return(const stratus_context* context, stratus_tetra_device* device); /* takes NULL */
/* Draws the tiles of a projection whose cells are in their bins. The rest is as in stratus_tetra_march_device(). */
stratus_status stratus_tetra_project_device(stratus_context* context, stratus_tetra_device** device,
  const stratus_tetra_device_source* source, const stratus_tetra_projection* projection, stratus_tetra_project_counts* counts, bool* drawn);
void stratus_tetra_device_drop_table(stratus_tetra_device* device);                        /* takes NULL */
void stratus_tetra_device_drop_values(stratus_tetra_device* device);                       /* takes NULL */
void stratus_tetra_device_drop_gradients(stratus_tetra_device* device);                    /* takes NULL */
void stratus_tetra_device_drop_components(stratus_tetra_device* device);                   /* takes NULL */
void stratus_tetra_device_destroy(stratus_context* context, stratus_tetra_device* device); /* takes NULL */

/* ---- steps of both */

/* Whether a work item does a packet of 16 rays; else it does one. */
bool stratus_tetra_device_packets(const stratus_context* context);

/* *why_not: the reason why the device cannot draw a mesh, of which a warning is logged; NULL where it can. Makes *device if that is NULL.
 * cell_bytes: of the largest buffer of cells. */
stratus_status stratus_tetra_device_begin(stratus_context* context, stratus_tetra_device** device,
  const stratus_tetra_device_source* source, size_t cell_bytes, const char** why_not);
/* Sends the table, where it is another than before, and the frame: arguments, points, lines and ends of rays. points: four floats each. */
stratus_status stratus_tetra_device_send(stratus_context* context, stratus_tetra_device* device, const stratus_tetra_device_source* source,
  const stratus_tetra_frame* frame, const float* points);
/* Makes room for the picture, and gets it. */
stratus_status stratus_tetra_device_lend_picture(stratus_context* context, stratus_tetra_device* device, const stratus_image* image);
stratus_status stratus_tetra_device_receive_picture(stratus_context* context, stratus_tetra_device* device, const stratus_image* image);
/* Launches a kernel of `source` whose parameters are the slots of `order`. packets: a work item does packets of 16 rays; lit: the variant
 * TETRA_LIT. */
stratus_status stratus_tetra_device_launch(stratus_context* context, stratus_tetra_device* device, const char* source, const char* name,
  bool packets, bool lit, const stratus_tetra_slot* order, unsigned parameters, const size_t global[2], const size_t local[2]);

#endif
