/* SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/* Returns the samples per second of all threads together in a tight loop over visible samples: position, trilinear interpolation, colour
 * and alpha from a table, compositing. 16 neighbouring rays at a time march through a block of 64^3 floats (1 MiB, which stays in the
 * second-level cache). Nothing is skipped, tested, clipped or terminated. */
double bench_sample_rate(void);
/* Returns the version of the loop that ran: "AVX-512" or "portable". */
const char* bench_sample_loop(void);

#ifdef __cplusplus
}
#endif
