/* SPDX-License-Identifier: BSD-3-Clause
 * Shapes of the bounding volume hierarchies, compared with slow and obvious methods on few boxes, and the cost of leaves. A shape is the
 * set of a tree's inner nodes, each as a mask of the boxes under it. */
#include "boxes.h"

#include <stdio.h>

#define BOXES_MAX 60

static stratus_context* context;

typedef struct shape {
  uint64_t masks[BOXES_MAX];
  int count;
} shape;

static int compare_masks(const void* a, const void* b)
{
  const uint64_t x = *(const uint64_t*)a, y = *(const uint64_t*)b;
  return (x > y) - (x < y);
}

static void assert_same_shape(shape* a, shape* b)
{
  assert_int_equal(a->count, b->count);
  qsort(a->masks, (size_t)a->count, sizeof *a->masks, compare_masks);
  qsort(b->masks, (size_t)b->count, sizeof *b->masks, compare_masks);
  for (int i = 0; i < a->count; ++i) {
    assert_true(a->masks[i] == b->masks[i]);
  }
}

static uint64_t add_pairs(const stratus_bvh_pair* pairs, uint32_t child, shape* s)
{
  if (child & STRATUS_BVH_LEAF) {
    return (uint64_t)1 << (child & ~STRATUS_BVH_LEAF);
  }
  const uint64_t mask = add_pairs(pairs, pairs[child].child[0], s) | add_pairs(pairs, pairs[child].child[1], s);
  s->masks[s->count++] = mask;
  return mask;
}

static uint64_t mask_of(const stratus_bvh* bvh, uint32_t node, shape* s)
{
  const stratus_tree_node* n = bvh->nodes + node;
  if (stratus_tree_node_kind(n) != STRATUS_NODE_INNER) {
    assert_int_equal(stratus_tree_node_count(n), 1);
    return (uint64_t)1 << bvh->order[n->first];
  }
  const uint64_t mask = mask_of(bvh, n->first, s) | mask_of(bvh, n->first + 1, s);
  s->masks[s->count++] = mask;
  return mask;
}

static shape shape_of(stratus_tree_method method, const stratus_box* boxes, uint32_t count)
{
  stratus_bvh bvh = make_bvh(context, method, boxes, count, 1, 64);
  shape s = { .count = 0 };
  assert_int_equal(stratus_bvh_check(context, &bvh, boxes, count), STRATUS_OK);
  (void)mask_of(&bvh, 0, &s);
  stratus_bvh_release(context, &bvh);
  return s;
}

static stratus_bvh_build sorted(const stratus_box* boxes, uint32_t count)
{
  stratus_bvh_build build = { .context = context, .count = count, .max_depth = 64 };
  assert_int_equal(stratus_bvh_sort_boxes(&build, boxes), STRATUS_OK);
  return build;
}

static void release(stratus_bvh_build* build)
{
  stratus_release(context, build->boxes);
  stratus_release(context, build->number);
  stratus_release(context, build->codes);
}

static double measured(const stratus_box* a, const stratus_box* b, stratus_bvh_measure measure)
{
  stratus_box both = *a;
  stratus_box_add(&both, b);
  return measure == STRATUS_BVH_SURFACE
    ? stratus_box_area(&both)
    : (double)(both.hi[0] - both.lo[0]) + (double)(both.hi[1] - both.lo[1]) + (double)(both.hi[2] - both.lo[2]);
}

/* Merges the two nearest clusters until one is left. Ties as bvh_agglomerative.c says; *ties counts them. */
static shape greedy_shape(const stratus_box* boxes, uint32_t count, stratus_bvh_measure measure, int* ties)
{
  stratus_box box[BOXES_MAX];
  uint64_t mask[BOXES_MAX];
  bool live[BOXES_MAX];
  shape s = { .count = 0 };
  *ties = 0;
  for (uint32_t i = 0; i < count; ++i) {
    box[i] = boxes[i];
    mask[i] = (uint64_t)1 << i;
    live[i] = true;
  }
  while ((uint32_t)s.count < count - 1) {
    uint32_t low = 0, high = 0;
    double least = INFINITY;
    for (uint32_t i = 0; i < count; ++i) {
      for (uint32_t j = i + 1; live[i] && j < count; ++j) {
        if (live[j]) {
          const double distance = measured(box + i, box + j, measure);
          *ties += distance == least;
          if (distance < least || (distance == least && (i ^ j) < (low ^ high))) {
            least = distance;
            low = i;
            high = j;
          }
        }
      }
    }
    stratus_box_add(box + low, box + high);
    mask[low] |= mask[high];
    live[high] = false;
    s.masks[s.count++] = mask[low];
  }
  return s;
}

static void agglomerative_clustering_is_the_greedy_one(void** state)
{
  uint32_t random = 1;
  int ties = 0, all_ties = 0;
  (void)state;
  for (int repeat = 0; repeat < 40; ++repeat) {
    for (int set = 0; set < BOX_SETS; ++set) {
      const uint32_t count = (uint32_t)random_below(&random, BOXES_MAX - 1) + 2;
      stratus_box* boxes = make_boxes((box_set)set, count, &random);
      for (int measure = STRATUS_BVH_SURFACE; measure <= STRATUS_BVH_EDGES; ++measure) {
        stratus_bvh_pair pairs[BOXES_MAX];
        uint32_t root = 0;
        shape s = { .count = 0 }, greedy = greedy_shape(boxes, count, (stratus_bvh_measure)measure, &ties);
        assert_int_equal(stratus_bvh_agglomerate(context, (stratus_bvh_measure)measure, boxes, count, pairs, &root), STRATUS_OK);
        (void)add_pairs(pairs, root, &s);
        assert_same_shape(&s, &greedy);
        all_ties += ties;
      }
      free(boxes);
    }
  }
  assert_true(all_ties > 1000); /* as in lattices: else the order of equals was not tried */
}

/* The shape with masks by the caller's numbers instead of ranks. */
static shape by_number(const shape* ranks, const stratus_bvh_build* build)
{
  shape s = { .count = ranks->count };
  for (int m = 0; m < s.count; ++m) {
    s.masks[m] = 0;
    for (uint32_t rank = 0; rank < build->count; ++rank) {
      s.masks[m] |= (ranks->masks[m] >> rank & 1) << build->number[rank];
    }
  }
  return s;
}

static void the_measure_asked_for_is_the_one_merged_by(void** state)
{
  uint32_t random = 5;
  int ties = 0, differ = 0;
  (void)state;
  for (int repeat = 0; repeat < 20; ++repeat) {
    for (int set = 0; set < BOX_SETS; ++set) {
      const uint32_t count = (uint32_t)random_below(&random, BOXES_MAX - 1) + 2;
      stratus_box* boxes = make_boxes((box_set)set, count, &random);
      stratus_bvh_build build = sorted(boxes, count);
      double cost[2];
      for (int measure = STRATUS_BVH_SURFACE; measure <= STRATUS_BVH_EDGES; ++measure) {
        const stratus_bvh_options options = { STRATUS_TREE_AC, 1, 64, (stratus_bvh_measure)measure };
        stratus_bvh bvh = make_bvh_by(context, &options, boxes, count);
        const shape ranks = greedy_shape(build.boxes, count, options.measure, &ties);
        shape s = { .count = 0 }, greedy = by_number(&ranks, &build);
        (void)mask_of(&bvh, 0, &s);
        assert_same_shape(&s, &greedy);
        cost[measure] = stratus_bvh_sah(bvh.nodes, bvh.node_count);
        stratus_bvh_release(context, &bvh);
      }
      differ += cost[STRATUS_BVH_SURFACE] != cost[STRATUS_BVH_EDGES];
      release(&build);
      free(boxes);
    }
  }
  assert_true(differ > 20); /* else both measures gave equal trees */
}

static void few_boxes_make_the_greedy_tree_by_ploc_and_k_means(void** state)
{
  uint32_t random = 2;
  int ties = 0;
  (void)state;
  for (int repeat = 0; repeat < 200; ++repeat) {
    const uint32_t count = (uint32_t)random_below(&random, 16) + 2; /* all within PLOC's radius; eight are k-means' one cluster each */
    stratus_box* boxes = make_boxes(BOXES_RANDOM, count, &random);
    shape greedy = greedy_shape(boxes, count, STRATUS_BVH_SURFACE, &ties);
    if (ties == 0) {
      shape ploc = shape_of(STRATUS_TREE_PLOC, boxes, count);
      assert_same_shape(&ploc, &greedy);
      if (count <= 8) {
        shape k_means = shape_of(STRATUS_TREE_KMEANS, boxes, count);
        assert_same_shape(&k_means, &greedy);
      }
    }
    free(boxes);
  }
}

/* ---- Morton codes */

static uint64_t slow_code(const stratus_box* boxes, uint32_t count, uint32_t i)
{
  int64_t least[3], extent = 0;
  for (int a = 0; a < 3; ++a) {
    int64_t most = INT64_MIN;
    least[a] = INT64_MAX;
    for (uint32_t b = 0; b < count; ++b) {
      const int64_t middle = (int64_t)boxes[b].lo[a] + boxes[b].hi[a];
      least[a] = middle < least[a] ? middle : least[a];
      most = middle > most ? middle : most;
    }
    extent = most - least[a] > extent ? most - least[a] : extent;
  }
  int shift = 0;
  while (extent >> shift >= 1 << 21) {
    ++shift;
  }
  uint64_t code = 0;
  for (int a = 0; a < 3; ++a) {
    const int64_t place = ((int64_t)boxes[i].lo[a] + boxes[i].hi[a] - least[a]) >> shift;
    for (int bit = 0; bit < 21; ++bit) {
      code |= (uint64_t)(place >> bit & 1) << (3 * bit + a);
    }
  }
  return code;
}

/* Splits ranks [begin, end) at the highest bit in which their codes differ; ranks split equal codes. */
static uint64_t part_slowly(const stratus_bvh_build* build, uint32_t begin, uint32_t end, shape* s)
{
  if (end - begin == 1) {
    return (uint64_t)1 << build->number[begin];
  }
  const bool equal = build->codes[begin] == build->codes[end - 1];
  int bit = 63;
#define KEY(rank) (equal ? (uint64_t)(rank) : build->codes[rank])
  while (KEY(begin) >> bit == KEY(end - 1) >> bit) {
    --bit;
  }
  uint32_t middle = begin;
  while (!(KEY(middle) >> bit & 1)) {
    ++middle;
  }
#undef KEY
  const uint64_t mask = part_slowly(build, begin, middle, s) | part_slowly(build, middle, end, s);
  s->masks[s->count++] = mask;
  return mask;
}

static void lbvh_parts_at_the_highest_bit(void** state)
{
  uint32_t random = 3;
  (void)state;
  for (int repeat = 0; repeat < 40; ++repeat) {
    for (int set = 0; set < BOX_SETS; ++set) {
      const uint32_t count = (uint32_t)random_below(&random, BOXES_MAX - 1) + 2;
      stratus_box* boxes = make_boxes((box_set)set, count, &random);
      stratus_bvh_build build = sorted(boxes, count);
      for (uint32_t i = 0; i < count; ++i) {
        assert_true(build.codes[i] == slow_code(boxes, count, build.number[i]));
        assert_memory_equal(build.boxes + i, boxes + build.number[i], sizeof *boxes);
        assert_true(
          i == 0 || build.codes[i - 1] < build.codes[i] || (build.codes[i - 1] == build.codes[i] && build.number[i - 1] < build.number[i]));
      }
      shape slow = { .count = 0 }, s = shape_of(STRATUS_TREE_LBVH, boxes, count);
      (void)part_slowly(&build, 0, count, &slow);
      assert_same_shape(&s, &slow);
      release(&build);
      free(boxes);
    }
  }
}

/* ---- surface area heuristic */

static double cost_of(const stratus_box* boxes, uint32_t count, uint64_t mask)
{
  stratus_box all = stratus_box_none();
  int n = 0;
  for (uint32_t i = 0; i < count; ++i) {
    if (mask >> i & 1) {
      stratus_box_add(&all, boxes + i);
      ++n;
    }
  }
  return stratus_box_area(&all) * n;
}

/* Least cost of all splits of the boxes under `mask` by a plane between middles; INFINITY if all middles agree. */
static double least_cost(const stratus_box* boxes, uint32_t count, uint64_t mask)
{
  double least = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    for (uint32_t at = 0; at < count; ++at) {
      uint64_t left = 0;
      for (uint32_t i = 0; i < count; ++i) {
        left |= (uint64_t)(stratus_box_middle(boxes + i, axis) < stratus_box_middle(boxes + at, axis)) << i;
      }
      left &= mask;
      if (left && left != mask) {
        least = fmin(least, cost_of(boxes, count, left) + cost_of(boxes, count, mask & ~left));
      }
    }
  }
  return least;
}

/* Checks that every node's split is the best. The sweep also splits between boxes whose middles agree, so that it may be better. */
static void check_splits(stratus_tree_method method, const stratus_box* boxes, uint32_t count, bool exact)
{
  stratus_bvh bvh = make_bvh(context, method, boxes, count, 1, 64);
  for (uint32_t i = 0; i < bvh.node_count; ++i) {
    const stratus_tree_node* node = bvh.nodes + i;
    shape unused = { .count = 0 };
    if (stratus_tree_node_kind(node) == STRATUS_NODE_INNER) {
      const uint64_t left = mask_of(&bvh, node->first, &unused), right = mask_of(&bvh, node->first + 1, &unused);
      const double cost = cost_of(boxes, count, left) + cost_of(boxes, count, right), least = least_cost(boxes, count, left | right);
      assert_true(cost <= least);
      assert_true(!exact || cost == least || least == INFINITY);
    }
  }
  stratus_bvh_release(context, &bvh);
}

static void every_split_by_surface_area_is_the_best(void** state)
{
  uint32_t random = 4;
  (void)state;
  for (int repeat = 0; repeat < 40; ++repeat) {
    for (int set = 0; set < BOX_SETS; ++set) {
      const uint32_t count = (uint32_t)random_below(&random, 30) + 2;
      stratus_box* boxes = make_boxes((box_set)set, count, &random);
      check_splits(STRATUS_TREE_SWEEP, boxes, count, false);
      if (set == BOXES_UNIT || set == BOXES_ONE) {
        check_splits(STRATUS_TREE_SAH, boxes, count, true); /* a bin a place */
      }
      free(boxes);
    }
    stratus_box distinct[24];
    for (int i = 0; i < 24; ++i) { /* no two middles agree along an axis */
      distinct[i] = unit_box(5 * i + random_below(&random, 5), 7 * ((i * 7) % 24) + random_below(&random, 7), 3 * ((i * 11) % 24));
    }
    check_splits(STRATUS_TREE_SWEEP, distinct, 24, true);
  }
}

static void the_cost_is_what_one_computes_by_hand(void** state)
{
  const stratus_box apart[2] = { unit_box(0, 0, 0), unit_box(9, 0, 0) }, near[2] = { unit_box(0, 0, 0), unit_box(1, 0, 0) };
  (void)state;
  stratus_bvh bvh = make_bvh(context, STRATUS_TREE_SAH, apart, 2, 2, 64);
  assert_int_equal(bvh.node_count, 3); /* 10 + 1 + 10 of surface, twice that as a leaf; with two leaves 21 + 3 + 3 */
  assert_true(stratus_bvh_sah(bvh.nodes, bvh.node_count) == 27.0 / 21.0);
  stratus_bvh_release(context, &bvh);
  bvh = make_bvh(context, STRATUS_TREE_SAH, near, 2, 2, 64);
  assert_int_equal(bvh.node_count, 1); /* 2 * 5 as a leaf, 5 + 3 + 3 with two */
  assert_true(stratus_bvh_sah(bvh.nodes, bvh.node_count) == 2.0);
  stratus_bvh_release(context, &bvh);
}

int test_bvh_shapes(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(agglomerative_clustering_is_the_greedy_one),
    cmocka_unit_test(the_measure_asked_for_is_the_one_merged_by),
    cmocka_unit_test(few_boxes_make_the_greedy_tree_by_ploc_and_k_means),
    cmocka_unit_test(lbvh_parts_at_the_highest_bit),
    cmocka_unit_test(every_split_by_surface_area_is_the_best),
    cmocka_unit_test(the_cost_is_what_one_computes_by_hand),
  };
  context = make_context("host", 2);
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  stratus_context_destroy(context);
  return failed;
}
