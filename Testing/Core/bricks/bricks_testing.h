/* SPDX-License-Identifier: BSD-3-Clause
 * A host context for all tests of a file, pools, and comparisons, for tests of bricks. */
#ifndef STRATUS_BRICKS_TESTING_H
#define STRATUS_BRICKS_TESTING_H

#include "bricks.h"
#include "structures.h"
#include "stratus.h"

static stratus_context* host;

static inline int begin(void** state)
{
  (void)state;
  host = make_context("host", 2);
  return 0;
}

static inline int end(void** state)
{
  (void)state;
  stratus_context_destroy(host);
  return 0;
}

/* memory: as in the options. */
static inline stratus_brick_pool* make_pool(uint64_t memory)
{
  stratus_brick_pool_options options = stratus_brick_pool_options_default();
  stratus_brick_pool* pool = NULL;
  options.memory = memory;
  assert_int_equal(stratus_brick_pool_create(host, &options, &pool), STRATUS_OK);
  return pool;
}

static inline void expect_same_ranges(const stratus_volume* one, const stratus_volume* other, int block_size)
{
  stratus_value_range *a = NULL, *b = NULL;
  assert_int_equal(stratus_value_range_create(host, one, block_size, &a), STRATUS_OK);
  assert_int_equal(stratus_value_range_create(host, other, block_size, &b), STRATUS_OK);
  const size_t count = (size_t)(a->blocks[0] * a->blocks[1] * a->blocks[2]);
  assert_memory_equal(a->blocks, b->blocks, sizeof a->blocks);
  assert_memory_equal(a->lo, b->lo, count * sizeof *a->lo);
  assert_memory_equal(a->hi, b->hi, count * sizeof *a->hi);
  assert_memory_equal(a->gaps, b->gaps, count * sizeof *a->gaps);
  assert_true(a->whole_lo == b->whole_lo && a->whole_hi == b->whole_hi);
  stratus_value_range_destroy(a);
  stratus_value_range_destroy(b);
}

#endif
