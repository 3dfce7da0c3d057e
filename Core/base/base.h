/* SPDX-License-Identifier: BSD-3-Clause
 * What the files of the core share. Never installed, never included from outside Core/ but by white-box tests. */
#ifndef STRATUS_INTERNAL_H
#define STRATUS_INTERNAL_H

#include "stratus.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>

typedef struct stratus_device stratus_device;

struct stratus_context {
  stratus_context_options options; /* device is not kept: see device_name */
  int threads;
  stratus_device* device; /* NULL: the host draws */
  int isa;                /* of the host's traversal at most: 2 AVX-512, 1 AVX2, 0 any; tests lower it */
  char device_name[256];
  char message[1024];
};

/* Returns at once with the status of a call that failed. For functions that hold nothing to release. */
#define TRY(call)                                                                                                                          \
  do {                                                                                                                                     \
    const stratus_status try_status = (call);                                                                                              \
    if (try_status != STRATUS_OK) {                                                                                                        \
      return try_status;                                                                                                                   \
    }                                                                                                                                      \
  } while (0)

/* The same for functions with a `status` and a `cleanup:` label. */
#define TRY_CLEANUP(call)                                                                                                                  \
  do {                                                                                                                                     \
    status = (call);                                                                                                                       \
    if (status != STRATUS_OK) {                                                                                                            \
      goto cleanup;                                                                                                                        \
    }                                                                                                                                      \
  } while (0)

/* ---- context.c */

/* Leaves the message and returns the status. */
stratus_status stratus_fail(stratus_context* context, stratus_status status, const char* format, ...) __attribute__((format(printf, 3, 4)));
void stratus_log(stratus_context* context, stratus_log_level level, const char* format, ...) __attribute__((format(printf, 3, 4)));
/* STRATUS_CANCELLED if the caller's callback says so. */
stratus_status stratus_progress(stratus_context* context, const char* stage, double fraction);
/* count*size bytes (at least 1), 64-byte aligned, not cleared. Sets *memory; STRATUS_OVERFLOW, STRATUS_OUT_OF_MEMORY with a message. */
stratus_status stratus_allocate(stratus_context* context, size_t count, size_t size, void** memory);
stratus_status stratus_allocate_zero(stratus_context* context, size_t count, size_t size, void** memory);
void stratus_release(stratus_context* context, void* memory);
/* a*b*c into *product; STRATUS_OVERFLOW with `what` in the message. */
stratus_status stratus_product(stratus_context* context, const char* what, size_t a, size_t b, size_t c, size_t* product);
/* STRATUS_OVERFLOW where `count` items of `size` bytes, "points" say, can't be in any array. */
stratus_status stratus_array_check(stratus_context* context, const char* what, size_t count, size_t size);
double stratus_now_ms(void); /* monotonic clock */

/* ---- volume.c
 * Traversal, ranges and tables see a voxel as the float that stratus_volume_fetch() makes of it, its "fetched" value:
 * types of at most 24 bits and float32 as they are, wider ones as (float)((double)value - bias). Monotone, so the fetched
 * range is the range of the fetched. */
double stratus_volume_bias(
  const stratus_volume* volume); /* 0 for narrow types; else the finite value of least magnitude among some thousand, 0 if none */
float stratus_volume_fetch(const stratus_volume* volume, double bias, size_t index);
/* Size of the index box: cells between value positions, dimensions-1 at least 0. */
void stratus_volume_cells(const stratus_volume* volume, int64_t cells[3]);
bool stratus_type_is_wide(stratus_type type);
/* The least float that is not below a number, and the greatest that is not above. */
static inline float stratus_float_above(double number)
{
  const float nearest = (float)number;
  return (double)nearest < number ? nextafterf(nearest, INFINITY) : nearest;
}
static inline float stratus_float_below(double number)
{
  const float nearest = (float)number;
  return (double)nearest > number ? nextafterf(nearest, -INFINITY) : nearest;
}
/* 4x4 row-major affine: index coordinates -> world, and back. */
void stratus_volume_index_to_world(const stratus_volume* volume, double matrix[16]);
bool stratus_matrix_invert_affine(const double matrix[16], double inverse[16]);
void stratus_matrix_point(const double matrix[16], const double point[3], double result[3]);
void stratus_matrix_vector(const double matrix[16], const double vector[3], double result[3]);
static inline double stratus_vector_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/* One byte a cell, 1 where HIDDEN points or cells make it transparent; *hidden stays NULL if none is. cell_centered: a byte a value. */
stratus_status stratus_volume_hidden_cells(stratus_context* context, const stratus_volume* volume, uint8_t** hidden);
/* The cells that this piece owns (not DUPLICATE): the box [lo, hi) in cells (cell_centered: in values); everything without ghosts. */
void stratus_volume_owned(const stratus_volume* volume, int64_t lo[3], int64_t hi[3]);

/* ---- value_range.c */
struct stratus_value_range {
  stratus_context* context;
  int64_t blocks[3]; /* at least 1 each */
  int block_size;
  double bias; /* of the fetched values */
  bool wide;   /* whether several values may be fetched as one */
  float* lo;   /* blocks[0]*[1]*[2] fetched values; lo > hi (INFINITY, -INFINITY) where no voxel is finite */
  float* hi;
  uint8_t* gaps;  /* 1 where some voxel of the block is not finite or some cell hidden */
  float whole_lo; /* of all finite values */
  float whole_hi;
};

/* ---- transfer_table.c */

/* The transfer function as traversal samples it. Entry e of a fetched value s is stratus_table_entry(). Midpoint sampling reads
 * rgba[4 e]: colour times alpha, alpha, for one whole sample distance. Pre-integrated sampling reads the inclusive range of entries
 * between two values: sums[last+1] - sums[first] of each of the four rows. An entry with zero opacity is exactly 0 in both. */
typedef struct stratus_table {
  stratus_context* context;
  int size;            /* entries */
  float scale, offset; /* entry = (int) clamp(fma(s, scale, offset), 0, size-1) */
  int* next_shown;     /* size+1: smallest entry >= i with any opacity, `size` if none */
  float* rgba;   /* NULL if pre-integrated; behind the size*4 floats, 4 more an entry: optical depth of a whole sample distance, 0, 0, 0 */
  int32_t* sums; /* NULL if midpoint: 4 rows of size+1 running sums, of r tau, g tau, b tau, tau, in units of sum_scale; then 2 rows of
                  * `size` numbers of entries, see fill_opaque() */
  float sum_scale;   /* optical depth per entry and per sample distance */
  int has_opaque;    /* pre-integrated: 1 if any entry is of opacity 1 */
  float color_slope; /* pre-integrated: most that a colour changes between neighbouring entries with opacity, over the error allowed */
  int shown;         /* entries with opacity */
  int last_shown;    /* the last of them, -1 if none */
} stratus_table;

stratus_status stratus_table_create(stratus_context* context, const stratus_transfer* transfer, double bias, float lo, float hi,
  stratus_sampling sampling, double sample_distance, stratus_table** table);
/* Of at least so many entries, 1..65536. */
stratus_status stratus_table_create_fine(stratus_context* context, const stratus_transfer* transfer, double bias, float lo, float hi,
  stratus_sampling sampling, double sample_distance, int entries, stratus_table** table);
void stratus_table_destroy(stratus_table* table);
/* Of four bytes, that rgba or sums take with all that stands behind them. */
size_t stratus_table_words(const stratus_table* table);
/* The function at one value: colour, not multiplied by it, and opacity. */
void stratus_transfer_at(const stratus_transfer* transfer, double value, double rgba[4]);

static inline int stratus_table_entry(const stratus_table* table, float value)
{
  const float entry = fmaf(value, table->scale, table->offset);
  const float last = (float)(table->size - 1);
  return (int)(!(entry > 0.0f) ? 0.0f : entry > last ? last : entry); /* no number goes to 0 */
}

/* 1 if the table shows anything for any value interpolated within [lo, hi]: the hull is widened by more than interpolation can round. */
static inline int stratus_table_shows(const stratus_table* table, float lo, float hi)
{
  const float slack = 1e-6f * fmaxf(fabsf(lo), fabsf(hi));
  return lo <= hi && table->next_shown[stratus_table_entry(table, lo - slack)] <= stratus_table_entry(table, hi + slack);
}

/* ---- occupancy.c */
struct stratus_occupancy {
  stratus_context* context;
  int64_t blocks[3];
  int block_size;
  uint8_t* occupied; /* blocks[0]*[1]*[2]: 0 or 1 */
  int64_t count;
  int64_t lo[3], hi[3]; /* of the occupied blocks */
};

/* With pre-integration a block with gaps counts as occupied if anything shows at all: two blocks whose shared layer is not finite may lie
 * on both sides of a peak. (Blocks without gaps share finite voxels, so a cube of empty ones has one connected, transparent hull.) */
/* What is occupied in either; of the same blocks. */
void stratus_occupancy_add(stratus_occupancy* occupancy, const stratus_occupancy* other);
stratus_status stratus_occupancy_build(
  stratus_context* context, const stratus_value_range* ranges, const stratus_table* table, stratus_occupancy** occupancy);

/* ---- distance_map.c
 * What traversal reads, a byte a block: empty: 1..127, the distance; occupied: 128 + the distance to the nearest empty block, 1..127
 * (Chebyshev in all kinds but BLOCK, where it is 1). In a map of kind k the byte of block (i,j,k) for octant o is
 * bytes[o*map_bytes + (k*blocks[1] + j)*pitch + i], o = 0 in all kinds but OCTANT. */
struct stratus_distance_map {
  stratus_context* context;
  stratus_distance_kind kind;
  int64_t blocks[3];
  int block_size;
  size_t pitch;      /* blocks[0] rounded up to 64 */
  size_t map_bytes;  /* pitch*blocks[1]*blocks[2] */
  size_t bytes_size; /* all maps and 64 bytes of padding, which traversal may read */
  uint8_t* bytes;
  size_t bounds_at; /* > 0: where the bits of a float a block begin, for rays that look for extremes: kernels/ray_extremes.h */
  int tree_nodes;   /* > 0: no map but a tree as the march asks it, in the layout of kernels/tree_map.h; kind, pitch and map_bytes mean
                       nothing */
};

#endif
