/* SPDX-License-Identifier: BSD-3-Clause
 * Steps of hashes of 64 bits. */
#ifndef STRATUS_HASH_H
#define STRATUS_HASH_H

#include <stdint.h>

/* Odd constants with well-mixed bits. */
#define STRATUS_MIX_A UINT64_C(0x9fb21c651e98df25)
#define STRATUS_MIX_B UINT64_C(0xd6e8feb86659fd93)

static inline uint64_t stratus_hash_rotate(uint64_t x, int bits)
{
  return x << bits | x >> (64 - bits);
}

/* Mixes x: each of its bits changes half of the result's. */
static inline uint64_t stratus_hash_finish(uint64_t x)
{
  x = (x ^ x >> 32) * STRATUS_MIX_A;
  x = (x ^ x >> 29) * STRATUS_MIX_B;
  return x ^ x >> 32;
}

#endif
