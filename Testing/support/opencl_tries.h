/* SPDX-License-Identifier: BSD-3-Clause
 * Tries with one fault each of the layer of opencl_faults.c: which call fails next, and which functions have been called and have failed.
 */
#ifndef STRATUS_TESTING_OPENCL_TRIES_H
#define STRATUS_TESTING_OPENCL_TRIES_H

#include "opencl_faults_load.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#include <cmocka.h>

#define NAMES_MAX 64

static opencl_faults* faults;
static const char* seen[NAMES_MAX]; /* functions of OpenCL that were called */
static bool refused[NAMES_MAX];     /* functions that failed at least once */
static int64_t tries;

/* The calls of a run without fault. */
static struct {
  int64_t count;
  const char* names[OPENCL_TRACE_MAX];
} usual;

static inline void note_calls(int64_t from, int64_t to, bool as_refused)
{
  for (int64_t c = from; c < to && c < OPENCL_TRACE_MAX; ++c) {
    int i = 0;
    while (i < NAMES_MAX && seen[i] && strcmp(seen[i], faults->trace[c]) != 0) {
      ++i;
    }
    assert_in_range(i, 0, NAMES_MAX - 1);
    seen[i] = faults->trace[c];
    refused[i] |= as_refused;
  }
}

static inline void keep_usual(void)
{
  usual.count = faults->calls;
  assert_in_range(usual.count, 1, OPENCL_TRACE_MAX);
  memcpy(usual.names, faults->trace, (size_t)usual.count * sizeof *usual.names);
}

/* The next call to fail after call n: the next one, or without STRATUS_LONG the next that is the first of its function, or every `step`th.
 * Beyond the usual ones any: the run then ends. */
static inline int64_t next_call(int64_t n, int64_t step)
{
  for (++n; !long_run() && n < usual.count && n % step != 0; ++n) {
    int64_t earlier = 0;
    while (strcmp(usual.names[earlier], usual.names[n]) != 0) {
      ++earlier;
    }
    if (earlier == n) {
      break;
    }
  }
  return n;
}

static inline void begin_fault(opencl_fault fault, int64_t at, int error)
{
  faults->fault = fault;
  faults->error = error;
  faults->calls = 0;
  faults->refused = 0;
  faults->first = -1;
  faults->at = at;
  ++tries;
}

/* Ends the fault. Returns whether it met a call. */
static inline bool end_fault(void)
{
  const bool met = faults->refused > 0;
  note_calls(0, faults->calls, false);
  if (faults->first >= 0) {
    note_calls(faults->first, faults->first + 1, true);
  }
  faults->at = -1;
  faults->at_first = NULL;
  assert_string_equal(faults->misuse, "");
  assert_int_equal(faults->pending, 0);
  return met;
}

#endif
