/* SPDX-License-Identifier: BSD-3-Clause
 * Finds how far a ray of each octant may leap from a cell. Cells are bits, 64 per word. A leap of n is free if no bit is set among the n^3
 * cells that begin with the cell; a few shifts and ORs along each axis decide that for a whole word. Leaps are tried from short to long,
 * and a code is the number of the longest free one. tree_octants_isa.c does the work on bits. */
#include "threads.h"
#include "tree_fields.h"

#include <string.h>

#define WORD_NS 30.0 /* of one thread for a word of 64 cells and each bit of the codes */
#define ROOM_GRIDS 5 /* grids that stratus_find_leaps needs in addition to its arguments */

/* Sets the bits of the occupied cells, and the bits of the empty ones. */
static void mark_bits(const stratus_voxels* voxels, const stratus_tree_shape* shape, const stratus_tree_node* node,
  const stratus_tree_field* field, const stratus_bit_grid* grid, uint64_t* occupied, uint64_t* empty)
{
  const uint32_t count = stratus_tree_node_count(node);
  memset(occupied, 0, (size_t)grid->size * sizeof *occupied);
  for (uint32_t b = 0; b < count; ++b) {
    const stratus_brick* brick = &voxels->bricks[shape->order[node->first + b]];
    const int64_t i = brick->at[0] - field->at[0], j = brick->at[1] - field->at[1], k = brick->at[2] - field->at[2];
    occupied[(k * grid->rows[0] + j) * grid->words + i / 64] |= 1ull << (i % 64);
  }
  for (int64_t w = 0; w < grid->size; ++w) {
    const int64_t left = field->cells[0] - w % grid->words * 64;
    empty[w] = ~occupied[w] & (left < 64 ? (1ull << left) - 1 : ~0ull);
  }
}

stratus_status stratus_tree_octants(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape,
  const stratus_tree_node* node, const stratus_tree_field* field, stratus_tree* tree)
{
  static const stratus_octant_functions* const all[] = STRATUS_ISA_EACH(&stratus_octant_functions);
  const stratus_octant_functions* const functions = all[stratus_isa_at_most(context->isa)];
  const int bits = tree->entry_bytes;
  const stratus_bit_grid grid = { .words = (field->cells[0] + 63) / 64,
    .rows = { field->cells[1], field->cells[2] },
    .size = (field->cells[0] + 63) / 64 * (int64_t)field->cells[1] * field->cells[2] };
  const int64_t n = grid.size;
  void* memory;
  TRY(stratus_allocate(context, (size_t)n, (size_t)(2 + 8 * bits + 4 * ROOM_GRIDS) * sizeof(uint64_t), &memory));
  uint64_t* const occupied = memory;
  uint64_t *const empty = occupied + n, *const planes = empty + n, *const room = planes + 8 * bits * n;
  mark_bits(voxels, shape, node, field, &grid, occupied, empty);
  const int threads = stratus_threads_for(context, WORD_NS * bits * (double)n);
#pragma omp parallel num_threads(threads)
  {
#pragma omp for schedule(dynamic, 1)
    for (int xy = 0; xy < 4; ++xy) {
      functions->find_leaps(&grid, bits, xy, occupied, empty, room + xy * ROOM_GRIDS * n, planes);
    }
#pragma omp for schedule(static)
    for (int64_t row = 0; row < grid.rows[0] * grid.rows[1]; ++row) {
      uint8_t* const entries = tree->entries + ((size_t)field->first_entry + (size_t)(row * field->cells[0])) * (size_t)bits;
      functions->write_row(planes + row * grid.words, n, bits, field->cells[0], entries);
    }
  }
  stratus_release(context, memory);
  return STRATUS_OK;
}
