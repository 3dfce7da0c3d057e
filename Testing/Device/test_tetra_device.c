/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of tetrahedra drawn by an OpenCL device, by marching and by projection: in packets of 16, as on a CPU, and one ray a work item,
 * as on a GPU. The same as the host's of packets of 16, to the bit. A device that disappears at any call leaves an error, and the picture
 * right once it is back. */
#include "tetra_case.h"

#include "device_state.h"
#include "faulty_allocator.h"
#include "tetra_caster.h"
#include "tetra_costs.h"
#include "testing.h"

#define CALLS_MAX 500

/* How the device draws. */
typedef struct variant {
  int as_gpu;
  stratus_tetra_method method;
} variant;

static tetra_picture ours, theirs;
static int seeds = 12, edge = 4; /* cases, and boxes along a mesh's edges */
static double wider = 1.0;       /* of the view: a mesh fills less of the picture */

/* Opens a context, and lets all cases be drawn by the variant's method. */
static stratus_context* open_context(const char* name, const variant* how)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  options.device = name;
  options.threads = 2;
  tetra_method = how->method;
  if (stratus_context_create(&options, &context, NULL, 0) == STRATUS_OK && context->device) {
    context->device->is_cpu = !how->as_gpu;
  }
  return context;
}

static void assert_same(void)
{
  assert_memory_equal(ours.rgba, theirs.rgba, sizeof ours.rgba);
  assert_memory_equal(ours.depth, theirs.depth, sizeof ours.depth);
  assert_memory_equal(ours.rgba8, theirs.rgba8, sizeof ours.rgba8);
  assert_memory_equal(ours.samples, theirs.samples, sizeof ours.samples);
  assert_int_equal(ours.report.rays, theirs.report.rays);
  assert_int_equal(ours.report.entries, theirs.report.entries);
  assert_int_equal(ours.report.segments, theirs.report.segments);
  assert_int_equal(ours.report.stuck, theirs.report.stuck);
  assert_int_equal(ours.report.again, theirs.report.again);
}

/* A mesh, a function and a view at random, each kind of option among them. */
static void make_case(stratus_context* context, tetra_case* c, uint32_t seed, const float* opaque)
{
  tetra_create(c, edge, 0.2, seed % 3 == 0 ? 0.3 : 0.0, seed);
  tetra_camera(context, c, edge, (int)(seed % 8), seed & 1);
  for (int axis = 0; axis < 3; ++axis) { /* a simulator takes its time for each ray that meets the mesh */
    c->camera.right[axis] *= wider;
    c->camera.up[axis] *= wider;
  }
  static const stratus_tetra_mode modes[12] = { [2] = STRATUS_TETRA_SLICE,
    [3] = STRATUS_TETRA_FIRST_HIT,
    [4] = STRATUS_TETRA_MAXIMUM,
    [5] = STRATUS_TETRA_AVERAGE,
    [8] = STRATUS_TETRA_ADDITIVE,
    [10] = STRATUS_TETRA_ISOSURFACE,
    [11] = STRATUS_TETRA_MINIMUM };
  const bool marched = tetra_method == STRATUS_TETRA_METHOD_MARCH;
  c->options.mode = marched ? modes[seed % 12] : seed % 6 == 4 ? STRATUS_TETRA_MAXIMUM : STRATUS_TETRA_COMPOSITE;
  c->options.contour_count = 2;
  c->options.contours[0] = 0.6;
  c->options.contours[1] = 0.4;
  c->options.slice = (stratus_slice){ .center = { 0.4 * edge, 0.5 * edge, 0.6 * edge }, .square = { 1, 1, -0.5, 0.1 }, .constant = -0.3 };
  c->options.termination = seed & 2 ? 0.9 : 1.0;
  c->mesh.cell_values = seed % 6 == 5;
  if (seed % 4 == 3) {
    c->opaque_depth = opaque;
    c->camera.near_k = 2.0 * edge;
    c->camera.far_k = 5.0 * edge;
  }
  if (seed % 5 == 2 && !c->opaque_depth) { /* the eye in the mesh */
    for (int axis = 0; axis < 3; ++axis) {
      c->camera.eye[axis] = 0.5 * edge + 0.1 * axis;
    }
    c->camera.near_k = 0.3;
  }
  if (seed % 4 == 1) { /* cut by planes and a box */
    const double plane[4] = { 0.3, -0.5, 0.8, -0.2 * edge }, bounds[6] = { 0.3, 0.9 * edge, -INFINITY, 0.8 * edge, 0.2, INFINITY };
    memcpy(c->options.clip_planes[0], plane, sizeof plane);
    memcpy(c->options.crop_bounds, bounds, sizeof bounds);
    c->options.clip_plane_count = c->options.crop = 1;
    c->options.crop_regions = marched && seed == 5 ? 0x5a3e9d6 : STRATUS_CROP_INSIDE;
  }
  if (seed % 4 >= 2 && marched) { /* lit, thinned, or both; other modes are neither */
    static const double thin[4] = { 0.1, 0.0, 0.6, 1.0 };
    c->options.shade = seed % 5 != 0;
    c->options.shading.specular = 0.4;
    c->options.shading.one_sided = seed % 3 == 0;
    c->transfer.gradient = thin;
    c->transfer.gradient_count = seed % 4 == 3 ? 2 : 0;
    c->options.gradient_distance = seed == 7 ? 0.5 : 0.0;
  }
  if (seed % 7 == 3) { /* deep segments, in many pieces */
    c->transfer.unit_distance = 0.02;
  }
}

static void device_and_host_draw_the_same(void** state)
{
  static float opaque[TETRA_PIXELS_MOST];
  stratus_context *host = open_context("host", *state), *device = open_context("0", *state);
  assert_non_null(device);
  print_message("on %s\n", stratus_context_device(device));
  for (uint32_t seed = 0; seed < (uint32_t)seeds; ++seed) {
    tetra_case c;
    uint32_t random = seed;
    for (int i = 0; i < TETRA_PIXELS; ++i) {
      opaque[i] = (float)tetra_uniform(&random, 0.0, 1.0);
    }
    make_case(host, &c, seed, opaque);
    tetra_draw(host, &c, &theirs);
    assert_true(theirs.report.segments > 0);
    tetra_draw(device, &c, &ours);
    assert_same();
    tetra_as_lattice(&c, edge);
    tetra_draw(host, &c, &theirs);
    tetra_draw(device, &c, &ours);
    assert_same();
    tetra_destroy(&c);
  }
  stratus_context_destroy(device);
  stratus_context_destroy(host);
}

/* Values of several components, each with a function of its own or all with one, mixed or drawn by themselves. */
static void components_draw_the_same(void** state)
{
  stratus_context *host = open_context("host", *state), *device = open_context("0", *state);
  assert_non_null(device);
  for (uint32_t seed = 0; seed < 18; seed += few_run() ? 7 : 1) {
    static const stratus_tetra_mode last[8] = { STRATUS_TETRA_SLICE, STRATUS_TETRA_MINIMUM, STRATUS_TETRA_ISOSURFACE, STRATUS_TETRA_AVERAGE,
      STRATUS_TETRA_FIRST_HIT, STRATUS_TETRA_SLICE, STRATUS_TETRA_ISOSURFACE, STRATUS_TETRA_FIRST_HIT };
    static const double thicker[4] = { 0.2, 0.1, 0.9, 0.6 }, thin[4] = { 0.1, 0.0, 0.6, 1.0 };
    static const stratus_material materials[2] = { { 1, 0.1, 0.9, 0.5, 30.0 }, { 1, 0.4, 0.5, 0.0, 1.0 } };
    tetra_case c;
    tetra_create(&c, edge, 0.2, 0.0, seed);
    tetra_camera(host, &c, edge, (int)(seed % 8), seed & 1);
    stratus_transfer transfers[2] = { c.transfer, c.transfer };
    transfers[1].opacity = thicker;
    transfers[1].opacity_count = 2;
    c.options.mode = seed > 9 ? last[seed - 10]
      : seed < 3 || seed > 6  ? STRATUS_TETRA_COMPOSITE
                              : (stratus_tetra_mode)(STRATUS_TETRA_MAXIMUM + seed - 3);
    c.options.contour_count = 1;
    c.options.contours[0] = 0.5;
    c.options.slice = (stratus_slice){ .center = { 0.5 * edge, 0.5 * edge, 0.5 * edge }, .linear = { 1, 2, 3 } };
    if (seed > 6) {
      c.options.shade = 1;
      c.options.materials = seed == 8 || seed > 15 ? materials : NULL;
      transfers[1].gradient = thin;
      transfers[1].gradient_count = 2;
      c.options.gradient_distance = seed == 9 ? 0.5 : 0.0;
    }
    c.mesh.point_count /= 2; /* every two values become one of two components; cells name half of the points */
    c.mesh.components = 2;
    c.mesh.value_stride = 2;
    for (int64_t cell = 0; cell < 4 * c.mesh.cell_count; ++cell) {
      c.mesh.cell_count = c.vertices[cell] >= (int32_t)c.mesh.point_count ? cell / 4 : c.mesh.cell_count;
    }
    c.options.dependent = seed == 1 || seed == 7 || (seed > 9 && seed < 15);
    c.options.mean_components = seed == 2 || seed == 8;
    for (int where = 0; where < 2; ++where) {
      stratus_context* context = where ? device : host;
      tetra_picture* p = where ? &ours : &theirs;
      stratus_tetra_caster* caster = NULL;
      memset(p, 0x5a, sizeof *p);
      const stratus_image image = {
        .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = p->rgba, .depth = p->depth, .rgba8 = p->rgba8, .samples = p->samples
      };
      assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
      assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, transfers, &c.camera, &c.options, &image, &p->report), STRATUS_OK);
      stratus_tetra_caster_destroy(caster);
    }
    assert_true(theirs.report.segments > 0);
    assert_same();
    tetra_destroy(&c);
  }
  stratus_context_destroy(device);
  stratus_context_destroy(host);
}

/* Labels of cells, lit and thinned or not, of lists and lattices. */
static void labels_draw_the_same(void** state)
{
  stratus_context *host = open_context("host", *state), *device = open_context("0", *state);
  assert_non_null(device);
  for (uint32_t seed = 0; seed < 4; ++seed) {
    static const double thicker[4] = { 0.2, 0.1, 0.9, 0.6 }, opaque[4] = { 0.5, 0.0, 0.6, 1.0 }, thin[4] = { 0.1, 0.0, 0.6, 1.0 };
    uint8_t* labels = malloc((size_t)(6 * edge * edge * edge));
    assert_non_null(labels);
    tetra_case c;
    tetra_create(&c, edge, 0.2, 0.0, seed);
    tetra_camera(host, &c, edge, (int)(seed % 8), seed & 1);
    stratus_transfer transfers[3] = { c.transfer, c.transfer, c.transfer };
    transfers[1].opacity = thicker;
    transfers[2].opacity = opaque;
    transfers[1].opacity_count = transfers[2].opacity_count = 2;
    for (int i = 0; i < 6 * edge * edge * edge; ++i) {
      labels[i] = (uint8_t)((uint32_t)i * 2654435761u >> 30);
    }
    if (seed % 2 == 1) {
      c.options.shade = 1;
      transfers[1].gradient = thin;
      transfers[1].gradient_count = 2;
    }
    if (seed > 1) {
      tetra_as_lattice(&c, edge);
    }
    c.mesh.labels = labels;
    c.transfers = transfers;
    c.options.label_count = 2;
    tetra_draw(host, &c, &theirs);
    tetra_draw(device, &c, &ours);
    assert_true(theirs.report.segments > 0);
    assert_same();
    free(labels);
    tetra_destroy(&c);
  }
  stratus_context_destroy(device);
  stratus_context_destroy(host);
}

/* Pixels whose pieces come out of order, with more of them than are sorted at once. */
static void overlaps_are_drawn_again(void** state)
{
  stratus_context *host = open_context("host", *state), *device = open_context("0", *state);
  tetra_case c;
  assert_non_null(device);
  tetra_create(&c, 2 * edge, 0.2, 0.0, 3);
  tetra_copy(&c, 3, 0.31);
  c.transfer.unit_distance = 4.0;
  tetra_camera(host, &c, 2 * edge, 2, 0);
  tetra_draw(host, &c, &theirs);
  tetra_draw(device, &c, &ours);
  assert_same();
  assert_true(ours.report.again > TETRA_PIXELS / 10);
  tetra_destroy(&c);
  stratus_context_destroy(device);
  stratus_context_destroy(host);
}

/* The automatic method: on a processor what costs less on the host, on a GPU the march. The costs are given, so that no timing decides. */
static void auto_goes_by_the_costs_of_the_host(void** state)
{
  static const stratus_tetra_costs costs[2] = { { .segment = 1e6 }, { .piece = 1e6, .packet = 1e6, .cell = 1e6, .sorted = 1e6 } };
  const variant* how = *state;
  stratus_context* device = open_context("0", how);
  stratus_tetra_caster* caster = NULL;
  tetra_case c;
  assert_non_null(device);
  tetra_create(&c, 3, 0.2, 0.2, 2);
  tetra_camera(device, &c, 3, 1, 0);
  c.options.method = STRATUS_TETRA_METHOD_AUTO;
  assert_int_equal(stratus_tetra_caster_create(device, &caster), STRATUS_OK);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = ours.rgba };
  for (int i = 0; i < 2; ++i) {
    stratus_tetra_report report;
    caster->costs = &costs[i];
    assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, &report), STRATUS_OK);
    assert_int_equal(report.method, i == 0 && !how->as_gpu ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_MARCH);
  }
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&c);
  stratus_context_destroy(device);
}

/* The device's data are replaced only if they change, and a new caster draws equal pictures. */
static void draw_with_changes(stratus_context* device, int cell_values)
{
  stratus_tetra_caster* caster = NULL;
  tetra_case c;
  tetra_create(&c, 3, 0.2, 0.2, 2);
  c.mesh.cell_values = cell_values;
  assert_int_equal(stratus_tetra_caster_create(device, &caster), STRATUS_OK);
  const stratus_image image = {
    .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = ours.rgba, .depth = ours.depth, .rgba8 = ours.rgba8, .samples = ours.samples
  };
  for (int step = 0; step < 6; ++step) {
    tetra_camera(device, &c, 3, step, step & 1);
    if (step == 1) {
      c.opacity[5] = 0.3;
    } else if (step == 2) {
      c.options.mode = STRATUS_TETRA_MAXIMUM;
    } else if (step == 3) {
      c.values[30] = 0.9f;
      ++c.mesh.revision;
    } else if (step == 4) {
      c.options.mode = STRATUS_TETRA_COMPOSITE;
    } else if (step == 5) {
      stratus_tetra_caster_release(caster);
    }
    assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, &ours.report), STRATUS_OK);
    tetra_draw(device, &c, &theirs);
    assert_same();
  }
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&c);
}

static void a_caster_that_drew_before(void** state)
{
  stratus_context* device = open_context("0", *state);
  assert_non_null(device);
  draw_with_changes(device, 0);
  draw_with_changes(device, 1);
  stratus_context_destroy(device);
}

static void the_loss_of_the_device_at_any_call(void** state)
{
  stratus_context* device = open_context("0", *state);
  stratus_tetra_caster* caster = NULL;
  tetra_case c;
  int calls = 0;
  assert_non_null(device);
  tetra_create(&c, 2, 0.2, 0.0, 4);
  tetra_camera(device, &c, 2, 1, 0);
  tetra_draw(device, &c, &theirs);
  const stratus_image image = {
    .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = ours.rgba, .depth = ours.depth, .rgba8 = ours.rgba8, .samples = ours.samples
  };
  for (stratus_status status = STRATUS_DEVICE_ERROR; status != STRATUS_OK; ++calls) {
    assert_true(calls < CALLS_MAX);
    assert_int_equal(stratus_tetra_caster_create(device, &caster), STRATUS_OK);
    stratus_device_fail_after(device->device, calls, CL_DEVICE_NOT_AVAILABLE);
    status = stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, &ours.report);
    stratus_device_fail_after(device->device, -1, 0);
    if (status != STRATUS_OK) {
      assert_int_equal(status, STRATUS_DEVICE_ERROR);
      assert_non_null(strstr(stratus_context_message(device), "CL_DEVICE_NOT_AVAILABLE"));
      assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, &ours.report), STRATUS_OK);
    }
    assert_same();
    stratus_tetra_caster_destroy(caster);
  }
  assert_true(calls > 30); /* buffers, arguments, launches and reads */
  tetra_destroy(&c);
  stratus_context_destroy(device);
}

/* Memory refused at any call is an error, nothing is kept of it, and the same caster draws the picture when asked again. */
static void refused_memory(void** state)
{
  faulty_allocator allocator = { 0 };
  const stratus_context_options options = faulty_options(&allocator, "0");
  stratus_context* device = NULL;
  tetra_case c;
  int refused = 0;
  assert_int_equal(stratus_context_create(&options, &device, NULL, 0), STRATUS_OK);
  tetra_method = ((const variant*)*state)->method;
  device->device->is_cpu = !((const variant*)*state)->as_gpu;
  tetra_create(&c, 2, 0.2, 0.2, 10);
  tetra_camera(device, &c, 2, 0, 0);
  tetra_draw(device, &c, &theirs); /* programs are built */
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = ours.rgba };
  for (bool reached = true; reached;) {
    stratus_tetra_caster* caster = NULL;
    const int64_t live = allocator.live;
    assert_int_equal(stratus_tetra_caster_create(device, &caster), STRATUS_OK);
    allocator.fail_at = allocator.calls + refused + 1;
    stratus_status status = stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL);
    reached = allocator.calls >= allocator.fail_at;
    allocator.fail_at = 0;
    if (reached) {
      assert_int_equal(status, STRATUS_OUT_OF_MEMORY);
      ++refused;
      status = stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL);
    }
    assert_int_equal(status, STRATUS_OK);
    assert_memory_equal(ours.rgba, theirs.rgba, sizeof ours.rgba);
    stratus_tetra_caster_destroy(caster);
    assert_int_equal(allocator.live, live);
  }
  assert_true(refused > 15);
  tetra_destroy(&c);
  stratus_context_destroy(device);
  assert_int_equal(allocator.live, 0);
}

/* --few: a third of the meshes. --tiny: two small meshes, for a simulator that checks each access. */
int test_tetra_device(void)
{
  variant march_cpu = { 0, STRATUS_TETRA_METHOD_MARCH }, march_gpu = { 1, STRATUS_TETRA_METHOD_MARCH },
          project_cpu = { 0, STRATUS_TETRA_METHOD_PROJECT }, project_gpu = { 1, STRATUS_TETRA_METHOD_PROJECT };
  const struct CMUnitTest few[] = {
    cmocka_unit_test_prestate(device_and_host_draw_the_same, &march_gpu),
    cmocka_unit_test_prestate(device_and_host_draw_the_same, &project_gpu),
    cmocka_unit_test_prestate(overlaps_are_drawn_again, &project_gpu),
  };
#define TWO(test) cmocka_unit_test_prestate(test, &march_cpu), cmocka_unit_test_prestate(test, &project_gpu)
#define EACH(test)                                                                                                                         \
  cmocka_unit_test_prestate(test, &march_cpu), cmocka_unit_test_prestate(test, &march_gpu), cmocka_unit_test_prestate(test, &project_cpu), \
    cmocka_unit_test_prestate(test, &project_gpu)
  const struct CMUnitTest all[] = {
    EACH(device_and_host_draw_the_same),
    cmocka_unit_test_prestate(components_draw_the_same, &march_cpu),
    cmocka_unit_test_prestate(labels_draw_the_same, &march_cpu),
    cmocka_unit_test_prestate(components_draw_the_same, &march_gpu),
    cmocka_unit_test_prestate(labels_draw_the_same, &march_gpu),
    cmocka_unit_test_prestate(overlaps_are_drawn_again, &project_cpu),
    cmocka_unit_test_prestate(overlaps_are_drawn_again, &project_gpu),
    cmocka_unit_test_prestate(auto_goes_by_the_costs_of_the_host, &march_cpu),
    cmocka_unit_test_prestate(auto_goes_by_the_costs_of_the_host, &march_gpu),
    EACH(a_caster_that_drew_before),
    EACH(the_loss_of_the_device_at_any_call),
    EACH(refused_memory),
  };
  const struct CMUnitTest small[] = {
    TWO(device_and_host_draw_the_same),
    cmocka_unit_test_prestate(components_draw_the_same, &march_gpu),
    cmocka_unit_test_prestate(labels_draw_the_same, &march_gpu),
    cmocka_unit_test_prestate(overlaps_are_drawn_again, &project_cpu),
    cmocka_unit_test_prestate(auto_goes_by_the_costs_of_the_host, &march_cpu),
    TWO(a_caster_that_drew_before),
    TWO(the_loss_of_the_device_at_any_call),
    TWO(refused_memory),
  };
#undef TWO
#undef EACH
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  if (test_option("--tiny")) {
    seeds = 2;
    edge = 1;
    wider = 2.5;
    return cmocka_run_group_tests(few, NULL, NULL);
  }
  if (few_run()) {
    seeds = 3;
    return cmocka_run_group_tests(small, NULL, NULL);
  }
  return cmocka_run_group_tests(all, NULL, NULL);
}
