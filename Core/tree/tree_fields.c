/* SPDX-License-Identifier: BSD-3-Clause
 * Leaves of distance fields: their layout, and fields of Chebyshev distances. tree_octants.c fills fields with a leap for each octant. */
#include "device.h"
#include "tree_fields.h"

#include "stratus/distance_field.h"

#include <string.h>

/* Most bytes of entries per voxel with which an octant's code has three bits instead of two. Three bits leap farther. */
#define ENTRY_BYTES_A_VOXEL 20

int32_t stratus_tree_field_leap(
  const stratus_tree* tree, const stratus_tree_field* field, int octant, int32_t i, int32_t j, int32_t k, uint64_t* mask)
{
  const uint32_t row = (uint32_t)k * (uint32_t)field->cells[1] + (uint32_t)j;
  const size_t index = field->first_entry + (size_t)row * (size_t)field->cells[0] + (size_t)i;
  const uint8_t* e = tree->entries + index * (size_t)tree->entry_bytes;
  const int bits = tree->entry_bytes;
  const uint32_t low = (1u << bits) - 1u, entry = (uint32_t)e[0] | (uint32_t)e[1] << 8 | (bits == 3 ? (uint32_t)e[2] << 16 : 0u);
  *mask = 0;
  if (!(entry & low)) {
    *mask = tree->cell_log2 ? tree->masks[tree->rows[field->first_row + row] + (entry >> bits)] : 1u;
    return 0;
  }
  return tree->octants ? stratus_leap_of_code(bits, (int)(entry >> (octant * bits) & low)) : (int32_t)(entry >> 2);
}

static int entry_bytes_of(uint64_t entries, int64_t voxels, bool long_rows)
{
  return long_rows || 3 * entries <= ENTRY_BYTES_A_VOXEL * (uint64_t)voxels ? 3 : 2;
}

double stratus_tree_octant_bytes(const stratus_voxels* voxels)
{
  double cells[3];
  for (int a = 0; a < 3; ++a) {
    cells[a] = (double)((voxels->hi[a] - 1) / STRATUS_BRICK - voxels->lo[a] / STRATUS_BRICK + 1);
  }
  const double rows = cells[1] * cells[2], entries = cells[0] * rows;
  return entries * entry_bytes_of((uint64_t)entries, voxels->count, cells[0] > STRATUS_FIELD_ROW_MAX) + rows * sizeof(uint32_t) +
    (double)voxels->brick_count * sizeof(uint64_t);
}

/* ---------------------------------------------------------------- cells */

/* Finds the cells of a field: bricks, or voxels of bricks in the paper's trees. */
static void place_field(const stratus_tree_node* node, int cell_log2, stratus_tree_field* field)
{
  for (int a = 0; a < 3; ++a) {
    const int32_t first = node->lo[a] >> cell_log2, last = (node->hi[a] - 1) >> cell_log2;
    field->at[a] = first;
    field->cells[a] = last - first + 1;
  }
}

/* Sets a byte of `occupied` to 1 for each occupied cell. */
static void mark_cells(const stratus_voxels* voxels, const stratus_tree_shape* shape, const stratus_tree_node* node, int cell_log2,
  const stratus_tree_field* field, uint8_t* occupied)
{
  const uint32_t count = stratus_tree_node_count(node);
  for (uint32_t b = 0; b < count; ++b) {
    const stratus_brick* brick = &voxels->bricks[shape->order[node->first + b]];
    const int side = cell_log2 ? 1 : STRATUS_BRICK;
    for (uint64_t left = cell_log2 ? 1u : brick->mask; left; left &= left - 1) {
      const int bit = cell_log2 ? 0 : __builtin_ctzll(left);
      const int64_t i = brick->at[0] * side + (bit & 3) - field->at[0];
      const int64_t j = brick->at[1] * side + (bit >> 2 & 3) - field->at[1];
      const int64_t k = brick->at[2] * side + (bit >> 4) - field->at[2];
      occupied[(k * field->cells[1] + j) * field->cells[0] + i] = 1;
    }
  }
}

/* Numbers the masks: a row's occupied bricks in order, rows in order. The entries of occupied cells are 0 before. */
static stratus_status number_masks(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape,
  const stratus_tree_node* node, const stratus_tree_field* field, stratus_tree* tree, uint32_t* mask)
{
  const uint32_t count = stratus_tree_node_count(node), rows = (uint32_t)field->cells[1] * (uint32_t)field->cells[2];
  const int bytes = tree->entry_bytes;
  uint32_t* const start = tree->rows + field->first_row;
  void* memory;
  /* A node's bricks come in any order, but a brick's number depends only on the bricks of its row. */
  TRY(stratus_allocate_zero(context, (size_t)rows + 1, sizeof(uint32_t), &memory));
  uint32_t* const next = memory;
  const stratus_status status = stratus_allocate(context, count, sizeof(uint32_t), &memory);
  if (status != STRATUS_OK) {
    stratus_release(context, next);
    return status;
  }
  uint32_t* const sorted = memory;
  for (uint32_t b = 0; b < count; ++b) {
    const stratus_brick* brick = &voxels->bricks[shape->order[node->first + b]];
    next[(uint32_t)(brick->at[2] - field->at[2]) * (uint32_t)field->cells[1] + (uint32_t)(brick->at[1] - field->at[1]) + 1]++;
  }
  for (uint32_t r = 0; r < rows; ++r) {
    next[r + 1] += next[r];
    start[r] = *mask + next[r];
  }
  for (uint32_t b = 0; b < count; ++b) { /* insertion sort in each row, because a node's bricks are nearly in order */
    const uint32_t number = shape->order[node->first + b];
    const stratus_brick* brick = &voxels->bricks[number];
    const uint32_t row = (uint32_t)(brick->at[2] - field->at[2]) * (uint32_t)field->cells[1] + (uint32_t)(brick->at[1] - field->at[1]);
    uint32_t at = next[row]++;
    for (; at > start[row] - *mask && voxels->bricks[sorted[at - 1]].at[0] > brick->at[0]; --at) {
      sorted[at] = sorted[at - 1];
    }
    sorted[at] = number;
  }
  for (uint32_t b = 0; b < count; ++b) {
    const stratus_brick* brick = &voxels->bricks[sorted[b]];
    const uint32_t row = (uint32_t)(brick->at[2] - field->at[2]) * (uint32_t)field->cells[1] + (uint32_t)(brick->at[1] - field->at[1]);
    const uint32_t value = (*mask + b - start[row]) << bytes;
    uint8_t* const e = tree->entries +
      ((size_t)field->first_entry + (size_t)row * (size_t)field->cells[0] + (size_t)(brick->at[0] - field->at[0])) * (size_t)bytes;
    tree->masks[*mask + b] = brick->mask;
    e[0] = (uint8_t)value;
    e[1] = (uint8_t)(value >> 8);
    if (bytes == 3) {
      e[2] = (uint8_t)(value >> 16);
    }
  }
  *mask += count;
  stratus_release(context, sorted);
  stratus_release(context, next);
  return STRATUS_OK;
}

/* ---------------------------------------------------------------- distances */

/* Fills a field with Chebyshev distances, by the sweeps of distance_sweep.c. */
static stratus_status fill_distances(stratus_context* context, const stratus_tree_field* field, uint8_t* occupied, stratus_tree* tree)
{
  stratus_occupancy occupancy = { .context = context, .block_size = STRATUS_BRICK, .occupied = occupied };
  stratus_distance_map* map = NULL;
  size_t i = 0;
  for (int a = 0; a < 3; ++a) {
    occupancy.blocks[a] = field->cells[a];
    occupancy.lo[a] = 0;
    occupancy.hi[a] = field->cells[a];
  }
  for (size_t n = (size_t)field->cells[0] * (size_t)field->cells[1] * (size_t)field->cells[2]; i < n; ++i) {
    occupancy.count += occupied[i];
  }
  TRY(stratus_distance_map_create(context, &occupancy, STRATUS_DISTANCE_FULL, &map));
  uint8_t* e = tree->entries + (size_t)field->first_entry * 2;
  for (int64_t row = 0; row < occupancy.blocks[1] * occupancy.blocks[2]; ++row) {
    const uint8_t* const bytes = map->bytes + (size_t)row * map->pitch;
    for (i = 0; i < (size_t)field->cells[0]; ++i, e += 2) {
      const unsigned value = bytes[i] < 128 ? (unsigned)bytes[i] << 2 | 1u : 0u;
      e[0] = (uint8_t)value;
      e[1] = (uint8_t)(value >> 8);
    }
  }
  stratus_distance_map_destroy(map);
  return STRATUS_OK;
}

/* Copies the bricks of a node to a set of their own, whose origin is the corner of the node's first brick. */
static stratus_status cut_out(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape,
  const stratus_tree_node* node, stratus_voxels* part)
{
  const uint32_t count = stratus_tree_node_count(node);
  void* memory;
  *part = (stratus_voxels){ .context = context, .brick_count = count };
  TRY(stratus_allocate(context, count, sizeof *part->bricks, &memory));
  part->bricks = memory;
  for (int a = 0; a < 3; ++a) {
    const int32_t first = node->lo[a] / STRATUS_BRICK, last = (node->hi[a] - 1) / STRATUS_BRICK;
    part->bricks_along[a] = last - first + 1;
    part->dimensions[a] = part->bricks_along[a] * STRATUS_BRICK;
    part->lo[a] = node->lo[a] - first * STRATUS_BRICK;
    part->hi[a] = node->hi[a] - first * STRATUS_BRICK;
  }
  for (uint32_t b = 0; b < count; ++b) {
    part->bricks[b] = voxels->bricks[shape->order[node->first + b]];
    part->count += part->bricks[b].count;
    for (int a = 0; a < 3; ++a) {
      part->bricks[b].at[a] = (uint16_t)(part->bricks[b].at[a] - node->lo[a] / STRATUS_BRICK);
    }
  }
  return STRATUS_OK;
}

/* Largest number in an entry without octants. */
#define ENTRY_MAX ((1u << 14) - 1u)

/* Returns how far a ray may leap from a cell whose flooded distance is `distance`: as many cells as surely stay within the sphere of that
 * distance, at most `longest`. */
static unsigned leap_within(float distance, unsigned longest)
{
  unsigned leap = 1;
  /* Cells within the Chebyshev distance `leap` are in the sphere if 3 leap^2 < d^2. One more step leaves them. */
  while (leap < longest && 3.0f * (float)(leap * leap) < distance * distance) {
    ++leap;
  }
  return leap;
}

static unsigned in_parts(float distance)
{
  const float parts = distance * STRATUS_FLOODED_PARTS;
  return parts < (float)ENTRY_MAX ? (unsigned)parts : ENTRY_MAX;
}

/* Makes the paper's leaf, a Euclidean field by its adaptive flooding (2.3). Floodings overestimate distances, so that the Chebyshev
 * distance, already in the entry, bounds the leap. An uncorrected tree keeps the flooded distances themselves. */
static stratus_status fill_by_flooding(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape,
  const stratus_tree_node* node, const stratus_tree_field* field, stratus_tree* tree)
{
  stratus_field_options options = stratus_field_options_default();
  stratus_field* flooded = NULL;
  stratus_voxels part;
  stratus_status status = STRATUS_OK;
  void* distances = NULL;
  options.method = STRATUS_FIELD_AJFA;
  TRY(cut_out(context, voxels, shape, node, &part));
  TRY_CLEANUP(stratus_field_create(context, &part, &options, &flooded, NULL));
  TRY_CLEANUP(stratus_allocate(
    context, (size_t)part.dimensions[0] * (size_t)part.dimensions[1], (size_t)part.dimensions[2] * sizeof(float), &distances));
  stratus_field_distances(flooded, distances);
  const int32_t* n = field->cells;
#pragma omp parallel for collapse(2) schedule(static) num_threads(context->threads)
  for (int32_t k = 0; k < n[2]; ++k) {
    for (int32_t j = 0; j < n[1]; ++j) {
      const size_t line = (size_t)(k + part.lo[2]) * (size_t)part.dimensions[1] + (size_t)(j + part.lo[1]);
      const float* row = (const float*)distances + line * (size_t)part.dimensions[0] + part.lo[0];
      uint8_t* e = tree->entries + 2 * ((size_t)field->first_entry + ((size_t)k * (size_t)n[1] + (size_t)j) * (size_t)n[0]);
      for (int32_t i = 0; i < n[0]; ++i, e += 2) {
        const unsigned exact = (unsigned)(e[0] | e[1] << 8) >> 2;
        if (exact > 0) {
          const unsigned value = (tree->statistics.uncorrected ? in_parts(row[i]) : leap_within(row[i], exact)) << 2 | 1u;
          e[0] = (uint8_t)value;
          e[1] = (uint8_t)(value >> 8);
        }
      }
    }
  }

cleanup:
  stratus_release(context, distances);
  stratus_field_destroy(flooded);
  stratus_release(context, part.bricks);
  return status;
}

static stratus_status make_field(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape,
  const stratus_tree_node* node, stratus_tree* tree, stratus_tree_field* field, uint32_t* mask)
{
  if (tree->octants) {
    TRY(stratus_tree_octants(context, voxels, shape, node, field, tree));
  } else {
    void* occupied;
    TRY(stratus_allocate_zero(context, (size_t)field->cells[0] * (size_t)field->cells[1], (size_t)field->cells[2], &occupied));
    mark_cells(voxels, shape, node, tree->cell_log2, field, occupied);
    const stratus_status status = fill_distances(context, field, occupied, tree);
    stratus_release(context, occupied);
    TRY(status);
  }
  if (tree->cell_log2 == 0) {
    TRY(fill_by_flooding(context, voxels, shape, node, field, tree));
  }
  return tree->cell_log2 ? number_masks(context, voxels, shape, node, field, tree, mask) : STRATUS_OK;
}

/* Sets the places of the fields, and the sizes of the arrays that they share. */
static stratus_status place_fields(
  stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape, stratus_tree* tree)
{
  uint64_t entries = 0, rows = 0, masks = 0;
  uint32_t f = 0;
  bool long_rows = false;
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    const stratus_tree_node* node = &shape->nodes[n];
    if (stratus_tree_node_kind(node) == STRATUS_NODE_FIELD) {
      stratus_tree_field* field = &tree->fields[f++];
      place_field(node, tree->cell_log2, field);
      field->first_entry = (uint32_t)entries;
      field->first_row = (uint32_t)rows;
      entries += (uint64_t)field->cells[0] * (uint64_t)field->cells[1] * (uint64_t)field->cells[2];
      rows += (uint64_t)field->cells[1] * (uint64_t)field->cells[2];
      masks += stratus_tree_node_count(node);
      long_rows |= field->cells[0] > STRATUS_FIELD_ROW_MAX;
    }
  }
  tree->entry_bytes = tree->octants ? entry_bytes_of(entries, voxels->count, long_rows) : 2;
  if (!tree->octants && long_rows && tree->cell_log2) {
    return stratus_fail(context, STRATUS_UNSUPPORTED, "a distance field of rows longer than %d bricks", STRATUS_FIELD_ROW_MAX);
  }
  if (entries * (uint64_t)tree->entry_bytes > INT32_MAX - 64 || rows > INT32_MAX / 4 || masks > INT32_MAX / 8) {
    return stratus_fail(
      context, STRATUS_OVERFLOW, "distance fields of %llu entries: at most %d bytes", (unsigned long long)entries, INT32_MAX - 64);
  }
  tree->entry_count = (uint32_t)entries;
  tree->row_count = tree->cell_log2 ? (uint32_t)rows : 0;
  tree->mask_count = tree->cell_log2 ? (uint32_t)masks : 0;
  return STRATUS_OK;
}

stratus_status stratus_tree_make_fields(
  stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape, stratus_tree* tree)
{
  void* memory;
  uint32_t f = 0, mask = 0;
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    tree->field_count += stratus_tree_node_kind(&shape->nodes[n]) == STRATUS_NODE_FIELD;
  }
  if (tree->field_count == 0) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate_zero(context, tree->field_count, sizeof *tree->fields, &memory));
  tree->fields = memory;
  TRY(place_fields(context, voxels, shape, tree));
  TRY(stratus_allocate(context, (size_t)tree->entry_count * (size_t)tree->entry_bytes + 4, 1, &memory));
  tree->entries = memory;
  memset(tree->entries + (size_t)tree->entry_count * (size_t)tree->entry_bytes, 0, 4);
  TRY(stratus_allocate_zero(context, (size_t)tree->row_count, sizeof *tree->rows, &memory));
  tree->rows = memory;
  TRY(stratus_allocate(context, tree->mask_count, sizeof *tree->masks, &memory));
  tree->masks = memory;
  bool made = false;
  if (stratus_tree_fields_on_device(context, voxels, tree)) {
    const stratus_status status = stratus_device_tree_fields(context, voxels, shape, tree);
    made = !stratus_device_hands_back(context, status);
    TRY(made ? status : STRATUS_OK);
  }
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    if (stratus_tree_node_kind(&shape->nodes[n]) == STRATUS_NODE_FIELD) {
      if (!made) {
        TRY(make_field(context, voxels, shape, &shape->nodes[n], tree, &tree->fields[f], &mask));
      }
      tree->nodes[n].first = f++;
    }
  }
  return STRATUS_OK;
}
