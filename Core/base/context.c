/* SPDX-License-Identifier: BSD-3-Clause
 * Creation and destruction of a context: its options, its device and its threads. */
#define _POSIX_C_SOURCE 200809L
#include "device_choice.h"
#include "instruction_set.h"
#include "program_cache.h"

#include <omp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define THREADS_MAX 1024

#define TEXT_OF(number) #number
#define TEXT(number) TEXT_OF(number)

const char* stratus_version(void)
{
  return TEXT(STRATUS_VERSION_MAJOR) "." TEXT(STRATUS_VERSION_MINOR) "." TEXT(STRATUS_VERSION_PATCH);
}

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
    case STRATUS_FILE_ERROR:
      return "file error";
  }
  return "unknown status";
}

#define ALIGNMENT 64

/* Blocks are aligned here, not by posix_memalign(): up to glibc 2.37 that does not take the blocks again that were freed, so that a program
 * that draws time steps grew by all their arrays. The word before a block is what free() takes. The address sanitizer knows the ends of its
 * own blocks only. */
#if defined(__SANITIZE_ADDRESS__)
#define ALIGNS_ITSELF 0
#elif defined(__has_feature)
#define ALIGNS_ITSELF !__has_feature(address_sanitizer)
#else
#define ALIGNS_ITSELF 1
#endif

static void* default_allocate(void* user, size_t bytes)
{
  (void)user;
#if ALIGNS_ITSELF
  char* const block = bytes <= SIZE_MAX - ALIGNMENT ? malloc(bytes + ALIGNMENT) : NULL;
  if (!block) {
    return NULL;
  }
  char* const memory = block + ALIGNMENT - (uintptr_t)block % ALIGNMENT; /* at least the 8 bytes behind that malloc() aligns to */
  memcpy(memory - sizeof block, &block, sizeof block);
  return memory;
#else
  void* memory = NULL;
  return posix_memalign(&memory, ALIGNMENT, bytes) == 0 ? memory : NULL;
#endif
}

static void default_release(void* user, void* memory)
{
  (void)user;
  char* block = memory;
#if ALIGNS_ITSELF
  if (memory) {
    memcpy(&block, (char*)memory - sizeof block, sizeof block);
  }
#endif
  free(block);
}

stratus_context_options stratus_context_options_default(void)
{
  return (stratus_context_options){ .device = "auto", .allocate = default_allocate, .release = default_release };
}

static stratus_status check_options(stratus_context* context, const stratus_context_options* options)
{
  if (context->isa < 0) {
    return stratus_fail(context, STRATUS_UNSUPPORTED,
      "this library was built for its own machine (STRATUS_ISAS=native), and needs %s, which this processor lacks", stratus_isa_name());
  }
  if (options->threads < 0 || options->threads > THREADS_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "threads %d outside 0..%d", options->threads, THREADS_MAX);
  }
  if (!options->allocate != !options->release) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "allocate and release must be given both or neither");
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

  stratus_context draft = { .options = *options, .isa = stratus_isa_best() };
  if (!options->allocate && !options->release) {
    draft.options.allocate = defaults.allocate;
    draft.options.release = defaults.release;
    draft.options.allocator_user = NULL;
  }
  draft.options.device = NULL; /* both are borrowed for this call only */
  draft.options.program_folder = NULL;
  draft.threads = options->threads ? options->threads : omp_get_max_threads();
  draft.threads = draft.threads > THREADS_MAX ? THREADS_MAX : draft.threads;

  status = check_options(&draft, options);
  if (status == STRATUS_OK) {
    status = stratus_program_folder(&draft, options->program_folder, draft.program_folder);
  }
  void* memory = NULL;
  if (status == STRATUS_OK) {
    status = stratus_allocate(&draft, 1, sizeof *context, &memory);
  }
  if (status == STRATUS_OK) {
    context = memory;
    *context = draft;
    status = stratus_device_choose(context, options->device, false);
    if (context->device && !options->program_folder && stratus_programs_are_kept(stratus_device_id(context->device))) {
      context->program_folder[0] = '\0';
    }
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
    (void)stratus_device_close(context->device);
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

void stratus_context_get_programs(const stratus_context* context, stratus_program_statistics* statistics)
{
  if (statistics) {
    *statistics = context ? context->programs : (stratus_program_statistics){ 0 };
  }
}
