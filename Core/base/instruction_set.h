/* SPDX-License-Identifier: BSD-3-Clause
 * Code that is compiled once for each instruction set (files *_isa.c) and picked when the program runs. */
#ifndef STRATUS_INSTRUCTION_SET_H
#define STRATUS_INSTRUCTION_SET_H

/* Instruction sets that the build compiles: 0 what the compiler targets by itself, 1 AVX2 with FMA, 2 AVX-512. */
#ifndef STRATUS_ISA_COUNT
#define STRATUS_ISA_COUNT 1
#endif

/* The best of them that this machine runs, and its name. */
int stratus_isa_best(void);
/* The same, but none above `most`. */
static inline int stratus_isa_at_most(int most)
{
  const int best = stratus_isa_best();
  return most < best ? most : best;
}
const char* stratus_isa_name(void);

/* In a file *_isa.c, compiled with STRATUS_ISA 0, 1 or 2: the name of a function for that instruction set. */
#define STRATUS_ISA_PASTE(name, isa) name##_isa##isa
#define STRATUS_ISA_EXPAND(name, isa) STRATUS_ISA_PASTE(name, isa)
#define STRATUS_ISA_NAME(name) STRATUS_ISA_EXPAND(name, STRATUS_ISA)

/* Initializer of an array that an instruction set indexes: STRATUS_ISA_EACH(f) is { f_isa0, f_isa1, f_isa2 }, as far as they are built. */
#if STRATUS_ISA_COUNT == 1
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
