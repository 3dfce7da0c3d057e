/* SPDX-License-Identifier: BSD-3-Clause
 * A pass of a stable radix sort: what Core/base/radix_sort.c does on the host. A work-group takes a chunk of keys; the host turns the
 * counts of all chunks into places. On a processor a group has one item, which needs no atomic operations. */
#ifndef GROUP
#define GROUP 64
#endif
#ifndef DIGIT_BITS
#define DIGIT_BITS 4
#endif
#define DIGITS (1 << DIGIT_BITS)

static uint digit_of(ulong key, int shift) { return (uint)(key >> shift) & (DIGITS - 1); }

/* places: of each digit, its number in every chunk. */
__kernel void count(__global const ulong* keys, uint size, int shift, uint chunk, uint chunks, __global uint* places)
{
  __local uint counts[DIGITS];
  const uint item = (uint)get_local_id(0), group = (uint)get_group_id(0);
  const uint first = group * chunk, end = min(size, first + chunk);
  for (uint digit = item; digit < DIGITS; digit += GROUP) {
    counts[digit] = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = first + item; i < end; i += GROUP) {
#if GROUP == 1
    ++counts[digit_of(keys[i], shift)];
#else
    atomic_inc(&counts[digit_of(keys[i], shift)]);
#endif
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint digit = item; digit < DIGITS; digit += GROUP) {
    places[digit * chunks + group] = counts[digit];
  }
}

/* places: of each digit, where the keys of every chunk go. */
__kernel void scatter(__global const ulong* keys, __global const uint* values, uint size, int shift, uint chunk, uint chunks,
  __global const uint* places, __global ulong* keys_out, __global uint* values_out)
{
  __local uint next[DIGITS], digits[GROUP];
  const uint item = (uint)get_local_id(0), group = (uint)get_group_id(0);
  const uint first = group * chunk, end = min(size, first + chunk);
  for (uint digit = item; digit < DIGITS; digit += GROUP) {
    next[digit] = places[digit * chunks + group];
  }
  for (uint block = first; block < end; block += GROUP) {
    const uint i = block + item, digit = i < end ? digit_of(keys[i], shift) : DIGITS;
    uint before = 0, all = 0; /* keys of this digit in the block */
    digits[item] = digit;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint other = 0; other < GROUP; ++other) {
      const uint same = digits[other] == digit ? 1 : 0;
      before += other < item ? same : 0;
      all += same;
    }
    if (i < end) {
      const uint to = next[digit] + before;
      keys_out[to] = keys[i];
      values_out[to] = values[i];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (i < end && before + 1 == all) {
      next[digit] += all;
    }
  }
}
