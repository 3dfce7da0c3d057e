/* SPDX-License-Identifier: BSD-3-Clause
 * Lit samples, compared with the double reference, which shades in doubles. Also every instruction set and structure to the bit, and each
 * number of the shading by its effect. */
#include "picture_case.h"

#include "volume.h"

/* Limit in dB against the reference at a quarter of a voxel. Light multiplies colours that are sampled at equal places, so lit
 * pictures have the sampling error and the limit of unlit ones. */
#define MIDPOINT_DB 58.0

static picture drawn;
static picture other;

static double lit_psnr(const char* what, stratus_context* context, const picture_case* c, double wanted)
{
  static float reference[4 * CASE_PIXELS_MOST];
  reference_scene scene = case_scene(c);
  double reference_db = 0.0;
  scene.shading = &c->options.light.shading;
  case_render(context, c, &drawn);
  assert_int_equal(reference_converged(&scene, CASE_WIDTH, CASE_HEIGHT, 62.0, reference, NULL, &reference_db), 0);
  const double db = reference_psnr(drawn.rgba, reference, CASE_PIXELS);
  print_message("             %s: %.1f dB, reference %.0f dB, %d pixels\n", what, db, reference_db, case_lit(&drawn));
  assert_true(case_lit(&drawn) > case_share(20));
  assert_true(db >= wanted);
  return db;
}

static void shine(picture_case* c)
{
  c->options.light.shade = 1;
  c->options.light.shading.ambient = 0.15;
  c->options.light.shading.diffuse = 0.7;
  c->options.light.shading.specular = 0.35;
  c->options.light.shading.specular_power = 12.5;
}

static void pictures_are_lit_as_the_reference_lights_them(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  case_create(context, &c, STRATUS_FLOAT32, 30, 26, 28, 5);
  shine(&c);
  lit_psnr("light at the eye", context, &c, MIDPOINT_DB);

  c.options.light.shading.light_count = 2;
  c.options.light.shading.lights[0] = (stratus_light){ .vector = { 3, -1, 2 }, .color = { 1, 0.4, 0.2 } };
  c.options.light.shading.lights[1] = (stratus_light){ .vector = { 40, 50, -10 }, .color = { 0.2, 0.5, 1.5 }, .positional = 1 };
  lit_psnr("two lights, two-sided", context, &c, MIDPOINT_DB);
  c.options.light.shading.one_sided = 1;
  lit_psnr("two lights, one-sided", context, &c, MIDPOINT_DB);
  c.options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
  lit_psnr("pre-integrated", context, &c, MIDPOINT_DB);
  c.options.light.shading.lights[0].separate_specular = 1; /* the other light's highlights keep its colour */
  c.options.light.shading.lights[0].specular_color[1] = 3.0;
  lit_psnr("highlights of a colour of their own", context, &c, MIDPOINT_DB);
  case_destroy(&c);

  case_create(context, &c, STRATUS_UINT8, 31, 27, 22, 6);
  shine(&c);
  c.volume.spacing[0] = 0.7;
  c.volume.spacing[1] = 1.6;
  const double turned[16] = { 0.8, -0.6, 0, 30, 0.6, 0.8, 0.1, -7, 0, 0, -1.2, 900, 0, 0, 0, 1 };
  memcpy(c.volume.matrix, turned, sizeof turned);
  case_camera(context, &c, 3, 1);
  lit_psnr("uneven, turned, mirrored and sheared; parallel", context, &c, MIDPOINT_DB);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Rays by cells take light at places that neighbouring stretches share. The picture converges to the reference as the spread about a place
 * falls, with no more samples; places that are far apart are seen. Where normals are turned to the eye, light jumps along a ray. */
static void rays_by_cells_are_lit_at_shared_places(void** state)
{
  (void)state;
  static const double spreads[] = { 1e-5, 1e-3, 1e-1 }, wanted[] = { 70.0, 55.0, 35.0 };
  stratus_context* context = case_context("host", 2);
  for (int way = 0; way < 4; ++way) {
    const int turned = way & 1, both_sides = way / 2;
    picture_case c;
    double last = INFINITY;
    case_create(context, &c, turned ? STRATUS_UINT8 : STRATUS_FLOAT32, 30, 26, 28, 5);
    shine(&c);
    c.options.light.shading.light_count = 2;
    c.options.light.shading.lights[0] = (stratus_light){ .vector = { 3, -1, 2 }, .color = { 1, 0.4, 0.2 } };
    c.options.light.shading.lights[1] = (stratus_light){ .vector = { 40, 50, -10 }, .color = { 0.2, 0.5, 1.5 }, .positional = 1 };
    c.options.light.shading.one_sided = !both_sides;
    c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
    c.options.sampling.cell_error = 1e-4;
    if (turned) {
      const double matrix[16] = { 0.8, -0.6, 0, 30, 0.6, 0.8, 0.1, -7, 0, 0, -1.2, 900, 0, 0, 0, 1 };
      memcpy(c.volume.matrix, matrix, sizeof matrix);
      c.volume.spacing[1] = 1.6;
      case_camera(context, &c, 3, 1);
    }
    for (int i = 0; i < 3; ++i) {
      c.options.sampling.light_spread = spreads[i];
      const double db = lit_psnr(both_sides ? "by cells, both sides" : "by cells", context, &c, wanted[i]);
      assert_true(db < last);
      last = db;
    }
    case_destroy(&c);
  }
  stratus_context_destroy(context);
}

/* Where the field is smooth, samples are as long as without light: one that makes much of a pixel is lit at several places. */
static void long_samples_are_lit_at_several_places(void** state)
{
  static const double tolerances[] = { 0.02, 0.005 };
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  case_create(context, &c, STRATUS_FLOAT32, 30, 26, 28, 5);
  shine(&c);
  c.options.sampling.distance = 0.0;
  for (int i = 0; i < 2; ++i) {
    uint64_t samples[2];
    c.options.sampling.tolerance = tolerances[i];
    for (int cells = 0; cells < 2; ++cells) {
      c.options.sampling.rule = cells ? STRATUS_SAMPLING_CELLS : STRATUS_SAMPLING_AUTO;
      lit_psnr(cells ? "by cells" : "by long samples", context, &c, -20.0 * log10(tolerances[i]));
      samples[cells] = drawn.report.samples;
      assert_int_equal(drawn.report.sampling, cells ? STRATUS_SAMPLING_CELLS : STRATUS_SAMPLING_LOCAL);
    }
    assert_true(3 * samples[0] < 2 * samples[1]);
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* A light that follows the camera is the same light as one in the world where it is now. */
static void lights_follow_the_camera(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  for (int parallel = 0; parallel < 2; ++parallel) {
    picture_case c;
    case_create(context, &c, STRATUS_FLOAT32, 30, 26, 28, 5);
    shine(&c);
    c.options.sampling.distance = 0.25;
    case_camera(context, &c, 3, parallel);
    c.options.light.shading.light_count = 2;
    stratus_light* lights = c.options.light.shading.lights;
    lights[0] = (stratus_light){ .vector = { 1, 2, 3 }, .color = { 1, 0.4, 0.2 }, .follows_camera = 1 };
    lights[1] = (stratus_light){ .vector = { -4, 5, -1 }, .color = { 0.2, 0.3, 0.2 }, .follows_camera = 1 };
    case_render(context, &c, &drawn);
    double basis[3][3];
    memcpy(basis[0], c.camera.right, sizeof basis[0]);
    memcpy(basis[1], c.camera.up, sizeof basis[1]);
    for (int a = 0; a < 3; ++a) {
      basis[2][a] = -c.camera.forward[a];
    }
    for (int i = 0; i < 3; ++i) {
      const double length = sqrt(basis[i][0] * basis[i][0] + basis[i][1] * basis[i][1] + basis[i][2] * basis[i][2]);
      for (int a = 0; a < 3; ++a) {
        basis[i][a] /= length;
      }
    }
    for (int l = 0; l < 2; ++l) {
      const stratus_light own = lights[l];
      for (int a = 0; a < 3; ++a) {
        lights[l].vector[a] = 0.0;
        for (int i = 0; i < 3; ++i) {
          lights[l].vector[a] += own.vector[i] * basis[i][a];
        }
      }
      lights[l].follows_camera = 0;
    }
    case_render(context, &c, &other);
    double largest = 0.0;
    for (size_t i = 0; i < 4 * CASE_PIXELS; ++i) {
      largest = fmax(largest, fabs((double)drawn.rgba[i] - (double)other.rgba[i]));
    }
    assert_true(case_lit(&drawn) > case_share(20) && largest < 1e-5);
    lights[0].vector[0] += 10.0;
    case_render(context, &c, &other);
    assert_memory_not_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    lights[0].positional = lights[0].follows_camera = 1;
    stratus_ray_caster* caster = NULL;
    const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba };
    assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    assert_int_equal(
      stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
    stratus_ray_caster_destroy(caster);
    case_destroy(&c);
  }
  stratus_context_destroy(context);
}

/* Lights that get weaker with the distance, and lamps that shine into a cone, whose border crosses the volume. */
static void lights_are_dimmed_and_have_cones_as_the_reference_says(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  case_create(context, &c, STRATUS_FLOAT32, 30, 26, 28, 5);
  shine(&c);
  c.options.light.shading.light_count = 2;
  stratus_light* lamps = c.options.light.shading.lights;
  lamps[0] = (stratus_light){ .vector = { 3, -1, 2 }, .color = { 0.2, 0.4, 0.9 } };
  lamps[1] = (stratus_light){ .vector = { 40, 50, -10 }, .color = { 20, 50, 15 }, .positional = 1, .attenuation = { 0.5, 0.02, 0.03 } };
  lit_psnr("dimmed", context, &c, MIDPOINT_DB);
  lamps[1] = (stratus_light){
    .vector = { 40, 40, -10 }, .color = { 4, 5, 2 }, .positional = 1, .cone_angle = 12.0, .axis = { -2.5, -2.7, 2.4 }, .cone_exponent = 8.0
  };
  c.options.sampling.distance = 0.02; /* the cone's border is a step */
  lit_psnr("a cone", context, &c, 55.0);
  const float before = drawn.rgba[4 * (CASE_HEIGHT / 2 * CASE_WIDTH + CASE_WIDTH / 2)];
  lamps[1].cone_angle = 90.0; /* is none */
  case_render(context, &c, &drawn);
  const float wide = drawn.rgba[4 * (CASE_HEIGHT / 2 * CASE_WIDTH + CASE_WIDTH / 2)];
  assert_true(wide != before);
  lamps[1].cone_angle = 0.0;
  case_render(context, &c, &drawn);
  assert_true(drawn.rgba[4 * (CASE_HEIGHT / 2 * CASE_WIDTH + CASE_WIDTH / 2)] == wide);
  c.volume.spacing[0] = 0.7; /* lengths are the world's */
  c.volume.spacing[1] = 1.6;
  const double turned[16] = { 0.8, -0.6, 0, 30, 0.6, 0.8, 0.1, -7, 0, 0, -1.2, 900, 0, 0, 0, 1 };
  memcpy(c.volume.matrix, turned, sizeof turned);
  case_camera(context, &c, 3, 1);
  c.options.sampling.distance = 0.2;
  lamps[1] = (stratus_light){ .vector = { 60, 40, 930 }, .color = { 30, 50, 15 }, .positional = 1, .attenuation = { 0.1, 0.2, 0.02 } };
  lit_psnr("dimmed; uneven, turned, mirrored and sheared", context, &c, MIDPOINT_DB);
  case_destroy(&c);
  stratus_context_destroy(context);
}

static void what_is_wrong_with_a_lamp_is_said(void** state)
{
  (void)state;
  static const struct {
    double attenuation, angle, axis, exponent;
    const char* word;
  } wrong[] = { { -0.25, 0, 0, 0, "-0.25" }, { NAN, 0, 0, 0, "nan" }, { 0, -7, 1, 0, "-7" }, { 0, INFINITY, 1, 0, "inf" },
    { 0, 30, 0, 1, "(0, 0, 0)" }, { 0, 30, NAN, 1, "nan" }, { 0, 30, 1, -2, "-2" } };
  stratus_context* context = case_context("host", 1);
  picture_case c;
  case_create(context, &c, STRATUS_FLOAT32, 5, 6, 7, 5);
  shine(&c);
  c.options.light.shading.light_count = 1;
  stratus_ray_caster* caster = NULL;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
    for (int positional = 0; positional < 2; ++positional) { /* fields that a directional light does not read are not checked */
      c.options.light.shading.lights[0] = (stratus_light){ .vector = { 3, -1, 2 },
        .color = { 1, 1, 1 },
        .positional = positional,
        .attenuation = { wrong[i].attenuation },
        .cone_angle = wrong[i].angle,
        .axis = { 0, wrong[i].axis },
        .cone_exponent = wrong[i].exponent };
      assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL),
        positional ? STRATUS_INVALID_ARGUMENT : STRATUS_OK);
      assert_true(!positional || strstr(stratus_context_message(context), wrong[i].word));
    }
  }
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Borders, cell data, nearest values and generic fetches are lit. */
static void border_voxels_and_every_type_are_lit(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  for (int type = STRATUS_INT8; type <= STRATUS_FLOAT64; ++type) {
    picture_case c;
    case_create(context, &c, (stratus_type)type, 9 + type, 5, 12, 11 + (uint32_t)type);
    shine(&c);
    c.volume.cell_centered = type % 2;
    case_camera(context, &c, type % 8, 0);
    lit_psnr(case_type_names[type], context, &c, MIDPOINT_DB);
    case_destroy(&c);
  }
  picture_case c;
  case_create(context, &c, STRATUS_FLOAT32, 14, 1, 16, 3);
  shine(&c);
  c.volume.cell_centered = 1;
  case_camera(context, &c, 1, 0);
  lit_psnr("one layer of cells", context, &c, MIDPOINT_DB);
  case_destroy(&c);
  case_create(context, &c, STRATUS_UINT16, 20, 20, 20, 4);
  shine(&c);
  c.options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
  c.options.sampling.distance = 0.02;
  lit_psnr("nearest", context, &c, MIDPOINT_DB);
  case_destroy(&c);
  stratus_context_destroy(context);
}

static void same(const picture* a, const picture* b, const char* what)
{
  if (memcmp(a->rgba, b->rgba, sizeof a->rgba) != 0 || memcmp(a->depth, b->depth, sizeof a->depth) != 0 ||
    memcmp(a->samples, b->samples, sizeof a->samples) != 0) {
    print_error("%s: another picture\n", what);
    fail();
  }
}

static void no_structure_thread_or_instruction_set_changes_a_bit(void** state)
{
  (void)state;
  stratus_context* contexts[3] = { case_context("host", 1), case_context("host", 3), case_context("host", 2) };
  contexts[2]->isa = 1;
  int lit = 0;
  for (uint32_t seed = 900; seed < 940; ++seed) {
    picture_case c;
    char what[64];
    case_create_random(contexts[0], seed, &c);
    shine(&c);
    if (c.options.sampling.rule == STRATUS_SAMPLING_CELLS && c.options.sampling.interpolation == STRATUS_INTERPOLATION_NEAREST) {
      c.options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED; /* light by cells needs linear interpolation */
    }
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(contexts[0], &c, &drawn);
    lit += case_lit(&drawn) > 0;
    for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
      assert_true(isfinite(drawn.rgba[i]));
    }
    for (int s = STRATUS_STRUCTURE_BLOCK; s <= STRATUS_STRUCTURE_HYBRID; ++s) {
      c.options.skipping.structure = (stratus_structure)s;
      case_render(contexts[s % 3], &c, &other);
      snprintf(what, sizeof what, "seed %u, %s", seed, stratus_structure_name(c.options.skipping.structure));
      if (memcmp(drawn.rgba, other.rgba, sizeof drawn.rgba) != 0 || memcmp(drawn.depth, other.depth, sizeof drawn.depth) != 0) {
        print_error("%s: another picture\n", what);
        fail();
      }
    }
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    contexts[2]->isa = 0;
    case_render(contexts[2], &c, &other);
    contexts[2]->isa = 1;
    same(&drawn, &other, "baseline");
    case_destroy(&c);
  }
  print_message("             %d pictures\n", lit);
  assert_true(lit > 20);
  for (int i = 0; i < 3; ++i) {
    stratus_context_destroy(contexts[i]);
  }
}

static double light_of(stratus_context* context, const picture_case* c)
{
  double sum = 0.0;
  case_render(context, c, &other);
  for (int i = 0; i < CASE_PIXELS; ++i) {
    sum += (double)(other.rgba[4 * i] + other.rgba[4 * i + 1] + other.rgba[4 * i + 2]);
  }
  return sum;
}

static void each_number_of_the_shading_has_its_effect(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  case_create(context, &c, STRATUS_FLOAT32, 24, 24, 24, 8);
  const double plain = light_of(context, &c);
  memcpy(&drawn, &other, sizeof drawn);
  c.options.light.shade = 1;
  c.options.light.shading.ambient = 1.0;
  c.options.light.shading.diffuse = 0.0;
  assert_true(fabs(light_of(context, &c) - plain) < 1e-5 * plain); /* ambient light without any other shows the colours as they are */
  for (int i = 0; i < CASE_PIXELS; ++i) {                          /* light changes no opacity, no depth and no count */
    assert_true(drawn.rgba[4 * i + 3] == other.rgba[4 * i + 3]);
    assert_true(drawn.depth[i] == other.depth[i] && drawn.samples[i] == other.samples[i]);
  }
  c.options.light.shading.ambient = 0.25;
  assert_true(fabs(light_of(context, &c) - 0.25 * plain) < 1e-5 * plain);
  c.options.light.shading.ambient = 0.0;
  assert_true(light_of(context, &c) == 0.0);
  c.options.light.shading.diffuse = 0.5;
  const double diffuse = light_of(context, &c);
  assert_true(diffuse > 0.05 * plain && diffuse < 0.5 * plain);
  c.options.light.shading.one_sided = 1;
  assert_true(light_of(context, &c) < 0.9 * diffuse);
  c.options.light.shading.one_sided = 0;
  c.options.light.shading.specular = 0.5;
  const double broad = light_of(context, &c);
  assert_true(broad > 1.05 * diffuse);
  c.options.light.shading.specular_power = 80.0;
  const double narrow = light_of(context, &c);
  assert_true(narrow > diffuse && narrow < 0.8 * broad);
  c.options.light.shading.light_count = 0;
  assert_true(light_of(context, &c) == 0.0);
  c.options.light.shading.light_count = 1;
  c.options.light.shading.lights[0] = (stratus_light){ .vector = { 1, 1, 1 }, .color = { 0, 1, 0 } };
  assert_true(light_of(context, &c) > 0.0);
  for (int i = 0; i < CASE_PIXELS; ++i) {
    assert_true(other.rgba[4 * i] == 0.0f && other.rgba[4 * i + 2] == 0.0f);
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* A fill value takes no part in the picture, nor does the range that it makes: everything else is lit and thinned as before. */
static void one_voxel_of_1e35_changes_neither_light_nor_gradient_opacity(void** state)
{
  (void)state;
  static const double steep[] = { 0.05, 0.0, 0.2, 0.4, 0.45, 1.0 };
  stratus_context* context = case_context("host", 2);
  picture_case c;
  case_create(context, &c, STRATUS_FLOAT32, 26, 24, 28, 71);
  shine(&c);
  c.options.clipping.crop = 1;
  for (int a = 0; a < 3; ++a) {
    c.options.clipping.crop_bounds[2 * a] = 3.0;
    c.options.clipping.crop_bounds[2 * a + 1] = 40.0;
  }
  for (int thinned = 0; thinned < 2; ++thinned) {
    c.transfer.gradient = steep;
    c.transfer.gradient_count = thinned ? 3 : 0;
    case_store(c.values, STRATUS_FLOAT32, 0, 0.0);
    case_render(context, &c, &drawn);
    for (int e = 0; e < 3; ++e) {
      const double outlier[] = { 1e20, 1e35, 3e38 };
      case_store(c.values, STRATUS_FLOAT32, 0, outlier[e]);
      case_render(context, &c, &other);
      const double db = reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS);
      print_message("             %g%s: %.1f dB, %d pixels\n", outlier[e], thinned ? ", thinned" : "", db, case_lit(&other));
      assert_true(case_lit(&drawn) > case_share(200));
      assert_true(db > 100.0);
    }
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* A light so far away that products of its coordinates overflow lights as its direction does. */
static void lights_however_far_light(void** state)
{
  (void)state;
  static const double distances[] = { 1e12, 1e18, 1e25, 1e40, 1e100, 1e300 };
  stratus_context* context = case_context("host", 1);
  picture_case c;
  case_create(context, &c, STRATUS_UINT8, 16, 16, 16, 1);
  c.options.light.shade = 1;
  c.options.light.shading.light_count = 1;
  c.options.light.shading.lights[0] = (stratus_light){ .vector = { 0.3, -0.5, 0.7 }, .color = { 1.0, 1.0, 1.0 } };
  const double by_direction = light_of(context, &c);
  c.options.light.shading.lights[0].positional = 1;
  for (size_t d = 0; d < sizeof distances / sizeof *distances; ++d) {
    const double vector[3] = { 0.3 * distances[d], -0.5 * distances[d], 0.7 * distances[d] };
    memcpy(c.options.light.shading.lights[0].vector, vector, sizeof vector);
    assert_true(fabs(light_of(context, &c) - by_direction) < 1e-5 * by_direction);
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

static void bad_shading_is_refused_where_it_would_be_used(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  stratus_ray_caster* caster = NULL;
  picture_case c;
  case_create(context, &c, STRATUS_UINT8, 8, 8, 8, 1);
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  c.options.light.shading.diffuse = (double)NAN;
  assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_OK);
  c.options.light.shade = 1;
  assert_int_equal(
    stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "diffuse"));
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
  stratus_context_destroy(context);
}

int test_ray_shading(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(pictures_are_lit_as_the_reference_lights_them),
    cmocka_unit_test(rays_by_cells_are_lit_at_shared_places),
    cmocka_unit_test(long_samples_are_lit_at_several_places),
    cmocka_unit_test(lights_follow_the_camera),
    cmocka_unit_test(lights_are_dimmed_and_have_cones_as_the_reference_says),
    cmocka_unit_test(what_is_wrong_with_a_lamp_is_said),
    cmocka_unit_test(border_voxels_and_every_type_are_lit),
    cmocka_unit_test(no_structure_thread_or_instruction_set_changes_a_bit),
    cmocka_unit_test(each_number_of_the_shading_has_its_effect),
    cmocka_unit_test(one_voxel_of_1e35_changes_neither_light_nor_gradient_opacity),
    cmocka_unit_test(lights_however_far_light),
    cmocka_unit_test(bad_shading_is_refused_where_it_would_be_used),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
