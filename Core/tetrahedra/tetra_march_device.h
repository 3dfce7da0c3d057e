/* SPDX-License-Identifier: BSD-3-Clause
 * Marching through tetrahedra on the context's OpenCL device: kernels/tetra_march.cl. */
#ifndef STRATUS_TETRA_MARCH_DEVICE_H
#define STRATUS_TETRA_MARCH_DEVICE_H

#include "tetra_march_frame.h"

typedef struct stratus_tetra_device stratus_tetra_device;

/* Identifies the mesh and table of a frame by build numbers > 0 that rise, so that the device copies them only once. A device that shares
 * the host's memory reads them in place: call stratus_tetra_device_drop_table() before freeing the table, and
 * stratus_tetra_device_destroy() before freeing the mesh. */
typedef struct stratus_tetra_device_source {
  uint64_t mesh, table;
  int64_t cell_count, point_count;
} stratus_tetra_device_source;

/* stratus_tetra_march() on the device. Makes *device if that is NULL. *drawn false: the device cannot draw this mesh; a warning says why.
 */
stratus_status stratus_tetra_march_device(stratus_context* context, stratus_tetra_device** device,
  const stratus_tetra_device_source* source, stratus_tetra_frame* frame, stratus_tetra_buffers* buffers, stratus_tetra_counts* counts,
  double* entries_ms, double* march_ms, bool* drawn);
void stratus_tetra_device_drop_table(stratus_tetra_device* device);                        /* takes NULL */
void stratus_tetra_device_destroy(stratus_context* context, stratus_tetra_device* device); /* takes NULL */

#endif
