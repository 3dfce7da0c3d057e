/* SPDX-License-Identifier: BSD-3-Clause
 * State of a device, shared by device.c (choice, buffers), device_program.c (kernels and their cache) and device_error.c (errors). */
#ifndef STRATUS_DEVICE_STATE_H
#define STRATUS_DEVICE_STATE_H

#include "device.h"

typedef struct cached_program {
  struct cached_program* next;
  cl_program program;
  const char* defines; /* stored behind `name` */
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
  bool builds;            /* structures */
  bool running;           /* kernels were launched that no later call has waited for */
  bool named;             /* by the caller: its failures are errors, but for want of memory */
  stratus_status failure; /* of the last call that failed, until stratus_device_hands_back() */
  int64_t calls_left;     /* OpenCL calls until every one fails with `injected`; negative: none fails */
  cl_int injected;
  char label[192];
};

/* Returns STRATUS_OK for CL_SUCCESS. Otherwise it returns the status that stands for the error, with the names of call and error in the
 * message. */
stratus_status stratus_device_check(stratus_context* context, stratus_device* device, const char* call, cl_int error);
/* Returns the error that a test injects into the next call, else CL_SUCCESS. */
cl_int stratus_device_next_error(stratus_device* device);
/* Checks an OpenCL call, which is evaluated only if no test injects an error. */
#define CALL(context, device, name, call)                                                                                                  \
  stratus_device_check(context, device, name, stratus_device_next_error(device) != CL_SUCCESS ? (device)->injected : (call))

/* Enclose calls that drivers may not be made for if several threads make them at once: finding devices, and the first use of one. Nothing
 * of the caller's, such as an allocator, may be called in between. */
void stratus_device_enter(void);
void stratus_device_leave(void);

/* Frees all programs and kernels. */
void stratus_device_programs_release(stratus_device* device);

#endif
