/* SPDX-License-Identifier: BSD-3-Clause
 * Arrays of bricks, and the pool that holds their parts. */
#define _POSIX_C_SOURCE 200809L
#include "bricks.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MEMORY_LEAST ((uint64_t)16 << 20)
#define THREADS_MOST 64

stratus_brick_pool_options stratus_brick_pool_options_default(void)
{
  return (stratus_brick_pool_options){ .memory = 0, .threads = 0, .whole_process = 0 };
}

static uint64_t limit_of(uint64_t memory)
{
  const uint64_t limit = memory ? memory : stratus_brick_memory_default();
  return limit < MEMORY_LEAST ? MEMORY_LEAST : limit;
}

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
  if (o.whole_process != 0 && o.whole_process != 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "whole_process %d of the pool must be 0 or 1", o.whole_process);
  }
  void* memory = NULL;
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_brick_pool), &memory));
  stratus_brick_pool* const p = memory;
  p->context = context;
  p->process = (long)getpid();
  p->memory = limit_of(o.memory);
  p->whole_process = o.whole_process;
  p->began = o.whole_process ? stratus_brick_memory_private() : 0;
  p->looked = -INFINITY;
  p->faults = p->quit = -1;
  p->page = (size_t)sysconf(_SC_PAGESIZE);
  pthread_mutex_init(&p->lock, NULL);
  pthread_cond_init(&p->read, NULL);
  const int threads = o.threads ? o.threads : context->threads < 2 ? 2 : context->threads;
  stratus_brick_pages_start(p, threads < THREADS_MOST ? threads : THREADS_MOST);
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
  if (pool && pool->process == (long)getpid()) {
    stratus_brick_ahead_stop(pool);
    stratus_brick_pages_stop(pool);
    pthread_cond_destroy(&pool->read);
    pthread_mutex_destroy(&pool->lock);
    stratus_release(pool->context, pool);
  }
}

/* ------------------------------------------------------------------------------------------------ arrays */

static uint64_t memory_of(stratus_brick_pool* pool)
{
  pthread_mutex_lock(&pool->lock);
  const uint64_t memory = pool->memory;
  pthread_mutex_unlock(&pool->lock);
  return memory;
}

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
    const int64_t of_point = a == 0 && source->components > 1 ? source->components : 1;
    if (source->dimensions[a] % of_point != 0 || source->brick[a] % of_point != 0 || source->before[a] % of_point != 0) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
        "%lld values along x, in bricks of %lld with %lld before them, are no multiples of %lld components",
        (long long)source->dimensions[a], (long long)source->brick[a], (long long)source->before[a], (long long)of_point);
    }
    if (source->dimensions[a] < 1 || source->brick[a] < 1) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
        "axis %d of bricks has %lld values, in bricks of %lld: both must be at least 1", a, (long long)source->dimensions[a],
        (long long)source->brick[a]);
    }
    if (source->before[a] < 0 || source->before[a] >= source->brick[a]) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "axis %d of bricks has %lld values before the array, must be from 0 to %lld",
        a, (long long)source->before[a], (long long)source->brick[a] - 1);
    }
  }
  if (source->only && (source->components > 1 || stratus_type_is_wide(source->type))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "a source of bricks of one value each has %lld components of type %d, must have one of FLOAT32, or of 8 or 16 bits",
      (long long)source->components, (int)source->type);
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
  stratus_brick_view* const view = &bricks->rows;
  void* memory = NULL;
  TRY(stratus_allocate(context, view->bytes, 1, &memory));
  view->values = memory;
  view->mapped = view->bytes;
  stratus_brick_room room = { .bytes = NULL };
  stratus_status status = STRATUS_OK;
  for (int64_t part = 0; part < view->parts && status == STRATUS_OK; ++part) {
    bricks->report.missing += stratus_brick_part_read(view, part, &room);
    (void)stratus_brick_store_part(view, part, &room);
    status = room.bytes ? stratus_progress(context, "bricks", (double)part / (double)view->parts)
                        : stratus_fail(context, STRATUS_OUT_OF_MEMORY, "out of memory for a part of %llu bytes",
                            (unsigned long long)stratus_brick_part_bytes(view, part));
  }
  free(room.bytes);
  TRY(status);
  bricks->report.parts_here = bricks->report.parts_read = bricks->waited_for = (uint64_t)view->parts;
  bricks->report.bytes_read = view->bytes - bricks->report.missing;
  return STRATUS_OK;
}

static bool make_states(stratus_brick_view* view)
{
  view->state = calloc((size_t)view->parts, sizeof *view->state);
  view->brought = calloc((size_t)view->parts, sizeof *view->brought);
  return view->state && view->brought;
}

static void release_states(const stratus_brick_view* view)
{
  free(view->state);
  free(view->brought);
}

static void release_tiles(stratus_bricks* bricks)
{
  stratus_brick_unmap(&bricks->tiles);
  release_states(&bricks->tiles);
  bricks->tiles = (stratus_brick_view){ .bricks = bricks, .tiled = true, .memory = -1 };
  for (int a = 0; a < 3; ++a) {
    free(bricks->at[a]);
    bricks->at[a] = NULL;
  }
}

/* Gives an array its tiles. Without them, for want of memory, rays read its rows. */
static void make_tiles(stratus_bricks* bricks)
{
  stratus_brick_view* const view = &bricks->tiles;
  if (stratus_brick_tiles_divide(view, bricks->pool->page) && make_states(view) && stratus_brick_map(view)) {
    bricks->report.parts += (uint64_t)view->parts;
    bricks->shown.values = view->values;
  } else {
    release_tiles(bricks);
  }
}

/* Releases what an array has, but for its place among the pool's. */
static void release(stratus_context* context, stratus_bricks* bricks)
{
  if (bricks->rows.memory < 0) {
    stratus_release(context, bricks->rows.values);
  } else {
    stratus_brick_unmap(&bricks->rows);
  }
  release_tiles(bricks);
  if (bricks->source.release) {
    bricks->source.release(bricks->source.user);
  }
  free(bricks->only);
  release_states(&bricks->rows);
  free(bricks);
}

static void join_pool(stratus_brick_pool* pool, stratus_brick_view* view)
{
  view->next = pool->first;
  pool->first = view;
  if (view->memory < 0) {
    pool->resident += view->bytes;
    pool->resident_most = pool->resident > pool->resident_most ? pool->resident : pool->resident_most;
  }
}

static void leave_pool(stratus_brick_pool* pool, const stratus_brick_view* view)
{
  for (stratus_brick_view** at = &pool->first; *at; at = &(*at)->next) {
    if (*at == view) {
      *at = view->next;
      break;
    }
  }
  if (pool->hand == view) {
    pool->hand = NULL;
  }
  pool->resident -= view->memory < 0 ? view->bytes : 0;
  pool->resident -= stratus_brick_resident(view);
  for (int64_t part = 0; view->memory >= 0 && part < view->parts; ++part) {
    pool->parts_here -= (view->state[part] & STRATUS_PART_STATE) != STRATUS_PART_ABSENT;
  }
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
  b->rows = (stratus_brick_view){ .bricks = b, .bytes = bytes, .memory = -1 };
  b->tiles = (stratus_brick_view){ .bricks = b, .tiled = true, .memory = -1 };
  stratus_brick_rows_divide(&b->rows);
  b->report.parts = (uint64_t)b->rows.parts;
  b->lists_only = source->only != NULL;
  stratus_brick_find_only(context, b);
  if (!make_states(&b->rows)) {
    status = stratus_fail(context, STRATUS_OUT_OF_MEMORY, "out of memory for the states of %lld parts", (long long)b->rows.parts);
  } else if (pool->faults < 0 || !stratus_brick_map(&b->rows)) {
    stratus_brick_unmap(&b->rows);
    status = read_all(context, b);
  } else if (b->lists_only || bytes > memory_of(pool)) {
    make_tiles(b);
  }
  if (status != STRATUS_OK) {
    release(context, b);
    return status;
  }
  stratus_brick_set_parts(b);
  pthread_mutex_lock(&pool->lock);
  join_pool(pool, &b->rows);
  if (b->tiles.parts > 0) {
    join_pool(pool, &b->tiles);
  }
  pthread_mutex_unlock(&pool->lock);
  *bricks = b;
  return STRATUS_OK;
}

const void* stratus_bricks_values(const stratus_bricks* bricks)
{
  return bricks ? bricks->rows.values : NULL;
}

const stratus_tiles* stratus_bricks_tiles(const stratus_bricks* bricks)
{
  return bricks && bricks->tiles.parts > 0 ? &bricks->shown : NULL;
}

const stratus_parts* stratus_bricks_parts(const stratus_bricks* bricks)
{
  return bricks && bricks->parts.read ? &bricks->parts : NULL;
}

const uint64_t* stratus_bricks_missing(const stratus_bricks* bricks)
{
  return bricks ? &bricks->report.missing : NULL;
}

const uint64_t* stratus_bricks_reads(const stratus_bricks* bricks)
{
  return bricks ? &bricks->waited_for : NULL;
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
  if (!bricks || bricks->pool->process != (long)getpid()) {
    return;
  }
  stratus_brick_pool* const pool = bricks->pool;
  pthread_mutex_lock(&pool->lock);
  bricks->leaves = true;
  bricks->like = NULL;
  for (stratus_brick_view* view = pool->first; view; view = view->next) {
    view->bricks->like = view->bricks->like == bricks ? NULL : view->bricks->like;
  }
  while (bricks->threads > 0) { /* for a read that is over, or that is not waited for */
    pthread_cond_wait(&pool->read, &pool->lock);
  }
  leave_pool(pool, &bricks->rows);
  if (bricks->tiles.parts > 0) {
    leave_pool(pool, &bricks->tiles);
  }
  pthread_mutex_unlock(&pool->lock);
  release(pool->context, bricks);
}
