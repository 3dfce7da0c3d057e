/* SPDX-License-Identifier: BSD-3-Clause
 * Rays through several volumes on the OpenCL device. Each volume's caster keeps its data there; the first one keeps the picture's. */
#include "ray_device_buffers.h"
#include "ray_several_host.h"

#include <stdio.h>

#define OWN_ARRAYS 7 /* of each volume, in the order of the kernel's parameters */

/* The type for which the kernel is compiled: the volumes' type if all have the same, otherwise any. */
static int common_type(const stratus_several_frame* frame)
{
  int type = frame->volumes[0].type;
  for (int n = 1; n < frame->count; ++n) {
    type = frame->volumes[n].type == type ? type : -1;
  }
  return type;
}

static stratus_status find_kernel(stratus_context* context, const stratus_several_frame* frame, bool packets, cl_kernel* kernel)
{
  char defines[256];
  int has = 0, cells = 0, media = 0;
  for (int n = 0; n < frame->count; ++n) {
    has |= stratus_ray_rarities(frame->volumes[n].frame.arguments);
    cells |= frame->volumes[n].cells != SEVERAL_BY_SAMPLES;
    media |= frame->volumes[n].media != 0;
  }
  snprintf(defines, sizeof defines,
    "-DSTRATUS_DEVICE=1 -DSTRATUS_TYPE=%d -DSTRATUS_WIDTH=%d -DRAY_TILE=%d -DSEVERAL_MOST=%d -DSEVERAL_CELLS=%d -DSEVERAL_MEDIA=%d "
    "-DSTRATUS_ARGUMENTS_BYTES=%zu -DRAY_HAS=%d%s",
    common_type(frame), packets ? 16 : 1, STRATUS_RAY_DEVICE_TILE, frame->count, cells, media, sizeof(stratus_ray_cast_arguments), has,
    stratus_device_has_double(context->device) ? "" : " -DSTRATUS_REAL_PAIR=1");
  return stratus_device_kernel(context, "ray_several", defines, "ray_several", kernel);
}

/* Pass the kernel the arrays of all volumes. Unused numbers get the first volume's arrays, because an argument must be some buffer. *next:
 * the number of the next argument. */
static stratus_status set_volumes(stratus_context* context, cl_kernel kernel, const stratus_several_frame* frame, unsigned* next)
{
  for (int n = 0; n < STRATUS_SEVERAL_MAX; ++n) {
    const stratus_several_part* part = &frame->volumes[n < frame->count ? n : 0];
    const stratus_device_slot* slots = part->caster->device->slots;
    const buffer_name names[OWN_ARRAYS] = { VALUES, HIDDEN, MAP, ROUGH, GRID, part->layers ? LAYERS : TABLE, TABLE };
    for (int i = 0; i < OWN_ARRAYS; ++i) {
      TRY(stratus_device_argument(context, kernel, (*next)++, sizeof(cl_mem), &slots[names[i]].memory));
    }
  }
  return STRATUS_OK;
}

/* counts: 4 zeros for each part of the picture. arguments, parts: one for each volume. */
static stratus_status draw(stratus_context* context, const stratus_several_frame* frame, cl_kernel kernel, bool packets,
  const stratus_ray_cast_arguments* arguments, const stratus_several_arguments* parts, void* counts, size_t counts_bytes)
{
  static const buffer_name pictures[] = { OPAQUE, RGBA, RGBA8, DEPTH, SAMPLES, COUNTS };
  stratus_device_slot* slots = frame->volumes[0].caster->device->slots;
  const stratus_ray_cast_frame* to = &frame->picture;
  const size_t width = (size_t)arguments->picture.width, height = (size_t)arguments->picture.height, pixels = width * height;
  const size_t count = (size_t)frame->count, side = packets ? STRATUS_RAY_DEVICE_TILE : 1, group = packets ? 1 : STRATUS_RAY_DEVICE_GROUP;
  const size_t global[2] = { (width + side - 1) / side, (height + side - 1) / side }, local[2] = { group, group };
  const cl_int volumes = frame->count;
  unsigned next = 0;
  TRY(stratus_slot_send(context, slots + ARGUMENTS, CL_MEM_READ_ONLY, arguments, count * sizeof *arguments));
  TRY(stratus_slot_send(context, slots + PARTS, CL_MEM_READ_ONLY, parts, count * sizeof *parts));
  TRY(stratus_slot_send(context, slots + OPAQUE, CL_MEM_READ_ONLY, to->opaque_depth, pixels * sizeof(float)));
  TRY(stratus_slot_lend(context, slots + RGBA, CL_MEM_WRITE_ONLY, to->rgba, pixels * 4 * sizeof(float)));
  TRY(stratus_slot_lend(context, slots + RGBA8, CL_MEM_WRITE_ONLY, to->rgba8, pixels * 4));
  TRY(stratus_slot_lend(context, slots + DEPTH, CL_MEM_WRITE_ONLY, to->depth, pixels * sizeof(float)));
  TRY(stratus_slot_lend(context, slots + SAMPLES, CL_MEM_WRITE_ONLY, to->samples, pixels * sizeof(uint32_t)));
  TRY(stratus_slot_send(context, slots + COUNTS, CL_MEM_READ_WRITE, counts, counts_bytes));
  TRY(stratus_device_argument(context, kernel, next++, sizeof(cl_mem), &slots[ARGUMENTS].memory));
  TRY(stratus_device_argument(context, kernel, next++, sizeof(cl_mem), &slots[PARTS].memory));
  TRY(stratus_device_argument(context, kernel, next++, sizeof volumes, &volumes));
  TRY(set_volumes(context, kernel, frame, &next));
  for (size_t i = 0; i < COUNT_OF(pictures); ++i) {
    TRY(stratus_device_argument(context, kernel, next++, sizeof(cl_mem), &slots[pictures[i]].memory));
  }
  TRY(stratus_device_run(context, kernel, 2, global, local));
  TRY(stratus_slot_receive(context, slots + RGBA, to->rgba, pixels * 4 * sizeof(float)));
  TRY(stratus_slot_receive(context, slots + RGBA8, to->rgba8, pixels * 4));
  TRY(stratus_slot_receive(context, slots + DEPTH, to->depth, pixels * sizeof(float)));
  TRY(stratus_slot_receive(context, slots + SAMPLES, to->samples, pixels * sizeof(uint32_t)));
  return stratus_slot_receive(context, slots + COUNTS, counts, counts_bytes);
}

stratus_status stratus_several_device(stratus_context* context, const stratus_several_frame* frame, stratus_ray_counts* counts)
{
  /* aligned so that a device can borrow them */
  _Alignas(64) stratus_ray_cast_arguments arguments[STRATUS_SEVERAL_MAX];
  _Alignas(64) stratus_several_arguments parts[STRATUS_SEVERAL_MAX];
  const bool packets = stratus_device_is_cpu(context->device) && stratus_device_has_double(context->device);
  cl_kernel kernel;
  void* memory = NULL;
  for (int n = 0; n < frame->count; ++n) {
    const stratus_several_part* part = &frame->volumes[n];
    arguments[n] = *part->frame.arguments;
    parts[n] = (stratus_several_arguments){ part->stride, part->lit, part->preintegrated, part->media, part->segment, part->cells };
  }
  const size_t of_picture = stratus_ray_device_parts((size_t)arguments->picture.width, (size_t)arguments->picture.height, packets);
  TRY(find_kernel(context, frame, packets, &kernel));
  TRY(stratus_allocate_zero(context, of_picture, 4 * sizeof(cl_uint), &memory));
  TRY(stratus_progress(context, "ray cast", 0.0));
  const stratus_status status = draw(context, frame, kernel, packets, arguments, parts, memory, of_picture * 4 * sizeof(cl_uint));
  stratus_slots_return(context, frame->volumes[0].caster->device->slots, BUFFERS);
  if (status == STRATUS_OK) {
    stratus_ray_device_count(memory, of_picture, counts);
  }
  stratus_release(context, memory);
  TRY(status);
  return stratus_progress(context, "ray cast", 1.0);
}
