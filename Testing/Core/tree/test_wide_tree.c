/* SPDX-License-Identifier: BSD-3-Clause
 * Wide hierarchies over bricks, held to boxes that are found voxel by voxel. */
#include "first_hits.h"

#include "wide_tree.h"

#include <stdio.h>

static int by_place(const void* one, const void* other)
{
  const stratus_brick *a = one, *b = other;
  for (int axis = 0; axis < 3; ++axis) {
    if (a->at[axis] != b->at[axis]) {
      return a->at[axis] < b->at[axis] ? -1 : 1;
    }
  }
  return 0;
}

static void set_mask(stratus_brick* brick, uint64_t mask)
{
  brick->mask = mask;
  brick->count = (uint16_t)__builtin_popcountll(mask);
}

/* Makes up to `count` bricks at places below `extent`, in cubes of edge `cluster` where that is not 0. Returns how many are left without
 * those that came twice. */
static uint32_t make_bricks(uint32_t count, const int extent[3], int cluster, uint32_t* random, stratus_brick* bricks)
{
  uint32_t kept = 0;
  int corner[3] = { 0 };
  for (uint32_t b = 0; b < count; ++b) {
    const uint64_t bits = (uint64_t)next_random(random) << 40 ^ (uint64_t)next_random(random) << 20 ^ next_random(random);
    const bool few = next_random(random) % 2;
    for (int a = 0; a < 3; ++a) {
      corner[a] = cluster == 0 ? 0 : b % 40 == 0 ? (int)(unit_random(random) * extent[a]) : corner[a];
      const int at = corner[a] + (int)(unit_random(random) * (cluster ? cluster : extent[a]));
      bricks[b].at[a] = (uint16_t)(at < extent[a] ? at : extent[a] - 1);
    }
    set_mask(&bricks[b], few || !bits ? UINT64_C(1) << next_random(random) % 64 : bits);
  }
  qsort(bricks, count, sizeof *bricks, by_place);
  for (uint32_t b = 0; b < count; ++b) {
    if (kept == 0 || by_place(&bricks[kept - 1], &bricks[b]) != 0) {
      bricks[kept++] = bricks[b];
    }
  }
  return kept;
}

static void shuffle(stratus_brick* bricks, uint32_t count, uint32_t* random)
{
  for (uint32_t b = count; b > 1; --b) {
    const uint32_t other = next_random(random) % b;
    const stratus_brick kept = bricks[b - 1];
    bricks[b - 1] = bricks[other];
    bricks[other] = kept;
  }
}

static stratus_brick* copy_bricks(stratus_context* context, const stratus_brick* bricks, uint32_t count)
{
  void* memory = NULL;
  assert_int_equal(stratus_allocate(context, count, sizeof *bricks, &memory), STRATUS_OK);
  memcpy(memory, bricks, count * sizeof *bricks);
  return memory;
}

/* ---------------------------------------------------------------- boxes */

typedef struct checked {
  const stratus_wide* wide;
  const stratus_brick* bricks;
  int *node_seen, *brick_seen;
  double area; /* of all children, as they are stored */
} checked;

static stratus_box box_of_voxels(const stratus_brick* brick)
{
  stratus_box box = { { INT32_MAX, INT32_MAX, INT32_MAX }, { INT32_MIN, INT32_MIN, INT32_MIN } };
  for (int bit = 0; bit < 64; ++bit) {
    const int in[3] = { bit % 4, bit / 4 % 4, bit / 16 };
    for (int a = 0; brick->mask >> bit & 1 && a < 3; ++a) {
      const int32_t at = 4 * brick->at[a] + in[a];
      box.lo[a] = at < box.lo[a] ? at : box.lo[a];
      box.hi[a] = at + 1 > box.hi[a] ? at + 1 : box.hi[a];
    }
  }
  return box;
}

static double area_of(const stratus_box* box)
{
  const double x = box->hi[0] - box->lo[0], y = box->hi[1] - box->lo[1], z = box->hi[2] - box->lo[2];
  return 2.0 * (x * y + y * z + z * x);
}

/* Checks a node and all below it. Returns the tight box of its voxels, and adds its bricks to *below. */
static stratus_box check_node(checked* c, uint32_t number, int level, uint32_t* below)
{
  stratus_box all = { { INT32_MAX, INT32_MAX, INT32_MAX }, { INT32_MIN, INT32_MIN, INT32_MIN } }, child[STRATUS_WIDE];
  assert_true(number < c->wide->node_count);
  const stratus_wide_node* node = &c->wide->nodes[number];
  const int reach = 1 << node->shift;
  uint32_t bricks = 0;
  assert_int_equal(c->node_seen[number]++, 0);
  assert_true(15 * level + STRATUS_WIDE <= STRATUS_WIDE_STACK);
  assert_true(node->count <= STRATUS_WIDE && node->inner <= node->count && node->count > (number > 0));
  for (int i = 0; i < node->count; ++i) {
    if (i < node->inner) {
      uint32_t inside = 0;
      assert_true(node->node + (uint32_t)i > number);
      child[i] = check_node(c, node->node + (uint32_t)i, level + 1, &inside);
      assert_true(inside > 1);
      bricks += inside;
    } else {
      const uint32_t brick = node->brick + (uint32_t)(i - node->inner);
      assert_int_equal(c->brick_seen[brick]++, 0);
      child[i] = box_of_voxels(&c->bricks[brick]);
      const stratus_box tight = stratus_brick_box(&c->bricks[brick]);
      assert_memory_equal(&tight, &child[i], sizeof tight);
      ++bricks;
    }
    for (int a = 0; a < 3; ++a) {
      all.lo[a] = child[i].lo[a] < all.lo[a] ? child[i].lo[a] : all.lo[a];
      all.hi[a] = child[i].hi[a] > all.hi[a] ? child[i].hi[a] : all.hi[a];
    }
  }
  assert_true(bricks > STRATUS_WIDE || node->inner == 0); /* up to 16 bricks take one node */
  for (int i = 0; i < node->count; ++i) {
    const stratus_box stored = stratus_wide_box(node, i);
    c->area += area_of(&stored);
    for (int a = 0; a < 3; ++a) {
      const int above = child[i].lo[a] - stored.lo[a], beyond = stored.hi[a] - child[i].hi[a];
      assert_true(above >= 0 && above < reach && beyond >= 0 && beyond < reach);
    }
  }
  for (int a = 0; a < 3; ++a) {
    assert_true(node->at[a] == (float)all.lo[a]);
    for (int i = node->count; i < STRATUS_WIDE; ++i) {
      assert_true(node->lo[a][i] == 255 && node->hi[a][i] == 0);
    }
  }
  const int32_t x = all.hi[0] - all.lo[0], y = all.hi[1] - all.lo[1], z = all.hi[2] - all.lo[2];
  const int32_t extent = x > y ? (x > z ? x : z) : (y > z ? y : z);
  assert_true(node->shift == 0 || extent > 255 << (node->shift - 1)); /* no coarser than need be */
  *below += bricks;
  return all;
}

/* Makes a hierarchy over the bricks in a random order, and checks all of it. */
static void check_set(stratus_context* context, const stratus_brick* bricks, uint32_t count, uint32_t* random)
{
  stratus_wide wide = { 0 };
  stratus_brick* given = copy_bricks(context, bricks, count);
  shuffle(given, count, random);
  stratus_brick* ordered = given;
  if (stratus_wide_create(context, &ordered, count, &wide) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  assert_true((uintptr_t)wide.nodes % 64 == 0);
  checked c = { .wide = &wide, .bricks = ordered };
  c.node_seen = calloc(wide.node_count, sizeof *c.node_seen);
  c.brick_seen = calloc(count, sizeof *c.brick_seen);
  uint32_t below = 0;
  const stratus_box root = check_node(&c, 0, 0, &below);
  assert_int_equal(below, count);
  for (uint32_t n = 0; n < wide.node_count; ++n) {
    assert_int_equal(c.node_seen[n], 1);
  }
  for (uint32_t b = 0; b < count; ++b) {
    assert_int_equal(c.brick_seen[b], 1);
  }
  stratus_box stored = stratus_wide_box(&wide.nodes[0], 0);
  for (int i = 1; i < wide.nodes[0].count; ++i) {
    const stratus_box child = stratus_wide_box(&wide.nodes[0], i);
    for (int a = 0; a < 3; ++a) {
      stored.lo[a] = child.lo[a] < stored.lo[a] ? child.lo[a] : stored.lo[a];
      stored.hi[a] = child.hi[a] > stored.hi[a] ? child.hi[a] : stored.hi[a];
    }
  }
  assert_true(area_of(&stored) >= area_of(&root));
  const double cost = 1.0 + c.area / area_of(&stored);
  assert_true(fabs(stratus_wide_sah(&wide) - cost) <= 1e-9 * cost); /* sums in another order */
  stratus_brick* sorted = copy_bricks(context, ordered, count);
  qsort(sorted, count, sizeof *sorted, by_place);
  assert_memory_equal(sorted, bricks, count * sizeof *bricks);
  stratus_release(context, sorted);
  free(c.node_seen);
  free(c.brick_seen);
  stratus_release(context, ordered);
  stratus_release(context, wide.memory);
}

#define MOST 6000

static stratus_brick bricks[MOST];

static void every_brick_has_one_place_and_boxes_enclose(void** state)
{
  (void)state;
  static const uint32_t counts[] = { 1, 2, 3, 15, 16, 17, 18, 31, 32, 33, 240, 256, 257, 1000, MOST };
  static const int extents[][3] = { { 20, 20, 20 }, { 400, 300, 500 }, { 65536, 2, 2 }, { 3, 65536, 1 }, { 1, 1, 65536 },
    { 65536, 65536, 65536 }, { 64, 64, 64 }, { 8, 7, 6 }, { 2000, 1500, 1000 } };
  uint32_t random = 3;
  stratus_context* context = host_with_isa(2, 2);
  for (size_t e = 0; e < sizeof extents / sizeof *extents; ++e) {
    for (size_t n = 0; n < sizeof counts / sizeof *counts; ++n) {
      for (int cluster = 0; cluster <= 9; cluster += 9) {
        const uint32_t kept = make_bricks(counts[n], extents[e], cluster, &random, bricks);
        check_set(context, bricks, kept, &random);
      }
    }
  }
  stratus_context_destroy(context);
}

/* Sets that make levels deep, nodes large, and boxes just as long as bytes reach. */
static void hard_sets_are_enclosed(void** state)
{
  (void)state;
  uint32_t random = 5;
  stratus_context* context = host_with_isa(2, 1);
  uint32_t count = 0; /* one brick for each bit of a code */
  memset(bricks, 0, sizeof bricks);
  set_mask(&bricks[count++], 1);
  for (int bit = 0; bit < 16; ++bit) {
    for (int a = 0; a < 3; ++a) {
      bricks[count].at[a] = (uint16_t)(1 << bit);
      set_mask(&bricks[count++], UINT64_C(1) << 63);
    }
  }
  qsort(bricks, count, sizeof *bricks, by_place);
  check_set(context, bricks, count, &random);
  for (int axis = 0; axis < 3; ++axis) { /* from 253 to 259 voxels, and twice as many */
    for (int length = 253; length <= 518; length = length == 259 ? 508 : length + 1) {
      memset(bricks, 0, 2 * sizeof *bricks);
      const int step = axis == 0 ? 1 : axis == 1 ? 4 : 16, last = length - 1 + 3;
      bricks[1].at[axis] = (uint16_t)(last / 4);
      set_mask(&bricks[0], UINT64_C(1) << 3 * step);
      set_mask(&bricks[1], UINT64_C(1) << last % 4 * step);
      check_set(context, bricks, 2, &random);
    }
  }
  for (int full = 0; full < 4096; ++full) { /* a cube */
    for (int a = 0; a < 3; ++a) {
      bricks[full].at[a] = (uint16_t)(full >> 4 * (2 - a) & 15);
    }
    set_mask(&bricks[full], ~UINT64_C(0));
  }
  check_set(context, bricks, 4096, &random);
  stratus_context_destroy(context);
}

/* A range of up to 16 bricks stays together, and the range whose codes differ in the highest bit is opened first. */
static void nodes_have_the_children_they_should(void** state)
{
  (void)state;
  stratus_context* context = host_with_isa(2, 1);
  for (uint32_t near = 1; near <= 17; ++near) { /* a row of bricks, and one far away */
    stratus_wide wide = { 0 };
    memset(bricks, 0, (near + 1) * sizeof *bricks);
    for (uint32_t b = 0; b <= near; ++b) {
      bricks[b].at[0] = b < near ? (uint16_t)b : 1000;
      set_mask(&bricks[b], 1);
    }
    stratus_brick* ordered = copy_bricks(context, bricks, near + 1);
    assert_int_equal(stratus_wide_create(context, &ordered, near + 1, &wide), STRATUS_OK);
    if (near < 16) {
      assert_int_equal(wide.node_count, 1);
      assert_int_equal(wide.nodes[0].count, near + 1);
    } else if (near == 16) {
      assert_int_equal(wide.node_count, 2);
      assert_int_equal(wide.nodes[0].count, 2);
      assert_int_equal(wide.nodes[1].count, 16);
    } else { /* the row is opened once: 16, and 1 */
      assert_int_equal(wide.node_count, 2);
      assert_int_equal(wide.nodes[0].count, 3);
      assert_int_equal(wide.nodes[1].count, 16);
    }
    assert_int_equal(wide.nodes[0].inner, near >= 16);
    stratus_release(context, ordered);
    stratus_release(context, wide.memory);
  }
  stratus_context_destroy(context);
}

static void order_and_threads_change_no_byte(void** state)
{
  (void)state;
  static const int extent[3] = { 3000, 500, 900 };
  uint32_t random = 11;
  const uint32_t count = make_bricks(MOST, extent, 20, &random, bricks);
  stratus_context* contexts[2] = { host_with_isa(2, 1), host_with_isa(2, 4) };
  stratus_wide wide[4] = { { 0 } };
  stratus_brick* ordered[4];
  for (int i = 0; i < 4; ++i) {
    ordered[i] = copy_bricks(contexts[i % 2], bricks, count);
    if (i > 1) {
      shuffle(ordered[i], count, &random);
    }
    assert_int_equal(stratus_wide_create(contexts[i % 2], &ordered[i], count, &wide[i]), STRATUS_OK);
    assert_int_equal(wide[i].node_count, wide[0].node_count);
    assert_memory_equal(wide[i].nodes, wide[0].nodes, wide[0].node_count * sizeof *wide[0].nodes);
    assert_memory_equal(ordered[i], ordered[0], count * sizeof *bricks);
  }
  for (int i = 0; i < 4; ++i) {
    stratus_release(contexts[i % 2], ordered[i]);
    stratus_release(contexts[i % 2], wide[i].memory);
  }
  stratus_context_destroy(contexts[0]);
  stratus_context_destroy(contexts[1]);
}

static void a_brick_that_is_there_twice_is_refused(void** state)
{
  (void)state;
  static const int extent[3] = { 50, 60, 70 };
  stratus_context* context = host_with_isa(2, 1);
  uint32_t random = 17;
  for (uint32_t wanted = 2; wanted < 400; wanted += 14) {
    const uint32_t count = make_bricks(wanted, extent, 0, &random, bricks);
    char place[64];
    stratus_wide wide = { 0 };
    bricks[count] = bricks[next_random(&random) % count];
    set_mask(&bricks[count], ~bricks[count].mask | 1); /* another mask at the same place */
    snprintf(place, sizeof place, "brick %d %d %d is there twice", bricks[count].at[0], bricks[count].at[1], bricks[count].at[2]);
    shuffle(bricks, count + 1, &random);
    stratus_brick *given = copy_bricks(context, bricks, count + 1), *ordered = given;
    assert_int_equal(stratus_wide_create(context, &ordered, count + 1, &wide), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(context), place));
    assert_ptr_equal(ordered, given);
    assert_memory_equal(given, bricks, (count + 1) * sizeof *bricks);
    assert_true(wide.nodes == NULL && wide.memory == NULL && wide.node_count == 0);
    stratus_release(context, given);
  }
  stratus_context_destroy(context);
}

int test_wide_tree(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_brick_has_one_place_and_boxes_enclose),
    cmocka_unit_test(hard_sets_are_enclosed),
    cmocka_unit_test(nodes_have_the_children_they_should),
    cmocka_unit_test(order_and_threads_change_no_byte),
    cmocka_unit_test(a_brick_that_is_there_twice_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
