/* SPDX-License-Identifier: BSD-3-Clause
 * The ray cast through several volumes on a device, of SEVERAL_MOST volumes whose values have one STRATUS_TYPE; -1 serves any. Where
 * STRATUS_WIDTH is 1 (a GPU) a work item does one ray; else (a CPU) it does a tile in packets, as the host does. */
#ifndef STRATUS_DEVICE
#define STRATUS_DEVICE 1
#endif
#ifndef STRATUS_WIDTH
#define STRATUS_WIDTH 1
#endif
#ifndef STRATUS_TYPE
#define STRATUS_TYPE -1
#endif
#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_SHADING
#define RAY_NAME(x) kernel_##x
/* 1: some volume has rays that go from cell to cell. */
#ifndef SEVERAL_CELLS
#define SEVERAL_CELLS 0
#endif
#define RAY_WITH_CELLS SEVERAL_CELLS
/* 1: some volume is of several media. */
#ifndef SEVERAL_MEDIA
#define SEVERAL_MEDIA 0
#endif
#define RAY_WITH_FUNCTIONS_2D SEVERAL_MEDIA
/* 1: there is a mesh. */
#ifndef SEVERAL_MESHES
#define SEVERAL_MESHES 0
#endif
/* Pixels along each side of a work item's tile of packets. */
#ifndef RAY_TILE
#define RAY_TILE 16
#endif

#ifdef __clang__
#pragma clang diagnostic ignored "-Wunused-function" /* a volume never marches without the others */
#endif

#include "ray_packet.h"

#include "ray_several_arguments.h"

#include "ray_cast.h"
#if SEVERAL_MEDIA
#include "several_media.h"
#endif
#include "ray_several.h"
#include "ray_store.h"

#ifdef STRATUS_ARGUMENTS_BYTES
/* Arrays of negative size, which do not compile, where the host lays the arguments out otherwise. */
typedef char stratus_arguments_agree[sizeof(stratus_ray_cast_arguments) == STRATUS_ARGUMENTS_BYTES ? 1 : -1];
#endif

/* The kernel's arguments of a volume; arguments of unused numbers are not read. */
#define VOLUME_ARGUMENTS(n)                                                                                                                \
  __global const void *values##n, __global const uchar *hidden##n, __global const uchar *map##n, __global const uchar *rough##n,           \
    __global const int *grid##n, __global const void *table##n, __global const void *besides##n

#define VOLUME_SOURCE(n)                                                                                                                   \
  if (n < count) {                                                                                                                         \
    from[n].a = a + n;                                                                                                                     \
    from[n].values = values##n;                                                                                                            \
    from[n].hidden = hidden##n;                                                                                                            \
    from[n].map = map##n;                                                                                                                  \
    from[n].rough = rough##n;                                                                                                              \
    from[n].grid = grid##n;                                                                                                                \
    from[n].lights = lights;                                                                                                               \
    from[n].table = table##n;                                                                                                              \
    from[n].besides = besides##n;                                                                                                          \
    from[n].stride = parts[n].stride;                                                                                                      \
    from[n].lit = parts[n].lit;                                                                                                            \
    from[n].cells = parts[n].cells;                                                                                                        \
    from[n].media = parts[n].media;                                                                                                        \
    from[n].segment = parts[n].segment;                                                                                                    \
    from[n].preintegrated = parts[n].preintegrated;                                                                                        \
  }

#if SEVERAL_MESHES
/* The kernel's arguments of a mesh in addition to a volume's, of which it has the points and their values in `values`, the sums of
 * stratus_tetra_sums() in `hidden`, gradients in `map`, gradient opacities in `rough`, the cells in `grid` and the values of cells in
 * `besides`. In `table` it has the running sums, or the places of several components. */
#define MESH_ARGUMENTS(n)                                                                                                                  \
  __global const float *lines##n, __global const float *ends##n, __global const int *faces##n, __global const uint *first##n,              \
    __global int *entries##n

#define MESH_SOURCE(n)                                                                                                                     \
  if (n < count) {                                                                                                                         \
    from[n].mesh = parts[n].mesh ? meshes + n : 0;                                                                                         \
    meshes[n].a = mesh_arguments + n;                                                                                                      \
    meshes[n].places = &parts[n].places;                                                                                                   \
    meshes[n].view.scene.cells = grid##n;                                                                                                  \
    meshes[n].view.scene.lights = lights;                                                                                                  \
    meshes[n].view.scene.points = (__global const float*)values##n;                                                                        \
    meshes[n].view.scene.sums = meshes[n].view.scene.media = (__global const int*)hidden##n;                                               \
    meshes[n].view.scene.components = (__global const float*)table##n;                                                                     \
    meshes[n].view.scene.gradients = (__global const float*)map##n;                                                                        \
    meshes[n].view.scene.factors = (__global const float*)rough##n;                                                                        \
    meshes[n].view.scene.cell_values = (__global const float*)besides##n;                                                                  \
    meshes[n].view.lines = lines##n;                                                                                                       \
    meshes[n].view.ends = ends##n;                                                                                                         \
    meshes[n].view.faces = faces##n;                                                                                                       \
    meshes[n].view.first = first##n;                                                                                                       \
    meshes[n].view.entries = entries##n;                                                                                                   \
  }
#define MESHES_ARGUMENTS                                                                                                                   \
  , __constant stratus_tetra_arguments *mesh_arguments, MESH_ARGUMENTS(0), MESH_ARGUMENTS(1), MESH_ARGUMENTS(2), MESH_ARGUMENTS(3),        \
    MESH_ARGUMENTS(4), MESH_ARGUMENTS(5), MESH_ARGUMENTS(6), MESH_ARGUMENTS(7)
#else
#define MESHES_ARGUMENTS
#define MESH_SOURCE(n)
#endif
#define SOURCE(n) VOLUME_SOURCE(n) MESH_SOURCE(n)

/* a, parts: one for each volume; the first volume's say which outputs are written. counts: rays, samples, skipped, lookups of each row of
 * pixels, or of each tile. */
PACKET_KERNEL void ray_several(__constant stratus_ray_cast_arguments* a, __constant stratus_several_arguments* parts, int count,
  VOLUME_ARGUMENTS(0), VOLUME_ARGUMENTS(1), VOLUME_ARGUMENTS(2), VOLUME_ARGUMENTS(3), VOLUME_ARGUMENTS(4), VOLUME_ARGUMENTS(5),
  VOLUME_ARGUMENTS(6), VOLUME_ARGUMENTS(7), __global const int* lights, __global const float* opaque_depth, __global float* rgba,
  __global uchar* rgba8, __global float* depth, __global uint* samples, __global uint* counts MESHES_ARGUMENTS)
{
  const stratus_pixels to = { rgba, rgba8, depth, samples };
  several_source from[SEVERAL_PARTS];
  several_volume volumes[SEVERAL_PARTS];
#if SEVERAL_MESHES
  several_mesh meshes[SEVERAL_MOST];
#endif
  count = min(count, SEVERAL_MOST);
  SOURCE(0)
#if SEVERAL_MOST > 1
  SOURCE(1)
#endif
#if SEVERAL_MOST > 2
  SOURCE(2)
#endif
#if SEVERAL_MOST > 3
  SOURCE(3)
#endif
#if SEVERAL_MOST > 4
  SOURCE(4)
#endif
#if SEVERAL_MOST > 5
  SOURCE(5)
#endif
#if SEVERAL_MOST > 6
  SOURCE(6)
#endif
#if SEVERAL_MOST > 7
  SOURCE(7)
#endif
  count = several_add_pieces(from, count);
#if STRATUS_WIDTH == 1
  const int x = (int)get_global_id(0), y = (int)get_global_id(1);
  if (x >= a->picture.width || y >= a->picture.height) {
    return;
  }
  stratus_packet k;
  several_load(from, count, opaque_depth, x, y, volumes, &k);
  several_march(from, volumes, count, &k);
  store_pixel(a, &to, x, y, (float4)(k.red, k.green, k.blue, 1.0f - k.transparency), k.depth, (uint)k.samples);
  if (k.hits) {
    __global uint* sums = counts + 4 * y;
    atomic_inc(sums);
    atomic_add(sums + 1, (uint)k.samples);
    atomic_add(sums + 2, (uint)k.skipped);
    atomic_add(sums + 3, (uint)k.lookups);
  }
#else
  const int x0 = (int)get_global_id(0) * RAY_TILE, y0 = (int)get_global_id(1) * RAY_TILE;
  const int x1 = min(x0 + RAY_TILE, a->picture.width), y1 = min(y0 + RAY_TILE, a->picture.height);
  vint taken = vi_set(0), skipped = vi_set(0), lookups = vi_set(0);
  uint rays = 0;
  for (int y = y0; y < y1; y += PACKET_Y) {
    for (int x = x0; x < x1; x += PACKET_X) {
      stratus_packet k;
      several_load(from, count, opaque_depth, x, y, volumes, &k);
      several_march(from, volumes, count, &k);
      store_packet(a, &to, &k, x, y);
      rays += (uint)m_count(k.hits);
      taken = taken + k.samples;
      skipped = skipped + k.skipped;
      lookups = lookups + k.lookups;
    }
  }
  const size_t tile = get_global_id(1) * get_global_size(0) + get_global_id(0);
  vstore4((uint4)(rays, sum_lanes(taken), sum_lanes(skipped), sum_lanes(lookups)), tile, counts);
#endif
}
