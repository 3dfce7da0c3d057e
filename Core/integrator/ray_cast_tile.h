/* SPDX-License-Identifier: BSD-3-Clause
 * Marches a tile of rays on the host. The including file defines STRATUS_TYPE, STRATUS_PREINTEGRATED, RAY_NAME and, unless rays composite,
 * STRATUS_RAY_MODE. The function is RAY_NAME(tile), or for all files RAY_TILE_NAME if that is defined. */
#include "ray_cast.h"

static void RAY_NAME(begin_packet)(const stratus_ray_cast_frame* frame, int x, int y, stratus_packet* k, stratus_crop* crop)
{
  if (packet_outside(frame->arguments, x, y)) {
    packet_nothing(k);
    crop->all = m_none();
  } else {
    RAY_NAME(ray_load)(frame->arguments, frame->opaque_depth, frame->grid, frame->lights, x, y, k, crop);
  }
}

#ifdef RAY_TILE_NAME
void STRATUS_ISA_NAME(RAY_TILE_NAME)
#else
static void RAY_NAME(tile)
#endif
  (const stratus_ray_cast_frame* frame, int x0, int y0, int x1, int y1, stratus_ray_counts* counts)
{
  const stratus_ray_cast_arguments* a = frame->arguments;
  tile_counts mine = { vi_set(0), vi_set(0), vi_set(0), 0 };
  const int pieces = a->crop.regions ? CROP_PIECES : 1, layers = a->camera.layers > 0 ? a->camera.layers : 1;
  const size_t picture = 4 * (size_t)a->picture.width * (size_t)a->picture.height;
  stratus_ray_cast_frame pictures = *frame; /* with the rgba of a layer */
  for (int y = y0; y < y1; y += PACKET_Y) {
    for (int x = x0; x < x1; x += PACKETS_TOGETHER * PACKET_X) {
      stratus_packet k[PACKETS_TOGETHER];
      stratus_crop crop[PACKETS_TOGETHER];
      for (int i = 0; i < PACKETS_TOGETHER; ++i) {
        RAY_NAME(begin_packet)(frame, x + i * PACKET_X, y, &k[i], &crop[i]); /* beyond the picture, no ray is live and nothing is stored */
      }
      for (int layer = 0; layer < layers; ++layer) {
        pictures.rgba = frame->rgba + (size_t)layer * picture;
        for (int piece = 0; piece < pieces; ++piece) {
          for (int i = 0; (a->crop.regions || a->camera.layers) && i < PACKETS_TOGETHER; ++i) {
            crop_enter(a, &crop[i], piece, layer, &k[i]);
          }
#if PACKETS_TOGETHER == 2
          RAY_NAME(ray_march_two)(a, frame->values, frame->hidden, frame->map, frame->rough, frame->table, &k[0], &k[1]);
#else
          RAY_NAME(ray_march)(a, frame->values, frame->hidden, frame->map, frame->rough, frame->table, &k[0]);
#endif
        }
        for (int i = 0; i < PACKETS_TOGETHER; ++i) {
#if defined(STRATUS_RAY_MODE)
          RAY_NAME(ray_finish)(a, frame->values, frame->hidden, frame->table, &k[i]);
#endif
          store_packet(&pictures, &k[i], x + i * PACKET_X, y, &mine);
          if (a->camera.layers) {
            crop_next_layer(a, &crop[i], &k[i]);
          }
        }
      }
    }
  }
  add_counts(&mine, counts);
}

#undef RAY_NAME
#undef STRATUS_TYPE
