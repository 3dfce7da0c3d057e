/* SPDX-License-Identifier: BSD-3-Clause
 * Labels of cells against the double-precision reference, in which each cell has the functions of its label: on random meshes with hollows,
 * values of points and of cells, lit and thinned by gradients, functions with peaks and opacity 1; lattices against their lists; labels
 * that change; and refused inputs. */
#include "tetra_light_case.h"

#include "faulty_allocator.h"
#include "tetra_caster.h"
#include "testing.h"

#define FUNCTIONS 4 /* of labels 0, 1, 2 and 3; cells have labels of up to 5 */
#define EDGE 4

typedef struct labelled {
  tetra_case c;
  stratus_transfer transfers[FUNCTIONS];
  double opacity[FUNCTIONS][6];
  uint8_t labels[6 * EDGE * EDGE * EDGE];
} labelled;

static tetra_picture picture, other;
static double reference[4 * TETRA_PIXELS_MOST];

/* Label 1 is a narrow peak, label 2 opaque from .7 on, and label 3 faint. */
static void create(stratus_context* context, labelled* l, double missing, uint32_t seed)
{
  static const double opacity[FUNCTIONS][6] = { { 0.2, 0.0, 0.5, 0.3, 1.0, 0.4 }, { 0.48, 0.0, 0.5, 0.9, 0.52, 0.0 },
    { 0.3, 0.0, 0.7, 1.0, 1.0, 1.0 }, { 0.0, 0.02, 0.6, 0.0, 1.0, 0.05 } };
  static const double colors[FUNCTIONS][8] = { { 0.0, 1.0, 0.2, 0.1, 1.0, 0.9, 0.9, 0.1 }, { 0.0, 0.1, 0.3, 1.0, 1.0, 0.2, 1.0, 0.4 },
    { 0.2, 0.9, 0.1, 0.8, 0.7, 0.3, 0.3, 0.3 }, { 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0 } };
  uint32_t random = seed + 11u;
  tetra_create(&l->c, EDGE, 0.2, missing, seed);
  memcpy(l->opacity, opacity, sizeof opacity);
  for (int f = 0; f < FUNCTIONS; ++f) {
    l->transfers[f] = stratus_transfer_default();
    l->transfers[f].opacity = l->opacity[f];
    l->transfers[f].opacity_count = 3;
    l->transfers[f].color = colors[f];
    l->transfers[f].color_count = 2;
  }
  for (int i = 0; i < 6 * EDGE * EDGE * EDGE; ++i) {
    l->labels[i] = (uint8_t)tetra_uniform(&random, 0.0, 5.999);
  }
  l->c.mesh.labels = l->labels;
  l->c.transfers = l->transfers;
  l->c.options.label_count = FUNCTIONS - 1;
  tetra_camera(context, &l->c, EDGE, (int)(seed % 8), seed & 1);
}

/* The default tolerance is a quarter of a step of 255. */
static void labels_are_right(void** state)
{
  static const double thin[2][6] = { { 0.1, 0.0, 0.5, 0.6, 1.2, 1.0 }, { 0.0, 1.0, 0.2, 0.3, 5.0, 0.9 } };
  for (uint32_t seed = 0; seed < 16; seed += few_run() ? 5 : 1) {
    labelled l;
    double largest;
    create(*state, &l, seed % 3 == 0 ? 0.25 : 0.0, seed);
    l.c.mesh.cell_values = seed % 5 == 4;
    l.c.options.shade = seed % 4 == 1;
    l.c.options.shading.specular = 0.3;
    if (seed % 4 > 1) { /* the other labels have the gradient opacity of label 0, or none */
      l.transfers[seed % 8 > 3 ? 0 : 3].gradient = thin[0];
      l.transfers[seed % 8 > 3 ? 0 : 3].gradient_count = 3;
      l.transfers[1].gradient = thin[1];
      l.transfers[1].gradient_count = 3;
      l.c.options.gradient_distance = seed % 4 == 3 ? 0.5 : 0.0;
    }
    tetra_reference_lit(&l.c, reference);
    tetra_draw(*state, &l.c, &picture);
    const double error = tetra_error(picture.rgba, reference, &largest);
    if (!(error < 0.255)) {
      print_error("seed %u: %.3f of 255, at most %.2f\n", seed, error, largest);
    }
    assert_true(error < 0.255);
    tetra_destroy(&l.c);
  }
}

static double difference(void)
{
  double most = 0.0;
  for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
    most = fmax(most, fabs((double)picture.rgba[i] - (double)other.rgba[i]));
  }
  return most;
}

/* A lattice has a label for each hexahedron, its list the same one for each of six tetrahedra. */
static void lattices_are_as_their_lists(void** state)
{
  for (uint32_t seed = 1; seed < 5; ++seed) {
    labelled l;
    create(*state, &l, 0.0, seed);
    l.c.options.shade = seed > 2;
    for (int i = 6 * EDGE * EDGE * EDGE - 1; i >= 0; --i) {
      l.labels[i] = l.labels[i / 6];
    }
    tetra_draw(*state, &l.c, &picture);
    for (int i = 0; i < EDGE * EDGE * EDGE; ++i) {
      l.labels[i] = l.labels[6 * i];
    }
    tetra_as_lattice(&l.c, EDGE);
    tetra_draw(*state, &l.c, &other);
    assert_true(difference() < 1e-4);
    tetra_destroy(&l.c);
  }
}

/* One caster draws other labels and functions, and none, as a new one does. Equal functions are as no labels. */
static void labels_change(void** state)
{
  stratus_tetra_caster* caster = NULL;
  stratus_tetra_report report;
  labelled l;
  create(*state, &l, 0.0, 3);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = other.rgba, .depth = other.depth };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int step = 0; step < 6; ++step) {
    if (step == 1) {
      l.labels[40] = 2;
      memset(l.labels + 100, 1, 50);
      ++l.c.mesh.revision;
    }
    l.opacity[3][1] = step >= 2 ? 0.2 : 0.02;
    l.c.options.label_count = step == 3 ? 0 : step == 4 ? 2 : FUNCTIONS - 1;
    l.c.mesh.labels = step == 3 ? NULL : l.labels;
    tetra_draw(*state, &l.c, &picture);
    assert_int_equal(stratus_tetra_caster_render(caster, &l.c.mesh, l.transfers, &l.c.camera, &l.c.options, &image, &report), STRATUS_OK);
    assert_memory_equal(picture.rgba, other.rgba, sizeof picture.rgba);
    assert_memory_equal(picture.depth, other.depth, sizeof picture.depth);
    assert_int_equal(report.mesh_builds, 1);
  }
  stratus_tetra_caster_destroy(caster);
  l.transfers[1] = l.transfers[2] = l.transfers[3] = l.transfers[0];
  tetra_draw(*state, &l.c, &picture);
  l.c.options.label_count = 0;
  tetra_draw(*state, &l.c, &other);
  assert_true(difference() < 1e-6);
  tetra_destroy(&l.c);
}

/* Labels after a picture without them, so that only their own memory is new. A failure leaves the caster ready, and no memory behind. */
static void allocations_may_fail(void** state)
{
  faulty_allocator allocator = { 0 };
  const stratus_context_options options = faulty_options(&allocator, "host");
  stratus_context* context = NULL;
  stratus_tetra_caster* caster = NULL;
  int refused = 0;
  labelled l;
  create(*state, &l, 0.0, 2);
  l.transfers[2].gradient = l.opacity[0];
  l.transfers[2].gradient_count = 3;
  tetra_draw(*state, &l.c, &picture);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = other.rgba };
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  for (bool reached = true; reached;) {
    stratus_tetra_options plain = l.c.options;
    plain.label_count = 0;
    assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
    assert_int_equal(stratus_tetra_caster_render(caster, &l.c.mesh, l.transfers, &l.c.camera, &plain, &image, NULL), STRATUS_OK);
    allocator.fail_at = allocator.calls + refused + 1;
    const stratus_status status = stratus_tetra_caster_render(caster, &l.c.mesh, l.transfers, &l.c.camera, &l.c.options, &image, NULL);
    reached = allocator.calls >= allocator.fail_at;
    allocator.fail_at = 0;
    assert_int_equal(status, reached ? STRATUS_OUT_OF_MEMORY : STRATUS_OK);
    refused += reached;
    assert_int_equal(stratus_tetra_caster_render(caster, &l.c.mesh, l.transfers, &l.c.camera, &l.c.options, &image, NULL), STRATUS_OK);
    assert_memory_equal(picture.rgba, other.rgba, sizeof picture.rgba);
    stratus_tetra_caster_destroy(caster);
  }
  assert_true(refused > FUNCTIONS);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
  tetra_destroy(&l.c);
}

static void wrong_labels_are_refused(void** state)
{
  static const char* const words[] = { "label_count 256 of a mesh with labels, must be 0..255", "label_count 3 of a mesh without labels",
    "label_count -1", "labels in mode maximum of a mesh of 1 components", "labels in mode composite of a mesh of 2 components",
    "labels cannot be projected", "opacity" };
  stratus_tetra_caster* caster = NULL;
  stratus_tetra_report report;
  labelled l;
  create(*state, &l, 0.0, 1);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int wrong = 0; wrong < 7; ++wrong) {
    stratus_mesh mesh = l.c.mesh;
    stratus_tetra_options o = l.c.options;
    o.label_count = wrong == 0 ? 256 : wrong == 2 ? -1 : 3;
    o.mode = wrong == 3 ? STRATUS_TETRA_MAXIMUM : STRATUS_TETRA_COMPOSITE;
    o.method = wrong == 5 ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_AUTO;
    mesh.labels = wrong == 1 ? NULL : mesh.labels;
    mesh.components = wrong == 4 ? 2 : 1;
    mesh.value_stride = mesh.components;
    l.transfers[3].opacity_count = wrong == 6 ? 0 : 3;
    assert_int_equal(stratus_tetra_caster_render(caster, &mesh, l.transfers, &l.c.camera, &o, &image, NULL),
      wrong < 3 || wrong == 6 ? STRATUS_INVALID_ARGUMENT : STRATUS_UNSUPPORTED);
    if (!strstr(stratus_context_message(*state), words[wrong])) {
      print_error("%s\n", stratus_context_message(*state));
    }
    assert_non_null(strstr(stratus_context_message(*state), words[wrong]));
  }
  l.transfers[3].opacity_count = 3;
  l.c.options.method = STRATUS_TETRA_METHOD_AUTO;
  assert_int_equal(stratus_tetra_caster_render(caster, &l.c.mesh, l.transfers, &l.c.camera, &l.c.options, &image, &report), STRATUS_OK);
  assert_string_equal(report.why, "march: labels cannot be projected");
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&l.c);
}

int test_tetra_labels(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(labels_are_right, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(lattices_are_as_their_lists, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(labels_change, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(allocations_may_fail, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(wrong_labels_are_refused, tetra_start, tetra_stop),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
