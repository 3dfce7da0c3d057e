/* SPDX-License-Identifier: BSD-3-Clause
 * Hard cases for an octree of objects: no object, one, all at one place, boxes of no size, infinite or NaN bounds, eyes within boxes, tiny
 * and huge scenes, flat frusta, 21 levels, borders of cells, refused memory, invalid arguments. Each case has its expected result. */
#include "faulty_allocator.h"
#include "octree_case.h"

#include "octree.h"

#define REQUESTS_MAX 4000

typedef struct scene {
  stratus_context* context;
  stratus_octree* tree;
  stratus_octree_view* view;
  stratus_octree_visible visible;
} scene;

static stratus_octree_options small_leaves(int variant)
{
  stratus_octree_options o = stratus_octree_options_default();
  o.leaf_objects = 4;
  o.pixels = 1e-6;
  o.stop = (stratus_octree_stop)(variant % 4);
  o.placement = variant / 4 ? STRATUS_OCTREE_TOUCHING : STRATUS_OCTREE_ENCLOSING;
  return o;
}

#define VARIANTS 8

static void open_scene(scene* s, int variant)
{
  const stratus_octree_options options = small_leaves(variant);
  s->context = make_context("host", 1);
  assert_int_equal(stratus_octree_create(s->context, &options, &s->tree), STRATUS_OK);
  assert_int_equal(stratus_octree_view_create(s->tree, &s->view), STRATUS_OK);
}

static void close_scene(scene* s)
{
  if (stratus_octree_check(s->tree) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(s->context));
  }
  stratus_octree_view_destroy(s->view);
  stratus_octree_destroy(s->tree);
  stratus_context_destroy(s->context);
}

static stratus_frustum look(scene* s, const double eye[3], const double focal[3], double near_k, double far_k)
{
  const double up[3] = { 0, 0.1, 1 };
  stratus_camera camera;
  stratus_frustum frustum;
  assert_int_equal(stratus_camera_perspective(s->context, eye, focal, up, 40.0, 1.0, &camera), STRATUS_OK);
  camera.near_k = near_k;
  camera.far_k = far_k;
  assert_int_equal(stratus_frustum_from_camera(s->context, &camera, &frustum), STRATUS_OK);
  return frustum;
}

static size_t seen(scene* s, const stratus_frustum* frustum, int exact)
{
  const stratus_octree_cull_options options = { .exact = exact, .coverage = 1 };
  assert_int_equal(stratus_octree_cull(s->view, frustum, &options, &s->visible), STRATUS_OK);
  for (size_t i = 0; i < s->visible.count; ++i) {
    assert_true(s->visible.coverage[i] >= 0.0f && s->visible.coverage[i] <= 1.0f);
    assert_true(!isnan(s->visible.depth[i]));
  }
  return s->visible.count;
}

static void no_object_and_one(void** state)
{
  (void)state;
  for (int variant = 0; variant < VARIANTS; ++variant) {
    scene s;
    open_scene(&s, variant);
    const double eye[3] = { -5, 0, 0 }, origin[3] = { 0, 0, 0 }, away[3] = { -10, 0, 0 }, box[6] = { -1, 1, -1, 1, -1, 1 };
    const stratus_frustum towards = look(&s, eye, origin, 0.1, 100.0), backwards = look(&s, eye, away, 0.1, 100.0);
    uint32_t id = 7, ids[2];
    double distance;
    size_t count = 9;
    assert_int_equal(seen(&s, &towards, 0), 0);
    assert_int_equal(stratus_octree_query_nearest(s.tree, eye, 2, ids, NULL, &count), STRATUS_OK);
    assert_int_equal(count, 0);
    assert_int_equal(stratus_octree_query_box(s.tree, box, ids, 2, &count), STRATUS_OK);
    assert_int_equal(count, 0);
    assert_int_equal(stratus_octree_insert(s.tree, box, 0, &id), STRATUS_OK);
    assert_int_equal(stratus_octree_remove(s.tree, &id, 0), STRATUS_OK);
    assert_int_equal(stratus_octree_insert(s.tree, box, 1, &id), STRATUS_OK);
    assert_int_equal(id, 0);
    assert_int_equal(seen(&s, &towards, 1), 1);
    assert_int_equal(seen(&s, &backwards, 0), 0);
    assert_int_equal(stratus_octree_query_nearest(s.tree, eye, 2, ids, &distance, &count), STRATUS_OK);
    assert_int_equal(count, 1);
    assert_true(distance == 4.0);
    assert_int_equal(stratus_octree_remove(s.tree, &id, 1), STRATUS_OK);
    assert_int_equal(seen(&s, &towards, 0), 0);
    close_scene(&s);
  }
}

/* Points, and boxes of one size: no split separates them, and the tree must not grow without end. */
static void all_at_one_place(void** state)
{
  (void)state;
  for (int variant = 0; variant < VARIANTS; ++variant) {
    for (int size = 0; size < 2; ++size) {
      scene s;
      open_scene(&s, variant);
      static double boxes[1000][6];
      static uint32_t ids[1000];
      for (int i = 0; i < 1000; ++i) {
        for (int j = 0; j < 6; ++j) {
          boxes[i][j] = 3.0 + (j % 2 ? size : -size);
        }
      }
      assert_int_equal(stratus_octree_insert(s.tree, boxes[0], 1000, ids), STRATUS_OK);
      const double eye[3] = { 3.001, 3, 3 }, point[3] = { 3, 3, 3 }, far_eye[3] = { 30, 3, 3 };
      for (int frame = 0; frame < 3; ++frame) {
        const stratus_frustum close = look(&s, eye, point, 1e-4, 10.0), away = look(&s, far_eye, point, 1.0, 100.0);
        assert_int_equal(seen(&s, &close, 1), 1000);
        assert_int_equal(seen(&s, &away, 0), 1000);
      }
      stratus_octree_statistics statistics;
      stratus_octree_get_statistics(s.tree, &statistics);
      assert_true(statistics.nodes < 8 * 8 * 22);
      close_scene(&s);
    }
  }
}

static void bounds_of_no_size_infinite_or_not_a_number(void** state)
{
  static const double boxes[8][6] = { { 0, 0, 0, 0, 0, 0 }, { -INFINITY, INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY },
    { 0, INFINITY, 0, 1, 0, 1 }, { NAN, 1, 0, 1, 0, 1 }, { 0, 1, 0, NAN, 0, 1 }, { 1e31, 2e31, 0, 1, 0, 1 }, { 50, 50, 50, 50, 50, 50 },
    { -1e30, 1e30, -1e30, 1e30, -1e30, 1e30 } };
  (void)state;
  for (int variant = 0; variant < VARIANTS; ++variant) {
    scene s;
    uint32_t ids[8], found[8];
    size_t count;
    open_scene(&s, variant);
    assert_int_equal(stratus_octree_insert(s.tree, boxes[0], 8, ids), STRATUS_OK);
    const double eye[3] = { -5, 0, 0 }, origin[3] = { 0, 0, 0 }, away[3] = { -10, 0, 0 }, far_box[6] = { 90, 91, 90, 91, 90, 91 };
    const stratus_frustum towards = look(&s, eye, origin, 0.1, 20.0), backwards = look(&s, eye, away, 0.1, 20.0);
    assert_int_equal(seen(&s, &towards, 1), 7);   /* all but the point at 50 */
    assert_int_equal(seen(&s, &backwards, 1), 6); /* the five without bounds, and the one about everything */
    stratus_octree_statistics statistics;
    stratus_octree_get_statistics(s.tree, &statistics);
    assert_int_equal(statistics.unbounded, 5);
    assert_int_equal(stratus_octree_query_box(s.tree, far_box, found, 8, &count), STRATUS_OK);
    assert_int_equal(count, 6);
    assert_int_equal(stratus_octree_query_nearest(s.tree, eye, 8, found, NULL, &count), STRATUS_OK);
    assert_int_equal(count, 3);
    /* There and back. */
    assert_int_equal(stratus_octree_move(s.tree, &ids[0], boxes[3], 1), STRATUS_OK);
    assert_int_equal(stratus_octree_move(s.tree, &ids[4], boxes[6], 1), STRATUS_OK);
    assert_int_equal(seen(&s, &backwards, 0), 6);
    assert_int_equal(stratus_octree_remove(s.tree, ids, 8), STRATUS_OK);
    assert_int_equal(seen(&s, &towards, 0), 0);
    close_scene(&s);
  }
}

/* The eye within a box, within the root's corner, and on its border. */
static void eyes_within_boxes_and_corners(void** state)
{
  (void)state;
  for (int variant = 0; variant < VARIANTS; ++variant) {
    scene s;
    open_scene(&s, variant);
    static double boxes[500][6];
    static uint32_t ids[500];
    uint32_t random = 3;
    for (int i = 0; i < 500; ++i) {
      random_bounds(&random, 1.0, boxes[i]);
    }
    const double around[6] = { -9, 9, -9, 9, -9, 9 };
    memcpy(boxes[0], around, sizeof around);
    assert_int_equal(stratus_octree_insert(s.tree, boxes[0], 500, ids), STRATUS_OK);
    const double start[3] = { 0, 0, 0 }, ahead[3] = { 1, 0, 0 };
    stratus_frustum frustum = look(&s, start, ahead, 0.01, 1e3);
    (void)seen(&s, &frustum, 0);
    stratus_octree_statistics statistics;
    stratus_octree_get_statistics(s.tree, &statistics);
    for (int corner = 0; corner < 8; ++corner) {
      double eye[3], focal[3] = { 0.4, 0.4, 0.4 };
      for (int a = 0; a < 3; ++a) {
        eye[a] = statistics.root[2 * a + (corner >> a & 1)];
      }
      frustum = look(&s, eye, focal, 0.0, INFINITY);
      size_t right = 0;
      for (int i = 0; i < 500; ++i) {
        right += stratus_frustum_side(&frustum, boxes[i], 1) != STRATUS_SIDE_OUTSIDE;
      }
      assert_true(right > 400);
      assert_int_equal(seen(&s, &frustum, 1), right);
      /* And looking out of the root: only boxes around the eye are visible. */
      for (int a = 0; a < 3; ++a) {
        focal[a] = 2.0 * eye[a] - 0.4;
      }
      frustum = look(&s, eye, focal, 0.0, INFINITY);
      right = 0;
      for (int i = 0; i < 500; ++i) {
        right += stratus_frustum_side(&frustum, boxes[i], 1) != STRATUS_SIDE_OUTSIDE;
      }
      assert_int_equal(seen(&s, &frustum, 1), right);
    }
    close_scene(&s);
  }
}

/* A scene of 1e-6 and one of 1e8 in the same tree, a million million times apart, and 21 levels deep. */
static void tiny_and_huge_extents_down_to_the_last_level(void** state)
{
  (void)state;
  int deepest = 0;
  for (int variant = 0; variant < VARIANTS; ++variant) {
    scene s;
    open_scene(&s, variant);
    static double boxes[1200][6];
    static uint32_t ids[1200];
    uint32_t random = 5;
    for (int i = 0; i < 1200; ++i) {
      random_bounds(&random, i < 800 ? 1e-6 : 1e8, boxes[i]);
      for (int j = 0; j < 6 && i < 400; ++j) { /* a thousandth of that */
        boxes[i][j] *= 1e-3;
      }
    }
    assert_int_equal(stratus_octree_insert(s.tree, boxes[0], 1200, ids), STRATUS_OK);
    for (int frame = 0; frame < 12; ++frame) {
      const double scale = frame % 3 == 0 ? 1e8 : frame % 3 == 1 ? 1e-6 : 1e-9;
      const stratus_frustum frustum = random_frustum(s.context, &random, scale, NULL);
      const size_t count = seen(&s, &frustum, 1);
      size_t right = 0;
      for (int i = 0; i < 1200; ++i) {
        right += stratus_frustum_side(&frustum, boxes[i], 1) != STRATUS_SIDE_OUTSIDE;
      }
      assert_int_equal(count, right);
    }
    stratus_octree_statistics statistics;
    stratus_octree_get_statistics(s.tree, &statistics);
    assert_true(statistics.depth <= STRATUS_OCTREE_LEVELS_MAX);
    deepest = statistics.depth > deepest ? statistics.depth : deepest;
    close_scene(&s);
  }
  assert_int_equal(deepest, STRATUS_OCTREE_LEVELS_MAX);
}

/* Boxes and points on borders of cells, seen from where that border is the frustum's. */
static void objects_on_a_cell_s_border(void** state)
{
  (void)state;
  for (int variant = 0; variant < VARIANTS; ++variant) {
    scene s;
    open_scene(&s, variant);
    static double boxes[729][6];
    static uint32_t ids[729];
    for (int i = 0; i < 729; ++i) {
      const int at[3] = { i % 9, i / 9 % 9, i / 81 };
      for (int a = 0; a < 3; ++a) {
        boxes[i][2 * a] = at[a] - 4;
        boxes[i][2 * a + 1] = at[a] - 4 + i % 2;
      }
    }
    assert_int_equal(stratus_octree_insert(s.tree, boxes[0], 729, ids), STRATUS_OK);
    for (int x = -4; x <= 4; ++x) {
      const stratus_frustum frustum = { .planes = { { 1, 0, 0, -x }, { -1, 0, 0, x }, { 0, 1, 0, 4 }, { 0, -1, 0, 4 }, { 0, 0, 1, 4 },
                                          { 0, 0, -1, 4 } } };
      size_t right = 0;
      for (int i = 0; i < 729; ++i) {
        right += boxes[i][0] <= x && x <= boxes[i][1];
      }
      assert_true(right >= 81);
      assert_int_equal(seen(&s, &frustum, 1), right); /* a frustum without volume sees the boxes that touch its plane */
    }
    close_scene(&s);
  }
}

/* A box far out makes the root double, and one much further away makes a new one; all stay seen. */
static void a_root_that_grows_keeps_its_objects(void** state)
{
  (void)state;
  for (int variant = 0; variant < VARIANTS; ++variant) {
    scene s;
    open_scene(&s, variant);
    double boxes[200][6];
    uint32_t ids[200], random = 9, id;
    for (int i = 0; i < 200; ++i) {
      random_bounds(&random, 1.0, boxes[i]);
    }
    assert_int_equal(stratus_octree_insert(s.tree, boxes[0], 200, ids), STRATUS_OK);
    const double eye[3] = { -20, 0.3, 0.3 }, focal[3] = { 0, 0.3, 0.3 }, within[3] = { 0.3, 0.3, 0.3 };
    const stratus_frustum all = look(&s, eye, focal, 0.1, INFINITY), part = look(&s, within, focal, 1e-3, INFINITY);
    const size_t some = seen(&s, &part, 0);
    double far_away = 2.0;
    for (int i = 0; i < 60; ++i, far_away *= i < 50 ? 2.0 : 1e3) {
      const double box[6] = { -far_away, 1 - far_away, far_away, far_away, -far_away, -far_away };
      assert_int_equal(stratus_octree_insert(s.tree, box, 1, &id), STRATUS_OK);
      assert_int_equal(stratus_octree_check(s.tree), STRATUS_OK);
      assert_true(seen(&s, &part, 0) >= some);
      assert_true(seen(&s, &all, 0) >= 200);
      assert_int_equal(stratus_octree_remove(s.tree, &id, 1), STRATUS_OK);
    }
    assert_int_equal(seen(&s, &all, 1), 200);
    close_scene(&s);
  }
}

static void arguments_that_are_none_are_refused_with_the_value(void** state)
{
  (void)state;
  scene s;
  open_scene(&s, 0);
  const double box[6] = { 0, 1, 0, 1, 0, 1 }, falling[6] = { 0, 1, 2, 1, 0, 1 }, point[3] = { 0, 0, 0 }, bad[3] = { 0, NAN, 0 };
  uint32_t id, twice[2], nobody = 5;
  size_t count = 77;
  stratus_octree* none = NULL;
  stratus_octree_options options[9];
  for (int i = 0; i < 9; ++i) {
    options[i] = stratus_octree_options_default();
  }
  options[0].levels = 22, options[1].leaf_objects = 0, options[2].pixels = 0.0, options[3].c = NAN, options[4].looseness = 2.5;
  options[5].collapse_after = -1, options[6].split_budget = -1, options[7].placement = (stratus_octree_placement)2;
  options[8].stop = (stratus_octree_stop)4;
  for (int i = 0; i < 9; ++i) {
    assert_int_equal(stratus_octree_create(s.context, &options[i], &none), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(s.context), "octree "));
    assert_null(none);
  }
  assert_int_equal(stratus_octree_insert(s.tree, falling, 1, &id), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(s.context), "2..1 on axis 1"));
  assert_int_equal(stratus_octree_insert(s.tree, NULL, 1, &id), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_insert(NULL, box, 1, &id), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_insert(s.tree, box, 1, &id), STRATUS_OK);
  twice[0] = twice[1] = id;
  assert_int_equal(stratus_octree_remove(s.tree, twice, 2), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_remove(s.tree, &nobody, 1), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(s.context), "no object 5"));
  assert_int_equal(stratus_octree_move(s.tree, &nobody, box, 1), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_move(s.tree, &id, falling, 1), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_count(s.tree), 1);
  assert_int_equal(stratus_octree_query_sphere(s.tree, point, -1.0, &id, 1, &count), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_query_sphere(s.tree, bad, 1.0, &id, 1, &count), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_query_ray(s.tree, point, point, 1.0, &id, NULL, 1, &count), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_query_ray(s.tree, point, box, NAN, &id, NULL, 1, &count), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_query_box(s.tree, falling, &id, 1, &count), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_query_nearest(s.tree, bad, 1, &id, NULL, &count), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_query_nearest(s.tree, point, 1, NULL, NULL, &count), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(count, 77);
  stratus_frustum frustum = { 0 };
  frustum.planes[2][3] = INFINITY;
  assert_int_equal(stratus_octree_cull(s.view, &frustum, NULL, &s.visible), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_cull(s.view, NULL, NULL, &s.visible), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_octree_cull(NULL, &frustum, NULL, &s.visible), STRATUS_INVALID_ARGUMENT);
  frustum.planes[2][3] = -1.0; /* lets nothing through */
  assert_int_equal(seen(&s, &frustum, 0), 0);
  stratus_octree_clear(s.tree);
  assert_int_equal(stratus_octree_count(s.tree), 0);
  close_scene(&s);
  stratus_octree_destroy(NULL);
  stratus_octree_view_destroy(NULL);
}

/* One life of a scene: insertions, culls, moves, growth and queries. *sum depends on all that was seen. */
static stratus_status live(stratus_context* context, int variant, const double* boxes, size_t count, uint64_t* sum)
{
  const stratus_octree_options options = small_leaves(variant);
  stratus_octree* tree = NULL;
  stratus_octree_view* view = NULL;
  uint32_t ids[300], found[300];
  uint32_t random = 1;
  stratus_status status = STRATUS_OK;
  *sum = 0;
  TRY_CLEANUP(stratus_octree_create(context, &options, &tree));
  TRY_CLEANUP(stratus_octree_view_create(tree, &view));
  TRY_CLEANUP(stratus_octree_insert(tree, boxes, count, ids));
  const stratus_frustum frustum = random_frustum(context, &random, 1.0, NULL);
  for (int frame = 0; frame < 3; ++frame) {
    const stratus_octree_cull_options cull = { .exact = frame % 2, .coverage = 1 };
    stratus_octree_visible visible;
    TRY_CLEANUP(stratus_octree_cull(view, &frustum, &cull, &visible));
    *sum = *sum * 1000 + visible.count;
    const double away[6] = { 5.0 * frame, 5.0 * frame + 1.0, -5.0, -4.0, 9.0, 9.0 };
    TRY_CLEANUP(stratus_octree_move(tree, &ids[frame], away, 1));
    size_t n;
    const double point[3] = { 0.3, 0.3, 0.3 };
    TRY_CLEANUP(stratus_octree_query_nearest(tree, point, 20, found, NULL, &n));
    *sum = *sum * 1000 + found[n - 1];
  }
cleanup:
  if (tree && stratus_octree_count(tree) > 0) {
    const int64_t fail_at = ((faulty_allocator*)context->options.allocator_user)->fail_at;
    ((faulty_allocator*)context->options.allocator_user)->fail_at = 0;
    assert_true(stratus_octree_count(tree) == count);
    /* After a refused request every object is still at exactly one place. */
    if (stratus_octree_check(tree) != STRATUS_OK) {
      fail_msg("after request %lld: %s", (long long)fail_at, stratus_context_message(context));
    }
  }
  stratus_octree_view_destroy(view);
  stratus_octree_destroy(tree);
  return status;
}

static void memory_refused_at_any_request(void** state)
{
  (void)state;
  double boxes[300][6];
  uint32_t random = 4;
  for (int i = 0; i < 300; ++i) {
    random_bounds(&random, 1.0, boxes[i]);
  }
  for (int variant = 0; variant < VARIANTS; ++variant) {
    faulty_allocator allocator = { 0 };
    stratus_context_options options = faulty_options(&allocator, "host");
    stratus_context* context = NULL;
    options.threads = 1;
    assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
    const int64_t alive = allocator.live;
    uint64_t right, sum;
    assert_int_equal(live(context, variant, boxes[0], 300, &right), STRATUS_OK);
    int64_t n = 1;
    for (; n < REQUESTS_MAX; ++n) {
      allocator.fail_at = allocator.calls + n;
      const stratus_status status = live(context, variant, boxes[0], 300, &sum);
      const bool reached = allocator.fail_at == 0 || status != STRATUS_OK;
      allocator.fail_at = 0;
      assert_int_equal(allocator.live, alive);
      if (status == STRATUS_OK) {
        break;
      }
      assert_true(reached);
      assert_int_equal(status, STRATUS_OUT_OF_MEMORY);
    }
    assert_in_range(n, 50, REQUESTS_MAX - 1);
    assert_true(sum == right);
    stratus_context_destroy(context);
    assert_int_equal(allocator.live, 0);
  }
}

int test_octree_fails(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(no_object_and_one),
    cmocka_unit_test(all_at_one_place),
    cmocka_unit_test(bounds_of_no_size_infinite_or_not_a_number),
    cmocka_unit_test(eyes_within_boxes_and_corners),
    cmocka_unit_test(tiny_and_huge_extents_down_to_the_last_level),
    cmocka_unit_test(objects_on_a_cell_s_border),
    cmocka_unit_test(a_root_that_grows_keeps_its_objects),
    cmocka_unit_test(arguments_that_are_none_are_refused_with_the_value),
    cmocka_unit_test(memory_refused_at_any_request),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
