/* SPDX-License-Identifier: BSD-3-Clause
 * The transfer function's table: the entry of a value, and the sums between two entries. */
#ifndef STRATUS_TRANSFER_TABLE_H
#define STRATUS_TRANSFER_TABLE_H

#include "gather.h"
#include "table_arguments.h"

/* The entries of values within cells of several entries. first: the first entry of each cell; bound: where entries begin that are not their
 * cell's first. */
INLINE vint search_entry(GLOBAL const int* first, GLOBAL const int* bound, int steps, vint cell, vfloat value, vmask mask)
{
  vint entry = v_gather_ints(first, cell, mask);
  const vint beyond = v_gather_ints(first, cell + vi_set(1), mask);
  mask = mask & vi_lt(entry + vi_set(1), beyond);
  if (m_any(mask)) { /* most cells are one entry */
    for (int ahead = 1 << (steps - 1); ahead > 0; ahead >>= 1) {
      const vint next = entry + vi_set(ahead);
      const vmask inside = mask & vi_lt(next, beyond);
      entry = vi_select(inside & v_le(v_from_bits(v_gather_ints(bound, next, inside)), value), next, entry);
    }
  }
  return entry;
}

/* A value's place in the grid: the whole part is its cell. */
INLINE vfloat table_place(CONSTANT stratus_table_arguments* t, vfloat value)
{
  return v_clamp(v_fma(value, v_set(t->scale), v_set(t->offset)), 0.0f, t->last);
}

/* The entry of a value in a cell. */
INLINE vint entry_in_cell(CONSTANT stratus_table_arguments* t, GLOBAL const void* table, vint cell, vfloat value, vmask mask)
{
  if (t->search_steps) {
    GLOBAL const int* words = (GLOBAL const int*)table;
    cell = search_entry(words + t->first_at, words + t->bound_at, t->search_steps, cell, value, mask);
  }
  return cell;
}

INLINE vint table_entry(CONSTANT stratus_table_arguments* t, GLOBAL const void* table, vfloat value)
{
  const vint cell = v_to_int(table_place(t, value));
  return entry_in_cell(t, table, cell, value, vi_ge(cell, vi_set(0)));
}

/* The sums over entries low..beyond-1 of red, green and blue times tau, and of tau. Running sums are integers, so that their difference is
 * exact, and exactly zero over a transparent stretch. */
INLINE void sums_between(GLOBAL const int* sums, vint low, vint beyond, vmask mask, vfloat out[4])
{
  vint before[4], up_to[4];
  gather_four_ints(sums, low, mask, before);
  gather_four_ints(sums, beyond, mask, up_to);
  for (int c = 0; c < 4; ++c) {
    out[c] = v_from_int(up_to[c] - before[c]);
  }
}

/* Only the last of these sums. */
INLINE vfloat tau_between(GLOBAL const int* sums, vint low, vint beyond, vmask mask)
{
  return v_from_int(gather_int32(sums + 3, beyond << vi_set(2), mask) - gather_int32(sums + 3, low << vi_set(2), mask));
}

/* The divisor by which the sums over entries low..beyond-1 become a mean: the number of entries, or their widths. */
INLINE vfloat width_between(CONSTANT stratus_table_arguments* t, GLOBAL const int* sums, vint low, vint beyond, vmask mask)
{
  vint width = beyond - low;
  if (t->search_steps) {
    GLOBAL const int* widths = sums + t->widths_at;
    width = gather_int32(widths, beyond, mask) - gather_int32(widths, low, mask);
  }
  return v_from_int(width);
}

/* The beginning or end of a range of values: the running sums before the value's entry, the entry's own addends, and the part of the entry
 * before the value; the same for widths. */
typedef struct table_end {
  vint before[4], begin;
  vfloat own[4], width, part;
} table_end;

INLINE void table_end_at(CONSTANT stratus_table_arguments* t, GLOBAL const int* sums, vfloat value, vint entry, vmask mask, table_end* end)
{
  const vint next = entry + vi_set(1);
  vint behind[4], wide = vi_set(1);
  end->begin = entry;
  if (t->search_steps) {
    end->begin = gather_int32(sums + t->widths_at, entry, mask);
    wide = gather_int32(sums + t->widths_at, next, mask) - end->begin;
  }
  gather_four_ints(sums, entry, mask, end->before);
  gather_four_ints(sums, next, mask, behind);
  for (int c = 0; c < 4; ++c) {
    end->own[c] = v_from_int(behind[c] - end->before[c]);
  }
  end->width = v_from_int(wide);
  const vfloat place = v_clamp(v_fma(value, v_set(t->scale), v_set(t->offset)), 0.0f, t->last + 1.0f);
  const vint cell = v_to_int(v_min(place, v_set(t->last)));
  vfloat part = place - v_from_int(cell);
  if (t->search_steps) {
    part =
      v_fma(part, v_set((float)t->unit), v_from_int(cell * vi_set(t->unit) - end->begin)) * v_reciprocal(v_max(end->width, v_set(1.0f)));
  }
  end->part = v_clamp(part, 0.0f, 1.0f);
}

/* The sums from one value to another. Of the entries at both ends only the parts between the values count. Returns the width of the range.
 * Where the function jumps, whole entries would count too much of one side. */
INLINE vfloat sums_from_to(CONSTANT stratus_table_arguments* t, const table_end* from, const table_end* to, vfloat out[4])
{
  const vfloat zero = v_set(0.0f), least = v_set(0x1p-6f * (float)t->unit), between = v_from_int(to->begin - from->begin);
  const vfloat width = v_abs(v_fma(to->part, to->width, between) - from->part * from->width);
  /* floats cannot distinguish such parts of one entry, or of two neighbours */
  const vmask own = v_lt(width, least) & v_le(between, from->width) & v_le(zero - between, to->width);
  for (int c = 0; c < 4; ++c) {
    const vfloat sum = v_fma(to->part, to->own[c], v_from_int(to->before[c] - from->before[c])) - from->part * from->own[c];
    out[c] = v_select(own, to->own[c], v_abs(sum));
  }
  return v_max(v_select(own, to->width, width), v_set(0x1p-6f));
}

/* The values at which a stretch begins: of stretches whose numbers are `stretch`, and the last one plus 1. */
INLINE vfloat table_stretch_begin(CONSTANT stratus_table_arguments* t, GLOBAL const int* sums, vint stretch, vmask mask)
{
  return v_from_bits(v_gather_ints(sums + t->stretches_at, stretch << vi_set(TABLE_STRETCH_LOG2), mask));
}

/* The stretches of values. guess: where to look first, because a ray mostly stays in a stretch. */
INLINE vint table_stretch(CONSTANT stratus_table_arguments* t, GLOBAL const int* sums, vint guess, vfloat value, vmask mask)
{
  vint stretch = guess;
  const vmask low = v_le(table_stretch_begin(t, sums, guess, mask), value),
              high = v_lt(value, table_stretch_begin(t, sums, guess + vi_set(1), mask));
  if (m_any(m_andnot(mask, low & high))) {
    stretch = vi_set(0);
    for (int ahead = (1 << t->stretch_steps) >> 1; ahead > 0; ahead >>= 1) {
      const vint next = stretch + vi_set(ahead);
      const vmask inside = mask & vi_lt(next, vi_set(t->stretches));
      stretch = vi_select(inside & v_le(table_stretch_begin(t, sums, next, inside), value), next, stretch);
    }
  }
  return stretch;
}

/* A stretch at one value: the colour, the colour's change per value, and the optical depth in the unit of the running sums. */
typedef struct table_shown {
  vfloat color[3], slope[3], tau;
} table_shown;

INLINE void table_stretch_at(
  CONSTANT stratus_table_arguments* t, GLOBAL const int* sums, vint stretch, vfloat value, vmask mask, table_shown* shown)
{
  GLOBAL const float* words = (GLOBAL const float*)(sums + t->stretches_at);
  const vint first = stretch << vi_set(TABLE_STRETCH_LOG2 - 2);
  vfloat low[4], high[4];
  gather_four(words, first, mask, low);
  gather_four(words, first + vi_set(1), mask, high);
  const vfloat beyond = value - low[0], color[3] = { low[2], low[3], high[0] };
  for (int c = 0; c < 3; ++c) {
    shown->slope[c] = high[c + 1];
    shown->color[c] = v_fma(high[c + 1], beyond, color[c]);
  }
  shown->tau = low[1];
}

/* Lanes whose way from one entry to another meets an entry of opacity 1; *first is the first such entry of each. rows: the two rows of
 * entries behind the sums, for rising and for falling ways. */
INLINE vmask opaque_on_the_way(CONSTANT stratus_table_arguments* t, GLOBAL const int* rows, vint from, vint to, vmask mask, vint* first)
{
  const vmask rises = vi_ge(to, from);
  *first = gather_int32(rows, from + vi_select(rises, vi_set(0), vi_set(t->entries)), mask);
  return mask & ((rises & vi_ge(to, *first)) | m_andnot(vi_ge(*first, to), rises));
}

/* Into how many pieces a segment is cut, by its error. */
INLINE vfloat pieces_for(vfloat q)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  vfloat pieces = one + v_select(v_lt(one, q), one, zero) + v_select(v_lt(v_set(4.0f), q), one, zero);
  pieces = pieces + v_select(v_lt(v_set(9.0f), q), v_set(2.0f), zero) + v_select(v_lt(v_set(25.0f), q), v_set(3.0f), zero);
  return pieces + v_select(v_lt(v_set(64.0f), q), v_set(8.0f), zero);
}

/* The error of a segment that is composited at once, relative to that allowed. Averaging colour is wrong by an error that grows with
 * optical depth and with the most that the colour can change over the entries, which is no more than over the whole table. The error falls
 * with the square of the number of pieces. */
INLINE vfloat segment_error(CONSTANT stratus_table_arguments* t, vfloat depth, vfloat widths)
{
  return depth * v_min(widths * v_set(t->color_slope), v_set(t->color_most));
}

#endif
