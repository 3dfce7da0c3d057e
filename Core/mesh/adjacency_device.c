/* SPDX-License-Identifier: BSD-3-Clause
 * Neighbours through faces on the context's OpenCL device: all faces are sorted by their points, and faces of the same points are paired.
 * The host has found the orientations, which need exact arithmetic. */
#include "adjacency_device.h"
#include "radix_sort_device.h"

/* Fewer faces are paired in less time than the passes of sorting wait for one another. */
#define FACES_MIN ((size_t)1 << 14)

typedef struct adjacency_device {
  stratus_context* context;
  cl_mem vertices, orientation, neighbours, counters;
  stratus_device_keys keys;
  cl_uint faces;
  cl_int points, bits; /* bits: of point numbers up to `points` */
} adjacency_device;

bool stratus_adjacency_on_device(const stratus_context* context, const stratus_mesh* mesh)
{
  const size_t faces = 4 * (size_t)mesh->cell_count;
  return stratus_device_builds(context) && faces >= FACES_MIN && faces <= UINT32_MAX &&
    faces <= stratus_device_largest_allocation(context->device) / sizeof(uint64_t);
}

static stratus_status make_buffers(adjacency_device* d, const stratus_mesh* mesh, const stratus_adjacency* adjacency)
{
  static const uint32_t zeros[2] = { 0, 0 };
  const size_t cells = (size_t)mesh->cell_count, numbers = 4 * cells * sizeof(int32_t);
  TRY(stratus_device_buffer(d->context, CL_MEM_READ_ONLY, numbers, mesh->vertices, true, &d->vertices));
  TRY(stratus_device_buffer(d->context, CL_MEM_READ_ONLY, cells, adjacency->orientation, true, &d->orientation));
  TRY(stratus_device_buffer(d->context, CL_MEM_WRITE_ONLY, numbers, NULL, false, &d->neighbours));
  TRY(stratus_device_buffer(d->context, CL_MEM_READ_WRITE, sizeof zeros, zeros, false, &d->counters));
  return stratus_device_keys_create(d->context, d->faces, &d->keys);
}

static stratus_status launch(const adjacency_device* d, const char* kernel, const stratus_kernel_argument* arguments, size_t count)
{
  const int64_t items[3] = { d->faces, 1, 1 };
  return stratus_device_launch(d->context, "adjacency", "", kernel, arguments, count, items);
}

static stratus_status sort_faces(adjacency_device* d)
{
  const stratus_kernel_argument third[] = { ARGUMENT(d->vertices), ARGUMENT(d->faces), ARGUMENT(d->points), ARGUMENT(d->keys.keys[0]),
    ARGUMENT(d->keys.values[0]) };
  TRY(launch(d, "third_points", third, COUNT_OF(third)));
  TRY(stratus_device_keys_sort(d->context, &d->keys, d->bits));
  const stratus_kernel_argument first[] = { ARGUMENT(d->vertices), ARGUMENT(d->faces), ARGUMENT(d->points), ARGUMENT(d->bits),
    ARGUMENT(d->keys.values[0]), ARGUMENT(d->keys.keys[0]) };
  TRY(launch(d, "first_points", first, COUNT_OF(first)));
  return stratus_device_keys_sort(d->context, &d->keys, 2 * d->bits);
}

static stratus_status pair_faces(adjacency_device* d, stratus_adjacency* adjacency)
{
  uint32_t counters[2];
  const stratus_kernel_argument arguments[] = { ARGUMENT(d->vertices), ARGUMENT(d->orientation), ARGUMENT(d->faces), ARGUMENT(d->points),
    ARGUMENT(d->keys.keys[0]), ARGUMENT(d->keys.values[0]), ARGUMENT(d->neighbours), ARGUMENT(d->counters) };
  TRY(launch(d, "pair_faces", arguments, COUNT_OF(arguments)));
  TRY(stratus_device_read(d->context, d->counters, 0, sizeof counters, counters));
  TRY(stratus_device_read(d->context, d->neighbours, 0, d->faces * sizeof(int32_t), adjacency->neighbours));
  adjacency->broken_faces = counters[0];
  adjacency->folded_faces = counters[1];
  return STRATUS_OK;
}

stratus_status stratus_adjacency_pair_on_device(stratus_context* context, const stratus_mesh* mesh, stratus_adjacency* adjacency)
{
  stratus_status status = STRATUS_OK;
  adjacency_device d = { .context = context, .faces = (cl_uint)(4 * mesh->cell_count), .points = (cl_int)mesh->point_count };
  while (mesh->point_count >> d.bits > 0) {
    ++d.bits;
  }
  TRY_CLEANUP(make_buffers(&d, mesh, adjacency));
  TRY_CLEANUP(sort_faces(&d));
  TRY_CLEANUP(pair_faces(&d, adjacency));
cleanup:
  stratus_device_keys_release(&d.keys);
  stratus_device_buffer_release(d.vertices);
  stratus_device_buffer_release(d.orientation);
  stratus_device_buffer_release(d.neighbours);
  stratus_device_buffer_release(d.counters);
  return status;
}
