/* SPDX-License-Identifier: BSD-3-Clause
 * A volume's values on the OpenCL device in pages, where the whole volume does not fit one allocation: only the pages that rays may need,
 * in up to PAGE_SLABS buffers. */
#ifndef STRATUS_RAY_PAGES_DEVICE_H
#define STRATUS_RAY_PAGES_DEVICE_H

#include "device_frame.h"
#include "ray_field.h"
#include "ray_structure.h"

typedef struct stratus_ray_pages {
  stratus_device_slot slabs[PAGE_SLABS], table;
  int32_t* entries; /* the page table, as the device has it; NULL: the device has no pages */
  int64_t pages[3]; /* along each axis */
  int64_t count;    /* on the device */
  size_t bytes;     /* of these */
  uint64_t data_serial, occupancy_serial;
  uint64_t uploads; /* buffers that were sent, of all pages so far */
  int margin[2];    /* voxels below and above an occupied block that the pages were chosen for */
} stratus_ray_pages;

/* Gives the device the pages of the occupied blocks, and of the voxels in a margin (below, above) about them, unless it has them. *why_not:
 * the reason why they do not fit, written to `text`; NULL where they do. */
stratus_status stratus_ray_pages_update(const stratus_ray_field* field, const stratus_ray_structure* structure, const int margin[2],
  stratus_ray_pages* pages, char* text, size_t capacity, const char** why_not);
/* Writes the layout of the page table to the rays' arguments. */
void stratus_ray_pages_arguments(const stratus_ray_pages* pages, int planes, stratus_ray_cast_arguments* a);
/* Releases the buffers and all memory. */
void stratus_ray_pages_drop(stratus_context* context, stratus_ray_pages* pages);

#endif
