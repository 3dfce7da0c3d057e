/* SPDX-License-Identifier: BSD-3-Clause
 * The transfer function's table: which entry a value has, and what lies between two entries. */
#ifndef STRATUS_TRANSFER_TABLE_H
#define STRATUS_TRANSFER_TABLE_H

#include "gather.h"
#include "table_arguments.h"

/* A value's place in the table: the whole part is its entry. */
INLINE vfloat table_place(CONSTANT stratus_table_arguments* t, vfloat value)
{
  return v_clamp(v_fma(value, v_set(t->scale), v_set(t->offset)), 0.0f, t->last);
}

INLINE vint table_entry(CONSTANT stratus_table_arguments* t, vfloat value) { return v_to_int(table_place(t, value)); }

/* The sum over entries low..beyond-1 of row `which`: 0..2 red, green, blue times tau; 3 tau. Running sums are integers, so that their
 * difference is exact, and exactly zero over a transparent stretch. */
INLINE vfloat sum_between(CONSTANT stratus_table_arguments* t, GLOBAL const int* sums, int which, vint low, vint beyond, vmask mask)
{
  GLOBAL const int* sum = sums + which * ((int)t->last + 2);
  return v_from_int(gather_int32(sum, beyond, mask) - gather_int32(sum, low, mask));
}

/* Lanes whose way from one entry to another meets an entry of opacity 1; *first is the first such entry of each. rows: the two rows of
 * entries behind the sums, for rising and for falling ways. */
INLINE vmask opaque_on_the_way(CONSTANT stratus_table_arguments* t, GLOBAL const int* rows, vint from, vint to, vmask mask, vint* first)
{
  const vmask rises = vi_ge(to, from);
  *first = gather_int32(rows, from + vi_select(rises, vi_set(0), vi_set((int)t->last + 1)), mask);
  return mask & ((rises & vi_ge(to, *first)) | m_andnot(vi_ge(*first, to), rises));
}

/* Into how many pieces a segment is cut. Averaging a piece's colour is wrong by an error that grows with optical depth and with the most
 * that the colour can change over the entries, and falls with the square of the number of pieces. */
INLINE vfloat segment_pieces(CONSTANT stratus_table_arguments* t, vfloat depth, vfloat entries)
{
  const vfloat q = depth * entries * v_set(t->color_slope), zero = v_set(0.0f), one = v_set(1.0f);
  vfloat pieces = one + v_select(v_lt(one, q), one, zero) + v_select(v_lt(v_set(4.0f), q), one, zero);
  pieces = pieces + v_select(v_lt(v_set(9.0f), q), v_set(2.0f), zero) + v_select(v_lt(v_set(25.0f), q), v_set(3.0f), zero);
  return pieces + v_select(v_lt(v_set(64.0f), q), v_set(8.0f), zero);
}

#endif
