/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes of tetrahedra among several volumes: against the double reference, which knows neither neighbours nor lattice, and against what
 * must be the same by definition. */
#include "faulty_allocator.h"
#include "several_case.h"

#include "base.h"

#undef TETRA_PIXELS
#include "tetra_case.h"
#include "testing.h"

/* dB against the reference. Steps of volumes are a fifth of a unit, and cells are drawn from face to face. */
#define MIXED_DB 80.0

static picture drawn, other, third;
static float reference[4 * CASE_PIXELS], finer[4 * CASE_PIXELS], depths[CASE_PIXELS];

/* Volumes and meshes, at most three of each. */
typedef struct mixed_case {
  several_case volumes;
  tetra_case meshes[3];
  int mesh_count;
  bool meshes_first; /* in the order of inputs */
  stratus_tetra_caster* tetra[3];
  several_casters casters;
  stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX];
} mixed_case;

static mixed_case m;

/* A mesh of n^3 boxes of 20 units about the origin, turned by its seed, in colours of its own. */
static void place_mesh(tetra_case* c, int n, uint32_t seed)
{
  const double turn = 0.3 + 0.7 * seed, size = 20.0 / n, ca = cos(turn), sa = sin(turn);
  const double middle[3] = { 10.0, 10.0, 10.0 },
               rows[3][3] = { { ca, -sa * 0.8, sa * 0.6 }, { sa, ca * 0.8, -ca * 0.6 }, { 0.0, 0.6, 0.8 } };
  for (int row = 0; row < 3; ++row) {
    double shift = 0.0;
    for (int a = 0; a < 3; ++a) {
      c->mesh.matrix[4 * row + a] = rows[row][a] * size;
      shift += rows[row][a] * middle[a];
    }
    c->mesh.matrix[4 * row + 3] = 2.0 * (double)seed - 2.0 - shift;
  }
  const double color[12] = { 0.0, 0.1, 0.9, 0.3, 0.5, 0.2, 0.3, 1.0, 1.0, 0.9, 0.9, 0.1 };
  memcpy(c->color, color, sizeof color);
  c->transfer.unit_distance = 4.0;
  c->options.termination = 0.0;
  c->options.method = STRATUS_TETRA_METHOD_AUTO;
}

static void mixed_create(stratus_context* context, int count, int mesh_count, uint32_t seed)
{
  memset(&m, 0, sizeof m);
  if (count > 0) {
    several_create(context, &m.volumes, count, seed);
  }
  m.mesh_count = mesh_count;
  for (int n = 0; n < mesh_count; ++n) {
    tetra_create(&m.meshes[n], 3 + n, 0.2, n == 0 ? 0.1 : 0.0, seed + (uint32_t)n);
    place_mesh(&m.meshes[n], 3 + n, seed % 5u + (uint32_t)n);
    assert_int_equal(stratus_tetra_caster_create(context, &m.tetra[n]), STRATUS_OK);
  }
  several_casters_create(context, &m.casters);
  const double eye[3] = { 50, 40, 30.0 - 3.0 * (double)(seed % 20u) }, focal[3] = { 0, 0, 0 }, up[3] = { 0.1, 0.2, 1 };
  if (seed % 2) {
    assert_int_equal(
      stratus_camera_perspective(context, eye, focal, up, 34.0, (double)CASE_WIDTH / CASE_HEIGHT, &m.volumes.of[0].camera), STRATUS_OK);
  } else {
    assert_int_equal(
      stratus_camera_parallel(context, eye, focal, up, 19.0, (double)CASE_WIDTH / CASE_HEIGHT, &m.volumes.of[0].camera), STRATUS_OK);
  }
}

static void mixed_destroy(void)
{
  several_casters_destroy(&m.casters);
  several_destroy(&m.volumes);
  for (int n = 0; n < m.mesh_count; ++n) {
    stratus_tetra_caster_destroy(m.tetra[n]);
    tetra_destroy(&m.meshes[n]);
  }
}

static stratus_status mixed_draw(picture* p)
{
  stratus_ray_cast_input inputs[STRATUS_SEVERAL_MAX];
  const int count = m.volumes.count, all = count + m.mesh_count;
  const stratus_image image = { .width = CASE_WIDTH,
    .height = CASE_HEIGHT,
    .rgba = p->rgba,
    .depth = p->depth,
    .samples = p->samples,
    .opaque_depth = m.volumes.of[0].opaque_depth };
  for (int n = 0; n < count; ++n) {
    inputs[n + (m.meshes_first ? m.mesh_count : 0)] = (stratus_ray_cast_input){ .caster = m.casters.of[n],
      .volume = &m.volumes.of[n].volume,
      .transfer = &m.volumes.of[n].transfer,
      .options = &m.volumes.of[n].options };
  }
  for (int n = 0; n < m.mesh_count; ++n) {
    inputs[n + (m.meshes_first ? 0 : count)] = (stratus_ray_cast_input){ .tetra = m.tetra[n],
      .mesh = &m.meshes[n].mesh,
      .transfer = &m.meshes[n].transfer,
      .options = &m.volumes.of[0].options,
      .tetra_options = &m.meshes[n].options };
  }
  const stratus_status status = stratus_ray_caster_render_several(inputs, all, &m.volumes.of[0].camera, &image, m.reports);
  p->report = m.reports[0];
  return status;
}

static void expect_drawn(void** state, picture* p)
{
  const stratus_status status = mixed_draw(p);
  if (status != STRATUS_OK) {
    print_error("%s: %s\n", stratus_status_name(status), stratus_context_message(*state));
  }
  assert_int_equal(status, STRATUS_OK);
}

/* Returns the PSNR of `drawn` against the reference, which halves its steps at least once. */
static double mixed_psnr(void** state, const char* what, double step)
{
  reference_scene scenes[STRATUS_SEVERAL_MAX];
  reference_mesh meshes[3];
  for (int n = 0; n < m.volumes.count; ++n) {
    scenes[n] = case_scene(&m.volumes.of[n]);
    scenes[n].shading = m.volumes.of[n].options.light.shade ? &m.volumes.of[n].options.light.shading : NULL;
  }
  for (int n = 0; n < m.mesh_count; ++n) {
    meshes[n] = (reference_mesh){ &m.meshes[n].mesh, &m.meshes[n].transfer, m.meshes[n].options.clip_plane_count,
      (const double(*)[4])m.meshes[n].options.clip_planes };
  }
  const reference_mixture mixture = { scenes, m.volumes.count, meshes, m.mesh_count, &m.volumes.of[0].camera,
    m.volumes.of[0].opaque_depth };
  expect_drawn(state, &drawn);
  assert_int_equal(reference_render_mixture(&mixture, CASE_WIDTH, CASE_HEIGHT, 2.0 * step, reference, NULL), 0);
  assert_int_equal(reference_render_mixture(&mixture, CASE_WIDTH, CASE_HEIGHT, step, finer, depths), 0);
  const double db = reference_psnr(drawn.rgba, finer, CASE_PIXELS);
  print_message("             %s: %.1f dB, reference %.0f dB, %d pixels; %s\n", what, db, reference_psnr(reference, finer, CASE_PIXELS),
    case_lit(&drawn), m.reports[m.volumes.count + m.mesh_count - 1].why);
  assert_true(case_lit(&drawn) > 100);
  return db;
}

static void expect_same(const picture* a, const picture* b)
{
  assert_memory_equal(a->rgba, b->rgba, sizeof a->rgba);
  assert_memory_equal(a->depth, b->depth, sizeof a->depth);
}

static float largest_difference(const picture* a, const picture* b)
{
  float most = 0.0f;
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    most = fmaxf(most, fabsf(a->rgba[i] - b->rgba[i]));
  }
  return most;
}

static void volumes_and_meshes_mix_as_the_reference_does(void** state)
{
  for (uint32_t seed = 0; seed < 6; seed += few_run() ? 5 : 1) {
    char what[64];
    mixed_create(*state, 1 + (int)(seed % 3), 1 + (int)(seed / 2 % 2), 500 + seed);
    snprintf(what, sizeof what, "seed %u", seed);
    assert_true(mixed_psnr(state, what, 0.04) >= MIXED_DB);
    m.meshes_first = true;
    assert_int_equal(mixed_draw(&other), STRATUS_OK);
    assert_true(largest_difference(&drawn, &other) < 1e-5f);
    mixed_destroy();
  }
}

/* Cells' own values; a lattice, which lists no cells; values of both kinds together with a stretched volume. */
static void every_kind_of_mesh_mixes(void** state)
{
  mixed_create(*state, 1, 2, 520);
  for (int64_t cell = 0; cell < m.meshes[1].mesh.cell_count; ++cell) {
    m.meshes[1].values[cell] = (float)(0.5 + 0.4 * sin(0.37 * (double)cell));
  }
  m.meshes[1].mesh.cell_values = 1;
  assert_true(mixed_psnr(state, "values of cells", 0.04) >= MIXED_DB);
  mixed_destroy();

  mixed_create(*state, 1, 1, 521);
  tetra_destroy(&m.meshes[0]);
  tetra_create(&m.meshes[0], 3, 0.2, 0.0, 4);
  place_mesh(&m.meshes[0], 3, 2);
  expect_drawn(state, &other);
  tetra_as_lattice(&m.meshes[0], 3);
  expect_drawn(state, &drawn);
  print_message("             lattice and list: %g\n", (double)largest_difference(&drawn, &other));
  assert_true(case_lit(&drawn) > 300);
  assert_true(largest_difference(&drawn, &other) < 1e-5f);
  mixed_destroy();
}

/* A single mesh, also with an empty volume and with another mesh behind it, has the picture that its own caster draws. */
static void a_mesh_alone_is_the_ordinary_picture(void** state)
{
  static uint32_t samples[CASE_PIXELS];
  mixed_create(*state, 1, 1, 530);
  m.meshes[0].options.tolerance = 1e-5;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba, .depth = other.depth, .samples = samples };
  m.volumes.of[0].opacity[1] = m.volumes.of[0].opacity[3] = m.volumes.of[0].opacity[5] = m.volumes.of[0].opacity[7] = 0.0;
  assert_int_equal(stratus_tetra_caster_render(
                     m.tetra[0], &m.meshes[0].mesh, &m.meshes[0].transfer, &m.volumes.of[0].camera, &m.meshes[0].options, &image, NULL),
    STRATUS_OK);
  expect_drawn(state, &drawn);
  const int volumes = m.volumes.count;
  m.volumes.count = 0;
  expect_drawn(state, &third);
  m.volumes.count = volumes;
  print_message("             with an empty volume %g, without %g\n", (double)largest_difference(&drawn, &other),
    (double)largest_difference(&third, &other));
  /* both round values to the entries of one table, in different ways */
  assert_true(largest_difference(&drawn, &other) < 1e-3f && largest_difference(&third, &other) < 1e-3f);
  for (int i = 0; i < CASE_PIXELS; ++i) {
    assert_true(drawn.depth[i] == other.depth[i] || fabsf(drawn.depth[i] - other.depth[i]) < 1e-3f);
  }
  mixed_destroy();
}

/* Two copies of a mesh, each of half the density, draw the whole one. */
static void halves_of_a_mesh_draw_the_whole(void** state)
{
  mixed_create(*state, 1, 1, 533);
  m.meshes[0].options.tolerance = 1e-5;
  expect_drawn(state, &other);
  mixed_destroy();
  mixed_create(*state, 1, 1, 533);
  m.mesh_count = 2;
  assert_int_equal(stratus_tetra_caster_create(*state, &m.tetra[1]), STRATUS_OK);
  tetra_create(&m.meshes[1], 3, 0.2, 0.1, 533);
  place_mesh(&m.meshes[1], 3, 533 % 5u);
  for (int n = 0; n < 2; ++n) {
    m.meshes[n].options.tolerance = 1e-5;
    m.meshes[n].transfer.unit_distance *= 2.0;
  }
  expect_drawn(state, &drawn);
  print_message("             halves: %g\n", (double)largest_difference(&drawn, &other));
  assert_true(case_lit(&drawn) > 500);
  assert_true(largest_difference(&drawn, &other) < 1e-5f);
  mixed_destroy();
}

/* Opaque geometry, near and far planes, clip planes and boxes, a camera within, jitter. */
static void what_bounds_a_ray_bounds_it_in_meshes(void** state)
{
  static float opaque[CASE_PIXELS];
  mixed_create(*state, 1, 2, 540);
  for (int i = 0; i < CASE_PIXELS; ++i) {
    opaque[i] = i % 7 == 0 ? 1.0f : (float)(i % CASE_WIDTH) / CASE_WIDTH;
  }
  m.volumes.of[0].camera.near_k = 55.0;
  m.volumes.of[0].camera.far_k = 85.0;
  m.volumes.of[0].opaque_depth = opaque;
  assert_true(mixed_psnr(state, "opaque, near and far", 0.04) >= MIXED_DB);
  m.volumes.of[0].opaque_depth = NULL;
  m.meshes[1].options.clip_plane_count = 1;
  const double plane[4] = { 0.3, 0.5, -0.2, 1.0 };
  memcpy(m.meshes[1].options.clip_planes[0], plane, sizeof plane);
  assert_true(mixed_psnr(state, "clip planes", 0.04) >= MIXED_DB);
  const double inside[3] = { 1.3, 0.7, 1.1 }, focal[3] = { 30, 40, 35 }, up[3] = { 0, 1, 0 };
  assert_int_equal(stratus_camera_perspective(*state, inside, focal, up, 80.0, 1.2, &m.volumes.of[0].camera), STRATUS_OK);
  assert_true(mixed_psnr(state, "camera inside", 0.04) >= MIXED_DB);
  m.volumes.of[0].options.sampling.jitter = 1;
  assert_true(mixed_psnr(state, "jitter", 0.04) >= MIXED_DB);
  mixed_destroy();
}

/* Opacity 1 stops rays, in a volume or in a mesh; the silhouette of a wall jumps from pixel to pixel. */
static void a_wall_in_a_mesh_hides_what_is_behind(void** state)
{
  for (int of_mesh = 0; of_mesh < 2; ++of_mesh) {
    mixed_create(*state, 1, 1, 550);
    picture_case* c = &m.volumes.of[0];
    const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
    const double wall[8] = { base - scale, 0, base + 0.2 * scale, 0.1, base + 0.2 * scale, 1.0, base + scale, 1.0 };
    const double in_mesh[8] = { 0.0, 0.0, 0.6, 0.1, 0.6, 1.0, 1.0, 1.0 };
    memcpy(of_mesh ? m.meshes[0].opacity : c->opacity, of_mesh ? in_mesh : wall, sizeof wall);
    c->options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
    c->options.sampling.distance = 0.02;
    assert_true(mixed_psnr(state, of_mesh ? "wall in the mesh" : "wall in the volume", 0.01) >= 42.0);
    int opaque = 0;
    for (int i = 0; i < CASE_PIXELS; ++i) {
      opaque += drawn.rgba[4 * i + 3] == 1.0f;
    }
    assert_true(opaque > 50);
    mixed_destroy();
  }
}

/* Where cells overlap both count, so that a part behind them is as dim as behind two meshes. */
static void cells_that_overlap_both_count(void** state)
{
  mixed_create(*state, 0, 1, 560);
  m.volumes.count = 0;
  tetra_copy(&m.meshes[0], 2, 0.7);
  (void)mixed_psnr(state, "overlapping", 0.04);
  float most = 0.0f;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    most = fmaxf(most, fabsf(drawn.rgba[4 * i + 3] - finer[4 * i + 3]));
  }
  print_message("             alpha differs by %g\n", (double)most);
  assert_true(most < 2e-3f);
  mixed_destroy();
}

/* Skipping changes no bit, nor do threads, instruction sets, or casters that are used again. */
static void no_structure_changes_a_bit(void** state)
{
  stratus_context* contexts[4] = { case_context("host", 1), case_context("host", 5), case_context("host", 2), case_context("host", 2) };
  contexts[2]->isa = 0;
  contexts[3]->isa = 1;
  for (uint32_t seed = 0; seed < 6; seed += few_run() ? 5 : 1) {
    mixed_create(*state, 2, 1 + (int)(seed % 2), 570 + seed);
    for (int n = 0; n < 2; ++n) {
      m.volumes.of[n].options.skipping.structure = (stratus_structure)(STRATUS_STRUCTURE_AUTO + (seed + (uint32_t)n) % 6);
    }
    m.volumes.of[0].options.skipping.audit = 1;
    m.volumes.of[0].options.sampling.jitter = seed % 3 == 0;
    expect_drawn(state, &drawn);
    assert_int_equal(drawn.report.differing_pixels, 0);
    expect_drawn(state, &other);
    expect_same(&drawn, &other);
    const mixed_case kept = m;
    for (int t = 0; t < 4; ++t) {
      m = kept;
      several_casters_create(contexts[t], &m.casters);
      for (int n = 0; n < m.mesh_count; ++n) {
        assert_int_equal(stratus_tetra_caster_create(contexts[t], &m.tetra[n]), STRATUS_OK);
      }
      assert_int_equal(mixed_draw(&other), STRATUS_OK);
      expect_same(&drawn, &other);
      several_casters_destroy(&m.casters);
      for (int n = 0; n < m.mesh_count; ++n) {
        stratus_tetra_caster_destroy(m.tetra[n]);
      }
    }
    m = kept;
    mixed_destroy();
  }
  for (int t = 0; t < 4; ++t) {
    stratus_context_destroy(contexts[t]);
  }
}

/* Automatic sampling and division keep the tolerance of the whole picture. */
static void the_tolerance_is_kept(void** state)
{
  for (uint32_t seed = 0; seed < 4; seed += few_run() ? 3 : 1) {
    mixed_create(*state, 1, 1, 580 + seed);
    m.volumes.of[0].options = stratus_ray_cast_options_default();
    for (int deep = 0; deep < 2; ++deep) {
      m.meshes[0].transfer.unit_distance = deep ? 0.3 : 4.0;
      assert_true(mixed_psnr(state, deep ? "automatic, deep" : "automatic", 0.02) >= 60.0);
    }
    mixed_destroy();
  }
}

static void what_does_not_mix_is_refused(void** state)
{
  mixed_create(*state, 1, 1, 590);
  stratus_context* elsewhere = case_context("host", 1);
  const stratus_tetra_options good = m.meshes[0].options;
#define REFUSED(status, words)                                                                                                             \
  assert_int_equal(mixed_draw(&drawn), status);                                                                                            \
  assert_non_null(strstr(stratus_context_message(*state), words));                                                                         \
  m.meshes[0].options = good
  m.meshes[0].options.mode = STRATUS_TETRA_MAXIMUM;
  REFUSED(STRATUS_UNSUPPORTED, "mesh 1 of several has mode maximum");
  m.meshes[0].options.method = STRATUS_TETRA_METHOD_PROJECT;
  REFUSED(STRATUS_UNSUPPORTED, "projected");
  m.meshes[0].options.shade = 1;
  REFUSED(STRATUS_UNSUPPORTED, "light, gradient opacity or labels");
  m.meshes[0].options.label_count = 1;
  REFUSED(STRATUS_UNSUPPORTED, "light, gradient opacity or labels");
  m.meshes[0].options.tolerance = -1.0;
  REFUSED(STRATUS_INVALID_ARGUMENT, "tolerance");
  m.meshes[0].mesh.point_count = -1;
  REFUSED(STRATUS_INVALID_ARGUMENT, "point");
  m.meshes[0].mesh.point_count = 64;
  m.meshes[0].mesh.matrix[3] = 1e12;
  REFUSED(STRATUS_INVALID_ARGUMENT, "wide");
  m.meshes[0].mesh.matrix[3] = 0.0;
  stratus_tetra_caster* kept = m.tetra[0];
  assert_int_equal(stratus_tetra_caster_create(elsewhere, &m.tetra[0]), STRATUS_OK);
  REFUSED(STRATUS_INVALID_ARGUMENT, "another context");
  stratus_tetra_caster_destroy(m.tetra[0]);
  m.tetra[0] = NULL;
  REFUSED(STRATUS_INVALID_ARGUMENT, "caster is NULL");
  m.tetra[0] = kept;
  const stratus_ray_cast_input both = { .caster = m.casters.of[0], .tetra = m.tetra[0] };
  assert_int_equal(stratus_ray_caster_render_several(&both, 1, &m.volumes.of[0].camera, NULL, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "volume or a mesh"));
  assert_int_equal(mixed_draw(&drawn), STRATUS_OK);
  mixed_destroy();
  stratus_context_destroy(elsewhere);
}

/* Whichever allocation fails, the call says so, nothing leaks, and the next picture is right. */
static void each_allocation_may_fail(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  const stratus_context_options options = faulty_options(&allocator, "host");
  stratus_context* context = NULL;
  int failures = 0;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  const int64_t live = allocator.live;
  for (int64_t n = 1; n < 400; ++n) {
    mixed_create(context, 1, 1, 595);
    allocator.fail_at = allocator.calls + n;
    const stratus_status status = mixed_draw(&other);
    const bool failed = allocator.calls >= allocator.fail_at;
    allocator.fail_at = 0;
    assert_true(status == STRATUS_OK || (failed && status == STRATUS_OUT_OF_MEMORY));
    failures += failed;
    assert_int_equal(mixed_draw(&other), STRATUS_OK);
    if (n == 1) {
      memcpy(&drawn, &other, sizeof drawn);
    }
    expect_same(&drawn, &other);
    mixed_destroy();
    if (!failed) {
      break;
    }
  }
  assert_true(failures > 20 && failures < 390);
  assert_int_equal(allocator.live, live);
  stratus_context_destroy(context);
}

int test_ray_several_meshes(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(volumes_and_meshes_mix_as_the_reference_does),
    cmocka_unit_test(every_kind_of_mesh_mixes),
    cmocka_unit_test(a_mesh_alone_is_the_ordinary_picture),
    cmocka_unit_test(halves_of_a_mesh_draw_the_whole),
    cmocka_unit_test(what_bounds_a_ray_bounds_it_in_meshes),
    cmocka_unit_test(a_wall_in_a_mesh_hides_what_is_behind),
    cmocka_unit_test(cells_that_overlap_both_count),
    cmocka_unit_test(no_structure_changes_a_bit),
    cmocka_unit_test(the_tolerance_is_kept),
    cmocka_unit_test(what_does_not_mix_is_refused),
    cmocka_unit_test(each_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
