/* SPDX-License-Identifier: BSD-3-Clause
 * Shared by the two files that fill distance fields. */
#ifndef STRATUS_TREE_FIELDS_H
#define STRATUS_TREE_FIELDS_H

#include "instruction_set.h"
#include "tree.h"

/* Returns the cells that a code leaps: 1, 2, 4 for codes 1 to 3 of 2 bits; 1, 2, 3, 4, 6, 8, 12 for codes 1 to 7 of 3 bits. */
static inline int32_t stratus_leap_of_code(int bits, int code)
{
  return bits == 2 ? 1 << (code - 1) : (2 + (code & 1)) << (code >> 1) >> 1;
}

/* tree_octants.c: fills the field's entries with codes, and with 0 where a cell is occupied. Cells must be bricks. */
stratus_status stratus_tree_octants(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape,
  const stratus_tree_node* node, const stratus_tree_field* field, stratus_tree* tree);

/* ---- tree_fields_device.c: gives the same bytes */
/* Returns whether the context's device makes the fields: it builds, the fields have a leap for each octant, and they fit. */
bool stratus_tree_fields_on_device(const stratus_context* context, const stratus_voxels* voxels, const stratus_tree* tree);
/* Fills entries, rows and masks. A field's bricks in the order must ascend. */
stratus_status stratus_device_tree_fields(
  stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape, stratus_tree* tree);

/* ---- tree_octants_isa.c, for each instruction set */

/* A grid of cells as bits, 64 a word: rows[0]*rows[1] rows of `words` words, x fastest. Bits beyond a row's end are 0. */
typedef struct stratus_bit_grid {
  int64_t words, rows[2], size; /* size: number of words */
} stratus_bit_grid;

/* Writes 8*bits planes of bits, `bits` for each octant, which are the codes of the octants with one pair of signs along x and y: bit 0 of
 * xy is set for + along x, bit 1 for + along y. */
typedef void stratus_find_leaps(
  const stratus_bit_grid* grid, int bits, int xy, const uint64_t* occupied, const uint64_t* empty, uint64_t* room, uint64_t* planes);
/* Converts a row of the planes, `apart` words apart, to entries of `bits` bytes each. */
typedef void stratus_write_row(const uint64_t* planes, int64_t apart, int bits, int64_t cells, uint8_t* entries);

typedef struct stratus_octant_functions {
  stratus_find_leaps* find_leaps;
  stratus_write_row* write_row;
} stratus_octant_functions;
extern const stratus_octant_functions stratus_octant_functions_isa0, stratus_octant_functions_isa1, stratus_octant_functions_isa2;

#endif
