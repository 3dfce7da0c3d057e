/* SPDX-License-Identifier: BSD-3-Clause
 * Reads parts of one array ahead, where another one was read, when nothing has waited for a part for a moment. */
#define _POSIX_C_SOURCE 200809L
#include "bricks.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#define QUIET_MS 20 /* a moment: a picture that reads waits less between its parts */

/* Whether nothing has waited for a part for a moment. */
static bool is_quiet(const stratus_brick_pool* pool)
{
  return pool->serving == 0 && stratus_now_ms() - pool->served >= QUIET_MS;
}

static bool is_here(const stratus_brick_view* view, int64_t part)
{
  const int state = view->state[part] & STRATUS_PART_STATE;
  return state == STRATUS_PART_HERE || state == STRATUS_PART_RESTING;
}

/* Finds a part to read. Returns its view; NULL: there is none. */
static stratus_brick_view* find_part(stratus_brick_pool* pool, int64_t* part)
{
  for (stratus_brick_view* view = pool->first; view; view = view->next) {
    const stratus_bricks* other = view->bricks->like;
    const stratus_brick_view* like = !other ? NULL : view->tiled ? &other->tiles : &other->rows;
    for (int64_t n = 0; like && like->parts == view->parts && n < view->parts; ++n) {
      const int64_t at = (view->ahead + n) % view->parts;
      if (is_here(like, at) && (view->state[at] & STRATUS_PART_STATE) == STRATUS_PART_ABSENT) {
        view->ahead = at;
        *part = at;
        return view;
      }
    }
  }
  return NULL;
}

static void wait_a_moment(stratus_brick_pool* pool)
{
  struct timespec until;
  clock_gettime(CLOCK_REALTIME, &until);
  until.tv_nsec += (long)QUIET_MS * 1000000;
  until.tv_sec += until.tv_nsec / 1000000000;
  until.tv_nsec %= 1000000000;
  (void)pthread_cond_timedwait(&pool->read, &pool->lock, &until);
}

static void* read_ahead(void* user)
{
  stratus_brick_pool* const pool = user;
  stratus_brick_room room = { .bytes = NULL };
  pthread_mutex_lock(&pool->lock);
  while (!pool->ending) {
    int64_t part = 0;
    if (!is_quiet(pool)) {
      wait_a_moment(pool);
      continue;
    }
    stratus_brick_view* const view = find_part(pool, &part);
    bool read = false;
    if (view) {
      stratus_bricks* const bricks = view->bricks;
      stratus_brick_enter(bricks);
      read = stratus_brick_read_part(view, part, &room, STRATUS_BRICK_AHEAD);
      stratus_brick_leave(bricks);
    }
    if (!read) {
      pthread_cond_wait(&pool->read, &pool->lock); /* until more is read, or another array is to be */
    }
  }
  pthread_mutex_unlock(&pool->lock);
  free(room.bytes);
  return NULL;
}

void stratus_brick_ahead_stop(stratus_brick_pool* pool)
{
  if (pool->reads_ahead) {
    pthread_mutex_lock(&pool->lock);
    pool->ending = true;
    pthread_cond_broadcast(&pool->read);
    pthread_mutex_unlock(&pool->lock);
    pthread_join(pool->ahead, NULL);
    pool->reads_ahead = false;
  }
}

stratus_status stratus_bricks_read_ahead(stratus_bricks* bricks, stratus_bricks* like)
{
  if (!bricks) {
    return STRATUS_INVALID_ARGUMENT;
  }
  stratus_brick_pool* const pool = bricks->pool;
  const size_t size = sizeof bricks->source.dimensions;
  if (like && (like == bricks || like->pool != pool || memcmp(like->source.dimensions, bricks->source.dimensions, size) != 0)) {
    return stratus_fail(
      pool->context, STRATUS_INVALID_ARGUMENT, "bricks are read ahead like another array of the same pool and dimensions");
  }
  pthread_mutex_lock(&pool->lock);
  bricks->like = bricks->rows.memory < 0 ? NULL : like;
  if (bricks->like && !pool->reads_ahead) {
    pool->reads_ahead = stratus_brick_start_thread(&pool->ahead, read_ahead, pool);
  }
  pthread_cond_broadcast(&pool->read);
  pthread_mutex_unlock(&pool->lock);
  return STRATUS_OK;
}
