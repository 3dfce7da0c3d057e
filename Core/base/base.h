/* SPDX-License-Identifier: BSD-3-Clause
 * The context and its services, which all files of the core use. Room headers are never installed; outside of Core/ only tests include
 * them. */
#ifndef STRATUS_BASE_H
#define STRATUS_BASE_H

#include "build_report.h"
#include "cache_folder.h"
#include "stratus/camera.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>

typedef struct stratus_device stratus_device;

struct stratus_context {
  stratus_context_options options; /* `device` and `program_folder` are not kept, but device_name and the copy below */
  int threads;
  stratus_device* device; /* NULL: the host draws */
  int isa;                /* best instruction set that host code may use: 2 AVX-512, 1 AVX2, 0 any; tests lower it */
  stratus_program_statistics programs;
  stratus_build_report report;
  char program_folder[STRATUS_CACHE_PATH]; /* of built OpenCL programs; "": they are not kept */
  char device_name[256];
  char message[1024];
};

/* Returns from the calling function with the status of a failed call. For functions that hold nothing to release. */
#define TRY(call)                                                                                                                          \
  do {                                                                                                                                     \
    const stratus_status try_status = (call);                                                                                              \
    if (try_status != STRATUS_OK) {                                                                                                        \
      return try_status;                                                                                                                   \
    }                                                                                                                                      \
  } while (0)

/* Does the same in functions with a variable `status` and a label `cleanup`. */
#define TRY_CLEANUP(call)                                                                                                                  \
  do {                                                                                                                                     \
    status = (call);                                                                                                                       \
    if (status != STRATUS_OK) {                                                                                                            \
      goto cleanup;                                                                                                                        \
    }                                                                                                                                      \
  } while (0)

/* ---- services.c */

/* Formats the context's message, and returns `status`. */
stratus_status stratus_fail(stratus_context* context, stratus_status status, const char* format, ...) __attribute__((format(printf, 3, 4)));
void stratus_log(stratus_context* context, stratus_log_level level, const char* format, ...) __attribute__((format(printf, 3, 4)));
/* Reports progress. Returns STRATUS_CANCELLED if the caller's callback asks to stop. */
stratus_status stratus_progress(stratus_context* context, const char* stage, double fraction);
/* Sets *memory to count*size bytes (at least 1), 64-byte aligned, not cleared. Fails with STRATUS_OVERFLOW or STRATUS_OUT_OF_MEMORY, and a
 * message. */
stratus_status stratus_allocate(stratus_context* context, size_t count, size_t size, void** memory);
stratus_status stratus_allocate_zero(stratus_context* context, size_t count, size_t size, void** memory);
void stratus_release(stratus_context* context, void* memory);
/* Sets *product to a*b*c. STRATUS_OVERFLOW, with `what` in the message, if it does not fit. */
stratus_status stratus_product(stratus_context* context, const char* what, size_t a, size_t b, size_t c, size_t* product);
/* Returns STRATUS_OVERFLOW if no array can hold `count` items of `size` bytes. `what` names them in the message, such as "points". */
stratus_status stratus_array_check(stratus_context* context, const char* what, size_t count, size_t size);
double stratus_now_ms(void); /* monotonic clock, milliseconds */
/* Returns the milliseconds that the calling thread has run. Work of other threads and programs does not count. */
double stratus_thread_ms(void);

#endif
