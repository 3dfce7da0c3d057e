/* SPDX-License-Identifier: BSD-3-Clause
 * Value ranges in the cache's folder: a head, then the least and the greatest value of each block, in the volume's type where that has at
 * most 16 bits and as floats otherwise, then a bit for each block's gaps. */
#include "value_range_kept.h"

#include "volume_kept.h"

#include <stdlib.h>
#include <string.h>

#define KIND "ranges"

typedef struct head {
  double bias;
  float whole_lo, whole_hi;
} head;

static size_t blocks_of(const stratus_value_range* ranges)
{
  return (size_t)ranges->blocks[0] * (size_t)ranges->blocks[1] * (size_t)ranges->blocks[2];
}

/* Bytes of a stored extreme. */
static size_t extreme_bytes(stratus_type type)
{
  const size_t size = stratus_type_size(type);
  return size < sizeof(float) ? size : sizeof(float);
}

static size_t stored_bytes(stratus_type type, size_t blocks)
{
  return sizeof(head) + 2 * blocks * extreme_bytes(type) + (blocks + 7) / 8;
}

#define EACH(work)                                                                                                                         \
  for (size_t b = 0; b < count; ++b) {                                                                                                     \
    work;                                                                                                                                  \
  }                                                                                                                                        \
  return

static void pack(stratus_type type, const float* from, void* to, size_t count)
{
  switch (type) {
    case STRATUS_INT8:
      EACH(((int8_t*)to)[b] = (int8_t)from[b]);
    case STRATUS_UINT8:
      EACH(((uint8_t*)to)[b] = (uint8_t)from[b]);
    case STRATUS_INT16:
      EACH(((int16_t*)to)[b] = (int16_t)from[b]);
    case STRATUS_UINT16:
      EACH(((uint16_t*)to)[b] = (uint16_t)from[b]);
    default:
      memcpy(to, from, count * sizeof *from);
  }
}

static void unpack(stratus_type type, const void* from, float* to, size_t count)
{
  switch (type) {
    case STRATUS_INT8:
      EACH(to[b] = (float)((const int8_t*)from)[b]);
    case STRATUS_UINT8:
      EACH(to[b] = (float)((const uint8_t*)from)[b]);
    case STRATUS_INT16:
      EACH(to[b] = (float)((const int16_t*)from)[b]);
    case STRATUS_UINT16:
      EACH(to[b] = (float)((const uint16_t*)from)[b]);
    default:
      memcpy(to, from, count * sizeof *to);
  }
}

bool stratus_value_range_recall(const stratus_volume* volume, stratus_value_range* ranges)
{
  const size_t blocks = blocks_of(ranges), part = blocks * extreme_bytes(volume->type);
  uint8_t* const bytes = stratus_kept_recall(ranges->context, volume, KIND, ranges->block_size, stored_bytes(volume->type, blocks));
  if (!bytes) {
    return false;
  }
  head h;
  memcpy(&h, bytes, sizeof h);
  const uint8_t *lo = bytes + sizeof h, *hi = lo + part, *gaps = hi + part;
  unpack(volume->type, lo, ranges->lo, blocks);
  unpack(volume->type, hi, ranges->hi, blocks);
  for (size_t b = 0; b < blocks; ++b) {
    ranges->gaps[b] = gaps[b / 8] >> b % 8 & 1;
  }
  ranges->bias = h.bias;
  ranges->whole_lo = h.whole_lo;
  ranges->whole_hi = h.whole_hi;
  free(bytes);
  return true;
}

void stratus_value_range_keep(const stratus_volume* volume, const stratus_value_range* ranges)
{
  const size_t blocks = blocks_of(ranges), size = stored_bytes(volume->type, blocks), part = blocks * extreme_bytes(volume->type);
  uint8_t* const bytes = volume->identity ? calloc(size, 1) : NULL;
  if (!bytes) {
    return;
  }
  const head h = { .bias = ranges->bias, .whole_lo = ranges->whole_lo, .whole_hi = ranges->whole_hi };
  memcpy(bytes, &h, sizeof h);
  uint8_t *lo = bytes + sizeof h, *hi = lo + part, *gaps = hi + part;
  pack(volume->type, ranges->lo, lo, blocks);
  pack(volume->type, ranges->hi, hi, blocks);
  for (size_t b = 0; b < blocks; ++b) {
    gaps[b / 8] |= (uint8_t)((ranges->gaps[b] != 0) << b % 8);
  }
  stratus_kept_keep(volume, KIND, ranges->block_size, bytes, size);
  free(bytes);
}
