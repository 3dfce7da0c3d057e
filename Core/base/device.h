/* SPDX-License-Identifier: BSD-3-Clause
 * The core's interface to OpenCL. Every call that fails leaves the name of OpenCL's error in the context's message. */
#ifndef STRATUS_DEVICE_H
#define STRATUS_DEVICE_H

#include "base.h"

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

/* More devices than this are not found. */
#define STRATUS_DEVICES_MAX 64

/* Opens a device. selector: a decimal index, or a part of a name in any case. */
stratus_status stratus_device_open(stratus_context* context, const char* selector, stratus_device** device);
stratus_status stratus_device_open_id(stratus_context* context, cl_device_id id, stratus_device** device);
/* Accepts NULL. Returns the status with which its queue ended, as OpenCL reports it. Only this reports a device that is lost after its last
 * result was read. */
cl_int stratus_device_close(stratus_device* device);

/* Lists the devices that "auto" may take, and returns how many they are: GPUs, and with `processors` CPUs, too. */
int stratus_device_candidates(bool processors, cl_device_id ids[STRATUS_DEVICES_MAX]);
/* Writes a device's name and its driver's version. */
void stratus_device_describe(cl_device_id id, char* text, size_t capacity);

/* Returns whether the host is to do what the context's device failed at with `status`: it has no memory for it, or it failed otherwise and
 * "auto" took it. The reason goes to the log. A call of a device that was named fails, if not for want of memory. */
bool stratus_device_hands_back(stratus_context* context, stratus_status status);

/* True if the context's device builds structures: a device that was requested by name, or a GPU that "auto" chose. A CPU's OpenCL that
 * replaces a GPU in tests of "auto" does not: the host builds faster on the same cores. */
bool stratus_device_builds(const stratus_context* context);

const char* stratus_device_label(const stratus_device* device);
cl_device_id stratus_device_id(const stratus_device* device);
bool stratus_device_is_cpu(const stratus_device* device);
bool stratus_device_has_double(const stratus_device* device);
size_t stratus_device_largest_allocation(const stratus_device* device);

/* Get kernel `kernel` of the embedded source `source` (its file's name without .cl), built with `defines` ("-DA=1 -DB=2"). The device
 * caches programs and kernels by source and defines, and owns the kernel. defines NULL: the kernel depends on no define, so that any
 * program of the source serves, if one is built. A failed build leaves its log in the message. */
stratus_status stratus_device_kernel(
  stratus_context* context, const char* source, const char* defines, const char* kernel, cl_kernel* result);
/* Gives a kernel of the caller's `text`. `source` is its name in the cache and in messages. */
stratus_status stratus_device_kernel_from(
  stratus_context* context, const char* source, const char* text, const char* defines, const char* kernel, cl_kernel* result);

/* Create a buffer of `bytes` (at least 1). host NULL: it is not initialised. Otherwise it is a copy of `host`. With `borrow`, and if device
 * and host share memory, it is `host` itself, which must then outlive the buffer. */
stratus_status stratus_device_buffer(
  stratus_context* context, cl_mem_flags access, size_t bytes, const void* host, bool borrow, cl_mem* buffer);
void stratus_device_buffer_release(cl_mem buffer); /* takes NULL */
stratus_status stratus_device_write(stratus_context* context, cl_mem buffer, size_t offset, size_t bytes, const void* host);
stratus_status stratus_device_read(stratus_context* context, cl_mem buffer, size_t offset, size_t bytes, void* host); /* blocks */

/* True if a buffer over `host` is that memory itself, also for kernels that write. After stratus_device_settle() the host sees what they
 * wrote. */
bool stratus_device_lends(const stratus_device* device, const void* host);
stratus_status stratus_device_settle(stratus_context* context, cl_mem buffer, size_t bytes); /* blocks */

/* Sets argument `index` of a kernel. */
stratus_status stratus_device_argument(stratus_context* context, cl_kernel kernel, unsigned index, size_t size, const void* value);
/* Enqueues a kernel, in order. `global` items are rounded up to whole groups of `local` (both have `dimensions` entries, 1..3; local > 0),
 * so that the kernel must ignore items beyond the end. */
stratus_status stratus_device_run(
  stratus_context* context, cl_kernel kernel, unsigned dimensions, const size_t* global, const size_t* local);
stratus_status stratus_device_finish(stratus_context* context);
/* Waits until nothing runs that was enqueued, however it ends. After a failed call kernels may still be writing memory that they borrow. */
void stratus_device_drain(const stratus_context* context);

typedef struct stratus_kernel_argument {
  size_t size;
  const void* value; /* NULL: `size` bytes of local memory */
} stratus_kernel_argument;

#define ARGUMENT(x)                                                                                                                        \
  {                                                                                                                                        \
    sizeof(x), &(x)                                                                                                                        \
  }
#define COUNT_OF(array) (sizeof(array) / sizeof *(array))
/* Items of a group along x. The number is constant because a device compiles a kernel anew for each shape of groups. */
#define STRATUS_DEVICE_GROUP 64

/* Builds kernel `kernel` of `source`, sets its arguments in order, and enqueues it over items[0] x items[1] x items[2]. */
stratus_status stratus_device_launch(stratus_context* context, const char* source, const char* defines, const char* kernel,
  const stratus_kernel_argument* arguments, size_t count, const int64_t items[3]);
/* The same over `groups` work-groups of `group` items in a row. */
stratus_status stratus_device_launch_groups(stratus_context* context, const char* source, const char* defines, const char* kernel,
  const stratus_kernel_argument* arguments, size_t count, size_t groups, size_t group);

/* Returns the text of kernels/<name>.cl with its headers included, NULL if there is none. The build generates it. */
const char* stratus_kernel_source(const char* name);
/* Returns the name of an OpenCL error, such as "CL_OUT_OF_RESOURCES" for -5. */
const char* stratus_device_error_name(int error);

/* For tests: lets `calls` more OpenCL calls through, and makes every later one fail with `error`, as on a device that disappears. The next
 * call of this function ends that; a negative `calls` makes none fail. Calls that release are neither counted nor refused. */
void stratus_device_fail_after(stratus_device* device, int64_t calls, int error);

#endif
