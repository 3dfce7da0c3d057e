/* SPDX-License-Identifier: BSD-3-Clause
 * Context: device choice, allocation, messages, log and progress. */
#define _POSIX_C_SOURCE 200809L
#include "device.h"
#include "base.h"
#include "ray_cast_host.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define THREADS_MAX 1024

const char* stratus_status_name(stratus_status status)
{
  switch (status) {
    case STRATUS_OK:
      return "ok";
    case STRATUS_INVALID_ARGUMENT:
      return "invalid argument";
    case STRATUS_OVERFLOW:
      return "overflow";
    case STRATUS_OUT_OF_MEMORY:
      return "out of memory";
    case STRATUS_CANCELLED:
      return "cancelled";
    case STRATUS_NO_DEVICE:
      return "no such device";
    case STRATUS_DEVICE_ERROR:
      return "device error";
    case STRATUS_UNSUPPORTED:
      return "unsupported";
  }
  return "unknown status";
}

static void* default_allocate(void* user, size_t bytes)
{
  (void)user;
  void* memory = NULL;
  return posix_memalign(&memory, 64, bytes) == 0 ? memory : NULL;
}

static void default_release(void* user, void* memory)
{
  (void)user;
  free(memory);
}

stratus_context_options stratus_context_options_default(void)
{
  return (stratus_context_options){ .device = "auto", .allocate = default_allocate, .release = default_release };
}

stratus_status stratus_fail(stratus_context* context, stratus_status status, const char* format, ...)
{
  /* Formatted apart first: an argument may point into the message itself. */
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

static stratus_status check_options(stratus_context* context, const stratus_context_options* options)
{
  if (options->threads < 0 || options->threads > THREADS_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "threads %d outside 0..%d", options->threads, THREADS_MAX);
  }
  if (!options->allocate != !options->release) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "allocate and release must be given both or neither");
  }
  return STRATUS_OK;
}

static stratus_status choose_device(stratus_context* context, const char* selector)
{
  if (!selector || !*selector) {
    selector = "auto";
  }
  if (strcmp(selector, "host") != 0) {
    TRY(stratus_device_open(context, selector, &context->device));
  }
  if (context->device) {
    snprintf(context->device_name, sizeof context->device_name, "%s", stratus_device_label(context->device));
  } else {
    snprintf(context->device_name, sizeof context->device_name, "host (%s, %d thread%s)", stratus_ray_cast_isa(), context->threads,
      context->threads == 1 ? "" : "s");
    if (strcmp(selector, "auto") == 0) {
      stratus_log(
        context, STRATUS_LOG_INFO, "no OpenCL GPU among %d device(s): drawing on the %s", stratus_device_count(), context->device_name);
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_context_create(const stratus_context_options* options, stratus_context** out, char* message, size_t capacity)
{
  const stratus_context_options defaults = stratus_context_options_default();
  stratus_context* context = NULL;
  stratus_status status = STRATUS_OK;

  if (message && capacity) {
    message[0] = '\0';
  }
  if (!out) {
    if (message && capacity) {
      snprintf(message, capacity, "no place for the context: its address is NULL");
    }
    return STRATUS_INVALID_ARGUMENT;
  }
  *out = NULL;
  if (!options) {
    options = &defaults;
  }

  stratus_context draft = { .options = *options, .isa = stratus_ray_cast_best_isa() };
  if (!options->allocate && !options->release) {
    draft.options.allocate = defaults.allocate;
    draft.options.release = defaults.release;
    draft.options.allocator_user = NULL;
  }
  draft.options.device = NULL; /* borrowed for this call only */
  draft.threads = options->threads ? options->threads : omp_get_max_threads();
  draft.threads = draft.threads > THREADS_MAX ? THREADS_MAX : draft.threads;

  status = check_options(&draft, options);
  void* memory = NULL;
  if (status == STRATUS_OK) {
    status = stratus_allocate(&draft, 1, sizeof *context, &memory);
  }
  if (status == STRATUS_OK) {
    context = memory;
    *context = draft;
    status = choose_device(context, options->device);
    draft = *context;
  }
  if (status != STRATUS_OK) {
    if (message && capacity) {
      snprintf(message, capacity, "%s", draft.message);
    }
    stratus_context_destroy(context);
    return status;
  }
  *out = context;
  return STRATUS_OK;
}

void stratus_context_destroy(stratus_context* context)
{
  if (context) {
    stratus_device_close(context->device);
    const stratus_context_options options = context->options;
    options.release(options.allocator_user, context);
  }
}

const char* stratus_context_message(const stratus_context* context)
{
  return context ? context->message : "no context";
}

const char* stratus_context_device(const stratus_context* context)
{
  return context ? context->device_name : "";
}

int stratus_context_on_device(const stratus_context* context)
{
  return context && context->device;
}

int stratus_context_threads(const stratus_context* context)
{
  return context ? context->threads : 0;
}
