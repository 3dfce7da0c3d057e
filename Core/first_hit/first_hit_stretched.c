/* SPDX-License-Identifier: BSD-3-Clause
 * First hits among voxels of any widths, on the host and on the context's device. */
#include "first_hit_stretched_rays.h"

#include "device_frame.h"
#include "matrix.h"

#define STRATUS_WIDTH 1
#include "first_hit_stretched.h"

#include <stdio.h>
#include <string.h>

#define BATCH 65536 /* rays a launch */
#define GROUP 64

_Static_assert(_Alignof(stratus_stretched_arguments) == sizeof(float), "arguments must be scalars of four bytes");

typedef struct batch {
  const stratus_tree* tree;
  double to_voxels[16];
  stratus_stretched_arguments arguments;
  double* borders; /* of all axes */
  size_t border_count;
} batch;

/* Lays the borders of all axes out in one array. */
static stratus_status begin(stratus_context* context, const stratus_tree* tree, const stratus_voxel_borders* borders, batch* b)
{
  const stratus_tree_field* field = &tree->fields[0];
  stratus_stretched_arguments* a = &b->arguments;
  void* memory;
  *b = (batch){ .tree = tree };
  memcpy(b->to_voxels, tree->world_to_index, sizeof b->to_voxels);
  for (int axis = 0; axis < 3; ++axis) {
    b->to_voxels[4 * axis + 3] += 0.5;
    a->at[axis] = field->at[axis];
    a->cells[axis] = field->cells[axis];
    a->border_at[axis] = borders->at[axis] ? (int)b->border_count + 1 : -1;
    b->border_count += borders->at[axis] ? (size_t)STRATUS_BORDERS_BEYOND(tree->dimensions[axis]) + 2 : 0;
  }
  a->octants = tree->octants;
  a->entry_bytes = tree->entry_bytes;
  TRY(stratus_allocate(context, b->border_count + 1, sizeof(double), &memory));
  b->borders = memory;
  for (int axis = 0; axis < 3; ++axis) {
    if (borders->at[axis]) {
      const size_t count = (size_t)STRATUS_BORDERS_BEYOND(tree->dimensions[axis]) + 2;
      memcpy(b->borders + a->border_at[axis] - 1, borders->at[axis] - 1, count * sizeof(double));
    }
  }
  return STRATUS_OK;
}

static void in_voxels(const batch* b, const stratus_ray* ray, double out[8])
{
  stratus_matrix_point(b->to_voxels, ray->origin, out);
  stratus_matrix_vector(b->to_voxels, ray->direction, out + 3);
  out[6] = ray->t_min;
  out[7] = ray->t_max;
}

static void set_hit(const int voxel[3], bool found, int visited, stratus_hit* hit)
{
  *hit = (stratus_hit){ .t = INFINITY, .voxel = { -1, -1, -1 }, .face = -1, .visited = (uint32_t)visited };
  for (int axis = 0; found && axis < 3; ++axis) {
    hit->voxel[axis] = voxel[axis];
  }
}

static void run_host(const stratus_context* context, const batch* b, const stratus_ray* rays, size_t count, stratus_hit* hits)
{
#pragma omp parallel for schedule(dynamic, 256) num_threads(context->threads)
  for (size_t r = 0; r < count; ++r) {
    double in[8];
    int voxel[3], visited;
    in_voxels(b, rays + r, in);
    const hit_stretched w = { .a = &b->arguments,
      .entries = b->tree->entries,
      .rows = b->tree->rows,
      .masks = b->tree->masks,
      .borders = b->borders,
      .o = { in[0], in[1], in[2] },
      .d = { in[3], in[4], in[5] },
      .t_min = in[6],
      .t_max = in[7] };
    const bool found = stretched_walk(&w, voxel, &visited);
    set_hit(voxel, found, visited, hits + r);
  }
}

/* ---- device */

enum { ARGUMENTS, ENTRIES, ROWS, MASKS, BORDERS, RAYS, RESULTS, BUFFERS };

typedef struct launch {
  cl_kernel kernel;
  stratus_device_slot slots[BUFFERS];
  double* rays;
  int32_t* results;
} launch;

static stratus_status prepare(stratus_context* context, const batch* b, size_t most, launch* l)
{
  const stratus_tree* tree = b->tree;
  char defines[96];
  void* memory;
  snprintf(defines, sizeof defines, "-DSTRATUS_DEVICE=1 -DSTRATUS_ARGUMENTS_BYTES=%zu", sizeof(stratus_stretched_arguments));
  TRY(stratus_device_kernel(context, "first_hit_stretched", defines, "first_hit_stretched", &l->kernel));
  TRY(stratus_allocate(context, most, 8 * sizeof(double), &memory));
  l->rays = memory;
  TRY(stratus_allocate(context, most, 4 * sizeof(int32_t), &memory));
  l->results = memory;
  TRY(stratus_slot_keep(context, l->slots + ENTRIES, tree->entries, (size_t)tree->entry_count * (size_t)tree->entry_bytes + 4));
  TRY(stratus_slot_keep(context, l->slots + ROWS, tree->row_count ? tree->rows : NULL, (size_t)tree->row_count * sizeof *tree->rows));
  TRY(stratus_slot_keep(context, l->slots + MASKS, tree->mask_count ? tree->masks : NULL, (size_t)tree->mask_count * sizeof *tree->masks));
  return stratus_slot_keep(context, l->slots + BORDERS, b->borders, (b->border_count + 1) * sizeof(double));
}

static stratus_status walk(stratus_context* context, batch* b, launch* l, const stratus_ray* rays, size_t count, stratus_hit* hits)
{
  const size_t items = count, local = GROUP;
  b->arguments.count = (int)count;
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (size_t r = 0; r < count; ++r) {
    in_voxels(b, rays + r, l->rays + 8 * r);
  }
  TRY(stratus_slot_send(context, l->slots + ARGUMENTS, CL_MEM_READ_ONLY, &b->arguments, sizeof b->arguments));
  TRY(stratus_slot_send(context, l->slots + RAYS, CL_MEM_READ_ONLY, l->rays, count * 8 * sizeof(double)));
  TRY(stratus_slot_lend(context, l->slots + RESULTS, CL_MEM_WRITE_ONLY, l->results, count * 4 * sizeof(int32_t)));
  for (unsigned p = 0; p < BUFFERS; ++p) {
    TRY(stratus_device_argument(context, l->kernel, p, sizeof(cl_mem), &l->slots[p].memory));
  }
  TRY(stratus_device_run(context, l->kernel, 1, &items, &local));
  TRY(stratus_slot_receive(context, l->slots + RESULTS, l->results, count * 4 * sizeof(int32_t)));
  for (size_t r = 0; r < count; ++r) {
    const int32_t* result = l->results + 4 * r;
    set_hit(result, result[0] >= 0, result[3], hits + r);
  }
  return STRATUS_OK;
}

static stratus_status run_device(stratus_context* context, batch* b, const stratus_ray* rays, size_t count, stratus_hit* hits)
{
  const size_t most = count < BATCH ? count : BATCH;
  launch l = { .kernel = NULL };
  stratus_status status = prepare(context, b, most, &l);
  for (size_t first = 0; status == STRATUS_OK && first < count; first += most) {
    status = walk(context, b, &l, rays + first, count - first < most ? count - first : most, hits + first);
  }
  stratus_device_drain(context);
  for (int s = 0; s < BUFFERS; ++s) {
    stratus_slot_drop(l.slots + s);
  }
  stratus_release(context, l.rays);
  stratus_release(context, l.results);
  return status;
}

stratus_status stratus_tree_first_voxels_between(stratus_context* context, const stratus_tree* tree, const stratus_voxel_borders* borders,
  const stratus_ray* rays, size_t count, stratus_hit* hits)
{
  static const int none[3] = { -1, -1, -1 };
  batch b;
  if (tree->field_count == 0) { /* no voxel at all */
    for (size_t r = 0; r < count; ++r) {
      set_hit(none, false, 0, hits + r);
    }
    return STRATUS_OK;
  }
  TRY(begin(context, tree, borders, &b));
  stratus_status status = STRATUS_OK;
  for (size_t r = 0; status == STRATUS_OK && r < count; ++r) {
    status = stratus_ray_usable(b.to_voxels, rays + r) ? STRATUS_OK : stratus_ray_refuse(context, b.to_voxels, rays + r, r);
  }
  bool on_host = true;
  if (status == STRATUS_OK && context->device && stratus_device_has_double(context->device)) {
    status = run_device(context, &b, rays, count, hits);
    on_host = stratus_device_hands_back(context, status);
    status = on_host ? STRATUS_OK : status;
  } else if (status == STRATUS_OK && context->device) {
    stratus_log(context, STRATUS_LOG_INFO, "first hits: the host walks the rays, because the device has no doubles");
  }
  if (status == STRATUS_OK && on_host) {
    run_host(context, &b, rays, count, hits);
  }
  stratus_release(context, b.borders);
  return status;
}
