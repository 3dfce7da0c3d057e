/* SPDX-License-Identifier: BSD-3-Clause
 * An OpenCL device and the host, for tests that compare the two. Includers bring make_context() (structures.h). */
#ifndef STRATUS_TESTING_DEVICE_PAIR_H
#define STRATUS_TESTING_DEVICE_PAIR_H

#include "device_state.h"
#include "testing.h"

#include <stdio.h>

static stratus_context *device, *host_context;
static bool tiny; /* few and small cases: enough for a simulator to see every kernel */

static inline int open_device(void** state)
{
  (void)state;
  device = make_context("0", 2);
  host_context = make_context("host", 2);
  printf("device: %s\n", stratus_context_device(device));
  return 0;
}

/* A device on a CPU is taken for a GPU: the core would leave the work to the host there. */
static inline int open_device_as_gpu(void** state)
{
  open_device(state);
  device->device->is_cpu = false;
  return 0;
}

static inline int close_device(void** state)
{
  (void)state;
  stratus_context_destroy(device);
  stratus_context_destroy(host_context);
  return 0;
}

/* Where there is no device, the test says so and skips itself. */
static inline bool no_device(void)
{
  tiny = test_option("--tiny");
  return stratus_device_count() == 0 && test_skip("no OpenCL device on this machine");
}

#endif
