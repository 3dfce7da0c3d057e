/* SPDX-License-Identifier: BSD-3-Clause
 * Loads the layer of opencl_faults.c into a test's process. */
#ifndef STRATUS_TESTING_OPENCL_FAULTS_LOAD_H
#define STRATUS_TESTING_OPENCL_FAULTS_LOAD_H

#include "opencl_faults.h"
#include "stratus.h"
#include "testing.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The process must not have called OpenCL yet, and the test defines _GNU_SOURCE. Returns NULL where there is no device, or where the loader
 * knows no layers. */
static inline opencl_faults* load_opencl_faults(void)
{
  char path[4096];
  const char* program = test_program();
  const char* slash = strrchr(program, '/');
  snprintf(path, sizeof path, "%.*s/libstratus-opencl-faults.so", slash ? (int)(slash - program) : 1, slash ? program : ".");
  /* The loader reads this once, at the first call of OpenCL in the process. */
  if (setenv("OPENCL_LAYERS", path, 1) != 0 || stratus_device_count() == 0) {
    return NULL;
  }
  void* library = dlopen(path, RTLD_NOW | RTLD_NOLOAD);
  opencl_faults* faults = library ? dlsym(library, OPENCL_FAULTS_SYMBOL) : NULL;
  return faults && faults->calls > 0 ? faults : NULL;
}

#endif
