/* SPDX-License-Identifier: BSD-3-Clause
 * The host's way through the traversal: which instruction set, which tiles, which threads. */
#include "ray_cast_host.h"

#include "ray_caster.h"
#include "instruction_set.h"

#include <omp.h>
#include <stdatomic.h>

/* Pixels a tile: small enough to share out evenly, large enough that its rays meet the same voxels. */
#define TILE 32

int stratus_ray_cast_type_is_fast(int type)
{
  return type == STRATUS_INT8 || type == STRATUS_UINT8 || type == STRATUS_INT16 || type == STRATUS_UINT16 || type == STRATUS_FLOAT32 ||
    type == STRATUS_FLOAT64;
}

stratus_ray_cast_tile* stratus_ray_cast_tile_for(int isa, int type, stratus_ray_variant variant)
{
  typedef stratus_ray_cast_tile* tile_of(int type, stratus_ray_variant variant);
  static tile_of* const composite[] = STRATUS_ISA_EACH(stratus_ray_cast_tile);
  static tile_of* const modes[] = STRATUS_ISA_EACH(stratus_ray_modes_tile);
  static tile_of* const shading[] = STRATUS_ISA_EACH(stratus_ray_shading_tile);
  isa = stratus_isa_at_most(isa);
  return (variant <= STRATUS_VARIANT_PREINTEGRATED ? composite
      : variant < STRATUS_VARIANT_SHADING_MIDPOINT ? modes
                                                   : shading)[isa](type, variant);
}

/* rgba8 of the pixels [x0, x1) x [y0, y1), where it is wanted. */
static void round_pixels(const stratus_ray_cast_frame* frame, int x0, int y0, int x1, int y1)
{
  const size_t width = (size_t)frame->arguments->picture.width, count = 4 * (size_t)(x1 - x0);
  for (int y = y0; frame->rgba8 && y < y1; ++y) {
    const size_t first = 4 * ((size_t)y * width + (size_t)x0);
    const float* restrict rgba = frame->rgba + first;
    uint8_t* restrict rgba8 = frame->rgba8 + first;
    for (size_t i = 0; i < count; ++i) {
      const float value = rgba[i] * 255.0f + 0.5f;
      rgba8[i] = (uint8_t)(int)(value < 255.0f ? value : 255.0f); /* premultiplied light is never below 0 */
    }
  }
}

stratus_status stratus_ray_cast_host(
  stratus_context* context, const stratus_ray_cast_frame* frame, int type, stratus_ray_variant variant, stratus_ray_counts* counts)
{
  const int width = frame->arguments->picture.width, height = frame->arguments->picture.height;
  const int columns = (width + TILE - 1) / TILE, tiles = columns * ((height + TILE - 1) / TILE);
  stratus_ray_cast_tile* const draw = stratus_ray_cast_tile_for(context->isa, type, variant);
  stratus_ray_counts sum = { 0 };
  atomic_int next = 0, cancelled = 0;
  stratus_status status = STRATUS_OK;

#pragma omp parallel num_threads(context->threads)
  {
    stratus_ray_counts mine = { 0 };
    for (int tile; !atomic_load_explicit(&cancelled, memory_order_relaxed) && (tile = atomic_fetch_add(&next, 1)) < tiles;) {
      const int x0 = tile % columns * TILE, x1 = x0 + TILE < width ? x0 + TILE : width;
      const int y0 = tile / columns * TILE, y1 = y0 + TILE < height ? y0 + TILE : height;
      draw(frame, x0, y0, x1, y1, &mine);
      round_pixels(frame, x0, y0, x1, y1); /* while the tile is in the cache */
      if (omp_get_thread_num() == 0 && context->options.progress) {
        status = stratus_progress(context, "ray cast", (double)(tile + 1) / tiles);
        if (status != STRATUS_OK) {
          atomic_store(&cancelled, 1);
        }
      }
    }
#pragma omp critical(stratus_ray_counts)
    {
      sum.rays += mine.rays;
      sum.samples += mine.samples;
      sum.skipped += mine.skipped;
      sum.lookups += mine.lookups;
    }
  }
  *counts = sum;
  return status;
}
