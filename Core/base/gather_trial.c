/* SPDX-License-Identifier: BSD-3-Clause
 * The times of gathers and of loads. */
#define _POSIX_C_SOURCE 200809L
#include "gather_trial.h"

#include "instruction_set.h"

#include <math.h>
#include <time.h>

#if STRATUS_ISA_COUNT > 3
float stratus_gather_trial(const float* table, int seed, int gathers)
{
  return stratus_gather_trial_isa2(table, seed, gathers);
}

static double now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

int stratus_gathers_are_faster(void)
{
  float table[STRATUS_GATHER_TRIAL];
  double least[2] = { 1e30, 1e30 };
  float sum = 0.0f; /* of values that are not negative; the compiler may not leave the reads out */
  for (int i = 0; i < STRATUS_GATHER_TRIAL; ++i) {
    table[i] = (float)i;
  }
  for (int round = 0; round < 16; ++round) { /* in turns; the least time counts, because interruptions only add */
    const double start = now();
    sum += stratus_gather_trial(table, round, round & 1);
    const double spent = now() - start;
    least[round & 1] = spent < least[round & 1] ? spent : least[round & 1];
  }
  return sum >= 0.0f && least[1] < least[0];
}
#else
float stratus_gather_trial(const float* table, int seed, int gathers)
{
  (void)table;
  (void)seed;
  (void)gathers;
  return NAN;
}

int stratus_gathers_are_faster(void)
{
  return 0;
}
#endif
