/* SPDX-License-Identifier: BSD-3-Clause
 * All values of an array part after part, for code that reads each once. A part is read into its reader's room. The pool gets a copy if
 * rays will read this layout of the array: it then rests, as the first to be dropped. */
#include "bricks.h"

#include <math.h>
#include <string.h>

/* The layout whose parts are scanned. */
static stratus_brick_view* scanned(stratus_bricks* bricks)
{
  return bricks->lists_only && bricks->tiles.parts > 0 ? &bricks->tiles : &bricks->rows;
}

/* Reads a part into the room, but for one that is in memory: then nothing is read, and false is returned. */
static bool read_into(stratus_brick_view* view, int64_t part, stratus_brick_room* room)
{
  stratus_bricks* const bricks = view->bricks;
  stratus_brick_pool* const pool = bricks->pool;
  pthread_mutex_lock(&pool->lock);
  stratus_brick_enter(bricks);
  ++pool->serving;
  while ((view->state[part] & STRATUS_PART_STATE) == STRATUS_PART_READING) {
    pthread_cond_wait(&pool->read, &pool->lock);
  }
  const bool absent = (view->state[part] & STRATUS_PART_STATE) == STRATUS_PART_ABSENT;
  if (absent && (view->tiled || bricks->tiles.parts == 0)) {
    (void)stratus_brick_read_part(view, part, room, STRATUS_BRICK_SCANNED);
  } else if (absent) {
    pthread_mutex_unlock(&pool->lock);
    const uint64_t missing = stratus_brick_part_read(view, part, room);
    pthread_mutex_lock(&pool->lock);
    if (room->bytes) {
      stratus_brick_count_read(view, part, missing, STRATUS_BRICK_SCANNED);
    }
  }
  --pool->serving;
  pool->served = stratus_now_ms();
  stratus_brick_leave(bricks);
  pthread_mutex_unlock(&pool->lock);
  return absent && room->bytes;
}

static void read_part(void* user, int64_t number, stratus_part* part)
{
  stratus_bricks* const bricks = user;
  stratus_brick_view* const view = scanned(bricks);
  int64_t inset[3];
  stratus_brick_part_box(view, number, part->lo, part->size, inset, part->pitch);
  part->values = NULL;
  part->one = stratus_brick_only_value(bricks, part->lo, part->size);
  if (!isnan(part->one)) {
    return;
  }
  stratus_brick_room room = { .bytes = part->room, .capacity = part->capacity };
  const char* first = NULL;
  if (read_into(view, number, &room)) {
    first = room.bytes;
  } else {
    first = view->values + stratus_brick_run_at(view, number, 0).begin;
    if (!view->tiled) {
      part->pitch[1] = part->pitch[0] * (size_t)bricks->source.dimensions[0];
      part->pitch[2] = part->pitch[1] * (size_t)bricks->source.dimensions[1];
    }
  }
  part->room = room.bytes;
  part->capacity = room.capacity;
  for (int a = 0; a < 3; ++a) {
    first += (size_t)inset[a] * part->pitch[a];
  }
  part->values = first;
}

void stratus_brick_set_parts(stratus_bricks* bricks)
{
  const stratus_brick_view* const view = scanned(bricks);
  bricks->parts = (stratus_parts){ .values = bricks->rows.values,
    .type = bricks->source.type,
    .count = view->parts,
    .read = view->memory < 0 ? NULL : read_part,
    .user = bricks };
  memcpy(bricks->parts.dimensions, bricks->source.dimensions, sizeof bricks->parts.dimensions);
}
