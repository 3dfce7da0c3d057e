/* SPDX-License-Identifier: BSD-3-Clause
 * Volumes, and the structures made from their blocks: value ranges, transfer tables, occupancy, distance maps. */
#ifndef STRATUS_VOLUME_H
#define STRATUS_VOLUME_H

#include "stratus/skipping.h"
#include "base.h"
#include "matrix.h"
#include "transfer_pieces.h"

/* ---- volume.c
 * Traversal, ranges and tables see a value as the float that stratus_volume_fetch() makes of it, its fetched value. Types of at most 24
 * bits and float32 are fetched unchanged, wider ones as (float)((double)value - bias). Fetching is monotone, so that the range of the
 * fetched values is the fetched range. */
/* Returns 0 for narrow types. For wide ones it returns the finite value of least magnitude among some thousand, 0 if there is none. */
double stratus_volume_bias(const stratus_volume* volume);
/* Returns whether any two finite fetched values differ. It stops at the first two. */
bool stratus_volume_floats_differ(const stratus_volume* volume, double bias);
stratus_status stratus_volume_check_floats(stratus_context* context, const stratus_volume* volume, double bias);
/* Fails where the values' source could not supply all of them. */
stratus_status stratus_volume_check_missing(stratus_context* context, const stratus_volume* volume);
float stratus_volume_fetch(const stratus_volume* volume, double bias, size_t index);
/* Gives the number of cells between value positions along each axis: dimensions-1, at least 0. */
void stratus_volume_cells(const stratus_volume* volume, int64_t cells[3]);
/* Return whether two views show the same values and ghosts, wherever they are in the world. Components are not compared. */
bool stratus_volume_same_data(const stratus_volume* a, const stratus_volume* b);
bool stratus_type_is_wide(stratus_type type);
bool stratus_type_is_integer(stratus_type type);
/* Sets values of a type that is not wide to one that it has. */
void stratus_type_fill(stratus_type type, float one, void* values, size_t count);
/* A box of a volume's values. */
typedef struct stratus_part {
  int64_t lo[3], size[3]; /* its first value, and values along each axis */
  const void* values;     /* NULL: all of them are `one` */
  size_t pitch[3];        /* bytes from a value to the next one along each axis */
  float one;
  void* room; /* where read() may put values. NULL at first; its reader frees it */
  size_t capacity;
} stratus_part;

/* Gives part `number`. `part` may hold another one before, whose room is then used again. Several threads call it at once. Values that
 * cannot be read count as missing.
 */
typedef void stratus_part_read_function(void* user, int64_t number, stratus_part* part);

struct stratus_parts {
  const void* values; /* of the array, which has this type and these dimensions */
  stratus_type type;
  int64_t dimensions[3];
  int64_t count; /* of parts; together they are all values, each once */
  stratus_part_read_function* read;
  void* user;
};

/* Returns all values of a volume as one part, in place. */
stratus_part stratus_volume_whole(const stratus_volume* volume);
/* Returns the rows y0..y1-1 of the layers z0..z1-1 of a part that has them. */
stratus_part stratus_part_rows(const stratus_part* part, int64_t y0, int64_t y1, int64_t z0, int64_t z1);
/* Returns the parts of all of the volume's values, if there are such. */
const stratus_parts* stratus_volume_parts(const stratus_volume* volume);
/* Return the least float that is not below a number, and the greatest that is not above it. */
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
static inline size_t stratus_volume_count(const stratus_volume* volume)
{
  return (size_t)volume->dimensions[0] * (size_t)volume->dimensions[1] * (size_t)volume->dimensions[2];
}
/* Whether the volume extends along an axis. */
static inline bool stratus_volume_extends(const stratus_volume* volume, int axis)
{
  return volume->dimensions[axis] > 1 || volume->cell_centered;
}
/* Whether any axis has coordinates. */
static inline bool stratus_volume_is_stretched(const stratus_volume* volume)
{
  return volume->coordinates[0] || volume->coordinates[1] || volume->coordinates[2];
}
/* Gives where an axis begins, at its first coordinate, less the volume's origin: 0 without coordinates. */
double stratus_volume_begin(const stratus_volume* volume, int axis);
/* Returns the spacing of an axis. With coordinates it is the mean one, negative where they fall. */
double stratus_volume_spacing(const stratus_volume* volume, int axis);
/* Get the 4x4 row-major affine matrix from index coordinates to world. Along axes with coordinates it maps mean index coordinates, which
 * are the index coordinates of a grid with the same ends and equal spacing. */
void stratus_volume_index_to_world(const stratus_volume* volume, double matrix[16]);
/* Sets *hidden to one byte for each cell (cell_centered: for each value), 1 where HIDDEN points or cells make it transparent. *hidden stays
 * NULL if there is no such cell. */
stratus_status stratus_volume_hidden_cells(stratus_context* context, const stratus_volume* volume, uint8_t** hidden);
/* Gives the cells that this piece owns (not DUPLICATE), as the box [lo, hi) in cells (cell_centered: in values). Without ghosts these are
 * all cells. Returns whether the box is of all cells. Reads all ghosts. */
bool stratus_volume_owned(const stratus_volume* volume, int64_t lo[3], int64_t hi[3]);

/* ---- value_range.c */
struct stratus_value_range {
  stratus_context* context;
  int64_t blocks[3]; /* each >= 1 */
  int block_size;
  double bias;  /* bias of the fetched values */
  bool wide;    /* several values may have the same fetched value */
  bool integer; /* values are whole numbers */
  float* lo;    /* blocks[0]*[1]*[2] fetched values; lo > hi (INFINITY, -INFINITY) where no voxel is finite */
  float* hi;
  uint8_t* gaps;               /* 1 where some voxel of the block is not finite, or some cell is hidden */
  bool on_device;              /* made by the context's device, */
  void *device_lo, *device_hi; /* which keeps lo and hi in these buffers; NULL where they are the host's arrays, or none */
  float whole_lo;              /* range of all finite values */
  float whole_hi;
};

/* Returns the size of blocks that rays skip: `wanted`, or 4 for 0, or larger if the maps of a large volume would take much memory. */
int stratus_value_range_block_size(const stratus_volume* volume, int wanted);
/* Returns the ranges of blocks of that size that are kept of the volume; NULL if none are. No value is read. */
stratus_value_range* stratus_value_range_find_kept(stratus_context* context, const stratus_volume* volume);

static inline stratus_fetching stratus_value_range_fetching(const stratus_value_range* ranges)
{
  return (stratus_fetching){ .bias = ranges->bias, .wide = ranges->wide, .integer = ranges->integer };
}

/* Bound on the rounding of a tetrahedron's interpolation beyond the range of its values, relative to the largest magnitude among them.
 *
 * The trilinear interpolation of volumes needs none: it never leaves the hull of its corners. v_lerp() is fma(t, d, a), where d is b - a
 * rounded and t a float in 0 <= t < 1, because it is a position less its whole part, which is exact. Then t <= 1 - 2^-24, and rounding has
 * made |d| greater than |b - a| by at most |d| 2^-24. So a + t d is between a and b, and so is the float that it is rounded to.
 *
 * The bounds of volumes' blocks in modes maximum and minimum have the slack, too (stratus_ray_modes_bounds): a larger bound is always safe.
 */
#define STRATUS_HULL_SLACK 1e-6f

/* ---- transfer_table.c */

/* Most entries of a table: rays hold entries in floats, which are exact that far. */
#define STRATUS_TABLE_MOST 8000000

/* The cell of a value in a table's uniform grid. NaN gives 0. */
static inline int stratus_grid_cell(float scale, float offset, int cells, float value)
{
  const float place = fmaf(value, scale, offset), last = (float)(cells - 1);
  return (int)(!(place > 0.0f) ? 0.0f : place > last ? last : place);
}

/* Returns the last of the entries first..beyond-1 that is the first, or whose bound is at most `value`. */
static inline int stratus_entry_within(const float* bound, int first, int beyond, float value)
{
  while (beyond - first > 1) {
    const int middle = first + (beyond - first) / 2;
    if (bound[middle] <= value) {
      first = middle;
    } else {
      beyond = middle;
    }
  }
  return first;
}

/* The transfer function as traversal samples it. stratus_table_entry() gives the entry e of a fetched value. Midpoint sampling reads
 * colour times alpha, and alpha, from rgba[4*e] on, for one whole sample distance. Pre-integrated sampling reads the inclusive range of
 * entries between two values: sums[4*(last+1)+c] - sums[4*first+c] for each of the four. An entry with zero opacity is exactly 0 in both.
 * An entry has opacity only if the function shows on all floats that have that entry: where the function is transparent the table is, too.
 */
typedef struct stratus_table {
  stratus_context* context;
  int size;            /* number of entries */
  int cells;           /* of the uniform grid: cell = (int) clamp(fma(s, scale, offset), 0, cells-1) */
  float scale, offset; /* of the grid */
  int search_steps;    /* 0: entries are cells. Otherwise cells have several entries, and this many bisections find one */
  bool preintegrated;  /* it has sums, otherwise rgba */
  bool jumps;          /* the function has vertical steps, or features narrower than a cell */
  int* next_shown;     /* size+1 numbers: the smallest entry >= i with any opacity, `size` if there is none */
  /* NULL if pre-integrated. Behind the size*4 floats follow 4 more for each entry: the optical depth of a whole sample distance, 0, 0,
   * 0. */
  float* rgba;
  /* NULL if midpoint. The running sums of r tau, g tau, b tau and tau up to each of size+1 entries, in units of sum_scale. Then two rows of
   * `size` entry numbers, see fill_opaque(). If entries are not cells, then a row of size+1 running sums of widths, which the other sums'
   * terms are multiplied by. */
  int32_t* sums;
  /* If entries are not cells: the first entry of each cell, and `size`; the bound at which each entry begins that is not its cell's first.
   * Both are behind rgba or sums, in the same allocation. */
  const int32_t* first;
  const float* bound;
  double tau_per_sum; /* optical depth per entry (or width) and per unit of length */
  float sum_scale;    /* the same per sample distance */
  bool cut;           /* pre-integrated: values lie beyond the table, and are transparent there */
  int has_opaque;     /* pre-integrated: 1 if any entry has opacity 1 */
  /* pre-integrated: the number of stretches, see table_stretches.h, and of bisections that find one; 0: the function has none */
  int stretches, stretch_steps;
  /* Pre-integrated: the largest change of colour between neighbouring entries with opacity, per entry (or width), and that over all entries
   * with opacity, divided by the error allowed. */
  float color_slope, color_most;
  int shown;      /* number of entries with opacity */
  int last_shown; /* the last of them, -1 if none */
} stratus_table;

/* The values that a table serves: the finite fetched ones from lo to hi. */
typedef struct stratus_table_values {
  stratus_fetching fetching;
  float lo, hi;
  bool nearest; /* values are not interpolated */
  bool sums;    /* the table is one of running sums; set by stratus_table_create_fine() */
  bool uniform; /* entries are the cells of the grid, and each is the function at its middle, whatever else it mixes */
} stratus_table_values;

/* The values of a volume. One without finite values has a table of the value 0. */
stratus_table_values stratus_table_values_of(const stratus_value_range* ranges, bool nearest);
/* Returns how many entries a table takes at least, so that their width errs by less than the tolerance of the picture. */
int stratus_table_entries_for(stratus_sampling sampling, double tolerance);
stratus_status stratus_table_create(stratus_context* context, const stratus_transfer* transfer, const stratus_table_values* values,
  stratus_sampling sampling, double sample_distance, stratus_table** table);
/* Makes a table of at least `entries` entries, 1..65536, or about as many where values are whole numbers. */
stratus_status stratus_table_create_fine(stratus_context* context, const stratus_transfer* transfer, const stratus_table_values* values,
  stratus_sampling sampling, double sample_distance, int entries, stratus_table** table);
/* Makes a pre-integrated table one for another sample distance. */
void stratus_table_set_distance(stratus_table* table, double sample_distance);
void stratus_table_destroy(stratus_table* table);
/* Returns the size, in words of four bytes, of rgba or sums with all that follows them. */
size_t stratus_table_words(const stratus_table* table);
/* Returns the width of a cell in the row of widths; 1 if entries are cells. */
int stratus_table_unit(const stratus_table* table);
/* Return where in these words the widths, first[] and bound[] begin; meant for tables whose entries are not cells. */
size_t stratus_table_widths_at(const stratus_table* table);
size_t stratus_table_first_at(const stratus_table* table);
size_t stratus_table_bound_at(const stratus_table* table);
/* Returns where in these words the stretches begin. */
size_t stratus_table_stretches_at(const stratus_table* table);
/* Gives the function at one value: colour, not multiplied by opacity, and opacity. */
void stratus_transfer_at(const stratus_transfer* transfer, double value, double rgba[4]);

static inline int stratus_table_entry(const stratus_table* table, float value)
{
  const int cell = stratus_grid_cell(table->scale, table->offset, table->cells, value);
  return table->first ? stratus_entry_within(table->bound, table->first[cell], table->first[cell + 1], value) : cell;
}

/* Returns 1 if the table shows anything for any value interpolated within [lo, hi]. The range is widened by more than interpolation can
 * round. */
static inline int stratus_table_shows(const stratus_table* table, float lo, float hi)
{
  const float slack = STRATUS_HULL_SLACK * fmaxf(fabsf(lo), fabsf(hi));
  return lo <= hi && table->next_shown[stratus_table_entry(table, lo - slack)] <= stratus_table_entry(table, hi + slack);
}

/* ---- transfer_copy.c */
/* Returns whether two functions give the same opacity everywhere. */
bool stratus_transfer_same_opacity(const stratus_transfer* a, const stratus_transfer* b);
/* Compares what a stratus_table is made from: opacity, colour and unit distance. */
bool stratus_transfer_same_table(const stratus_transfer* a, const stratus_transfer* b);
/* Compares all fields and points. */
bool stratus_transfer_same(const stratus_transfer* a, const stratus_transfer* b);
/* Copies `count` functions with their points into one allocation, which the caller releases. */
stratus_status stratus_transfer_copy(stratus_context* context, const stratus_transfer* transfers, int count, stratus_transfer** copy);

/* ---- occupancy.c */
struct stratus_occupancy {
  stratus_context* context;
  int64_t blocks[3];
  int block_size;
  uint8_t* occupied; /* blocks[0]*[1]*[2] bytes, 0 or 1 */
  int64_t count;
  int64_t lo[3], hi[3]; /* box of the occupied blocks */
};

/* Adds the occupied blocks of `other`, which has the same blocks. */
void stratus_occupancy_add(stratus_occupancy* occupancy, const stratus_occupancy* other);
/* Mark the blocks whose range meets an interval of fetched values that show. gaps: a block with gaps counts as occupied if anything shows
 * at all. Segments between two samples need this: two blocks whose shared layer is not finite may be on both sides of a peak. Blocks
 * without gaps share finite voxels, so that a cube of empty blocks has one connected, transparent hull. */
stratus_status stratus_occupancy_build(
  stratus_context* context, const stratus_value_range* ranges, const stratus_shown* shown, bool gaps, stratus_occupancy** occupancy);
/* Marks the blocks whose byte is below `beyond`. */
stratus_status stratus_occupancy_below(
  stratus_context* context, const int64_t blocks[3], int block_size, const uint8_t* bytes, uint8_t beyond, stratus_occupancy** occupancy);

/* ---- distance_map.c
 * One byte for each block. Traversal reads maps of all kinds except PAPER. Of an empty block it is the distance, 1..127. Of an occupied
 * block it is 128 plus the distance to the nearest empty block, 1..127 (Chebyshev in all kinds except BLOCK, where it is 1). PAPER has the
 * paper's own bytes: 0 in an occupied block, elsewhere the distance, 1..255. In a map of kind k the byte of block (i,j,k) for octant o is
 * bytes[o*map_bytes + (k*blocks[1] + j)*pitch + i]; o is 0 in all kinds except OCTANT. */
struct stratus_distance_map {
  stratus_context* context;
  stratus_distance_kind kind;
  int64_t blocks[3];
  int block_size;
  size_t pitch;      /* blocks[0] rounded up to 64 */
  size_t map_bytes;  /* pitch*blocks[1]*blocks[2] */
  size_t bytes_size; /* all maps and 64 bytes of padding, which traversal may read */
  uint8_t* bytes;
  /* If > 0, the offset in bytes[] of one float for each block: a bound on its largest value, or on the negative of its smallest. Rays that
   * look for extremes skip blocks by it, see kernels/field/ray_extremes.h. */
  size_t bounds_at;
  /* If > 0, bytes[] holds no map but a tree of so many nodes, in the layout of kernels/field/tree_map.h. kind, pitch and map_bytes then
   * mean nothing. */
  int tree_nodes;
};

/* Returns the binary logarithm of the size of the map's blocks. */
static inline int stratus_distance_map_block_log2(const stratus_distance_map* map)
{
  int log2 = 0;
  while (1 << log2 < map->block_size) {
    ++log2;
  }
  return log2;
}

#endif
