/* SPDX-License-Identifier: BSD-3-Clause
 * Buffers at guard pages, and the allocator of contexts. */
#define _DEFAULT_SOURCE
#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>

#define PAGE ((size_t)4096)
#define CANARY 0xc5
#define GARBAGE 0x7b /* as a float 1.3e36 */
#define MOST_GUARDED 20000

static size_t to_pages(size_t bytes)
{
  return (bytes + PAGE - 1) / PAGE * PAGE;
}

/* Maps a page that faults, `pages` bytes, and another page that faults. NULL: the system has no memory left. */
static unsigned char* map_guarded(size_t pages)
{
  unsigned char* base = mmap(NULL, pages + 2 * PAGE, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (base == MAP_FAILED) {
    return NULL;
  }
  if (pages > 0 && mprotect(base + PAGE, pages, PROT_READ | PROT_WRITE) != 0) {
    munmap(base, pages + 2 * PAGE);
    return NULL;
  }
  return base;
}

static fuzz_block* new_block(fuzz* f, size_t bytes)
{
  if (f->block_count == f->block_room) {
    f->block_room = f->block_room ? 2 * f->block_room : 64;
    f->blocks = realloc(f->blocks, f->block_room * sizeof *f->blocks);
  }
  const size_t pages = to_pages(bytes);
  unsigned char* base = map_guarded(pages);
  if (!f->blocks || !base) {
    fprintf(stderr, "stratus-fuzz: the system has no memory left for buffers\n");
    exit(EXIT_FAILURE);
  }
  /* Most over-reads go upwards. A quarter of the buffers catches those that go down. */
  unsigned char* data = fuzz_below(f, 4) > 0 ? base + PAGE + pages - bytes : base + PAGE;
  memset(base + PAGE, CANARY, pages);
  fuzz_block* block = f->blocks + f->block_count++;
  *block = (fuzz_block){ .base = base, .data = data, .total = pages + 2 * PAGE, .bytes = bytes };
  ++f->tally->buffers;
  return block;
}

void* fuzz_output(fuzz* f, size_t bytes)
{
  fuzz_block* block = new_block(f, bytes);
  memset(block->data, GARBAGE, bytes);
  return block->data;
}

const void* fuzz_input(fuzz* f, const void* data, size_t bytes)
{
  fuzz_block* block = new_block(f, bytes);
  if (bytes > 0) {
    memcpy(block->data, data, bytes);
    mprotect(block->base + PAGE, block->total - 2 * PAGE, PROT_READ);
  }
  block->input = true;
  return block->data;
}

void fuzz_change(fuzz* f, const void* input, const void* data)
{
  for (size_t i = 0; i < f->block_count; ++i) {
    fuzz_block* block = f->blocks + i;
    if (block->data == input && block->input && block->bytes > 0) {
      mprotect(block->base + PAGE, block->total - 2 * PAGE, PROT_READ | PROT_WRITE);
      memcpy(block->data, data, block->bytes);
      mprotect(block->base + PAGE, block->total - 2 * PAGE, PROT_READ);
      return;
    }
  }
}

void fuzz_free_blocks(fuzz* f)
{
  for (size_t i = 0; i < f->block_count; ++i) {
    const fuzz_block* block = f->blocks + i;
    const unsigned char *first = block->base + PAGE, *end = block->base + block->total - PAGE;
    for (const unsigned char* p = first; p < end; ++p) {
      p = p == block->data ? p + block->bytes : p;
      EXPECT(p >= end || *p == CANARY, "byte %td of a buffer of %zu was written", p - block->data, block->bytes);
    }
    munmap(block->base, block->total);
  }
  f->block_count = 0;
}

/* ---- allocator of contexts */

typedef struct guarded_header {
  unsigned char* base;
  size_t total, bytes;
} guarded_header;

static void* allocate_guarded(size_t bytes)
{
  const size_t rounded = (bytes + 63) / 64 * 64, pages = to_pages(rounded + 64);
  unsigned char* base = map_guarded(pages);
  if (!base) {
    return NULL;
  }
  unsigned char* data = base + PAGE + pages - rounded;
  memset(data + bytes, CANARY, rounded - bytes);
  const guarded_header header = { base, pages + 2 * PAGE, bytes };
  memcpy(data - 64, &header, sizeof header);
  return data;
}

static void release_guarded(fuzz_memory* memory, unsigned char* data)
{
  guarded_header header;
  memcpy(&header, data - 64, sizeof header);
  for (size_t i = header.bytes; i % 64 != 0; ++i) {
    memory->damaged = memory->damaged || data[i] != CANARY;
  }
  munmap(header.base, header.total);
}

static void* allocate(void* user, size_t bytes)
{
  fuzz_memory* memory = user;
  void* data = NULL;
  if (++memory->calls == memory->fail_at) {
    ++memory->refused;
    return NULL;
  }
  if (bytes > (size_t)1 << 32) {
    return NULL;
  }
  /* With posix_memalign() the address sanitizer knows the length to the byte. */
  if (memory->guarded) {
    data = allocate_guarded(bytes);
  } else if (posix_memalign(&data, 64, bytes) != 0) {
    data = NULL;
  }
  if (data) {
    ++memory->live;
    memset(data, memory->fill, bytes);
  }
  return data;
}

static void release(void* user, void* data)
{
  fuzz_memory* memory = user;
  if (data) {
    --memory->live;
    if (memory->guarded) {
      release_guarded(memory, data);
    } else {
      free(data);
    }
  }
}

static int progress(void* user, const char* stage, double fraction)
{
  fuzz_progress* p = user;
  p->wrong = p->wrong || !stage || !*stage || !(fraction >= 0.0 && fraction <= 1.0);
  const bool cancel = ++p->calls == p->cancel_at;
  p->cancelled += cancel;
  return cancel;
}

static void log_line(void* user, stratus_log_level level, const char* line)
{
  fuzz_progress* p = user;
  p->wrong = p->wrong || !line || strlen(line) >= 1024 || (unsigned)level > STRATUS_LOG_WARNING;
}

stratus_context_options fuzz_context_options(fuzz* f, fuzz_memory* memory)
{
  static const int fills[] = { 0x00, 0xff, 0x7b, 0xbe, 0x01 };
  *memory = (fuzz_memory){ .fill = fills[fuzz_below(f, 5)], .guarded = fuzz_below(f, 6) == 0 };
  stratus_context_options options = stratus_context_options_default();
  options.device = f->device;
  options.threads = fuzz_chance(f, 0.75) ? 1 : 2 + (int)fuzz_below(f, 3);
  options.allocate = allocate;
  options.release = release;
  options.allocator_user = memory;
  options.progress = progress;
  options.progress_user = &f->progress;
  options.log = fuzz_chance(f, 0.5) ? log_line : NULL;
  options.log_user = &f->progress;
  return options;
}

stratus_context* fuzz_context(fuzz* f, fuzz_memory* memory)
{
  const stratus_context_options options = fuzz_context_options(f, memory);
  stratus_context* context = NULL;
  char message[256];
  const stratus_status status = CALL(stratus_context_create(FUZZ_INPUT(f, options), &context, message, sizeof message));
  EXPECT(status == STRATUS_OK && context, "no context: %s", message);
  return context;
}

void fuzz_context_close(fuzz* f, stratus_context* context, fuzz_memory* memory)
{
  CALL(stratus_context_destroy(context));
  EXPECT(memory->live == 0, "%lld allocations are left", (long long)memory->live);
  EXPECT(!memory->damaged, "the bytes behind an allocation were written");
  EXPECT(!f->progress.wrong, "progress without a stage, or beyond 0..1, or a line of no log");
}
