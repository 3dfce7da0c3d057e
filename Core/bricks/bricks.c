/* SPDX-License-Identifier: BSD-3-Clause
 * Arrays whose parts are read when something first reads their values. The kernel stops a thread that reads a page that is not there, and
 * notifies one of the pool's threads (userfaultfd), which reads the part of the page and lets the thread go on. So everything that reads
 * values reads bricks, and what is in memory costs nothing.
 *
 * Each array is a file in memory that is mapped for its readers. Parts are written to the file, and their pages are shown to the readers
 * when they are complete. A page that parts share is shown once all of them are there, and stays.
 *
 * A clock chooses what is dropped: its hand first takes the pages of a part out of the readers' mapping, and drops the part when it comes
 * around again and nothing has read it. */
#define _GNU_SOURCE
#include "bricks.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifdef __linux__
#include <fcntl.h>
#include <linux/userfaultfd.h>
#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#endif
#if defined(UFFDIO_CONTINUE) && defined(SYS_userfaultfd)
#define STRATUS_PAGED 1
#ifndef UFFD_USER_MODE_ONLY
#define UFFD_USER_MODE_ONLY 1
#endif
#endif

#define MEMORY_LEAST ((uint64_t)16 << 20)
#define THREADS_MOST 64

stratus_brick_pool_options stratus_brick_pool_options_default(void)
{
  return (stratus_brick_pool_options){ .memory = 0, .threads = 0 };
}

static uint64_t limit_of(uint64_t memory)
{
  const uint64_t limit = memory ? memory : stratus_brick_memory_default();
  return limit < MEMORY_LEAST ? MEMORY_LEAST : limit;
}

/* Puts the runs of a part from the room into the array. Returns how many bytes could not be written, for want of memory. */
static uint64_t store_part(const stratus_bricks* bricks, int64_t part, const stratus_brick_room* room)
{
  const int64_t runs = room->bytes ? stratus_brick_runs(bricks, part) : 0;
  const char* from = room->bytes;
  uint64_t missing = 0;
  for (int64_t r = 0; r < runs; ++r) {
    const stratus_brick_run run = stratus_brick_run_at(bricks, part, r);
    if (bricks->memory < 0) {
      memcpy(bricks->values + run.begin, from, run.end - run.begin);
      from += run.end - run.begin;
    }
    for (size_t at = run.begin; bricks->memory >= 0 && at < run.end;) {
      const ssize_t wrote = pwrite(bricks->memory, from, run.end - at, (off_t)at);
      if (wrote < 0 && errno != EINTR) {
        missing += run.end - at;
      }
      const size_t done = wrote > 0 ? (size_t)wrote : wrote < 0 && errno == EINTR ? 0 : run.end - at;
      from += done;
      at += done;
    }
  }
  return missing;
}

/* ------------------------------------------------------------------------------------------------ pages */
#ifdef STRATUS_PAGED

/* Lets readers see pages of the array, from byte `begin` to `end`; those that they see already stay. A page that
 * could not be written, for want of memory, is shown as zeros; its bytes count as missing. */
static void show(const stratus_bricks* bricks, size_t begin, size_t end)
{
  while (begin < end) {
    struct uffdio_continue range = { .range = { .start = (uintptr_t)bricks->values + begin, .len = end - begin } };
    if (ioctl(bricks->pool->faults, UFFDIO_CONTINUE, &range) == 0) {
      return;
    }
    if (range.mapped > 0) {
      begin += (size_t)range.mapped;
    } else if (errno == EEXIST) {
      struct uffdio_range one = { .start = (uintptr_t)bricks->values + begin, .len = bricks->pool->page };
      ioctl(bricks->pool->faults, UFFDIO_WAKE, &one);
      begin += bricks->pool->page;
    } else if (errno != EAGAIN) {
      struct uffdio_zeropage zeros = { .range = { .start = (uintptr_t)bricks->values + begin, .len = bricks->pool->page } };
      ioctl(bricks->pool->faults, UFFDIO_ZEROPAGE, &zeros);
      begin += bricks->pool->page;
    }
  }
}

static void show_part(const stratus_bricks* bricks, int64_t part)
{
  const int64_t runs = stratus_brick_runs(bricks, part);
  for (int64_t r = 0; r < runs; ++r) {
    const stratus_brick_run inner = stratus_brick_inner(bricks, bricks->pool->page, stratus_brick_run_at(bricks, part, r));
    show(bricks, inner.begin, inner.end);
  }
}

/* Returns the bytes of the pages that hold only this part. *edges: bytes of the pages that it shares. */
static uint64_t bytes_of(const stratus_bricks* bricks, int64_t part, uint64_t* edges)
{
  const size_t page = bricks->pool->page;
  const int64_t runs = stratus_brick_runs(bricks, part);
  uint64_t bytes = 0;
  *edges = 0;
  for (int64_t r = 0; r < runs; ++r) {
    const stratus_brick_run run = stratus_brick_run_at(bricks, part, r), inner = stratus_brick_inner(bricks, page, run);
    bytes += inner.end - inner.begin;
    *edges += (run.begin < inner.begin ? page : 0) + (run.end > inner.end ? page : 0);
  }
  return bytes;
}

/* Takes a part's own pages from the readers, and with `drop` from memory, too. */
static void hide_part(const stratus_bricks* bricks, int64_t part, bool drop)
{
  const int64_t runs = stratus_brick_runs(bricks, part);
  for (int64_t r = 0; r < runs; ++r) {
    const stratus_brick_run inner = stratus_brick_inner(bricks, bricks->pool->page, stratus_brick_run_at(bricks, part, r));
    if (inner.end > inner.begin && drop) {
      (void)fallocate(bricks->memory, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, (off_t)inner.begin, (off_t)(inner.end - inner.begin));
    } else if (inner.end > inner.begin) {
      (void)madvise(bricks->values + inner.begin, inner.end - inner.begin, MADV_DONTNEED);
    }
  }
}

static void set_state(stratus_bricks* bricks, int64_t part, int state)
{
  bricks->state[part] = (uint8_t)((bricks->state[part] & ~STRATUS_PART_STATE) | state);
}

/* Moves the clock's hand until the pool is within its limit, or has gone around twice. Part `kept` of `keeper` stays. */
static void make_room(stratus_brick_pool* pool, const stratus_bricks* keeper, int64_t kept)
{
  int64_t parts = 0;
  for (const stratus_bricks* b = pool->first; b; b = b->next) {
    parts += b->parts;
  }
  for (int64_t visit = 0; pool->resident > pool->memory && visit < 2 * parts; ++visit) {
    if (!pool->hand || pool->hand_part >= pool->hand->parts) {
      pool->hand = pool->hand && pool->hand->next ? pool->hand->next : pool->first;
      pool->hand_part = 0;
    }
    stratus_bricks* const bricks = pool->hand;
    const int64_t part = pool->hand_part++;
    const int state = bricks->state[part] & STRATUS_PART_STATE;
    if ((bricks == keeper && part == kept) || (state != STRATUS_PART_HERE && state != STRATUS_PART_RESTING)) {
      continue;
    }
    hide_part(bricks, part, state == STRATUS_PART_RESTING);
    set_state(bricks, part, state == STRATUS_PART_RESTING ? STRATUS_PART_ABSENT : STRATUS_PART_RESTING);
    if (state == STRATUS_PART_RESTING) {
      uint64_t edges = 0;
      pool->resident -= bytes_of(bricks, part, &edges);
      --bricks->report.parts_here;
      ++bricks->report.parts_dropped;
    }
  }
}

/* Reads a part, with the pool's lock on entry and on return, but not while the source reads. Room is made before. */
static void read_part(stratus_bricks* bricks, int64_t part, stratus_brick_room* room)
{
  stratus_brick_pool* const pool = bricks->pool;
  uint64_t edges = 0;
  const uint64_t inner = bytes_of(bricks, part, &edges), shared = bricks->state[part] & STRATUS_PART_EDGES ? 0 : edges;
  bricks->state[part] = STRATUS_PART_EDGES | STRATUS_PART_READING;
  pool->resident += inner + shared;
  make_room(pool, bricks, part);
  pool->resident_most = pool->resident > pool->resident_most ? pool->resident : pool->resident_most;
  pthread_mutex_unlock(&pool->lock);
  uint64_t missing = stratus_brick_part_read(bricks, part, room);
  missing += missing == stratus_brick_part_bytes(bricks, part) ? 0 : store_part(bricks, part, room);
  pthread_mutex_lock(&pool->lock);
  set_state(bricks, part, STRATUS_PART_HERE);
  bricks->report.parts_here += 1;
  pool->parts_read += 1;
  pool->bytes_read += stratus_brick_part_bytes(bricks, part) - missing;
  bricks->report.bytes_read += stratus_brick_part_bytes(bricks, part) - missing;
  (void)__atomic_add_fetch(&bricks->report.parts_read, 1, __ATOMIC_RELEASE); /* others read these two without the lock */
  (void)__atomic_add_fetch(&bricks->report.missing, missing, __ATOMIC_RELEASE);
  show_part(bricks, part);
  pthread_cond_broadcast(&pool->read);
}

/* Sees that a part is in memory and shown. Returns whether the lock was held all the time. */
static bool bring(stratus_bricks* bricks, int64_t part, stratus_brick_room* room)
{
  bool held = true;
  while ((bricks->state[part] & STRATUS_PART_STATE) == STRATUS_PART_READING) {
    held = false;
    pthread_cond_wait(&bricks->pool->read, &bricks->pool->lock);
  }
  const int state = bricks->state[part] & STRATUS_PART_STATE;
  if (state == STRATUS_PART_RESTING) {
    set_state(bricks, part, STRATUS_PART_HERE);
    show_part(bricks, part);
  } else if (state == STRATUS_PART_ABSENT) {
    held = false;
    read_part(bricks, part, room);
  }
  return held;
}

/* Brings all parts of a page, and shows it. Another part may go while one comes: then they are looked at again. */
static void bring_page(stratus_bricks* bricks, size_t begin, stratus_brick_room* room)
{
  const size_t page = bricks->pool->page, last = begin + page < bricks->bytes ? begin + page - 1 : bricks->bytes - 1;
  for (bool held = false; !held;) {
    held = true;
    int64_t before = -1;
    for (size_t byte = begin; byte <= last; byte = (byte / bricks->row + 1) * bricks->row) {
      const int64_t part = stratus_brick_part_of(bricks, byte);
      if (part != before) {
        held = bring(bricks, part, room) && held;
        before = part;
      }
    }
  }
  show(bricks, begin, begin + page);
}

static void serve(stratus_brick_pool* pool, uintptr_t address, stratus_brick_room* room)
{
  pthread_mutex_lock(&pool->lock);
  for (stratus_bricks* bricks = pool->first; bricks; bricks = bricks->next) {
    const uintptr_t begin = (uintptr_t)bricks->values;
    if (address >= begin && address - begin < bricks->mapped) {
      bring_page(bricks, (address - begin) / pool->page * pool->page, room);
      break;
    }
  }
  pthread_mutex_unlock(&pool->lock);
}

static void* serve_faults(void* user)
{
  stratus_brick_pool* const pool = user;
  stratus_brick_room room = { .bytes = NULL };
  for (bool more = true; more;) {
    struct pollfd wait[2] = { { .fd = pool->faults, .events = POLLIN }, { .fd = pool->quit, .events = POLLIN } };
    struct uffd_msg message;
    more = (poll(wait, 2, -1) >= 0 || errno == EINTR) && !wait[1].revents;
    if (more && read(pool->faults, &message, sizeof message) == (ssize_t)sizeof message && message.event == UFFD_EVENT_PAGEFAULT) {
      serve(pool, (uintptr_t)message.arg.pagefault.address, &room);
    }
  }
  free(room.bytes);
  return NULL;
}

/* Opens the handle on which the kernel reports faults. Returns -1 where it does not. */
static int open_faults(void)
{
  const int handle = (int)syscall(SYS_userfaultfd, O_CLOEXEC | O_NONBLOCK | UFFD_USER_MODE_ONLY);
  struct uffdio_api api = { .api = UFFD_API, .features = UFFD_FEATURE_MISSING_SHMEM | UFFD_FEATURE_MINOR_SHMEM };
  if (handle >= 0 && ioctl(handle, UFFDIO_API, &api) != 0) {
    close(handle);
    return -1;
  }
  return handle;
}

static void stop_threads(stratus_brick_pool* pool)
{
  const uint64_t one = 1;
  if (pool->thread_count > 0 && write(pool->quit, &one, sizeof one) == (ssize_t)sizeof one) {
    for (int i = 0; i < pool->thread_count; ++i) {
      pthread_join(pool->threads[i], NULL);
    }
  }
  pool->thread_count = 0;
  if (pool->faults >= 0) {
    close(pool->faults);
  }
  if (pool->quit >= 0) {
    close(pool->quit);
  }
  pool->faults = pool->quit = -1;
}

static void start_threads(stratus_brick_pool* pool, int threads)
{
  sigset_t all, before;
  pool->faults = open_faults();
  pool->quit = pool->faults < 0 ? -1 : eventfd(0, EFD_CLOEXEC);
  if (pool->quit >= 0) {
    sigfillset(&all); /* the program's handlers run in its own threads */
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (pool->thread_count < threads && pthread_create(&pool->threads[pool->thread_count], NULL, serve_faults, pool) == 0) {
      ++pool->thread_count;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
  }
  if (pool->thread_count == 0) {
    stop_threads(pool);
  }
}

/* Maps the array. Returns false if the system does not; then nothing is left. */
static bool map(stratus_bricks* bricks)
{
  const size_t page = bricks->pool->page;
  bricks->mapped = (bricks->bytes + page - 1) / page * page;
  bricks->memory = memfd_create("stratus-bricks", MFD_CLOEXEC);
  if (bricks->memory < 0 || ftruncate(bricks->memory, (off_t)bricks->mapped) != 0) {
    return false;
  }
  void* const values = mmap(NULL, bricks->mapped, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_NORESERVE, bricks->memory, 0);
  bricks->values = values == MAP_FAILED ? NULL : values;
  if (!bricks->values) {
    return false;
  }
  struct uffdio_register range = { .range = { .start = (uintptr_t)bricks->values, .len = bricks->mapped },
    .mode = UFFDIO_REGISTER_MODE_MISSING | UFFDIO_REGISTER_MODE_MINOR };
  (void)madvise(bricks->values, bricks->mapped, MADV_DONTFORK);
  (void)madvise(bricks->values, bricks->mapped, MADV_DONTDUMP);
  return ioctl(bricks->pool->faults, UFFDIO_REGISTER, &range) == 0;
}

static void unmap(stratus_bricks* bricks)
{
  if (bricks->values) {
    munmap(bricks->values, bricks->mapped);
  }
  if (bricks->memory >= 0) {
    close(bricks->memory);
  }
  bricks->values = NULL;
  bricks->memory = -1;
}

#else

static void stop_threads(stratus_brick_pool* pool)
{
  (void)pool;
}

static void start_threads(stratus_brick_pool* pool, int threads)
{
  (void)pool, (void)threads;
}

static bool map(stratus_bricks* bricks)
{
  (void)bricks;
  return false;
}

static void unmap(stratus_bricks* bricks)
{
  (void)bricks;
}

#endif

/* ------------------------------------------------------------------------------------------------ the pool */

stratus_status stratus_brick_pool_create(stratus_context* context, const stratus_brick_pool_options* options, stratus_brick_pool** pool)
{
  if (!context || !pool) {
    return context ? stratus_fail(context, STRATUS_INVALID_ARGUMENT, "no place for the pool: its address is NULL")
                   : STRATUS_INVALID_ARGUMENT;
  }
  const stratus_brick_pool_options o = options ? *options : stratus_brick_pool_options_default();
  if (o.threads < 0 || o.threads > THREADS_MOST) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "threads %d of the pool outside 0..%d", o.threads, THREADS_MOST);
  }
  void* memory = NULL;
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_brick_pool), &memory));
  stratus_brick_pool* const p = memory;
  p->context = context;
  p->memory = limit_of(o.memory);
  p->faults = p->quit = -1;
  p->page = (size_t)sysconf(_SC_PAGESIZE);
  pthread_mutex_init(&p->lock, NULL);
  pthread_cond_init(&p->read, NULL);
  const int threads = o.threads ? o.threads : context->threads < 2 ? 2 : context->threads;
  start_threads(p, threads < THREADS_MOST ? threads : THREADS_MOST);
  *pool = p;
  return STRATUS_OK;
}

stratus_status stratus_brick_pool_set_memory(stratus_brick_pool* pool, uint64_t memory)
{
  if (!pool) {
    return STRATUS_INVALID_ARGUMENT;
  }
  pthread_mutex_lock(&pool->lock);
  pool->memory = limit_of(memory);
  pthread_mutex_unlock(&pool->lock);
  return STRATUS_OK;
}

void stratus_brick_pool_get_report(stratus_brick_pool* pool, stratus_brick_pool_report* report)
{
  if (!pool || !report) {
    return;
  }
  pthread_mutex_lock(&pool->lock);
  *report = (stratus_brick_pool_report){
    .paged = pool->faults >= 0,
    .memory = pool->memory,
    .resident = pool->resident,
    .resident_most = pool->resident_most,
    .parts_read = pool->parts_read,
    .bytes_read = pool->bytes_read,
  };
  pthread_mutex_unlock(&pool->lock);
}

void stratus_brick_pool_destroy(stratus_brick_pool* pool)
{
  if (pool) {
    stop_threads(pool);
    pthread_cond_destroy(&pool->read);
    pthread_mutex_destroy(&pool->lock);
    stratus_release(pool->context, pool);
  }
}

/* ------------------------------------------------------------------------------------------------ arrays */

static stratus_status check(stratus_context* context, const stratus_brick_source* source, size_t* bytes)
{
  const size_t size = stratus_type_size(source->type);
  if (size == 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "type %d of bricks is no stratus_type", (int)source->type);
  }
  if (!source->read) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the source of bricks has no function that reads them");
  }
  for (int a = 0; a < 3; ++a) {
    if (source->dimensions[a] < 1 || source->brick[a] < 1) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
        "axis %d of bricks has %lld values, in bricks of %lld: both must be at least 1", a, (long long)source->dimensions[a],
        (long long)source->brick[a]);
    }
  }
  TRY(stratus_product(
    context, "values of bricks", (size_t)source->dimensions[0], (size_t)source->dimensions[1], (size_t)source->dimensions[2], bytes));
  TRY(stratus_array_check(context, "values of bricks", *bytes, size));
  *bytes *= size;
  return STRATUS_OK;
}

/* Reads all parts into memory, where the system has no pages that stop their readers. */
static stratus_status read_all(stratus_context* context, stratus_bricks* bricks)
{
  void* memory = NULL;
  TRY(stratus_allocate(context, bricks->bytes, 1, &memory));
  bricks->values = memory;
  bricks->mapped = bricks->bytes;
  stratus_brick_room room = { .bytes = NULL };
  stratus_status status = STRATUS_OK;
  for (int64_t part = 0; part < bricks->parts && status == STRATUS_OK; ++part) {
    bricks->report.missing += stratus_brick_part_read(bricks, part, &room);
    (void)store_part(bricks, part, &room);
    status = room.bytes ? stratus_progress(context, "bricks", (double)part / (double)bricks->parts)
                        : stratus_fail(context, STRATUS_OUT_OF_MEMORY, "out of memory for a part of %llu bytes",
                            (unsigned long long)stratus_brick_part_bytes(bricks, part));
  }
  free(room.bytes);
  TRY(status);
  bricks->report.parts_here = bricks->report.parts_read = (uint64_t)bricks->parts;
  bricks->report.bytes_read = bricks->bytes - bricks->report.missing;
  return STRATUS_OK;
}

/* Releases what an array has, but for its place among the pool's. */
static void release(stratus_context* context, stratus_bricks* bricks)
{
  if (bricks->memory < 0) {
    stratus_release(context, bricks->values);
  } else {
    unmap(bricks);
  }
  if (bricks->source.release) {
    bricks->source.release(bricks->source.user);
  }
  free(bricks->only);
  free(bricks->state);
  free(bricks);
}

stratus_status stratus_bricks_create(
  stratus_context* context, stratus_brick_pool* pool, const stratus_brick_source* source, stratus_bricks** bricks)
{
  if (!context || !pool || !source || !bricks) {
    return context ? stratus_fail(context, STRATUS_INVALID_ARGUMENT, "bricks need a pool, a source and a place: one of them is NULL")
                   : STRATUS_INVALID_ARGUMENT;
  }
  size_t bytes = 0;
  stratus_status status = check(context, source, &bytes);
  stratus_bricks* const b = status == STRATUS_OK ? calloc(1, sizeof *b) : NULL;
  if (!b) {
    if (source->release) {
      source->release(source->user);
    }
    return status != STRATUS_OK ? status : stratus_fail(context, STRATUS_OUT_OF_MEMORY, "out of memory for an array of bricks");
  }
  b->pool = pool;
  b->source = *source;
  b->bytes = bytes;
  b->row = (size_t)source->dimensions[0] * stratus_type_size(source->type);
  b->memory = -1;
  stratus_brick_parts_divide(b);
  b->report.parts = (uint64_t)b->parts;
  stratus_brick_find_only(context, b);
  b->state = calloc((size_t)b->parts, 1);
  if (!b->state) {
    status = stratus_fail(context, STRATUS_OUT_OF_MEMORY, "out of memory for the states of %lld parts", (long long)b->parts);
  } else if (pool->faults < 0 || !map(b)) {
    unmap(b);
    status = read_all(context, b);
  }
  if (status != STRATUS_OK) {
    release(context, b);
    return status;
  }
  pthread_mutex_lock(&pool->lock);
  b->next = pool->first;
  pool->first = b;
  if (b->memory < 0) {
    pool->resident += bytes;
    pool->resident_most = pool->resident > pool->resident_most ? pool->resident : pool->resident_most;
  }
  pthread_mutex_unlock(&pool->lock);
  *bricks = b;
  return STRATUS_OK;
}

const void* stratus_bricks_values(const stratus_bricks* bricks)
{
  return bricks ? bricks->values : NULL;
}

const uint64_t* stratus_bricks_missing(const stratus_bricks* bricks)
{
  return bricks ? &bricks->report.missing : NULL;
}

const uint64_t* stratus_bricks_reads(const stratus_bricks* bricks)
{
  return bricks ? &bricks->report.parts_read : NULL;
}

void stratus_bricks_get_report(stratus_bricks* bricks, stratus_bricks_report* report)
{
  if (bricks && report) {
    pthread_mutex_lock(&bricks->pool->lock);
    *report = bricks->report;
    pthread_mutex_unlock(&bricks->pool->lock);
  }
}

void stratus_bricks_destroy(stratus_bricks* bricks)
{
  if (!bricks) {
    return;
  }
  stratus_brick_pool* const pool = bricks->pool;
  pthread_mutex_lock(&pool->lock);
  for (stratus_bricks** at = &pool->first; *at; at = &(*at)->next) {
    if (*at == bricks) {
      *at = bricks->next;
      break;
    }
  }
  if (pool->hand == bricks) {
    pool->hand = NULL;
  }
  if (bricks->memory < 0) {
    pool->resident -= bricks->bytes;
  }
#ifdef STRATUS_PAGED
  for (int64_t part = 0; bricks->memory >= 0 && part < bricks->parts; ++part) {
    const int state = bricks->state[part] & STRATUS_PART_STATE;
    uint64_t edges = 0;
    const uint64_t inner = bytes_of(bricks, part, &edges);
    pool->resident -= (state == STRATUS_PART_ABSENT ? 0 : inner) + (bricks->state[part] & STRATUS_PART_EDGES ? edges : 0);
  }
#endif
  pthread_mutex_unlock(&pool->lock);
  release(pool->context, bricks);
}
