/* SPDX-License-Identifier: BSD-3-Clause
 * A test's settings for the OpenCL layer of opencl_faults.c, and the layer's counts. The layer is between the loader and every platform, so
 * each call of OpenCL passes through it, in the core's own build without any hook. */
#ifndef STRATUS_TESTING_OPENCL_FAULTS_H
#define STRATUS_TESTING_OPENCL_FAULTS_H

#include <stdint.h>

#define OPENCL_TRACE_MAX 8192

typedef enum opencl_fault {
  OPENCL_FAULT_ONCE,   /* call `at` fails, and no other */
  OPENCL_FAULT_ALL,    /* every call from `at` on fails */
  OPENCL_FAULT_VANISH, /* from `at` on the device runs nothing: calls that only enqueue succeed, those that wait or compile fail */
  OPENCL_FAULTS
} opencl_fault;

/* Calls that release are never counted nor refused, but with FAULT_ALL and FAULT_VANISH they return the error after they have released. */
typedef struct opencl_faults {
  int64_t at;           /* number of the first call to fail, from 0; negative: none fails */
  const char* at_first; /* a function whose first call sets `at` to its number where that is negative; NULL: none */
  opencl_fault fault;
  int error;
  int64_t calls;                       /* counted since this was last set to 0 */
  int64_t refused;                     /* calls that did not reach the platform */
  int64_t first;                       /* number of the first call that returned the error; negative: none did since it was last set */
  const char* trace[OPENCL_TRACE_MAX]; /* their names */
  int64_t live;                        /* references to contexts, queues, buffers, programs and kernels that are held */
  int64_t pending;                     /* commands that run although nobody has waited for them */
  char misuse[160];                    /* the first use of an object after its release; empty: none */
} opencl_faults;

/* The layer's only variable, for dlsym(). */
#define OPENCL_FAULTS_SYMBOL "stratus_opencl_faults"

#endif
