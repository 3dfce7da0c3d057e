/* SPDX-License-Identifier: BSD-3-Clause
 * 2,000 random meshes with inverted cells, slivers, seams, points that are there twice, gaps, hollows and hidden cells, each drawn by both
 * methods: each gives the reference's picture. Where cells overlap the order in which they count is free, so that meshes with inverted
 * cells have one colour, by which no order shows. */
#include "tetra_parts.h"
#include "testing.h"

#define ALL 2000
#define CLOSE 0.01 /* greatest RMSE of 255; the worst of all has .005 */

enum { INVERTED, SLIVERS, SEAMS, TWICE, REPEATED, HIDDEN, DEFECTS };

static const char* const defect_names[] = { "inverted", "slivers", "seams", "points twice", "points repeated", "hidden" };

static uint32_t below(uint32_t* random, uint32_t n)
{
  return (uint32_t)tetra_uniform(random, 0.0, (double)n - 1e-6);
}

/* Boxes of other divisions side by side, whose faces do not match, over one another's edges. */
static void build_seams(tetra_case* c, uint32_t* random)
{
  const int across[2] = { 1 + (int)below(random, 3), 1 + (int)below(random, 3) };
  const double middle = tetra_uniform(random, 0.8, 2.2);
  const double low[3] = { 0, 0, 0 }, offset[3] = { middle, tetra_uniform(random, -0.5, 0.5), 0 };
  const double size[3] = { middle, 3, 3 }, other[3] = { 3.0 - middle, 3, tetra_uniform(random, 2, 3) };
  tetra_clear(c, 2 * 64, 2 * 6 * 27);
  tetra_add_box(c, across[0], low, size);
  tetra_add_box(c, across[1], offset, other);
}

/* Gives some cells points of their own where others have the same. */
static void double_points(tetra_case* c, uint32_t* random)
{
  const int64_t points = c->mesh.point_count, most = points + 4 * c->mesh.cell_count;
  c->points = realloc(c->points, (size_t)most * 3 * sizeof *c->points);
  c->values = realloc(c->values, (size_t)most * sizeof *c->values);
  assert_true(c->points && c->values);
  for (int64_t v = 0; v < 4 * c->mesh.cell_count; ++v) {
    if (below(random, 5) == 0) {
      const int64_t from = c->vertices[v], to = c->mesh.point_count++;
      memcpy(c->points + 3 * to, c->points + 3 * from, 3 * sizeof *c->points);
      c->values[to] = c->values[from];
      c->vertices[v] = (int32_t)to;
    }
  }
  c->mesh.points = c->points;
  c->mesh.values = c->values;
}

/* Moves some points into, or almost into, the plane of others of a cell of theirs: by a millionth of it or by nothing. */
static void flatten(tetra_case* c, uint32_t* random)
{
  for (uint32_t i = 0; i < 3; ++i) {
    const int32_t* v = c->vertices + 4 * (int64_t)below(random, (uint32_t)c->mesh.cell_count);
    const double off = below(random, 2) ? 0.0 : tetra_uniform(random, -1e-6, 1e-6), share = tetra_uniform(random, 0.3, 0.7);
    for (int a = 0; a < 3; ++a) {
      c->points[3 * v[0] + a] = (1.0 - share) * c->points[3 * v[1] + a] + share * c->points[3 * v[2] + a] + off;
    }
  }
}

static void choose_camera(stratus_context* context, tetra_case* c, uint32_t* random)
{
  tetra_camera(context, c, 3, (int)below(random, 8), (int)below(random, 2));
  if (below(random, 4) == 0) { /* inside */
    for (int a = 0; a < 3; ++a) {
      c->camera.eye[a] = tetra_uniform(random, 0.2, 2.8);
    }
  } else if (below(random, 3) == 0) { /* a near and a far plane that cut */
    const double reach = 4.0;
    double middle = 0.0;
    for (int a = 0; a < 3; ++a) {
      middle += (1.5 - c->camera.eye[a]) * c->camera.forward[a];
    }
    c->camera.near_k = fmax(middle - tetra_uniform(random, 0.0, 0.5 * reach), 0.0);
    c->camera.far_k = c->camera.near_k + tetra_uniform(random, 0.5, reach);
  }
}

/* Makes a mesh with some of the defects; returns them as bits. */
static uint32_t build(stratus_context* context, tetra_case* c, uint32_t* random)
{
  const uint32_t defects = 1u << below(random, DEFECTS) | 1u << below(random, DEFECTS);
  const bool inverted = defects >> INVERTED & 1 || defects >> SLIVERS & 1; /* a point that moves may turn the cells about it */
  const double missing = below(random, 3) ? 0.0 : tetra_uniform(random, 0.05, 0.6);
  tetra_create(c, 1 + (int)below(random, 3), tetra_uniform(random, 0.0, inverted ? 0.7 : 0.12), missing, below(random, 1u << 20));
  if (defects >> SEAMS & 1) {
    build_seams(c, random);
  }
  if (c->mesh.cell_count == 0) {
    tetra_destroy(c);
    tetra_create(c, 2, 0.1, 0.0, 1);
  }
  if (defects >> SLIVERS & 1) {
    flatten(c, random);
  }
  if (defects >> TWICE & 1) {
    double_points(c, random);
  }
  if (defects >> REPEATED & 1) {
    for (int i = 0; i < 4; ++i) {
      int32_t* v = c->vertices + 4 * (int64_t)below(random, (uint32_t)c->mesh.cell_count);
      v[below(random, 4)] = v[below(random, 4)];
    }
  }
  if (defects >> HIDDEN & 1) {
    free(c->hidden);
    c->hidden = calloc((size_t)c->mesh.cell_count, 1);
    assert_non_null(c->hidden);
    for (int64_t i = 0; i < c->mesh.cell_count; ++i) {
      c->hidden[i] = below(random, 4) == 0;
    }
    c->mesh.hidden = c->hidden;
    c->values[below(random, (uint32_t)c->mesh.point_count)] = NAN;
  }
  for (int i = 0; inverted && i < 12; ++i) {
    c->color[i] = i & 3 ? 0.5 : c->color[i];
  }
  /* A sliver's largest value counts in full, however few digits its thickness has: only light falls with the thickness. */
  c->options.mode = below(random, 4) || defects >> SLIVERS & 1 ? STRATUS_TETRA_COMPOSITE : STRATUS_TETRA_MAXIMUM;
  c->options.tolerance = 0.0; /* the finest division of cells */
  c->transfer.unit_distance = pow(10.0, tetra_uniform(random, -1.0, 0.5));
  choose_camera(context, c, random);
  return defects;
}

static void both_methods_draw_the_reference(void** state)
{
  static tetra_picture picture;
  static double reference[4 * TETRA_PIXELS_MOST];
  int64_t inverted = 0, flat = 0, repeated = 0, shown = 0;
  double worst = 0.0;
  test_seeds seeds = test_seeds_of(TEST_SOME(ALL), ALL);
  while (test_next(&seeds)) {
    uint32_t random = seeds.seed * 2654435761u + 31u;
    tetra_case c;
    char what[128] = "";
    const uint32_t defects = build(*state, &c, &random);
    for (int d = 0; d < DEFECTS; ++d) {
      if (defects >> d & 1) {
        snprintf(what + strlen(what), sizeof what - strlen(what), " %s", defect_names[d]);
      }
    }
    tetra_reference(&c, reference, NULL);
    bool shows = false;
    for (int i = 0; i < TETRA_PIXELS; ++i) {
      shows = shows || reference[4 * i + 3] > 0.0;
    }
    for (tetra_method = STRATUS_TETRA_METHOD_MARCH; tetra_method <= STRATUS_TETRA_METHOD_PROJECT; ++tetra_method) {
      double largest;
      c.options.method = tetra_method;
      tetra_draw(*state, &c, &picture);
      const double error = tetra_error(picture.rgba, reference, &largest);
      worst = shows ? fmax(worst, error) : worst;
      if (!(error <= CLOSE) && (shows || isfinite(error))) { /* INFINITY: neither shows anything */
        fail_msg("%s, %s:%s: RMSE %.4f of 255, at most %g; largest %.3f", stratus_tetra_method_name(tetra_method),
          c.options.mode == STRATUS_TETRA_MAXIMUM ? "maximum" : "composite", what, error, CLOSE, largest);
      }
      assert_int_equal(picture.report.stuck, 0);
    }
    shown += shows;
    inverted += picture.report.inverted;
    flat += picture.report.flat;
    repeated += picture.report.repeated;
    tetra_destroy(&c);
  }
  print_message(
    "             %u meshes, %lld show something; %lld cells inverted, %lld flat, %lld name a point twice; worst RMSE %.4f of 255\n",
    seeds.end, (long long)shown, (long long)inverted, (long long)flat, (long long)repeated, worst);
  if (test_many(&seeds, 40)) {
    assert_true(shown > 3 * (int64_t)seeds.end / 4);
    assert_true(inverted > 0 && flat > 0 && repeated > 0);
  }
}

int test_random_meshes(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(both_methods_draw_the_reference),
  };
  return cmocka_run_group_tests(tests, tetra_start, tetra_stop);
}
