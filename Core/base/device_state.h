/* SPDX-License-Identifier: BSD-3-Clause
 * What device.c, which chooses a device and talks to it, device_program.c, which builds and caches its kernels, and device_error.c share.
 */
#ifndef STRATUS_DEVICE_STATE_H
#define STRATUS_DEVICE_STATE_H

#include "device.h"

typedef struct cached_program {
  struct cached_program* next;
  cl_program program;
  const char* defines; /* behind the name */
  char name[];
} cached_program;

typedef struct cached_kernel {
  struct cached_kernel* next;
  const cached_program* program;
  cl_kernel kernel;
  char name[];
} cached_kernel;

struct stratus_device {
  stratus_context* owner;
  cl_device_id id;
  cl_context context;
  cl_command_queue queue;
  cached_program* programs;
  cached_kernel* kernels;
  size_t largest_allocation;
  size_t borrow_alignment;
  bool is_cpu, has_double, shares_memory;
  int64_t calls_left; /* until every call fails with `injected`; negative: never */
  cl_int injected;
  char label[192];
};

/* STRATUS_OK for CL_SUCCESS; else the status that the error means, with both names in the message. */
stratus_status stratus_device_check(stratus_context* context, const stratus_device* device, const char* call, cl_int error);
/* What a test asked the next call to fail with, else CL_SUCCESS. */
cl_int stratus_device_next_error(stratus_device* device);
/* The call is evaluated only where no test asked it to fail. */
#define CALL(context, device, name, call)                                                                                                  \
  stratus_device_check(context, device, name, stratus_device_next_error(device) != CL_SUCCESS ? (device)->injected : (call))

/* Frees all programs and kernels. */
void stratus_device_programs_release(stratus_device* device);

#endif
