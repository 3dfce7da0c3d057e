/* SPDX-License-Identifier: BSD-3-Clause
 * Whether this processor reads the corners of cells faster by gather instructions or by one load for each lane. */
#ifndef STRATUS_GATHER_TRIAL_H
#define STRATUS_GATHER_TRIAL_H

/* Measures both, in a tenth of a millisecond. For machines with AVX-512, in builds that have it. */
int stratus_gathers_are_faster(void);

/* Reads the table of STRATUS_GATHER_TRIAL floats at places that follow from `seed`, and returns a sum of them; for the same machines. */
#define STRATUS_GATHER_TRIAL 4096
float stratus_gather_trial(const float* table, int seed, int gathers);

/* gather_trial_isa.c */
float stratus_gather_trial_isa0(const float* table, int seed, int gathers);
float stratus_gather_trial_isa1(const float* table, int seed, int gathers);
float stratus_gather_trial_isa2(const float* table, int seed, int gathers);

#endif
