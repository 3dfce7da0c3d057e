/* SPDX-License-Identifier: BSD-3-Clause
 * Distributes the tiles of a picture over the host's threads. */
#include "ray_cast_rest.h"

#include "stratus/ray_cast.h"

#include "picture.h"
#include "tiles.h"

/* Rounds pixels [x0, x1) x [y0, y1) to rgba8, if that is wanted. */
static void round_pixels(const stratus_ray_cast_frame* frame, int x0, int y0, int x1, int y1)
{
  const size_t width = (size_t)frame->arguments->picture.width, count = 4 * (size_t)(x1 - x0);
  for (int y = y0; frame->rgba8 && y < y1; ++y) {
    const size_t first = 4 * ((size_t)y * width + (size_t)x0);
    const float* restrict rgba = frame->rgba + first;
    uint8_t* restrict rgba8 = frame->rgba8 + first;
    for (size_t i = 0; i < count; ++i) {
      rgba8[i] = stratus_image_byte(rgba[i]);
    }
  }
}

void stratus_ray_cast_pixels(
  const stratus_ray_cast_frame* frame, stratus_ray_cast_tile* draw, int x0, int y0, int x1, int y1, stratus_ray_counts* counts)
{
  if (x0 < x1 && y0 < y1) {
    draw(frame, x0, y0, x1, y1, counts);
    round_pixels(frame, x0, y0, x1, y1); /* while they are in the cache */
  }
}

bool stratus_ray_is_drawn(const stratus_ray_drawn* drawn, int tile)
{
  int i = 0;
  while (i < drawn->count && drawn->tiles[i] != tile) {
    ++i;
  }
  return i < drawn->count;
}

typedef struct cast_job {
  const stratus_ray_cast_frame* frame;
  const stratus_ray_drawn* drawn;
  stratus_ray_cast_tile* draw;
  int columns; /* of tiles */
} cast_job;

static void cast_tile(const void* data, int tile, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const cast_job* job = data;
  const int width = job->frame->arguments->picture.width, height = job->frame->arguments->picture.height;
  const int x0 = tile % job->columns * STRATUS_RAY_TILE, x1 = x0 + STRATUS_RAY_TILE < width ? x0 + STRATUS_RAY_TILE : width;
  const int y0 = tile / job->columns * STRATUS_RAY_TILE, y1 = y0 + STRATUS_RAY_TILE < height ? y0 + STRATUS_RAY_TILE : height;
  stratus_ray_counts mine = { 0 };
  if (!stratus_ray_is_drawn(job->drawn, tile)) {
    stratus_ray_cast_pixels(job->frame, job->draw, x0, y0, x1, y1, &mine);
  }
  counts[0] += mine.rays;
  counts[1] += mine.samples;
  counts[2] += mine.skipped;
  counts[3] += mine.lookups;
}

stratus_status stratus_ray_cast_rest(stratus_context* context, const stratus_ray_cast_frame* frame, int type, stratus_ray_variant variant,
  const stratus_ray_drawn* drawn, stratus_ray_counts* counts)
{
  const int width = frame->arguments->picture.width, height = frame->arguments->picture.height;
  const int columns = (width + STRATUS_RAY_TILE - 1) / STRATUS_RAY_TILE, rows = (height + STRATUS_RAY_TILE - 1) / STRATUS_RAY_TILE;
  const cast_job job = { frame, drawn, stratus_ray_cast_tile_for(context->isa, type, variant), columns };
  uint64_t sums[STRATUS_TILE_COUNTS];
  const stratus_status status = stratus_each_tile(context, "ray cast", columns * rows, cast_tile, &job, sums);
  const stratus_ray_counts* before = &drawn->counts;
  *counts = (stratus_ray_counts){ .rays = before->rays + sums[0],
    .samples = before->samples + sums[1],
    .skipped = before->skipped + sums[2],
    .lookups = before->lookups + sums[3] };
  return status;
}
