/* SPDX-License-Identifier: BSD-3-Clause
 * Code that the build compiles once for each instruction set (files *_isa.c), and that the program selects when it runs. */
#ifndef STRATUS_INSTRUCTION_SET_H
#define STRATUS_INSTRUCTION_SET_H

/* Number of instruction sets that the build compiles: 0 the compiler's default, 1 AVX2 with FMA, 2 AVX-512. If STRATUS_ISA_ONLY is set, it
 * is the highest of these, and the only one that the build compiles. */
#ifndef STRATUS_ISA_COUNT
#define STRATUS_ISA_COUNT 1
#endif

/* Returns the best of them that this machine runs; -1 if it runs none. */
int stratus_isa_best(void);
/* Returns the best instruction set that is not above `most`. */
static inline int stratus_isa_at_most(int most)
{
  const int best = stratus_isa_best();
  return most < best ? most : best;
}
/* Returns its name, such as "AVX-512"; if the build has only one, that one's. */
const char* stratus_isa_name(void);

/* Names a function for the instruction set of its file: *_isa.c is compiled with STRATUS_ISA 0, 1 or 2. */
#define STRATUS_ISA_PASTE(name, isa) name##_isa##isa
#define STRATUS_ISA_EXPAND(name, isa) STRATUS_ISA_PASTE(name, isa)
#define STRATUS_ISA_NAME(name) STRATUS_ISA_EXPAND(name, STRATUS_ISA)

/* Initializes an array that an instruction set indexes: STRATUS_ISA_EACH(f) is { f_isa0, f_isa1, f_isa2 }, as far as the build has them. */
#ifdef STRATUS_ISA_ONLY
#define STRATUS_ISA_ONE(name) STRATUS_ISA_EXPAND(name, STRATUS_ISA_ONLY)
#define STRATUS_ISA_EACH(name)                                                                                                             \
  {                                                                                                                                        \
    STRATUS_ISA_ONE(name), STRATUS_ISA_ONE(name), STRATUS_ISA_ONE(name)                                                                    \
  }
#elif STRATUS_ISA_COUNT == 1
#define STRATUS_ISA_EACH(name)                                                                                                             \
  {                                                                                                                                        \
    name##_isa0                                                                                                                            \
  }
#elif STRATUS_ISA_COUNT == 2
#define STRATUS_ISA_EACH(name)                                                                                                             \
  {                                                                                                                                        \
    name##_isa0, name##_isa1                                                                                                               \
  }
#else
#define STRATUS_ISA_EACH(name)                                                                                                             \
  {                                                                                                                                        \
    name##_isa0, name##_isa1, name##_isa2                                                                                                  \
  }
#endif

#endif
