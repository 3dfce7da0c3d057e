/* SPDX-License-Identifier: BSD-3-Clause
 * How many threads to wake for short work. */
#ifndef STRATUS_THREADS_H
#define STRATUS_THREADS_H

#include "base.h"

/* Returns how many threads are worth waking for work that takes one of them about so many nanoseconds: each gets .2 ms or more. To wait for
 * one another costs threads microseconds on idle processors, but turns of the scheduler, milliseconds, where other programs run. */
static inline int stratus_threads_for(const stratus_context* context, double nanoseconds)
{
  const double worth = nanoseconds / 2e5;
  return worth < context->threads ? (worth > 1.0 ? (int)worth : 1) : context->threads;
}

#endif
