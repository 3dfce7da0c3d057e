/* SPDX-License-Identifier: BSD-3-Clause
 * Statuses, the context that every call takes, and OpenCL devices. */
#ifndef STRATUS_PUBLIC_CONTEXT_H
#define STRATUS_PUBLIC_CONTEXT_H

#include "version.h"

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum stratus_status {
  STRATUS_OK = 0,
  STRATUS_INVALID_ARGUMENT, /* a value out of its range; the message names value and range */
  STRATUS_OVERFLOW,         /* a product of sizes does not fit the address space */
  STRATUS_OUT_OF_MEMORY,    /* the allocator or the device returned nothing */
  STRATUS_CANCELLED,        /* the progress callback asked to stop; outputs are undefined, objects intact */
  STRATUS_NO_DEVICE,        /* no such OpenCL device */
  STRATUS_DEVICE_ERROR,     /* an OpenCL call failed, or the device disappeared */
  STRATUS_UNSUPPORTED       /* understood, but not built */
} stratus_status;

/* English name of a status, never NULL. */
STRATUS_API const char* stratus_status_name(stratus_status status);

typedef struct stratus_context stratus_context;

typedef enum stratus_log_level { STRATUS_LOG_DEBUG, STRATUS_LOG_INFO, STRATUS_LOG_WARNING } stratus_log_level;

typedef void* (*stratus_allocate_function)(void* user, size_t bytes); /* at least 64-byte aligned, or NULL */
typedef void (*stratus_release_function)(void* user, void* memory);   /* takes NULL */
typedef void (*stratus_log_function)(void* user, stratus_log_level level, const char* line);
/* stage: a short name ("value ranges", "ray cast"); fraction 0..1. Return non-zero to cancel. Called on the thread
 * that called the core, never from a worker. */
typedef int (*stratus_progress_function)(void* user, const char* stage, double fraction);

typedef struct stratus_context_options {
  /* "auto" (or NULL): the first OpenCL GPU, else the host; "host": plain C; else the index of stratus_device_name(),
   * or a part of its name, any case. Default "auto". */
  const char* device;
  int threads;                        /* of the host, 1..1024; 0: as many as OpenMP would take. Default 0. */
  stratus_allocate_function allocate; /* both or neither; default: the C library */
  stratus_release_function release;
  void* allocator_user;
  stratus_log_function log; /* default: silent */
  void* log_user;
  stratus_progress_function progress; /* default: none */
  void* progress_user;
} stratus_context_options;

STRATUS_API stratus_context_options stratus_context_options_default(void);

/* options may be NULL. On failure *context is NULL and `message`, if not NULL, gets up to `capacity` bytes of reason. */
STRATUS_API stratus_status stratus_context_create(
  const stratus_context_options* options, stratus_context** context, char* message, size_t capacity);
STRATUS_API void stratus_context_destroy(stratus_context* context);

/* Why the last failing call on this context failed; "" before any failure. Valid until the next call. */
STRATUS_API const char* stratus_context_message(const stratus_context* context);
/* Name of the device in use, "host (AVX-512, 2 threads)" for plain C. */
STRATUS_API const char* stratus_context_device(const stratus_context* context);
/* 1 if an OpenCL device draws, 0 if the host does. */
STRATUS_API int stratus_context_on_device(const stratus_context* context);
STRATUS_API int stratus_context_threads(const stratus_context* context);

/* All OpenCL devices of all platforms, in the loader's order; 0 where there is no platform. */
STRATUS_API int stratus_device_count(void);
/* Copies the name of device 0..count-1, cut to capacity; returns STRATUS_NO_DEVICE beyond. */
STRATUS_API stratus_status stratus_device_name(int index, char* name, size_t capacity);

#ifdef __cplusplus
}
#endif

#endif
