/* SPDX-License-Identifier: BSD-3-Clause
 * The traversal on the host, compiled once for each instruction set and picked at run time. */
#ifndef STRATUS_RAY_CAST_HOST_H
#define STRATUS_RAY_CAST_HOST_H

/* Name of the instruction set that this machine's traversal uses: "AVX-512", "AVX2", "baseline". */
const char* stratus_ray_cast_isa(void);

#endif
