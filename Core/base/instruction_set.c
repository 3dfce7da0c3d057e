/* SPDX-License-Identifier: BSD-3-Clause
 * The instruction sets that this build contains, and the best that this machine runs. */
#include "instruction_set.h"

int stratus_isa_best(void)
{
#if STRATUS_ISA_COUNT > 1
  __builtin_cpu_init();
#if STRATUS_ISA_COUNT > 2
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
    __builtin_cpu_supports("avx512vl")) {
    return 2;
  }
#endif
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return 1;
  }
#endif
  return 0;
}

const char* stratus_isa_name(void)
{
  static const char* const names[3] = { "baseline", "AVX2", "AVX-512" };
  return names[stratus_isa_best()];
}
