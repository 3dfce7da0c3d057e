/* SPDX-License-Identifier: BSD-3-Clause
 * Composite rays through several volumes, compiled for one instruction set, STRATUS_ISA. */
#define TETRA_LIT 1
#include "ray_cast_packets.h"
#include "ray_reading.h"
#include "ray_several_host.h"
#include "tetra_march_view.h"

#include <omp.h>

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
_Static_assert(sizeof(several_volume) <= STRATUS_SEVERAL_PART_BYTES, "a room holds it");

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
  several_source from[SEVERAL_PARTS];
  several_mesh meshes[SEVERAL_MOST];
  several_volume* volumes = (several_volume*)(void*)(frame->rooms + (size_t)omp_get_thread_num() * frame->room);
  for (int n = 0; n < frame->count; ++n) {
    const stratus_several_part* part = &frame->volumes[n];
    const stratus_ray_cast_frame* of = &part->frame;
    from[n] = (several_source){ .a = of->arguments,
      .values = of->values,
      .hidden = of->hidden,
      .grid = of->grid,
      .lights = picture->lights,
      .map = of->map,
      .rough = of->rough,
      .table = part->layers ? (const void*)part->layers : of->table,
      .besides = of->table,
      .mesh = part->mesh ? &meshes[n] : NULL,
      .stride = part->arguments.stride,
      .lit = part->arguments.lit,
      .cells = part->arguments.cells,
      .media = part->arguments.media,
      .segment = part->arguments.segment,
      .preintegrated = part->arguments.preintegrated };
    if (part->mesh) {
      meshes[n] = (several_mesh){ .view = tetra_view_of(part->mesh), .a = &part->mesh->arguments, .places = &part->arguments.places };
      find_mesh(&meshes[n], x0, y0, x1, y1);
    }
  }
  const int parts = several_add_pieces(from, frame->count);
  for (int y = y0; y < y1; y += PACKET_Y) {
    for (int x = x0; x < x1; x += PACKET_X) {
      stratus_packet k;
      several_load(from, parts, picture->opaque_depth, x, y, volumes, &k);
      several_march(from, volumes, parts, &k);
      store_packet(picture, &k, x, y, &mine);
    }
  }
  add_counts(&mine, counts);
}
