/* SPDX-License-Identifier: BSD-3-Clause
 * Code that the build compiles once for each instruction set (files *_isa.c), and that the program selects when it runs. */
#ifndef STRATUS_INSTRUCTION_SET_H
#define STRATUS_INSTRUCTION_SET_H

/* Number of instruction sets that the build compiles: 0 the compiler's default, 1 AVX2 with FMA, 2 AVX-512, 3 AVX-512 whose packets read
 * volumes by gather instructions (STRATUS_GATHERS) instead of one load for each lane. Which of the last two is faster depends on the
 * processor. Only rooms that read volumes have set 3; in others it is set 2. If STRATUS_ISA_ONLY is set, it is the highest set, and the
 * only one that the build compiles, of 2 with 3. */
#ifndef STRATUS_ISA_COUNT
#define STRATUS_ISA_COUNT 1
#endif

/* Returns the highest of them that this machine runs; -1 if it runs none. */
int stratus_isa_highest(void);
/* Returns the fastest: the highest, or if that is 3 the faster one of 2 and 3, by a measurement that the first call makes. */
int stratus_isa_best(void);
/* Returns the highest instruction set that is not above `most`. */
static inline int stratus_isa_at_most(int most)
{
  const int highest = stratus_isa_highest();
  return most < highest ? most : highest;
}
/* Returns its name, such as "AVX-512"; if the build has only one, that one's. */
const char* stratus_isa_name(void);

/* Names a function for the instruction set of its file: *_isa.c is compiled with STRATUS_ISA 0, 1 or 2. Set 3 has STRATUS_ISA 2, too. */
#define STRATUS_ISA_PASTE(name, isa) name##_isa##isa
#define STRATUS_ISA_EXPAND(name, isa) STRATUS_ISA_PASTE(name, isa)
#ifdef STRATUS_GATHERS
#define STRATUS_ISA_NAME(name) STRATUS_ISA_EXPAND(name, 3)
#else
#define STRATUS_ISA_NAME(name) STRATUS_ISA_EXPAND(name, STRATUS_ISA)
#endif

/* Initialize an array that an instruction set indexes, as far as the build has them: STRATUS_ISA_EACH(f) is { f_isa0, f_isa1, f_isa2,
 * f_isa2 }, and of rooms that have set 3 STRATUS_ISA_EVERY(f) is { f_isa0, f_isa1, f_isa2, f_isa3 }. */
#define STRATUS_ISA_FOUR(a, b, c, d)                                                                                                       \
  {                                                                                                                                        \
    a, b, c, d                                                                                                                             \
  }
#ifdef STRATUS_ISA_ONLY
#define STRATUS_ISA_ONE(name) STRATUS_ISA_EXPAND(name, STRATUS_ISA_ONLY)
#define STRATUS_ISA_EACH(name) STRATUS_ISA_FOUR(STRATUS_ISA_ONE(name), STRATUS_ISA_ONE(name), STRATUS_ISA_ONE(name), STRATUS_ISA_ONE(name))
#if STRATUS_ISA_COUNT > 3
#define STRATUS_ISA_EVERY(name) STRATUS_ISA_FOUR(STRATUS_ISA_ONE(name), STRATUS_ISA_ONE(name), STRATUS_ISA_ONE(name), name##_isa3)
#else
#define STRATUS_ISA_EVERY(name) STRATUS_ISA_EACH(name)
#endif
#elif STRATUS_ISA_COUNT == 1
#define STRATUS_ISA_EACH(name) STRATUS_ISA_FOUR(name##_isa0, name##_isa0, name##_isa0, name##_isa0)
#define STRATUS_ISA_EVERY(name) STRATUS_ISA_EACH(name)
#elif STRATUS_ISA_COUNT == 2
#define STRATUS_ISA_EACH(name) STRATUS_ISA_FOUR(name##_isa0, name##_isa1, name##_isa1, name##_isa1)
#define STRATUS_ISA_EVERY(name) STRATUS_ISA_EACH(name)
#else
#define STRATUS_ISA_EACH(name) STRATUS_ISA_FOUR(name##_isa0, name##_isa1, name##_isa2, name##_isa2)
#define STRATUS_ISA_EVERY(name) STRATUS_ISA_FOUR(name##_isa0, name##_isa1, name##_isa2, name##_isa3)
#endif

#endif
