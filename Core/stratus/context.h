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
  STRATUS_OVERFLOW,         /* the byte size or item count of an array does not fit the address space */
  STRATUS_OUT_OF_MEMORY,    /* the allocator or the device returned nothing */
  STRATUS_CANCELLED,        /* the progress callback asked to stop; output arrays are undefined, objects stay usable */
  STRATUS_NO_DEVICE,        /* no such OpenCL device */
  STRATUS_DEVICE_ERROR,     /* an OpenCL call failed, or the device disappeared */
  STRATUS_UNSUPPORTED,      /* the request is valid, but this build or method does not implement it */
  STRATUS_FILE_ERROR        /* a file cannot be written; the message has the system's words */
} stratus_status;

/* Return the English name of a status. Never NULL. */
STRATUS_API const char* stratus_status_name(stratus_status status);

/* Return a hash of `size` bytes. Each seed gives another hash. Callers may use it to recognise content, and so leave a revision unchanged.
 * bytes NULL counts as no bytes. The hash does not protect against content that was made to collide. */
STRATUS_API uint64_t stratus_hash(const void* bytes, size_t size, uint64_t seed);

typedef struct stratus_context stratus_context;

typedef enum stratus_log_level { STRATUS_LOG_DEBUG, STRATUS_LOG_INFO, STRATUS_LOG_WARNING } stratus_log_level;

typedef void* (*stratus_allocate_function)(void* user, size_t bytes); /* returns memory aligned to at least 64 bytes, or NULL */
typedef void (*stratus_release_function)(void* user, void* memory);   /* accepts NULL */
typedef void (*stratus_log_function)(void* user, stratus_log_level level, const char* line);
/* Reports progress. stage: a short name ("value ranges", "ray cast"); fraction: 0..1. A non-zero result cancels the call. The core calls
 * this function on the thread that called the core, never on a worker. */
typedef int (*stratus_progress_function)(void* user, const char* stage, double fraction);

typedef struct stratus_context_options {
  /* "auto" or NULL: the host or an OpenCL GPU, whichever draws a small image faster (docs/devices.md). "host": plain C. Otherwise the
   * device's index for stratus_device_name(), or a part of its name in upper or lower case. Default "auto". */
  const char* device;
  int threads;                        /* threads on the host, 1..1024; 0: as many as OpenMP offers. Default 0. */
  stratus_allocate_function allocate; /* give both functions or neither. Default: the C library. */
  stratus_release_function release;
  void* allocator_user;
  stratus_log_function log; /* default: silent */
  void* log_user;
  stratus_progress_function progress; /* default: none */
  void* progress_user;
  /* Folder that keeps built OpenCL programs for later contexts and processes. It is created if missing. A folder that cannot be used is not
   * an error. At most 959 characters; "": programs are not kept. NULL (default): `programs-1` in the cache folder of docs/devices.md; for
   * PoCL programs are not kept, because PoCL keeps them itself. */
  const char* program_folder;
} stratus_context_options;

/* Return options with their defaults. */
STRATUS_API stratus_context_options stratus_context_options_default(void);

/* Create a context. options may be NULL. If the call fails, *context is NULL, and `message`, if not NULL, receives the reason, cut to
 * `capacity` bytes. */
STRATUS_API stratus_status stratus_context_create(
  const stratus_context_options* options, stratus_context** context, char* message, size_t capacity);
/* Destroy a context. Destroy its objects first. */
STRATUS_API void stratus_context_destroy(stratus_context* context);

/* Return the reason of the last failure on this context, "" before the first. The string is valid until the next call. */
STRATUS_API const char* stratus_context_message(const stratus_context* context);
/* Return the name of the device in use, such as "host (AVX-512, 2 threads)" for plain C. */
STRATUS_API const char* stratus_context_device(const stratus_context* context);
/* Return 1 if an OpenCL device draws, 0 if the host does. */
STRATUS_API int stratus_context_on_device(const stratus_context* context);
/* Return the number of threads on the host. */
STRATUS_API int stratus_context_threads(const stratus_context* context);

/* OpenCL programs of a context. The first image that needs a program waits for it. */
typedef struct stratus_program_statistics {
  uint64_t built, loaded;   /* programs compiled from source; programs read from the folder of built programs */
  double build_ms, load_ms; /* total times of both */
} stratus_program_statistics;

/* Fill in the context's statistics; zeros for a NULL context. */
STRATUS_API void stratus_context_get_programs(const stratus_context* context, stratus_program_statistics* statistics);

/* A stage of building: all work that was done under one name at one place since the report was started. */
typedef struct stratus_build_stage {
  /* "value ranges", "occupancy", "distance map", "effective voxels", "density", "tree shape", "tree leaves" (bricks and fields),
   * "hierarchy", "distance field", "partition", "visibility order", "visibility signs", "visibility peeling", "cells and border" (of a mesh
   * that is drawn). A constant. */
  const char* name;
  const char* where; /* stratus_context_device() if the device ran kernels for it, otherwise "host"; valid as long as the context */
  double ms;         /* elapsed time without the stages within it; includes compiling a program for it */
  uint64_t bytes;    /* size of the result */
  uint64_t kernels;  /* number of kernels launched; 0 on the host */
} stratus_build_stage;

/* Largest number of stages in a report. */
#define STRATUS_BUILD_STAGES_MAX 32

/* Empty the context's report. Later calls add to it if they succeed and create value ranges, occupancy, distance maps, voxels, trees,
 * distance fields, partitions or visibility orders, sort visibility orders, or prepare a mesh for drawing. A new context's report is empty.
 * Accepts NULL. */
STRATUS_API void stratus_context_start_build_report(stratus_context* context);
/* Copy the report's first `capacity` stages, in the order in which they first ended: a stage follows the stages within it. stages may be
 * NULL. Returns the number of all stages in the report, 0 for a NULL context. */
STRATUS_API int stratus_context_get_build_report(const stratus_context* context, stratus_build_stage* stages, int capacity);

/* Return the number of OpenCL devices of all platforms, in the order in which the loader lists them; 0 if there is no platform. */
STRATUS_API int stratus_device_count(void);
/* Copy the name of device `index`, 0..count-1, cut to `capacity` bytes. Another index gives STRATUS_NO_DEVICE. */
STRATUS_API stratus_status stratus_device_name(int index, char* name, size_t capacity);

#ifdef __cplusplus
}
#endif

#endif
