/* SPDX-License-Identifier: BSD-3-Clause
 * Keeps layers of surfaces by depth, a list for each pixel. */
#include "ray_layers.h"

#include <string.h>

/* Surfaces are at one depth if their depths differ by less than this share. A depth is a float that was rounded a few times, by 2^-24 of
 * itself each. Surfaces at one depth are in the order of the inputs. */
#define SAME_DEPTH 0x1p-20f

stratus_status stratus_layers_create(stratus_context* context, const stratus_image* image, stratus_layers* layers)
{
  void* memory = NULL;
  TRY(stratus_allocate_zero(context, (size_t)image->width * (size_t)image->height, sizeof *layers->nearest, &memory));
  layers->nearest = memory;
  layers->memory = NULL;
  return STRATUS_OK;
}

void stratus_layers_destroy(stratus_context* context, stratus_layers* layers)
{
  while (layers->memory) {
    stratus_layer* next = layers->memory->behind;
    stratus_release(context, layers->memory);
    layers->memory = next;
  }
  stratus_release(context, layers->nearest);
  layers->nearest = NULL;
}

bool stratus_layers_wanted(const stratus_layers* layers, size_t pixel, int input, int count)
{
  float clear = 1.0f;
  for (const stratus_layer* layer = layers->nearest[pixel]; layer && count > 0; layer = layer->behind) {
    clear *= 1.0f - layer->rgba[3];
    if (clear < layers->least || clear <= 0.0f) {
      return false;
    }
    count -= layer->of == input;
  }
  return count == 0;
}

static bool in_front(const stratus_layer* a, const stratus_layer* b)
{
  const bool same = fabsf(a->depth - b->depth) <= SAME_DEPTH * fmaxf(fabsf(a->depth), fabsf(b->depth));
  return same ? a->of < b->of : a->depth < b->depth;
}

/* Puts a layer behind the other ones of its input. */
static void insert(stratus_layer** nearest, stratus_layer* layer)
{
  stratus_layer** at = nearest;
  for (stratus_layer** next = nearest; *next; next = &(*next)->behind) {
    at = (*next)->of == layer->of ? &(*next)->behind : at;
  }
  while (*at && !in_front(layer, *at)) {
    at = &(*at)->behind;
  }
  layer->behind = *at;
  *at = layer;
}

/* Adds row y of a part. Layers come from `free` on; NULL: they are only counted. Returns how many there are. */
static size_t join_row(const stratus_image* part, int y, const int inside[4], int input, stratus_layer** nearest, stratus_layer* free)
{
  size_t count = 0;
  for (int x = inside[0]; x < inside[1]; ++x) {
    const size_t from = (size_t)y * (size_t)part->width + (size_t)x;
    if (!(part->rgba[4 * from + 3] > 0.0f)) {
      continue;
    }
    if (free) {
      stratus_layer* layer = free + count;
      memcpy(layer->rgba, part->rgba + 4 * from, sizeof layer->rgba);
      layer->depth = part->depth[from];
      layer->of = input;
      insert(nearest + x, layer);
    }
    ++count;
  }
  return count;
}

stratus_status stratus_layers_join(stratus_context* context, stratus_layers* layers, int input, const stratus_image* image,
  const stratus_image* part, int x0, int y0, const int inside[4])
{
  size_t count = 1, used = 1; /* the first one leads to the memory of the pictures before */
  void* memory = NULL;
#pragma omp parallel for num_threads(context->threads) reduction(+ : count)
  for (int y = inside[2]; y < inside[3]; ++y) {
    count += join_row(part, y, inside, input, NULL, NULL);
  }
  TRY(stratus_allocate(context, count, sizeof(stratus_layer), &memory));
  stratus_layer* next = memory;
  next->behind = layers->memory;
  layers->memory = next;
#pragma omp parallel for num_threads(context->threads)
  for (int y = inside[2]; y < inside[3]; ++y) {
    const size_t mine = join_row(part, y, inside, input, NULL, NULL);
    size_t first;
#pragma omp atomic capture
    {
      first = used;
      used += mine;
    }
    join_row(part, y, inside, input, layers->nearest + (size_t)(y0 + y) * (size_t)image->width + x0, next + first);
  }
  return STRATUS_OK;
}

void stratus_layers_finish(stratus_context* context, const stratus_layers* layers, const stratus_image* image)
{
  const int64_t pixels = (int64_t)image->width * image->height;
#pragma omp parallel for num_threads(context->threads)
  for (int64_t i = 0; i < pixels; ++i) {
    float clear = 1.0f;
    for (const stratus_layer* layer = layers->nearest[i]; layer && clear >= layers->least; layer = layer->behind) {
      for (int c = 0; c < 4; ++c) {
        image->rgba[4 * i + c] += clear * layer->rgba[c];
      }
      clear *= 1.0f - layer->rgba[3];
    }
    if (image->depth && layers->nearest[i]) {
      image->depth[i] = layers->nearest[i]->depth;
    }
  }
}
