/* SPDX-License-Identifier: BSD-3-Clause
 * A hash of a volume's content, of 64 bits. It ensures that a structure that comes with data is used for these data only. Rows are hashed
 * independently and their hashes added: threads may take them in any order, and a pass that reads the rows for another purpose can hash
 * them while they are in the cache. */
#include "volume_hash.h"

#include "hash.h"

#include <omp.h>
#include <string.h>

#define GATHER(type)                                                                                                                       \
  {                                                                                                                                        \
    const type* from = (const type*)volume->values + first;                                                                                \
    type* to = room;                                                                                                                       \
    for (int64_t i = 0; i < n; ++i) {                                                                                                      \
      to[i] = from[i * volume->value_stride];                                                                                              \
    }                                                                                                                                      \
    return room;                                                                                                                           \
  }

const void* stratus_volume_row(const stratus_volume* volume, int64_t j, int64_t k, void* room)
{
  const int64_t n = volume->dimensions[0], first = (k * volume->dimensions[1] + j) * n * volume->value_stride;
  const size_t size = stratus_type_size(volume->type);
  if (volume->value_stride == 1) {
    return (const uint8_t*)volume->values + (size_t)first * size;
  }
  switch (size) { /* only bits are copied, so any type of the same size serves */
    case 1:
      GATHER(uint8_t)
    case 2:
      GATHER(uint16_t)
    case 4:
      GATHER(uint32_t)
    default:
      GATHER(uint64_t)
  }
}

/* Returns the hash of the wanted flags of one row. It is 0 if none is set, so that flags of 0 throughout equal no flags. */
static uint64_t hash_flags(const uint8_t* flags, int64_t n, uint8_t wanted, uint64_t seed)
{
  uint64_t sum = 0;
  for (int64_t i = 0; flags && i < n; ++i) {
    if (flags[i] & wanted) {
      sum += stratus_hash_finish(seed ^ ((uint64_t)i << 8 | (flags[i] & wanted)));
    }
  }
  return sum;
}

uint64_t stratus_volume_hash_row(const stratus_volume* volume, int64_t j, int64_t k, const void* row)
{
  const int64_t* n = volume->dimensions;
  const uint64_t seed = stratus_hash_finish((uint64_t)(k * n[1] + j) + STRATUS_MIX_B);
  const int64_t less = !volume->cell_centered;
  int64_t cells[3];
  for (int a = 0; a < 3; ++a) {
    cells[a] = n[a] > 1 ? n[a] - less : 1;
  }
  uint64_t sum = stratus_hash(row, (size_t)n[0] * stratus_type_size(volume->type), seed);
  if (!volume->cell_centered && volume->point_ghosts) {
    const uint8_t wanted = STRATUS_GHOST_DUPLICATE | STRATUS_GHOST_HIDDEN_POINT;
    sum += hash_flags(volume->point_ghosts + (k * n[1] + j) * n[0], n[0], wanted, seed ^ STRATUS_MIX_A);
  }
  if (volume->cell_ghosts && j < cells[1] && k < cells[2]) {
    const uint8_t wanted = STRATUS_GHOST_DUPLICATE | STRATUS_GHOST_HIDDEN_CELL;
    sum += hash_flags(volume->cell_ghosts + (k * cells[1] + j) * cells[0], cells[0], wanted, seed ^ STRATUS_MIX_B);
  }
  return sum;
}

uint64_t stratus_volume_hash_shape(const stratus_volume* volume)
{
  uint64_t hash = stratus_hash_finish((uint64_t)volume->type * 2 + (volume->cell_centered ? 1 : 0));
  for (int a = 0; a < 3; ++a) {
    hash = stratus_hash_finish(stratus_hash_rotate(hash, 21) ^ (uint64_t)volume->dimensions[a]);
  }
  return hash;
}

stratus_status stratus_volume_hash(stratus_context* context, const stratus_volume* volume, uint64_t* hash)
{
  TRY(stratus_volume_check(context, volume));
  const int64_t ny = volume->dimensions[1], rows = ny * volume->dimensions[2];
  const size_t room = volume->value_stride == 1 ? 0 : (size_t)volume->dimensions[0] * stratus_type_size(volume->type);
  uint64_t sum = stratus_volume_hash_shape(volume);
  void* memory;
  TRY(stratus_allocate(context, (size_t)context->threads, room, &memory));
#pragma omp parallel num_threads(context->threads) reduction(+ : sum)
  {
    void* mine = (uint8_t*)memory + (size_t)omp_get_thread_num() * room;
#pragma omp for schedule(static)
    for (int64_t row = 0; row < rows; ++row) {
      const int64_t j = row % ny, k = row / ny;
      sum += stratus_volume_hash_row(volume, j, k, stratus_volume_row(volume, j, k, mine));
    }
  }
  stratus_release(context, memory);
  *hash = sum ? sum : 1;
  return STRATUS_OK;
}
