/* SPDX-License-Identifier: BSD-3-Clause
 * The instruction sets that this build contains, and the best that this machine runs. */
#include "instruction_set.h"

static int highest_here(void)
{
#if STRATUS_ISA_COUNT > 1
  __builtin_cpu_init();
#if STRATUS_ISA_COUNT > 2
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
    __builtin_cpu_supports("avx512vl")) {
    return STRATUS_ISA_COUNT - 1;
  }
#endif
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return 1;
  }
#endif
  return 0;
}

#ifdef STRATUS_ISA_MAIN /* CMake runs this on the machine that builds, with a STRATUS_ISA_COUNT of 3 at most */
int main(void)
{
  return highest_here();
}
#else
#include "gather_trial.h"

#include <stdatomic.h>

int stratus_isa_highest(void)
{
#ifdef STRATUS_ISA_ONLY
  return highest_here() >= STRATUS_ISA_ONLY ? highest_here() : -1;
#else
  return highest_here();
#endif
}

int stratus_isa_best(void)
{
#if STRATUS_ISA_COUNT > 3
  static atomic_int best = -2;
  int known = atomic_load(&best);
  if (known == -2) { /* threads that are here at once measure at once, and one result stays */
    known = stratus_isa_highest();
    known = known == 3 && !stratus_gathers_are_faster() ? 2 : known;
    atomic_store(&best, known);
  }
  return known;
#else
  return stratus_isa_highest();
#endif
}

const char* stratus_isa_name(void)
{
  static const char* const names[] = { "baseline", "AVX2", "AVX-512", "AVX-512" };
#ifdef STRATUS_ISA_ONLY
  return names[STRATUS_ISA_ONLY];
#else
  return names[stratus_isa_highest()];
#endif
}
#endif
