/* SPDX-License-Identifier: BSD-3-Clause
 * Only for wheels built with glibc on x86-64: the compiler reads this before each file (cmake/wheel.cmake). glibc 2.29 gave these functions
 * a second version, fmod 2.38, which leaves out the error handling of System V, and a linker uses the newest that it sees. The first
 * version computes the same bits, in glibc 2.28 as in today's, so that a library that uses it runs on both. */
__asm__(".symver exp, exp@GLIBC_2.2.5");
__asm__(".symver exp2, exp2@GLIBC_2.2.5");
__asm__(".symver fmod, fmod@GLIBC_2.2.5");
__asm__(".symver log, log@GLIBC_2.2.5");
__asm__(".symver log2, log2@GLIBC_2.2.5");
__asm__(".symver pow, pow@GLIBC_2.2.5");
/* glibc 2.32 and 2.34 moved these from the library of threads, unchanged. */
__asm__(".symver pthread_create, pthread_create@GLIBC_2.2.5");
__asm__(".symver pthread_join, pthread_join@GLIBC_2.2.5");
__asm__(".symver pthread_sigmask, pthread_sigmask@GLIBC_2.2.5");
