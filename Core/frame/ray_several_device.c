/* SPDX-License-Identifier: BSD-3-Clause
 * Rays through several volumes on the OpenCL device. Each volume's caster keeps its data there; the first one keeps the picture's. */
#include "ray_device_buffers.h"
#include "ray_several_picture.h"
#include "tetra_caster.h"

#include <stdio.h>
#include <string.h>

#define OWN_ARRAYS 7  /* of each volume, in the order of the kernel's parameters */
#define MESH_ARRAYS 5 /* of each mesh besides */

typedef struct several_device {
  stratus_context* context;
  const stratus_several_frame* frame;
  stratus_device_slot* slots; /* of the picture: the first volume's, or `own` where all are meshes */
  stratus_device_slot own[BUFFERS];
  bool packets, meshes; /* meshes: there is one */
  cl_kernel kernel;
  unsigned next; /* the number of the kernel's next argument */
} several_device;

/* The type for which the kernel is compiled: the volumes' type if all have the same, otherwise any. */
static int common_type(const stratus_several_frame* frame)
{
  int type = STRATUS_FLOAT32, volumes = 0;
  for (int n = 0; n < frame->count; ++n) {
    const stratus_several_part* part = &frame->volumes[n];
    if (part->caster) {
      type = volumes == 0 || part->type == type ? part->type : -1;
      ++volumes;
    }
  }
  return type;
}

static stratus_status find_kernel(several_device* d)
{
  char defines[320];
  int has = 0, cells = 0, media = 0;
  bool lit = false; /* a mesh */
  for (int n = 0; n < d->frame->count; ++n) {
    const stratus_several_part* part = &d->frame->volumes[n];
    has |= stratus_ray_rarities(part->frame.arguments);
    cells |= part->arguments.cells != SEVERAL_BY_SAMPLES;
    media |= part->arguments.media != 0;
    lit = lit || (part->mesh && part->mesh->lit);
  }
  snprintf(defines, sizeof defines,
    "-DSTRATUS_DEVICE=1 -DSTRATUS_TYPE=%d -DSTRATUS_WIDTH=%d -DRAY_TILE=%d -DSEVERAL_MOST=%d -DSEVERAL_PARTS=%d -DSEVERAL_CELLS=%d "
    "-DSEVERAL_MEDIA=%d "
    "-DSTRATUS_ARGUMENTS_BYTES=%zu -DRAY_HAS=%d%s%s%s",
    common_type(d->frame), d->packets ? 16 : 1, STRATUS_RAY_DEVICE_TILE, d->frame->count, stratus_several_part_count(d->frame), cells,
    media, sizeof(stratus_ray_cast_arguments), has, stratus_device_has_double(d->context->device) ? "" : " -DSTRATUS_REAL_PAIR=1",
    d->meshes ? " -DSEVERAL_MESHES=1" : "", lit ? " -DTETRA_LIT=1" : "");
  return stratus_device_kernel(d->context, "ray_several", defines, "ray_several", &d->kernel);
}

/* Passes the kernel a buffer. Unused parameters get the arguments, because an argument must be some buffer. slot: NULL, or without memory:
 * the parameter is not used. */
static stratus_status pass(several_device* d, const stratus_device_slot* slot)
{
  const stratus_device_slot* some = slot && slot->memory ? slot : d->slots + ARGUMENTS;
  return stratus_device_argument(d->context, d->kernel, d->next++, sizeof(cl_mem), &some->memory);
}

static stratus_status pass_volumes(several_device* d)
{
  static const stratus_tetra_slot of_mesh[2][OWN_ARRAYS] = { { TETRA_POINTS, TETRA_SUMS, TETRA_GRADIENTS, TETRA_FACTORS, TETRA_CELLS,
                                                               TETRA_RUNNING_SUMS, TETRA_CELL_VALUES },
    { TETRA_POINTS, TETRA_COMPONENT_SUMS, TETRA_GRADIENTS, TETRA_FACTORS, TETRA_CELLS, TETRA_COMPONENT_PLACES, TETRA_CELL_VALUES } };
  for (int n = 0; n < STRATUS_SEVERAL_MAX; ++n) {
    const stratus_several_part* part = n < d->frame->count ? &d->frame->volumes[n] : NULL;
    const buffer_name names[OWN_ARRAYS] = { VALUES, HIDDEN, MAP, ROUGH, GRID, part && part->layers ? LAYERS : TABLE, TABLE };
    for (int i = 0; i < OWN_ARRAYS; ++i) {
      TRY(pass(d,
        !part          ? NULL
          : part->mesh ? part->tetra->device->slots + of_mesh[part->mesh->components != NULL][i]
                       : part->caster->device->slots + names[i]));
    }
  }
  return STRATUS_OK;
}

static stratus_status pass_meshes(several_device* d)
{
  static const stratus_tetra_slot names[MESH_ARRAYS] = { TETRA_LINES, TETRA_ENDS, TETRA_FACES, TETRA_FIRST, TETRA_ENTRIES };
  TRY(pass(d, d->slots + MESHES));
  for (int n = 0; n < STRATUS_SEVERAL_MAX; ++n) {
    const bool mesh = n < d->frame->count && d->frame->volumes[n].mesh;
    for (int i = 0; i < MESH_ARRAYS; ++i) {
      TRY(pass(d, mesh ? d->frame->volumes[n].tetra->device->slots + names[i] : NULL));
    }
  }
  return STRATUS_OK;
}

/* Sends the arguments of all volumes. */
static stratus_status send_arguments(several_device* d, const stratus_ray_cast_arguments* arguments, const stratus_several_arguments* parts,
  const stratus_tetra_arguments* meshes)
{
  const size_t count = (size_t)d->frame->count;
  TRY(stratus_slot_send(d->context, d->slots + ARGUMENTS, CL_MEM_READ_ONLY, arguments, count * sizeof *arguments));
  TRY(stratus_slot_send(d->context, d->slots + PARTS, CL_MEM_READ_ONLY, parts, count * sizeof *parts));
  return d->meshes ? stratus_slot_send(d->context, d->slots + MESHES, CL_MEM_READ_ONLY, meshes, count * sizeof *meshes) : STRATUS_OK;
}

/* Passes the kernel the maps of light, which all inputs share. */
static stratus_status pass_lights(several_device* d)
{
  cl_mem memory = d->slots[ARGUMENTS].memory; /* without maps, some buffer */
  bool sent;
  if (d->frame->maps) {
    TRY(stratus_light_maps_on_device(d->frame->maps, &memory, &sent));
  }
  return stratus_device_argument(d->context, d->kernel, d->next++, sizeof(cl_mem), &memory);
}

/* counts: 4 zeros for each part of the picture. */
static stratus_status draw(several_device* d, void* counts, size_t counts_bytes)
{
  static const buffer_name pictures[] = { OPAQUE, RGBA, RGBA8, DEPTH, SAMPLES, COUNTS };
  stratus_context* context = d->context;
  stratus_device_slot* slots = d->slots;
  const stratus_ray_cast_frame* to = &d->frame->picture;
  const size_t width = (size_t)to->arguments->picture.width, height = (size_t)to->arguments->picture.height, pixels = width * height;
  const size_t side = d->packets ? STRATUS_RAY_DEVICE_TILE : 1, group = d->packets ? 1 : STRATUS_RAY_DEVICE_GROUP;
  const size_t global[2] = { (width + side - 1) / side, (height + side - 1) / side }, local[2] = { group, group };
  const cl_int volumes = d->frame->count;
  TRY(stratus_slot_send(context, slots + OPAQUE, CL_MEM_READ_ONLY, to->opaque_depth, pixels * sizeof(float)));
  TRY(stratus_slot_lend(context, slots + RGBA, CL_MEM_WRITE_ONLY, to->rgba, pixels * 4 * sizeof(float)));
  TRY(stratus_slot_lend(context, slots + RGBA8, CL_MEM_WRITE_ONLY, to->rgba8, pixels * 4));
  TRY(stratus_slot_lend(context, slots + DEPTH, CL_MEM_WRITE_ONLY, to->depth, pixels * sizeof(float)));
  TRY(stratus_slot_lend(context, slots + SAMPLES, CL_MEM_WRITE_ONLY, to->samples, pixels * sizeof(uint32_t)));
  TRY(stratus_slot_send(context, slots + COUNTS, CL_MEM_READ_WRITE, counts, counts_bytes));
  TRY(pass(d, slots + ARGUMENTS));
  TRY(pass(d, slots + PARTS));
  TRY(stratus_device_argument(context, d->kernel, d->next++, sizeof volumes, &volumes));
  TRY(pass_volumes(d));
  TRY(pass_lights(d));
  for (size_t i = 0; i < COUNT_OF(pictures); ++i) {
    TRY(pass(d, slots + pictures[i]));
  }
  if (d->meshes) {
    TRY(pass_meshes(d));
  }
  TRY(stratus_device_run(context, d->kernel, 2, global, local));
  TRY(stratus_slot_receive(context, slots + RGBA, to->rgba, pixels * 4 * sizeof(float)));
  TRY(stratus_slot_receive(context, slots + RGBA8, to->rgba8, pixels * 4));
  TRY(stratus_slot_receive(context, slots + DEPTH, to->depth, pixels * sizeof(float)));
  TRY(stratus_slot_receive(context, slots + SAMPLES, to->samples, pixels * sizeof(uint32_t)));
  return stratus_slot_receive(context, slots + COUNTS, counts, counts_bytes);
}

static stratus_status draw_and_count(several_device* d, stratus_ray_counts* counts)
{
  /* aligned so that a device can borrow them */
  _Alignas(64) stratus_ray_cast_arguments arguments[STRATUS_SEVERAL_MAX];
  _Alignas(64) stratus_several_arguments parts[STRATUS_SEVERAL_MAX];
  _Alignas(64) stratus_tetra_arguments meshes[STRATUS_SEVERAL_MAX];
  stratus_context* context = d->context;
  void* memory = NULL;
  memset(meshes, 0, sizeof meshes);
  for (int n = 0; n < d->frame->count; ++n) {
    const stratus_several_part* part = &d->frame->volumes[n];
    arguments[n] = *part->frame.arguments;
    parts[n] = part->arguments;
    if (part->mesh) {
      meshes[n] = part->mesh->arguments;
    }
  }
  const size_t of_picture = stratus_ray_device_parts((size_t)arguments->picture.width, (size_t)arguments->picture.height, d->packets);
  TRY(find_kernel(d));
  TRY(stratus_allocate_zero(context, of_picture, 4 * sizeof(cl_uint), &memory));
  stratus_status status;
  TRY_CLEANUP(stratus_progress(context, "ray cast", 0.0));
  TRY_CLEANUP(send_arguments(d, arguments, parts, meshes));
  TRY_CLEANUP(draw(d, memory, of_picture * 4 * sizeof(cl_uint)));
  stratus_ray_device_count(memory, of_picture, counts);
cleanup:
  stratus_slots_return(context, d->slots, BUFFERS);
  stratus_release(context, memory);
  return status;
}

stratus_status stratus_several_device(stratus_context* context, const stratus_several_frame* frame, stratus_ray_counts* counts)
{
  several_device d = {
    .context = context, .frame = frame, .packets = stratus_device_is_cpu(context->device) && stratus_device_has_double(context->device)
  };
  for (int n = 0; n < frame->count; ++n) {
    const stratus_several_part* part = &frame->volumes[n];
    d.meshes |= part->mesh != NULL;
    d.slots = !d.slots && part->caster ? part->caster->device->slots : d.slots;
  }
  d.slots = d.slots ? d.slots : d.own;
  const stratus_status status = draw_and_count(&d, counts);
  for (int b = 0; b < BUFFERS; ++b) {
    stratus_slot_drop(d.own + b);
  }
  TRY(status);
  return stratus_progress(context, "ray cast", 1.0);
}
