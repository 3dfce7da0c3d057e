/* SPDX-License-Identifier: BSD-3-Clause
 * Volumes that are larger than the device's largest allocation, which the test sets to a small number. Pictures from pages equal the whole
 * volume's to the bit, in every rule and mode. Pages are sent once, and again only if more blocks show. The host draws volumes that do not
 * fit, and the report says why. With the argument `--tiny` the test draws a few rays: enough for a simulator to see the kernels. */
#include "gradients.h"
#include "structures.h"

#include "device_pair.h"

/* So large that the transfer function's tables fit what is taken for the largest allocation. */
#define SIDES 126, 130, 134
#define VALUES (126 * 130 * 134)
#define LOCAL_TABLE_BYTES 400000
/* With --tiny: of the volume, which the tables of types of one byte fit, and of the picture. */
#define TINY_SIDES 74, 75, 74
#define TINY_PICTURE 8

static picture whole, paged;
static uint8_t labels[VALUES];
static float* own_gradients; /* of the last case; NULL: none */

/* One picture of the pages' test. */
typedef struct page_case {
  const char* name;
  stratus_type type;
  stratus_mode mode;
  stratus_sampling sampling;
  stratus_interpolation interpolation;
  stratus_structure structure;
  double sample_distance;
  int dense;   /* 1: most blocks show, so that the pages fill several slabs */
  int divisor; /* the largest allocation is the volume's bytes over this */
  int shade, components, centered, ghosts, label_count;
  int gradients; /* 1: the volume has its own */
  int shadows;   /* 1: light from one side, which matter absorbs */
} page_case;

/* clang-format off */
#define LINEAR STRATUS_INTERPOLATION_LINEAR
#define DISTANCE STRATUS_STRUCTURE_DISTANCE
#define COMPOSITE STRATUS_MODE_COMPOSITE
#define NEAREST STRATUS_INTERPOLATION_NEAREST
#define MIDPOINT STRATUS_SAMPLING_MIDPOINT
#define PREINTEGRATED STRATUS_SAMPLING_PREINTEGRATED
#define CELLS STRATUS_SAMPLING_CELLS
static const page_case cases[] = {
  { "midpoint", STRATUS_UINT8, COMPOSITE, MIDPOINT, LINEAR, DISTANCE, .7, .divisor = 3 },
  { "midpoint, dense", STRATUS_INT16, COMPOSITE, MIDPOINT, LINEAR, STRATUS_STRUCTURE_NONE, .7, .dense = 1, .divisor = 2 },
  { "pre-integrated, long", STRATUS_FLOAT32, COMPOSITE, PREINTEGRATED, LINEAR, DISTANCE, 7.3, .divisor = 3 },
  { "pre-integrated", STRATUS_FLOAT64, COMPOSITE, PREINTEGRATED, LINEAR, STRATUS_STRUCTURE_OCTANT, 1.3, .divisor = 3, .centered = 1,
    .ghosts = 1 },
  { "pre-integrated, bytes", STRATUS_UINT8, COMPOSITE, PREINTEGRATED, LINEAR, DISTANCE, .9, .divisor = 1 },
  { "cells", STRATUS_UINT16, COMPOSITE, CELLS, LINEAR, STRATUS_STRUCTURE_BLOCK, 0, .divisor = 3 },
  { "nearest", STRATUS_INT64, COMPOSITE, MIDPOINT, NEAREST, DISTANCE, .9, .divisor = 4 },
  { "cells, nearest", STRATUS_FLOAT32, COMPOSITE, CELLS, NEAREST, DISTANCE, 0, .divisor = 3 },
  { "lit", STRATUS_INT8, COMPOSITE, MIDPOINT, LINEAR, DISTANCE, .8, .divisor = 2, .shade = 1 },
  { "lit, cells", STRATUS_FLOAT32, COMPOSITE, CELLS, LINEAR, DISTANCE, 0, .divisor = 3, .shade = 1 },
  { "lit, pre-integrated, nearest", STRATUS_UINT32, COMPOSITE, PREINTEGRATED, NEAREST, DISTANCE, 1.1, .divisor = 3, .shade = 1 },
  { "lit by gradients of its own", STRATUS_FLOAT32, COMPOSITE, MIDPOINT, LINEAR, DISTANCE, .8, .divisor = 1, .shade = 1, .gradients = 1 },
  { "two components", STRATUS_UINT8, COMPOSITE, MIDPOINT, LINEAR, DISTANCE, .8, .divisor = 2, .shade = 1, .components = 2 },
  { "labels", STRATUS_UINT16, COMPOSITE, MIDPOINT, LINEAR, DISTANCE, .8, .divisor = 1, .label_count = 1 },
  { "maximum", STRATUS_UINT8, STRATUS_MODE_MAXIMUM, MIDPOINT, LINEAR, DISTANCE, .8, .divisor = 2 },
  { "minimum", STRATUS_INT32, STRATUS_MODE_MINIMUM, MIDPOINT, LINEAR, STRATUS_STRUCTURE_NONE, .8, .divisor = 2 },
  { "average", STRATUS_UINT8, STRATUS_MODE_AVERAGE, MIDPOINT, LINEAR, DISTANCE, .8, .divisor = 2 },
  { "additive", STRATUS_UINT64, STRATUS_MODE_ADDITIVE, MIDPOINT, LINEAR, DISTANCE, .8, .divisor = 3 },
  { "isosurface", STRATUS_FLOAT32, STRATUS_MODE_ISOSURFACE, MIDPOINT, LINEAR, DISTANCE, .8, .divisor = 3 },
  { "two components, lit by gradients of their own", STRATUS_FLOAT32, COMPOSITE, MIDPOINT, LINEAR, DISTANCE, .8, .divisor = 1, .shade = 1,
    .components = 2, .gradients = 1 },
  { "shadows", STRATUS_UINT8, COMPOSITE, CELLS, LINEAR, DISTANCE, 0, .divisor = 1, .shade = 1, .shadows = 1 },
};
/* clang-format on */

static void set_peak(picture_case* c, double at)
{
  const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
  const double peak[8] = { base + at * scale, 0, base + (at + .03) * scale, 0.8, base + (at + .06) * scale, 0, base + 2 * scale, 0 };
  memcpy(c->opacity, peak, sizeof peak);
}

static void make_case(const page_case* p, uint32_t seed, picture_case* c)
{
  if (tiny) {
    case_create(host_context, c, p->type, TINY_SIDES, seed);
  } else {
    case_create(host_context, c, p->type, SIDES, seed);
  }
  const double base = case_type_values[p->type].base, scale = case_type_values[p->type].scale;
  const double shown = tiny && p->mode != STRATUS_MODE_MAXIMUM ? 0.4 : 0.62; /* few values reach it */
  if (!p->dense) {
    set_peak(c, p->mode == STRATUS_MODE_MINIMUM ? -0.5 : p->sample_distance > 2.0 ? 0.75 : shown);
  }
  c->options.mode = p->mode;
  c->options.sampling.rule = p->sampling;
  c->options.sampling.interpolation = p->interpolation;
  c->options.skipping.structure = p->structure;
  c->options.sampling.distance = p->sample_distance;
  c->options.sampling.cell_error = p->sampling == CELLS ? 0.01 : 0.0;
  c->options.light.shade = p->shade;
  c->options.light.shading.specular = 0.3;
  c->options.light.shading.shadows = p->shadows;
  if (p->shadows) {
    c->options.sampling.tolerance = 0.2; /* maps of light that fit the allocation */
    c->options.light.shading.light_count = 1;
    c->options.light.shading.lights[0] = (stratus_light){ .vector = { 0.3, -0.5, 1.0 }, .color = { 1.0, 1.0, 1.0 } };
  }
  c->options.optics.contour_count = 1;
  c->options.optics.contours[0] = base + 0.65 * scale;
  c->options.optics.average_range[0] = base + shown * scale;
  c->options.optics.average_range[1] = base + 0.8 * scale;
  c->volume.cell_centered = p->centered;
  if (p->components) { /* every second value the other component */
    c->volume.dimensions[0] /= 2;
    c->volume.components = p->components;
    c->volume.value_stride = p->components;
  }
  free(own_gradients);
  own_gradients = p->gradients ? gradients_set(&c->volume, p->components < 2) : NULL;
  if (p->ghosts) {
    c->cell_ghosts = calloc(VALUES, 1);
    for (int i = VALUES / 2; i < VALUES / 2 + 20000; i += 7) {
      c->cell_ghosts[i] = STRATUS_GHOST_HIDDEN_CELL;
    }
    c->volume.cell_ghosts = c->cell_ghosts;
  }
  if (p->label_count) {
    for (size_t v = 0; v < sizeof labels; ++v) {
      labels[v] = (uint8_t)(v / 5 % 3);
    }
    c->options.mask.bytes = labels;
    c->options.mask.label_count = p->label_count;
  }
  case_camera(host_context, c, (int)(seed % 8), 0);
}

static size_t volume_bytes(const picture_case* c)
{
  const int64_t* n = c->volume.dimensions;
  return (size_t)(n[0] * n[1] * n[2] * c->volume.value_stride) * stratus_type_size(c->volume.type);
}

static void render(stratus_ray_caster* caster, const picture_case* c, picture* p)
{
  static const double green[] = { 0, 0, 1, 0 };
  stratus_transfer functions[2] = { c->transfer, c->transfer }; /* of the second component, or of a label */
  functions[1].color = green;
  functions[1].color_count = 1;
  const stratus_image image = { .width = tiny ? TINY_PICTURE : CASE_WIDTH,
    .height = tiny ? TINY_PICTURE : CASE_HEIGHT,
    .rgba = p->rgba,
    .depth = p->depth,
    .samples = p->samples };
  const stratus_status status = stratus_ray_caster_render(caster, &c->volume, functions, &c->camera, &c->options, &image, &p->report);
  if (status != STRATUS_OK) {
    print_error("%s\n", stratus_context_message(device));
  }
  assert_int_equal(status, STRATUS_OK);
}

static void assert_same(const char* name)
{
  int other = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    other += memcmp(whole.rgba + 4 * i, paged.rgba + 4 * i, 4 * sizeof(float)) != 0 || whole.samples[i] != paged.samples[i] ||
      memcmp(whole.depth + i, paged.depth + i, sizeof(float)) != 0;
  }
  if (other) {
    fail_msg("%s: %d pixels of %d lit ones differ from the whole volume's; %s", name, other, case_lit(&whole), paged.report.why);
  }
  assert_int_equal(whole.report.samples, paged.report.samples);
  assert_int_equal(whole.report.skipped, paged.report.skipped);
  assert_int_equal(whole.report.lookups, paged.report.lookups);
}

static void render_alone(const picture_case* c, size_t largest, picture* p)
{
  stratus_ray_caster* caster = NULL;
  const size_t before = device->device->largest_allocation;
  device->device->largest_allocation = largest ? largest : before;
  assert_int_equal(stratus_ray_caster_create(device, &caster), STRATUS_OK);
  render(caster, c, p);
  stratus_ray_caster_destroy(caster);
  device->device->largest_allocation = before;
}

static void compare(const page_case* p, const picture_case* c)
{
  render_alone(c, 0, &whole);
  assert_null(strstr(whole.report.why, "pages"));
  assert_true(case_lit(&whole) > (tiny ? 3 : 50));
  const size_t largest = (volume_bytes(c) - 1) / (size_t)(tiny ? 1 : p->divisor);
  render_alone(c, p->gradients && p->components ? largest + largest / 2 : largest, &paged); /* four planes a component, in four slabs */
  if (!strstr(paged.report.why, "the device has ")) {
    fail_msg("%s: %s", p->name, paged.report.why);
  }
  assert_same(p->name);
}

static void pages_draw_the_whole_volumes_bits(void** state)
{
  const bool one_ray = *(const bool*)*state;
  device->device->is_cpu = !one_ray;
  device->device->builds = !tiny; /* other tests show a simulator what builds */
  for (uint32_t i = one_ray && !tiny; i < COUNT_OF(cases); i += tiny ? 1 : few_run() ? 20 : one_ray ? 3 : 1) {
    picture_case c;
    if (tiny && cases[i].type > STRATUS_UINT8) {
      continue;
    }
    make_case(&cases[i], 40 + i, &c);
    compare(&cases[i], &c);
    print_message("             %s: %s\n", cases[i].name, strstr(paged.report.why, "the device has "));
    case_destroy(&c);
  }
  device->device->is_cpu = true;
}

static void pages_serve_the_local_rule(void** state)
{
  static const page_case local = { "local", .divisor = 1 };
  (void)state;
  int compared = 0;
  for (uint32_t seed = 540; compared < (few_run() ? 1 : 3); ++seed) {
    picture_case c;
    case_create_local(host_context, seed, &c);
    if (c.volume.type != STRATUS_FLOAT64 && volume_bytes(&c) > LOCAL_TABLE_BYTES) { /* doubles may be kept as floats */
      compare(&local, &c);
      assert_int_equal(whole.report.sampling, STRATUS_SAMPLING_LOCAL);
      assert_int_equal(paged.report.sampling, STRATUS_SAMPLING_LOCAL);
      ++compared;
    }
    case_destroy(&c);
  }
}

/* Draws what `caster` has pages of, and the whole volume by a caster of its own. Returns the uploads of the first. */
static uint64_t draw_both(stratus_ray_caster* caster, const picture_case* c, size_t largest, const char* name)
{
  const size_t before = device->device->largest_allocation;
  const uint64_t uploads = paged.report.uploads;
  render_alone(c, 0, &whole);
  device->device->largest_allocation = largest;
  render(caster, c, &paged);
  device->device->largest_allocation = before;
  assert_same(name);
  assert_true(case_lit(&whole) > case_share(50));
  return paged.report.uploads - uploads;
}

static int count_stage(const char* name)
{
  stratus_build_stage stages[STRATUS_BUILD_STAGES_MAX];
  const int count = stratus_context_get_build_report(device, stages, STRATUS_BUILD_STAGES_MAX);
  int found = 0;
  for (int i = 0; i < count; ++i) {
    found += strcmp(stages[i].name, name) == 0;
  }
  return found;
}

static void pages_are_sent_once_and_anew_where_more_shows(void** state)
{
  static const page_case first = {
    .type = STRATUS_FLOAT32, .sampling = PREINTEGRATED, .structure = STRATUS_STRUCTURE_DISTANCE, .sample_distance = 0.7
  };
  stratus_ray_caster* caster = NULL;
  picture_case c;
  (void)state;
  make_case(&first, 77, &c);
  const size_t largest = volume_bytes(&c) / 2;
  assert_int_equal(stratus_ray_caster_create(device, &caster), STRATUS_OK);
  paged.report.uploads = 0;
  stratus_context_start_build_report(device);
  const uint64_t at_first = draw_both(caster, &c, largest, "first");
  assert_int_equal(count_stage("pages of values"), 1);
  case_camera(host_context, &c, 3, 0);
  stratus_context_start_build_report(device);
  assert_int_equal(draw_both(caster, &c, largest, "another view"), 0);
  assert_int_equal(count_stage("pages of values"), 0);
  c.options.sampling.distance = 9.0; /* segments end farther from visible blocks; the table of sums serves */
  assert_true(draw_both(caster, &c, largest, "longer segments") >= 2);
  assert_int_equal(count_stage("pages of values"), 1);
  c.options.sampling.distance = 0.8;
  assert_int_equal(draw_both(caster, &c, largest, "shorter segments"), 0);
  set_peak(&c, 0.5);
  assert_true(draw_both(caster, &c, largest, "another peak") >= 4); /* slabs, page table, map, table */
  assert_int_equal(count_stage("pages of values"), 1);
  c.opacity[3] = 0.5;                                                     /* the same blocks */
  assert_int_equal(draw_both(caster, &c, largest, "another opacity"), 2); /* map and table */
  stratus_context_start_build_report(device);
  const double base = case_type_values[c.volume.type].base, scale = case_type_values[c.volume.type].scale;
  c.opacity[4] = base + 0.54 * scale; /* some of them */
  assert_int_equal(draw_both(caster, &c, largest, "a narrower peak"), 2);
  assert_int_equal(count_stage("pages of values"), 0);
  case_store(c.values, c.volume.type, 100000, base + 0.52 * scale); /* new values */
  ++c.volume.revision;
  assert_true(draw_both(caster, &c, largest, "new values") >= 4);
  assert_int_equal(count_stage("pages of values"), 1);
  stratus_context_start_build_report(device);
  draw_both(caster, &c, volume_bytes(&c), "the whole volume fits");
  assert_null(strstr(paged.report.why, "pages"));
  assert_int_equal(count_stage("pages of values"), 0);
  draw_both(caster, &c, largest, "pages again");
  assert_int_equal(count_stage("pages of values"), 1);
  assert_true(at_first >= 4);
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

static void what_does_not_fit_is_drawn_on_the_host(void** state)
{
  static const page_case dense = {
    .type = STRATUS_FLOAT32, .sampling = MIDPOINT, .structure = STRATUS_STRUCTURE_DISTANCE, .sample_distance = 0.7, .dense = 1
  };
  stratus_ray_caster* caster = NULL;
  picture_case c;
  (void)state;
  make_case(&dense, 77, &c);
  const size_t largest = volume_bytes(&c) / 8, before = device->device->largest_allocation;
  case_render(host_context, &c, &whole);
  assert_int_equal(stratus_ray_caster_create(device, &caster), STRATUS_OK);
  device->device->largest_allocation = largest;
  render(caster, &c, &paged);
  assert_non_null(strstr(paged.report.why, "drawn on the host: the blocks that show take "));
  assert_same("dense");
  set_peak(&c, 0.62);
  render(caster, &c, &paged);
  device->device->largest_allocation = before;
  assert_null(strstr(paged.report.why, "on the host"));
  assert_non_null(strstr(paged.report.why, "the device has "));
  render_alone(&c, 0, &whole);
  assert_same("peak");
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

/* In each try one call of OpenCL and all later calls fail. If the device has no memory for a picture, the host draws it; any other failure
 * is an error; and the next picture has the pages again. */
static void pages_survive_a_device_that_fails(void** state)
{
  static const int errors[] = { CL_MEM_OBJECT_ALLOCATION_FAILURE, CL_DEVICE_NOT_AVAILABLE };
  static const page_case bytes = {
    .type = STRATUS_UINT8, .sampling = MIDPOINT, .structure = STRATUS_STRUCTURE_DISTANCE, .sample_distance = 0.7
  };
  const size_t before = device->device->largest_allocation;
  picture_case c;
  int on_host = 0, refused = 0;
  (void)state;
  make_case(&bytes, 40, &c);
  render_alone(&c, 0, &whole);
  render_alone(&c, volume_bytes(&c) / 3, &paged); /* builds the kernels */
  const stratus_image image = {
    .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = paged.rgba, .depth = paged.depth, .samples = paged.samples
  };
  device->device->largest_allocation = volume_bytes(&c) / 3;
  for (int64_t n = 0, met = 1; met; n += few_run() ? 5 : 1) {
    met = 0;
    for (size_t e = 0; e < COUNT_OF(errors); ++e) {
      stratus_ray_caster* caster = NULL;
      assert_int_equal(stratus_ray_caster_create(device, &caster), STRATUS_OK);
      stratus_device_fail_after(device->device, n, errors[e]);
      const stratus_status status = stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, &paged.report);
      met = device->device->calls_left == 0;
      stratus_device_fail_after(device->device, -1, 0);
      if (status == STRATUS_OK && strstr(paged.report.why, "drawn on the host: ")) {
        ++on_host;
        assert_int_equal(errors[e], CL_MEM_OBJECT_ALLOCATION_FAILURE);
        assert_memory_equal(whole.rgba, paged.rgba, sizeof whole.rgba);
      } else if (status != STRATUS_OK) {
        ++refused;
        assert_int_equal(status, STRATUS_DEVICE_ERROR);
        assert_int_equal(errors[e], CL_DEVICE_NOT_AVAILABLE);
      } else {
        assert_same("where a structure was built on the host, if anything failed");
      }
      render(caster, &c, &paged);
      assert_non_null(strstr(paged.report.why, "the device has "));
      assert_same("after a failure");
      stratus_ray_caster_destroy(caster);
    }
  }
  print_message("             %d pictures drawn on the host, %d refused\n", on_host, refused);
  assert_true(on_host >= 3 && refused >= 3);
  device->device->largest_allocation = before;
  case_destroy(&c);
}

static bool packets = false, one_ray = true;

int test_ray_pages_device(void)
{
  if (no_device()) {
    return TEST_SKIPPED;
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_prestate(pages_draw_the_whole_volumes_bits, &packets),
    cmocka_unit_test(pages_are_sent_once_and_anew_where_more_shows),
    cmocka_unit_test(pages_survive_a_device_that_fails),
  };
  const struct CMUnitTest few[] = { tests[0], cmocka_unit_test_prestate(pages_draw_the_whole_volumes_bits, &one_ray) };
  return tiny ? cmocka_run_group_tests(few, open_device, close_device) : cmocka_run_group_tests(tests, open_device, close_device);
}

int test_ray_pages_by_rays_device(void)
{
  if (no_device()) {
    return TEST_SKIPPED;
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_prestate(pages_draw_the_whole_volumes_bits, &one_ray),
    cmocka_unit_test(pages_serve_the_local_rule),
    cmocka_unit_test(what_does_not_fit_is_drawn_on_the_host),
  };
  return cmocka_run_group_tests(tests, open_device, close_device);
}
