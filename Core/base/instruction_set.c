/* SPDX-License-Identifier: BSD-3-Clause
 * The instruction sets that this build contains, and the best that this machine runs. */
#include "instruction_set.h"

static int best_here(void)
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

int stratus_isa_best(void)
{
#ifdef STRATUS_ISA_ONLY
  return best_here() == STRATUS_ISA_ONLY ? STRATUS_ISA_ONLY : -1;
#else
  return best_here();
#endif
}

const char* stratus_isa_name(void)
{
  static const char* const names[3] = { "baseline", "AVX2", "AVX-512" };
#ifdef STRATUS_ISA_ONLY
  return names[STRATUS_ISA_ONLY];
#else
  return names[stratus_isa_best()];
#endif
}

#ifdef STRATUS_ISA_MAIN /* CMake runs this on the machine that builds */
int main(void)
{
  return best_here();
}
#endif
