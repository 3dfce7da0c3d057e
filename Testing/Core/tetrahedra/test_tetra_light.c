/* SPDX-License-Identifier: BSD-3-Clause
 * Light and gradient opacity of tetrahedra against the double-precision reference: on random meshes with hollows, values of points and of
 * cells, under matrices and cuts; a linear field against the formula; lattices against their lists; and refused inputs. */
#include "tetra_light_case.h"

#include "tetra_caster.h"
#include "testing.h"

static tetra_picture picture, other;
static double reference[4 * TETRA_PIXELS_MOST];
static const double thin[6] = { 0.1, 0.0, 0.5, 0.6, 1.2, 1.0 };

/* Light from the eye, from two sides, or a lamp nearby. */
static void set_light(tetra_case* c, int kind)
{
  stratus_shading* s = &c->options.shading;
  static const stratus_light lights[2] = {
    { .vector = { -1.0, 2.0, 1.5 }, .color = { 1.0, 0.8, 0.6 }, .separate_specular = 1, .specular_color = { 0.1, 0.5, 1.5 } },
    { .vector = { 0.5, -1.0, 0.3 }, .color = { 0.2, 0.3, 0.5 } }
  };
  static const stratus_light lamp = {
    .vector = { 5.0, 6.0, 7.0 }, .color = { 3.0, 3.0, 3.0 }, .positional = 1, .attenuation = { 1.0, 0.2, 0.05 }
  };
  c->options.shade = 1;
  s->ambient = 0.2;
  s->diffuse = 0.7;
  s->specular = kind > 0 ? 0.4 : 0.0;
  s->specular_power = 20.0;
  s->light_count = kind == 0 ? -1 : kind == 1 ? 2 : 1;
  s->lights[0] = kind == 1 ? lights[0] : lamp;
  s->lights[1] = lights[1];
  s->one_sided = kind == 1;
}

/* A matrix that turns, stretches, shears, mirrors and moves. */
static void set_matrix(tetra_case* c)
{
  const double matrix[16] = { 0.9, -0.3, 0.1, 0.2, 0.4, 0.8, 0.0, -0.3, 0.1, 0.2, -1.1, 4.1, 0, 0, 0, 1 };
  memcpy(c->mesh.matrix, matrix, sizeof matrix);
}

static void is_right(stratus_context* context, const tetra_case* c, double limit, const char* what, uint32_t seed)
{
  double largest;
  tetra_reference_lit(c, reference);
  tetra_draw(context, c, &picture);
  const double error = tetra_error(picture.rgba, reference, &largest);
  if (!(error < limit)) {
    print_error("%s %u, mode %s: %.3f of 255, at most %.2f\n", what, seed, stratus_tetra_mode_name(c->options.mode), error, largest);
  }
  assert_true(error < limit);
}

/* The default tolerance is a quarter of a step of 255. */
static void light_is_right(void** state)
{
  for (uint32_t seed = 0; seed < 18; seed += few_run() ? 5 : 1) {
    tetra_case c;
    tetra_create(&c, 4, 0.2, seed % 3 == 0 ? 0.25 : 0.0, seed);
    set_light(&c, (int)(seed % 3));
    c.mesh.cell_values = seed % 6 == 5;
    c.options.mode = seed % 6 == 4 ? STRATUS_TETRA_ISOSURFACE : STRATUS_TETRA_COMPOSITE;
    c.options.contours[0] = 0.4;
    c.options.contours[1] = 0.6;
    c.options.contour_count = 2;
    if (seed % 4 == 1) {
      set_matrix(&c);
    }
    if (seed % 7 == 3 &&
      c.options.mode == STRATUS_TETRA_COMPOSITE) { /* a peak that is narrower than cells: light follows its position in them */
      memcpy(c.opacity, (const double[6]){ 0.45, 0.0, 0.5, 0.9, 0.55, 0.0 }, 6 * sizeof(double));
      c.transfer.opacity_count = 3;
    }
    if (seed % 5 == 2) {
      c.options.crop = 1;
      memcpy(c.options.crop_bounds, (const double[6]){ 0.4, 3.3, 0.7, 2.9, 0.6, 3.6 }, 6 * sizeof(double));
    }
    tetra_camera(*state, &c, 4, (int)(seed % 8), seed & 1);
    is_right(*state, &c, 0.255, "light", seed);
    tetra_destroy(&c);
  }
}

static void gradient_opacity_is_right(void** state)
{
  for (uint32_t seed = 0; seed < 12; seed += few_run() ? 5 : 1) {
    tetra_case c;
    tetra_create(&c, 4, 0.2, seed % 3 == 0 ? 0.25 : 0.0, seed);
    c.transfer.gradient = thin;
    c.transfer.gradient_count = 3;
    c.options.gradient_distance = seed % 3 == 1 ? 0.5 : seed == 8 ? -1.0 : 0.0;
    if (seed & 2) {
      set_light(&c, 1);
    }
    if (seed % 4 == 1) {
      set_matrix(&c);
    }
    tetra_camera(*state, &c, 4, (int)(seed % 8), seed & 1);
    is_right(*state, &c, 0.255, "gradient opacity", seed);
    tetra_destroy(&c);
  }
}

/* Values of opacity 1 stay so where the factor is above 0, and over a length let pass what the factor leaves. */
static void opaque_values_are_thinned(void** state)
{
  static const double slab[2] = { 0.0, 0.2 }, steep[4] = { 0.0, 0.0, 0.2, 0.0 };
  tetra_case c;
  tetra_create(&c, 2, 0.0, 0.0, 1);
  for (int i = 0; i < c.mesh.point_count; ++i) {
    c.values[i] = (float)(0.5 + 0.1 * c.points[3 * i]);
  }
  memcpy(c.opacity, (const double[4]){ 0.0, 1.0, 1.0, 1.0 }, 4 * sizeof(double));
  memcpy(c.color, (const double[4]){ 0.0, 1.0, 1.0, 1.0 }, 4 * sizeof(double));
  c.transfer.opacity_count = 2;
  c.transfer.color_count = 1;
  c.transfer.gradient = slab;
  c.transfer.gradient_count = 1;
  const double eye[3] = { 1.0, 1.0, -5 }, middle[3] = { 1.0, 1.0, 0 }, up[3] = { 0, 1, 0 };
  assert_int_equal(stratus_camera_parallel(*state, eye, middle, up, 0.5, 1.0, &c.camera), STRATUS_OK);
  const int at = 4 * (TETRA_WIDTH * (TETRA_HEIGHT / 2) + TETRA_WIDTH / 2);
  const double ways[4] = { 0.0, 2.0, 1.0, 0.5 }, alpha[4] = { 1.0, 0.2, 1.0 - 0.8 * 0.8, 1.0 - 0.8 * 0.8 * 0.8 * 0.8 };
  for (int i = 0; i < 4; ++i) {
    c.options.gradient_distance = ways[i];
    tetra_draw(*state, &c, &picture);
    if (!(fabs((double)picture.rgba[at + 3] - alpha[i]) < 1e-3)) {
      print_error("way %g: alpha %g, not %g\n", ways[i], (double)picture.rgba[at + 3], alpha[i]);
    }
    assert_true(fabs((double)picture.rgba[at + 3] - alpha[i]) < 1e-3);
  }
  c.options.gradient_distance = 0.0;
  c.transfer.gradient = steep;
  c.transfer.gradient_count = 2;
  tetra_draw(*state, &c, &picture);
  assert_true(picture.rgba[at + 3] == 0.0f);
  tetra_destroy(&c);
}

/* In a linear field the normal is the same everywhere, however the cells lie: a picture of opaque white is ambient + diffuse N L. */
static void linear_field_has_one_light(void** state)
{
  tetra_case c;
  tetra_create(&c, 4, 0.2, 0.1, 3);
  for (int i = 0; i < c.mesh.point_count; ++i) {
    c.values[i] = (float)(0.1 + 0.05 * c.points[3 * i] + 0.1 * c.points[3 * i + 1]);
  }
  memcpy(c.opacity, (const double[4]){ 0.0, 1.0, 1.0, 1.0 }, 4 * sizeof(double));
  memcpy(c.color, (const double[4]){ 0.0, 1.0, 1.0, 1.0 }, 4 * sizeof(double));
  c.transfer.opacity_count = 2;
  c.transfer.color_count = 1;
  set_light(&c, 0);
  c.options.shading.light_count = 1;
  c.options.shading.one_sided = 1;
  c.options.shading.lights[0] = (stratus_light){ .vector = { -1, 0, 0 }, .color = { 1, 1, 1 } };
  tetra_camera(*state, &c, 4, 2, 0);
  tetra_draw(*state, &c, &picture);
  const double known = 0.2 + 0.7 / sqrt(5.0);
  int met = 0;
  for (int pixel = 0; pixel < TETRA_PIXELS; ++pixel) {
    if (picture.rgba[4 * pixel + 3] > 0.999f) {
      assert_true(fabs((double)picture.rgba[4 * pixel] - known) < 1e-5);
      ++met;
    }
  }
  assert_true(met > 100);
  tetra_destroy(&c);
}

/* A lattice has the gradients of its list, as sums of the same cells in another order. */
static void lattices_are_lit_as_lists(void** state)
{
  for (uint32_t seed = 0; seed < 6; ++seed) {
    tetra_case c;
    tetra_create(&c, 4, 0.1, 0.0, seed);
    set_light(&c, (int)(seed % 3));
    if (seed & 1) {
      c.transfer.gradient = thin;
      c.transfer.gradient_count = 3;
    }
    tetra_camera(*state, &c, 4, (int)seed, seed & 1);
    tetra_draw(*state, &c, &picture);
    tetra_as_lattice(&c, 4);
    tetra_draw(*state, &c, &other);
    double squares = 0.0;
    for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
      squares += pow(255.0 * (double)(picture.rgba[i] - other.rgba[i]), 2.0);
    }
    assert_true(sqrt(squares / (4 * TETRA_PIXELS)) < 0.01);
    tetra_destroy(&c);
  }
}

/* Light that is off, or lights nothing, leaves the bits; any number of threads and any instruction set draws the same. */
static void light_depends_on_nothing_else(void** state)
{
  tetra_case c;
  tetra_create(&c, 4, 0.2, 0.1, 2);
  tetra_camera(*state, &c, 4, 3, 0);
  tetra_draw(*state, &c, &picture);
  set_light(&c, 1);
  c.options.shade = 0;
  c.options.shading.ambient = NAN; /* not read */
  tetra_draw(*state, &c, &other);
  assert_memory_equal(picture.rgba, other.rgba, sizeof picture.rgba);
  set_light(&c, 1);
  c.transfer.gradient = thin;
  c.transfer.gradient_count = 3;
  tetra_draw(*state, &c, &picture);
  stratus_context* context = *state;
  const int threads = context->threads;
  for (int t = 1; t < 6; ++t) {
    context->threads = t;
    tetra_draw(context, &c, &other);
    assert_memory_equal(picture.rgba, other.rgba, sizeof picture.rgba);
  }
  context->threads = threads;
  const int isa = context->isa;
  for (context->isa = isa - 1; context->isa >= 0; --context->isa) {
    tetra_draw(context, &c, &other);
    assert_memory_equal(picture.rgba, other.rgba, sizeof picture.rgba);
  }
  context->isa = isa;
  tetra_destroy(&c);
}

static void wrong_light_is_refused(void** state)
{
  stratus_tetra_caster* caster = NULL;
  stratus_tetra_report report;
  tetra_case c;
  tetra_create(&c, 2, 0.2, 0.0, 1);
  tetra_camera(*state, &c, 2, 1, 0);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  static const char* const words[] = { "gradient_distance nan", "gradient_distance inf", "ambient is nan", "9 lights",
    "cannot be projected", "cannot be projected" };
  for (int wrong = 0; wrong < 6; ++wrong) {
    stratus_tetra_options o = c.options;
    stratus_transfer transfer = c.transfer;
    o.method = wrong > 3 ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_AUTO;
    o.shade = wrong < 5;
    o.gradient_distance = wrong == 0 ? (double)NAN : wrong == 1 ? (double)INFINITY : 0.0;
    o.shading.ambient = wrong == 2 ? NAN : 0.1;
    o.shading.light_count = wrong == 3 ? 9 : -1;
    transfer.gradient = thin;
    transfer.gradient_count = wrong == 5 ? 3 : 0;
    assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &transfer, &c.camera, &o, &image, NULL),
      wrong < 4 ? STRATUS_INVALID_ARGUMENT : STRATUS_UNSUPPORTED);
    if (!strstr(stratus_context_message(*state), words[wrong])) {
      print_error("%s\n", stratus_context_message(*state));
    }
    assert_non_null(strstr(stratus_context_message(*state), words[wrong]));
  }
  c.options.shade = 1;
  c.options.method = STRATUS_TETRA_METHOD_AUTO;
  for (int i = 0; i < 3; ++i) { /* gradients are made once for values, whatever the camera and the light */
    c.options.shading.ambient = 0.1 * i;
    assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, &report), STRATUS_OK);
    assert_int_equal(report.gradient_builds, 1);
    assert_int_equal(report.method, STRATUS_TETRA_METHOD_MARCH);
    assert_string_equal(report.why, "march: light and gradient opacity cannot be projected");
  }
  c.values[0] = 0.3f;
  ++c.mesh.revision;
  assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, &report), STRATUS_OK);
  assert_int_equal(report.gradient_builds, 2);
  assert_int_equal(report.mesh_builds, 1);
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&c);
}

/* Sets one of the things that decide where matter is; false if there are no more. */
static bool change(int number, stratus_mesh* m, stratus_transfer* t, stratus_tetra_options* o)
{
  static const double points[2] = { 0.1, 0.3 };
  static stratus_mesh blocks[2];
  static uint8_t bytes[2];
  switch (number) {
    case 0:
      m->hidden = bytes;
      break;
    case 1:
      m->labels = bytes;
      break;
    case 2:
      m->float_points = (const float*)points;
      break;
    case 3:
      m->lattice[1] = 3;
      break;
    case 4:
      m->type = STRATUS_FLOAT64;
      break;
    case 5:
      m->value_stride = 2;
      break;
    case 6:
      m->cell_values = !m->cell_values;
      break;
    case 7:
      ++m->revision;
      break;
    case 8:
      m->values = points;
      break;
    case 9:
      m->matrix[3] += 1.0;
      break;
    case 10:
      m->components = 2;
      m->value_stride = 2;
      break;
    case 11:
      o->mean_components = 1;
      break;
    case 12:
      o->dependent = 1;
      break;
    case 13:
      o->label_count = 1;
      break;
    case 14:
      o->mode = STRATUS_TETRA_ISOSURFACE;
      break;
    case 15:
      o->crop = 1;
      break;
    case 16:
      o->clip_plane_count = 1;
      break;
    case 17:
      t[0].unit_distance *= 2.0;
      break;
    case 18:
      m->blocks = blocks;
      m->block_count = 1;
      break;
    case 19:
      m->blocks = blocks;
      m->block_count = 2;
      break;
    case 20:
      blocks[0].hidden = bytes;
      m->blocks = blocks;
      m->block_count = 1;
      break;
    case 21:
      blocks[0].hidden = NULL;
      blocks[0].values = points;
      m->blocks = blocks;
      m->block_count = 1;
      break;
    default:
      return false;
  }
  return true;
}

/* Each change of matter gives another key, so that shadows are built anew. */
static void shadows_follow_all_that_absorbs(void** state)
{
  uint64_t keys[64];
  int count = 0;
  tetra_case c;
  (void)state;
  tetra_create(&c, 3, 0.2, 0.0, 1);
  keys[count++] = stratus_tetra_shadow_key(0, &c.mesh, &c.transfer, &c.options);
  for (bool more = true; more; ++count) {
    stratus_mesh mesh = c.mesh;
    stratus_transfer transfers[2] = { c.transfer, c.transfer };
    stratus_tetra_options options = c.options;
    more = change(count - 1, &mesh, transfers, &options);
    keys[count] = stratus_tetra_shadow_key(0, &mesh, transfers, &options);
    for (int i = 0; i < count && more; ++i) {
      if (keys[i] == keys[count]) {
        fail_msg("changes %d and %d have the same key", i - 1, count - 1);
      }
    }
  }
  assert_int_equal(count, 24);
  tetra_destroy(&c);
}

int test_tetra_light(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(shadows_follow_all_that_absorbs),
    cmocka_unit_test_setup_teardown(light_is_right, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(gradient_opacity_is_right, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(opaque_values_are_thinned, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(linear_field_has_one_light, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(lattices_are_lit_as_lists, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(light_depends_on_nothing_else, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(wrong_light_is_refused, tetra_start, tetra_stop),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
