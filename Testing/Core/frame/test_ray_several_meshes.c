/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes of tetrahedra among several volumes: against the double reference, which knows neither neighbours nor lattice, and against what
 * must be the same by definition. */
#include "faulty_allocator.h"
#include "mixed_case.h"

#include "base.h"

#include "testing.h"
#include "tetra_light_case.h"

/* dB against the reference. Steps of volumes are a fifth of a unit, and cells are drawn from face to face. */
#define MIXED_DB 80.0

static picture drawn, other, third;
static float reference[4 * CASE_PIXELS_MOST], finer[4 * CASE_PIXELS_MOST], depths[CASE_PIXELS_MOST];

static mixed_case m;

static void expect_drawn(void** state, picture* p)
{
  const stratus_status status = mixed_draw(&m, p);
  if (status != STRATUS_OK) {
    print_error("%s: %s\n", stratus_status_name(status), stratus_context_message(*state));
  }
  assert_int_equal(status, STRATUS_OK);
}

/* A mesh that is lit or thinned by its gradients. */
typedef struct lit_mesh {
  const tetra_case* of;
  tetra_space world, local;
} lit_mesh;

static void light_cell(const void* data, int64_t cell, const double place[3], const double along[3], double rgb[3], double* depth)
{
  const lit_mesh* mesh = data;
  const tetra_case* c = mesh->of;
  double g[3];
  if (c->options.shade) {
    tetra_gradient_at(c, &mesh->world, &mesh->world, cell, place, g);
    tetra_illuminate(c, place, along, g, rgb);
  }
  if (c->transfer.gradient_count > 0) {
    tetra_gradient_at(c, &mesh->world, &mesh->local, cell, place, g);
    const double factor =
      linear_between(c->transfer.gradient, c->transfer.gradient_count, 2, 1, sqrt(tetra_dot(g, g)) * mesh->local.spacing);
    const double length = c->options.gradient_distance;
    *depth = length > 0.0 ? -log1p(factor * expm1(-*depth * length)) / length : *depth * factor;
  }
}

/* Returns the PSNR of `drawn` against the reference, which halves its steps at least once. */
static double mixed_psnr(void** state, const char* what, double step)
{
  reference_scene scenes[STRATUS_SEVERAL_MAX];
  reference_mesh meshes[3];
  lit_mesh lit[3];
  for (int n = 0; n < m.volumes.count; ++n) {
    scenes[n] = case_scene(&m.volumes.of[n]);
    scenes[n].shading = m.volumes.of[n].options.light.shade ? &m.volumes.of[n].options.light.shading : NULL;
  }
  for (int n = 0; n < m.mesh_count; ++n) {
    tetra_case* c = &m.meshes[n];
    c->camera = m.volumes.of[0].camera;
    lit[n] = (lit_mesh){ c, tetra_space_create(c, 1), tetra_space_create(c, 0) };
    meshes[n] = (reference_mesh){ &c->mesh, &c->transfer, c->options.clip_plane_count, (const double(*)[4])c->options.clip_planes,
      c->options.shade || c->transfer.gradient_count > 0 ? light_cell : NULL, &lit[n] };
  }
  const reference_mixture mixture = { scenes, m.volumes.count, meshes, m.mesh_count, &m.volumes.of[0].camera,
    m.volumes.of[0].opaque_depth };
  expect_drawn(state, &drawn);
  assert_int_equal(reference_render_mixture(&mixture, CASE_WIDTH, CASE_HEIGHT, 2.0 * step, reference, NULL), 0);
  assert_int_equal(reference_render_mixture(&mixture, CASE_WIDTH, CASE_HEIGHT, step, finer, depths), 0);
  for (int n = 0; n < m.mesh_count; ++n) {
    tetra_space_destroy(&lit[n].world);
    tetra_space_destroy(&lit[n].local);
  }
  const double db = reference_psnr(drawn.rgba, finer, CASE_PIXELS);
  print_message("             %s: %.1f dB, reference %.0f dB, %d pixels; %s\n", what, db, reference_psnr(reference, finer, CASE_PIXELS),
    case_lit(&drawn), m.reports[m.volumes.count + m.mesh_count - 1].why);
  assert_true(case_lit(&drawn) > case_share(100));
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
    mixed_create(*state, &m, 1 + (int)(seed % 3), 1 + (int)(seed / 2 % 2), 500 + seed);
    snprintf(what, sizeof what, "seed %u", seed);
    assert_true(mixed_psnr(state, what, 0.04) >= MIXED_DB);
    m.meshes_first = true;
    assert_int_equal(mixed_draw(&m, &other), STRATUS_OK);
    assert_true(largest_difference(&drawn, &other) < 1e-5f);
    mixed_destroy(&m);
  }
}

/* Cells' own values; a lattice, which lists no cells; values of both kinds together with a stretched volume. */
static void every_kind_of_mesh_mixes(void** state)
{
  mixed_create(*state, &m, 1, 2, 520);
  for (int64_t cell = 0; cell < m.meshes[1].mesh.cell_count; ++cell) {
    m.meshes[1].values[cell] = (float)(0.5 + 0.4 * sin(0.37 * (double)cell));
  }
  m.meshes[1].mesh.cell_values = 1;
  assert_true(mixed_psnr(state, "values of cells", 0.04) >= MIXED_DB);
  mixed_destroy(&m);

  mixed_create(*state, &m, 1, 1, 521);
  tetra_destroy(&m.meshes[0]);
  tetra_create(&m.meshes[0], 3, 0.2, 0.0, 4);
  place_mesh(&m.meshes[0], 3, 2);
  expect_drawn(state, &other);
  tetra_as_lattice(&m.meshes[0], 3);
  expect_drawn(state, &drawn);
  print_message("             lattice and list: %g\n", (double)largest_difference(&drawn, &other));
  assert_true(case_lit(&drawn) > case_share(300));
  assert_true(largest_difference(&drawn, &other) < 1e-5f);
  mixed_destroy(&m);
}

/* Lights the mesh from the eye, from a side, or by a lamp nearby. */
static void light_mesh(tetra_case* c, uint32_t kind)
{
  static const stratus_light side = { .vector = { -1.0, 2.0, 1.5 }, .color = { 1.0, 0.8, 0.6 } },
                             lamp = { .vector = { 15.0, 16.0, 17.0 }, .color = { 2.0, 2.0, 2.0 }, .positional = 1 };
  stratus_shading* s = &c->options.shading;
  c->options.shade = 1;
  s->ambient = 0.2;
  s->diffuse = 0.7;
  s->specular = kind > 0 ? 0.4 : 0.0;
  s->specular_power = 20.0;
  s->light_count = kind == 0 ? -1 : 1;
  s->lights[0] = kind == 1 ? side : lamp;
}

/* Light and gradient opacity of meshes, together with volumes that are lit or not. Light is exact within the tolerance. */
static void light_of_meshes_mixes_as_the_reference_does(void** state)
{
  static const double thin[6] = { 0.05, 0.0, 0.25, 0.6, 0.6, 1.0 };
  for (uint32_t seed = 0; seed < 8; seed += few_run() ? 6 : 1) {
    char what[64];
    mixed_create(*state, &m, seed == 4 ? 0 : 1, 1 + (int)(seed / 2 % 2), 524 + seed);
    m.volumes.of[0].options.light.shade = seed % 2 == 1;
    for (int n = 0; n < m.mesh_count; ++n) {
      tetra_case* c = &m.meshes[n];
      if (n == 0 && seed != 2) {
        light_mesh(c, seed % 3);
      }
      if (seed >= 2) {
        c->transfer.gradient = thin;
        c->transfer.gradient_count = 3;
        c->options.gradient_distance = seed >= 6 ? 2.5 : 0.0; /* of opacities over a length */
      }
    }
    snprintf(what, sizeof what, "light, seed %u", seed);
    assert_true(mixed_psnr(state, what, 0.04) >= 60.0);
    for (int n = 0; n < m.mesh_count; ++n) {
      m.meshes[n].options.tolerance = 1e-5;
    }
    assert_true(mixed_psnr(state, "a small tolerance", 0.04) >= 72.0);
    mixed_destroy(&m);
  }
}

/* A wall is lit where it is, and is none where the gradient opacity is 0. */
static void a_wall_in_a_lit_mesh_is_lit(void** state)
{
  static const double none[2] = { 0.0, 0.0 };
  mixed_create(*state, &m, 1, 1, 551);
  const double wall[8] = { 0.0, 0.0, 0.6, 0.0, 0.6, 1.0, 1.0, 1.0 };
  memcpy(m.meshes[0].opacity, wall, sizeof wall);
  light_mesh(&m.meshes[0], 0);
  assert_true(mixed_psnr(state, "lit wall", 0.01) >= 40.0);
  m.meshes[0].transfer.gradient = none;
  m.meshes[0].transfer.gradient_count = 1;
  expect_drawn(state, &drawn);
  m.mesh_count = 0;
  expect_drawn(state, &other);
  m.mesh_count = 1;
  assert_true(largest_difference(&drawn, &other) < 1e-3f);
  mixed_destroy(&m);
}

/* Gives the first mesh the values of both as two components. */
static void join_components(float* values, stratus_transfer transfers[2])
{
  tetra_case* c = &m.meshes[0];
  for (int64_t i = 0; i < c->mesh.point_count; ++i) {
    values[2 * i] = c->values[i];
    values[2 * i + 1] = m.meshes[1].values[i];
  }
  transfers[0] = c->transfer;
  transfers[1] = m.meshes[1].transfer;
  c->mesh.values = values;
  c->mesh.value_stride = c->mesh.components = 2;
  m.transfers[0] = transfers;
}

/* A volume and two meshes of the same points and cells, which have other values and functions. */
static void create_twins(void** state, uint32_t seed)
{
  mixed_create(*state, &m, 1, 2, seed);
  tetra_case* c = &m.meshes[1];
  tetra_destroy(c);
  tetra_create(c, 3, 0.2, 0.1, seed);
  place_mesh(c, 3, seed % 5u);
  const double color[12] = { 0.0, 0.9, 0.1, 0.3, 0.5, 0.1, 0.4, 0.9, 1.0, 0.2, 0.8, 0.9 };
  memcpy(c->color, color, sizeof color);
  for (int64_t i = 0; i < c->mesh.point_count; ++i) {
    c->values[i] = (float)(0.5 + 0.4 * sin(1.3 * (double)i));
  }
  m.meshes[0].options.tolerance = c->options.tolerance = 1e-5;
}

/* Independent components are as many meshes, whose optical depths add up; dependent ones are as in the mesh's own picture. */
static void components_of_meshes_mix(void** state)
{
  static const double thin[6] = { 0.05, 0.0, 0.25, 0.6, 0.6, 1.0 };
  static float values[2 * 64];
  stratus_transfer transfers[2];
  char what[64];
  for (uint32_t seed = 0; seed < 4; seed += few_run() ? 3 : 1) {
    create_twins(state, 536 + seed);
    for (int n = 0; n < 2; ++n) {
      m.meshes[n].transfer.gradient = thin;
      m.meshes[n].transfer.gradient_count = seed == 2 ? 3 : 0;
      if (seed == 1 || seed == 3) {
        light_mesh(&m.meshes[n], seed);
      }
    }
    snprintf(what, sizeof what, "two meshes, seed %u", seed);
    assert_true(mixed_psnr(state, what, 0.04) >= 72.0);
    join_components(values, transfers);
    m.mesh_count = 1;
    expect_drawn(state, &other);
    const double db = reference_psnr(other.rgba, finer, CASE_PIXELS);
    print_message("             two components: %.1f dB, of two meshes' at most %g\n", db, (double)largest_difference(&drawn, &other));
    assert_true(db >= 72.0);
    m.meshes[0].options.dependent = 1;
    m.volumes.of[0].opacity[1] = m.volumes.of[0].opacity[3] = m.volumes.of[0].opacity[5] = m.volumes.of[0].opacity[7] = 0.0;
    expect_drawn(state, &drawn);
    const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba, .depth = other.depth };
    assert_int_equal(
      stratus_tetra_caster_render(m.tetra[0], &m.meshes[0].mesh, transfers, &m.volumes.of[0].camera, &m.meshes[0].options, &image, NULL),
      STRATUS_OK);
    print_message("             dependent, with an empty volume: %g\n", (double)largest_difference(&drawn, &other));
    assert_true(case_lit(&drawn) > case_share(500) && largest_difference(&drawn, &other) < 1e-3f);
    m.mesh_count = 2;
    mixed_destroy(&m);
  }
}

/* A single mesh, also with an empty volume and with another mesh behind it, has the picture that its own caster draws. */
static void a_mesh_alone_is_the_ordinary_picture(void** state)
{
  static uint32_t samples[CASE_PIXELS_MOST];
  mixed_create(*state, &m, 1, 1, 530);
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
  mixed_destroy(&m);
}

/* Two copies of a mesh, each of half the density, draw the whole one. */
static void halves_of_a_mesh_draw_the_whole(void** state)
{
  mixed_create(*state, &m, 1, 1, 533);
  m.meshes[0].options.tolerance = 1e-5;
  expect_drawn(state, &other);
  mixed_destroy(&m);
  mixed_create(*state, &m, 1, 1, 533);
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
  assert_true(case_lit(&drawn) > case_share(500));
  assert_true(largest_difference(&drawn, &other) < 1e-5f);
  mixed_destroy(&m);
}

/* Opaque geometry, near and far planes, clip planes and boxes, a camera within, jitter. */
static void what_bounds_a_ray_bounds_it_in_meshes(void** state)
{
  static float opaque[CASE_PIXELS_MOST];
  mixed_create(*state, &m, 1, 2, 540);
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
  mixed_destroy(&m);
}

/* Opacity 1 stops rays, in a volume or in a mesh; the silhouette of a wall jumps from pixel to pixel. */
static void a_wall_in_a_mesh_hides_what_is_behind(void** state)
{
  for (int of_mesh = 0; of_mesh < 2; ++of_mesh) {
    mixed_create(*state, &m, 1, 1, 550);
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
    mixed_destroy(&m);
  }
}

/* Where cells overlap both count, so that a part behind them is as dim as behind two meshes. */
static void cells_that_overlap_both_count(void** state)
{
  mixed_create(*state, &m, 0, 1, 560);
  m.volumes.count = 0;
  tetra_copy(&m.meshes[0], 2, 0.7);
  (void)mixed_psnr(state, "overlapping", 0.04);
  float most = 0.0f;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    most = fmaxf(most, fabsf(drawn.rgba[4 * i + 3] - finer[4 * i + 3]));
  }
  print_message("             alpha differs by %g\n", (double)most);
  assert_true(most < 2e-3f);
  mixed_destroy(&m);
}

/* Skipping changes no bit, nor do threads, instruction sets, or casters that are used again. */
static void no_structure_changes_a_bit(void** state)
{
  stratus_context* contexts[4] = { case_context("host", 1), case_context("host", 5), case_context("host", 2), case_context("host", 2) };
  contexts[2]->isa = 0;
  contexts[3]->isa = 1;
  for (uint32_t seed = 0; seed < 6; seed += few_run() ? 5 : 1) {
    mixed_create(*state, &m, 2, 1 + (int)(seed % 2), 570 + seed);
    for (int n = 0; n < 2; ++n) {
      m.volumes.of[n].options.skipping.structure = (stratus_structure)(STRATUS_STRUCTURE_AUTO + (seed + (uint32_t)n) % 6);
    }
    m.volumes.of[0].options.skipping.audit = 1;
    m.volumes.of[0].options.sampling.jitter = seed % 3 == 0;
    expect_drawn(state, &drawn);
    assert_int_equal(drawn.report.differing_pixels, 0);
    expect_drawn(state, &other);
    expect_same(&drawn, &other);
    for (int t = 0; t < 4; ++t) {
      assert_int_equal(mixed_draw_by(contexts[t], &m, &other), STRATUS_OK);
      expect_same(&drawn, &other);
    }
    mixed_destroy(&m);
  }
  for (int t = 0; t < 4; ++t) {
    stratus_context_destroy(contexts[t]);
  }
}

/* Automatic sampling and division keep the tolerance of the whole picture. */
static void the_tolerance_is_kept(void** state)
{
  for (uint32_t seed = 0; seed < 4; seed += few_run() ? 3 : 1) {
    mixed_create(*state, &m, 1, 1, 580 + seed);
    m.volumes.of[0].options = stratus_ray_cast_options_default();
    for (int deep = 0; deep < 2; ++deep) {
      m.meshes[0].transfer.unit_distance = deep ? 0.3 : 4.0;
      assert_true(mixed_psnr(state, deep ? "automatic, deep" : "automatic", 0.02) >= 60.0);
    }
    mixed_destroy(&m);
  }
}

static void what_does_not_mix_is_refused(void** state)
{
  mixed_create(*state, &m, 1, 1, 590);
  stratus_context* elsewhere = case_context("host", 1);
  const stratus_tetra_options good = m.meshes[0].options;
#define REFUSED(status, words)                                                                                                             \
  assert_int_equal(mixed_draw(&m, &drawn), status);                                                                                        \
  assert_non_null(strstr(stratus_context_message(*state), words));                                                                         \
  m.meshes[0].options = good
  m.meshes[0].options.mode = STRATUS_TETRA_MAXIMUM;
  REFUSED(STRATUS_UNSUPPORTED, "mesh 1 of several has mode maximum");
  m.meshes[0].options.method = STRATUS_TETRA_METHOD_PROJECT;
  REFUSED(STRATUS_UNSUPPORTED, "projected");
  m.meshes[0].options.label_count = 1;
  REFUSED(STRATUS_INVALID_ARGUMENT, "label_count 1 of a mesh without labels");
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
  assert_int_equal(mixed_draw(&m, &drawn), STRATUS_OK);
  mixed_destroy(&m);
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
    mixed_create(context, &m, 1, 1, 595);
    allocator.fail_at = allocator.calls + n;
    const stratus_status status = mixed_draw(&m, &other);
    const bool failed = allocator.calls >= allocator.fail_at;
    allocator.fail_at = 0;
    assert_true(status == STRATUS_OK || (failed && status == STRATUS_OUT_OF_MEMORY));
    failures += failed;
    assert_int_equal(mixed_draw(&m, &other), STRATUS_OK);
    if (n == 1) {
      memcpy(&drawn, &other, sizeof drawn);
    }
    expect_same(&drawn, &other);
    mixed_destroy(&m);
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
    cmocka_unit_test(light_of_meshes_mixes_as_the_reference_does),
    cmocka_unit_test(a_wall_in_a_lit_mesh_is_lit),
    cmocka_unit_test(components_of_meshes_mix),
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
