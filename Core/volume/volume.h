/* SPDX-License-Identifier: BSD-3-Clause
 * Volumes and what is made of them block by block: value ranges, transfer tables, occupancy, distance maps. */
#ifndef STRATUS_VOLUME_H
#define STRATUS_VOLUME_H

#include "stratus/skipping.h"
#include "base.h"
#include "matrix.h"

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

/* Interpolation may round beyond the range of the values that it interpolates, by less than this part of the largest in magnitude. */
#define STRATUS_HULL_SLACK 1e-6f

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
  const float slack = STRATUS_HULL_SLACK * fmaxf(fabsf(lo), fabsf(hi));
  return lo <= hi && table->next_shown[stratus_table_entry(table, lo - slack)] <= stratus_table_entry(table, hi + slack);
}

/* ---- transfer_copy.c */
/* Whether two functions give the same opacity everywhere; and whether all of them is the same. */
bool stratus_transfer_same_opacity(const stratus_transfer* a, const stratus_transfer* b);
bool stratus_transfer_same(const stratus_transfer* a, const stratus_transfer* b);
/* `count` functions with their points, one allocation that the caller releases. */
stratus_status stratus_transfer_copy(stratus_context* context, const stratus_transfer* transfers, int count, stratus_transfer** copy);

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
