/* SPDX-License-Identifier: BSD-3-Clause
 * Trees as bytes: a header, then the arrays, each at a multiple of 8. What is read back is trusted with nothing: sizes, numbers and leaps are
 * all checked before the tree is handed out, so that no bytes can lead traversal astray. */
#include "tree.h"

#include <string.h>

#define MAGIC 0x3142545354525453ull /* "STRTSTB1" read as a little-endian number: other byte orders see another one */
#define VERSION 1
#define DEPTH_MAX 128

typedef struct header {
  uint64_t magic, size, checksum; /* the checksum is of all that follows it */
  int32_t version, method;
  int32_t dimensions[3], octants, entry_bytes, cell_log2;
  uint32_t node_count, brick_count, field_count, entry_count, row_count, mask_count;
  int64_t voxels, bricks;
  double bandwidth;
  int32_t splits[4];
  char why[256];
  double index_to_world[16];
  stratus_origin origin;
} header;

_Static_assert(sizeof(header) % 8 == 0 && sizeof(stratus_tree_node) == 32 && sizeof(stratus_brick) == 16, "records have no padding");
_Static_assert(sizeof(stratus_tree_field) == 32, "records have no padding");

/* Multiply and fold, eight bytes at a time: finds damage, keeps no secret. */
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
  for (; size > 0; size--, p++) {
    h = (h ^ *p) * 0xff51afd7ed558ccdull;
    h ^= h >> 29;
  }
  return h;
}

#define ARRAYS 6

/* Sizes of the arrays in bytes, rounded up to 8, and their sum with the header. */
static size_t array_sizes(const header* h, size_t sizes[ARRAYS])
{
  const size_t plain[ARRAYS] = { h->node_count * sizeof(stratus_tree_node), h->brick_count * sizeof(stratus_brick),
    h->field_count * sizeof(stratus_tree_field), h->entry_count * (size_t)h->entry_bytes + 4, h->row_count * sizeof(uint32_t),
    h->mask_count * sizeof(uint64_t) };
  size_t sum = sizeof *h;
  for (int i = 0; i < ARRAYS; i++) {
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
  h.octants = tree->octants;
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
  return tree->origin.hash;
}

size_t stratus_tree_bytes(const stratus_tree* tree)
{
  const header h = header_of(tree);
  size_t sizes[ARRAYS];
  return array_sizes(&h, sizes);
}

void stratus_tree_save(const stratus_tree* tree, void* bytes)
{
  header h = header_of(tree);
  const void* const arrays[ARRAYS] = { tree->nodes, tree->bricks, tree->fields, tree->entries, tree->rows, tree->masks };
  size_t sizes[ARRAYS];
  unsigned char* p = bytes;
  h.size = array_sizes(&h, sizes);
  memset(p, 0, h.size);
  p += sizeof h;
  for (int i = 0; i < ARRAYS; i++) {
    if (arrays[i]) {
      memcpy(p, arrays[i], sizes[i]);
    }
    p += (sizes[i] + 7) / 8 * 8;
  }
  memcpy(bytes, &h, sizeof h);
  const size_t from = offsetof(header, version);
  h.checksum = checksum((unsigned char*)bytes + from, h.size - from);
  memcpy(bytes, &h, sizeof h);
}

/* ---------------------------------------------------------------- and back */

#define WRONG(...) stratus_fail(context, STRATUS_INVALID_ARGUMENT, __VA_ARGS__)

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
  bool fine = h->method >= 0 && h->method < STRATUS_TREE_METHODS && (h->octants == 0 || h->octants == 1) &&
    (h->cell_log2 == 0 || h->cell_log2 == 2) && (h->octants || h->entry_bytes == 2) && h->why[sizeof h->why - 1] == 0 &&
    h->origin.intervals >= 0 && h->origin.intervals <= STRATUS_INTERVALS_MAX && h->voxels >= 0 && h->bricks >= 0 &&
    (uint64_t)h->entry_count * (uint64_t)h->entry_bytes <= INT32_MAX && h->row_count <= INT32_MAX / 4 && h->mask_count <= INT32_MAX / 8;
  for (int a = 0; a < 3; a++) {
    fine = fine && h->dimensions[a] >= 1 && h->dimensions[a] <= STRATUS_AXIS_MAX;
  }
  for (int32_t i = 0; fine && i < h->origin.intervals; i++) {
    const double* interval = h->origin.interval[i];
    const bool emptied = h->origin.intervals == 1 && interval[0] == INFINITY && interval[1] == -INFINITY; /* equal to nobody's */
    fine = emptied || (interval[0] <= interval[1] && (i == 0 || h->origin.interval[i - 1][1] < interval[0]));
  }
  return fine ? STRATUS_OK : WRONG("a tree whose header contradicts itself");
}

static bool box_inside(const stratus_tree_node* node, const int32_t lo[3], const int32_t hi[3])
{
  for (int a = 0; a < 3; a++) {
    if (node->lo[a] < lo[a] || node->hi[a] > hi[a] || node->lo[a] >= node->hi[a]) {
      return false;
    }
  }
  return true;
}

/* A leaf's bricks lie in its box, bit by bit, and are no other leaf's. */
static bool bricks_fit(const stratus_tree* tree, const stratus_tree_node* node, uint8_t* taken)
{
  for (uint32_t b = node->first; b < node->first + stratus_tree_node_count(node); b++) {
    const stratus_brick* brick = &tree->bricks[b];
    if (taken[b]) {
      return false;
    }
    taken[b] = 1;
    for (uint64_t left = brick->mask; left; left &= left - 1) {
      const int bit = __builtin_ctzll(left);
      const int32_t voxel[3] = { brick->at[0] * 4 + (bit & 3), brick->at[1] * 4 + (bit >> 2 & 3), brick->at[2] * 4 + (bit >> 4) };
      for (int a = 0; a < 3; a++) {
        if (voxel[a] < node->lo[a] || voxel[a] >= node->hi[a]) {
          return false;
        }
      }
    }
  }
  return true;
}

/* Each node but the root the child of one before it, children inside, leaves' bricks and fields one after another. */
static stratus_status check_nodes(stratus_context* context, const stratus_tree* tree, uint8_t* depth, uint8_t* taken)
{
  static const int32_t zero[3] = { 0, 0, 0 };
  uint32_t bricks = 0, fields = 0;
  memset(depth, 255, tree->node_count);
  for (uint32_t n = 0; n < tree->node_count; n++) {
    const stratus_tree_node* node = &tree->nodes[n];
    const uint32_t count = stratus_tree_node_count(node);
    if (n == 0) {
      depth[0] = 0;
    }
    if (depth[n] == 255 || !box_inside(node, zero, tree->dimensions)) {
      return WRONG("node %u of the tree is nobody's child, or has no box in the volume", n);
    }
    switch (node->kind_count >> 30) {
      case STRATUS_NODE_INNER:
        if (node->first <= n || node->first >= tree->node_count - 1 || depth[n] >= DEPTH_MAX || depth[node->first] != 255 ||
          depth[node->first + 1] != 255 || !box_inside(&tree->nodes[node->first], node->lo, node->hi) ||
          !box_inside(&tree->nodes[node->first + 1], node->lo, node->hi)) {
          return WRONG("node %u of the tree has children that can't be its own", n);
        }
        depth[node->first] = depth[node->first + 1] = (uint8_t)(depth[n] + 1);
        break;
      case STRATUS_NODE_BRICKS:
        if (count == 0 || node->first > tree->brick_count || count > tree->brick_count - node->first || !bricks_fit(tree, node, taken)) {
          return WRONG("node %u of the tree has bricks that are not there, or not its own", n);
        }
        bricks += count;
        break;
      case STRATUS_NODE_FIELD:
        if (node->first >= tree->field_count) {
          return WRONG("node %u of the tree has a distance field that is not there", n);
        }
        fields++;
        break;
      default:
        return WRONG("node %u of the tree is of no kind", n);
    }
  }
  return bricks == tree->brick_count && fields == tree->field_count ? STRATUS_OK : WRONG("the tree has leaves twice, or none");
}

static stratus_status check_bricks(stratus_context* context, const stratus_tree* tree)
{
  for (uint32_t b = 0; b < tree->brick_count; b++) {
    const stratus_brick* brick = &tree->bricks[b];
    if (brick->mask == 0 || brick->count != __builtin_popcountll(brick->mask)) {
      return WRONG("brick %u of the tree is empty, or has another number of voxels than it says", b);
    }
  }
  return STRATUS_OK;
}

static stratus_status check_entries(stratus_context* context, const stratus_tree* tree, const stratus_tree_field* field)
{
  const uint32_t n = (uint32_t)field->cells[0];
  const int bits = tree->entry_bytes;
  const uint32_t low = (1u << bits) - 1u;
  for (uint32_t row = 0; row < (uint32_t)field->cells[1] * (uint32_t)field->cells[2]; row++) {
    const uint8_t* e = tree->entries + ((size_t)field->first_entry + (size_t)row * n) * (size_t)bits;
    for (uint32_t i = 0; i < n; i++, e += bits) {
      const uint32_t entry = (uint32_t)e[0] | (uint32_t)e[1] << 8 | (bits == 3 ? (uint32_t)e[2] << 16 : 0u);
      bool fine = true;
      if (!(entry & low)) {
        fine = tree->cell_log2 == 0 ||
          (tree->rows[field->first_row + row] < tree->mask_count && (entry >> bits) < tree->mask_count - tree->rows[field->first_row + row]);
      } else if (tree->octants) {
        for (int octant = 1; octant < 8; octant++) {
          fine = fine && (entry >> (octant * bits) & low) != 0;
        }
      } else {
        fine = entry >> 2 >= 1;
      }
      if (!fine) {
        return WRONG("a distance field of the tree has a cell that leads nowhere");
      }
    }
  }
  return STRATUS_OK;
}

static stratus_status check_fields(stratus_context* context, const stratus_tree* tree)
{
  uint64_t entries = 0, rows = 0;
  for (uint32_t f = 0; f < tree->field_count; f++) {
    const stratus_tree_field* field = &tree->fields[f];
    bool fine = field->first_entry == entries && field->first_row == rows;
    for (int a = 0; a < 3; a++) {
      fine = fine && field->at[a] >= 0 && field->cells[a] >= 1 && field->cells[a] <= STRATUS_AXIS_MAX &&
        ((int64_t)field->at[a] + field->cells[a] - 1) << tree->cell_log2 < tree->dimensions[a];
    }
    entries += fine ? (uint64_t)field->cells[0] * (uint64_t)field->cells[1] * (uint64_t)field->cells[2] : 0;
    rows += fine ? (uint64_t)field->cells[1] * (uint64_t)field->cells[2] : 0;
    if (!fine || entries > tree->entry_count || (tree->cell_log2 && rows > tree->row_count)) {
      return WRONG("distance field %u of the tree lies outside the volume or its entries", f);
    }
    TRY(check_entries(context, tree, field));
  }
  return entries == tree->entry_count ? STRATUS_OK : WRONG("the tree has entries that are no distance field's");
}

/* Bits of an occupied brick's mask that lie beyond the node's box. */
static uint64_t bits_outside(const stratus_tree_node* node, const int32_t first[3])
{
  uint64_t outside = 0;
  for (int bit = 0; bit < 64; bit++) {
    const int32_t voxel[3] = { first[0] + (bit & 3), first[1] + (bit >> 2 & 3), first[2] + (bit >> 4) };
    for (int a = 0; a < 3; a++) {
      outside |= voxel[a] < node->lo[a] || voxel[a] >= node->hi[a] ? 1ull << bit : 0;
    }
  }
  return outside;
}

/* No voxel of a field's border bricks lies beyond the node. Entries have been checked. */
static bool masks_fit(const stratus_tree* tree, const stratus_tree_node* node, const stratus_tree_field* field)
{
  const int32_t* n = field->cells;
  for (int32_t k = 0; k < n[2] && tree->cell_log2; k++) {
    for (int32_t j = 0; j < n[1]; j++) {
      const bool whole_row = k == 0 || k == n[2] - 1 || j == 0 || j == n[1] - 1;
      for (int32_t i = 0; i < n[0]; i += whole_row || n[0] == 1 ? 1 : n[0] - 1) {
        const int32_t first[3] = { (field->at[0] + i) * 4, (field->at[1] + j) * 4, (field->at[2] + k) * 4 };
        uint64_t mask;
        stratus_tree_field_leap(tree, field, 0, i, j, k, &mask);
        if (mask && (mask & bits_outside(node, first))) {
          return false;
        }
      }
    }
  }
  return true;
}

/* A node of a field covers cells of that field only. */
static stratus_status check_covers(stratus_context* context, const stratus_tree* tree)
{
  for (uint32_t n = 0; n < tree->node_count; n++) {
    const stratus_tree_node* node = &tree->nodes[n];
    if (stratus_tree_node_kind(node) == STRATUS_NODE_FIELD) {
      const stratus_tree_field* field = &tree->fields[node->first];
      for (int a = 0; a < 3; a++) {
        if (node->lo[a] >> tree->cell_log2 != field->at[a] || (node->hi[a] - 1) >> tree->cell_log2 != field->at[a] + field->cells[a] - 1) {
          return WRONG("node %u of the tree and its distance field lie apart", n);
        }
      }
      if (!masks_fit(tree, node, field)) {
        return WRONG("node %u of the tree has a distance field with voxels beyond its box", n);
      }
    }
  }
  return STRATUS_OK;
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
  for (int i = 0; i < ARRAYS && status == STRATUS_OK; i++) {
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
  void* depth;
  tree->context = context;
  memcpy(tree->dimensions, h->dimensions, sizeof h->dimensions);
  memcpy(tree->index_to_world, h->index_to_world, sizeof h->index_to_world);
  if (!stratus_matrix_invert_affine(tree->index_to_world, tree->world_to_index)) {
    return WRONG("the tree's matrix can't be inverted");
  }
  tree->origin = h->origin;
  tree->octants = h->octants;
  tree->entry_bytes = h->entry_bytes;
  tree->cell_log2 = h->cell_log2;
  tree->node_count = h->node_count;
  tree->brick_count = h->brick_count;
  tree->field_count = h->field_count;
  tree->entry_count = h->entry_count;
  tree->row_count = h->row_count;
  tree->mask_count = h->mask_count;
  *s = (stratus_tree_statistics){ .method = (stratus_tree_method)h->method, .voxels = h->voxels, .bricks = h->bricks, .bandwidth = h->bandwidth,
    .dbscan_splits = h->splits[0], .density_splits = h->splits[1], .sah_splits = h->splits[2], .median_splits = h->splits[3] };
  memcpy(s->why, h->why, sizeof s->why);
  TRY(read_arrays(context, h, bytes, tree));
  TRY(stratus_allocate_zero(context, (size_t)tree->node_count + tree->brick_count, 1, &depth));
  const stratus_status status = check_nodes(context, tree, depth, (uint8_t*)depth + tree->node_count);
  stratus_release(context, depth);
  TRY(status);
  TRY(check_bricks(context, tree));
  TRY(check_fields(context, tree));
  TRY(check_covers(context, tree));
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
    return WRONG("%zu bytes are no tree: its header alone has %zu", size, sizeof h);
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

stratus_status stratus_tree_covers(
  stratus_context* context, const stratus_tree* tree, const stratus_volume* volume, const stratus_criterion* criterion, int cells, int* covers)
{
  stratus_origin wanted;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!tree || !covers) {
    return WRONG("%s is NULL", tree ? "covers" : "tree");
  }
  TRY(stratus_volume_check(context, volume));
  *covers = 0;
  if (tree->origin.hash == 0 || tree->origin.cells != (cells != 0) || !stratus_tree_fits(tree, volume)) {
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
  for (int a = 0; a < 3; a++) {
    const int64_t blocks = ((cells[a] > 0 ? cells[a] : 1) + STRATUS_BRICK - 1) / STRATUS_BRICK;
    if (tree->dimensions[a] != (tree->origin.cells ? blocks * STRATUS_BRICK : volume->dimensions[a])) {
      return false;
    }
  }
  return true;
}
