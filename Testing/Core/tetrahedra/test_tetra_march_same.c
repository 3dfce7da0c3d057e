/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of tetrahedra that must be the same to the bit: at any number of threads, instruction set and order of cells, and from a caster
 * that drew something else before. */
#include "tetra_case.h"

#include "volume.h"

static tetra_picture one, other;

static stratus_context* open_context(int threads)
{
  stratus_context* context = NULL;
  stratus_context_options options = stratus_context_options_default();
  options.device = "host";
  options.threads = threads;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  return context;
}

static void assert_same(void)
{
  assert_memory_equal(one.rgba, other.rgba, sizeof one.rgba);
  assert_memory_equal(one.depth, other.depth, sizeof one.depth);
  assert_memory_equal(one.rgba8, other.rgba8, sizeof one.rgba8);
  assert_memory_equal(one.samples, other.samples, sizeof one.samples);
}

static void at_any_number_of_threads_and_instruction_set(void** state)
{
  (void)state;
  for (uint32_t seed = 0; seed < 11; ++seed) {
    tetra_case c;
    tetra_create(&c, 4, 0.2, 0.25, seed);
    stratus_context* context = open_context(1);
    tetra_camera(context, &c, 4, (int)seed % 8, seed & 1);
    c.options.mode = seed == 5 ? STRATUS_TETRA_MAXIMUM : STRATUS_TETRA_COMPOSITE;
    c.options.termination = seed & 2 ? 0.9 : 1.0;
    c.mesh.cell_values = seed == 6 || seed == 10;
    if (tetra_method == STRATUS_TETRA_METHOD_MARCH && seed > 6) {
      c.options.mode = (stratus_tetra_mode)(seed == 10 ? STRATUS_TETRA_AVERAGE : STRATUS_TETRA_MINIMUM + seed - 7);
      c.options.mode = seed == 9 ? STRATUS_TETRA_ISOSURFACE : c.options.mode;
      c.options.contour_count = 1;
      c.options.contours[0] = 0.5;
      c.options.clip_plane_count = 1;
      c.options.clip_planes[0][0] = -1.0;
      c.options.clip_planes[0][3] = 2.3;
    }
    if (seed >= 8) {
      tetra_as_lattice(&c, 4);
    }
    tetra_draw(context, &c, &one);
    assert_true(one.report.rays > TETRA_PIXELS / 8);
    for (int isa = context->isa - 1; isa >= 0; --isa) {
      context->isa = isa;
      tetra_draw(context, &c, &other);
      assert_same();
      assert_int_equal(one.report.segments, other.report.segments);
    }
    stratus_context_destroy(context);
    for (int threads = 2; threads < 6; ++threads) {
      context = open_context(threads);
      tetra_draw(context, &c, &other);
      assert_same();
      stratus_context_destroy(context);
    }
    tetra_destroy(&c);
  }
}

static void whatever_the_order_of_cells(void** state)
{
  stratus_context* context = open_context(2);
  tetra_case c;
  uint32_t s = 3;
  (void)state;
  tetra_create(&c, 4, 0.2, 0.0, 1); /* no hollows: no two ways begin at one depth */
  tetra_camera(context, &c, 4, 2, 0);
  tetra_draw(context, &c, &one);
  for (int64_t i = c.mesh.cell_count - 1; i > 0; --i) {
    const int64_t j = (int64_t)tetra_uniform(&s, 0, (double)i + 0.999);
    int32_t kept[4];
    memcpy(kept, c.vertices + 4 * i, sizeof kept);
    memcpy(c.vertices + 4 * i, c.vertices + 4 * j, sizeof kept);
    memcpy(c.vertices + 4 * j, kept, sizeof kept);
  }
  tetra_draw(context, &c, &other);
  assert_same();
  tetra_destroy(&c);
  stratus_context_destroy(context);
}

/* Only changed inputs cause a rebuild, and a new caster draws equal pictures. */
static void from_a_caster_that_drew_before(void** state)
{
  stratus_context* context = open_context(2);
  stratus_tetra_caster* caster = NULL;
  tetra_case c;
  (void)state;
  tetra_create(&c, 3, 0.2, 0.2, 2);
  assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
  const stratus_image image = {
    .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = one.rgba, .depth = one.depth, .rgba8 = one.rgba8, .samples = one.samples
  };
  static const uint64_t values[] = { 1, 1, 1, 1, 2, 2 }, tables[] = { 1, 1, 2, 3, 3, 3 };
  for (int step = 0; step < 6; ++step) {
    tetra_camera(context, &c, 3, step, step & 1);
    if (step == 2) {
      c.opacity[5] = 0.3;
    } else if (step == 3) {
      c.options.mode = STRATUS_TETRA_MAXIMUM;
    } else if (step == 4) {
      c.values[30] = 0.9f;
      ++c.mesh.revision;
    } else if (step == 5) {
      c.mesh.matrix[3] = 0.5; /* geometry is the frame's */
    }
    assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, &one.report), STRATUS_OK);
    assert_int_equal(one.report.mesh_builds, 1);
    assert_int_equal(one.report.value_builds, values[step]);
    assert_int_equal(one.report.table_builds, tables[step]);
    tetra_draw(context, &c, &other);
    assert_same();
  }
  stratus_tetra_caster_release(caster);
  assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, &one.report), STRATUS_OK);
  assert_same();
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&c);
  stratus_context_destroy(context);
}

int test_tetra_march_same(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(at_any_number_of_threads_and_instruction_set),
    cmocka_unit_test(whatever_the_order_of_cells),
    cmocka_unit_test(from_a_caster_that_drew_before),
  };
  int failed = 0;
  for (tetra_method = STRATUS_TETRA_METHOD_MARCH; tetra_method <= STRATUS_TETRA_METHOD_PROJECT; ++tetra_method) {
    failed += cmocka_run_group_tests_name(stratus_tetra_method_name(tetra_method), tests, NULL, NULL);
  }
  return failed;
}
