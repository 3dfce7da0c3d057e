/* SPDX-License-Identifier: BSD-3-Clause
 * Marches through tetrahedra on the OpenCL device: keeps a copy of the mesh until it is rebuilt, sends the frame, and launches two
 * kernels. */
#include "tetra_device.h"

#include "tetra_caster.h"

#include <string.h>

#define PIXELS ((size_t)TETRA_TILE * TETRA_TILE)
#define GROUP 64 /* work items in a group, if each is a pixel */

_Static_assert(sizeof(stratus_tetra_border_face) == 4 * TETRA_FACE, "a face must have no padding");

typedef struct device_march {
  stratus_context* context;
  stratus_tetra_device* device;
  stratus_device_slot* slots; /* the device's */
  stratus_tetra_frame* frame;
  bool packets;
  size_t tiles, pixels;
} device_march;

/* ---- steps */

static stratus_status send(device_march* m, const stratus_tetra_device_source* source)
{
  stratus_tetra_device* d = m->device;
  const stratus_tetra_frame* frame = m->frame;
  if (d->march_mesh != source->mesh) {
    TRY(stratus_slot_keep(m->context, m->slots + TETRA_CELLS, frame->cells, source->cell_ints * sizeof(int32_t)));
    d->march_mesh = source->mesh;
  }
  if (d->march_values != source->values) {
    TRY(stratus_slot_keep(m->context, m->slots + TETRA_CELL_VALUES, frame->cell_values, source->value_count * sizeof(float)));
    d->march_values = source->values;
  }
  if (frame->lit && (!m->slots[TETRA_GRADIENTS].memory || (frame->gradients && d->gradients != source->gradients))) {
    const size_t vectors = (size_t)source->point_count * (size_t)frame->gradient_sets;
    TRY(stratus_slot_keep(m->context, m->slots + TETRA_GRADIENTS, frame->gradients, vectors * 4 * sizeof *frame->gradients));
    d->gradients = frame->gradients ? source->gradients : 0;
  }
  if (frame->lit && (!m->slots[TETRA_COMPONENT_SUMS].memory || (frame->components && d->components != source->components))) {
    TRY(stratus_slot_keep(
      m->context, m->slots + TETRA_COMPONENT_PLACES, frame->components, frame->component_floats * sizeof *frame->components));
    TRY(stratus_slot_keep(m->context, m->slots + TETRA_COMPONENT_SUMS, frame->media, frame->media_count * sizeof *frame->media));
    d->components = frame->components ? source->components : 0;
  }
  if (frame->lit) {
    const size_t bytes = frame->factor_count * sizeof *frame->factors;
    TRY(stratus_slot_send(m->context, m->slots + TETRA_FACTORS, CL_MEM_READ_ONLY, frame->factors, bytes));
    d->lights = NULL;
    if (frame->maps) {
      bool sent;
      TRY(stratus_light_maps_on_device(frame->maps, &d->lights, &sent));
    }
  }
  TRY(stratus_tetra_device_send(m->context, d, source, frame, frame->places));
  TRY(stratus_slot_send(m->context, m->slots + TETRA_FACES, CL_MEM_READ_ONLY, frame->faces, frame->face_count * sizeof *frame->faces));
  TRY(stratus_slot_send(
    m->context, m->slots + TETRA_BIN_BEGIN, CL_MEM_READ_ONLY, frame->bin_begin, (m->tiles + 1) * sizeof *frame->bin_begin));
  return stratus_slot_send(
    m->context, m->slots + TETRA_BINS, CL_MEM_READ_ONLY, frame->bins, frame->bin_begin[m->tiles] * sizeof *frame->bins);
}

static stratus_status launch(device_march* m, const char* name, bool lit, const stratus_tetra_slot* order, unsigned parameters)
{
  const size_t global[2] = { (size_t)m->frame->columns * (m->packets ? 1 : PIXELS), (size_t)m->frame->rows };
  const size_t local[2] = { m->packets ? 1 : GROUP, 1 };
  return stratus_tetra_device_launch(m->context, m->device, "tetra_march", name, m->packets, lit, order, parameters, global, local);
}

static stratus_status count_entries(device_march* m, stratus_tetra_buffers* buffers, size_t* total)
{
  static const stratus_tetra_slot order[] = { TETRA_ARGUMENTS, TETRA_POINTS, TETRA_LINES, TETRA_FACES, TETRA_BIN_BEGIN, TETRA_BINS,
    TETRA_FIRST };
  const size_t bytes = (m->pixels + 1) * sizeof(uint32_t);
  TRY(stratus_tetra_reserve(m->context, &buffers->first, m->pixels + 1, sizeof(uint32_t)));
  m->frame->first = buffers->first.memory;
  TRY(stratus_slot_lend(m->context, m->slots + TETRA_FIRST, CL_MEM_READ_WRITE, m->frame->first, bytes));
  TRY(launch(m, "tetra_count", false, order, COUNT_OF(order)));
  TRY(stratus_slot_receive(m->context, m->slots + TETRA_FIRST, m->frame->first, bytes));
  TRY(stratus_tetra_sum_entries(m->context, m->frame, m->pixels, total));
  return stratus_slot_send(m->context, m->slots + TETRA_FIRST, CL_MEM_READ_WRITE, m->frame->first, bytes);
}

static stratus_status reserve_entries(device_march* m, size_t entries)
{
  TRY(stratus_slot_reserve(m->context, m->slots + TETRA_ENTRIES, CL_MEM_READ_WRITE, 2 * sizeof(int32_t) * (entries > 0 ? entries : 1)));
  return stratus_slot_reserve(m->context, m->slots + TETRA_FOUND, CL_MEM_READ_WRITE, m->pixels * sizeof(uint32_t));
}

/* sums: four zeros per tile, to which the kernel adds. */
static stratus_status march(device_march* m, size_t entries, uint32_t* sums)
{
  static const stratus_tetra_slot order[] = { TETRA_ARGUMENTS, TETRA_CELLS, TETRA_CELL_VALUES, TETRA_SUMS, TETRA_COLORS, TETRA_POINTS,
    TETRA_LINES, TETRA_ENDS, TETRA_FACES, TETRA_BIN_BEGIN, TETRA_BINS, TETRA_FIRST, TETRA_ENTRIES, TETRA_FOUND, TETRA_RGBA, TETRA_RGBA8,
    TETRA_DEPTH, TETRA_SAMPLES, TETRA_COUNTS, TETRA_GRADIENTS, TETRA_FACTORS, TETRA_COMPONENT_PLACES, TETRA_COMPONENT_SUMS,
    TETRA_SLOTS }; /* the last five only of a lit frame; TETRA_SLOTS: its maps of light */
  const stratus_image* image = &m->frame->image;
  const size_t sums_bytes = m->tiles * 4 * sizeof *sums;
  TRY(reserve_entries(m, entries));
  TRY(stratus_tetra_device_lend_picture(m->context, m->device, image));
  TRY(stratus_slot_send(m->context, m->slots + TETRA_COUNTS, CL_MEM_READ_WRITE, sums, sums_bytes));
  TRY(launch(m, "tetra_march", m->frame->lit, order, COUNT_OF(order) - (m->frame->lit ? 0 : 5)));
  TRY(stratus_tetra_device_receive_picture(m->context, m->device, image));
  return stratus_slot_receive(m->context, m->slots + TETRA_COUNTS, sums, sums_bytes);
}

static stratus_status draw(device_march* m, const stratus_tetra_device_source* source, stratus_tetra_buffers* buffers,
  stratus_tetra_counts* counts, double* entries_ms, double* march_ms)
{
  const double start = stratus_now_ms();
  size_t entries = 0;
  void* memory = NULL;
  TRY(send(m, source));
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
  stratus_device_drain(m->context);
  if (status != STRATUS_OK || m->slots[TETRA_COUNTS].lent) {
    stratus_slot_drop(&m->slots[TETRA_COUNTS]);
  }
  stratus_release(m->context, memory);
  *entries_ms += marching - start;
  *march_ms = stratus_now_ms() - marching;
  return status;
}

/* *why_not: as in stratus_tetra_device_begin(). */
static stratus_status begin(stratus_context* context, stratus_tetra_device** device, const stratus_tetra_device_source* source,
  stratus_tetra_frame* frame, device_march* m, const char** why_not)
{
  const size_t tiles = (size_t)frame->columns * (size_t)frame->rows;
  TRY(stratus_tetra_device_begin(context, device, source, source->cell_ints * sizeof(int32_t), why_not));
  if (!*why_not) {
    *m = (device_march){ context, *device, (*device)->slots, frame, stratus_tetra_device_packets(context), tiles, tiles * PIXELS };
  }
  return STRATUS_OK;
}

stratus_status stratus_tetra_march_device(stratus_context* context, stratus_tetra_device** device,
  const stratus_tetra_device_source* source, stratus_tetra_frame* frame, stratus_tetra_buffers* buffers, stratus_tetra_counts* counts,
  double* entries_ms, double* march_ms, bool* drawn)
{
  const char* why_not;
  device_march m;
  *drawn = false;
  TRY(begin(context, device, source, frame, &m, &why_not));
  if (why_not) {
    return STRATUS_OK;
  }
  const stratus_status status = draw(&m, source, buffers, counts, entries_ms, march_ms);
  stratus_tetra_device_return(context, *device);
  TRY(status);
  *drawn = true;
  return stratus_progress(context, "march", 1.0);
}

stratus_status stratus_tetra_device_enter(stratus_context* context, stratus_tetra_device** device,
  const stratus_tetra_device_source* source, stratus_tetra_frame* frame, stratus_tetra_buffers* buffers, const char** why_not)
{
  static const stratus_tetra_slot order[] = { TETRA_ARGUMENTS, TETRA_POINTS, TETRA_LINES, TETRA_FACES, TETRA_BIN_BEGIN, TETRA_BINS,
    TETRA_FIRST, TETRA_ENTRIES, TETRA_FOUND };
  size_t entries = 0;
  device_march m;
  TRY(begin(context, device, source, frame, &m, why_not));
  if (*why_not) {
    return STRATUS_OK;
  }
  TRY(send(&m, source));
  if (m.device->running != source->table) {
    m.device->running = 0; /* until they are there */
    const size_t bytes = stratus_table_words(frame->table) * sizeof(int32_t);
    TRY(stratus_slot_keep(context, m.slots + TETRA_RUNNING_SUMS, frame->table->sums, bytes));
    m.device->running = source->table;
  }
  TRY(count_entries(&m, buffers, &entries));
  TRY(reserve_entries(&m, entries));
  return launch(&m, "tetra_find", false, order, COUNT_OF(order));
}
