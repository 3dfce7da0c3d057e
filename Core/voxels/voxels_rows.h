/* SPDX-License-Identifier: BSD-3-Clause
 * Marks the values of a row that are in one of several intervals, for one type of values. voxels_scan.c includes this file once for each
 * type and defines
 *   TYPE     the type of the values
 *   AS       the type in which they are compared
 *   NAME(f)  f with the type in its name
 *   BOUND    the member of `stratus_bound`
 * Every comparison is exact, and false for NaN. */

static void NAME(mark)(const void* row, int64_t n, const stratus_bounds* intervals, int64_t count, uint8_t* restrict flags)
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
