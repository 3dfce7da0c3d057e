/* SPDX-License-Identifier: BSD-3-Clause
 * The sampling that is chosen for the scenes of record: a looser tolerance reads no more of the volume than a tighter one, and equal input
 * gives an equal choice. Reads are counted, because times are not the same from run to run. */
#include "stratus.h"
#include "stratus/scenes.h"
#include "testing.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#define SIDE 64
#define VIEWS 4
#define TOLERANCES 5

static const double tolerances[TOLERANCES] = { 0.001, 0.003, 0.0126, 0.03, 0.1 };
/* Functions that are sharp come first. Of these, no choice may read more than a tighter one. Smooth scenes may read a tenth more where
 * samples, which cost less than cells, take the place of cells. */
static const char* const scenes[] = { "peak", "stripes", "labels", "skin", "cloud", "plume", "fog", "haze", "voxel", "bone", "shell",
  "plate" };
#define SHARP 4
#define SMOOTH_MORE 1.1

static void draw(stratus_context* context, stratus_ray_caster* caster, const stratus_scene* scene, int view,
  const stratus_ray_cast_options* options, stratus_ray_cast_report* report)
{
  static float rgba[4 * SIDE * SIDE];
  const stratus_image image = { .width = SIDE, .height = SIDE, .rgba = rgba };
  double bounds[6];
  stratus_camera camera;
  assert_int_equal(stratus_volume_bounds(context, &scene->volume, bounds), STRATUS_OK);
  assert_int_equal(stratus_scene_camera(context, bounds, scene->up_axis, view, 0, 1.0, &camera), STRATUS_OK);
  assert_int_equal(stratus_ray_caster_render(caster, &scene->volume, scene->transfers, &camera, options, &image, report), STRATUS_OK);
}

/* Returns the reads of several views at a tolerance. Without a structure all samples and cells on the rays are counted, whatever the width
 * of packets. */
static double reads_at(stratus_context* context, const stratus_scene* scene, double tolerance)
{
  stratus_ray_caster *caster = NULL, *again = NULL;
  stratus_ray_cast_options options = stratus_ray_cast_options_default();
  stratus_ray_cast_report report, other;
  double reads = 0.0;
  options.sampling.tolerance = tolerance;
  assert_int_equal(stratus_ray_caster_create(context, &again), STRATUS_OK);
  draw(context, again, scene, VIEWS - 1, &options, &other);
  stratus_ray_caster_destroy(again);
  options.skipping.structure = STRATUS_STRUCTURE_NONE;
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  for (int view = 0; view < VIEWS; ++view) {
    draw(context, caster, scene, view, &options, &report);
    reads += (double)report.samples / VIEWS;
    assert_int_equal(report.sampling, other.sampling);
    assert_true(report.sample_distance == other.sample_distance && report.cell_error == other.cell_error);
  }
  print_message("             %g: %.0f reads, %s, sample distance %.3g, cell error %.3g\n", tolerance, reads,
    stratus_sampling_name(report.sampling), report.sample_distance, report.cell_error);
  stratus_ray_caster_destroy(caster);
  return reads;
}

static void a_looser_tolerance_reads_no_more(void** state)
{
  const int count = few_run() ? SHARP : (int)(sizeof scenes / sizeof *scenes);
  stratus_context* context = NULL;
  (void)state;
  assert_int_equal(stratus_context_create(NULL, &context, NULL, 0), STRATUS_OK);
  for (int n = 0; n < count; ++n) {
    stratus_scene* scene = NULL;
    double least = INFINITY;
    assert_int_equal(stratus_scene_create(context, scenes[n], &scene), STRATUS_OK);
    print_message("             %s\n", scenes[n]);
    for (int t = 0; t < TOLERANCES; ++t) {
      const double reads = reads_at(context, scene, tolerances[t]);
      assert_true(reads <= (n < SHARP ? 1.0 : SMOOTH_MORE) * least);
      least = fmin(least, reads);
    }
    stratus_scene_destroy(context, scene);
  }
  stratus_context_destroy(context);
}

int test_ray_choice(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_looser_tolerance_reads_no_more),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
