/* SPDX-License-Identifier: BSD-3-Clause
 * Arrays whose parts are read when something first reads their values. The kernel stops a thread that reads a page that is not there, and
 * notifies one of the pool's threads (userfaultfd), which reads the part of the page and lets the thread go on. So everything that reads
 * values reads bricks, and what is in memory costs nothing.
 *
 * Each array is a file in memory that is mapped for its readers. Parts are written to the file, and their pages are shown to the readers
 * when they are complete. A page that parts share is shown once all of them are there, and stays, until such pages take half of the pool's
 * memory: then all parts are dropped. An array that does not fit in the pool's memory has a second file and mapping for rays, in which each
 * tile of the grid has pages of its own.
 *
 * A clock chooses what is dropped: its hand first takes the pages of a part out of the readers' mapping, and drops the part when it comes
 * around again and nothing has read it. It may come around at once. So it passes the half of the parts that were brought last, because
 * their readers may not be done with them. */
#define _GNU_SOURCE
#include "bricks.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifdef __linux__
#include <fcntl.h>
#include <linux/userfaultfd.h>
#include <poll.h>
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

/* Puts the runs of a part from the room into the array. Returns how many bytes could not be written, for want of memory. */
uint64_t stratus_brick_store_part(const stratus_brick_view* view, int64_t part, const stratus_brick_room* room)
{
  const int64_t runs = room->bytes ? stratus_brick_runs(view, part) : 0;
  const char* from = room->bytes;
  uint64_t missing = 0;
  for (int64_t r = 0; r < runs; ++r) {
    const stratus_brick_run run = stratus_brick_run_at(view, part, r);
    if (view->memory < 0) {
      memcpy(view->values + run.begin, from, run.end - run.begin);
      from += run.end - run.begin;
    }
    for (size_t at = run.begin; view->memory >= 0 && at < run.end;) {
      const ssize_t wrote = pwrite(view->memory, from, run.end - at, (off_t)at);
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

bool stratus_brick_start_thread(pthread_t* thread, stratus_brick_thread_function* run, void* user)
{
  static const int faults[] = { SIGBUS, SIGSEGV, SIGFPE, SIGILL };
  sigset_t blocked, before;
  sigfillset(&blocked);
  for (size_t i = 0; i < sizeof faults / sizeof *faults; ++i) {
    sigdelset(&blocked, faults[i]);
  }
  pthread_sigmask(SIG_SETMASK, &blocked, &before);
  const bool started = pthread_create(thread, NULL, run, user) == 0;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  return started;
}

void stratus_brick_count_read(stratus_brick_view* view, int64_t part, uint64_t missing, stratus_brick_reason reason)
{
  stratus_brick_pool* const pool = view->bricks->pool;
  const uint64_t bytes = stratus_brick_part_bytes(view, part) - missing;
  ++pool->parts_read;
  pool->bytes_read += bytes;
  view->bricks->report.bytes_read += bytes;
  ++view->bricks->report.parts_read;
  (void)__atomic_add_fetch(
    &view->bricks->waited_for, reason != STRATUS_BRICK_AHEAD, __ATOMIC_RELEASE); /* others read these two without the lock */
  (void)__atomic_add_fetch(&view->bricks->report.missing, missing, __ATOMIC_RELEASE);
}

void stratus_brick_enter(stratus_bricks* bricks)
{
  ++bricks->threads;
}

void stratus_brick_leave(stratus_bricks* bricks)
{
  if (--bricks->threads == 0 && bricks->leaves) {
    pthread_cond_broadcast(&bricks->pool->read);
  }
}

#ifdef STRATUS_PAGED

/* Lets readers see pages of the array, from byte `begin` to `end`; those that they see already stay. A page that
 * could not be written, for want of memory, is shown as zeros; its bytes count as missing. */
static void show(const stratus_brick_view* view, size_t begin, size_t end)
{
  while (begin < end) {
    struct uffdio_continue range = { .range = { .start = (uintptr_t)view->values + begin, .len = end - begin } };
    if (ioctl(view->bricks->pool->faults, UFFDIO_CONTINUE, &range) == 0) {
      return;
    }
    if (range.mapped > 0) {
      begin += (size_t)range.mapped;
    } else if (errno == EEXIST) {
      struct uffdio_range one = { .start = (uintptr_t)view->values + begin, .len = view->bricks->pool->page };
      ioctl(view->bricks->pool->faults, UFFDIO_WAKE, &one);
      begin += view->bricks->pool->page;
    } else if (errno != EAGAIN) {
      struct uffdio_zeropage zeros = { .range = { .start = (uintptr_t)view->values + begin, .len = view->bricks->pool->page } };
      ioctl(view->bricks->pool->faults, UFFDIO_ZEROPAGE, &zeros);
      begin += view->bricks->pool->page;
    }
  }
}

static void show_part(const stratus_brick_view* view, int64_t part)
{
  const int64_t runs = stratus_brick_runs(view, part);
  for (int64_t r = 0; r < runs; ++r) {
    const stratus_brick_run inner = stratus_brick_inner(view, view->bricks->pool->page, stratus_brick_run_at(view, part, r));
    show(view, inner.begin, inner.end);
  }
}

/* Returns the bytes of the pages that hold only this part. *edges: bytes of the pages that it shares. */
static uint64_t bytes_of(const stratus_brick_view* view, int64_t part, uint64_t* edges)
{
  const size_t page = view->bricks->pool->page;
  const int64_t runs = stratus_brick_runs(view, part);
  uint64_t bytes = 0;
  *edges = 0;
  for (int64_t r = 0; r < runs; ++r) {
    const stratus_brick_run run = stratus_brick_run_at(view, part, r), inner = stratus_brick_inner(view, page, run);
    bytes += inner.end - inner.begin;
    *edges += run.begin < inner.begin ? page : 0; /* the run that ends there does not count it */
  }
  return bytes;
}

uint64_t stratus_brick_resident(const stratus_brick_view* view)
{
  uint64_t bytes = 0;
  for (int64_t part = 0; view->memory >= 0 && part < view->parts; ++part) {
    const int state = view->state[part] & STRATUS_PART_STATE;
    uint64_t edges = 0;
    const uint64_t inner = bytes_of(view, part, &edges);
    bytes += (state == STRATUS_PART_ABSENT ? 0 : inner) + (view->state[part] & STRATUS_PART_EDGES ? edges : 0);
  }
  return bytes;
}

/* Takes a part's own pages from the readers, and with `drop` from memory, too. */
static void hide_part(const stratus_brick_view* view, int64_t part, bool drop)
{
  const int64_t runs = stratus_brick_runs(view, part);
  for (int64_t r = 0; r < runs; ++r) {
    const stratus_brick_run inner = stratus_brick_inner(view, view->bricks->pool->page, stratus_brick_run_at(view, part, r));
    if (inner.end > inner.begin && drop) {
      (void)fallocate(view->memory, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, (off_t)inner.begin, (off_t)(inner.end - inner.begin));
    } else if (inner.end > inner.begin) {
      (void)madvise(view->values + inner.begin, inner.end - inner.begin, MADV_DONTNEED);
    }
  }
}

static void set_state(stratus_brick_view* view, int64_t part, int state)
{
  view->state[part] = (uint8_t)((view->state[part] & ~STRATUS_PART_STATE) | state);
  if (state == STRATUS_PART_HERE) {
    view->brought[part] = ++view->bricks->pool->brought;
  }
}

/* Whether a part is in the half of those in memory that were brought last. */
static bool is_young(const stratus_brick_view* view, int64_t part)
{
  const stratus_brick_pool* pool = view->bricks->pool;
  return 2 * (uint64_t)(pool->brought - view->brought[part]) < pool->parts_here;
}

static void drop_part(stratus_brick_view* view, int64_t part)
{
  uint64_t edges = 0;
  hide_part(view, part, true);
  set_state(view, part, STRATUS_PART_ABSENT);
  view->bricks->pool->resident -= bytes_of(view, part, &edges);
  --view->bricks->pool->parts_here;
  --view->bricks->report.parts_here;
  ++view->bricks->report.parts_dropped;
}

/* Moves the clock's hand until the pool is within its limit, or has gone around three times: the third time it drops young parts, too. */
static void make_room(stratus_brick_pool* pool)
{
  int64_t parts = 0;
  for (const stratus_brick_view* b = pool->first; b; b = b->next) {
    parts += b->parts;
  }
  const uint64_t memory = stratus_brick_memory_left(pool);
  for (int64_t visit = 0; pool->resident > memory && visit < 3 * parts; ++visit) {
    if (!pool->hand || pool->hand_part >= pool->hand->parts) {
      pool->hand = pool->hand && pool->hand->next ? pool->hand->next : pool->first;
      pool->hand_part = 0;
    }
    stratus_brick_view* const view = pool->hand;
    const int64_t part = pool->hand_part++;
    const int state = view->state[part] & STRATUS_PART_STATE;
    if (state == STRATUS_PART_HERE) {
      hide_part(view, part, false);
      set_state(view, part, STRATUS_PART_RESTING);
    } else if (state == STRATUS_PART_RESTING && (visit >= 2 * parts || !is_young(view, part))) {
      drop_part(view, part);
    }
  }
}

static bool is_being_read(const stratus_brick_view* view)
{
  int64_t part = 0;
  while (part < view->parts && (view->state[part] & STRATUS_PART_STATE) != STRATUS_PART_READING) {
    ++part;
  }
  return part < view->parts;
}

/* Drops all parts of a view, and the pages that they share. */
static void empty(stratus_brick_view* view)
{
  stratus_bricks_report* const report = &view->bricks->report;
  view->bricks->pool->resident -= stratus_brick_resident(view);
  for (int64_t part = 0; part < view->parts; ++part) {
    const int here = (view->state[part] & STRATUS_PART_STATE) != STRATUS_PART_ABSENT;
    view->bricks->pool->parts_here -= (uint64_t)here;
    report->parts_here -= (uint64_t)here;
    report->parts_dropped += (uint64_t)here;
    view->state[part] = STRATUS_PART_ABSENT;
  }
  (void)fallocate(view->memory, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, (off_t)view->mapped);
  view->shared = 0;
  ++view->emptied;
}

/* Sees that pages that parts share leave half of the memory to the pages of single parts. */
static void limit_shared(stratus_brick_pool* pool)
{
  const uint64_t most = stratus_brick_memory_left(pool) / 2;
  uint64_t shared = 0;
  for (const stratus_brick_view* view = pool->first; view; view = view->next) {
    shared += view->shared;
  }
  for (stratus_brick_view* view = pool->first; view && shared > most; view = view->next) {
    if (view->shared > 0 && !is_being_read(view)) {
      shared -= view->shared;
      empty(view);
    }
  }
}

bool stratus_brick_read_part(stratus_brick_view* view, int64_t part, stratus_brick_room* room, stratus_brick_reason reason)
{
  stratus_brick_pool* const pool = view->bricks->pool;
  limit_shared(pool);
  uint64_t edges = 0;
  const uint64_t inner = bytes_of(view, part, &edges), shared = view->state[part] & STRATUS_PART_EDGES ? 0 : edges;
  if (reason == STRATUS_BRICK_AHEAD && pool->resident + inner + shared > stratus_brick_memory_left(pool)) {
    return false;
  }
  pool->resident += inner + shared;
  view->shared += shared;
  make_room(pool);
  view->state[part] = STRATUS_PART_EDGES | STRATUS_PART_READING;
  pool->resident_most = pool->resident > pool->resident_most ? pool->resident : pool->resident_most;
  pthread_mutex_unlock(&pool->lock);
  uint64_t missing = stratus_brick_part_read(view, part, room);
  const uint64_t lost = stratus_brick_store_part(view, part, room), all = stratus_brick_part_bytes(view, part);
  missing = missing + lost < all ? missing + lost : all;
  pthread_mutex_lock(&pool->lock);
  set_state(view, part, reason == STRATUS_BRICK_SCANNED ? STRATUS_PART_RESTING : STRATUS_PART_HERE);
  ++pool->parts_here;
  ++view->bricks->report.parts_here;
  stratus_brick_count_read(view, part, missing, reason);
  if (reason != STRATUS_BRICK_SCANNED) { /* the first read of it is noticed */
    show_part(view, part);
  }
  pthread_cond_broadcast(&pool->read);
  return true;
}

/* Sees that a part is in memory and shown. */
static void bring(stratus_brick_view* view, int64_t part, stratus_brick_room* room)
{
  const int state = view->state[part] & STRATUS_PART_STATE;
  if (state == STRATUS_PART_RESTING) {
    set_state(view, part, STRATUS_PART_HERE);
    show_part(view, part);
  } else if (state == STRATUS_PART_ABSENT) {
    (void)stratus_brick_read_part(view, part, room, STRATUS_BRICK_WAITED_FOR);
  }
}

/* Brings all parts of a page. Values on a page that parts share stay there when the parts are dropped, so that each part must have been
 * read once, and they need not be in memory together. */
static void bring_parts(stratus_brick_view* view, size_t begin, size_t last, stratus_brick_room* room)
{
  size_t end = 0;
  const bool shared = stratus_brick_part_of(view, begin, &end) != stratus_brick_part_of(view, last, &end);
  int64_t before = -1;
  for (size_t byte = begin; byte <= last; byte = end) {
    const int64_t part = stratus_brick_part_of(view, byte, &end);
    while ((view->state[part] & STRATUS_PART_STATE) == STRATUS_PART_READING) {
      pthread_cond_wait(&view->bricks->pool->read, &view->bricks->pool->lock);
    }
    if (part != before && !(shared && (view->state[part] & STRATUS_PART_EDGES))) {
      bring(view, part, room);
    }
    before = part;
  }
}

/* Shows a page, once its parts were brought while none of it was emptied. */
static void bring_page(stratus_brick_view* view, size_t begin, stratus_brick_room* room)
{
  const size_t page = view->bricks->pool->page, last = begin + page < view->bytes ? begin + page - 1 : view->bytes - 1;
  uint64_t emptied;
  do {
    emptied = view->emptied;
    bring_parts(view, begin, last, room);
  } while (emptied != view->emptied);
  show(view, begin, begin + page);
}

static void serve(stratus_brick_pool* pool, uintptr_t address, stratus_brick_room* room)
{
  pthread_mutex_lock(&pool->lock);
  ++pool->serving;
  for (stratus_brick_view* view = pool->first; view; view = view->next) {
    const uintptr_t begin = (uintptr_t)view->values;
    if (address >= begin && address - begin < view->mapped) {
      stratus_bricks* const bricks = view->bricks;
      stratus_brick_enter(bricks);
      bring_page(view, (address - begin) / pool->page * pool->page, room);
      stratus_brick_leave(bricks);
      break;
    }
  }
  --pool->serving;
  pool->served = stratus_now_ms();
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

void stratus_brick_pages_stop(stratus_brick_pool* pool)
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

void stratus_brick_pages_start(stratus_brick_pool* pool, int threads)
{
  pool->faults = open_faults();
  pool->quit = pool->faults < 0 ? -1 : eventfd(0, EFD_CLOEXEC);
  if (pool->quit >= 0) {
    while (pool->thread_count < threads && stratus_brick_start_thread(&pool->threads[pool->thread_count], serve_faults, pool)) {
      ++pool->thread_count;
    }
  }
  if (pool->thread_count == 0) {
    stratus_brick_pages_stop(pool);
  }
}

/* Maps the array. Returns false if the system does not; then nothing is left. */
bool stratus_brick_map(stratus_brick_view* view)
{
  const size_t page = view->bricks->pool->page;
  view->mapped = (view->bytes + page - 1) / page * page;
  view->memory = memfd_create("stratus-bricks", MFD_CLOEXEC);
  if (view->memory < 0 || ftruncate(view->memory, (off_t)view->mapped) != 0) {
    return false;
  }
  void* const values = mmap(NULL, view->mapped, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_NORESERVE, view->memory, 0);
  view->values = values == MAP_FAILED ? NULL : values;
  if (!view->values) {
    return false;
  }
  struct uffdio_register range = { .range = { .start = (uintptr_t)view->values, .len = view->mapped },
    .mode = UFFDIO_REGISTER_MODE_MISSING | UFFDIO_REGISTER_MODE_MINOR };
  (void)madvise(view->values, view->mapped, MADV_DONTFORK);
  (void)madvise(view->values, view->mapped, MADV_DONTDUMP);
  return ioctl(view->bricks->pool->faults, UFFDIO_REGISTER, &range) == 0;
}

void stratus_brick_unmap(stratus_brick_view* view)
{
  if (view->values) {
    munmap(view->values, view->mapped);
  }
  if (view->memory >= 0) {
    close(view->memory);
  }
  view->values = NULL;
  view->memory = -1;
}

#else

uint64_t stratus_brick_resident(const stratus_brick_view* view)
{
  (void)view;
  return 0;
}

bool stratus_brick_read_part(stratus_brick_view* view, int64_t part, stratus_brick_room* room, stratus_brick_reason reason)
{
  (void)view, (void)part, (void)room, (void)reason;
  return false;
}

void stratus_brick_pages_stop(stratus_brick_pool* pool)
{
  (void)pool;
}

void stratus_brick_pages_start(stratus_brick_pool* pool, int threads)
{
  (void)pool, (void)threads;
}

bool stratus_brick_map(stratus_brick_view* view)
{
  (void)view;
  return false;
}

void stratus_brick_unmap(stratus_brick_view* view)
{
  (void)view;
}

#endif
