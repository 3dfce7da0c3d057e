/* SPDX-License-Identifier: BSD-3-Clause
 * Values of a large file as an array whose bricks are read from the file when something first reads them, in bounded memory. */
#ifndef STRATUS_PUBLIC_BRICKS_H
#define STRATUS_PUBLIC_BRICKS_H

#include "volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes the values of the box from `lo` on, of `size` values along each axis, x fastest, without gaps. The box is one or several bricks,
 * which are whole but for the array's ends. Returns 0, or another number if the values cannot be read: they then count as missing. Other
 * threads call it, several at once. It must not read values of bricks. */
typedef int (*stratus_brick_read_function)(void* user, const int64_t lo[3], const int64_t size[3], void* values);
typedef void (*stratus_brick_release_function)(void* user);

/* A file, or anything else that knows the values of a grid and can say those of a part of it. */
typedef struct stratus_brick_source {
  stratus_type type;
  int64_t dimensions[3]; /* number of values along x, y, z; each >= 1 */
  /* Values along x, y, z of the parts in which the source reads best, such as the chunks of a file; each >= 1. Parts begin at multiples of
   * it. The last ones along an axis are smaller. 1, 1, 1 if the source reads any box as well. */
  int64_t brick[3];
  /* Of a part of a larger grid: how many values of the first brick along x, y, z precede the part; below `brick`. Bricks then begin at
   * multiples of `brick` minus this. 0 (default): the first brick is whole. */
  int64_t before[3];
  /* Of several components: how many values along x each point of the grid has. Then dimensions[0], brick[0] and before[0] are
   * multiples of it. 0 counts as 1. */
  int64_t components;
  stratus_brick_read_function read;
  /* 0, or the identity of a stratus_volume of these values. Bricks of which its kept value ranges say that all values are the same are then
   * not read. */
  uint64_t identity;
  /* NULL, or of each brick, x fastest, the one value that all of its values are, or NaN; copied. Such bricks are not read. The array then
   * has tiles, whatever its size. Only for one component, of FLOAT32 or a type of 8 or 16 bits. */
  const float* only;
  /* NULL, or called once with `user`: by stratus_bricks_destroy(), or by stratus_bricks_create() if that fails. */
  stratus_brick_release_function release;
  void* user;
} stratus_brick_source;

/* The memory that the bricks of several arrays share, and the threads that read them. */
typedef struct stratus_brick_pool stratus_brick_pool;
/* An array of bricks. */
typedef struct stratus_bricks stratus_bricks;

typedef struct stratus_brick_pool_options {
  /* Bytes that the pool's bricks take at most. 0 (default): half of the memory that the machine, or the control group that the process is
   * in, has free when the pool is made. Less than 16 MiB counts as 16 MiB. */
  uint64_t memory;
  int threads; /* 0..64 that read bricks. 0 (default): as many as the context has, but at least 2 */
  /* 1: other memory that the process took since the pool was made counts in `memory`, too, such as value ranges and pictures, until half of
   * it, and 32 MiB, is left to bricks. Needs Linux's /proc. 0 (default): only bricks count. */
  int whole_process;
} stratus_brick_pool_options;

typedef struct stratus_brick_pool_report {
  /* 1: bricks are read when something first reads their values. 0: the system does not offer that (it needs Linux 5.14 or later, and a
   * process that may use userfaultfd), and stratus_bricks_create() reads all values. */
  int paged;
  uint64_t memory;        /* the limit, in bytes */
  uint64_t resident;      /* bytes of the bricks that are in memory */
  uint64_t resident_most; /* the most there were */
  uint64_t parts_read;    /* of all arrays, including arrays that were destroyed */
  uint64_t bytes_read;
} stratus_brick_pool_report;

typedef struct stratus_bricks_report {
  uint64_t parts;      /* into which the array is divided, and its tiles */
  uint64_t parts_here; /* in memory */
  uint64_t parts_read; /* how often a part was read; again after it was dropped */
  uint64_t parts_dropped;
  uint64_t bytes_read;
  uint64_t missing; /* bytes of values that the source could not read; they are NaN, integers 0 */
} stratus_bricks_report;

STRATUS_API stratus_brick_pool_options stratus_brick_pool_options_default(void);
STRATUS_API stratus_status stratus_brick_pool_create(
  stratus_context* context, const stratus_brick_pool_options* options, stratus_brick_pool** pool);
/* Changes the limit; 0: as in the options. Bricks beyond it are dropped when the next one is read. */
STRATUS_API stratus_status stratus_brick_pool_set_memory(stratus_brick_pool* pool, uint64_t memory);
STRATUS_API void stratus_brick_pool_get_report(stratus_brick_pool* pool, stratus_brick_pool_report* report);
/* The arrays of the pool must be destroyed before. */
STRATUS_API void stratus_brick_pool_destroy(stratus_brick_pool* pool);

/* Makes an array of all values of the source, of which none are read yet. The part of the array that is read and dropped as a whole is a
 * row of bricks along x, because neighbours along x share pages of memory; where that is less than 64 KiB, several rows or layers of them.
 * Readers of the array wait for its parts. Parts are dropped if they were not read for longest (by a clock with a second chance).
 *
 * An array that is larger than the pool's memory now has the same values in tiles, too: bricks, or several of less than 64 KiB, that are
 * read and dropped one by one. */
STRATUS_API stratus_status stratus_bricks_create(
  stratus_context* context, stratus_brick_pool* pool, const stratus_brick_source* source, stratus_bricks** bricks);
/* The values, x fastest, without gaps, for stratus_volume.values. They must not be written. System calls that read them give EFAULT where
 * they are not in memory. A process that fork() makes does not have them,
 * and frees nothing of them. */
STRATUS_API const void* stratus_bricks_values(const stratus_bricks* bricks);
/* The values in tiles, for stratus_volume.tiles, as long as the array lives; NULL if it has none. */
STRATUS_API const stratus_tiles* stratus_bricks_tiles(const stratus_bricks* bricks);
/* The parts in which the values are read, for stratus_volume.parts, as long as the array lives; NULL if all values are in memory. */
STRATUS_API const stratus_parts* stratus_bricks_parts(const stratus_bricks* bricks);
/* Where the missing bytes are counted, for stratus_volume.missing. */
STRATUS_API const uint64_t* stratus_bricks_missing(const stratus_bricks* bricks);
/* Where the parts are counted that were read because something waited for them. */
STRATUS_API const uint64_t* stratus_bricks_reads(const stratus_bricks* bricks);
STRATUS_API void stratus_bricks_get_report(stratus_bricks* bricks, stratus_bricks_report* report);
/* Lets a thread of the pool read, while nothing else does, the parts of the array that another one of the same pool and shape has in
 * memory: such as those of the next time step where rays read this one. It goes on while `like` is read, until `like` is destroyed or
 * another call replaces it; NULL ends it. No parts are dropped for it. */
STRATUS_API stratus_status stratus_bricks_read_ahead(stratus_bricks* bricks, stratus_bricks* like);
/* Nothing may read the values any more. */
STRATUS_API void stratus_bricks_destroy(stratus_bricks* bricks);

#ifdef __cplusplus
}
#endif

#endif
