/* SPDX-License-Identifier: BSD-3-Clause
 * An allocator for tests. It counts live allocations, and refuses one call. */
#ifndef STRATUS_FAULTY_ALLOCATOR_H
#define STRATUS_FAULTY_ALLOCATOR_H

#include "stratus.h"

#include <stdlib.h>

typedef struct faulty_allocator {
  int64_t calls;   /* so far */
  int64_t live;    /* allocations minus releases */
  int64_t fail_at; /* number of the call that is refused, from 1; 0: none */
} faulty_allocator;

static inline void* faulty_allocate(void* user, size_t bytes)
{
  faulty_allocator* allocator = (faulty_allocator*)user;
  if (++allocator->calls == allocator->fail_at) {
    return NULL;
  }
  /* aligned_alloc() needs a size that is a multiple of the alignment. */
  void* memory = bytes > SIZE_MAX - 63 ? NULL : aligned_alloc(64, (bytes + 63) / 64 * 64);
  allocator->live += memory != NULL;
  return memory;
}

static inline void faulty_release(void* user, void* memory)
{
  faulty_allocator* allocator = (faulty_allocator*)user;
  allocator->live -= memory != NULL;
  free(memory);
}

static inline stratus_context_options faulty_options(faulty_allocator* allocator, const char* device)
{
  stratus_context_options options = stratus_context_options_default();
  options.device = device;
  options.allocate = faulty_allocate;
  options.release = faulty_release;
  options.allocator_user = allocator;
  return options;
}

#endif
