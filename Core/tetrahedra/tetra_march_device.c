/* SPDX-License-Identifier: BSD-3-Clause
 * Marches through tetrahedra on the OpenCL device: keeps copies of mesh and table until they are rebuilt, sends the frame, and launches two
 * kernels. */
#include "tetra_march_device.h"

#include "device_frame.h"
#include "tetra_caster.h"

#include <stdio.h>
#include <string.h>

#define PIXELS ((size_t)TETRA_TILE * TETRA_TILE)
#define GROUP 64 /* work items in a group, if each is a pixel */

/* The kernel gets the arguments' size by a define and asserts it, too. */
_Static_assert(_Alignof(stratus_tetra_arguments) == sizeof(float), "arguments must be scalars of four bytes");
_Static_assert(sizeof(stratus_tetra_border_face) == 4 * TETRA_FACE, "a face must have no padding");

typedef enum buffer_name {
  ARGUMENTS,
  CELLS,
  CELL_VALUES,
  SUMS,
  COLORS,
  POINTS,
  LINES,
  ENDS,
  FACES,
  BIN_BEGIN,
  BINS,
  FIRST,
  ENTRIES,
  FOUND,
  RGBA,
  RGBA8,
  DEPTH,
  SAMPLES,
  COUNTS,
  BUFFERS
} buffer_name;

struct stratus_tetra_device {
  stratus_device_slot slots[BUFFERS];
  uint64_t mesh, table;
};

typedef struct device_march {
  stratus_context* context;
  stratus_tetra_device* device;
  stratus_device_slot* slots; /* the device's */
  stratus_tetra_frame* frame;
  bool packets;
  size_t tiles, pixels;
} device_march;

void stratus_tetra_device_drop_table(stratus_tetra_device* device)
{
  if (device) {
    stratus_slot_drop(&device->slots[SUMS]);
    stratus_slot_drop(&device->slots[COLORS]);
    device->table = 0;
  }
}

void stratus_tetra_device_destroy(stratus_context* context, stratus_tetra_device* device)
{
  if (device) {
    for (int name = 0; name < BUFFERS; ++name) {
      stratus_slot_drop(&device->slots[name]);
    }
    stratus_release(context, device);
  }
}

/* ---- steps */

static stratus_status upload(device_march* m, const stratus_tetra_device_source* source)
{
  stratus_tetra_device* d = m->device;
  const stratus_tetra_frame* frame = m->frame;
  const size_t cells = (size_t)source->cell_count, entries = (size_t)frame->table->size;
  if (d->mesh != source->mesh) {
    TRY(stratus_slot_keep(m->context, m->slots + CELLS, frame->cells, cells * TETRA_CELL * sizeof(int32_t)));
    TRY(stratus_slot_keep(m->context, m->slots + CELL_VALUES, frame->cell_values, cells * sizeof(float)));
    d->mesh = source->mesh;
  }
  if (d->table != source->table) {
    TRY(stratus_slot_keep(m->context, m->slots + SUMS, frame->march_sums, STRATUS_TETRA_SUMS * entries * sizeof(int32_t)));
    TRY(stratus_slot_keep(m->context, m->slots + COLORS, frame->table->rgba, 4 * entries * sizeof(float)));
    d->table = source->table;
  }
  return STRATUS_OK;
}

static stratus_status send_frame(device_march* m, size_t point_count)
{
  const stratus_tetra_frame* frame = m->frame;
  const stratus_image* image = &frame->image;
  const size_t lines = 2 * ((size_t)image->width + (size_t)image->height + 2 * TETRA_PADDING);
  TRY(stratus_slot_send(m->context, m->slots + ARGUMENTS, CL_MEM_READ_ONLY, &frame->arguments, sizeof frame->arguments));
  TRY(stratus_slot_send(m->context, m->slots + POINTS, CL_MEM_READ_ONLY, frame->places, point_count * 4 * sizeof(float)));
  TRY(stratus_slot_send(m->context, m->slots + LINES, CL_MEM_READ_ONLY, frame->us, lines * sizeof(float)));
  TRY(stratus_slot_send(
    m->context, m->slots + ENDS, CL_MEM_READ_ONLY, frame->ends, (size_t)image->width * (size_t)image->height * sizeof(float)));
  TRY(stratus_slot_send(m->context, m->slots + FACES, CL_MEM_READ_ONLY, frame->faces, frame->face_count * sizeof *frame->faces));
  TRY(stratus_slot_send(m->context, m->slots + BIN_BEGIN, CL_MEM_READ_ONLY, frame->bin_begin, (m->tiles + 1) * sizeof *frame->bin_begin));
  return stratus_slot_send(m->context, m->slots + BINS, CL_MEM_READ_ONLY, frame->bins, frame->bin_begin[m->tiles] * sizeof *frame->bins);
}

static stratus_status launch(device_march* m, const char* name, const buffer_name* order, unsigned arguments)
{
  char defines[96];
  cl_kernel kernel;
  (void)snprintf(defines, sizeof defines, "-DSTRATUS_DEVICE=1 -DSTRATUS_WIDTH=%d -DSTRATUS_ARGUMENTS_BYTES=%zu", m->packets ? 16 : 1,
    sizeof(stratus_tetra_arguments));
  TRY(stratus_device_kernel(m->context, "tetra_march", defines, name, &kernel));
  for (unsigned i = 0; i < arguments; ++i) {
    TRY(stratus_device_argument(m->context, kernel, i, sizeof(cl_mem), &m->slots[order[i]].memory));
  }
  const size_t global[2] = { (size_t)m->frame->columns * (m->packets ? 1 : PIXELS), (size_t)m->frame->rows };
  const size_t local[2] = { m->packets ? 1 : GROUP, 1 };
  return stratus_device_run(m->context, kernel, 2, global, local);
}

static stratus_status count_entries(device_march* m, stratus_tetra_buffers* buffers, size_t* total)
{
  static const buffer_name order[] = { ARGUMENTS, POINTS, LINES, FACES, BIN_BEGIN, BINS, FIRST };
  const size_t bytes = (m->pixels + 1) * sizeof(uint32_t);
  TRY(stratus_tetra_reserve(m->context, &buffers->first, m->pixels + 1, sizeof(uint32_t)));
  m->frame->first = buffers->first.memory;
  TRY(stratus_slot_lend(m->context, m->slots + FIRST, CL_MEM_READ_WRITE, m->frame->first, bytes));
  TRY(launch(m, "tetra_count", order, sizeof order / sizeof *order));
  TRY(stratus_slot_receive(m->context, m->slots + FIRST, m->frame->first, bytes));
  TRY(stratus_tetra_sum_entries(m->context, m->frame, m->pixels, total));
  return stratus_slot_send(m->context, m->slots + FIRST, CL_MEM_READ_WRITE, m->frame->first, bytes);
}

/* sums: four zeros per tile, to which the kernel adds. */
static stratus_status march(device_march* m, size_t entries, uint32_t* sums)
{
  static const buffer_name order[] = { ARGUMENTS, CELLS, CELL_VALUES, SUMS, COLORS, POINTS, LINES, ENDS, FACES, BIN_BEGIN, BINS, FIRST,
    ENTRIES, FOUND, RGBA, RGBA8, DEPTH, SAMPLES, COUNTS };
  const stratus_image* image = &m->frame->image;
  const size_t pixels = (size_t)image->width * (size_t)image->height, sums_bytes = m->tiles * 4 * sizeof *sums;
  TRY(stratus_slot_reserve(m->context, m->slots + ENTRIES, CL_MEM_READ_WRITE, 2 * sizeof(int32_t) * (entries > 0 ? entries : 1)));
  TRY(stratus_slot_reserve(m->context, m->slots + FOUND, CL_MEM_READ_WRITE, m->pixels * sizeof(uint32_t)));
  TRY(stratus_slot_lend(m->context, m->slots + RGBA, CL_MEM_WRITE_ONLY, image->rgba, pixels * 4 * sizeof(float)));
  TRY(stratus_slot_lend(m->context, m->slots + RGBA8, CL_MEM_WRITE_ONLY, image->rgba8, pixels * 4));
  TRY(stratus_slot_lend(m->context, m->slots + DEPTH, CL_MEM_WRITE_ONLY, image->depth, pixels * sizeof(float)));
  TRY(stratus_slot_lend(m->context, m->slots + SAMPLES, CL_MEM_WRITE_ONLY, image->samples, pixels * sizeof(uint32_t)));
  TRY(stratus_slot_send(m->context, m->slots + COUNTS, CL_MEM_READ_WRITE, sums, sums_bytes));
  TRY(launch(m, "tetra_march", order, sizeof order / sizeof *order));
  TRY(stratus_slot_receive(m->context, m->slots + RGBA, image->rgba, pixels * 4 * sizeof(float)));
  TRY(stratus_slot_receive(m->context, m->slots + RGBA8, image->rgba8, pixels * 4));
  TRY(stratus_slot_receive(m->context, m->slots + DEPTH, image->depth, pixels * sizeof(float)));
  TRY(stratus_slot_receive(m->context, m->slots + SAMPLES, image->samples, pixels * sizeof(uint32_t)));
  return stratus_slot_receive(m->context, m->slots + COUNTS, sums, sums_bytes);
}

static stratus_status draw(device_march* m, const stratus_tetra_device_source* source, stratus_tetra_buffers* buffers,
  stratus_tetra_counts* counts, double* entries_ms, double* march_ms)
{
  const double start = stratus_now_ms();
  size_t entries = 0;
  void* memory = NULL;
  TRY(upload(m, source));
  TRY(send_frame(m, (size_t)source->point_count));
  TRY(count_entries(m, buffers, &entries));
  TRY(stratus_progress(m->context, "entry faces", 1.0));
  const double marching = stratus_now_ms();
  TRY(stratus_allocate_zero(m->context, m->tiles, 4 * sizeof(uint32_t), &memory));
  uint32_t* sums = memory;
  const stratus_status status = march(m, entries, sums);
  for (size_t tile = 0; tile < m->tiles && status == STRATUS_OK; ++tile) {
    counts->rays += sums[4 * tile];
    counts->entries += sums[4 * tile + 1];
    counts->segments += sums[4 * tile + 2];
    counts->stuck += sums[4 * tile + 3];
  }
  if (status != STRATUS_OK || m->slots[COUNTS].lent) {
    stratus_slot_drop(&m->slots[COUNTS]);
  }
  stratus_release(m->context, memory);
  *entries_ms += marching - start;
  *march_ms = stratus_now_ms() - marching;
  return status;
}

/* Returns the reason why the device cannot draw this mesh, or NULL. */
static const char* obstacle(const stratus_context* context, const stratus_tetra_device_source* source)
{
  const size_t largest = stratus_device_largest_allocation(context->device);
  if ((size_t)source->cell_count > largest / (TETRA_CELL * sizeof(int32_t))) {
    return "the mesh's cells are larger than the device's largest allocation";
  }
  if ((size_t)source->point_count > largest / (4 * sizeof(float))) {
    return "the mesh's points are larger than the device's largest allocation";
  }
  return NULL;
}

stratus_status stratus_tetra_march_device(stratus_context* context, stratus_tetra_device** device,
  const stratus_tetra_device_source* source, stratus_tetra_frame* frame, stratus_tetra_buffers* buffers, stratus_tetra_counts* counts,
  double* entries_ms, double* march_ms, bool* drawn)
{
  const char* why_not = obstacle(context, source);
  *drawn = false;
  if (why_not) {
    stratus_log(context, STRATUS_LOG_WARNING, "drawing tetrahedra on the host: %s", why_not);
    return STRATUS_OK;
  }
  if (!*device) {
    void* memory = NULL;
    TRY(stratus_allocate_zero(context, 1, sizeof **device, &memory));
    *device = memory;
  }
  const size_t tiles = (size_t)frame->columns * (size_t)frame->rows;
  device_march m = { context, *device, (*device)->slots, frame, stratus_device_is_cpu(context->device), tiles, tiles * PIXELS };
  const stratus_status status = draw(&m, source, buffers, counts, entries_ms, march_ms);
  stratus_slots_return(m.slots, BUFFERS);
  TRY(status);
  *drawn = true;
  return stratus_progress(context, "march", 1.0);
}
