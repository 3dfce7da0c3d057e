/* SPDX-License-Identifier: BSD-3-Clause
 * Draws the tiles of projected tetrahedra on the OpenCL device: keeps a copy of the mesh until it is rebuilt, sends the frame with its bins
 * of cells, and launches a kernel; where a work item is a pixel, another one for pixels whose pieces came out of order. */
#include "tetra_device.h"

#include <string.h>

#define COUNTS 3 /* of a tile */
#define GROUP 64 /* pixels of a work group, if each item is a pixel: SQUARE^2 in tetra_project.cl */
#define TILE_PIXELS ((size_t)PROJECT_TILE * PROJECT_TILE)

typedef struct device_projection {
  stratus_context* context;
  stratus_tetra_device* device;
  stratus_device_slot* slots; /* the device's */
  const stratus_tetra_projection* projection;
  bool packets;
  size_t tiles;
} device_projection;

static const stratus_tetra_slot parameters[] = { TETRA_ARGUMENTS, TETRA_VERTICES, TETRA_MESH_VALUES, TETRA_SUMS, TETRA_COLORS, TETRA_POINTS,
  TETRA_LINES, TETRA_ENDS, TETRA_RECTS, TETRA_BIN_BEGIN, TETRA_BINS, TETRA_RGBA, TETRA_RGBA8, TETRA_DEPTH, TETRA_SAMPLES, TETRA_COUNTS,
  TETRA_WRONG };

/* The mesh's vertices are the caller's, and may be gone after the frame: a device that shares the host's memory borrows them for one frame
 * only, and any other keeps a copy. */
static stratus_status send_mesh(device_projection* p, const stratus_tetra_device_source* source)
{
  const stratus_tetra_projection* projection = p->projection;
  stratus_tetra_device* d = p->device;
  const size_t cells = (size_t)source->cell_count;
  const bool borrows = stratus_device_lends(p->context->device, projection->vertices);
  if (borrows || d->project_mesh != source->mesh) {
    d->project_mesh = 0;
    TRY(stratus_slot_send(p->context, p->slots + TETRA_VERTICES, CL_MEM_READ_ONLY, projection->vertices, cells * 4 * sizeof(int32_t)));
    d->project_mesh = borrows ? 0 : source->mesh;
  }
  if (d->project_values != source->values) {
    TRY(stratus_slot_keep(p->context, p->slots + TETRA_MESH_VALUES, projection->cell_values, cells * sizeof(float)));
    d->project_values = source->values;
  }
  return STRATUS_OK;
}

static stratus_status send(device_projection* p, const stratus_tetra_device_source* source)
{
  const stratus_tetra_projection* projection = p->projection;
  const uint32_t pairs = projection->bin_begin[p->tiles];
  TRY(send_mesh(p, source));
  TRY(stratus_tetra_device_send(p->context, p->device, source, projection->frame, projection->frame->points));
  TRY(stratus_slot_send(
    p->context, p->slots + TETRA_RECTS, CL_MEM_READ_ONLY, projection->rects, (size_t)projection->cell_count * sizeof *projection->rects));
  TRY(stratus_slot_send(
    p->context, p->slots + TETRA_BIN_BEGIN, CL_MEM_READ_ONLY, projection->bin_begin, (p->tiles + 1) * sizeof *projection->bin_begin));
  return stratus_slot_send(p->context, p->slots + TETRA_BINS, CL_MEM_READ_ONLY, projection->bins, pairs * sizeof *projection->bins);
}

static stratus_status launch(device_projection* p, const char* name, size_t items, size_t group)
{
  const size_t global[2] = { items, 1 }, local[2] = { group, 1 };
  return stratus_tetra_device_launch(
    p->context, p->device, "tetra_project", name, p->packets, false, parameters, COUNT_OF(parameters), global, local);
}

/* Draws the pixels that the kernel has listed. */
static stratus_status draw_again(device_projection* p)
{
  uint32_t wrong = 0;
  TRY(stratus_device_read(p->context, p->slots[TETRA_WRONG].memory, 0, sizeof wrong, &wrong));
  return wrong > 0 ? launch(p, "tetra_project_again", wrong, GROUP) : STRATUS_OK;
}

/* sums: COUNTS zeros per tile, to which kernels add. */
static stratus_status draw_tiles(device_projection* p, uint32_t* sums)
{
  const stratus_image* image = &p->projection->frame->image;
  const size_t bytes = p->tiles * COUNTS * sizeof *sums;
  const uint32_t none = 0;
  TRY(stratus_tetra_device_lend_picture(p->context, p->device, image));
  TRY(stratus_slot_send(p->context, p->slots + TETRA_COUNTS, CL_MEM_READ_WRITE, sums, bytes));
  if (p->packets) {
    TRY(stratus_slot_lend(p->context, p->slots + TETRA_WRONG, CL_MEM_READ_WRITE, NULL, 0));
    TRY(launch(p, "tetra_project", p->tiles, 1));
  } else {
    TRY(stratus_slot_reserve(p->context, p->slots + TETRA_WRONG, CL_MEM_READ_WRITE, (1 + p->tiles * TILE_PIXELS) * sizeof(uint32_t)));
    TRY(stratus_device_write(p->context, p->slots[TETRA_WRONG].memory, 0, sizeof none, &none));
    TRY(launch(p, "tetra_project", p->tiles * TILE_PIXELS, GROUP));
    TRY(draw_again(p));
  }
  TRY(stratus_tetra_device_receive_picture(p->context, p->device, image));
  return stratus_slot_receive(p->context, p->slots + TETRA_COUNTS, sums, bytes);
}

static stratus_status draw(device_projection* p, const stratus_tetra_device_source* source, stratus_tetra_project_counts* counts)
{
  void* memory = NULL;
  TRY(send(p, source));
  TRY(stratus_allocate_zero(p->context, p->tiles, COUNTS * sizeof(uint32_t), &memory));
  uint32_t* sums = memory;
  const stratus_status status = draw_tiles(p, sums);
  for (size_t tile = 0; tile < p->tiles && status == STRATUS_OK; ++tile) {
    counts->rays += sums[COUNTS * tile];
    counts->segments += sums[COUNTS * tile + 1];
    counts->again += sums[COUNTS * tile + 2];
  }
  stratus_device_drain(p->context);
  if (status != STRATUS_OK || p->slots[TETRA_COUNTS].lent) {
    stratus_slot_drop(&p->slots[TETRA_COUNTS]);
  }
  stratus_release(p->context, memory);
  return status;
}

stratus_status stratus_tetra_project_device(stratus_context* context, stratus_tetra_device** device,
  const stratus_tetra_device_source* source, const stratus_tetra_projection* projection, stratus_tetra_project_counts* counts, bool* drawn)
{
  const char* why_not;
  *drawn = false;
  TRY(stratus_tetra_device_begin(context, device, source, (size_t)source->cell_count * 4 * sizeof(int32_t), &why_not));
  if (why_not) {
    return STRATUS_OK;
  }
  device_projection p = { context, *device, (*device)->slots, projection, stratus_tetra_device_packets(context),
    (size_t)projection->columns * (size_t)projection->rows };
  const stratus_status status = draw(&p, source, counts);
  stratus_tetra_device_return(context, *device);
  TRY(status);
  *drawn = true;
  return stratus_progress(context, "project", 1.0);
}
