/* SPDX-License-Identifier: BSD-3-Clause
 * The path tracer itself: its random numbers, bits that depend on nothing but samples, any grid against the double reference, blocks,
 * hidden parts, tolerance, cancelling, and refusals. */
#include "grid_case.h"
#include "path_case.h"

#include "path.h"

#define WIDTH CASE_WIDTH
#define HEIGHT CASE_HEIGHT

static float images[3][4 * CASE_PIXELS_MOST], errors[2][4 * CASE_PIXELS_MOST];

/* The known answers of Salmon et al.'s library, Random123. */
static void random_numbers_are_those_of_philox(void** state)
{
  static const uint32_t known[3][10] = { { 0, 0, 0, 0, 0, 0, 0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8 },
    { 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd },
    { 0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344, 0xa4093822, 0x299f31d0, 0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1 } };
  (void)state;
  for (int i = 0; i < 3; ++i) {
    uint32_t word[4];
    memcpy(word, known[i], sizeof word);
    stratus_philox(known[i] + 4, word);
    assert_memory_equal(word, known[i] + 6, sizeof word);
  }
}

/* Moments of the phase function of Henyey and Greenstein about any direction w: the mean direction is g w, and the mean of its products
 * with itself is (1 - m) / 2 + (3 m - 1) / 2 w w, where m = (1 + 2 g^2) / 3 is that of the squared cosine. */
static void scattered_directions_have_the_phase_function_s_moments(void** state)
{
  static const double directions[][3] = { { 0, 0, 1 }, { 0, 0, -1 }, { 1, 0, 0 }, { 0.6, -0.48, 0.64 }, { -0.48, 0.6, -0.64 } };
  static const double anisotropies[] = { 0.0, 1e-7, 0.5, -0.85, 0.99, -0.99 };
  const int count = path_samples(20000);
  double most = 0.0;
  (void)state;
  for (int k = 0; k < 30; ++k) {
    const double g = anisotropies[k / 5], *w = directions[k % 5], m = (1.0 + 2.0 * g * g) / 3.0;
    double mean[3] = { 0 }, product[3][3] = { { 0 } };
    stratus_path_random random = stratus_path_random_of(5, 0, (uint64_t)k);
    for (int i = 0; i < count; ++i) {
      double d[3] = { w[0], w[1], w[2] };
      stratus_path_scatter(g, &random, d);
      assert_true(fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1.0) < 1e-12);
      for (int a = 0; a < 9; ++a) {
        product[a / 3][a % 3] += d[a / 3] * d[a % 3] / count;
        mean[a % 3] += a < 3 ? d[a] / count : 0.0;
      }
    }
    for (int a = 0; a < 9; ++a) { /* numbers of -1..1 have deviations of 1 at most */
      const double expected = (a / 3 == a % 3 ? 0.5 * (1.0 - m) : 0.0) + 0.5 * (3.0 * m - 1.0) * w[a / 3] * w[a % 3];
      most = fmax(most, fabs(product[a / 3][a % 3] - expected));
      most = fmax(most, a < 3 ? fabs(mean[a] - g * w[a]) : 0.0);
    }
  }
  print_message(
    "             largest difference of 360 moments %.5f, %.2f standard errors of a number of deviation 1\n", most, most * sqrt(count));
  assert_true(most < 3.0 / sqrt(count)); /* of uniform directions, which have the largest deviations, 5 standard errors */
}

/* Ratio tracking through a linear field, whose blocks have extinctions far below their largest one, to transmittances where the estimate
 * ends at random. */
static void transmittance_has_its_closed_form(void** state)
{
  static const double thick[] = { 1.0, 4.0, 6.0 };
  for (int i = 0; i < 6; ++i) {
    path_case c;
    const double depth = thick[i / 2] * (0.05 * log(0.05) + 0.95) / 0.95; /* as of test_path_single's ramp */
    path_slab(*state, &c, 1.0, thick[i / 2], 8);
    for (int v = 0; v < 32; ++v) {
      c.values[v] = v / 4 / 7.0;
    }
    const double ramp[] = { 0.0, 0.0, 1.0, 0.95 };
    memcpy(c.opacity, ramp, sizeof ramp);
    c.transfer.opacity_count = 2;
    c.options.block_size = i % 2 ? 1 : 1000;
    stratus_path_field field = { .majorant = NULL };
    stratus_path_field_set(&field, &c.volume, &c.transfer, &c.options);
    assert_int_equal(stratus_path_field_build(*state, &field), STRATUS_OK);
    const int count = path_samples(40000);
    double sum = 0.0, square = 0.0;
    for (int sample = 0; sample < count; ++sample) {
      const double world[3] = { 0.3, 0.2, i % 2 ? -1.0 : 10.0 }, along[3] = { 0, 0, i % 2 ? 1.0 : -1.0 };
      stratus_path_ray ray = { .end = 20.0 };
      stratus_path_random random = stratus_path_random_of((uint64_t)i, 1, (uint64_t)sample);
      stratus_path_to_place(&field, world, ray.from);
      stratus_path_turn_to_place(&field, along, ray.along);
      stratus_path_clip(&field, &ray);
      const double left = stratus_path_transmittance(&field, &ray, &random);
      sum += left / count;
      square += left * left / count;
    }
    path_assert("transmittance", exp(-depth), sum, sqrt((square - sum * sum) / count), 0.1);
    stratus_path_field_release(*state, &field);
  }
}

static stratus_status draw(
  stratus_path_tracer* tracer, const picture_case* c, const stratus_path_options* options, float* rgba, stratus_path_report* report)
{
  const stratus_image image = { .width = WIDTH, .height = HEIGHT, .rgba = rgba, .opaque_depth = c->opaque_depth };
  return stratus_path_tracer_render(tracer, &c->volume, &c->transfer, &c->camera, options, &image, report);
}

/* Draws with a tracer of its own. */
static void draw_new(stratus_context* context, const picture_case* c, const stratus_path_options* options, float* rgba, float* deviations)
{
  stratus_path_tracer* tracer = NULL;
  assert_int_equal(stratus_path_tracer_create(context, &tracer), STRATUS_OK);
  if (draw(tracer, c, options, rgba, NULL) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  if (deviations) {
    assert_int_equal(stratus_path_tracer_errors(tracer, deviations), STRATUS_OK);
  }
  stratus_path_tracer_destroy(tracer);
}

static stratus_path_options options_of(const picture_case* c)
{
  stratus_path_options options = stratus_path_options_default();
  options.clipping = c->options.clipping;
  options.mask = c->options.mask;
  options.interpolation = c->options.sampling.interpolation;
  return options;
}

/* Every type, grid, hole, ghost, crop, plane and camera, against the reference renderer. The squares of the errors by the standard errors
 * of alpha have the mean 1. */
static void alpha_is_that_of_the_double_reference(void** state)
{
  double sum = 0.0, count = 0.0, bias = 0.0, variance = 0.0;
  const int samples = 64;
  for (test_seeds s = test_seeds_of(36, 600); test_next(&s);) {
    picture_case c;
    grid_case grid;
    case_create_random(*state, s.seed, &c);
    if (s.seed % 3 == 0) {
      grid_case_set_random(*state, s.seed, &c, &grid);
    }
    if (s.seed % 4 == 1) { /* an optical depth of hundreds a voxel, whose largest extinctions are of parts of cells */
      c.transfer.unit_distance = 0.01;
    }
    const reference_scene scene = case_scene(&c);
    stratus_path_options options = options_of(&c);
    options.samples = samples;
    options.albedo = 0.0;
    options.seed = s.seed;
    options.block_size = (int)(s.seed % 5);
    draw_new(*state, &c, &options, images[0], NULL);
    assert_int_equal(reference_render(&scene, WIDTH, HEIGHT, 0.5, images[1], NULL), 0);
    for (int i = 3; i < 4 * CASE_PIXELS; i += 4) {
      const double expected = (double)images[1][i], found = (double)images[0][i], square = expected * (1.0 - expected) / samples;
      if (expected < 1e-9 || expected > 1.0 - 1e-9) { /* never, or always */
        assert_true(fabs(found - expected) < 1e-3);
      } else {
        bias += found - expected;
        variance += square;
        if (square > 0.05 / samples) { /* so that a square of so few samples spreads little more than a normal number's */
          sum += (found - expected) * (found - expected) / square;
          count += 1.0;
        }
      }
    }
    case_destroy(&c);
  }
  print_message("             %.0f pixels: mean square %.4f of the expected one, bias %+.2f standard errors\n", count, sum / count,
    bias / sqrt(variance));
  assert_true(count > case_share(2000));
  assert_true(fabs(sum / count - 1.0) < PATH_SIGMAS * sqrt(2.5 / count)); /* a square's variance is 2 + (1 - 6 square) / square / samples */
  assert_true(fabs(bias) < PATH_SIGMAS * sqrt(variance));
}

/* A scene with several scatterings, light and sky. */
static stratus_path_options make_cloud(stratus_context* context, picture_case* c, uint32_t seed)
{
  case_create(context, c, STRATUS_FLOAT32, 22, 18, 20, seed);
  stratus_path_options options = options_of(c);
  options.albedo = 0.9;
  options.anisotropy = 0.4;
  options.light_count = 1;
  options.lights[0] = (stratus_light){ .vector = { 1, -0.5, 2 }, .color = { 1, 0.9, 0.8 } };
  options.sky_zenith[2] = 0.5;
  options.sky_horizon[0] = 0.2;
  return options;
}

/* Squares of differences by the sums of the squares of both errors have the mean 1; their sum has the mean 0. */
static void assert_same_light(const char* what)
{
  double sum = 0.0, count = 0.0, bias = 0.0, variance = 0.0;
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    const double difference = (double)images[0][i] - (double)images[1][i];
    const double square = (double)errors[0][i] * (double)errors[0][i] + (double)errors[1][i] * (double)errors[1][i];
    bias += i % 4 == 3 ? 0.0 : difference;
    variance += i % 4 == 3 ? 0.0 : square;
    if (i % 4 == 1 && images[0][i + 2] > 0.3f && images[0][i + 2] < 0.9f) {
      sum += difference * difference / square;
      count += 1.0;
    }
  }
  print_message("             %s: %.0f pixels, mean square %.3f of the expected one, bias %+.2f standard errors at most\n", what, count,
    sum / count, bias / sqrt(variance));
  assert_true(count > 100.0 && sum / count > 0.75 && sum / count < 1.25);
  assert_true(fabs(bias) < 1.75 * PATH_SIGMAS * sqrt(variance)); /* of three channels of the same paths */
}

static void blocks_change_the_numbers_but_not_the_light(void** state)
{
  static const int sizes[] = { 1, 4, 1000 };
  picture_case c;
  stratus_path_options options = make_cloud(*state, &c, 5);
  options.samples = path_samples(48);
  draw_new(*state, &c, &options, images[0], errors[0]); /* blocks of 4 */
  for (int i = 0; i < 3; ++i) {
    char what[48];
    snprintf(what, sizeof what, "blocks of %d, another seed", sizes[i]);
    options.block_size = sizes[i];
    options.seed = 7u + (uint64_t)i;
    draw_new(*state, &c, &options, images[1], errors[1]);
    assert_same_light(what);
  }
  case_destroy(&c);
}

static void bits_depend_on_the_number_of_samples_only(void** state)
{
  stratus_context* one = case_context("host", 1);
  stratus_path_tracer* tracer = NULL;
  stratus_path_report report;
  picture_case c;
  stratus_path_options options = make_cloud(*state, &c, 6);
  options.samples = 24;
  draw_new(*state, &c, &options, images[0], errors[0]);
  draw_new(one, &c, &options, images[1], errors[1]);
  assert_memory_equal(images[0], images[1], sizeof images[0]);
  assert_memory_equal(errors[0], errors[1], sizeof errors[0]);
  assert_int_equal(stratus_path_tracer_create(*state, &tracer), STRATUS_OK);
  static const int parts[] = { 1, 7, 16 };
  for (int i = 0; i < 3; ++i) {
    options.samples = parts[i];
    assert_int_equal(draw(tracer, &c, &options, images[1], &report), STRATUS_OK);
    assert_int_equal(report.restarted, i == 0);
    assert_true(isnan(report.standard_error) == (i == 0));
  }
  assert_int_equal(report.samples, 24);
  assert_memory_equal(images[0], images[1], sizeof images[0]);
  /* Whatever changes, the image is the one of a new tracer. */
  for (int change = 0; change < 12; ++change) {
    const double other[] = { -21.0, 0.1, -20.0, 0.9 };
    options.anisotropy = change == 0 ? 0.2 : options.anisotropy;
    options.seed = change == 1 ? 3 : options.seed;
    options.lights[0].color[1] = change == 2 ? 2.0 : options.lights[0].color[1];
    options.sky_zenith[1] = change == 3 ? 1.0 : options.sky_zenith[1];
    options.bounces = change == 4 ? 3 : options.bounces;
    c.camera.eye[0] += change == 5 ? 0.5 : 0.0;
    c.transfer.unit_distance = change == 6 ? 2.0 : c.transfer.unit_distance;
    memcpy(c.opacity, other, change == 7 ? sizeof other : 0);
    c.volume.revision += change == 8;
    c.volume.spacing[1] = change == 9 ? 1.5 : c.volume.spacing[1];
    options.clipping.clip_plane_count = change >= 10;
    options.clipping.clip_planes[0][3] = change == 10 ? 1.0 : 2.0;
    ((float*)c.values)[4000] += change == 8 ? 1.0f : 0.0f;
    options.samples = 3;
    assert_int_equal(draw(tracer, &c, &options, images[0], &report), STRATUS_OK);
    assert_int_equal(report.restarted, 1);
    assert_int_equal(report.samples, 3);
    draw_new(*state, &c, &options, images[1], NULL);
    assert_memory_equal(images[0], images[1], sizeof images[0]);
  }
  stratus_path_tracer_destroy(tracer);
  stratus_context_destroy(one);
  case_destroy(&c);
}

static void a_tolerance_ends_the_call(void** state)
{
  stratus_path_tracer* tracer = NULL;
  stratus_path_report report;
  picture_case c;
  stratus_path_options options = make_cloud(*state, &c, 6);
  double before = 1.0;
  assert_int_equal(stratus_path_tracer_create(*state, &tracer), STRATUS_OK);
  options.samples = 1000000;
  for (int i = 0; i < 2; ++i) {
    options.tolerance = i ? 0.04 : 0.08;
    assert_int_equal(draw(tracer, &c, &options, images[0], &report), STRATUS_OK);
    print_message("             tolerance %.3f: %d samples, standard error %.4f, %.4f at most, %.2f s\n", options.tolerance,
      (int)report.samples, report.standard_error, report.largest_error, report.seconds);
    assert_true(report.standard_error <= options.tolerance && report.standard_error > 0.7 * options.tolerance);
    assert_true(report.largest_error > report.standard_error && report.standard_error < before && report.samples < 2000);
    before = report.standard_error;
  }
  assert_int_equal(stratus_path_tracer_errors(tracer, errors[0]), STRATUS_OK);
  double squares = 0.0, count = 0.0; /* against another seed and many more samples, the error is as large as reported */
  options.tolerance = 0.0;
  options.samples = (int)report.samples * 4;
  options.seed = 4;
  draw_new(*state, &c, &options, images[1], errors[1]);
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    if (images[0][i / 4 * 4 + 3] > 0.0f) {
      squares += ((double)images[0][i] - (double)images[1][i]) * ((double)images[0][i] - (double)images[1][i]);
      count += 1.0;
    }
  }
  const double found = sqrt(squares / count / (1.0 + 1.0 / 4.0));
  print_message("             standard error by another image %.4f\n", found);
  assert_true(fabs(found / report.standard_error - 1.0) < 0.1);
  stratus_path_tracer_destroy(tracer);
  case_destroy(&c);
}

/* A slab of which only the lower part shows: alpha and single scattering are of a slab as thick as that part. dense: the whole slab has a
 * depth of 40 in one block, which is cut into shorter stretches. */
static void hidden_parts_neither_absorb_nor_cast_a_shadow(void** state)
{
  static const char* const names[] = { "clip planes", "crop box", "crop regions", "mask", "hidden cells", "a matrix and clip planes",
    "crop regions of falling coordinates", "hidden values, nearest", "mask, nearest" };
  static const double falling[9] = { 1.0, 0.875, 0.75, 0.625, 0.5, 0.375, 0.25, 0.125, 0.0 };
  static uint8_t bytes[4 * 9];
  for (int run = 0; run < 18; ++run) {
    const bool dense = run >= 9;
    const int kind = run % 9;
    path_case c;
    char what[64];
    double shown = dense ? 0.0625 : 0.3125;
    const double sigma = dense ? 40.0 : 2.0, sun = 0.6;
    path_slab(*state, &c, sigma, 1.0, 9);
    stratus_ray_clipping_options* clipping = &c.options.clipping;
    const double planes[2][4] = { { 0, 0, -2, 2.0 * shown }, { 1, 0, 0, 3 } };
    for (int side = 0; side < 6; ++side) {
      clipping->crop_bounds[side] = side % 2 ? 2e4 : -2e4;
    }
    if (kind == 0 || kind == 5) {
      clipping->clip_plane_count = 2;
      memcpy(clipping->clip_planes, planes, sizeof planes);
    } else if (kind == 1) {
      clipping->crop = 1;
      clipping->crop_bounds[5] = shown;
    } else if (kind == 2 || kind == 6) { /* below the lower plane, and between the others */
      clipping->crop = 1;
      clipping->crop_bounds[4] = shown;
      clipping->crop_bounds[5] = 0.5;
      clipping->crop_regions = 1u << 4;
      c.volume.coordinates[2] = kind == 6 ? falling : NULL;
    } else if (kind == 3 || kind == 8) { /* values 0, 1, 2 of the nine layers show, up to half a layer beyond; dense: only value 0 */
      memset(bytes, 0, sizeof bytes);
      memset(bytes, 1, dense ? 4 : 12);
      c.options.mask.bytes = bytes;
    } else { /* 2 of 8 cells show, or 2 of 9 values of cells; dense: 1 */
      memset(bytes, STRATUS_GHOST_HIDDEN_CELL, sizeof bytes);
      memset(bytes, 0, (size_t)((dense ? 1 : 2) * (kind == 7 ? 4 : 1)));
      c.volume.cell_ghosts = bytes;
      c.volume.cell_centered = kind == 7;
      shown = dense ? 0.125 : 0.25;
    }
    if (kind == 5) { /* x and y sheared, z doubled, and the slab as thick again as the planes show */
      const double matrix[16] = { 1, 0.3, 0, 0, 0, -2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1 };
      memcpy(c.volume.matrix, matrix, sizeof matrix);
    }
    path_sun(&c, sun);
    c.options.interpolation = kind >= 7 ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
    c.options.block_size = dense ? 1000 : 0;
    c.options.bounces = 1;
    c.options.seed = (uint64_t)run;
    c.options.samples = path_samples(400);
    const double rate = 1.0 + 1.0 / sun;
    const path_mean mean = path_draw(*state, &c);
    snprintf(what, sizeof what, "%s%s, alpha", dense ? "dense " : "", names[kind]);
    path_assert(what, -expm1(-sigma * shown), mean.rgba[3], mean.error[3], 0.02);
    snprintf(what, sizeof what, "%s%s, light", dense ? "dense " : "", names[kind]);
    path_assert(what, -expm1(-sigma * shown * rate) / rate, mean.rgba[0], mean.error[0], 0.02);
  }
}

/* Opaque geometry and the camera's planes end rays from the camera. The sun reaches all of the medium. */
static void opaque_depth_ends_rays_from_the_camera(void** state)
{
  static float depth[PATH_PIXELS];
  path_case c;
  const double sun = 0.5, rate = 1.0 + 1.0 / sun;
  path_slab(*state, &c, 2.0, 1.0, 3);
  path_sun(&c, sun);
  c.camera.near_k = 9.0; /* the eye is 10 above the middle */
  c.camera.far_k = 11.0;
  for (int i = 0; i < PATH_PIXELS; ++i) {
    depth[i] = 0.375f; /* a depth of 9.75, a quarter into the slab */
  }
  c.opaque_depth = depth;
  c.options.bounces = 1;
  c.options.samples = path_samples(1500);
  const path_mean mean = path_draw(*state, &c);
  path_assert("alpha before opaque geometry", -expm1(-0.5), mean.rgba[3], mean.error[3], 0.01);
  path_assert("light before opaque geometry", -expm1(-0.5 * rate) / rate, mean.rgba[0], mean.error[0], 0.01);
  c.opaque_depth = NULL;
  c.camera.near_k = 9.75;
  const path_mean near = path_draw(*state, &c);
  path_assert("alpha behind the near plane", -expm1(-1.5), near.rgba[3], near.error[3], 0.01);
  path_assert("light behind the near plane", exp(-0.5 / sun) * -expm1(-1.5 * rate) / rate, near.rgba[0], near.error[0], 0.01);
}

/* An opaque ground under a sheer rise of the opacity, in voxels ten thousand times as wide as high. Rays that pass above it meet nothing,
 * and rays down collide where it begins. Neither needs more than a few steps in any cell, though a voxel's width has an optical depth of
 * millions.
 */
static void rays_along_an_opaque_surface_are_cheap(void** state)
{
  for (int along = 0; along < 2; ++along) {
    static float depth[PATH_PIXELS], rgba[4 * PATH_PIXELS];
    path_case c;
    stratus_path_tracer* tracer = NULL;
    stratus_path_report report;
    path_slab(*state, &c, 1.0, 1.0, 5);
    for (int i = 0; i < 20; ++i) {
      c.values[i] = 1.0 - i / 4 / 4.0; /* falls from 1 to 0 */
    }
    const double step[] = { 0.0, 0.0, 0.6, 0.0, 0.6, 1.0, 1.0, 1.0 };
    memcpy(c.opacity, step, sizeof step);
    c.transfer.opacity_count = 4;
    c.options.samples = 200;
    c.options.albedo = 0.0;
    if (along) { /* at height .41, where the opacity begins at .4 */
      const stratus_camera level = { .eye = { -2e4, 0, 0.41 },
        .forward = { 1, 0, 0 },
        .up = { 0, 0, 1e-3 },
        .right = { 0, -1, 0 },
        .far_k = (double)INFINITY,
        .parallel = 1 };
      c.camera = level;
    }
    const stratus_image image = { .width = PATH_SIDE, .height = PATH_SIDE, .rgba = rgba, .depth = depth };
    assert_int_equal(stratus_path_tracer_create(*state, &tracer), STRATUS_OK);
    assert_int_equal(stratus_path_tracer_render(tracer, &c.volume, &c.transfer, &c.camera, &c.options, &image, &report), STRATUS_OK);
    for (int i = 0; i < PATH_PIXELS; ++i) {
      assert_true(rgba[4 * i + 3] == (along ? 0.0f : 1.0f));
      assert_true(along || fabsf(depth[i] - 10.1f) < 1e-3f); /* the least of 200, the eye is at 10.5 */
    }
    print_message("             %.1f values a path\n", (double)report.lookups / 200 / PATH_PIXELS);
    assert_true((double)report.lookups < 40.0 * 200 * PATH_PIXELS);
    stratus_path_tracer_destroy(tracer);
  }
}

/* The image's other buffers. */
static void depth_samples_and_bytes_are_the_image_s(void** state)
{
  static float depth[CASE_PIXELS_MOST];
  static uint32_t samples[CASE_PIXELS_MOST];
  static uint8_t bytes[4 * CASE_PIXELS_MOST];
  stratus_path_tracer* tracer = NULL;
  picture_case c;
  stratus_path_options options = make_cloud(*state, &c, 9);
  int lit = 0;
  options.samples = 5;
  options.lights[0].color[0] = 9.0; /* brighter than bytes */
  const stratus_image image = { .width = WIDTH, .height = HEIGHT, .rgba = images[0], .depth = depth, .samples = samples, .rgba8 = bytes };
  assert_int_equal(stratus_path_tracer_create(*state, &tracer), STRATUS_OK);
  assert_int_equal(stratus_path_tracer_render(tracer, &c.volume, &c.transfer, &c.camera, &options, &image, NULL), STRATUS_OK);
  for (int i = 0; i < CASE_PIXELS; ++i) {
    const float* rgba = images[0] + 4 * i;
    assert_true((rgba[3] > 0.0f) == (depth[i] < INFINITY) && depth[i] > 0.0f && samples[i] == 5);
    for (int channel = 0; channel < 4; ++channel) {
      const double byte = fmin((double)rgba[channel] * 255.0, 255.0);
      assert_true(fabs(byte - bytes[4 * i + channel]) <= 0.501);
    }
    lit += rgba[0] > 1.0f;
  }
  assert_true(lit > 50);
  stratus_path_tracer_destroy(tracer);
  case_destroy(&c);
}

static int stop_after(void* user, const char* stage, double fraction)
{
  int* calls = user;
  return strcmp(stage, "path tracing") == 0 && fraction > 0.2 && --*calls <= 0;
}

static void a_cancelled_call_is_continued(void** state)
{
  stratus_context* context = NULL;
  stratus_context_options context_options = stratus_context_options_default();
  stratus_path_tracer* tracer = NULL;
  stratus_path_report report;
  picture_case c;
  int calls = 1;
  stratus_path_options options = make_cloud(*state, &c, 6);
  context_options.device = "host";
  context_options.threads = 2;
  context_options.progress = stop_after;
  context_options.progress_user = &calls;
  options.samples = 12;
  draw_new(*state, &c, &options, images[0], NULL);
  assert_int_equal(stratus_context_create(&context_options, &context, NULL, 0), STRATUS_OK);
  assert_int_equal(stratus_path_tracer_create(context, &tracer), STRATUS_OK);
  assert_int_equal(draw(tracer, &c, &options, images[1], &report), STRATUS_CANCELLED);
  assert_int_equal(stratus_path_tracer_errors(tracer, errors[0]), STRATUS_INVALID_ARGUMENT); /* no pass has ended */
  calls = INT32_MAX;
  assert_int_equal(draw(tracer, &c, &options, images[1], &report), STRATUS_OK);
  assert_memory_equal(images[0], images[1], sizeof images[0]);
  assert_true(report.seconds > 0.0 && report.vertices > 0);
  stratus_path_tracer_destroy(tracer);
  stratus_context_destroy(context);
  case_destroy(&c);
}

static void refusals_name_the_value_and_its_range(void** state)
{
  stratus_context* context = *state;
  static uint8_t bytes[22 * 18 * 20];
  static const double factors[] = { 0.0, 0.5, 1.0, 1.0 };
  static const struct {
    const char* message;
    stratus_status status;
  } expected[] = { { "0 samples a pixel, must be 1..1000000000", STRATUS_INVALID_ARGUMENT },
    { "tolerance -1, must be at least 0", STRATUS_INVALID_ARGUMENT }, { "-1 bounces, must be", STRATUS_INVALID_ARGUMENT },
    { "albedo 1.01, must be 0..1", STRATUS_INVALID_ARGUMENT }, { "anisotropy -1, must be -0.99..0.99", STRATUS_INVALID_ARGUMENT },
    { "anisotropy nan, must be", STRATUS_INVALID_ARGUMENT }, { "interpolation 2, must be 0..1", STRATUS_INVALID_ARGUMENT },
    { "block_size -4, must be 1..1000000", STRATUS_INVALID_ARGUMENT }, { "9 lights, must be 0..8", STRATUS_INVALID_ARGUMENT },
    { "light 0 has the direction (0, 0, 0)", STRATUS_INVALID_ARGUMENT }, { "-2 (zenith)", STRATUS_INVALID_ARGUMENT },
    { "up is (0, 0, 0)", STRATUS_INVALID_ARGUMENT }, { "7 clip planes, must be 0..6", STRATUS_INVALID_ARGUMENT },
    { "clip plane 0 has coefficient inf", STRATUS_INVALID_ARGUMENT }, { "crop bounds 2..1", STRATUS_INVALID_ARGUMENT },
    { "through 3 labels, must be 0", STRATUS_UNSUPPORTED }, { "gradient opacity of 2 points", STRATUS_UNSUPPORTED },
    { "volume of 2 components, must be 1", STRATUS_UNSUPPORTED }, { "DUPLICATE ghosts", STRATUS_UNSUPPORTED } };
  stratus_path_tracer* tracer = NULL;
  assert_int_equal(stratus_path_tracer_create(context, &tracer), STRATUS_OK);
  for (int i = 0; i < (int)(sizeof expected / sizeof *expected); ++i) {
    picture_case c;
    stratus_path_options o = make_cloud(context, &c, 6);
    o.samples = i == 0 ? 0 : 1;
    o.tolerance = i == 1 ? -1.0 : 0.0;
    o.bounces = i == 2 ? -1 : 0;
    o.albedo = i == 3 ? 1.01 : 1.0;
    o.anisotropy = i == 4 ? -1.0 : i == 5 ? (double)NAN : 0.0;
    o.interpolation = i == 6 ? (stratus_interpolation)2 : STRATUS_INTERPOLATION_LINEAR;
    o.block_size = i == 7 ? -4 : 0;
    o.light_count = i == 8 ? 9 : 1;
    o.lights[0].vector[0] = o.lights[0].vector[1] = o.lights[0].vector[2] = i == 9 ? 0.0 : 1.0;
    o.sky_zenith[1] = i == 10 ? -2.0 : 0.0;
    o.up[2] = i == 11 ? 0.0 : 1.0;
    o.clipping.clip_plane_count = i == 12 ? 7 : i == 13;
    o.clipping.clip_planes[0][2] = (double)INFINITY;
    o.clipping.crop = i == 14;
    o.clipping.crop_bounds[0] = 2.0;
    o.clipping.crop_bounds[1] = 1.0;
    o.mask.bytes = i == 15 ? bytes : NULL;
    o.mask.label_count = 3;
    c.transfer.gradient = factors;
    c.transfer.gradient_count = i == 16 ? 2 : 0;
    c.volume.components = i == 17 ? 2 : 1;
    c.volume.value_stride = i == 17 ? 2 : 1;
    c.volume.cell_centered = i == 18;
    memset(bytes, STRATUS_GHOST_DUPLICATE, 22 * 18);
    c.volume.cell_ghosts = i == 18 ? bytes : NULL;
    const stratus_status status = draw(tracer, &c, &o, images[0], NULL);
    if (status != expected[i].status || !strstr(stratus_context_message(context), expected[i].message)) {
      fail_msg("%d: %s: \"%s\", expected \"%s\"", i, stratus_status_name(status), stratus_context_message(context), expected[i].message);
    }
    case_destroy(&c);
  }
  stratus_path_tracer_destroy(tracer);
}

int test_path_tracer(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(random_numbers_are_those_of_philox),
    cmocka_unit_test(scattered_directions_have_the_phase_function_s_moments), cmocka_unit_test(transmittance_has_its_closed_form),
    cmocka_unit_test(alpha_is_that_of_the_double_reference), cmocka_unit_test(blocks_change_the_numbers_but_not_the_light),
    cmocka_unit_test(bits_depend_on_the_number_of_samples_only), cmocka_unit_test(a_tolerance_ends_the_call),
    cmocka_unit_test(hidden_parts_neither_absorb_nor_cast_a_shadow), cmocka_unit_test(opaque_depth_ends_rays_from_the_camera),
    cmocka_unit_test(rays_along_an_opaque_surface_are_cheap), cmocka_unit_test(depth_samples_and_bytes_are_the_image_s),
    cmocka_unit_test(a_cancelled_call_is_continued), cmocka_unit_test(refusals_name_the_value_and_its_range) };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
