/* SPDX-License-Identifier: BSD-3-Clause
 * 10,000 random volumes, functions, cameras and modes, each drawn with every structure: no structure changes a bit of the picture, and the
 * caster's own audit says the same. */
#include "random_scene.h"
#include "testing.h"

#define ALL 10000

static picture plain, skipping;
static uint8_t mask[64 * 64 * 64];

/* Light, contours, masks, labels, jitter and crop regions, on top of a case whose values lie about base, within scale. */
static void choose_options(picture_case* c, double base, double scale, uint32_t* random)
{
  stratus_ray_cast_options* o = &c->options;
  const int64_t* n = c->volume.dimensions;
  o->mode = case_random(random) % 5 < 2 ? STRATUS_MODE_COMPOSITE : (stratus_mode)(int)case_uniform(random, 0.0, STRATUS_MODE_SLICE + 1.0);
  o->optics.contour_count = 1 + (int)(case_random(random) % 3);
  for (int i = 0; i < o->optics.contour_count; ++i) {
    o->optics.contours[i] = base + scale * case_uniform(random, -0.6, 0.6);
  }
  if (case_random(random) % 3 == 0) {
    o->optics.average_range[0] = base - 0.3 * scale;
    o->optics.average_range[1] = base + scale * case_uniform(random, -0.3, 0.9);
  }
  if (o->mode == STRATUS_MODE_SLICE) {
    for (int a = 0; a < 3; ++a) { /* a plane or a quadric through the middle of an unturned volume */
      const double* x = c->volume.coordinates[a];
      o->slice.center[a] = x ? x[n[a] / 2] : c->volume.origin[a] + 0.5 * c->volume.spacing[a] * (double)n[a];
      o->slice.linear[a] = case_uniform(random, -1.0, 1.0);
      o->slice.square[a] = case_random(random) % 2 ? case_uniform(random, -0.2, 0.2) : 0.0;
    }
  }
  o->light.normals = (stratus_normals)(case_random(random) % 2);
  o->light.shade = case_random(random) % 4 == 0;
  o->light.shading.specular = o->light.shade && case_random(random) % 2 ? 0.4 : 0.0;
  o->light.shading.one_sided = case_random(random) % 3 == 0;
  o->sampling.jitter = case_random(random) % 6 == 0;
  o->sampling.jitter_seed = case_random(random);
  o->skipping.block_size = case_random(random) % 3 ? 0 : 2 << case_random(random) % 5;
  if (o->mode == STRATUS_MODE_FIRST_HIT) {
    o->clipping.crop_regions = STRATUS_CROP_INSIDE;
  } else if (case_random(random) % 6 == 0) {
    const uint32_t grain = 1 + case_random(random) % 9;
    for (int64_t i = 0; i < n[0] * n[1] * n[2]; ++i) {
      mask[i] = (uint8_t)((uint64_t)(i / grain) * 2654435761u >> 7 & 3);
    }
    o->mask.bytes = mask;
  } else if (case_random(random) % 5 == 0) {
    o->clipping.crop_regions = case_random(random) & STRATUS_CROP_ALL;
  }
  o->sampling.interpolation = o->mode == STRATUS_MODE_ISOSURFACE ? STRATUS_INTERPOLATION_LINEAR : o->sampling.interpolation;
}

static stratus_status draw(stratus_ray_caster* caster, const picture_case* c, picture* p)
{
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = p->rgba, .depth = p->depth };
  return stratus_ray_caster_render(caster, &c->volume, &c->transfer, &c->camera, &c->options, &image, &p->report);
}

static int differing_pixels(void)
{
  int differing = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    differing += memcmp(plain.rgba + 4 * i, skipping.rgba + 4 * i, 4 * sizeof(float)) != 0 ||
      memcmp(plain.depth + i, skipping.depth + i, sizeof(float)) != 0;
  }
  return differing;
}

/* Draws with every structure, from a random one on, with one caster or with a new one for each. */
static void judge(stratus_context* context, picture_case* c, uint32_t* random, uint64_t* skipped)
{
  stratus_ray_caster* caster = NULL;
  const bool anew = case_random(random) % 3 == 0;
  const uint32_t first = case_random(random);
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  c->options.skipping.structure = STRATUS_STRUCTURE_NONE;
  stratus_status status = draw(caster, c, &plain);
  if (status == STRATUS_UNSUPPORTED && c->options.sampling.rule == STRATUS_SAMPLING_CELLS) { /* cells draw no light and no mask */
    c->options.sampling.rule = STRATUS_SAMPLING_AUTO;
    c->options.sampling.distance = 0.0;
    status = draw(caster, c, &plain);
  }
  if (status != STRATUS_OK) {
    fail_msg("%s: %s", stratus_mode_name(c->options.mode), stratus_context_message(context));
  }
  c->options.skipping.audit = case_random(random) % 4 == 0;
  for (uint32_t i = 0; i <= STRATUS_STRUCTURE_HYBRID; ++i) {
    c->options.skipping.structure = (stratus_structure)((i + first) % (STRATUS_STRUCTURE_HYBRID + 1));
    if (anew) {
      stratus_ray_caster_destroy(caster);
      assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    }
    if (draw(caster, c, &skipping) != STRATUS_OK) {
      fail_msg("%s: %s", stratus_structure_name(c->options.skipping.structure), stratus_context_message(context));
    }
    const int differing = differing_pixels();
    if (differing > 0 || skipping.report.differing_pixels > 0) {
      fail_msg("%s, %s, structure %s: %d pixels differ from the plain march, %llu by the audit", stratus_mode_name(c->options.mode),
        stratus_sampling_name(plain.report.sampling), stratus_structure_name(c->options.skipping.structure), differing,
        (unsigned long long)skipping.report.differing_pixels);
    }
    *skipped += skipping.report.skipped;
  }
  stratus_ray_caster_destroy(caster);
}

static void no_structure_changes_a_bit(void** state)
{
  int lit = 0, modes[STRATUS_MODE_SLICE + 1] = { 0 };
  uint64_t skipped = 0;
  test_seeds seeds = test_seeds_of(TEST_SOME(ALL), ALL);
  while (test_next(&seeds)) {
    uint32_t random = seeds.seed * 2246822519u + 3266489917u;
    picture_case c;
    random_scene s = { .values = NULL };
    const uint32_t kind = case_random(&random) % 8;
    if (kind < 3) { /* shells, plates, labels, steps and stripes */
      random_scene_create(*state, seeds.seed, (double)CASE_WIDTH / CASE_HEIGHT, &s);
      memset(&c, 0, sizeof c);
      c.volume = s.volume;
      c.transfer = s.transfer;
      c.camera = s.camera;
      c.options = stratus_ray_cast_options_default();
      if (case_random(&random) % 4) {
        c.options.sampling.rule = (stratus_sampling)(STRATUS_SAMPLING_MIDPOINT + case_random(&random) % 3);
        c.options.sampling.distance = c.volume.spacing[0] * case_uniform(&random, 0.3, 3.0);
      }
    } else if (kind == 3) { /* scenes for rule local */
      case_create_local(*state, seeds.seed, &c);
    } else { /* any type, NaN, ghosts, planes, the eye inside */
      case_create_random(*state, seeds.seed, &c);
    }
    const double* points = c.transfer.opacity;
    const double from = points[0], to = points[2 * (c.transfer.opacity_count - 1)];
    choose_options(&c, 0.5 * (from + to), 0.5 * (to - from) + 1e-3 * (fabs(from) + fabs(to)), &random);
    judge(*state, &c, &random, &skipped);
    lit += case_lit(&plain) > 0;
    ++modes[c.options.mode];
    random_scene_destroy(&s);
    case_destroy(&c);
  }
  print_message("             %u cases, %d show something\n", seeds.end, lit);
  if (test_many(&seeds, 100)) {
    assert_true((uint32_t)lit > seeds.end / 2);
    assert_true(skipped > 0);
    for (int mode = 0; mode <= STRATUS_MODE_SLICE; ++mode) {
      assert_true(modes[mode] > 2);
    }
  }
}

int test_random_volumes(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(no_structure_changes_a_bit),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
