/* SPDX-License-Identifier: BSD-3-Clause
 * Label maps, compared with the double reference; the entries of their tables and of components' tables; and the arrays that unlit pictures
 * do not read. */
#include "components_case.h"

#include "ray_caster.h"
#include "volume.h"

static picture other;

/* Sets four labels in blobs, one of them without functions of its own. */
static void set_labels(many* m, uint8_t* labels)
{
  static const double colors[3][4] = { { 0, 1, 0.2, 0.1 }, { 0, 0.1, 0.9, 0.3 }, { 0, 0.2, 0.3, 1 } };
  const int64_t* n = m->c.volume.dimensions;
  for (int64_t v = 0; v < n[0] * n[1] * n[2]; ++v) {
    const int64_t x = v % n[0], y = v / n[0] % n[1], z = v / n[0] / n[1];
    labels[v] = (uint8_t)((x / 7 + y / 5 + z / 6) % 4);
  }
  m->transfers[1] = m->transfers[2] = m->transfers[0];
  m->transfers[1].color = colors[0];
  m->transfers[2].color = colors[1];
  m->transfers[1].color_count = m->transfers[2].color_count = 1;
  m->transfers[2].unit_distance = 0.4;
  m->c.options.mask.bytes = labels;
  m->c.options.mask.label_count = 2;
}

static void labels_have_colours_and_opacities_of_their_own(void** state)
{
  (void)state;
  static uint8_t labels[24 * 22 * 26];
  stratus_context* context = case_context("host", 2);
  for (int type = STRATUS_UINT8; type <= STRATUS_FLOAT64; type += 4) { /* uint8, uint32, float64 */
    many m;
    float reference[4 * CASE_PIXELS_MOST];
    many_create(context, &m, (stratus_type)type, 1, 24, 22, 26, 60u + (uint32_t)type);
    many_draw(context, &m, &other);
    set_labels(&m, labels);
    m.c.volume.cell_centered = type == STRATUS_UINT32;
    m.c.options.light.shade = type == STRATUS_FLOAT64;
    const double scale = case_type_values[type].scale;
    const double thin[2][4] = { { 0.0, 0.3, 0.3 * scale, 1.0 }, { 0.02 * scale, 1.0, 0.2 * scale, 0.1 } };
    for (int l = 0; l < 2; ++l) { /* label 1 has its own gradient opacity; label 2 uses the one of no label, if there is one */
      m.transfers[l].gradient = thin[l];
      m.transfers[l].gradient_count = type == STRATUS_FLOAT64 || (type == STRATUS_UINT32 && l == 1) ? 2 : 0;
    }
    m.c.options.optics.gradient_distance = type == STRATUS_FLOAT64 ? 2.0 : 0.0;
    m.c.options.sampling.distance = 0.02; /* labels are steps, where the samples' error is of first order */
    reference_scene scene = case_scene(&m.c);
    scene.transfer = m.transfers;
    scene.labels = labels;
    scene.label_count = 2;
    scene.gradient_distance = m.c.options.optics.gradient_distance;
    scene.shading = m.c.options.light.shade ? &m.c.options.light.shading : NULL;
    many_draw(context, &m, &drawn);
    assert_int_equal(reference_render(&scene, CASE_WIDTH, CASE_HEIGHT, 1.0 / 64, reference, NULL), 0);
    const double db = reference_psnr(drawn.rgba, reference, CASE_PIXELS);
    print_message("             labels over %s: %.1f dB, %d pixels\n", case_type_names[type], db, case_lit(&drawn));
    assert_true(case_lit(&drawn) > case_share(200));
    assert_true(db >= 60.0);
    for (int s = STRATUS_STRUCTURE_NONE; s <= STRATUS_STRUCTURE_HYBRID; ++s) {
      m.c.options.skipping.structure = (stratus_structure)s;
      many_draw(context, &m, &other);
      assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    }
    m.c.options.mask.label_count = 0; /* the same bytes as a mask, then none */
    many_draw(context, &m, &other);
    assert_memory_not_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

/* Tables of components and labels have as many entries as the tolerance needs, or as many as fit for all labels. */
static void components_and_labels_take_the_entries_of_the_tolerance(void** state)
{
  (void)state;
  static const double tolerances[] = { 0.01, 0.001, 0.0001, 0.00001 };
  static uint8_t labels[9 * 8 * 7];
  stratus_context* context = case_context("host", 2);
  for (int kind = 0; kind < 4; ++kind) { /* independent and dependent components, labels, very many labels */
    const int components = kind < 2 ? 2 : 1;
    many m;
    many_create(context, &m, STRATUS_FLOAT32, components, 9, 8, 7, 67);
    m.c.options.optics.dependent = kind == 1;
    m.c.options.sampling.distance = 0.5;
    m.c.options.sampling.rule = STRATUS_SAMPLING_AUTO; /* by hand, there is no tolerance */
    stratus_transfer transfers[256];
    if (kind >= 2) {
      set_labels(&m, labels);
    }
    for (int t = 0; t < 256; ++t) {
      transfers[t] = m.transfers[t < 2 ? t : kind < 2 ? 0 : 2];
    }
    m.c.options.mask.label_count = kind == 3 ? 255 : m.c.options.mask.label_count;
    for (size_t t = kind == 3 ? 3 : 0; t < sizeof tolerances / sizeof *tolerances; ++t) {
      const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
      stratus_ray_caster* caster = NULL;
      m.c.options.sampling.tolerance = tolerances[t];
      assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
      assert_int_equal(stratus_ray_caster_render(caster, &m.c.volume, transfers, &m.c.camera, &m.c.options, &image, NULL), STRATUS_OK);
      const stratus_ray_shading_tables* tables = &caster->optics.shading_tables;
      const int wanted = stratus_table_entries_for(STRATUS_SAMPLING_MIDPOINT, tolerances[t]);
      assert_true(wanted >= (t < 2 ? 4096 : t == 2 ? 32768 : 65536));
      for (int i = 0; i < (kind < 2 ? components : tables->label_tables_count); ++i) {
        const stratus_table* table = kind < 2 ? tables->tables[i] : tables->label_tables[i];
        assert_true(table->size >= (kind == 3 && wanted > 8192 ? 8192 : wanted));
      }
      stratus_ray_caster_destroy(caster);
    }
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

/* Gradient opacity, labels and components share their arguments with the light, which is not checked where nothing is lit. */
static void a_count_of_lights_beyond_any_changes_nothing_where_nothing_is_lit(void** state)
{
  (void)state;
  static const double steep[] = { 0.05, 0.0, 0.2, 0.4, 0.45, 1.0 };
  static const int counts[] = { 9, 1024, INT32_MAX, -2, INT32_MIN };
  static uint8_t labels[24 * 22 * 26];
  stratus_context* context = case_context("host", 2);
  for (int kind = 0; kind < 4; ++kind) {
    many m;
    many_create(context, &m, STRATUS_UINT8, kind == 1 ? 2 : 1, 24, 22, 26, 91);
    m.transfers[0].gradient = steep;
    m.transfers[0].gradient_count = kind == 0 ? 3 : 0;
    if (kind == 2) {
      set_labels(&m, labels);
    }
    if (kind == 3) {
      m.c.options.mode = STRATUS_MODE_FIRST_HIT;
      m.c.options.light.shading.on = 0;
    }
    many_draw(context, &m, &other);
    assert_true(case_lit(&other) > case_share(50));
    for (size_t i = 0; i < sizeof counts / sizeof *counts; ++i) {
      m.c.options.light.shading.light_count = counts[i];
      many_draw(context, &m, &drawn);
      assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    }
    m.c.options.light.shading.on = m.c.options.light.shade = 1;
    m.c.options.light.shading.light_count = 9;
    assert_int_equal(many_status(context, &m, &drawn), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(context), "9 lights"));
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

int test_ray_labels(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(labels_have_colours_and_opacities_of_their_own),
    cmocka_unit_test(components_and_labels_take_the_entries_of_the_tolerance),
    cmocka_unit_test(a_count_of_lights_beyond_any_changes_nothing_where_nothing_is_lit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
