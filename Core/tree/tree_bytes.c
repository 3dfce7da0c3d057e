/* SPDX-License-Identifier: BSD-3-Clause
 * Trees as bytes: a header, then the arrays, each at a multiple of 8. Loading checks all sizes, numbers and leaps before it returns a tree,
 * so that no bytes can lead traversal out of the arrays. */
#include "tree.h"
#include "voxels_build.h"
#include "volume_hash.h"
#include "matrix.h"

#include <string.h>

#define MAGIC 0x3142545354525453ull /* "STRTSTB1" as a little-endian number; machines of other byte orders read another number */
#define VERSION 1
#define WRONG(...) stratus_fail(context, STRATUS_INVALID_ARGUMENT, __VA_ARGS__)

typedef struct header {
  uint64_t magic, size, checksum; /* the checksum is of all bytes behind it */
  int32_t version, method;
  int32_t dimensions[3], leaps, entry_bytes, cell_log2;
  uint32_t node_count, brick_count, field_count, entry_count, row_count, mask_count;
  int64_t voxels, bricks;
  double bandwidth;
  int32_t splits[4];
  char why[256];
  double index_to_world[16];
  stratus_origin origin;
} header;

/* Values of `leaps`. */
enum { LEAPS_CHEBYSHEV, LEAPS_OCTANTS, LEAPS_UNCORRECTED };

_Static_assert(sizeof(header) % 8 == 0 && sizeof(stratus_tree_node) == 32 && sizeof(stratus_brick) == 16, "records have no padding");
_Static_assert(sizeof(stratus_tree_field) == 32, "records have no padding");

/* A hash that multiplies and folds eight bytes at a time. It detects damage, not forgery. */
static uint64_t checksum(const void* bytes, size_t size)
{
  const unsigned char* p = bytes;
  uint64_t h = 0x9e3779b97f4a7c15ull ^ size;
  for (; size >= 8; size -= 8, p += 8) {
    uint64_t word;
    memcpy(&word, p, 8);
    h = (h ^ word) * 0xff51afd7ed558ccdull;
    h ^= h >> 32;
  }
  for (; size > 0; --size, ++p) {
    h = (h ^ *p) * 0xff51afd7ed558ccdull;
    h ^= h >> 29;
  }
  return h;
}

#define ARRAYS 6

/* Computes the sizes of the arrays in bytes. Returns the size of the header and the arrays, each array rounded up to 8. */
static size_t array_sizes(const header* h, size_t sizes[ARRAYS])
{
  const size_t plain[ARRAYS] = { h->node_count * sizeof(stratus_tree_node), h->brick_count * sizeof(stratus_brick),
    h->field_count * sizeof(stratus_tree_field), h->entry_count * (size_t)h->entry_bytes + 4, h->row_count * sizeof(uint32_t),
    h->mask_count * sizeof(uint64_t) };
  size_t sum = sizeof *h;
  for (int i = 0; i < ARRAYS; ++i) {
    sizes[i] = plain[i];
    sum += (plain[i] + 7) / 8 * 8;
  }
  return sum;
}

static header header_of(const stratus_tree* tree)
{
  const stratus_tree_statistics* s = &tree->statistics;
  header h;
  memset(&h, 0, sizeof h);
  h.magic = MAGIC;
  h.version = VERSION;
  h.method = (int32_t)s->method;
  memcpy(h.dimensions, tree->dimensions, sizeof h.dimensions);
  h.leaps = tree->octants ? LEAPS_OCTANTS : s->uncorrected ? LEAPS_UNCORRECTED : LEAPS_CHEBYSHEV;
  h.entry_bytes = tree->entry_bytes;
  h.cell_log2 = tree->cell_log2;
  h.node_count = tree->node_count;
  h.brick_count = tree->brick_count;
  h.field_count = tree->field_count;
  h.entry_count = tree->entry_count;
  h.row_count = tree->row_count;
  h.mask_count = tree->mask_count;
  h.voxels = s->voxels;
  h.bricks = s->bricks;
  h.bandwidth = s->bandwidth;
  const int32_t splits[4] = { s->dbscan_splits, s->density_splits, s->sah_splits, s->median_splits };
  memcpy(h.splits, splits, sizeof splits);
  memcpy(h.why, s->why, sizeof h.why);
  memcpy(h.index_to_world, tree->index_to_world, sizeof h.index_to_world);
  h.origin = tree->origin;
  return h;
}

uint64_t stratus_tree_hash(const stratus_tree* tree)
{
  return tree ? tree->origin.hash : 0;
}

size_t stratus_tree_bytes(const stratus_tree* tree)
{
  if (!tree) {
    return 0;
  }
  const header h = header_of(tree);
  size_t sizes[ARRAYS];
  return array_sizes(&h, sizes);
}

void stratus_tree_seal(void* bytes, size_t size)
{
  const size_t from = offsetof(header, version);
  const uint64_t length = size, sum = checksum((unsigned char*)bytes + from, size - from);
  memcpy((unsigned char*)bytes + offsetof(header, size), &length, sizeof length);
  memcpy((unsigned char*)bytes + offsetof(header, checksum), &sum, sizeof sum);
}

void stratus_tree_save(const stratus_tree* tree, void* bytes)
{
  if (!tree || !bytes) {
    return;
  }
  header h = header_of(tree);
  const void* const arrays[ARRAYS] = { tree->nodes, tree->bricks, tree->fields, tree->entries, tree->rows, tree->masks };
  size_t sizes[ARRAYS];
  unsigned char* p = bytes;
  const size_t size = array_sizes(&h, sizes);
  memset(p, 0, size);
  p += sizeof h;
  for (int i = 0; i < ARRAYS; ++i) {
    if (arrays[i]) {
      memcpy(p, arrays[i], sizes[i]);
    }
    p += (sizes[i] + 7) / 8 * 8;
  }
  memcpy(bytes, &h, sizeof h);
  stratus_tree_seal(bytes, size);
}

/* ---------------------------------------------------------------- loading */

static stratus_status check_header(stratus_context* context, const header* h, const void* bytes, size_t size)
{
  size_t sizes[ARRAYS];
  if (h->magic != MAGIC) {
    return WRONG("the bytes are no tree, or of another byte order");
  }
  if (h->version != VERSION) {
    return WRONG("a tree of version %d; this program reads %d", h->version, VERSION);
  }
  if (h->size != size || (h->entry_bytes != 2 && h->entry_bytes != 3) || array_sizes(h, sizes) != size) {
    return WRONG("a tree of %llu bytes, of which %zu are here", (unsigned long long)h->size, size);
  }
  const size_t from = offsetof(header, version);
  if (checksum((const unsigned char*)bytes + from, size - from) != h->checksum) {
    return WRONG("a tree whose checksum does not fit: it was changed or damaged");
  }
  bool fine = h->method >= 0 && h->method < STRATUS_TREE_AUTO && h->leaps >= LEAPS_CHEBYSHEV && h->leaps <= LEAPS_UNCORRECTED &&
    (h->cell_log2 == 0 || h->cell_log2 == 2) && (h->leaps != LEAPS_UNCORRECTED || h->cell_log2 == 0) &&
    (h->leaps != LEAPS_OCTANTS || h->cell_log2 == 2) && (h->leaps == LEAPS_OCTANTS || h->entry_bytes == 2) &&
    h->why[sizeof h->why - 1] == 0 && h->origin.intervals >= 0 && h->origin.intervals <= STRATUS_INTERVALS_MAX && h->voxels >= 0 &&
    h->bricks >= 0 && (h->node_count == 0) == (h->voxels == 0) && (uint64_t)h->entry_count * (uint64_t)h->entry_bytes <= INT32_MAX &&
    h->row_count <= INT32_MAX / 4 && h->mask_count <= INT32_MAX / 8;
  for (int a = 0; a < 3; ++a) {
    fine = fine && h->dimensions[a] >= 1 && h->dimensions[a] <= STRATUS_AXIS_MAX;
  }
  for (int32_t i = 0; fine && i < h->origin.intervals; ++i) {
    const double* interval = h->origin.interval[i];
    /* An inverted interval stands for more intervals than an origin can store. It covers no criterion. */
    const bool emptied = h->origin.intervals == 1 && interval[0] == INFINITY && interval[1] == -INFINITY;
    fine = emptied || (interval[0] <= interval[1] && (i == 0 || h->origin.interval[i - 1][1] < interval[0]));
  }
  return fine ? STRATUS_OK : WRONG("a tree whose header contradicts itself");
}

static stratus_status copy_array(stratus_context* context, const unsigned char** from, size_t bytes, void** to)
{
  TRY(stratus_allocate(context, bytes, 1, to));
  memcpy(*to, *from, bytes);
  *from += (bytes + 7) / 8 * 8;
  return STRATUS_OK;
}

static stratus_status read_arrays(stratus_context* context, const header* h, const void* bytes, stratus_tree* tree)
{
  const unsigned char* p = (const unsigned char*)bytes + sizeof *h;
  size_t sizes[ARRAYS];
  void* arrays[ARRAYS] = { NULL };
  stratus_status status = STRATUS_OK;
  array_sizes(h, sizes);
  for (int i = 0; i < ARRAYS && status == STRATUS_OK; ++i) {
    status = copy_array(context, &p, sizes[i], &arrays[i]);
  }
  tree->nodes = arrays[0];
  tree->bricks = arrays[1];
  tree->fields = arrays[2];
  tree->entries = arrays[3];
  tree->rows = arrays[4];
  tree->masks = arrays[5];
  return status;
}

static stratus_status fill_tree(stratus_context* context, const header* h, const void* bytes, stratus_tree* tree)
{
  stratus_tree_statistics* s = &tree->statistics;
  tree->context = context;
  memcpy(tree->dimensions, h->dimensions, sizeof h->dimensions);
  memcpy(tree->index_to_world, h->index_to_world, sizeof h->index_to_world);
  if (!stratus_matrix_invert_affine(tree->index_to_world, tree->world_to_index)) {
    return WRONG("the tree's matrix can't be inverted");
  }
  tree->origin = h->origin;
  tree->octants = h->leaps == LEAPS_OCTANTS;
  tree->entry_bytes = h->entry_bytes;
  tree->cell_log2 = h->cell_log2;
  tree->node_count = h->node_count;
  tree->brick_count = h->brick_count;
  tree->field_count = h->field_count;
  tree->entry_count = h->entry_count;
  tree->row_count = h->row_count;
  tree->mask_count = h->mask_count;
  *s = (stratus_tree_statistics){ .method = (stratus_tree_method)h->method,
    .voxels = h->voxels,
    .bricks = h->bricks,
    .bandwidth = h->bandwidth,
    .uncorrected = h->leaps == LEAPS_UNCORRECTED,
    .dbscan_splits = h->splits[0],
    .density_splits = h->splits[1],
    .sah_splits = h->splits[2],
    .median_splits = h->splits[3] };
  memcpy(s->why, h->why, sizeof s->why);
  TRY(read_arrays(context, h, bytes, tree));
  TRY(stratus_tree_check_arrays(context, tree));
  if (s->method == STRATUS_TREE_WIDE && tree->brick_count > 0) {
    TRY(stratus_wide_create(context, &tree->bricks, tree->brick_count, &tree->wide));
  }
  return stratus_tree_count_up(context, tree);
}

stratus_status stratus_tree_load(stratus_context* context, const void* bytes, size_t size, stratus_tree** out)
{
  header h;
  void* memory;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!bytes || !out) {
    return WRONG("%s is NULL", bytes ? "tree" : "bytes");
  }
  if (size < sizeof h) {
    return WRONG("%zu bytes are no tree: the header has %zu", size, sizeof h);
  }
  memcpy(&h, bytes, sizeof h);
  TRY(check_header(context, &h, bytes, size));
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_tree), &memory));
  stratus_tree* tree = memory;
  const stratus_status status = fill_tree(context, &h, bytes, tree);
  if (status != STRATUS_OK) {
    tree->context = context;
    stratus_tree_destroy(tree);
    return status;
  }
  *out = tree;
  return STRATUS_OK;
}

stratus_status stratus_tree_covers(stratus_context* context, const stratus_tree* tree, const stratus_volume* volume,
  const stratus_criterion* criterion, int cells, int* covers)
{
  stratus_origin wanted;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!tree || !covers) {
    return WRONG("%s is NULL", tree ? "covers" : "tree");
  }
  TRY(stratus_volume_check(context, volume));
  TRY(stratus_criterion_check(context, criterion));
  *covers = 0;
  if (tree->origin.hash == 0 || tree->statistics.uncorrected || tree->origin.cells != (cells != 0) || !stratus_tree_fits(tree, volume)) {
    return STRATUS_OK;
  }
  memset(&wanted, 0, sizeof wanted);
  TRY(stratus_criterion_intervals(context, volume, criterion, cells, &wanted));
  TRY(stratus_volume_hash(context, volume, &wanted.hash));
  *covers = stratus_origin_covers(&tree->origin, &wanted);
  return STRATUS_OK;
}

bool stratus_tree_fits(const stratus_tree* tree, const stratus_volume* volume)
{
  int64_t cells[3];
  stratus_volume_cells(volume, cells);
  for (int a = 0; a < 3; ++a) {
    const int64_t blocks = ((cells[a] > 0 ? cells[a] : 1) + STRATUS_BRICK - 1) / STRATUS_BRICK;
    if (tree->dimensions[a] != (tree->origin.cells ? blocks * STRATUS_BRICK : volume->dimensions[a])) {
      return false;
    }
  }
  return true;
}
