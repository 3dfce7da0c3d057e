/* SPDX-License-Identifier: BSD-3-Clause
 * The services of a context: memory, the message of a failure, the log, progress, and the clock. */
#define _POSIX_C_SOURCE 200809L
#include "base.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

stratus_status stratus_fail(stratus_context* context, stratus_status status, const char* format, ...)
{
  /* The text is formatted in a buffer of its own first: an argument may point into the message. */
  char text[sizeof context->message];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  memcpy(context->message, text, sizeof text);
  return status;
}

void stratus_log(stratus_context* context, stratus_log_level level, const char* format, ...)
{
  if (!context->options.log) {
    return;
  }
  char line[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  context->options.log(context->options.log_user, level, line);
}

stratus_status stratus_progress(stratus_context* context, const char* stage, double fraction)
{
  if (context->options.progress && context->options.progress(context->options.progress_user, stage, fraction)) {
    return stratus_fail(context, STRATUS_CANCELLED, "cancelled during %s", stage);
  }
  return STRATUS_OK;
}

stratus_status stratus_product(stratus_context* context, const char* what, size_t a, size_t b, size_t c, size_t* product)
{
  size_t ab;
  if (__builtin_mul_overflow(a, b, &ab) || __builtin_mul_overflow(ab, c, product)) {
    return stratus_fail(context, STRATUS_OVERFLOW, "%s: %zu x %zu x %zu exceeds the address space of %zu", what, a, b, c, SIZE_MAX);
  }
  return STRATUS_OK;
}

stratus_status stratus_array_check(stratus_context* context, const char* what, size_t count, size_t size)
{
  const size_t most = PTRDIFF_MAX / size;
  return count <= most ? STRATUS_OK
                       : stratus_fail(context, STRATUS_OVERFLOW, "%zu %s exceed the %zu that an array holds", count, what, most);
}

stratus_status stratus_allocate(stratus_context* context, size_t count, size_t size, void** memory)
{
  size_t bytes = 0;
  TRY(stratus_product(context, "allocation", count, size, 1, &bytes));
  void* result = bytes > SIZE_MAX / 2 ? NULL : context->options.allocate(context->options.allocator_user, bytes ? bytes : 1);
  if (!result) {
    return stratus_fail(context, STRATUS_OUT_OF_MEMORY, "out of memory: %zu bytes refused", bytes);
  }
  *memory = result;
  return STRATUS_OK;
}

stratus_status stratus_allocate_zero(stratus_context* context, size_t count, size_t size, void** memory)
{
  TRY(stratus_allocate(context, count, size, memory));
  memset(*memory, 0, count * size);
  return STRATUS_OK;
}

void stratus_release(stratus_context* context, void* memory)
{
  if (memory) {
    context->options.release(context->options.allocator_user, memory);
  }
}

double stratus_now_ms(void)
{
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

double stratus_thread_ms(void)
{
  struct timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}
