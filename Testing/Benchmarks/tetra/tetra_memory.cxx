// SPDX-License-Identifier: BSD-3-Clause
#include "tetra_bench.h"

#include <cstdlib>

namespace bench {

namespace {
constexpr size_t header = 64; // keeps the alignment, and holds the size
}

counted_context::counted_context(int threads)
{
  stratus_context_options options = stratus_context_options_default();
  char message[512];
  options.device = "host";
  options.threads = threads;
  options.allocate = allocate;
  options.release = release;
  options.allocator_user = this;
  if (stratus_context_create(&options, &this->Context, message, sizeof message) != STRATUS_OK) {
    throw failure(message);
  }
}

counted_context::~counted_context()
{
  stratus_context_destroy(this->Context);
}

void* counted_context::allocate(void* user, size_t bytes)
{
  auto* self = static_cast<counted_context*>(user);
  if (bytes > SIZE_MAX - 2 * header) {
    return nullptr;
  }
  void* memory = std::aligned_alloc(header, (bytes + 2 * header - 1) / header * header);
  if (!memory) {
    return nullptr;
  }
  *static_cast<size_t*>(memory) = bytes;
  const size_t live = self->Live += bytes;
  for (size_t peak = self->Peak; peak < live && !self->Peak.compare_exchange_weak(peak, live);) {}
  return static_cast<char*>(memory) + header;
}

void counted_context::release(void* user, void* memory)
{
  if (memory) {
    auto* self = static_cast<counted_context*>(user);
    void* whole = static_cast<char*>(memory) - header;
    self->Live -= *static_cast<size_t*>(whole);
    std::free(whole);
  }
}
} // namespace bench
