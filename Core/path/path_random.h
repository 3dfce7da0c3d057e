/* SPDX-License-Identifier: BSD-3-Clause
 * Random numbers by number: Philox4x32 with 10 rounds (Salmon, Moraes, Dror & Shaw 2011). The numbers of a path depend only on the seed,
 * the pixel and the sample, so that threads may trace paths in any order. */
#ifndef STRATUS_PATH_RANDOM_H
#define STRATUS_PATH_RANDOM_H

#include <stdint.h>

typedef struct stratus_path_random {
  uint32_t key[2], counter[4];
  double kept; /* the second number of the last block, negative if it is used */
} stratus_path_random;

/* Replaces the four words by the block of random bits of that number. */
static inline void stratus_philox(const uint32_t key[2], uint32_t word[4])
{
  uint32_t k0 = key[0], k1 = key[1];
  for (int round = 0; round < 10; ++round) {
    const uint64_t a = (uint64_t)word[0] * 0xD2511F53u, b = (uint64_t)word[2] * 0xCD9E8D57u;
    word[0] = (uint32_t)(b >> 32) ^ word[1] ^ k0;
    word[2] = (uint32_t)(a >> 32) ^ word[3] ^ k1;
    word[1] = (uint32_t)b;
    word[3] = (uint32_t)a;
    k0 += 0x9E3779B9u;
    k1 += 0xBB67AE85u;
  }
}

static inline stratus_path_random stratus_path_random_of(uint64_t seed, uint32_t pixel, uint64_t sample)
{
  return (stratus_path_random){
    .key = { (uint32_t)seed, (uint32_t)(seed >> 32) }, .counter = { 0, pixel, (uint32_t)sample, (uint32_t)(sample >> 32) }, .kept = -1.0
  };
}

/* Returns the next number, 0 <= u < 1, of 53 bits. */
static inline double stratus_path_uniform(stratus_path_random* random)
{
  if (random->kept >= 0.0) {
    const double result = random->kept;
    random->kept = -1.0;
    return result;
  }
  uint32_t word[4] = { random->counter[0], random->counter[1], random->counter[2], random->counter[3] };
  ++random->counter[0];
  stratus_philox(random->key, word);
  random->kept = (double)(((uint64_t)word[2] << 32 | word[3]) >> 11) * 0x1p-53;
  return (double)(((uint64_t)word[0] << 32 | word[1]) >> 11) * 0x1p-53;
}

#endif
