/* SPDX-License-Identifier: BSD-3-Clause
 * Composite rays through several volumes, compiled for one instruction set, STRATUS_ISA. */
#include "ray_cast_packets.h"
#include "ray_reading.h"
#include "ray_several_host.h"

#define STRATUS_TYPE -2
#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_SHADING
#define RAY_WITH_CELLS 1
#define RAY_WITH_FUNCTIONS_2D 1
#define RAY_NAME(x) JOIN(x, several)
#include "ray_cast.h"
#include "several_media.h"
#include "ray_several.h"

_Static_assert(SEVERAL_MOST == STRATUS_SEVERAL_MAX, "as many as the API takes");

/* Set the mesh arrays that several_mesh.h reads, in the host's layout. */
static void set_mesh(const stratus_several_part* part, double step, several_mesh* m)
{
  const stratus_tetra_frame* frame = part->mesh;
  *m = (several_mesh){
    .view = { .scene = { .cells = frame->cells, .points = frame->places, .sums = frame->march_sums, .cell_values = frame->cell_values },
      .lines = frame->us,
      .ends = frame->ends,
      .faces = (const int32_t*)frame->faces,
      .bin_begin = frame->bin_begin,
      .bins = frame->bins,
      .first = frame->first,
      .entries = frame->entries },
    .a = &frame->arguments,
    .middle = frame->middle,
    .per_z = frame->per_z,
    .per_step = 1.0 / step,
    .width = frame->image.width,
    .height = frame->image.height,
    .parallel = frame->camera.parallel,
    .jitter = part->jitter,
    .seed = part->seed
  };
  for (int axis = 0; axis < 3; ++axis) {
    m->forward[axis] = frame->camera.forward[axis];
    m->right[axis] = frame->camera.right[axis];
    m->up[axis] = frame->camera.up[axis];
  }
  m->lean[0] = frame->lean[0];
  m->lean[1] = frame->lean[1];
}

/* Finds where the tile's rays enter a mesh. */
static void find_mesh(const several_mesh* m, int x0, int y0, int x1, int y1)
{
  uint32_t found[TETRA_PIXELS];
  for (int y = y0; y < y1; y += TETRA_TILE) {
    for (int x = x0; x < x1; x += TETRA_TILE) {
      const int tile = y / TETRA_TILE * m->a->columns + x / TETRA_TILE;
      find_entries(&m->view, m->a, tile, 0, TETRA_PIXELS, 0, found);
    }
  }
}

/* The frame is the first member of a stratus_several_frame. */
void STRATUS_ISA_NAME(stratus_several_tile)(
  const stratus_ray_cast_frame* picture, int x0, int y0, int x1, int y1, stratus_ray_counts* counts)
{
  const stratus_several_frame* frame = (const stratus_several_frame*)(const void*)picture;
  tile_counts mine = { vi_set(0), vi_set(0), vi_set(0), 0 };
  several_source from[SEVERAL_MOST];
  several_mesh meshes[SEVERAL_MOST];
  for (int n = 0; n < frame->count; ++n) {
    const stratus_ray_cast_frame* of = &frame->volumes[n].frame;
    from[n] = (several_source){ .a = of->arguments,
      .values = of->values,
      .hidden = of->hidden,
      .grid = of->grid,
      .map = of->map,
      .rough = of->rough,
      .table = frame->volumes[n].layers ? (const void*)frame->volumes[n].layers : of->table,
      .besides = of->table,
      .mesh = frame->volumes[n].mesh ? &meshes[n] : NULL,
      .stride = frame->volumes[n].stride,
      .lit = frame->volumes[n].lit,
      .cells = frame->volumes[n].cells,
      .media = frame->volumes[n].media,
      .segment = frame->volumes[n].segment,
      .preintegrated = frame->volumes[n].preintegrated };
    if (from[n].mesh) {
      set_mesh(&frame->volumes[n], frame->step, &meshes[n]);
      find_mesh(&meshes[n], x0, y0, x1, y1);
    }
  }
  for (int y = y0; y < y1; y += PACKET_Y) {
    for (int x = x0; x < x1; x += PACKET_X) {
      several_volume volumes[SEVERAL_MOST];
      stratus_packet k;
      several_load(from, frame->count, picture->opaque_depth, x, y, volumes, &k);
      several_march(from, volumes, frame->count, &k);
      store_packet(picture, &k, x, y, &mine);
    }
  }
  add_counts(&mine, counts);
}
