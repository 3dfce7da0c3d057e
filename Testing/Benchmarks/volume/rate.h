/* SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/* Samples a second that all threads take together in the tightest loop that does what a sample that shows has to: 16 neighbouring rays at a
 * time through a block of 64^3 floats (1 MiB, which stays in the second-level cache), position, trilinear interpolation, colour and alpha
 * from a table, compositing. Nothing is skipped, tested, clipped or terminated. */
double bench_sample_rate(void);
/* "AVX-512" or "portable": which form of the loop ran. */
const char* bench_sample_loop(void);

#ifdef __cplusplus
}
#endif
