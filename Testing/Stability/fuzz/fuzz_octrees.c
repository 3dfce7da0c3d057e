/* SPDX-License-Identifier: BSD-3-Clause
 * Octrees of objects: a history of insertions, moves, removals, culls and queries, compared with a linear list of the same history. */
#include "stratus.h"
#include "octree.h"

#include "fuzz.h"

#include <stdlib.h>

#define OBJECTS_MOST 300
#define AT_ONCE 40

typedef struct pair {
  stratus_octree *tree, *list;
  stratus_octree_view *view, *list_view;
  stratus_octree_options options;
  uint32_t ids[OBJECTS_MOST], list_ids[OBJECTS_MOST]; /* of each object */
  double bounds[OBJECTS_MOST][6];
  bool turned[OBJECTS_MOST];
  size_t count;
  double width;
} pair;

static stratus_octree_options choose_options(fuzz* f)
{
  stratus_octree_options o = CALL(stratus_octree_options_default());
  o.placement = (stratus_octree_placement)(fuzz_chance(f, 0.7) ? 0 : fuzz_choice(f, 2));
  o.stop = (stratus_octree_stop)fuzz_choice(f, STRATUS_OCTREE_STOP_STATIC + 1);
  o.levels = fuzz_chance(f, 0.1) ? 0 : fuzz_integer(f, 1, fuzz_chance(f, 0.5) ? STRATUS_OCTREE_LEVELS_MAX : 5);
  /* A static tree has 8^levels nodes, whatever is seen. */
  o.levels = o.stop == STRATUS_OCTREE_STOP_STATIC && o.levels > 4 ? 4 : o.levels;
  o.leaf_objects = fuzz_chance(f, 0.5) ? fuzz_integer(f, 1, 8) : fuzz_integer(f, 1, 256);
  o.pixels = fuzz_chance(f, 0.5) ? fuzz_real(f, 1.0, 64.0) : o.pixels;
  o.c = fuzz_chance(f, 0.5) ? fuzz_real(f, 1.0, 100.0) : o.c;
  o.looseness = fuzz_real(f, 1.0, 2.0);
  o.collapse_after = fuzz_integer(f, 0, 4);
  o.split_budget = fuzz_chance(f, 0.5) ? 0 : fuzz_odd(f) ? fuzz_odd_integer(f) : (int64_t)fuzz_below(f, 100);
  return o;
}

static void choose_box(fuzz* f, const pair* p, bool turned, double* box)
{
  const double size = p->width * (fuzz_chance(f, 0.1) ? fuzz_unit(f) : 0.1 * fuzz_unit(f) * fuzz_unit(f));
  for (int axis = 0; axis < 3; ++axis) {
    const double at = fuzz_between(f, -p->width, p->width);
    if (turned) {
      box[axis] = fuzz_odd(f) ? fuzz_odd_real(f) : at;
      for (int edge = 1; edge < 4; ++edge) {
        box[3 * edge + axis] = fuzz_odd(f) ? fuzz_odd_real(f) : size * fuzz_between(f, -1.0, 1.0);
      }
    } else {
      box[2 * axis] = fuzz_odd(f) ? fuzz_odd_real(f) : at;
      box[2 * axis + 1] = fuzz_odd(f) ? fuzz_odd_real(f) : at + size * fuzz_unit(f);
    }
  }
  if (!turned && fuzz_chance(f, 0.02)) {
    box[fuzz_below(f, 6)] = fuzz_chance(f, 0.5) ? NAN : fuzz_chance(f, 0.5) ? INFINITY : 2e30; /* no bounds */
    for (int axis = 0; axis < 3; ++axis) {
      box[2 * axis + 1] = box[2 * axis] > box[2 * axis + 1] ? INFINITY : box[2 * axis + 1];
    }
  }
}

/* ---- history */

static void insert(fuzz* f, pair* p)
{
  double boxes[12 * AT_ONCE];
  const bool turned = fuzz_chance(f, 0.25);
  const size_t numbers = turned ? 12 : 6, most = OBJECTS_MOST - p->count < AT_ONCE ? OBJECTS_MOST - p->count : AT_ONCE;
  size_t count = fuzz_below(f, most + 1);
  for (size_t i = 0; i < count; ++i) {
    choose_box(f, p, turned, boxes + numbers * i);
  }
  const double* given = fuzz_input(f, boxes, numbers * count * sizeof *boxes);
  uint32_t *ids = fuzz_output(f, count * sizeof *ids), *list_ids = fuzz_output(f, count * sizeof *ids);
  if (fuzz_chance(f, 0.05)) {
    fuzz_trouble(f);
  }
  stratus_status status =
    STATUS(turned ? stratus_octree_insert_oriented(p->tree, given, count, ids) : stratus_octree_insert(p->tree, given, count, ids));
  const bool troubled = f->memory.refused + f->progress.cancelled > 0;
  fuzz_calm(f);
  EXPECT(status == STRATUS_OK || troubled || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
  EXPECT(CALL(stratus_octree_count(p->tree)) == p->count + (status == STRATUS_OK ? count : 0), "%s, but %zu objects after %zu and %zu",
    stratus_status_name(status), stratus_octree_count(p->tree), p->count, count);
  if (status != STRATUS_OK) {
    return;
  }
  status = STATUS(
    turned ? stratus_octree_insert_oriented(p->list, given, count, list_ids) : stratus_octree_insert(p->list, given, count, list_ids));
  EXPECT(status == STRATUS_OK, "the list refuses what the tree took: %s", stratus_context_message(f->context));
  for (size_t i = 0; i < count; ++i) {
    p->ids[p->count] = ids[i];
    p->list_ids[p->count] = list_ids[i];
    p->turned[p->count] = turned;
    memcpy(p->bounds[p->count++], turned ? p->bounds[0] : given + 6 * i, 6 * sizeof(double));
    EXPECT(ids[i] < CALL(stratus_octree_id_limit(p->tree)), "id %u is not below the limit", ids[i]);
  }
}

/* Chooses some of the objects, each at most once; which[] holds their places. */
static size_t choose_objects(fuzz* f, const pair* p, size_t which[AT_ONCE])
{
  size_t count = 0;
  const uint64_t share = 1 + fuzz_below(f, 12);
  for (size_t i = 0; i < p->count && count < AT_ONCE; ++i) {
    if (fuzz_below(f, share) == 0) {
      which[count++] = i;
    }
  }
  return count;
}

static void move(fuzz* f, pair* p)
{
  size_t which[AT_ONCE];
  double boxes[12 * AT_ONCE];
  uint32_t ids[AT_ONCE], list_ids[AT_ONCE];
  const size_t count = choose_objects(f, p, which);
  const bool turned = fuzz_chance(f, 0.25);
  const size_t numbers = turned ? 12 : 6;
  bool spoilt = false;
  for (size_t i = 0; i < count; ++i) {
    choose_box(f, p, turned, boxes + numbers * i);
    ids[i] = p->ids[which[i]];
    list_ids[i] = p->list_ids[which[i]];
    if (fuzz_odd(f)) {
      ids[i] = list_ids[i] = (uint32_t)fuzz_odd_integer(f) | 0x80000000u;
      spoilt = true;
    }
  }
  const double* given = fuzz_input(f, boxes, numbers * count * sizeof *boxes);
  const uint32_t *names = fuzz_input(f, ids, count * sizeof *ids), *list_names = fuzz_input(f, list_ids, count * sizeof *ids);
  const stratus_status status =
    STATUS(turned ? stratus_octree_move_oriented(p->tree, names, given, count) : stratus_octree_move(p->tree, names, given, count));
  EXPECT(status == STRATUS_OK || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
  EXPECT(status != STRATUS_OK || !spoilt, "an id not in use was moved");
  const stratus_status listed = STATUS(
    turned ? stratus_octree_move_oriented(p->list, list_names, given, count) : stratus_octree_move(p->list, list_names, given, count));
  EXPECT(status == listed, "moves: %s, in the list %s", stratus_status_name(status), stratus_status_name(listed));
  for (size_t i = 0; status == STRATUS_OK && i < count; ++i) {
    p->turned[which[i]] = turned;
    memcpy(p->bounds[which[i]], turned ? p->bounds[which[i]] : given + 6 * i, 6 * sizeof(double));
  }
}

static void take_away(fuzz* f, pair* p)
{
  size_t which[AT_ONCE];
  uint32_t ids[AT_ONCE + 1], list_ids[AT_ONCE + 1];
  size_t count = choose_objects(f, p, which);
  for (size_t i = 0; i < count; ++i) {
    ids[i] = p->ids[which[i]];
    list_ids[i] = p->list_ids[which[i]];
  }
  const bool twice = count > 0 && fuzz_chance(f, 0.05);
  ids[count] = ids[0];
  list_ids[count] = list_ids[0];
  const size_t given = count + (twice ? 1 : 0);
  const stratus_status status = STATUS(stratus_octree_remove(p->tree, fuzz_input(f, ids, given * sizeof *ids), given));
  const stratus_status listed = STATUS(stratus_octree_remove(p->list, fuzz_input(f, list_ids, given * sizeof *ids), given));
  EXPECT(status == listed && (status == STRATUS_OK) == !twice, "removes: %s, in the list %s", stratus_status_name(status),
    stratus_status_name(listed));
  for (size_t i = count; status == STRATUS_OK && i-- > 0;) {
    const size_t at = which[i], last = --p->count;
    p->ids[at] = p->ids[last];
    p->list_ids[at] = p->list_ids[last];
    p->turned[at] = p->turned[last];
    memcpy(p->bounds[at], p->bounds[last], sizeof p->bounds[at]);
  }
}

/* ---- answers */

/* Sets a byte for each object that a list of ids names. Each may be named once. */
static void mark(fuzz* f, const uint32_t* of, size_t objects, const uint32_t* ids, size_t count, uint8_t marks[OBJECTS_MOST])
{
  memset(marks, 0, OBJECTS_MOST);
  for (size_t n = 0; n < count; ++n) {
    size_t at = 0;
    while (at < objects && of[at] != ids[n]) {
      ++at;
    }
    EXPECT(at < objects && !marks[at], "id %u is listed, %s", ids[n], at < objects ? "twice" : "and is no object's");
    marks[at] = 1;
  }
}

static void check_equal(
  fuzz* f, const pair* p, const uint32_t* ids, size_t count, const uint32_t* list_ids, size_t list_count, const char* what)
{
  uint8_t marks[OBJECTS_MOST], list_marks[OBJECTS_MOST];
  mark(f, p->ids, p->count, ids, count, marks);
  mark(f, p->list_ids, p->count, list_ids, list_count, list_marks);
  for (size_t i = 0; i < p->count; ++i) {
    EXPECT(marks[i] == list_marks[i], "%s: object %zu is %d, by the list %d", what, i, marks[i], list_marks[i]);
  }
  ++f->tally->compared;
}

static void cull(fuzz* f, pair* p)
{
  const double bounds[6] = { -p->width, p->width, -p->width, p->width, -p->width, p->width };
  stratus_octree_cull_options o = { .exact = fuzz_flag(f), .coverage = fuzz_flag(f) };
  stratus_octree_visible seen, listed;
  stratus_frustum frustum;
  const stratus_camera camera = fuzz_camera(f, bounds);
  if (STATUS(stratus_frustum_from_camera(f->context, FUZZ_INPUT(f, camera), &frustum)) != STRATUS_OK) {
    return;
  }
  for (int plane = 0; plane < 6; ++plane) {
    for (int i = 0; i < 4; ++i) {
      frustum.planes[plane][i] = fuzz_odd(f) ? fuzz_odd_real(f) : frustum.planes[plane][i];
    }
  }
  const stratus_frustum* given = FUZZ_INPUT(f, frustum);
  (void)STATUS(stratus_frustum_check(f->context, given));
  const stratus_octree_cull_options* options = fuzz_chance(f, 0.2) ? NULL : FUZZ_INPUT(f, o);
  o = options ? o : (stratus_octree_cull_options){ 0 };
  if (fuzz_chance(f, 0.1)) {
    fuzz_trouble(f);
  }
  const stratus_status status = STATUS(stratus_octree_cull(p->view, given, options, &seen));
  const bool troubled = f->memory.refused + f->progress.cancelled > 0;
  fuzz_calm(f);
  EXPECT(status == STRATUS_OK || troubled || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
  if (status != STRATUS_OK) {
    return;
  }
  for (size_t i = 0; o.coverage && i < seen.count; ++i) {
    EXPECT(seen.coverage[i] >= 0.0f && seen.coverage[i] <= 1.0f && !isnan(seen.depth[i]), "coverage %g, depth %g", (double)seen.coverage[i],
      (double)seen.depth[i]);
  }
  EXPECT(STATUS(stratus_octree_cull(p->list_view, given, options, &listed)) == STRATUS_OK, "the list is not culled");
  if (p->options.placement == STRATUS_OCTREE_ENCLOSING || o.exact || p->options.levels == 0) {
    check_equal(f, p, seen.ids, seen.count, listed.ids, listed.count, "culled");
  }
}

static void choose_query(fuzz* f, const pair* p, double point[3], double direction[3], double bounds[6])
{
  fuzz_vector(f, -p->width, p->width, point);
  fuzz_vector(f, -1.0, 1.0, direction);
  for (int axis = 0; axis < 3; ++axis) {
    bounds[2 * axis] = fuzz_real(f, -p->width, p->width);
    bounds[2 * axis + 1] = fuzz_odd(f) ? fuzz_odd_real(f) : bounds[2 * axis] + p->width * fuzz_unit(f);
  }
}

static void query(fuzz* f, pair* p)
{
  const size_t capacity = fuzz_chance(f, 0.7) ? OBJECTS_MOST : fuzz_below(f, 5);
  uint32_t *ids = fuzz_output(f, capacity * sizeof *ids), *list_ids = fuzz_output(f, OBJECTS_MOST * sizeof *ids);
  double *t = fuzz_output(f, capacity * sizeof *t), *list_t = fuzz_output(f, OBJECTS_MOST * sizeof *t);
  double point[3], direction[3], bounds[6];
  size_t count = 12345, listed = 12345, all = OBJECTS_MOST;
  const int kind = (int)fuzz_below(f, 4);
  choose_query(f, p, point, direction, bounds);
  const double *at = FUZZ_INPUT(f, point), *along = FUZZ_INPUT(f, direction), *box = FUZZ_INPUT(f, bounds);
  const double reach = fuzz_chance(f, 0.2) ? INFINITY : fuzz_real(f, 0.0, p->width), length = reach * 2.0;
  stratus_status status = STRATUS_OK, status_list = STRATUS_OK;
  if (kind == 0) {
    status = STATUS(stratus_octree_query_box(p->tree, box, ids, capacity, &count));
    status_list = STATUS(stratus_octree_query_box(p->list, box, list_ids, all, &listed));
  } else if (kind == 1) {
    status = STATUS(stratus_octree_query_sphere(p->tree, at, reach, ids, capacity, &count));
    status_list = STATUS(stratus_octree_query_sphere(p->list, at, reach, list_ids, all, &listed));
  } else if (kind == 2) {
    status = STATUS(stratus_octree_query_ray(p->tree, at, along, length, ids, fuzz_chance(f, 0.5) ? t : NULL, capacity, &count));
    status_list = STATUS(stratus_octree_query_ray(p->list, at, along, length, list_ids, list_t, all, &listed));
  } else {
    all = capacity;
    status = STATUS(stratus_octree_query_nearest(p->tree, at, capacity, ids, t, &count));
    status_list = STATUS(stratus_octree_query_nearest(p->list, at, capacity, list_ids, list_t, &listed));
  }
  EXPECT(status == status_list, "query %d: %s, in the list %s", kind, stratus_status_name(status), stratus_status_name(status_list));
  if (status != STRATUS_OK) {
    EXPECT(!fuzz_is_tame(f), "%s", stratus_context_message(f->context));
    EXPECT(count == 12345, "refused, but the count was written");
    return;
  }
  EXPECT(count == listed, "query %d finds %zu, the list %zu", kind, count, listed);
  if (kind < 3 && count <= capacity) {
    check_equal(f, p, ids, count, list_ids, listed, "query");
  }
  for (size_t i = 0; kind == 3 && i < count; ++i) {
    EXPECT(t[i] == list_t[i] && (i == 0 || t[i] >= t[i - 1]), "nearest %zu at %.17g, by the list %.17g", i, t[i], list_t[i]);
  }
}

static void look_inside(fuzz* f, const pair* p)
{
  stratus_octree_statistics* s = fuzz_output(f, sizeof *s);
  EXPECT(STATUS(stratus_octree_check(p->tree)) == STRATUS_OK, "%s", stratus_context_message(f->context));
  CALL(stratus_octree_get_statistics(p->tree, s));
  EXPECT(s->objects == p->count && CALL(stratus_octree_count(p->tree)) == p->count, "%zu objects, got %zu", p->count, s->objects);
  stratus_octree_node* nodes = fuzz_output(f, s->nodes * sizeof *nodes);
  stratus_frustum frustum = { .planes = { { 1, 0, 0, 0.5 * p->width }, { -1, 0.3, 0, p->width } }, .eye = { 0, 0, p->width } };
  const stratus_frustum* seen = fuzz_chance(f, 0.5) ? NULL : FUZZ_INPUT(f, frustum);
  EXPECT(STATUS(stratus_octree_nodes(p->tree, seen, nodes)) == STRATUS_OK, "%s", stratus_context_message(f->context));
  for (size_t n = 0; n < s->nodes; ++n) {
    EXPECT(nodes[n].level >= 0 && nodes[n].level <= s->depth && (unsigned)nodes[n].side <= STRATUS_SIDE_INSIDE, "node %zu at level %d", n,
      nodes[n].level);
  }
  double none[6];
  EXPECT(STATUS(stratus_octree_bounds(p->tree, (uint32_t)stratus_octree_id_limit(p->tree) + (uint32_t)fuzz_below(f, 9), none)) ==
      STRATUS_INVALID_ARGUMENT,
    "bounds of an id not in use");
  for (size_t i = 0; i < p->count; ++i) {
    double bounds[6];
    EXPECT(STATUS(stratus_octree_bounds(p->tree, p->ids[i], bounds)) == STRATUS_OK, "object %zu has no bounds", i);
    EXPECT(p->turned[i] || memcmp(bounds, p->bounds[i], sizeof bounds) == 0, "object %zu has other bounds than it was given", i);
  }
}

static void live(fuzz* f, pair* p)
{
  const uint64_t steps = 1 + fuzz_below(f, 24);
  for (uint64_t s = 0; s < steps; ++s) {
    const uint64_t what = s == 0 ? 0 : fuzz_below(f, 12);
    if (what < 2) {
      insert(f, p);
    } else if (what < 4) {
      move(f, p);
    } else if (what == 4) {
      take_away(f, p);
    } else if (what < 8) {
      cull(f, p);
    } else if (what < 11) {
      query(f, p);
    } else if (fuzz_chance(f, 0.05)) {
      CALL(stratus_octree_clear(p->tree));
      CALL(stratus_octree_clear(p->list));
      p->count = 0;
    } else {
      look_inside(f, p);
    }
  }
  look_inside(f, p);
}

void fuzz_octrees(fuzz* f)
{
  pair* p = calloc(1, sizeof *p);
  p->options = choose_options(f);
  p->width = fuzz_chance(f, 0.8) ? 100.0 : fuzz_scale(f, 1e-6, 1e9);
  const stratus_octree_options* options = FUZZ_INPUT(f, p->options);
  fuzz_about(f, "placement %d, stop %d, levels %d, leaves of %d, looseness %g", (int)p->options.placement, (int)p->options.stop,
    p->options.levels, p->options.leaf_objects, p->options.looseness);
  const stratus_status status = CREATE(&p->tree, stratus_octree_create(f->context, options, &p->tree));
  EXPECT(status == STRATUS_OK || !fuzz_is_tame(f), "%s", stratus_context_message(f->context));
  if (status == STRATUS_OK) {
    stratus_octree_options linear = stratus_octree_options_default();
    linear.levels = 0;
    EXPECT(CREATE(&p->list, stratus_octree_create(f->context, &linear, &p->list)) == STRATUS_OK, "no list");
    EXPECT(CREATE(&p->view, stratus_octree_view_create(p->tree, &p->view)) == STRATUS_OK, "no view");
    EXPECT(CREATE(&p->list_view, stratus_octree_view_create(p->list, &p->list_view)) == STRATUS_OK, "no view");
    live(f, p);
  }
  CALL(stratus_octree_view_destroy(p->view));
  CALL(stratus_octree_view_destroy(p->list_view));
  CALL(stratus_octree_destroy(p->tree));
  CALL(stratus_octree_destroy(p->list));
  free(p);
}
