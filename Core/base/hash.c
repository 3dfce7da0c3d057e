/* SPDX-License-Identifier: BSD-3-Clause
 * A hash of 64 bits, by which content is known again. */
#include "hash.h"

#include "base.h"

#include <string.h>

static inline uint64_t read_word(const uint8_t* bytes)
{
  uint64_t word;
  memcpy(&word, bytes, sizeof word);
  return word;
}

/* Runs four chains, so that no multiplication waits for the one before. */
uint64_t stratus_hash(const void* bytes_of, size_t size, uint64_t seed)
{
  const uint8_t* bytes = bytes_of;
  size = bytes ? size : 0;
  uint64_t lane[4] = { seed ^ STRATUS_MIX_A, seed ^ STRATUS_MIX_B, seed + STRATUS_MIX_A, seed + STRATUS_MIX_B };
  size_t at = 0;
  for (; at + 32 <= size; at += 32) {
    for (int l = 0; l < 4; ++l) {
      lane[l] = stratus_hash_rotate((lane[l] ^ read_word(bytes + at + 8 * l)) * STRATUS_MIX_A, 31);
    }
  }
  uint64_t result = stratus_hash_finish(lane[0]) + stratus_hash_rotate(stratus_hash_finish(lane[1]), 16) +
    stratus_hash_rotate(stratus_hash_finish(lane[2]), 32) + stratus_hash_rotate(stratus_hash_finish(lane[3]), 48);
  for (; at < size; at += 8) {
    uint64_t word = 0;
    memcpy(&word, bytes + at, size - at < 8 ? size - at : 8);
    result = stratus_hash_rotate((result ^ word) * STRATUS_MIX_B, 29);
  }
  return stratus_hash_finish(result ^ size);
}
