/* SPDX-License-Identifier: BSD-3-Clause
 * Entry of clang's libFuzzer, which each program of this folder defines. A finding aborts. */
#ifndef STRATUS_FUZZ_BYTES_H
#define STRATUS_FUZZ_BYTES_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef __cplusplus
extern "C"
#endif
  int
  LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

#define HOLDS(condition, ...)                                                                                                              \
  do {                                                                                                                                     \
    if (!(condition)) {                                                                                                                    \
      fprintf(stderr, "FINDING: " __VA_ARGS__);                                                                                            \
      fputc('\n', stderr);                                                                                                                 \
      abort();                                                                                                                             \
    }                                                                                                                                      \
  } while (0)

#endif
