/* SPDX-License-Identifier: BSD-3-Clause
 * Which values of a row lie in one of some intervals, for one type of values. Included once a type by voxels_scan.c with
 *   TYPE   of the values, and AS what they are compared as      NAME(f)   f with the type in its name
 *   BOUND  member of `bounds`
 * Every comparison is exact, and false for what is no number. */

static void NAME(mark)(const void* row, int64_t n, const bounds* intervals, int64_t count, uint8_t* restrict flags)
{
  const TYPE* restrict values = row;
  for (int64_t b = 0; b < count; ++b) {
    const AS lo = (AS)intervals[b].lo.BOUND, hi = (AS)intervals[b].hi.BOUND;
    if (b == 0) {
      for (int64_t i = 0; i < n; ++i) {
        flags[i] = (uint8_t)(((AS)values[i] >= lo) & ((AS)values[i] <= hi));
      }
    } else {
      for (int64_t i = 0; i < n; ++i) {
        flags[i] |= (uint8_t)(((AS)values[i] >= lo) & ((AS)values[i] <= hi));
      }
    }
  }
}

#undef TYPE
#undef AS
#undef NAME
#undef BOUND
