/* SPDX-License-Identifier: BSD-3-Clause
 * Sampling by cells against the double reference: the error falls with the option, nearest interpolation is exact, known integrals are met,
 * and neither structures, pieces nor planes change what is drawn. */
#include "picture_case.h"
#include "testing.h"

/* Longest piece of the reference's quadrature, in voxels. Its error falls with the sixth power, and is far below a float's rounding. */
#define PIECE (1.0 / 32)

static picture drawn;
static picture other;

/* Makes the case's transfer function one of KINDS, over a field within base -+ scale. */
#define KINDS 4
static const char* const kinds[KINDS] = { "ramp", "peak", "steps", "shell" };

static void set_function(picture_case* c, int kind)
{
  static const double opacity[KINDS][8] = { { -1, 0, 0, 0.02, 0.5, 0.3, 1, 0.3 }, { 0.05, 0, 0.12, 0.7, 0.19, 0, 1, 0 },
    { 0.1, 0, 0.1, 0.4, 0.3, 0.4, 0.3, 0 }, { -1, 0.01, 0.2, 0.01, 0.25, 0.95, 1, 0.95 } };
  const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
  for (int p = 0; p < 4; ++p) {
    c->opacity[2 * p] = base + scale * opacity[kind][2 * p];
    c->opacity[2 * p + 1] = opacity[kind][2 * p + 1];
  }
  c->transfer.clamp = kind != 2;
}

/* Replaces the field by one of random values, over which the smooth one counts by 1 - rough. */
static void roughen(picture_case* c, double rough, uint32_t seed)
{
  const double base = case_type_values[STRATUS_FLOAT32].base, scale = case_type_values[STRATUS_FLOAT32].scale;
  const int64_t* n = c->volume.dimensions;
  float* values = c->values;
  for (int64_t at = 0; at < n[0] * n[1] * n[2]; ++at) {
    values[at] = (float)((1.0 - rough) * values[at] + rough * (base + scale * case_uniform(&seed, -0.6, 0.6)));
  }
}

static double psnr_of(stratus_context* context, const picture_case* c, const float* reference)
{
  case_render(context, c, &drawn);
  assert_int_equal(drawn.report.sampling, STRATUS_SAMPLING_CELLS);
  return reference_psnr(drawn.rgba, reference, CASE_PIXELS);
}

static void the_error_falls_with_the_option(void** state)
{
  static const double errors[3] = { 1.0 / 16, 1.0 / 256, 1.0 / 16384 };
  static float reference[4 * CASE_PIXELS_MOST];
  static const double wanted[2][KINDS] = { { 75, 66, 66, 66 }, { 77, 69, 70, 64 } };
  for (int kind = 0; kind < 2 * KINDS; kind += few_run() ? 7 : 1) {
    picture_case c;
    double db[3];
    case_create(*state, &c, STRATUS_FLOAT32, 24, 22, 26, 300u + (uint32_t)kind);
    c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
    set_function(&c, kind % KINDS);
    if (kind >= KINDS) {
      roughen(&c, 0.5, 17u + (uint32_t)kind);
    }
    const reference_scene scene = case_scene(&c);
    assert_int_equal(reference_render(&scene, CASE_WIDTH, CASE_HEIGHT, PIECE, reference, NULL), 0);
    for (int i = 0; i < 3; ++i) {
      c.options.sampling.cell_error = errors[i];
      db[i] = psnr_of(*state, &c, reference);
    }
    print_message("             %s, %s: %.1f %.1f %.1f dB\n", kind < KINDS ? "smooth" : "rough", kinds[kind % KINDS], db[0], db[1], db[2]);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    assert_true(db[1] > db[0] - 1.0 && db[2] > db[1] - 1.0);
    assert_true(db[2] >= wanted[kind / KINDS][kind % KINDS]);
    case_destroy(&c);
  }
}

/* Where opacity is constant between steps, paths are cut at the steps, and the coarsest cell error is as good as the finest. Colours may
 * change between the steps, and in smooth and in rough fields a path may cross several steps. */
static void functions_by_steps_are_exact_at_every_cell_error(void** state)
{
  static const double opacity[2][12] = { { -1, 0, 0.05, 0, 0.05, 0.9, 0.2, 0.9, 0.2, 0, 1, 0 },
    { -1, 0.1, -0.2, 0.1, -0.2, 0.6, 0.1, 0.6, 0.1, 0.3, 1, 0.3 } };
  static const double color[2][24] = { { -1, 1, 0.8, 0.6, 0.05, 1, 0.8, 0.6, 0.2, 0.1, 0.3, 0.2, 0.3, 0, 0, 0, 0.5, 0, 0, 0, 1, 0, 0, 0 },
    { -1, 1, 0, 0, -0.1, 1, 0, 0, -0.1, 0, 1, 0, 0.15, 0, 1, 0, 0.15, 0, 0.2, 1, 1, 0, 1, 1 } };
  static float reference[4 * CASE_PIXELS_MOST];
  for (int n = 0; n < 4; ++n) {
    const double base = case_type_values[STRATUS_FLOAT32].base, scale = case_type_values[STRATUS_FLOAT32].scale;
    double db[2], opacities[12], colors[24];
    picture_case c;
    case_create(*state, &c, STRATUS_FLOAT32, 24, 22, 26, 310u + (uint32_t)n);
    c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
    for (int p = 0; p < 6; ++p) {
      opacities[2 * p] = base + scale * opacity[n % 2][2 * p];
      opacities[2 * p + 1] = opacity[n % 2][2 * p + 1];
      memcpy(colors + 4 * p, color[n % 2] + 4 * p, 4 * sizeof *colors);
      colors[4 * p] = base + scale * color[n % 2][4 * p];
    }
    c.transfer.opacity = opacities;
    c.transfer.color = colors;
    c.transfer.opacity_count = c.transfer.color_count = 6;
    roughen(&c, n < 2 ? 0.0 : 0.7, 29u + (uint32_t)n);
    const reference_scene scene = case_scene(&c);
    assert_int_equal(reference_render(&scene, CASE_WIDTH, CASE_HEIGHT, PIECE, reference, NULL), 0);
    for (int i = 0; i < 2; ++i) {
      c.options.sampling.cell_error = i ? 1.0 / 16384 : 0.5;
      db[i] = psnr_of(*state, &c, reference);
    }
    print_message("             %s, %s: %.1f %.1f dB\n", n < 2 ? "smooth" : "rough", n % 2 ? "steps" : "window", db[0], db[1]);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    assert_true(db[0] >= 76.0 && db[0] == db[1]);
    case_destroy(&c);
  }
}

/* The optical depth from box to box, in double. A ray along an axis passes through a row of values. */
static void nearest_is_exact(void** state)
{
  enum { N = 9 };
  for (int type = STRATUS_UINT8; type <= STRATUS_FLOAT32; type += STRATUS_FLOAT32 - STRATUS_UINT8) {
    for (int view = 0; view < 6; ++view) {
      picture_case c;
      double worst = 0.0;
      uint32_t seed = 5u + (uint32_t)view;
      case_create(*state, &c, (stratus_type)type, N, N, N, 44u + (uint32_t)view);
      c.volume.cell_centered = view % 2;
      for (int at = 0; at < N * N * N; ++at) {
        case_store(c.values, c.volume.type, (size_t)at, (double)(case_random(&seed) % 5));
      }
      /* five values, each with an opacity and a colour of its own, constant about it */
      const double opacity[20] = { -.5, 0, .5, 0, .5, .1, 1.5, .1, 1.5, .5, 2.5, .5, 2.5, .02, 3.5, .02, 3.5, .9, 4.5, .9 };
      const double color[20] = { 0.4, 1, 0, 0, 1.4, 1, 0, 0, 1.6, 0, 1, 0, 2.4, 0, 1, 0, 3, .2, .3, .4 };
      c.transfer.opacity = opacity;
      c.transfer.opacity_count = 10;
      c.transfer.color = color;
      c.transfer.color_count = 5;
      c.options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
      c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
      case_camera(*state, &c, view, view / 3);
      case_render(*state, &c, &drawn);
      assert_int_equal(drawn.report.sampling, STRATUS_SAMPLING_CELLS);
      /* the bounds of a volume of points are drawn in by 2^-21 of the dimension and two voxels */
      const double half = c.volume.cell_centered ? 0.5 : 0.0, lo = c.volume.cell_centered ? -0.5 : (N + 1) * 0x1p-21, hi = N - 1 - lo;
      static const double alphas[5] = { 0, .1, .5, .02, .9 }, reds[5] = { 1, 1, 0, .2, .2 };
      for (int pixel = 0; pixel < CASE_PIXELS; ++pixel) {
        const double u = 2.0 * (pixel % CASE_WIDTH + 0.5) / CASE_WIDTH - 1.0, v = 2.0 * (pixel / CASE_WIDTH + 0.5) / CASE_HEIGHT - 1.0;
        double p[3], d[3], begin = 0.0, end = 1e30, length = 0.0, red = 0.0, clear = 1.0;
        for (int a = 0; a < 3; ++a) {
          const double offset = u * c.camera.right[a] + v * c.camera.up[a];
          p[a] = c.camera.eye[a] - half + (c.camera.parallel ? offset : 0.0);
          d[a] = c.camera.forward[a] + (c.camera.parallel ? 0.0 : offset);
          length += d[a] * d[a];
        }
        length = sqrt(length);
        for (int a = 0; a < 3; ++a) {
          d[a] = d[a] / length;
          const double t0 = (lo - p[a]) / d[a], t1 = (hi - p[a]) / d[a];
          begin = fmax(begin, fmin(t0, t1));
          end = fmin(end, fmax(t0, t1));
        }
        while (begin < end) {
          double next = end;
          int64_t box[3];
          for (int a = 0; a < 3; ++a) { /* find the box of a point just behind the border */
            box[a] = (int64_t)fmin(fmax(floor(p[a] + (begin + 1e-9) * d[a] + 0.5), 0.0), N - 1);
            next = fmin(next,
              ((double)box[a] + (d[a] > 0.0 ? 0.5 : -0.5) - p[a]) / d[a] > begin + 1e-9
                ? ((double)box[a] + (d[a] > 0.0 ? 0.5 : -0.5) - p[a]) / d[a]
                : end);
          }
          const int value = (int)reference_value(&c.volume, box[0], box[1], box[2]);
          const double alpha = 1.0 - pow(1.0 - alphas[value], next - begin);
          red += clear * alpha * reds[value];
          clear *= 1.0 - alpha;
          begin = next;
        }
        worst = fmax(worst, fabs(1.0 - clear - (double)drawn.rgba[4 * pixel + 3]));
        worst = fmax(worst, fabs(red - (double)drawn.rgba[4 * pixel]));
      }
      print_message("             %s, view %d: at most %.1e apart\n", case_type_names[type], view, worst);
      assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
      assert_true(worst < 1e-5);
      case_destroy(&c);
    }
  }
}

/* Along any ray a field that is linear has the optical depth that the function's integral gives. */
static void a_linear_field_has_the_integral_of_its_function(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 12, 12, 33, 3u);
  float* values = c.values;
  for (int at = 0; at < 12 * 12 * 33; ++at) {
    values[at] = (float)(at / 144);
  }
  /* constant opacity between steps, wherever the steps fall: over 10.25 voxels, and over seven cells of the table's grid; the last function
   * is 1 beyond the part that is shown */
  static const double last[3] = { 17.5, 7.263, 7.263 }, opaque[3] = { 0.2, 0.9999, 0.9999 }, beyond[3] = { 0, 0, 1 };
  const double color[4] = { 0, 1, 0.5, 0.25 };
  const double eye[3] = { 5.5, 5.5, -30 }, focal[3] = { 5.5, 5.5, 10 }, up[3] = { 0, 1, 0 };
  assert_int_equal(stratus_camera_parallel(*state, eye, focal, up, 4.0, 1.0, &c.camera), STRATUS_OK);
  c.options.clipping.crop = 1;
  for (int side = 0; side < 6; ++side) {
    c.options.clipping.crop_bounds[side] = side == 5 ? 30.0 : side % 2 ? 1e9 : -1e9;
  }
  for (int window = 0; window < 3; ++window) {
    const double end = last[window], o = opaque[window],
                 opacity[14] = { 0, 0, 7.25, 0, 7.25, o, end, o, end, 0, 31, 0, 32, beyond[window] };
    c.transfer.opacity = opacity;
    c.transfer.opacity_count = 7;
    c.transfer.color = color;
    c.transfer.color_count = 1;
    c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
    case_render(*state, &c, &drawn);
    const double alpha = -expm1(log1p(-o) * (end - 7.25));
    double worst = 0.0;
    for (int pixel = 0; pixel < CASE_PIXELS; ++pixel) {
      worst = fmax(worst, fabs((double)drawn.rgba[4 * pixel + 3] - alpha));
    }
    print_message("             opacity %.3f: at most %.1e apart\n", alpha, worst);
    assert_true(worst < 1e-3 * fmin(alpha, 1.0 - alpha)); /* a cell of the grid is .002 wide */
  }
  case_destroy(&c);
}

static void expect_near(const char* what, double db, double least)
{
  print_message("             %s: %.1f dB\n", what, db);
  assert_true(db >= least);
}

/* Neither the unit of length along rays nor jitter counts. */
static void step_and_jitter_change_no_bit(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 24, 25, 26, 12u);
  c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
  case_render(*state, &c, &drawn);
  c.options.sampling.distance = 3.0;
  c.options.sampling.jitter = 1;
  case_render(*state, &c, &other);
  assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
  assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
  assert_memory_equal(drawn.depth, other.depth, sizeof drawn.depth);
  case_destroy(&c);
}

static void planes_and_regions_cut_cells(void** state)
{
  static float reference[4 * CASE_PIXELS_MOST];
  for (int what = 0; what < 3; ++what) {
    picture_case c;
    char name[32];
    case_create(*state, &c, STRATUS_FLOAT32, 24, 25, 26, 13u);
    c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
    c.options.sampling.cell_error = 1.0 / 16384;
    c.volume.cell_centered = what == 2;
    if (what == 0) {
      const double bounds[6] = { 3.3, 17.7, 2.2, 19.1, 5.5, 21.9 };
      c.options.clipping.crop = 1;
      memcpy(c.options.clipping.crop_bounds, bounds, sizeof bounds);
    } else {
      const double plane[4] = { 0.5, 0.3, -0.4, -1.3 };
      c.options.clipping.clip_plane_count = 1;
      memcpy(c.options.clipping.clip_planes[0], plane, sizeof plane);
    }
    const reference_scene scene = case_scene(&c);
    assert_int_equal(reference_render(&scene, CASE_WIDTH, CASE_HEIGHT, PIECE, reference, NULL), 0);
    snprintf(name, sizeof name, what ? "clipped" : "cropped");
    expect_near(name, psnr_of(*state, &c, reference), 60.0);
    case_destroy(&c);
  }
}

static void what_it_does_not_know_is_refused(void** state)
{
  stratus_context* context = *state;
  stratus_ray_caster* caster = NULL;
  uint8_t mask[8 * 8 * 8] = { 0 };
  const double gradient[2] = { 1, 0.5 };
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  for (int what = 0; what < 8; ++what) {
    static const char* const words[] = { "", "cells", "cells", "cell error", "cell error", "cell error", "light spread", "light spread" };
    picture_case c;
    case_create(context, &c, STRATUS_UINT8, 8, 8, 8, 14u);
    c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
    c.options.mask.bytes = what == 1 ? mask : NULL;
    c.options.light.shade = 1;
    c.transfer.gradient = gradient;
    c.transfer.gradient_count = what == 2;
    c.options.sampling.cell_error = what == 3 ? -0.1 : what == 4 ? (double)NAN : what == 5 ? (double)INFINITY : 0.0;
    c.options.sampling.light_spread = what == 6 ? -0.1 : what == 7 ? (double)NAN : 0.0;
    const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
    const stratus_status status = stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL);
    assert_int_equal(status, what == 0 ? STRATUS_OK : what < 3 ? STRATUS_UNSUPPORTED : STRATUS_INVALID_ARGUMENT);
    assert_true(what == 0 || strstr(stratus_context_message(context), words[what]));
    case_destroy(&c);
  }
  stratus_ray_caster_destroy(caster);
}

static int make_context(void** state)
{
  *state = case_context("host", 2);
  return 0;
}

static int drop_context(void** state)
{
  stratus_context_destroy(*state);
  return 0;
}

int test_ray_cells(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(the_error_falls_with_the_option),
    cmocka_unit_test(functions_by_steps_are_exact_at_every_cell_error),
    cmocka_unit_test(nearest_is_exact),
    cmocka_unit_test(a_linear_field_has_the_integral_of_its_function),
    cmocka_unit_test(step_and_jitter_change_no_bit),
    cmocka_unit_test(planes_and_regions_cut_cells),
    cmocka_unit_test(what_it_does_not_know_is_refused),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
