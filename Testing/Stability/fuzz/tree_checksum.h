/* SPDX-License-Identifier: BSD-3-Clause
 * The checksum of saved trees. With it, changed bytes reach the checks behind it. */
#ifndef STRATUS_FUZZ_TREE_CHECKSUM_H
#define STRATUS_FUZZ_TREE_CHECKSUM_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* The format's own, over the bytes from 24 on. */
static inline uint64_t fuzz_tree_checksum(const unsigned char* p, size_t size)
{
  uint64_t h = 0x9e3779b97f4a7c15ull ^ size;
  for (; size >= 8; size -= 8, p += 8) {
    uint64_t word;
    memcpy(&word, p, 8);
    h = (h ^ word) * 0xff51afd7ed558ccdull;
    h ^= h >> 32;
  }
  for (; size > 0; --size, ++p) {
    h = (h ^ *p) * 0xff51afd7ed558ccdull;
    h ^= h >> 29;
  }
  return h;
}

#endif
