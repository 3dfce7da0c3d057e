/* SPDX-License-Identifier: BSD-3-Clause
 * Common parts of both methods on the OpenCL device: buffers that are kept from frame to frame, copying the frame to the device, and
 * copying the image back. */
#include "tetra_device.h"

#include "tetra_caster.h"

#include <stdio.h>

/* The kernels get the arguments' size by a define and assert it, too. */
_Static_assert(_Alignof(stratus_tetra_arguments) == sizeof(float), "arguments must be scalars of four bytes");

void stratus_tetra_device_drop_table(stratus_tetra_device* device)
{
  if (device) {
    stratus_slot_drop(&device->slots[TETRA_SUMS]);
    stratus_slot_drop(&device->slots[TETRA_COLORS]);
    stratus_slot_drop(&device->slots[TETRA_FACTORS]);
    stratus_slot_drop(&device->slots[TETRA_RUNNING_SUMS]);
    device->table = device->running = 0;
  }
}

void stratus_tetra_device_drop_values(stratus_tetra_device* device)
{
  if (device) {
    stratus_slot_drop(&device->slots[TETRA_CELL_VALUES]);
    stratus_slot_drop(&device->slots[TETRA_MESH_VALUES]);
    device->march_values = device->project_values = 0;
  }
}

void stratus_tetra_device_drop_gradients(stratus_tetra_device* device)
{
  if (device) {
    stratus_slot_drop(&device->slots[TETRA_GRADIENTS]);
    device->gradients = 0;
  }
}

void stratus_tetra_device_drop_components(stratus_tetra_device* device)
{
  if (device) {
    stratus_slot_drop(&device->slots[TETRA_COMPONENT_PLACES]);
    stratus_slot_drop(&device->slots[TETRA_COMPONENT_SUMS]);
    device->components = 0;
  }
}

void stratus_tetra_device_destroy(stratus_context* context, stratus_tetra_device* device)
{
  if (device) {
    for (int slot = 0; slot < TETRA_SLOTS; ++slot) {
      stratus_slot_drop(&device->slots[slot]);
    }
    stratus_release(context, device);
  }
}

/* Returns the reason why the device cannot draw this mesh, or NULL. */
static const char* obstacle(const stratus_context* context, const stratus_tetra_device_source* source, size_t cell_bytes)
{
  const size_t largest = stratus_device_largest_allocation(context->device);
  if (cell_bytes > largest) {
    return "the mesh's cells are larger than the device's largest allocation";
  }
  if ((size_t)source->point_count > largest / (4 * sizeof(float))) {
    return "the mesh's points are larger than the device's largest allocation";
  }
  return NULL;
}

bool stratus_tetra_device_packets(const stratus_context* context)
{
  return stratus_device_is_cpu(context->device) && stratus_device_has_double(context->device);
}

void stratus_tetra_device_return(const stratus_context* context, stratus_tetra_device* device)
{
  if (device) {
    stratus_slots_return(context, device->slots, TETRA_SLOTS);
  }
}

stratus_status stratus_tetra_device_begin(stratus_context* context, stratus_tetra_device** device,
  const stratus_tetra_device_source* source, size_t cell_bytes, const char** why_not)
{
  *why_not = obstacle(context, source, cell_bytes);
  if (*why_not) {
    stratus_log(context, STRATUS_LOG_WARNING, "drawing tetrahedra on the host: %s", *why_not);
    return STRATUS_OK;
  }
  if (!*device) {
    void* memory = NULL;
    TRY(stratus_allocate_zero(context, 1, sizeof **device, &memory));
    *device = memory;
  }
  return STRATUS_OK;
}

stratus_status stratus_tetra_device_send(stratus_context* context, stratus_tetra_device* device, const stratus_tetra_device_source* source,
  const stratus_tetra_frame* frame, const float* points)
{
  stratus_device_slot* slots = device->slots;
  const stratus_image* image = &frame->image;
  const size_t entries = (size_t)frame->table->size, pixels = (size_t)image->width * (size_t)image->height;
  const size_t lines = 2 * ((size_t)image->width + (size_t)image->height + 2 * TETRA_PADDING);
  if (device->table != source->table) {
    TRY(stratus_slot_keep(context, slots + TETRA_SUMS, frame->march_sums, STRATUS_TETRA_SUMS * entries * sizeof(int32_t)));
    TRY(stratus_slot_keep(context, slots + TETRA_COLORS, frame->table->rgba, 4 * entries * sizeof(float)));
    device->table = source->table;
  }
  TRY(stratus_slot_send(context, slots + TETRA_ARGUMENTS, CL_MEM_READ_ONLY, &frame->arguments, sizeof frame->arguments));
  TRY(stratus_slot_send(context, slots + TETRA_POINTS, CL_MEM_READ_ONLY, points, (size_t)source->point_count * 4 * sizeof(float)));
  TRY(stratus_slot_send(context, slots + TETRA_LINES, CL_MEM_READ_ONLY, frame->us, lines * sizeof(float)));
  return stratus_slot_send(context, slots + TETRA_ENDS, CL_MEM_READ_ONLY, frame->ends, pixels * sizeof(float));
}

stratus_status stratus_tetra_device_lend_picture(stratus_context* context, stratus_tetra_device* device, const stratus_image* image)
{
  stratus_device_slot* slots = device->slots;
  const size_t pixels = (size_t)image->width * (size_t)image->height;
  TRY(stratus_slot_lend(context, slots + TETRA_RGBA, CL_MEM_WRITE_ONLY, image->rgba, pixels * 4 * sizeof(float)));
  TRY(stratus_slot_lend(context, slots + TETRA_RGBA8, CL_MEM_WRITE_ONLY, image->rgba8, pixels * 4));
  TRY(stratus_slot_lend(context, slots + TETRA_DEPTH, CL_MEM_WRITE_ONLY, image->depth, pixels * sizeof(float)));
  return stratus_slot_lend(context, slots + TETRA_SAMPLES, CL_MEM_WRITE_ONLY, image->samples, pixels * sizeof(uint32_t));
}

stratus_status stratus_tetra_device_receive_picture(stratus_context* context, stratus_tetra_device* device, const stratus_image* image)
{
  stratus_device_slot* slots = device->slots;
  const size_t pixels = (size_t)image->width * (size_t)image->height;
  TRY(stratus_slot_receive(context, slots + TETRA_RGBA, image->rgba, pixels * 4 * sizeof(float)));
  TRY(stratus_slot_receive(context, slots + TETRA_RGBA8, image->rgba8, pixels * 4));
  TRY(stratus_slot_receive(context, slots + TETRA_DEPTH, image->depth, pixels * sizeof(float)));
  return stratus_slot_receive(context, slots + TETRA_SAMPLES, image->samples, pixels * sizeof(uint32_t));
}

stratus_status stratus_tetra_device_launch(stratus_context* context, stratus_tetra_device* device, const char* source, const char* name,
  bool packets, bool lit, const stratus_tetra_slot* order, unsigned parameters, const size_t global[2], const size_t local[2])
{
  char defines[144];
  cl_kernel kernel;
  (void)snprintf(defines, sizeof defines, "-DSTRATUS_DEVICE=1 -DSTRATUS_WIDTH=%d -DSTRATUS_ARGUMENTS_BYTES=%zu%s%s", packets ? 16 : 1,
    sizeof(stratus_tetra_arguments), lit ? " -DTETRA_LIT=1" : "",
    stratus_device_has_double(context->device) ? "" : " -DSTRATUS_REAL_PAIR=1");
  TRY(stratus_device_kernel(context, source, defines, name, &kernel));
  for (unsigned i = 0; i < parameters; ++i) {
    const cl_mem* memory = order[i] < TETRA_SLOTS ? &device->slots[order[i]].memory
      : device->lights                            ? &device->lights
                                                  : &device->slots[TETRA_ARGUMENTS].memory; /* some buffer, which is not read */
    TRY(stratus_device_argument(context, kernel, i, sizeof(cl_mem), memory));
  }
  return stratus_device_run(context, kernel, 2, global, local);
}
