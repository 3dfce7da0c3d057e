/* SPDX-License-Identifier: BSD-3-Clause
 * Projection of tetrahedra, compared with the march and the double-precision reference: where no order of cells is right, with leaves,
 * behind opaque objects. Also the choice between the two methods. test_tetra_march*.c, which run once with each method, test what both must
 * do alike. */
#include "tetra_case.h"
#include "tetra_costs.h"
#include "testing.h"

/* Half of the bar of record for functions with peaks, since these functions are smoother. */
#define RMSE_MOST 0.025
/* Difference of the methods that the contract allows. */
#define DIFFERENCE_MOST 0.01

static tetra_picture marched, projected;
static double reference[4 * TETRA_PIXELS_MOST];

static double difference(void)
{
  double squares = 0.0;
  for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
    const double d = 255.0 * ((double)marched.rgba[i] - (double)projected.rgba[i]);
    squares += d * d;
  }
  return sqrt(squares / (4.0 * TETRA_PIXELS));
}

static void draw_both(stratus_context* context, tetra_case* c)
{
  tetra_method = c->options.method = STRATUS_TETRA_METHOD_MARCH;
  tetra_draw(context, c, &marched);
  tetra_method = c->options.method = STRATUS_TETRA_METHOD_PROJECT;
  tetra_draw(context, c, &projected);
  assert_true(marched.report.rays > TETRA_PIXELS / 10);
}

static void agrees(const tetra_case* c, const char* what)
{
  double largest;
  tetra_reference(c, reference, NULL);
  const double error = tetra_error(projected.rgba, reference, &largest), apart = difference();
  if (!(error <= RMSE_MOST) || !(apart <= DIFFERENCE_MOST)) {
    print_error("%s: RMSE %.4f of 255, at most %g; largest %.3f; from the march %.4f\n", what, error, RMSE_MOST, largest, apart);
  }
  assert_true(error <= RMSE_MOST && apart <= DIFFERENCE_MOST);
}

/* The march passes cells where the projection composites pieces. Their numbers agree where everything shows and no ray ends early. */
static void pieces_are_the_march_s_segments(void** state)
{
  for (uint32_t seed = 0; seed < 4; ++seed) {
    tetra_case c;
    tetra_create(&c, 4, 0.2, 0.3, seed);
    c.opacity[1] = c.opacity[3] = 0.1;
    tetra_camera(*state, &c, 4, (int)seed, seed & 1);
    draw_both(*state, &c);
    agrees(&c, "segments");
    assert_int_equal(marched.report.method, STRATUS_TETRA_METHOD_MARCH);
    /* a ray along an edge may find a piece without length in one way, and none in the other */
    const double passed = (double)marched.report.segments, composited = (double)projected.report.segments;
    assert_true(fabs(passed - composited) <= 1e-3 * passed);
    tetra_destroy(&c);
  }
}

/* A random direction, and two at right angles to it. */
static void random_axes(uint32_t* s, double axes[3][3])
{
  double length = 0.0;
  while (length < 0.01) {
    length = 0.0;
    for (int i = 0; i < 3; ++i) {
      axes[0][i] = tetra_uniform(s, -1, 1);
      length += axes[0][i] * axes[0][i];
    }
  }
  const double x = fabs(axes[0][0]), y = fabs(axes[0][1]), z = fabs(axes[0][2]);
  const int least = x < y ? (x < z ? 0 : 2) : (y < z ? 1 : 2);
  double square = 0.0;
  for (int i = 0; i < 3; ++i) {
    axes[0][i] /= sqrt(length);
  }
  for (int i = 0; i < 3; ++i) {
    axes[1][i] = (i == least) - axes[0][least] * axes[0][i];
    square += axes[1][i] * axes[1][i];
  }
  for (int i = 0; i < 3; ++i) {
    axes[1][i] /= sqrt(square);
  }
  for (int i = 0; i < 3; ++i) {
    axes[2][i] = axes[0][(i + 1) % 3] * axes[1][(i + 2) % 3] - axes[0][(i + 2) % 3] * axes[1][(i + 1) % 3];
  }
}

/* Random camera, from inside, near or far away, with right and up at any angle with each other and with forward, which has any length.
 * Parallel window planes lean by thousands of the mesh's widths, perspective ones by up to 60 degrees: beyond that, depths are too close
 * for floats. Some cameras cut the mesh by a near plane, a far plane, or both and opaque objects between them. */
static void look_at_random(tetra_case* c, int n, int parallel, uint32_t seed)
{
  static float opaque[TETRA_PIXELS_MOST];
  uint32_t s = seed * 48271u + 11u;
  double axes[3][3];
  stratus_camera* k = &c->camera;
  random_axes(&s, axes);
  const double distance = exp(tetra_uniform(&s, parallel ? 0.0 : -2.0, log(1e5))), length = exp(tetra_uniform(&s, -2, 2));
  const double turn = tetra_uniform(&s, 0, 6.28), apart = tetra_uniform(&s, 0.5, 2.6), most = parallel ? log(5e4) : log(1.7);
  const double at_mesh = parallel ? 1.0 : length / fmax(distance, 1.0), angles[2] = { turn, turn + apart };
  *k = (stratus_camera){ .parallel = parallel, .near_k = parallel ? -1e7 : 0.0, .far_k = INFINITY };
  for (int side = 0; side < 2; ++side) {
    double* to = side ? k->up : k->right;
    const double half = at_mesh * n * tetra_uniform(&s, 0.3, 1.0), sign = tetra_uniform(&s, -1, 1) < 0 ? -1 : 1;
    const double lean = sign * exp(tetra_uniform(&s, most - 3.0, most));
    for (int i = 0; i < 3; ++i) {
      to[i] = half * (cos(angles[side]) * axes[1][i] + sin(angles[side]) * axes[2][i] + lean * axes[0][i]);
    }
  }
  for (int i = 0; i < 3; ++i) {
    k->forward[i] = length * axes[0][i];
    k->eye[i] = n * tetra_uniform(&s, 0.3, 0.7) - distance * axes[0][i];
  }
  const int cut = (int)(seed / 2 % 6);
  if (cut == 1 || cut == 3) {
    k->near_k = fmax(distance + n * tetra_uniform(&s, -0.4, 0.2), 0.01 * distance) / length;
  }
  if (cut == 2 || cut == 3) {
    k->far_k = fmax((distance + n * tetra_uniform(&s, 0.2, 0.6)) / length, 1.01 * k->near_k);
  }
  for (int i = 0; cut == 3 && i < TETRA_PIXELS; ++i) {
    opaque[i] = (float)tetra_uniform(&s, 0.5, 1.0);
    c->opaque_depth = opaque;
  }
}

/* With any camera both methods show what the reference does, at full length and with everything behind alpha .9999 left out. */
static void any_camera_sees_the_same_by_both_ways(void** state)
{
  enum { N = 4, CAMERAS = 60 };
  for (uint32_t seed = 0; seed < (few_run() ? CAMERAS / 3 : CAMERAS); ++seed) {
    tetra_case c;
    double largest;
    tetra_create(&c, N, seed % 3 == 0 ? 0.2 : 0.0, 0.0, seed);
    c.opacity[1] = 0.1; /* everything shows */
    look_at_random(&c, N, seed & 1, seed);
    c.options.termination = seed % 5 == 0 ? stratus_tetra_options_default().termination : 1.0;
    draw_both(*state, &c);
    tetra_reference(&c, reference, NULL);
    const double march = tetra_error(marched.rgba, reference, &largest), project = tetra_error(projected.rgba, reference, &largest);
    const double apart = difference();
    if (!(march <= RMSE_MOST) || !(project <= RMSE_MOST) || !(apart <= DIFFERENCE_MOST)) {
      print_error("camera %u: RMSE %.4f of 255 by march, %.4f by projection, at most %g; they differ by %.4f, at most %g\n", seed, march,
        project, RMSE_MOST, apart, DIFFERENCE_MOST);
    }
    assert_true(march <= RMSE_MOST && project <= RMSE_MOST && apart <= DIFFERENCE_MOST);
    double farthest = 0.0;
    for (int i = 0; i < TETRA_PIXELS; ++i) {
      farthest = isinf(marched.depth[i]) ? farthest : fmax(farthest, fabs((double)marched.depth[i]));
    }
    for (int i = 0; i < TETRA_PIXELS; ++i) { /* some roundings of a float, of the picture's depths */
      const double behind = fabs((double)marched.depth[i] - (double)projected.depth[i]);
      assert_true(!isfinite(behind) || behind <= 1e-3 + 0x1p-21 * farthest);
    }
    tetra_destroy(&c);
  }
}

/* Copies of a mesh that overlap it, each moved a little: no order of whole cells is right, and a ray has more pieces than are sorted at
 * once. */
static void cells_that_overlap_are_drawn_again(void** state)
{
  enum { N = 8, COPIES = 3 };
  tetra_case c;
  tetra_create(&c, N, 0.2, 0.0, 3);
  tetra_copy(&c, COPIES, 0.31);
  c.transfer.unit_distance = 4.0;
  tetra_camera(*state, &c, N, 2, 0);
  draw_both(*state, &c);
  double largest;
  tetra_reference(&c, reference, NULL);
  uint32_t most = 0;
  for (int i = 0; i < TETRA_PIXELS; ++i) {
    most = projected.samples[i] > most ? projected.samples[i] : most;
  }
  assert_true(most > 64);
  assert_true(projected.report.again > TETRA_PIXELS / 10);
  /* the march draws the copies one after the other where they begin, so that only the reference can judge */
  assert_true(tetra_error(projected.rgba, reference, &largest) <= RMSE_MOST);
  tetra_destroy(&c);
}

/* Rays that end early end at the same cells, and wrongly ordered pieces behind an opaque object are found, too. */
static void opaque_things(void** state)
{
  for (uint32_t seed = 0; seed < 6; ++seed) {
    tetra_case c;
    tetra_create(&c, 4, 0.2, 0.4, seed);
    c.transfer.unit_distance = 0.02;
    tetra_camera(*state, &c, 4, (int)seed, seed & 1);
    c.options.termination = 0.999;
    draw_both(*state, &c);
    assert_true(difference() <= 10.0 * DIFFERENCE_MOST); /* a pixel may end one faint piece later */
    for (int i = 0; i < TETRA_PIXELS; ++i) {
      assert_int_equal(isinf(marched.depth[i]) != 0, isinf(projected.depth[i]) != 0);
      assert_true(isinf(marched.depth[i]) || fabs((double)(marched.depth[i] - projected.depth[i])) < 1e-3);
    }
    tetra_destroy(&c);
  }
}

static void leaves_change_nothing_but_roundings(void** state)
{
  stratus_partition* partition = NULL;
  stratus_partition_options options = stratus_partition_options_default();
  stratus_partition_result cut;
  tetra_case c;
  tetra_create(&c, 4, 0.0, 0.0, 5); /* planes of its own cut no cell */
  options.leaf_cells = 16;
  assert_int_equal(stratus_partition_create(*state, &c.mesh, &options, &partition), STRATUS_OK);
  stratus_partition_get(partition, &cut);
  assert_int_equal(cut.cell_count, c.mesh.cell_count);
  assert_true(cut.leaves.leaf_count == 8);
  memcpy(c.vertices, cut.vertices, (size_t)(4 * cut.cell_count) * sizeof *cut.vertices); /* leaf by leaf */
  tetra_camera(*state, &c, 4, 3, 0);
  draw_both(*state, &c);
  marched = projected;
  c.options.leaves = &cut.leaves;
  assert_int_equal(projected.report.leaves, 1);
  tetra_draw(*state, &c, &projected);
  assert_int_equal(projected.report.leaves, 8);
  assert_true(difference() <= 1e-4); /* another order that is also right: only pieces shorter than rounding may be reversed */
  stratus_leaves wrong = cut.leaves;
  wrong.leaf_count = 7;
  c.options.leaves = &wrong;
  stratus_tetra_caster* caster = NULL;
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = projected.rgba };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  assert_int_equal(
    stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "leaves"));
  stratus_tetra_caster_destroy(caster);
  stratus_partition_destroy(partition);
  tetra_destroy(&c);
}

/* The tests give the costs, so that no timing decides: if all cells show, the segments' cost decides; if one value in a thousand shows, the
 * order's cost decides. While the camera does not move, the method stays. */
static void auto_takes_what_costs_less(void** state)
{
  tetra_case c;
  stratus_tetra_caster* caster = NULL;
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = projected.rgba };
  static const stratus_tetra_costs costs[3] = { { 1.0, 1.0, 2.0, 12.0, 9.0 }, { 1000.0, 1.0, 2.0, 12.0, 9.0 },
    { 1.0, 1.0, 2.0, 12.0, 10000.0 } };
  static const stratus_tetra_method expected[3][2] = { { STRATUS_TETRA_METHOD_MARCH, STRATUS_TETRA_METHOD_PROJECT },
    { STRATUS_TETRA_METHOD_PROJECT, STRATUS_TETRA_METHOD_PROJECT }, { STRATUS_TETRA_METHOD_MARCH, STRATUS_TETRA_METHOD_MARCH } };
  tetra_create(&c, 3, 0.2, 0.0, 6);
  tetra_camera(*state, &c, 3, 1, 0);
  c.options.method = STRATUS_TETRA_METHOD_AUTO;
  assert_int_equal(stratus_tetra_options_default().method, STRATUS_TETRA_METHOD_AUTO);
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int i = 0; i < 6; ++i) {
    const int rare = i % 2;
    const double opacity[8] = { 0.0, rare ? 0.0 : 0.2, rare ? 0.985 : 0.3, rare ? 0.0 : 0.2, rare ? 0.99 : 0.6, 0.7, 1.0, 0.2 };
    memcpy(c.opacity, opacity, sizeof opacity);
    caster->costs = &costs[i / 2];
    for (int frame = 0; frame < 3; ++frame) {
      stratus_tetra_report report;
      assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, &report), STRATUS_OK);
      assert_int_equal(report.method, expected[i / 2][rare]);
      assert_memory_equal(report.why, stratus_tetra_method_name(report.method), strlen(stratus_tetra_method_name(report.method)));
    }
  }
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&c);
}

/* Measured costs are positive, and are measured once: they also keep one method while the camera does not move. */
static void costs_are_measured_once(void** state)
{
  stratus_tetra_costs costs, again;
  assert_int_equal(stratus_tetra_costs_here(*state, &costs), STRATUS_OK);
  assert_true(costs.segment > 0.0 && costs.packet > 0.0 && costs.cell > 0.0 && costs.sorted > 0.0 && costs.piece >= 0.0);
  assert_int_equal(stratus_tetra_costs_here(*state, &again), STRATUS_OK);
  assert_memory_equal(&costs, &again, sizeof costs);
}

/* More numbers of threads than there is room for: the first and the last number are not measured again. */
static void costs_of_many_numbers_of_threads_change_no_other_s(void** state)
{
  enum { MANY = 20 };
  stratus_context context = *(stratus_context*)*state;
  stratus_tetra_costs costs[MANY], again;
  for (int i = 0; i < MANY; ++i) {
    context.threads = 1 + i;
    assert_int_equal(stratus_tetra_costs_here(&context, &costs[i]), STRATUS_OK);
    assert_true(costs[i].segment > 0.0);
  }
  for (int i = 0; i < MANY; i += MANY - 1) {
    context.threads = 1 + i;
    assert_int_equal(stratus_tetra_costs_here(&context, &again), STRATUS_OK);
    assert_memory_equal(&costs[i], &again, sizeof again);
  }
}

int test_tetra_project(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(pieces_are_the_march_s_segments),
    cmocka_unit_test(any_camera_sees_the_same_by_both_ways),
    cmocka_unit_test(cells_that_overlap_are_drawn_again),
    cmocka_unit_test(opaque_things),
    cmocka_unit_test(leaves_change_nothing_but_roundings),
    cmocka_unit_test(auto_takes_what_costs_less),
    cmocka_unit_test(costs_are_measured_once),
    cmocka_unit_test(costs_of_many_numbers_of_threads_change_no_other_s),
  };
  return cmocka_run_group_tests(tests, tetra_start, tetra_stop);
}
