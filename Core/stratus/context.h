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
  STRATUS_UNSUPPORTED       /* the request is valid, but this build or method does not implement it */
} stratus_status;

/* English name of a status, never NULL. */
STRATUS_API const char* stratus_status_name(stratus_status status);

/* Returns a hash of `size` bytes, another one for each seed: callers may know content again by it, to leave a revision as it is. bytes
 * NULL: none. It is no defence against content that is made to collide. */
STRATUS_API uint64_t stratus_hash(const void* bytes, size_t size, uint64_t seed);

typedef struct stratus_context stratus_context;

typedef enum stratus_log_level { STRATUS_LOG_DEBUG, STRATUS_LOG_INFO, STRATUS_LOG_WARNING } stratus_log_level;

typedef void* (*stratus_allocate_function)(void* user, size_t bytes); /* returns memory aligned to 64 bytes at least, or NULL */
typedef void (*stratus_release_function)(void* user, void* memory);   /* takes NULL */
typedef void (*stratus_log_function)(void* user, stratus_log_level level, const char* line);
/* stage: a short name ("value ranges", "ray cast"); fraction: 0..1. A non-zero result cancels the call. The core calls this function on the
 * thread that called the core, never on a worker. */
typedef int (*stratus_progress_function)(void* user, const char* stage, double fraction);

typedef struct stratus_context_options {
  /* "auto" or NULL: the host or an OpenCL GPU, whichever draws a small picture faster (docs/devices.md). "host": plain C. Otherwise the
   * device's index for stratus_device_name(), or a part of its name in any case. Default "auto". */
  const char* device;
  int threads;                        /* threads on the host, 1..1024; 0: as many as OpenMP offers. Default 0. */
  stratus_allocate_function allocate; /* give both functions or neither. Default: the C library. */
  stratus_release_function release;
  void* allocator_user;
  stratus_log_function log; /* default: silent */
  void* log_user;
  stratus_progress_function progress; /* default: none */
  void* progress_user;
  /* Folder in which built OpenCL programs are kept for later contexts and processes; it is made if it is not there, and nothing that is
   * wrong with it is an error. At most 959 characters; "": nothing is kept. NULL, the default: `programs-1` in the folder that
   * docs/devices.md tells, but nothing for PoCL, which keeps programs itself. */
  const char* program_folder;
} stratus_context_options;

STRATUS_API stratus_context_options stratus_context_options_default(void);

/* Creates a context. options may be NULL. On failure *context is NULL, and `message`, if not NULL, receives the reason, cut to `capacity`
 * bytes. */
STRATUS_API stratus_status stratus_context_create(
  const stratus_context_options* options, stratus_context** context, char* message, size_t capacity);
STRATUS_API void stratus_context_destroy(stratus_context* context);

/* Returns the reason of the last failure on this context, "" before the first. The string is valid until the next call. */
STRATUS_API const char* stratus_context_message(const stratus_context* context);
/* Returns the name of the device in use, such as "host (AVX-512, 2 threads)" for plain C. */
STRATUS_API const char* stratus_context_device(const stratus_context* context);
/* Returns 1 if an OpenCL device draws, 0 if the host does. */
STRATUS_API int stratus_context_on_device(const stratus_context* context);
/* Returns the number of threads on the host. */
STRATUS_API int stratus_context_threads(const stratus_context* context);

/* OpenCL programs of a context. The first picture that needs one waits for it. */
typedef struct stratus_program_statistics {
  uint64_t built, loaded;   /* compiled from source; taken from the folder of built programs */
  double build_ms, load_ms; /* times of all of these */
} stratus_program_statistics;

/* Fills in the context's statistics; zeros for NULL. */
STRATUS_API void stratus_context_get_programs(const stratus_context* context, stratus_program_statistics* statistics);

/* A stage of building: all that was done under one name at one place since the report was started. */
typedef struct stratus_build_stage {
  /* "value ranges", "occupancy", "distance map", "effective voxels", "density", "tree shape", "tree leaves" (bricks and fields),
   * "hierarchy", "distance field", "partition", "visibility order", "visibility signs", "visibility peeling", "cells and border" (of a mesh
   * that is drawn). A constant. */
  const char* name;
  const char* where; /* stratus_context_device() if the device ran kernels for it, else "host"; valid as long as the context */
  double ms;         /* on the clock, without that of stages within it; a program that is compiled for it counts */
  uint64_t bytes;    /* of what it made */
  uint64_t kernels;  /* launched; 0 on the host */
} stratus_build_stage;

/* A report has no more stages than this. */
#define STRATUS_BUILD_STAGES_MAX 32

/* Starts the context's report anew. All later calls that create value ranges, occupancy, distance maps, voxels, trees, distance fields,
 * partitions and visibility orders, sort these, or prepare a mesh for drawing, add to it; what fails does not. A new context's report is
 * empty. Takes NULL. */
STRATUS_API void stratus_context_start_build_report(stratus_context* context);
/* Copies the report's first `capacity` stages, in the order in which they first ended: a stage comes behind those within it. Returns the
 * number of all its stages; 0 for NULL. stages may be NULL. */
STRATUS_API int stratus_context_get_build_report(const stratus_context* context, stratus_build_stage* stages, int capacity);

/* Returns the number of OpenCL devices of all platforms, in the order in which the loader lists them; 0 if there is no platform. */
STRATUS_API int stratus_device_count(void);
/* Copies the name of device `index`, 0..count-1, cut to `capacity` bytes. A larger index gives STRATUS_NO_DEVICE. */
STRATUS_API stratus_status stratus_device_name(int index, char* name, size_t capacity);

#ifdef __cplusplus
}
#endif

#endif
