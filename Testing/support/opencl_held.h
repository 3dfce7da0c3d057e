/* SPDX-License-Identifier: BSD-3-Clause
 * The objects that callers of the OpenCL layer hold, and which of them are kernels' arguments. The includer has `faults` and `lock`. */
#ifndef STRATUS_TESTING_OPENCL_HELD_H
#define STRATUS_TESTING_OPENCL_HELD_H

#include "opencl_faults.h"

#include <CL/cl.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define OBJECTS_MAX 4096
#define ARGUMENTS_MAX 48
#define KERNELS_MAX 256

typedef struct held_object {
  void* handle;
  int64_t references;
  uint64_t serial; /* a handle may return for another object; its number does not */
} held_object;

typedef struct kernel_arguments {
  void* kernel;
  void* memory[ARGUMENTS_MAX]; /* NULL: the argument is no buffer */
  uint64_t serial[ARGUMENTS_MAX];
} kernel_arguments;

static held_object objects[OBJECTS_MAX];
static kernel_arguments kernels[KERNELS_MAX];
static uint64_t serials;

static void misuse(const char* call, const char* what)
{
  if (!faults->misuse[0]) {
    snprintf(faults->misuse, sizeof faults->misuse, "%s: %s", call, what);
  }
}

static held_object* find(const void* handle)
{
  for (int i = 0; handle && i < OBJECTS_MAX; ++i) {
    if (objects[i].handle == handle) {
      return objects + i;
    }
  }
  return NULL;
}

static void hold(void* handle)
{
  if (!handle) {
    return;
  }
  pthread_mutex_lock(&lock);
  held_object* object = find(handle);
  for (int i = 0; !object && i < OBJECTS_MAX; ++i) {
    if (!objects[i].handle) {
      object = objects + i;
      *object = (held_object){ .handle = handle, .serial = ++serials };
    }
  }
  if (object) {
    ++object->references;
    ++faults->live;
  } else {
    misuse("hold", "more objects than the layer has room for");
  }
  pthread_mutex_unlock(&lock);
}

/* False: nobody holds the object, so that the platform must not hear of it. */
static bool let_go(const char* call, const void* handle)
{
  pthread_mutex_lock(&lock);
  held_object* object = find(handle);
  if (object) {
    --faults->live;
    if (--object->references == 0) {
      object->handle = NULL;
    }
    for (int k = 0; !object->handle && k < KERNELS_MAX; ++k) {
      if (kernels[k].kernel == handle) {
        memset(kernels + k, 0, sizeof kernels[k]);
      }
    }
  } else {
    misuse(call, "an object that is not held is released");
  }
  pthread_mutex_unlock(&lock);
  return object != NULL;
}

static bool is_held(const char* call, const void* handle)
{
  pthread_mutex_lock(&lock);
  const bool held = find(handle) != NULL;
  if (!held) {
    misuse(call, "an object is used that is not held");
  }
  pthread_mutex_unlock(&lock);
  return held;
}

static kernel_arguments* arguments_of(void* kernel)
{
  kernel_arguments* place = NULL;
  for (int k = 0; k < KERNELS_MAX; ++k) {
    if (kernels[k].kernel == kernel) {
      return kernels + k;
    }
    place = !place && !kernels[k].kernel ? kernels + k : place;
  }
  if (place) {
    place->kernel = kernel;
  }
  return place;
}

/* Remembers which object an argument was, as a kernel does not hold its buffers. */
static void remember_argument(void* kernel, cl_uint index, size_t size, const void* value)
{
  void* memory = NULL;
  if (value && size == sizeof memory) {
    memcpy(&memory, value, sizeof memory);
  }
  pthread_mutex_lock(&lock);
  kernel_arguments* a = index < ARGUMENTS_MAX ? arguments_of(kernel) : NULL;
  if (a) {
    const held_object* object = find(memory);
    a->memory[index] = object ? memory : NULL;
    a->serial[index] = object ? object->serial : 0;
  }
  pthread_mutex_unlock(&lock);
}

static bool arguments_are_held(void* kernel)
{
  bool held = true;
  pthread_mutex_lock(&lock);
  const kernel_arguments* a = arguments_of(kernel);
  for (int i = 0; a && i < ARGUMENTS_MAX; ++i) {
    const held_object* object = find(a->memory[i]);
    held &= !a->memory[i] || (object && object->serial == a->serial[i]);
  }
  if (!held) {
    misuse("clEnqueueNDRangeKernel", "an argument of the kernel was released");
  }
  pthread_mutex_unlock(&lock);
  return held;
}

#endif
