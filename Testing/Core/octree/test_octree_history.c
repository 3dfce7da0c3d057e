/* SPDX-License-Identifier: BSD-3-Clause
 * A million random insertions, moves and removals. After each thousand the octree sees and finds what a plain list of the same boxes does.
 * Also its queries, compared with loops. */
#include "octree_case.h"

#include "octree.h"

#define ROUNDS 1000
#define CHANGES 1000

/* The plain list: boxes by id, NULL where there is none. */
typedef struct mirror {
  double bounds[8192][6];
  uint8_t used[8192];
  uint32_t ids[8192]; /* in use */
  size_t count;
} mirror;

static void random_box(uint32_t* random, double bounds[6])
{
  random_bounds(random, 1.0, bounds);
  const int64_t odd = random_below(random, 200);
  for (int a = 0; a < 3; ++a) {
    if (odd == 0) { /* everywhere */
      bounds[2 * a] = -INFINITY;
      bounds[2 * a + 1] = a == 1 ? NAN : INFINITY;
    } else if (odd == 1) { /* a point */
      bounds[2 * a + 1] = bounds[2 * a];
    } else if (odd == 2) { /* far away: the root has to grow */
      bounds[2 * a] += 30.0;
      bounds[2 * a + 1] += 30.0;
    } else if (odd == 3) { /* on a cell's border, probably */
      bounds[2 * a] = bounds[2 * a + 1] = 0.25 * (double)random_below(random, 5);
    }
  }
}

static void change(stratus_octree* tree, mirror* m, uint32_t* random)
{
  double bounds[6];
  const int64_t kind = m->count < 100 ? 0 : m->count > 6000 ? 2 : random_below(random, 3);
  const size_t at = m->count ? (size_t)random_below(random, (int64_t)m->count) : 0;
  const uint32_t id = m->ids[at];
  random_box(random, bounds);
  if (kind == 0) {
    uint32_t fresh;
    assert_int_equal(stratus_octree_insert(tree, bounds, 1, &fresh), STRATUS_OK);
    assert_true(fresh < 8192 && !m->used[fresh]);
    m->used[fresh] = 1;
    m->ids[m->count++] = fresh;
    memcpy(m->bounds[fresh], bounds, sizeof bounds);
  } else if (kind == 1) {
    if (random_below(random, 2) && isfinite(m->bounds[id][0])) { /* a small step, most often within its node */
      memcpy(bounds, m->bounds[id], sizeof bounds);
      bounds[0] += 1e-4;
      bounds[1] += 1e-4;
    }
    assert_int_equal(stratus_octree_move(tree, &id, bounds, 1), STRATUS_OK);
    memcpy(m->bounds[id], bounds, sizeof bounds);
  } else {
    assert_int_equal(stratus_octree_remove(tree, &id, 1), STRATUS_OK);
    m->used[id] = 0;
    m->ids[at] = m->ids[--m->count];
  }
}

static void assert_shows(stratus_octree_view* view, const mirror* m, stratus_context* context, uint32_t* random, int touching)
{
  const stratus_frustum frustum = random_frustum(context, random, 1.0, NULL);
  const stratus_octree_cull_options options = { .exact = touching, .hold = random_below(random, 4) == 0 };
  stratus_octree_visible visible;
  assert_int_equal(stratus_octree_cull(view, &frustum, &options, &visible), STRATUS_OK);
  uint32_t* ids = sorted_ids(&visible);
  size_t next = 0;
  for (uint32_t id = 0; id < 8192; ++id) {
    const bool kept = next < visible.count && ids[next] == id;
    next += kept;
    const bool right = m->used[id] && stratus_frustum_side(&frustum, m->bounds[id], touching) != STRATUS_SIDE_OUTSIDE;
    assert_int_equal(kept, right);
  }
  assert_int_equal(next, visible.count);
  free(ids);
}

static void run_history(stratus_octree_options options, uint32_t seed, int rounds)
{
  static mirror m;
  memset(&m, 0, sizeof m);
  stratus_context* context = make_context("host", 1);
  stratus_octree* tree = NULL;
  stratus_octree_view* view = NULL;
  assert_int_equal(stratus_octree_create(context, &options, &tree), STRATUS_OK);
  assert_int_equal(stratus_octree_view_create(tree, &view), STRATUS_OK);
  for (int round = 0; round < rounds; ++round) {
    for (int i = 0; i < CHANGES; ++i) {
      change(tree, &m, &seed);
    }
    assert_int_equal(stratus_octree_count(tree), m.count);
    assert_shows(view, &m, context, &seed, options.placement == STRATUS_OCTREE_TOUCHING);
    if (round % 10 == 0 && stratus_octree_check(tree) != STRATUS_OK) {
      fail_msg("round %d: %s", round, stratus_context_message(context));
    }
  }
  stratus_octree_view_destroy(view);
  stratus_octree_destroy(tree);
  stratus_context_destroy(context);
}

static stratus_octree_options small_leaves(stratus_octree_placement placement, stratus_octree_stop stop)
{
  stratus_octree_options o = stratus_octree_options_default();
  o.placement = placement;
  o.stop = stop;
  o.leaf_objects = 8;
  o.collapse_after = 9;
  return o;
}

static void a_million_changes_of_an_enclosing_tree(void** state)
{
  (void)state;
  run_history(small_leaves(STRATUS_OCTREE_ENCLOSING, STRATUS_OCTREE_STOP_PIXELS), 1, ROUNDS);
}

static void changes_of_a_loose_tree_of_few_levels(void** state)
{
  (void)state;
  stratus_octree_options options = small_leaves(STRATUS_OCTREE_ENCLOSING, STRATUS_OCTREE_STOP_STATIC);
  options.looseness = 2.0;
  options.levels = 4;
  run_history(options, 2, ROUNDS / 10);
}

static void changes_of_a_touching_tree(void** state)
{
  (void)state;
  run_history(small_leaves(STRATUS_OCTREE_TOUCHING, STRATUS_OCTREE_STOP_MANHATTAN), 3, ROUNDS / 10);
}

/* ---- queries */

static double distance_of(const double bounds[6], const double point[3])
{
  double sum = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double away = fmax(fmax(bounds[2 * a] - point[a], point[a] - bounds[2 * a + 1]), 0.0);
    sum += away * away;
  }
  return sqrt(sum);
}

/* Liang and Barsky's method, interval by interval. */
static bool ray_meets(const double bounds[6], const double origin[3], const double direction[3], double t_max)
{
  long double from = 0.0L, to = t_max;
  for (int a = 0; a < 3; ++a) {
    const long double s = ((long double)bounds[2 * a] - origin[a]) / direction[a],
                      t = ((long double)bounds[2 * a + 1] - origin[a]) / direction[a];
    from = fmaxl(from, fminl(s, t));
    to = fminl(to, fmaxl(s, t));
  }
  return from <= to;
}

static void queries_find_what_loops_find(void** state)
{
  enum { COUNT = 5000 };
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (int placement = 0; placement < 2; ++placement) {
    stratus_octree_options options = small_leaves((stratus_octree_placement)placement, STRATUS_OCTREE_STOP_PIXELS);
    stratus_octree* tree = NULL;
    static double boxes[COUNT][6];
    static uint32_t ids[COUNT];
    static double values[COUNT];
    uint32_t random = 17;
    size_t found = 0;
    assert_int_equal(stratus_octree_create(context, &options, &tree), STRATUS_OK);
    for (int i = 0; i < COUNT; ++i) {
      random_bounds(&random, 1.0, boxes[i]);
      boxes[i][0] += 1e3; /* away from 0 */
      boxes[i][1] += 1e3;
    }
    assert_int_equal(stratus_octree_insert(tree, boxes[0], COUNT, ids), STRATUS_OK);
    for (int repeat = 0; repeat < 60; ++repeat) {
      double point[3], direction[3], bounds[6];
      size_t count = 0, right = 0;
      for (int a = 0; a < 3; ++a) {
        point[a] = 2.0 * random_unit(&random) - 0.5 + (a == 0 ? 1e3 : 0.0);
        direction[a] = random_unit(&random) - 0.5;
        bounds[2 * a] = point[a];
        bounds[2 * a + 1] = point[a] + 0.3 * random_unit(&random);
      }
      const double radius = 0.3 * random_unit(&random), t_max = repeat % 2 ? INFINITY : 1.0;
      assert_int_equal(stratus_octree_query_sphere(tree, point, radius, ids, COUNT, &count), STRATUS_OK);
      for (uint32_t i = 0; i < COUNT; ++i) {
        if (distance_of(boxes[i], point) <= radius) {
          assert_true(right < count && ids[right] == i);
          ++right;
        }
      }
      assert_int_equal(right, count);
      found += count;
      right = 0;
      assert_int_equal(stratus_octree_query_box(tree, bounds, ids, COUNT, &count), STRATUS_OK);
      for (uint32_t i = 0; i < COUNT; ++i) {
        if (boxes[i][0] <= bounds[1] && bounds[0] <= boxes[i][1] && boxes[i][2] <= bounds[3] && bounds[2] <= boxes[i][3] &&
          boxes[i][4] <= bounds[5] && bounds[4] <= boxes[i][5]) {
          assert_true(right < count && ids[right] == i);
          ++right;
        }
      }
      assert_int_equal(right, count);
      right = 0;
      assert_int_equal(stratus_octree_query_ray(tree, point, direction, t_max, ids, values, COUNT, &count), STRATUS_OK);
      for (uint32_t i = 0; i < COUNT; ++i) {
        right += ray_meets(boxes[i], point, direction, t_max);
      }
      assert_int_equal(right, count); /* no ray of these grazes an edge within rounding */
      for (size_t i = 0; i < count; ++i) {
        assert_true(ray_meets(boxes[ids[i]], point, direction, t_max));
        assert_true(i == 0 || values[i - 1] < values[i] || (values[i - 1] == values[i] && ids[i - 1] < ids[i]));
      }
      found += count;
      const size_t k = (size_t)random_below(&random, 40);
      assert_int_equal(stratus_octree_query_nearest(tree, point, k, ids, values, &count), STRATUS_OK);
      assert_int_equal(count, k);
      size_t nearer = 0;
      for (uint32_t i = 0; k > 0 && i < COUNT; ++i) {
        const double distance = distance_of(boxes[i], point);
        nearer += distance < values[k - 1] || (distance == values[k - 1] && i <= ids[k - 1]);
      }
      assert_int_equal(nearer, k);
      for (size_t i = 0; i < k; ++i) {
        assert_true(values[i] == distance_of(boxes[ids[i]], point));
        assert_true(i == 0 || values[i - 1] < values[i] || (values[i - 1] == values[i] && ids[i - 1] < ids[i]));
      }
    }
    assert_true(found > 1000);
    assert_int_equal(stratus_octree_check(tree), STRATUS_OK);
    stratus_octree_destroy(tree);
  }
  stratus_context_destroy(context);
}

/* A call that holds the tree neither splits nor merges a node, and sees what the next one sees, which splits them. */
static void held_trees_stay_as_they_are(void** state)
{
  enum { COUNT = 2000 };
  (void)state;
  stratus_context* context = make_context("host", 1);
  const stratus_octree_cull_options hold = { .hold = 1 };
  for (int stop = STRATUS_OCTREE_STOP_PIXELS; stop <= STRATUS_OCTREE_STOP_STATIC; ++stop) {
    const stratus_octree_options options = small_leaves(STRATUS_OCTREE_ENCLOSING, (stratus_octree_stop)stop);
    stratus_octree* tree = NULL;
    stratus_octree_view* view = NULL;
    double(*boxes)[6] = malloc(COUNT * sizeof *boxes);
    uint32_t *ids = malloc(COUNT * sizeof *ids), random = 3;
    for (int i = 0; i < COUNT; ++i) {
      random_bounds(&random, 1.0, boxes[i]);
    }
    assert_int_equal(stratus_octree_create(context, &options, &tree), STRATUS_OK);
    assert_int_equal(stratus_octree_view_create(tree, &view), STRATUS_OK);
    assert_int_equal(stratus_octree_insert(tree, boxes[0], COUNT, ids), STRATUS_OK);
    uint64_t splits = 0;
    for (int frame = 0; frame < 40; ++frame) {
      const stratus_frustum frustum = random_frustum(context, &random, 1.0, NULL);
      stratus_octree_visible held, free_to_split;
      stratus_octree_statistics before, after;
      stratus_octree_get_statistics(tree, &before);
      assert_int_equal(stratus_octree_cull(view, &frustum, &hold, &held), STRATUS_OK);
      stratus_octree_get_statistics(tree, &after);
      assert_int_equal(held.splits + held.collapses + held.objects_handed_down, 0);
      assert_memory_equal(&before, &after, sizeof before);
      uint32_t* seen = sorted_ids(&held);
      const size_t count = held.count;
      assert_int_equal(stratus_octree_cull(view, &frustum, NULL, &free_to_split), STRATUS_OK);
      assert_int_equal(free_to_split.count, count);
      uint32_t* expected = sorted_ids(&free_to_split);
      assert_memory_equal(seen, expected, count * sizeof *seen);
      splits += free_to_split.splits;
      free(seen);
      free(expected);
    }
    assert_true(splits > 8);
    assert_int_equal(stratus_octree_check(tree), STRATUS_OK);
    stratus_octree_view_destroy(view);
    stratus_octree_destroy(tree);
    free(boxes);
    free(ids);
  }
  stratus_context_destroy(context);
}

int test_octree_history(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_million_changes_of_an_enclosing_tree),
    cmocka_unit_test(changes_of_a_loose_tree_of_few_levels),
    cmocka_unit_test(changes_of_a_touching_tree),
    cmocka_unit_test(queries_find_what_loops_find),
    cmocka_unit_test(held_trees_stay_as_they_are),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
