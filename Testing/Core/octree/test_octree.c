/* SPDX-License-Identifier: BSD-3-Clause
 * The octree sees what a loop over all boxes sees, whatever its placement, stop rule, depth, history, views and threads. */
#include "octree_case.h"
#include "octree.h"

#define OBJECTS 6000

static double (*make_boxes(size_t count, double scale, uint32_t seed))[6]
{
  double(*boxes)[6] = malloc(count * sizeof *boxes);
  for (size_t i = 0; i < count; ++i) {
    random_bounds(&seed, scale, boxes[i]);
  }
  return boxes;
}

static stratus_octree* make_tree(stratus_context* context, const stratus_octree_options* options)
{
  stratus_octree* tree = NULL;
  assert_int_equal(stratus_octree_create(context, options, &tree), STRATUS_OK);
  return tree;
}

static stratus_octree_view* make_view(stratus_octree* tree)
{
  stratus_octree_view* view = NULL;
  assert_int_equal(stratus_octree_view_create(tree, &view), STRATUS_OK);
  return view;
}

/* Options of a variant: every placement, stop rule and some depths. Leaves are small, so that small scenes make deep trees. */
static stratus_octree_options options_of(int variant)
{
  stratus_octree_options o = stratus_octree_options_default();
  o.stop = (stratus_octree_stop)(variant % 4);
  o.placement = variant / 4 % 2 ? STRATUS_OCTREE_TOUCHING : STRATUS_OCTREE_ENCLOSING;
  o.leaf_objects = variant % 3 ? 4 : 64;
  o.levels = variant % 5 == 4 ? 3 : 21;
  o.looseness = variant % 2 ? 1.5 : 1.0;
  o.collapse_after = variant % 3 ? 4 : 0;
  o.split_budget = variant % 7 == 6 ? 500 : 0;
  return o;
}

#define VARIANTS 24

static void every_tree_shows_what_the_linear_list_shows(void** state)
{
  static const double scales[] = { 1.0, 1e-6, 1e8 };
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (int variant = 0; variant < VARIANTS; ++variant) {
    const double scale = scales[variant % 3];
    const stratus_octree_options options = options_of(variant);
    stratus_octree_options list = options;
    list.levels = 0;
    list.placement = STRATUS_OCTREE_ENCLOSING;
    double(*boxes)[6] = make_boxes(OBJECTS, scale, (uint32_t)variant);
    uint32_t* ids = malloc(OBJECTS * sizeof *ids);
    stratus_octree *tree = make_tree(context, &options), *linear = make_tree(context, &list);
    assert_int_equal(stratus_octree_insert(tree, boxes[0], OBJECTS, ids), STRATUS_OK);
    assert_int_equal(stratus_octree_insert(linear, boxes[0], OBJECTS, ids), STRATUS_OK);
    stratus_octree_view *view = make_view(tree), *all = make_view(linear);
    uint32_t random = (uint32_t)variant;
    size_t seen = 0;
    uint64_t splits = 0;
    for (int frame = 0; frame < 30; ++frame) {
      double inside[3];
      const stratus_frustum frustum = random_frustum(context, &random, scale, inside);
      const stratus_octree_cull_options exact = { .exact = frame % 2, .hold = frame % 5 == 3 };
      stratus_octree_visible a, b;
      assert_int_equal(stratus_octree_cull(view, &frustum, &exact, &a), STRATUS_OK);
      assert_int_equal(stratus_octree_cull(all, &frustum, &exact, &b), STRATUS_OK);
      assert_int_equal(b.splits, 0);
      splits += a.splits;
      if (options.placement == STRATUS_OCTREE_ENCLOSING || exact.exact) {
        assert_same_visible(&a, &b);
      }
      uint32_t *x = sorted_ids(&a), *y = sorted_ids(&b);
      size_t i = 0, j = 0;
      for (uint32_t id = 0; id < OBJECTS; ++id) {
        const bool kept = i < a.count && x[i] == id, listed = j < b.count && y[j] == id;
        const bool meets = box_meets_frustum(&frustum, boxes[id], inside, 0.0);
        i += kept;
        j += listed;
        assert_true(!meets || (kept && listed)); /* no wrong cull */
        assert_true(!exact.exact || !kept || box_meets_frustum(&frustum, boxes[id], inside, 1e-6 * scale));
        seen += meets;
      }
      free(x);
      free(y);
    }
    assert_true(seen > OBJECTS / 10);
    assert_int_equal(stratus_octree_check(tree), STRATUS_OK);
    stratus_octree_statistics statistics;
    stratus_octree_get_statistics(tree, &statistics);
    assert_true(splits > 0 && statistics.depth <= options.levels);
    stratus_octree_view_destroy(view);
    stratus_octree_view_destroy(all);
    stratus_octree_destroy(tree);
    stratus_octree_destroy(linear);
    free(boxes);
    free(ids);
  }
  stratus_context_destroy(context);
}

/* Turned boxes: tree and list see the same ones. These include every box of which a point is in sight, and are fewer than by their
 * bounds. */
static void turned_boxes_are_tested_as_they_are(void** state)
{
  enum { COUNT = 3000 };
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_octree_options options = options_of(1), list = options;
  list.levels = 0;
  stratus_octree *tree = make_tree(context, &options), *linear = make_tree(context, &list), *about = make_tree(context, &options);
  double(*boxes)[12] = malloc(COUNT * sizeof *boxes);
  uint32_t *ids = malloc(COUNT * sizeof *ids), random = 7;
  for (int i = 0; i < COUNT; ++i) {
    /* Long and thin, along a diagonal, where their bounds are most of them empty. */
    const double s = 0.01 + 0.2 * random_unit(&random), c = 0.7071067811865476;
    const double turned[9] = { s * c, s * c, 0, -0.01 * c, 0.01 * c, 0, 0, 0, 0.01 };
    for (int a = 0; a < 3; ++a) {
      boxes[i][a] = random_unit(&random);
    }
    memcpy(boxes[i] + 3, turned, sizeof turned);
    double bounds[6];
    assert_int_equal(stratus_octree_insert_oriented(tree, boxes[i], 1, &ids[i]), STRATUS_OK);
    assert_int_equal(stratus_octree_insert_oriented(linear, boxes[i], 1, &ids[i]), STRATUS_OK);
    assert_int_equal(stratus_octree_bounds(tree, ids[i], bounds), STRATUS_OK);
    assert_int_equal(stratus_octree_insert(about, bounds, 1, &ids[i]), STRATUS_OK);
  }
  stratus_octree_view *view = make_view(tree), *all = make_view(linear), *outer = make_view(about);
  size_t fewer = 0;
  for (int frame = 0; frame < 40; ++frame) {
    const stratus_frustum frustum = random_frustum(context, &random, 1.0, NULL);
    const stratus_octree_cull_options exact = { .exact = frame % 2 };
    stratus_octree_visible a, b, c;
    assert_int_equal(stratus_octree_cull(view, &frustum, &exact, &a), STRATUS_OK);
    assert_int_equal(stratus_octree_cull(all, &frustum, &exact, &b), STRATUS_OK);
    assert_int_equal(stratus_octree_cull(outer, &frustum, &exact, &c), STRATUS_OK);
    assert_same_visible(&a, &b);
    fewer += c.count - a.count;
    uint32_t* x = sorted_ids(&a);
    for (uint32_t id = 0; id < COUNT; ++id) {
      for (int i = 0; i < 5; ++i) {
        double point[6];
        for (int a3 = 0; a3 < 3; ++a3) {
          point[2 * a3] = point[2 * a3 + 1] = boxes[id][a3] + (0.5 * i - 1.0) * boxes[id][3 + a3];
        }
        if (reach_of(&frustum, point) > 1e-12L) {
          assert_non_null(bsearch(&id, x, a.count, sizeof *x, compare_ids));
        }
      }
    }
    free(x);
  }
  assert_true(fewer > 100);
  assert_int_equal(stratus_octree_check(tree), STRATUS_OK);
  stratus_octree_view_destroy(view);
  stratus_octree_view_destroy(all);
  stratus_octree_view_destroy(outer);
  stratus_octree_destroy(tree);
  stratus_octree_destroy(linear);
  stratus_octree_destroy(about);
  free(boxes);
  free(ids);
  stratus_context_destroy(context);
}

/* Long and thin, about the z axis, where its bounds are most of them empty. */
static void random_turned(uint32_t* random, double box[12])
{
  const double angle = 6.2831853071795865 * random_unit(random), length = 0.01 + 0.2 * random_unit(random), c = cos(angle), s = sin(angle);
  const double edges[9] = { length * c, length * s, 0, -0.01 * s, 0.01 * c, 0, 0, 0, 0.01 };
  for (int a = 0; a < 3; ++a) {
    box[a] = random_unit(random);
  }
  memcpy(box + 3, edges, sizeof edges);
}

/* Moves straight and turned boxes to turned ones, one by one and many at once, and some back to straight ones: bounds and visible objects
 * are as if the boxes had been inserted there. */
static void moved_to_turned_boxes_are_as_if_inserted_there(void** state)
{
  enum { COUNT = 2000, BACK = COUNT / 4 };
  (void)state;
  stratus_context* context = make_context("host", 1);
  const stratus_octree_options options = options_of(1);
  stratus_octree *moved = make_tree(context, &options), *fresh = make_tree(context, &options);
  double(*straight)[6] = make_boxes(COUNT, 1.0, 5), (*turned)[12] = malloc(COUNT * sizeof *turned);
  uint32_t *ids = malloc(COUNT * sizeof *ids), *fresh_ids = malloc(COUNT * sizeof *ids), random = 11;
  for (int i = 0; i < COUNT; ++i) {
    double from[12];
    random_turned(&random, from);
    random_turned(&random, turned[i]);
    assert_int_equal(
      i % 2 ? stratus_octree_insert_oriented(moved, from, 1, &ids[i]) : stratus_octree_insert(moved, straight[i], 1, &ids[i]), STRATUS_OK);
  }
  stratus_octree_view *view = make_view(moved), *expected = make_view(fresh);
  stratus_octree_visible a, b, c;
  stratus_frustum frustum = random_frustum(context, &random, 1.0, NULL);
  assert_int_equal(stratus_octree_cull(view, &frustum, NULL, &a), STRATUS_OK); /* nodes are split before anything moves */
  for (int i = 0; i < COUNT / 2; ++i) {
    assert_int_equal(stratus_octree_move_oriented(moved, &ids[i], turned[i], 1), STRATUS_OK);
  }
  assert_int_equal(stratus_octree_move_oriented(moved, ids + COUNT / 2, turned[COUNT / 2], COUNT - COUNT / 2), STRATUS_OK);
  assert_int_equal(stratus_octree_move(moved, ids, straight[0], BACK), STRATUS_OK);
  assert_int_equal(stratus_octree_insert(fresh, straight[0], BACK, fresh_ids), STRATUS_OK);
  assert_int_equal(stratus_octree_insert_oriented(fresh, turned[BACK], COUNT - BACK, fresh_ids + BACK), STRATUS_OK);
  assert_int_equal(stratus_octree_check(moved), STRATUS_OK);
  for (int i = 0; i < COUNT; ++i) {
    double p[6], q[6];
    assert_int_equal(stratus_octree_bounds(moved, ids[i], p), STRATUS_OK);
    assert_int_equal(stratus_octree_bounds(fresh, fresh_ids[i], q), STRATUS_OK);
    assert_int_equal(ids[i], fresh_ids[i]);
    assert_memory_equal(p, q, sizeof p);
  }
  size_t seen = 0;
  for (int frame = 0; frame < 40; ++frame) {
    frustum = random_frustum(context, &random, 1.0, NULL);
    const stratus_octree_cull_options exact = { .exact = 1 };
    assert_int_equal(stratus_octree_cull(view, &frustum, &exact, &a), STRATUS_OK);
    assert_int_equal(stratus_octree_cull(expected, &frustum, &exact, &b), STRATUS_OK);
    assert_same_visible(&a, &b);
    seen += b.count;
    assert_int_equal(stratus_octree_cull(expected, &frustum, NULL, &c), STRATUS_OK);
    assert_int_equal(stratus_octree_cull(view, &frustum, NULL, &a), STRATUS_OK);
    assert_same_visible(&a, &c);
  }
  assert_true(seen > COUNT);
  stratus_octree_view_destroy(view);
  stratus_octree_view_destroy(expected);
  stratus_octree_destroy(moved);
  stratus_octree_destroy(fresh);
  free(straight);
  free(turned);
  free(ids);
  free(fresh_ids);
  stratus_context_destroy(context);
}

static void threads_change_no_bit_of_the_list(void** state)
{
  enum { COUNT = 60000 };
  (void)state;
  uint32_t* first = malloc(COUNT * sizeof *first);
  float* coverage = malloc(COUNT * sizeof *coverage);
  size_t count = 0;
  for (int threads = 1; threads <= 7; threads += 3) {
    stratus_context* context = make_context("host", threads);
    double(*boxes)[6] = make_boxes(COUNT, 1.0, 5);
    uint32_t *ids = malloc(COUNT * sizeof *ids), random = 11;
    stratus_octree* tree = make_tree(context, NULL);
    assert_int_equal(stratus_octree_insert(tree, boxes[0], COUNT, ids), STRATUS_OK);
    stratus_octree_view* view = make_view(tree);
    stratus_octree_visible visible;
    const stratus_octree_cull_options options = { .coverage = 1 };
    for (int frame = 0; frame < 12; ++frame) {
      const stratus_frustum frustum = random_frustum(context, &random, 1.0, NULL);
      assert_int_equal(stratus_octree_cull(view, &frustum, &options, &visible), STRATUS_OK);
    }
    if (threads == 1) {
      count = visible.count;
      assert_true(count > 100);
      memcpy(first, visible.ids, count * sizeof *first);
      memcpy(coverage, visible.coverage, count * sizeof *coverage);
    }
    assert_int_equal(visible.count, count);
    assert_memory_equal(visible.ids, first, count * sizeof *first);
    assert_memory_equal(visible.coverage, coverage, count * sizeof *coverage);
    stratus_octree_view_destroy(view);
    stratus_octree_destroy(tree);
    stratus_context_destroy(context);
    free(boxes);
    free(ids);
  }
  free(first);
  free(coverage);
}

/* Two cameras alternate on one tree. Neither disturbs what the other sees, and both keep their lists until their next call. */
static void views_share_a_tree(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_octree_options options = options_of(0), list = options;
  list.levels = 0;
  options.collapse_after = 3;
  double(*boxes)[6] = make_boxes(OBJECTS, 1.0, 3);
  uint32_t *ids = malloc(OBJECTS * sizeof *ids), random = 5;
  stratus_octree *tree = make_tree(context, &options), *linear = make_tree(context, &list);
  assert_int_equal(stratus_octree_insert(tree, boxes[0], OBJECTS, ids), STRATUS_OK);
  assert_int_equal(stratus_octree_insert(linear, boxes[0], OBJECTS, ids), STRATUS_OK);
  stratus_octree_view* views[2] = { make_view(tree), make_view(tree) };
  stratus_octree_view* all = make_view(linear);
  for (int frame = 0; frame < 20; ++frame) {
    stratus_frustum frusta[2];
    stratus_octree_visible visible[2], right;
    for (int v = 0; v < 2; ++v) {
      frusta[v] = random_frustum(context, &random, 1.0, NULL);
      assert_int_equal(stratus_octree_cull(views[v], &frusta[v], NULL, &visible[v]), STRATUS_OK);
    }
    for (int v = 0; v < 2; ++v) {
      assert_int_equal(stratus_octree_cull(all, &frusta[v], NULL, &right), STRATUS_OK);
      assert_same_visible(&visible[v], &right);
    }
  }
  stratus_octree_view_destroy(views[0]);
  stratus_octree_view_destroy(views[1]);
  stratus_octree_view_destroy(all);
  stratus_octree_destroy(tree);
  stratus_octree_destroy(linear);
  free(boxes);
  free(ids);
  stratus_context_destroy(context);
}

/* Nodes appear where a border is, and go when none has been there for long. The static tree has more nodes than the adaptive one. */
static void nodes_come_with_the_border_and_go_without_it(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_octree_options options = stratus_octree_options_default(), fixed;
  options.leaf_objects = 8;
  options.collapse_after = 16;
  options.looseness = 1.0; /* cells are the nodes that a border crosses */
  fixed = options;
  fixed.stop = STRATUS_OCTREE_STOP_STATIC;
  double(*boxes)[6] = make_boxes(OBJECTS, 1.0, 9);
  uint32_t* ids = malloc(OBJECTS * sizeof *ids);
  stratus_octree *tree = make_tree(context, &options), *whole = make_tree(context, &fixed);
  assert_int_equal(stratus_octree_insert(tree, boxes[0], OBJECTS, ids), STRATUS_OK);
  assert_int_equal(stratus_octree_insert(whole, boxes[0], OBJECTS, ids), STRATUS_OK);
  stratus_octree_view *view = make_view(tree), *other = make_view(whole);
  stratus_octree_statistics adaptive, full, later;
  stratus_octree_visible visible;
  stratus_camera camera;
  stratus_frustum close, away;
  const double eye[3] = { 0.3, 0.3, 0.3 }, focal[3] = { 1, 0.4, 0.3 }, up[3] = { 0, 0, 1 }, back[3] = { -40, 0, 0 },
               behind[3] = { -41, 0, 0 };
  assert_int_equal(stratus_camera_perspective(context, eye, focal, up, 20.0, 1.0, &camera), STRATUS_OK);
  assert_int_equal(stratus_frustum_from_camera(context, &camera, &close), STRATUS_OK);
  assert_int_equal(stratus_camera_perspective(context, back, behind, up, 20.0, 1.0, &camera), STRATUS_OK);
  assert_int_equal(stratus_frustum_from_camera(context, &camera, &away), STRATUS_OK);
  assert_int_equal(stratus_octree_cull(view, &close, NULL, &visible), STRATUS_OK);
  assert_true(visible.splits > 0 && visible.count > 0);
  assert_int_equal(stratus_octree_cull(other, &close, NULL, &visible), STRATUS_OK);
  stratus_octree_get_statistics(tree, &adaptive);
  stratus_octree_get_statistics(whole, &full);
  assert_true(adaptive.nodes > 8 && 2 * adaptive.nodes < full.nodes);
  assert_true(adaptive.bytes < full.bytes);
  stratus_octree_node* nodes = malloc(full.nodes * sizeof *nodes);
  assert_int_equal(stratus_octree_nodes(tree, &close, nodes), STRATUS_OK);
  size_t held = 0;
  for (size_t i = 0; i < adaptive.nodes; ++i) {
    held += nodes[i].objects;
    /* Only nodes that the border crossed are split. */
    assert_true(!nodes[i].split || nodes[i].side == STRATUS_SIDE_CROSSING);
  }
  assert_int_equal(held, OBJECTS);
  assert_memory_equal(nodes[0].bounds, adaptive.root, sizeof adaptive.root);
  uint64_t collapses = 0;
  for (int frame = 0; frame < 64; ++frame) {
    assert_int_equal(stratus_octree_cull(view, &away, NULL, &visible), STRATUS_OK);
    assert_int_equal(visible.count, 0);
    collapses += visible.collapses;
  }
  stratus_octree_get_statistics(tree, &later);
  assert_int_equal(later.nodes, 1);
  assert_int_equal(collapses, adaptive.split_nodes);
  assert_int_equal(stratus_octree_check(tree), STRATUS_OK);
  assert_int_equal(stratus_octree_check(whole), STRATUS_OK);
  free(nodes);
  stratus_octree_view_destroy(view);
  stratus_octree_view_destroy(other);
  stratus_octree_destroy(tree);
  stratus_octree_destroy(whole);
  free(boxes);
  free(ids);
  stratus_context_destroy(context);
}

/* A scene that is wholly in sight needs no tree. One box across the border needs it. */
static void what_is_wholly_in_sight_needs_no_tree(void** state)
{
  (void)state;
  for (int touching = 0; touching < 2; ++touching) {
    stratus_context* context = make_context("host", 1);
    stratus_octree_options options = stratus_octree_options_default();
    options.placement = touching ? STRATUS_OCTREE_TOUCHING : STRATUS_OCTREE_ENCLOSING;
    options.leaf_objects = 8;
    double(*boxes)[6] = make_boxes(OBJECTS, 1.0, 5);
    uint32_t* ids = malloc(OBJECTS * sizeof *ids);
    stratus_octree* tree = make_tree(context, &options);
    stratus_octree_view* view = make_view(tree);
    const stratus_camera camera = {
      .eye = { 0, 0, 20 }, .forward = { 0, 0, -1 }, .right = { 10, 0, 0 }, .up = { 0, 10, 0 }, .near_k = 1, .far_k = 100, .parallel = 1
    };
    const double over_the_border[6] = { 9.5, 10.5, 0, 1, 0, 1 };
    stratus_frustum frustum;
    stratus_octree_visible visible;
    assert_int_equal(stratus_octree_insert(tree, boxes[0], OBJECTS, ids), STRATUS_OK);
    assert_int_equal(stratus_frustum_from_camera(context, &camera, &frustum), STRATUS_OK);
    assert_int_equal(stratus_octree_cull(view, &frustum, NULL, &visible), STRATUS_OK);
    assert_int_equal(visible.count, OBJECTS);
    assert_int_equal(visible.splits + visible.objects_tested + visible.nodes_tested, 0);
    assert_int_equal(stratus_octree_move(tree, &ids[7], over_the_border, 1), STRATUS_OK);
    assert_int_equal(stratus_octree_cull(view, &frustum, NULL, &visible), STRATUS_OK);
    assert_int_equal(visible.count, OBJECTS);
    assert_true(visible.splits > 0);
    assert_int_equal(stratus_octree_check(tree), STRATUS_OK);
    stratus_octree_clear(tree);
    assert_int_equal(stratus_octree_insert(tree, boxes[0], OBJECTS, ids), STRATUS_OK);
    assert_int_equal(stratus_octree_cull(view, &frustum, NULL, &visible), STRATUS_OK);
    assert_int_equal(visible.splits, 0); /* clear() forgets all earlier splits */
    free(boxes);
    free(ids);
    stratus_octree_view_destroy(view);
    stratus_octree_destroy(tree);
    stratus_context_destroy(context);
  }
}

/* A cube in the middle of a window of twice its sphere's width, and one that hangs half over its border. */
/* An empty first frame, before the view has room for results. */
static void a_view_of_nothing_sees_nothing(void** state)
{
  (void)state;
  const double behind[12] = { -2, -1, -1, 1, -1, 1, -9, -8, 0, 1, 0, 1 };
  const stratus_frustum frustum = { .planes = {
                                      { 1, 0, 0, 0 }, { 1, 0, 0, 5 }, { 0, 1, 0, 9 }, { 0, -1, 0, 9 }, { 0, 0, 1, 9 }, { 0, 0, -1, 9 } } };
  const stratus_octree_cull_options measured = { .coverage = 1 };
  stratus_context* context = make_context("host", 1);
  for (int variant = 0; variant < VARIANTS; ++variant) {
    const stratus_octree_options options = options_of(variant);
    stratus_octree* tree = make_tree(context, &options);
    stratus_octree_view* view = make_view(tree);
    stratus_octree_visible visible = { .count = 7 };
    uint32_t ids[2];
    size_t count = 7;
    assert_int_equal(stratus_octree_cull(view, &frustum, &measured, &visible), STRATUS_OK);
    assert_int_equal(visible.count, 0);
    assert_int_equal(stratus_octree_query_box(tree, behind, NULL, 0, &count), STRATUS_OK);
    assert_int_equal(count, 0);
    assert_int_equal(stratus_octree_check(tree), STRATUS_OK);
    assert_int_equal(stratus_octree_insert(tree, behind, 2, ids), STRATUS_OK);
    assert_int_equal(stratus_octree_cull(view, &frustum, &measured, &visible), STRATUS_OK);
    assert_int_equal(visible.count, 0);
    assert_int_equal(stratus_octree_remove(tree, ids, 2), STRATUS_OK);
    assert_int_equal(stratus_octree_cull(view, &frustum, &measured, &visible), STRATUS_OK);
    assert_int_equal(visible.count, 0);
    stratus_octree_clear(tree);
    stratus_octree_view_destroy(view);
    stratus_octree_destroy(tree);
  }
  stratus_context_destroy(context);
}

static void coverage_is_the_window_s_share(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_octree* tree = make_tree(context, NULL);
  stratus_octree_view* view = make_view(tree);
  const double s = 1.0 / sqrt(3.0); /* of spheres of radius 1 */
  const double boxes[3][6] = { { -s, s, -s, s, -5 - s, -5 + s }, { 2 - s, 2 + s, -s, s, -6 - s, -6 + s }, { NAN, 1, 0, 1, 0, 1 } };
  uint32_t ids[3];
  const stratus_camera camera = {
    .forward = { 0, 0, -1 }, .right = { 2, 0, 0 }, .up = { 0, 2, 0 }, .near_k = 1, .far_k = 100, .parallel = 1
  };
  stratus_frustum frustum;
  stratus_octree_visible visible;
  const stratus_octree_cull_options options = { .coverage = 1 };
  assert_int_equal(stratus_octree_insert(tree, boxes[0], 3, ids), STRATUS_OK);
  assert_int_equal(stratus_frustum_from_camera(context, &camera, &frustum), STRATUS_OK);
  assert_int_equal(stratus_octree_cull(view, &frustum, &options, &visible), STRATUS_OK);
  assert_int_equal(visible.count, 3);
  static const float coverage[] = { 0.25f, 0.125f, 1.0f }, depth[] = { 4.0f, 5.0f, 0.0f };
  for (size_t i = 0; i < 3; ++i) {
    /* Tolerances for floats of order one. */
    assert_true(fabsf(visible.coverage[i] - coverage[visible.ids[i]]) < 1e-6f);
    assert_true(fabsf(visible.depth[i] - depth[visible.ids[i]]) < 1e-5f);
  }
  stratus_octree_view_destroy(view);
  stratus_octree_destroy(tree);
  stratus_context_destroy(context);
}

int test_octree(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_tree_shows_what_the_linear_list_shows),
    cmocka_unit_test(turned_boxes_are_tested_as_they_are),
    cmocka_unit_test(moved_to_turned_boxes_are_as_if_inserted_there),
    cmocka_unit_test(threads_change_no_bit_of_the_list),
    cmocka_unit_test(views_share_a_tree),
    cmocka_unit_test(nodes_come_with_the_border_and_go_without_it),
    cmocka_unit_test(what_is_wholly_in_sight_needs_no_tree),
    cmocka_unit_test(a_view_of_nothing_sees_nothing),
    cmocka_unit_test(coverage_is_the_window_s_share),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
