/* SPDX-License-Identifier: BSD-3-Clause
 * Random scenes of boxes, moved, removed and seen by random frusta: an octree of random options sees what a loop over all boxes
 * sees, and finds what the loop finds. */
#include "octree_case.h"
#include "octree.h"
#include "testing.h"

#define ALL 20000
#define OBJECTS_MOST 1500
#define FRAMES 12

typedef struct box_scene {
  double boxes[OBJECTS_MOST][6], scale, spread;
  uint32_t ids[OBJECTS_MOST];
  bool alive[OBJECTS_MOST];
  size_t count;
  stratus_octree *tree, *list; /* the list has no level below the root */
} box_scene;

/* A box of one of many kinds: of a cluster, flat, without size, equal to another, or around everything. */
static void choose_box(box_scene* s, uint32_t* random, double bounds[6])
{
  random_bounds(random, s->scale, bounds);
  const int64_t kind = random_below(random, 40);
  const int axis = (int)random_below(random, 3);
  if (kind == 0) {
    bounds[2 * axis + 1] = bounds[2 * axis];
  } else if (kind == 1) {
    bounds[1] = bounds[0];
    bounds[3] = bounds[2];
    bounds[5] = bounds[4];
  } else if (kind == 2 && s->count > 0) {
    memcpy(bounds, s->boxes[random_below(random, (int64_t)s->count)], 6 * sizeof *bounds);
  } else if (kind == 3 && random_below(random, 8) == 0) {
    for (int side = 0; side < 6; ++side) {
      bounds[side] = side % 2 ? 10.0 * s->scale : -10.0 * s->scale;
    }
  } else if (kind == 4) { /* far out */
    bounds[2 * axis] += 1e3 * s->scale;
    bounds[2 * axis + 1] += 1e3 * s->scale;
  }
  for (int side = 0; side < 6; ++side) {
    bounds[side] = s->spread == 0.0 ? bounds[side] : s->spread * round(bounds[side] / s->spread); /* faces that meet */
  }
}

static stratus_octree_options choose_tree(uint32_t* random)
{
  stratus_octree_options o = stratus_octree_options_default();
  o.stop = (stratus_octree_stop)random_below(random, STRATUS_OCTREE_STOP_STATIC + 1);
  o.placement = (stratus_octree_placement)random_below(random, 2);
  o.leaf_objects = 1 << random_below(random, 8);
  o.levels = 1 + (int)random_below(random, o.stop == STRATUS_OCTREE_STOP_STATIC ? 6 : STRATUS_OCTREE_LEVELS_MAX);
  o.looseness = 1.0 + random_unit(random);
  o.collapse_after = (int)random_below(random, 5);
  o.split_budget = random_below(random, 3) ? 0 : 1 + random_below(random, 500);
  o.pixels = 1.0 + 60.0 * random_unit(random);
  o.c = 1.0 + 70.0 * random_unit(random);
  return o;
}

/* Inserts, moves and removes some boxes in both. */
static void change(box_scene* s, uint32_t* random)
{
  for (int64_t i = random_below(random, 60); i > 0; --i) {
    const size_t at = (size_t)random_below(random, (int64_t)s->count);
    double bounds[6];
    uint32_t other;
    if (!s->alive[at]) {
      assert_int_equal(stratus_octree_insert(s->tree, s->boxes[at], 1, &s->ids[at]), STRATUS_OK);
      assert_int_equal(stratus_octree_insert(s->list, s->boxes[at], 1, &other), STRATUS_OK);
      assert_int_equal(other, s->ids[at]);
      s->alive[at] = true;
    } else if (random_below(random, 3) == 0) {
      assert_int_equal(stratus_octree_remove(s->tree, &s->ids[at], 1), STRATUS_OK);
      assert_int_equal(stratus_octree_remove(s->list, &s->ids[at], 1), STRATUS_OK);
      s->alive[at] = false;
    } else {
      choose_box(s, random, bounds);
      memcpy(s->boxes[at], bounds, sizeof bounds);
      assert_int_equal(stratus_octree_move(s->tree, &s->ids[at], s->boxes[at], 1), STRATUS_OK);
      assert_int_equal(stratus_octree_move(s->list, &s->ids[at], s->boxes[at], 1), STRATUS_OK);
    }
  }
}

/* Compares a frame with the list, and with clipped boxes: none that meets the frustum may be missing. Returns how many meet it. */
static size_t see(
  stratus_context* context, box_scene* s, stratus_octree_view* view, stratus_octree_view* all, bool enclosing, uint32_t* random)
{
  double inside[3];
  const stratus_frustum frustum = random_frustum(context, random, s->scale, inside);
  const stratus_octree_cull_options options = {
    .exact = (int)random_below(random, 2), .coverage = (int)random_below(random, 2), .hold = random_below(random, 4) == 0
  };
  stratus_octree_visible ours, theirs;
  bool shown[OBJECTS_MOST] = { false };
  size_t seen = 0;
  assert_int_equal(stratus_octree_cull(view, &frustum, &options, &ours), STRATUS_OK);
  assert_int_equal(stratus_octree_cull(all, &frustum, &options, &theirs), STRATUS_OK);
  if (enclosing || options.exact) {
    assert_same_visible(&ours, &theirs);
  }
  for (size_t i = 0; i < ours.count; ++i) {
    assert_true(ours.ids[i] < OBJECTS_MOST && !shown[ours.ids[i]]);
    shown[ours.ids[i]] = true;
  }
  for (size_t i = 0; i < s->count; ++i) {
    const bool meets = s->alive[i] && box_meets_frustum(&frustum, s->boxes[i], inside, 0.0);
    if (meets && !shown[s->ids[i]]) {
      fail_msg("box %zu is in sight, and was culled", i);
    }
    if (s->alive[i] && options.exact && shown[s->ids[i]] && !box_meets_frustum(&frustum, s->boxes[i], inside, 1e-6 * s->scale)) {
      fail_msg("box %zu is out of sight, and was kept", i);
    }
    seen += meets;
  }
  return seen;
}

/* Boxes that touch a box, from both. */
static void find(box_scene* s, uint32_t* random)
{
  uint32_t found[OBJECTS_MOST];
  double bounds[6];
  size_t count, expected = 0;
  random_bounds(random, s->scale, bounds);
  assert_int_equal(stratus_octree_query_box(s->tree, bounds, found, OBJECTS_MOST, &count), STRATUS_OK);
  bool touched[OBJECTS_MOST] = { false };
  for (size_t i = 0; i < count; ++i) {
    touched[found[i]] = true;
  }
  for (size_t i = 0; i < s->count; ++i) {
    bool touches = s->alive[i];
    for (int a = 0; a < 3; ++a) {
      touches = touches && s->boxes[i][2 * a] <= bounds[2 * a + 1] && bounds[2 * a] <= s->boxes[i][2 * a + 1];
    }
    expected += touches;
    assert_true(!touches || touched[s->ids[i]]);
  }
  assert_int_equal(count, expected);
}

static void octrees_see_what_a_list_sees(void** state)
{
  static const double scales[] = { 1.0, 1e-6, 1e8, 1e-20, 1e20 };
  static box_scene s;
  (void)state;
  stratus_context* contexts[2] = { make_context("host", 1), make_context("host", 2) };
  size_t seen = 0;
  test_seeds seeds = test_seeds_of(TEST_SOME(ALL), ALL);
  while (test_next(&seeds)) {
    uint32_t random = seeds.seed * 2654435761u + 7u;
    stratus_context* context = contexts[seeds.seed % 2];
    stratus_octree_options options = choose_tree(&random), list = stratus_octree_options_default();
    memset(&s, 0, sizeof s);
    s.scale = scales[random_below(&random, 5)];
    s.spread = random_below(&random, 3) ? 0.0 : 0.125 * s.scale;
    const size_t count = 1 + (size_t)random_below(&random, random_below(&random, 4) ? 300 : OBJECTS_MOST);
    for (s.count = 0; s.count < count; ++s.count) {
      choose_box(&s, &random, s.boxes[s.count]);
      s.alive[s.count] = true;
    }
    list.levels = 0;
    assert_int_equal(stratus_octree_create(context, &options, &s.tree), STRATUS_OK);
    assert_int_equal(stratus_octree_create(context, &list, &s.list), STRATUS_OK);
    assert_int_equal(stratus_octree_insert(s.list, s.boxes[0], s.count, s.ids), STRATUS_OK);
    assert_int_equal(stratus_octree_insert(s.tree, s.boxes[0], s.count, s.ids), STRATUS_OK);
    stratus_octree_view *view = NULL, *all = NULL;
    assert_int_equal(stratus_octree_view_create(s.tree, &view), STRATUS_OK);
    assert_int_equal(stratus_octree_view_create(s.list, &all), STRATUS_OK);
    for (int frame = 0; frame < FRAMES; ++frame) {
      seen += see(context, &s, view, all, options.placement == STRATUS_OCTREE_ENCLOSING, &random);
      find(&s, &random);
      if (frame % 3 == 2) {
        change(&s, &random);
      }
    }
    assert_int_equal(stratus_octree_check(s.tree), STRATUS_OK);
    stratus_octree_view_destroy(view);
    stratus_octree_view_destroy(all);
    stratus_octree_destroy(s.tree);
    stratus_octree_destroy(s.list);
  }
  print_message("             %u scenes, %zu boxes in sight\n", seeds.end, seen);
  assert_true(!test_many(&seeds, 100) || seen > 100 * (size_t)seeds.end);
  stratus_context_destroy(contexts[0]);
  stratus_context_destroy(contexts[1]);
}

int test_random_boxes(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(octrees_see_what_a_list_sees),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
