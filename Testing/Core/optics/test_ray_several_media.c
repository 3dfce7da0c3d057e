/* SPDX-License-Identifier: BSD-3-Clause
 * Volumes among several that show more than one value's colour and opacity: components, label maps, functions of two variables. Against the
 * double reference with several fields, against the picture of one volume, and to the bit where nothing may change a bit. */
#include "components_case.h"
#include "several_case.h"
#include "transfer_2d_case.h"
#include "testing.h"

/* dB against the reference at steps of a fifth of a unit, where voxels are .5 to 2.5 units. */
#define MEDIA_DB 60.0

static picture other;
static transfer_2d_case function;
static uint8_t labels[24 * 22 * 26];

/* A volume with `components`, in place of one of a case. Its values are kept by `of`. */
static void take_many(stratus_context* context, several_case* m, int n, many* of, stratus_type type, int components, uint32_t seed)
{
  const stratus_ray_cast_options options = m->of[n].options;
  const stratus_camera camera = m->of[n].camera;
  many_create(context, of, type, components, 24, 22, 26, seed);
  case_destroy(&m->of[n]);
  m->of[n] = of->c;
  m->of[n].options = options;
  m->of[n].options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  m->of[n].options.sampling.distance = 0.2;
  m->of[n].camera = camera;
  several_place(&m->of[n], seed + 17u * (uint32_t)n);
  for (int c = 0; c < COMPONENTS; ++c) { /* the first component uses the moved case's points */
    of->transfers[c].unit_distance *= 2.0;
    of->transfers[c].opacity = m->of[n].opacity;
  }
  of->transfers[0].color = m->of[n].color;
  m->transfers[n] = of->transfers;
}

/* The values that take_many() kept go with the case, but for the interleaved ones. */
static void destroy(several_case* m, many* of)
{
  free(of->values);
  several_destroy(m);
}

/* Structures and threads. */
static void expect_no_bit_changed(stratus_context* context, several_case* m)
{
  m->of[0].options.skipping.audit = 1;
  for (int structure = STRATUS_STRUCTURE_NONE; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
    for (int n = 0; n < m->count; ++n) {
      m->of[n].options.skipping.structure = (stratus_structure)structure;
    }
    several_draw(context, m, &other);
    assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    assert_memory_equal(drawn.depth, other.depth, sizeof drawn.depth);
    assert_int_equal(other.report.differing_pixels, 0);
  }
}

static void components_mix_as_the_reference_does(void** state)
{
  static const stratus_type types[] = { STRATUS_FLOAT32, STRATUS_UINT8, STRATUS_INT16, STRATUS_FLOAT64, STRATUS_UINT8, STRATUS_UINT8 };
  static const int counts[] = { 2, 3, 4, 3, 2, 4 }, dependent[] = { 0, 0, 0, 0, 1, 1 };
  for (int i = 0; i < 6; i += few_run() ? 2 : 1) {
    several_case m;
    many of;
    char what[64];
    several_create(*state, &m, 2 + i % 2, 800 + (uint32_t)i);
    take_many(*state, &m, i % 2, &of, types[i], counts[i], 41u + (uint32_t)i);
    picture_case* c = &m.of[i % 2];
    stratus_material materials[4] = { { 0 }, { 1, 0.2, 0.7, 0.3, 8.0 }, { 1, 0.5, 0.5, 0.0, 1.0 }, { 0 } };
    c->options.optics.dependent = dependent[i];
    c->options.light.materials = i == 2 ? materials : NULL;
    c->options.optics.mean_components = i == 3;
    c->options.light.shade = i == 0;
    snprintf(what, sizeof what, "%d %s components%s", counts[i], dependent[i] ? "dependent" : "independent", i == 3 ? ", their mean" : "");
    assert_true(several_psnr(what, *state, &m, &drawn) >= MEDIA_DB);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    expect_no_bit_changed(*state, &m);
    destroy(&m, &of);
  }
}

static void labels_mix_as_the_reference_does(void** state)
{
  static const double colors[2][4] = { { 0, 1, 0.2, 0.1 }, { 0, 0.1, 0.9, 0.3 } };
  for (size_t v = 0; v < sizeof labels; ++v) {
    labels[v] = (uint8_t)((v % 24 / 7 + v / 24 % 22 / 5 + v / 24 / 22 / 6) % 4);
  }
  for (int i = 0; i < 3; i += few_run() ? 2 : 1) {
    several_case m;
    many of;
    several_create(*state, &m, 2, 820 + (uint32_t)i);
    take_many(*state, &m, i % 2, &of, i == 1 ? STRATUS_UINT16 : STRATUS_FLOAT32, 1, 61u + (uint32_t)i);
    picture_case* c = &m.of[i % 2];
    of.transfers[1] = of.transfers[2] = of.transfers[0];
    for (int l = 0; l < 2; ++l) {
      of.transfers[1 + l].color = colors[l];
      of.transfers[1 + l].color_count = 1;
    }
    const double steep = 0.3 * case_type_values[c->volume.type].scale, thin[4] = { 0.0, 0.3, steep, 1.0 };
    of.transfers[1].gradient = thin;
    of.transfers[1].gradient_count = i == 2 ? 2 : 0;
    c->options.mask.bytes = labels;
    c->options.mask.label_count = 2;
    c->options.light.shade = i == 1;
    for (int n = 0; n < 2; ++n) {
      m.of[n].options.sampling.distance = 0.02; /* labels are steps, where the samples' error is of first order */
    }
    assert_true(several_psnr("labels", *state, &m, &drawn) >= 54.0);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    expect_no_bit_changed(*state, &m);
    destroy(&m, &of);
  }
}

static void functions_of_two_variables_mix_as_the_reference_does(void** state)
{
  for (int i = 0; i < 4; i += few_run() ? 3 : 1) {
    several_case m;
    const int n = i % 2;
    several_create(*state, &m, 2, 840 + (uint32_t)i);
    function.pairs = NULL;
    if (i >= 2) {
      transfer_2d_case_pair(&m.of[n], &function, 77u + (uint32_t)i);
    }
    transfer_2d_case_set(&m.of[n], &function, 12u + (uint32_t)i, 0.25);
    function.of.unit_distance = 3.0;
    m.of[n].options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
    m.of[n].options.sampling.distance = 0.1;
    m.of[n].options.light.shade = i % 3 == 0;
    assert_true(several_psnr(i < 2 ? "value and gradient" : "two values", *state, &m, &drawn) >= 56.0);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    expect_no_bit_changed(*state, &m);
    free(function.pairs);
    several_destroy(&m);
  }
}

/* With a volume that shows nothing the picture is the ordinary one but for rounding. */
static void an_empty_volume_changes_nothing(void** state)
{
  for (int i = 0; i < 3; ++i) {
    several_case m;
    many of;
    float largest = 0.0f;
    several_create(*state, &m, 2, 860);
    take_many(*state, &m, 0, &of, STRATUS_UINT8, i == 1 ? 1 : 2, 71);
    of.c = m.of[0];
    of.transfers[1].opacity = of.transfers[0].opacity;
    if (i == 1) {
      m.of[0].options.mask.bytes = of.c.options.mask.bytes = labels;
      m.of[0].options.mask.label_count = of.c.options.mask.label_count = 2;
      of.transfers[1] = of.transfers[2] = of.transfers[0];
      of.transfers[2].unit_distance = 0.4;
    }
    if (i == 2) {
      transfer_2d_case_set(&m.of[0], &function, 3, 0.25);
      of.c.options.optics.transfer_2d = &function.of;
    }
    m.of[1].transfer.opacity_count = 1;
    m.of[1].opacity[1] = 0.0;
    several_draw(*state, &m, &drawn);
    many_draw(*state, &of, &other);
    for (int p = 0; p < 4 * CASE_PIXELS; ++p) {
      largest = fmaxf(largest, fabsf(drawn.rgba[p] - other.rgba[p]));
    }
    print_message("             with an empty one: %g\n", (double)largest);
    assert_true(case_lit(&drawn) > case_share(50));
    assert_true(largest < 4e-6f);
    destroy(&m, &of);
  }
}

/* Automatic steps keep the tolerance of the whole picture. */
static void automatic_sampling_keeps_the_tolerance(void** state)
{
  for (uint32_t seed = 0; seed < 3; seed += few_run() ? 2 : 1) {
    several_case m;
    many of;
    several_create(*state, &m, 2, 880 + seed);
    take_many(*state, &m, 0, &of, STRATUS_FLOAT32, 2 + (int)seed, 81u + seed);
    m.of[0].options = m.of[1].options = stratus_ray_cast_options_default();
    assert_true(several_psnr("automatic", *state, &m, &drawn) >= 60.0);
    destroy(&m, &of);
  }
}

int test_ray_several_media(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(components_mix_as_the_reference_does),
    cmocka_unit_test(labels_mix_as_the_reference_does),
    cmocka_unit_test(functions_of_two_variables_mix_as_the_reference_does),
    cmocka_unit_test(an_empty_volume_changes_nothing),
    cmocka_unit_test(automatic_sampling_keeps_the_tolerance),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
