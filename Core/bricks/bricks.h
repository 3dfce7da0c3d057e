/* SPDX-License-Identifier: BSD-3-Clause
 * Arrays of bricks, and the pool that holds their parts. */
#ifndef STRATUS_BRICKS_H
#define STRATUS_BRICKS_H

#include "stratus/bricks.h"
#include "base.h"
#include "volume.h"

#include <pthread.h>

/* State of a part. */
enum {
  STRATUS_PART_ABSENT,
  STRATUS_PART_READING, /* by one of the pool's threads, without the lock */
  STRATUS_PART_HERE,
  STRATUS_PART_RESTING, /* in memory; the next read of it is noticed */
  STRATUS_PART_STATE = 7,
  STRATUS_PART_EDGES = 8 /* its pages that other parts share are counted */
};

struct stratus_bricks {
  stratus_brick_pool* pool;
  stratus_bricks* next; /* of the pool */
  stratus_brick_source source;
  size_t bytes, row; /* of all values, and of a row along x */
  /* Paged: a mapping of `memory`, where a page that is not shown yet stops its readers. */
  char* values;
  size_t mapped;         /* bytes: whole pages */
  int memory;            /* the file of the mapping, which parts are written to; -1 if not paged */
  int64_t rows, layers;  /* of a part, along y and z */
  int64_t across, parts; /* parts along y, and in all */
  uint8_t* state;        /* of each part */
  float* only;           /* of each brick the one value that all of its values are, or NaN; NULL: nothing is known */
  stratus_bricks_report report;
};

/* Memory that a thread reads parts into. */
typedef struct stratus_brick_room {
  char* bytes;
  size_t capacity;
} stratus_brick_room;

struct stratus_brick_pool {
  stratus_context* context;
  pthread_mutex_t lock;
  pthread_cond_t read; /* a part was read */
  uint64_t memory, resident, resident_most, parts_read, bytes_read;
  stratus_bricks* first;
  stratus_bricks* hand; /* of the clock, at its part number hand_part */
  int64_t hand_part;
  int faults, quit; /* where the kernel reports pages that are read, and the handle that ends the threads; -1: not paged */
  size_t page;
  pthread_t threads[64];
  int thread_count;
};

/* ---- brick_parts.c: where parts are in the array, and how they are filled */

/* A range of bytes of the array. */
typedef struct stratus_brick_run {
  size_t begin, end;
} stratus_brick_run;

/* Chooses rows and layers of a part, so that it has runs of at least 64 KiB. */
void stratus_brick_parts_divide(stratus_bricks* bricks);
int64_t stratus_brick_runs(const stratus_bricks* bricks, int64_t part);
stratus_brick_run stratus_brick_run_at(const stratus_bricks* bricks, int64_t part, int64_t run);
/* Gives the part of the row of values (y,z) that a byte of the array is in. */
int64_t stratus_brick_part_of(const stratus_bricks* bricks, size_t byte);
/* Gives the pages that hold only this run, as a range of bytes: empty if there is none. */
stratus_brick_run stratus_brick_inner(const stratus_bricks* bricks, size_t page, stratus_brick_run run);
/* Returns the bytes of a part's values. */
uint64_t stratus_brick_part_bytes(const stratus_bricks* bricks, int64_t part);
/* Sets bricks->only by the value ranges that are kept, if any are. */
void stratus_brick_find_only(stratus_context* context, stratus_bricks* bricks);
/* Reads all values of a part into the room, run after run. Returns how many bytes of them the source could not read: all where there is no
 * memory for the room. */
uint64_t stratus_brick_part_read(const stratus_bricks* bricks, int64_t part, stratus_brick_room* room);

/* ---- brick_memory.c */

/* Returns half of the bytes of memory that the machine, or the process's control group, has free. */
uint64_t stratus_brick_memory_default(void);

#endif
