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

/* The values in memory, in one of two layouts: x fastest through the whole array, or tile after tile. */
typedef struct stratus_brick_view {
  stratus_bricks* bricks;
  struct stratus_brick_view* next; /* of the pool */
  bool tiled;
  size_t bytes; /* of all values, and what fills up tiles */
  /* Paged: a mapping of `memory`, where a page that is not shown yet stops its readers. */
  char* values;
  size_t mapped;     /* bytes: whole pages */
  int memory;        /* the file of the mapping, which parts are written to; -1 if not paged */
  int64_t side[3];   /* values along each axis of a part, which is read and dropped as a whole */
  int64_t before[3]; /* values of the first part that precede the array */
  int64_t across[3]; /* parts along each axis */
  int64_t parts;     /* and in all */
  size_t tile;       /* bytes from a tile to the next: whole pages */
  uint8_t* state;    /* of each part */
  uint32_t* brought; /* of each part: the pool's count when it was last brought */
  int64_t ahead;     /* the part where the search for one to read ahead goes on */
  uint64_t shared;   /* bytes in memory of pages that parts share */
  uint64_t emptied;  /* how often all parts were dropped, with the pages that they share */
} stratus_brick_view;

struct stratus_bricks {
  stratus_brick_pool* pool;
  stratus_brick_source source;
  stratus_brick_view rows;  /* the array */
  stratus_brick_view tiles; /* the same values for rays; no parts if the array fits in the pool's memory */
  uint64_t* at[3];          /* offsets in `shown` */
  stratus_tiles shown;
  stratus_parts parts;  /* for code that reads all values: rows, or tiles if the source lists bricks of one value */
  bool lists_only;      /* it does */
  uint64_t waited_for;  /* parts that were read because something waited for them */
  stratus_bricks* like; /* its parts are read ahead; NULL: none */
  int threads;          /* of the pool that bring parts now; the array stays until there are none */
  bool leaves;          /* it is to be destroyed */
  float* only;          /* of each brick the one value that all of its values are, or NaN; NULL: nothing is known */
  stratus_bricks_report report;
};

/* Memory that a thread reads parts into. */
typedef struct stratus_brick_room {
  char* bytes;
  size_t capacity;
} stratus_brick_room;

struct stratus_brick_pool {
  stratus_context* context;
  long process; /* whose the threads are: a process that fork() makes has none */
  pthread_mutex_t lock;
  pthread_cond_t read; /* a part was read */
  uint64_t memory, resident, resident_most, parts_read, bytes_read;
  bool whole_process;    /* the process's own memory counts */
  uint64_t began, grown; /* its bytes when the pool was made, and those that were added */
  double looked;         /* when that was found, by stratus_now_ms() */
  stratus_brick_view* first;
  stratus_brick_view* hand; /* of the clock, at its part number hand_part */
  int64_t hand_part;
  uint64_t parts_here; /* in memory, of all arrays that are paged */
  uint32_t brought;    /* how often parts were brought: read, or read by something again while they rested */
  int faults, quit;    /* where the kernel reports pages that are read, and the handle that ends the threads; -1: not paged */
  size_t page;
  pthread_t threads[64];
  int thread_count;
  pthread_t ahead; /* the thread that reads ahead */
  bool reads_ahead, ending;
  int serving;   /* threads that bring what something waits for */
  double served; /* when the last of them did, by stratus_now_ms() */
};

/* ---- brick_pages.c: pages that stop their readers, where the system has them */

/* Opens the system's handle for pages of a pool, and starts threads that serve it. Where there is none, pool->faults stays -1. */
void stratus_brick_pages_start(stratus_brick_pool* pool, int threads);
void stratus_brick_pages_stop(stratus_brick_pool* pool);
/* Maps a view. Returns false if the system does not; stratus_brick_unmap() frees what there is. */
bool stratus_brick_map(stratus_brick_view* view);
void stratus_brick_unmap(stratus_brick_view* view);
/* Puts the runs of a part from the room into the view. Returns how many bytes could not be written, for want of memory. */
uint64_t stratus_brick_store_part(const stratus_brick_view* view, int64_t part, const stratus_brick_room* room);
/* Why a part is read: something waits for its values; nothing does yet; or all parts are read once, as for value ranges. */
typedef enum stratus_brick_reason { STRATUS_BRICK_WAITED_FOR, STRATUS_BRICK_AHEAD, STRATUS_BRICK_SCANNED } stratus_brick_reason;

/* Counts a part that was read. With the pool's lock. */
void stratus_brick_count_read(stratus_brick_view* view, int64_t part, uint64_t missing, stratus_brick_reason reason);

/* Reads a part that is absent, with the pool's lock on entry and on return, but not while the source reads. Other parts are dropped for it;
 * but if it is read ahead, none are, and false is returned where there is no room. */
bool stratus_brick_read_part(stratus_brick_view* view, int64_t part, stratus_brick_room* room, stratus_brick_reason reason);
/* Returns the bytes of a view's parts that are in memory, and of the pages that they share. */
uint64_t stratus_brick_resident(const stratus_brick_view* view);

/* Counts a thread that brings parts of an array, and no longer does. With the pool's lock. */
void stratus_brick_enter(stratus_bricks* bricks);
void stratus_brick_leave(stratus_bricks* bricks);

typedef void* stratus_brick_thread_function(void* user);
/* Starts a thread that takes no signals: the program's handlers run in its own threads. It takes faults of its own, such as SIGBUS of a
 * source that maps a file. */
bool stratus_brick_start_thread(pthread_t* thread, stratus_brick_thread_function* run, void* user);

/* ---- brick_ahead.c */

/* Ends the thread that reads ahead, if there is one. */
void stratus_brick_ahead_stop(stratus_brick_pool* pool);

/* ---- brick_parts.c: where parts are in the array, and how they are filled */

/* A range of bytes of the array. */
typedef struct stratus_brick_run {
  size_t begin, end;
} stratus_brick_run;

/* Chooses the parts of the array: rows of bricks along x that have runs of at least 64 KiB. */
void stratus_brick_rows_divide(stratus_brick_view* view);
/* Chooses tiles of whole bricks, of at least 64 KiB, and makes the offsets of their values. Returns false if there is no memory for them.
 */
bool stratus_brick_tiles_divide(stratus_brick_view* view, size_t page);
int64_t stratus_brick_runs(const stratus_brick_view* view, int64_t part);
stratus_brick_run stratus_brick_run_at(const stratus_brick_view* view, int64_t part, int64_t run);
/* Gives the part that a byte of the view is in, and in *end the first byte behind it that may be in another part. */
int64_t stratus_brick_part_of(const stratus_brick_view* view, size_t byte, size_t* end);
/* Gives the pages that hold only this run, as a range of bytes: empty if there is none. */
stratus_brick_run stratus_brick_inner(const stratus_brick_view* view, size_t page, stratus_brick_run run);
/* Returns the bytes of a part's values. */
uint64_t stratus_brick_part_bytes(const stratus_brick_view* view, int64_t part);
/* Gives the box of values of a part, where its first value is in its tile, and how many bytes rows and layers of it are apart in a room. */
void stratus_brick_part_box(
  const stratus_brick_view* view, int64_t part, int64_t lo[3], int64_t size[3], int64_t inset[3], size_t pitch[3]);
/* Returns the one value that all bricks of a box are known to have, or NaN. */
float stratus_brick_only_value(const stratus_bricks* bricks, const int64_t lo[3], const int64_t size[3]);
/* Sets bricks->only by the source's own list, else by the value ranges that are kept, if any are. */
void stratus_brick_find_only(stratus_context* context, stratus_bricks* bricks);
/* Reads all values of a part into the room, run after run. Returns how many bytes of them the source could not read: all where there is no
 * memory for the room. */
uint64_t stratus_brick_part_read(const stratus_brick_view* view, int64_t part, stratus_brick_room* room);

/* ---- brick_memory.c */

/* Returns half of the bytes of memory that the machine, or the process's control group, has free. */
uint64_t stratus_brick_memory_default(void);
/* Returns the bytes of the process's memory that are of no file: not the bytes of bricks, either. 0 where the system does not say. */
uint64_t stratus_brick_memory_private(void);
/* Returns the bytes that the pool's bricks may take now. With the pool's lock. */
uint64_t stratus_brick_memory_left(stratus_brick_pool* pool);

/* ---- brick_scan.c */

/* Sets bricks->parts, once the array has its views. */
void stratus_brick_set_parts(stratus_bricks* bricks);

#endif
