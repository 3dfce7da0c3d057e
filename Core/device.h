/* SPDX-License-Identifier: BSD-3-Clause
 * OpenCL, as the core uses it. Every call that fails leaves the OpenCL error's name in the context's message. */
#ifndef STRATUS_DEVICE_LAYER_H
#define STRATUS_DEVICE_LAYER_H

#include "internal.h"

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

/* selector: "auto" (first GPU; none: STRATUS_OK and *device NULL), a decimal index, or a part of a name, any case. */
stratus_status stratus_device_open(stratus_context* context, const char* selector, stratus_device** device);
void stratus_device_close(stratus_device* device); /* takes NULL */

const char* stratus_device_label(const stratus_device* device);
bool stratus_device_is_cpu(const stratus_device* device);
bool stratus_device_has_double(const stratus_device* device);
size_t stratus_device_largest_allocation(const stratus_device* device);

/* Kernel `kernel` of the embedded source `source` (its file's name without .cl) built with `defines` ("-DA=1 -DB=2"). Programs and kernels are
 * cached in the device by source and defines; the kernel belongs to the cache. A failed build leaves the build log in the message. */
stratus_status stratus_device_kernel(
  stratus_context* context, const char* source, const char* defines, const char* kernel, cl_kernel* result);

/* A buffer of `bytes` (at least 1). `host` NULL: not initialised. Else copied from, or, where device and host share memory (`borrow`), used in
 * place: then `host` must outlive the buffer. */
stratus_status stratus_device_buffer(
  stratus_context* context, cl_mem_flags access, size_t bytes, const void* host, bool borrow, cl_mem* buffer);
void stratus_device_buffer_release(cl_mem buffer); /* takes NULL */
stratus_status stratus_device_write(stratus_context* context, cl_mem buffer, size_t offset, size_t bytes, const void* host);
stratus_status stratus_device_read(stratus_context* context, cl_mem buffer, size_t offset, size_t bytes, void* host); /* blocks */

/* Sets argument `index`. */
stratus_status stratus_device_argument(stratus_context* context, cl_kernel kernel, unsigned index, size_t size, const void* value);
/* Enqueues over `global` items in groups of `local` (both `dimensions` long, local fixed by the caller, global rounded up by it). In order. */
stratus_status stratus_device_run(
  stratus_context* context, cl_kernel kernel, unsigned dimensions, const size_t* global, const size_t* local);
stratus_status stratus_device_finish(stratus_context* context);

#endif
