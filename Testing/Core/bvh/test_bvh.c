/* SPDX-License-Identifier: BSD-3-Clause
 * Properties of every bounding volume hierarchy, whatever its shape: it is sound, within its bounds, the same at any number of threads, and
 * complete or not made at all. test_bvh_shapes.c tests the shapes. */
#include "boxes.h"
#include "faulty_allocator.h"
#include "testing.h"

#include <stdio.h>

#define REQUESTS_MAX 200

static const int leaf_sizes[] = { 1, 4, 64 };
static const int depths[] = { 1, 5, 64 };

static int log2_up(uint32_t n)
{
  int log = 0;
  while ((uint64_t)1 << log < n) {
    ++log;
  }
  return log;
}

/* Leaves hold at most leaf_boxes. From the depth's bound on a subtree that fits a leaf is one, and others are halves. */
static void check_bounds(const stratus_bvh* bvh, uint32_t count, int leaf_boxes, int max_depth)
{
  int* depth = calloc(bvh->node_count, sizeof *depth);
  uint32_t* boxes = calloc(bvh->node_count, sizeof *boxes);
  assert_non_null(depth);
  assert_non_null(boxes);
  for (uint32_t i = 0; i < bvh->node_count; ++i) {
    const stratus_tree_node* node = bvh->nodes + i;
    if (stratus_tree_node_kind(node) == STRATUS_NODE_INNER) {
      depth[node->first] = depth[node->first + 1] = depth[i] + 1;
    } else {
      assert_in_range(stratus_tree_node_count(node), 1, leaf_boxes);
    }
    assert_true(depth[i] <= max_depth + log2_up(count));
  }
  for (uint32_t i = bvh->node_count; i-- > 0;) {
    const stratus_tree_node* node = bvh->nodes + i;
    const int inner = stratus_tree_node_kind(node) == STRATUS_NODE_INNER;
    boxes[i] = inner ? boxes[node->first] + boxes[node->first + 1] : stratus_tree_node_count(node);
    if (inner && depth[i] >= max_depth) {
      assert_true(boxes[i] > (uint32_t)leaf_boxes);
      assert_true(boxes[node->first + 1] - boxes[node->first] <= 1); /* the median: the right half has the odd one */
    }
  }
  free(depth);
  free(boxes);
}

static void check_one(stratus_context* context, stratus_tree_method method, const stratus_box* boxes, uint32_t count)
{
  for (size_t l = 0; l < sizeof leaf_sizes / sizeof *leaf_sizes; ++l) {
    for (size_t d = 0; d < sizeof depths / sizeof *depths; ++d) {
      stratus_bvh bvh = make_bvh(context, method, boxes, count, leaf_sizes[l], depths[d]);
      if (stratus_bvh_check(context, &bvh, boxes, count) != STRATUS_OK) {
        fail_msg("method %d, %u boxes, leaf_boxes %d: %s", (int)method, count, leaf_sizes[l], stratus_context_message(context));
      }
      check_bounds(&bvh, count, leaf_sizes[l], depths[d]);
      if (leaf_sizes[l] == 1) {
        assert_int_equal(bvh.node_count, 2 * count - 1);
      }
      stratus_bvh_release(context, &bvh);
      assert_null(bvh.nodes);
    }
  }
}

static void every_method_is_sound_on_every_set(void** state)
{
  static const uint32_t counts[] = { 1, 2, 3, 4, 5, 8, 9, 17, 64, 300 };
  stratus_context* context = make_context("host", 2);
  uint32_t random = 1;
  (void)state;
  for (int set = 0; set < BOX_SETS; ++set) {
    for (size_t c = 0; c < sizeof counts / sizeof *counts; ++c) {
      stratus_box* boxes = make_boxes((box_set)set, counts[c], &random);
      for (int method = STRATUS_TREE_SAH; method <= STRATUS_TREE_KMEANS; ++method) {
        check_one(context, (stratus_tree_method)method, boxes, counts[c]);
      }
      free(boxes);
    }
  }
  stratus_context_destroy(context);
}

static void every_count_up_to_300_is_sound(void** state)
{
  stratus_context* context = make_context("host", 2);
  uint32_t random = 2;
  (void)state;
  for (uint32_t count = 1; count <= 300; count += few_run() ? 7 : 1) {
    stratus_box* boxes = make_boxes(count % 2 ? BOXES_RANDOM : BOXES_UNIT, count, &random);
    for (int method = STRATUS_TREE_SAH; method <= STRATUS_TREE_KMEANS; ++method) {
      stratus_bvh bvh = make_bvh(context, (stratus_tree_method)method, boxes, count, 1 + (int)(count % 5), 64);
      assert_int_equal(stratus_bvh_check(context, &bvh, boxes, count), STRATUS_OK);
      stratus_bvh_release(context, &bvh);
    }
    free(boxes);
  }
  stratus_context_destroy(context);
}

/* Enough boxes that every loop is shared: bins and k-means use chunks from 64 thousand on. */
static void threads_do_not_change_the_tree(void** state)
{
  static const struct {
    box_set set;
    uint32_t count;
  } cases[] = { { BOXES_UNEVEN, 150000 }, { BOXES_UNEVEN, 6000 }, { BOXES_UNIT, 6000 }, { BOXES_ONE, 6000 }, { BOXES_RANDOM, 6000 } };
  stratus_context* contexts[] = { make_context("host", 1), make_context("host", 2), make_context("host", 5) };
  uint32_t random = 3;
  (void)state;
  for (size_t c = 0; c < sizeof cases / sizeof *cases; ++c) {
    const uint32_t count = cases[c].count;
    stratus_box* boxes = make_boxes(cases[c].set, count, &random);
    for (int method = STRATUS_TREE_SAH; method <= STRATUS_TREE_KMEANS; ++method) {
      if (count > 10000 && (method == STRATUS_TREE_AC || method == STRATUS_TREE_DPC)) {
        continue; /* made for fewer, and without a part that fewer would not see */
      }
      stratus_bvh first = make_bvh(contexts[0], (stratus_tree_method)method, boxes, count, 2, 20);
      assert_int_equal(stratus_bvh_check(contexts[0], &first, boxes, count), STRATUS_OK);
      for (size_t t = 1; t < sizeof contexts / sizeof *contexts; ++t) {
        stratus_bvh bvh = make_bvh(contexts[t], (stratus_tree_method)method, boxes, count, 2, 20);
        assert_same_bvh(&first, &bvh, count);
        stratus_bvh_release(contexts[t], &bvh);
      }
      stratus_bvh_release(contexts[0], &first);
    }
    free(boxes);
  }
  for (size_t t = 0; t < sizeof contexts / sizeof *contexts; ++t) {
    stratus_context_destroy(contexts[t]);
  }
}

/* The check notices each damage to a sound tree. */
static void the_check_sees_damage(void** state)
{
  stratus_context* context = make_context("host", 1);
  uint32_t random = 4, inner = 0, leaf = 0;
  stratus_box* boxes = make_boxes(BOXES_RANDOM, 50, &random);
  stratus_bvh bvh = make_bvh(context, STRATUS_TREE_SAH, boxes, 50, 1, 64);
  (void)state;
  for (uint32_t i = 1; i < bvh.node_count; ++i) {
    *(stratus_tree_node_kind(bvh.nodes + i) == STRATUS_NODE_INNER ? &inner : &leaf) = i;
  }
  assert_true(inner && leaf);
#define DAMAGE(place, value)                                                                                                               \
  do {                                                                                                                                     \
    const uint32_t before = (uint32_t)(place);                                                                                             \
    assert_true(before != (uint32_t)(value));                                                                                              \
    (place) = (value);                                                                                                                     \
    assert_int_equal(stratus_bvh_check(context, &bvh, boxes, 50), STRATUS_INVALID_ARGUMENT);                                               \
    memcpy(&(place), &before, sizeof before);                                                                                              \
    assert_int_equal(stratus_bvh_check(context, &bvh, boxes, 50), STRATUS_OK);                                                             \
  } while (0)
  DAMAGE(bvh.nodes[inner].lo[1], bvh.nodes[inner].lo[1] - 1);
  DAMAGE(bvh.nodes[inner].hi[2], bvh.nodes[inner].hi[2] - 1);
  DAMAGE(bvh.nodes[leaf].hi[0], bvh.nodes[leaf].hi[0] + 1);
  DAMAGE(bvh.nodes[inner].first, inner);                                                /* its own child */
  DAMAGE(bvh.nodes[inner].first, bvh.nodes[0].first);                                   /* before it */
  DAMAGE(bvh.nodes[inner].first, bvh.node_count - 1);                                   /* beyond the end */
  DAMAGE(bvh.nodes[leaf].first, 50);                                                    /* no such place */
  DAMAGE(bvh.nodes[leaf].kind_count, stratus_tree_kind_count(STRATUS_NODE_BRICKS, 0));  /* an empty leaf */
  DAMAGE(bvh.nodes[leaf].kind_count, stratus_tree_kind_count(STRATUS_NODE_BRICKS, 51)); /* more than there are */
  DAMAGE(bvh.nodes[leaf].kind_count, stratus_tree_kind_count(STRATUS_NODE_FIELD, 1));   /* none of this tree's */
  DAMAGE(bvh.order[3], bvh.order[4]);                                                   /* one twice, one not at all */
  DAMAGE(bvh.order[3], 50);                                                             /* no such box */
  DAMAGE(bvh.node_count, bvh.node_count - 2);                                           /* two nodes short */
  DAMAGE(bvh.node_count, 0);
#undef DAMAGE
  stratus_bvh_release(context, &bvh);
  free(boxes);
  stratus_context_destroy(context);
}

static void bad_input_is_refused(void** state)
{
  stratus_context* context = make_context("host", 2);
  stratus_box boxes[4] = { unit_box(0, 0, 0), unit_box(1, 0, 0), unit_box(0, 4, 0), unit_box(9, 0, 0) };
  const stratus_bvh_options good = { STRATUS_TREE_SAH, 1, 64, STRATUS_BVH_SURFACE };
  stratus_bvh bvh, untouched;
  (void)state;
  memset(&bvh, 0x55, sizeof bvh);
  untouched = bvh;
#define REFUSED(call, word)                                                                                                                \
  do {                                                                                                                                     \
    assert_int_equal(call, STRATUS_INVALID_ARGUMENT);                                                                                      \
    assert_non_null(strstr(stratus_context_message(context), word));                                                                       \
    assert_memory_equal(&bvh, &untouched, sizeof bvh);                                                                                     \
  } while (0)
  REFUSED(stratus_bvh_create(context, NULL, 4, &good, &bvh), "NULL");
  REFUSED(stratus_bvh_create(context, boxes, 4, NULL, &bvh), "NULL");
  REFUSED(stratus_bvh_create(context, boxes, 4, &good, NULL), "NULL");
  REFUSED(stratus_bvh_create(context, boxes, 0, &good, &bvh), "0 boxes outside 1..");
  REFUSED(stratus_bvh_create(context, boxes, 1u << 29, &good, &bvh), "536870912 boxes");
  static const char* const words[] = { "method 0", "method 3", "method 11", "leaf_boxes 0", "leaf_boxes 65", "max_depth 0", "max_depth 65",
    "measure 2" };
  stratus_bvh_options bad[8];
  for (int i = 0; i < 8; ++i) {
    bad[i] = good;
  }
  bad[0].method = STRATUS_TREE_HYBRID;
  bad[1].method = STRATUS_TREE_OCTANT;
  bad[2].method = (stratus_tree_method)11;
  bad[3].leaf_boxes = 0;
  bad[4].leaf_boxes = 65;
  bad[5].max_depth = 0;
  bad[6].max_depth = 65;
  bad[7].measure = (stratus_bvh_measure)2;
  for (size_t i = 0; i < 8; ++i) {
    REFUSED(stratus_bvh_create(context, boxes, 4, bad + i, &bvh), words[i]);
  }
  for (int a = 0; a < 3; ++a) {
    const stratus_box before = boxes[2];
    boxes[2].hi[a] = boxes[2].lo[a];
    REFUSED(stratus_bvh_create(context, boxes, 4, &good, &bvh), "box 2");
    boxes[2] = before;
    boxes[2].lo[a] = -STRATUS_BVH_COORDINATE_MAX - 1;
    REFUSED(stratus_bvh_create(context, boxes, 4, &good, &bvh), "box 2");
    boxes[2] = before;
    boxes[2].hi[a] = STRATUS_BVH_COORDINATE_MAX + 1;
    REFUSED(stratus_bvh_create(context, boxes, 4, &good, &bvh), "box 2");
    boxes[2] = before;
  }
#undef REFUSED
  stratus_context_destroy(context);
}

/* Boxes as far apart and as large as they may be. */
static void the_greatest_coordinates_are_borne(void** state)
{
  const int32_t most = STRATUS_BVH_COORDINATE_MAX;
  stratus_context* context = make_context("host", 2);
  stratus_box boxes[20];
  (void)state;
  for (int i = 0; i < 20; ++i) {
    boxes[i] = unit_box(i & 1 ? most - 1 - i : -most + i, i & 2 ? most - 1 : -most, i & 4 ? most - 1 : -most);
  }
  boxes[7] = (stratus_box){ { -most, -most, -most }, { most, most, most } };
  for (int method = STRATUS_TREE_SAH; method <= STRATUS_TREE_KMEANS; ++method) {
    check_one(context, (stratus_tree_method)method, boxes, 20);
  }
  stratus_context_destroy(context);
}

static void memory_refused_at_any_request_is_a_clean_error(void** state)
{
  uint32_t random = 5;
  stratus_box* boxes = make_boxes(BOXES_DOUBLING, 300, &random);
  (void)state;
  for (int method = STRATUS_TREE_SAH; method <= STRATUS_TREE_KMEANS; ++method) {
    faulty_allocator allocator = { 0 };
    stratus_context_options context_options = faulty_options(&allocator, "host");
    const stratus_bvh_options options = { (stratus_tree_method)method, 2, 8, STRATUS_BVH_SURFACE };
    stratus_context* context = NULL;
    assert_int_equal(stratus_context_create(&context_options, &context, NULL, 0), STRATUS_OK);
    const int64_t live = allocator.live;
    stratus_bvh right = make_bvh(context, options.method, boxes, 300, 2, 8), bvh;
    memset(&bvh, 0x55, sizeof bvh);
    const stratus_bvh untouched = bvh;
    int64_t n = 1;
    for (; n < REQUESTS_MAX; ++n) {
      allocator.fail_at = allocator.calls + n;
      const stratus_status status = stratus_bvh_create(context, boxes, 300, &options, &bvh);
      allocator.fail_at = 0;
      if (status == STRATUS_OK) {
        break;
      }
      assert_int_equal(status, STRATUS_OUT_OF_MEMORY);
      assert_non_null(strstr(stratus_context_message(context), "bytes"));
      assert_memory_equal(&bvh, &untouched, sizeof bvh);
      assert_int_equal(allocator.live, live + 2);
    }
    assert_in_range(n, 10, REQUESTS_MAX - 1);
    assert_same_bvh(&right, &bvh, 300);
    for (int64_t at = 1; at <= 3; ++at) {
      allocator.fail_at = allocator.calls + at;
      assert_int_equal(stratus_bvh_check(context, &bvh, boxes, 300), STRATUS_OUT_OF_MEMORY);
    }
    stratus_bvh_release(context, &bvh);
    stratus_bvh_release(context, &right);
    assert_int_equal(allocator.live, live);
    stratus_context_destroy(context);
  }
  free(boxes);
}

static int cancel_at(void* user, const char* stage, double fraction)
{
  (void)stage;
  (void)fraction;
  return --*(int*)user == 0;
}

static void a_build_can_be_cancelled(void** state)
{
  uint32_t random = 6;
  stratus_box* boxes = make_boxes(BOXES_UNEVEN, 200, &random);
  faulty_allocator allocator = { 0 };
  int left = 0;
  stratus_context_options options = faulty_options(&allocator, "host");
  stratus_context* context = NULL;
  (void)state;
  options.progress = cancel_at;
  options.progress_user = &left;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  for (int calls = 1; calls <= 2; ++calls) {
    const stratus_bvh_options how = { STRATUS_TREE_PLOC, 1, 64, STRATUS_BVH_SURFACE };
    stratus_bvh bvh;
    left = calls;
    assert_int_equal(stratus_bvh_create(context, boxes, 200, &how, &bvh), STRATUS_CANCELLED);
    assert_int_equal(allocator.live, 1);
  }
  stratus_context_destroy(context);
  free(boxes);
}

int test_bvh(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_method_is_sound_on_every_set),
    cmocka_unit_test(every_count_up_to_300_is_sound),
    cmocka_unit_test(threads_do_not_change_the_tree),
    cmocka_unit_test(the_check_sees_damage),
    cmocka_unit_test(bad_input_is_refused),
    cmocka_unit_test(the_greatest_coordinates_are_borne),
    cmocka_unit_test(memory_refused_at_any_request_is_a_clean_error),
    cmocka_unit_test(a_build_can_be_cancelled),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
