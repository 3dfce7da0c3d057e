/* SPDX-License-Identifier: BSD-3-Clause
 * What all files of the core share: the context and its services. Rooms' headers are never installed; only tests include them from
 * outside of Core/. */
#ifndef STRATUS_BASE_H
#define STRATUS_BASE_H

#include "stratus/camera.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>

typedef struct stratus_device stratus_device;

struct stratus_context {
  stratus_context_options options; /* device is not kept: see device_name */
  int threads;
  stratus_device* device; /* NULL: the host draws */
  int isa;                /* of the host's traversal at most: 2 AVX-512, 1 AVX2, 0 any; tests lower it */
  char device_name[256];
  char message[1024];
};

/* Returns at once with the status of a call that failed. For functions that hold nothing to release. */
#define TRY(call)                                                                                                                          \
  do {                                                                                                                                     \
    const stratus_status try_status = (call);                                                                                              \
    if (try_status != STRATUS_OK) {                                                                                                        \
      return try_status;                                                                                                                   \
    }                                                                                                                                      \
  } while (0)

/* The same for functions with a `status` and a `cleanup:` label. */
#define TRY_CLEANUP(call)                                                                                                                  \
  do {                                                                                                                                     \
    status = (call);                                                                                                                       \
    if (status != STRATUS_OK) {                                                                                                            \
      goto cleanup;                                                                                                                        \
    }                                                                                                                                      \
  } while (0)

/* ---- services.c */

/* Leaves the message and returns the status. */
stratus_status stratus_fail(stratus_context* context, stratus_status status, const char* format, ...) __attribute__((format(printf, 3, 4)));
void stratus_log(stratus_context* context, stratus_log_level level, const char* format, ...) __attribute__((format(printf, 3, 4)));
/* STRATUS_CANCELLED if the caller's callback says so. */
stratus_status stratus_progress(stratus_context* context, const char* stage, double fraction);
/* count*size bytes (at least 1), 64-byte aligned, not cleared. Sets *memory; STRATUS_OVERFLOW, STRATUS_OUT_OF_MEMORY with a message. */
stratus_status stratus_allocate(stratus_context* context, size_t count, size_t size, void** memory);
stratus_status stratus_allocate_zero(stratus_context* context, size_t count, size_t size, void** memory);
void stratus_release(stratus_context* context, void* memory);
/* a*b*c into *product; STRATUS_OVERFLOW with `what` in the message. */
stratus_status stratus_product(stratus_context* context, const char* what, size_t a, size_t b, size_t c, size_t* product);
/* STRATUS_OVERFLOW where `count` items of `size` bytes, "points" say, can't be in any array. */
stratus_status stratus_array_check(stratus_context* context, const char* what, size_t count, size_t size);
double stratus_now_ms(void); /* monotonic clock */

#endif
