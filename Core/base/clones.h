/* SPDX-License-Identifier: BSD-3-Clause
 * Clones of a function for instruction sets beyond the compiler's flags. The compiler compiles an ALWAYS_INLINE body for the instruction
 * set of the function that includes it. The processor decides at run time which clone runs. */
#ifndef STRATUS_CLONES_H
#define STRATUS_CLONES_H

#if defined(__GNUC__)
#define ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define ALWAYS_INLINE inline
#endif

#if defined(__x86_64__) && defined(__GNUC__)
#define HAVE_CLONES 1
#define TARGET_AVX2 __attribute__((target("avx2")))
#define TARGET_AVX512 __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl")))
#else
#define HAVE_CLONES 0
#endif

#endif
