/* SPDX-License-Identifier: BSD-3-Clause
 * Which values of a row lie in one of some intervals, for one type of values. Included once a type by voxels_scan.c with
 *   TYPE        of the values           NAME(f)   f with the type in its name
 *   BOUND       member of `bounds`, of a type that holds TYPE
 * Every comparison is with numbers of the values' own type: exact, and false for what is no number. */

static void NAME(mark)(const void* row, int64_t n, const bounds* intervals, int64_t count, uint8_t* restrict flags)
{
  const TYPE* restrict values = row;
  for (int64_t b = 0; b < count; b++) {
    const TYPE lo = (TYPE)intervals[b].lo.BOUND, hi = (TYPE)intervals[b].hi.BOUND;
    if (b == 0) {
      for (int64_t i = 0; i < n; i++) {
        flags[i] = (uint8_t)((values[i] >= lo) & (values[i] <= hi));
      }
    } else {
      for (int64_t i = 0; i < n; i++) {
        flags[i] |= (uint8_t)((values[i] >= lo) & (values[i] <= hi));
      }
    }
  }
}

#undef TYPE
#undef NAME
#undef BOUND
