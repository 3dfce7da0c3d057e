/* SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/* Samples a second that all threads take together in the tightest loop there is: 16 neighbouring rays a step through a block of 32^3 floats that
 * stays in the cache, trilinear, one table look-up and one compositing step each, nothing skipped and nothing tested. */
double bench_sample_rate(void);
/* "AVX-512" or "portable": which form of the loop ran. */
const char* bench_sample_loop(void);

#ifdef __cplusplus
}
#endif
