/* SPDX-License-Identifier: BSD-3-Clause
 * First-hit pictures: every structure and number of threads gives the same bits; structures are rebuilt only after changes; trees that come
 * with the data are used only where they serve; refusals; memory that runs out. */
#define CASE_FULL_SIZE
#include "faulty_allocator.h"
#include "picture_case.h"

static picture first;
static picture second;

static void first_hit_case(stratus_context* context, uint32_t seed, picture_case* c)
{
  case_create_random(context, seed, c);
  c->options.mode = STRATUS_MODE_FIRST_HIT;
  c->options.light.normals = (stratus_normals)(seed % 2);
}

static void assert_same(const picture* a, const picture* b)
{
  assert_memory_equal(a->rgba, b->rgba, sizeof a->rgba);
  assert_memory_equal(a->depth, b->depth, sizeof a->depth);
  assert_memory_equal(a->samples, b->samples, sizeof a->samples);
}

static void structures_and_threads_change_no_bit(void** state)
{
  (void)state;
  stratus_context* contexts[2] = { case_context("host", 1), case_context("host", 3) };
  static const stratus_structure used[] = { STRATUS_STRUCTURE_OCTANT, STRATUS_STRUCTURE_NONE, STRATUS_STRUCTURE_BLOCK,
    STRATUS_STRUCTURE_DISTANCE, STRATUS_STRUCTURE_OCTANT, STRATUS_STRUCTURE_HYBRID };
  int lit = 0;
  for (uint32_t seed = 1; seed <= 60; ++seed) {
    picture_case c;
    first_hit_case(contexts[0], seed, &c);
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(contexts[0], &c, &first);
    lit += case_lit(&first) > 0;
    c.options.skipping.audit = 1;
    for (int structure = STRATUS_STRUCTURE_AUTO; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
      c.options.skipping.structure = (stratus_structure)structure;
      case_render(contexts[structure % 2], &c, &second);
      assert_same(&first, &second);
      assert_int_equal(second.report.differing_pixels, 0);
      assert_int_equal(second.report.structure, used[structure]);
      assert_int_equal(second.report.samples, first.report.samples);
    }
    case_destroy(&c);
  }
  assert_true(lit > 30);
  stratus_context_destroy(contexts[0]);
  stratus_context_destroy(contexts[1]);
}

static void bytes_and_window_have_the_same_picture(void** state)
{
  (void)state;
  static uint8_t bytes[4 * CASE_PIXELS_MOST];
  stratus_context* context = case_context("host", 2);
  stratus_ray_caster* caster = NULL;
  picture_case c;
  case_create(context, &c, STRATUS_UINT8, 12, 11, 10, 5);
  c.options.mode = STRATUS_MODE_FIRST_HIT;
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  memset(bytes, 7, sizeof bytes);
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = first.rgba, .rgba8 = bytes };
  assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, &first.report), STRATUS_OK);
  assert_true(case_lit(&first) > case_share(100));
  const int* window = first.report.window;
  for (int at = 0; at < CASE_PIXELS; ++at) {
    const int x = at % CASE_WIDTH, y = at / CASE_WIDTH;
    for (int channel = 0; channel < 4; ++channel) {
      assert_int_equal(bytes[4 * at + channel], (int)lround(255.0 * (double)first.rgba[4 * at + channel]));
    }
    assert_true(first.rgba[4 * at + 3] == 0.0f || (x >= window[0] && x < window[1] && y >= window[2] && y < window[3]));
  }
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Expects the numbers of voxel sets and trees built since the caster was made. */
static void expect_builds(const picture* p, uint64_t voxels, uint64_t trees)
{
  assert_int_equal(p->report.occupancy_builds, voxels);
  assert_int_equal(p->report.structure_builds, trees);
}

static void only_what_changed_is_built_anew(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  stratus_ray_caster* caster = NULL;
  picture_case c;
  double opacity[8], color[12];
  case_create(context, &c, STRATUS_FLOAT32, 12, 11, 10, 3);
  c.options.mode = STRATUS_MODE_FIRST_HIT;
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  case_render_with(context, caster, &c, &first);
  expect_builds(&first, 1, 1);
  case_camera(context, &c, 5, 1);
  c.volume.spacing[1] = 2.0;
  c.volume.origin[0] = 1e6;
  c.volume.matrix[1] = 0.3;
  case_camera(context, &c, 5, 1);
  case_render_with(context, caster, &c, &first);
  expect_builds(&first, 1, 1);
  assert_true(case_lit(&first) > case_share(100));
  case_render(context, &c, &second); /* a kept tree draws what a new one does, a million off the origin */
  assert_same(&first, &second);

  memcpy(color, c.color, sizeof color);
  color[1] = 1.0;
  c.transfer.color = color;
  c.transfer.unit_distance = 3.0;
  c.options.light.normals = STRATUS_NORMALS_GRADIENT;
  case_render_with(context, caster, &c, &first);
  expect_builds(&first, 1, 1);
  assert_true(memcmp(first.rgba, second.rgba, sizeof first.rgba) != 0);

  c.options.skipping.structure = STRATUS_STRUCTURE_OCTANT;
  case_render_with(context, caster, &c, &first);
  expect_builds(&first, 1, 2);
  c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
  case_render_with(context, caster, &c, &first);
  expect_builds(&first, 1, 2);
  c.options.skipping.structure = STRATUS_STRUCTURE_HYBRID;
  memcpy(opacity, c.opacity, sizeof opacity);
  opacity[2] += 0.5;
  opacity[4] += 0.5;
  c.transfer.opacity = opacity;
  case_render_with(context, caster, &c, &first);
  expect_builds(&first, 2, 3);
  ((float*)c.values)[555] = 1000.0f;
  ++c.volume.revision;
  case_render_with(context, caster, &c, &first);
  expect_builds(&first, 3, 4);
  stratus_ray_caster_release(caster);
  case_render_with(context, caster, &c, &second);
  expect_builds(&second, 4, 5);
  assert_same(&first, &second);
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* ---- trees that come with the data */

static void* tree_bytes(stratus_context* context, const picture_case* c, const stratus_criterion* criterion, int cells, size_t* size)
{
  stratus_voxels* voxels = NULL;
  stratus_tree* tree = NULL;
  assert_int_equal((cells ? stratus_voxels_create_cells : stratus_voxels_create)(context, &c->volume, criterion, &voxels), STRATUS_OK);
  assert_int_equal(stratus_tree_create(context, voxels, NULL, &tree), STRATUS_OK);
  stratus_voxels_destroy(voxels);
  *size = stratus_tree_bytes(tree);
  void* bytes = malloc(*size);
  assert_non_null(bytes);
  stratus_tree_save(tree, bytes);
  stratus_tree_destroy(tree);
  return bytes;
}

typedef struct offer {
  stratus_context* context;
  stratus_ray_caster* caster;
  picture_case c;
  stratus_criterion criterion;
} offer;

static void offer_begin(offer* o)
{
  o->context = case_context("host", 2);
  assert_int_equal(stratus_ray_caster_create(o->context, &o->caster), STRATUS_OK);
  case_create(o->context, &o->c, STRATUS_FLOAT32, 14, 13, 12, 3);
  o->c.volume.origin[1] = 33.0; /* the tree records where it was made, which must not matter */
  o->c.options.mode = STRATUS_MODE_FIRST_HIT;
  o->criterion = stratus_criterion_default();
  o->criterion.transfer = &o->c.transfer;
  case_camera(o->context, &o->c, 2, 0);
}

static void offer_end(offer* o)
{
  stratus_ray_caster_destroy(o->caster);
  case_destroy(&o->c);
  stratus_context_destroy(o->context);
}

/* Draws with the offered tree and without. Both pictures must be the same, whether the tree is used or not. */
static void expect_offered(offer* o, int used)
{
  case_render_with(o->context, o->caster, &o->c, &first);
  assert_int_equal(first.report.offered_tree, used);
  case_render(o->context, &o->c, &second);
  assert_same(&first, &second);
  assert_true(case_lit(&first) > case_share(100));
}

static void a_tree_that_comes_with_the_data_is_used(void** state)
{
  (void)state;
  offer o;
  size_t size = 0;
  offer_begin(&o);
  void* bytes = tree_bytes(o.context, &o.c, &o.criterion, 0, &size);
  assert_int_equal(stratus_ray_caster_offer_tree(o.caster, bytes, size), STRATUS_OK);
  free(bytes); /* copied */
  o.c.volume.origin[0] = 1e5;
  o.c.volume.matrix[6] = 0.4;
  case_camera(o.context, &o.c, 2, 0);
  expect_offered(&o, 1);
  expect_builds(&first, 0, 0);
  o.c.options.skipping.audit = 1;
  expect_offered(&o, 1);
  assert_int_equal(first.report.differing_pixels, 0);
  expect_builds(&first, 1, 0); /* the audit walks from voxel to voxel */
  o.c.options.skipping.audit = 0;
  o.c.options.skipping.structure = STRATUS_STRUCTURE_DISTANCE; /* the options request another structure */
  expect_offered(&o, 0);
  o.c.options.skipping.structure = STRATUS_STRUCTURE_HYBRID;
  static uint8_t mask[14 * 13 * 12];
  memset(mask + sizeof mask / 3, 1, sizeof mask - sizeof mask / 3);
  o.c.options.mask.bytes = mask; /* of which the tree knows nothing */
  expect_offered(&o, 0);
  o.c.options.mask.bytes = NULL;
  o.c.options.skipping.structure = STRATUS_STRUCTURE_HYBRID;
  expect_offered(&o, 1);
  stratus_ray_caster_release(o.caster);
  expect_offered(&o, 1);
  assert_int_equal(stratus_ray_caster_offer_tree(o.caster, NULL, 0), STRATUS_OK);
  expect_offered(&o, 0);
  offer_end(&o);
}

static void a_tree_that_does_not_serve_is_not_used(void** state)
{
  (void)state;
  offer o;
  size_t size = 0;
  offer_begin(&o);
  stratus_criterion all = stratus_criterion_default();
  for (int cells = 0; cells < 2; ++cells) { /* of all voxels; of cells */
    void* bytes = tree_bytes(o.context, &o.c, cells ? &o.criterion : &all, cells, &size);
    assert_int_equal(stratus_ray_caster_offer_tree(o.caster, bytes, size), STRATUS_OK);
    free(bytes);
    expect_offered(&o, 0);
  }
  void* bytes = tree_bytes(o.context, &o.c, &o.criterion, 0, &size);
  assert_int_equal(stratus_ray_caster_offer_tree(o.caster, bytes, size), STRATUS_OK);
  expect_offered(&o, 1);
  ((float*)o.c.values)[555] = 1000.0f; /* stale */
  ++o.c.volume.revision;
  expect_offered(&o, 0);
  ((float*)o.c.values)[555] = -1000.0f;
  ++o.c.volume.revision;
  expect_offered(&o, 0);
  const double narrower[8] = { o.c.opacity[0], 0, o.c.opacity[2] + 0.5, 0, o.c.opacity[4] + 0.5, 0.1, o.c.opacity[6], 0.4 };
  o.c.transfer.opacity = narrower;
  expect_offered(&o, 0);
  for (size_t cut = 0; cut < size; cut += 1 + size / 50) { /* truncated */
    assert_int_equal(stratus_ray_caster_offer_tree(o.caster, bytes, cut), STRATUS_INVALID_ARGUMENT);
  }
  for (size_t at = 0; at < size; at += 1 + size / 50) { /* tampered */
    ((uint8_t*)bytes)[at] ^= 0x10;
    assert_int_equal(stratus_ray_caster_offer_tree(o.caster, bytes, size), STRATUS_INVALID_ARGUMENT);
    assert_true(strlen(stratus_context_message(o.context)) > 10);
    ((uint8_t*)bytes)[at] ^= 0x10;
  }
  expect_offered(&o, 0);
  free(bytes);
  assert_int_equal(stratus_ray_caster_offer_tree(NULL, NULL, 0), STRATUS_INVALID_ARGUMENT);
  offer_end(&o);
}

/* ---- refusals */

static void refuse(stratus_context* context, picture_case* c, const char* word)
{
  stratus_ray_caster* caster = NULL;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = first.rgba };
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  const stratus_status status = stratus_ray_caster_render(caster, &c->volume, &c->transfer, &c->camera, &c->options, &image, NULL);
  if (status != STRATUS_INVALID_ARGUMENT || !strstr(stratus_context_message(context), word)) {
    print_error("%s: %s says nothing of '%s'\n", stratus_status_name(status), stratus_context_message(context), word);
    fail();
  }
  stratus_ray_caster_destroy(caster);
}

static void what_makes_no_sense_is_refused(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  picture_case c;
  case_create(context, &c, STRATUS_UINT8, 5, 5, 5, 1);
  c.options.mode = STRATUS_MODE_FIRST_HIT;
  const stratus_ray_cast_options fine = c.options;
#define REFUSE(change, word)                                                                                                               \
  c.options = fine;                                                                                                                        \
  change;                                                                                                                                  \
  refuse(context, &c, word)
  REFUSE(c.options.mode = (stratus_mode)(STRATUS_MODE_QUANTITIES + 1), "mode");
  REFUSE(c.options.mode = (stratus_mode)-1, "mode");
  REFUSE(c.options.light.normals = (stratus_normals)2, "normals");
  REFUSE(c.options.light.shading.ambient = -0.1, "ambient");
  REFUSE(c.options.light.shading.diffuse = (double)NAN, "diffuse");
  REFUSE(c.options.light.shading.specular = (double)INFINITY, "specular");
  REFUSE(c.options.light.shading.specular_power = -1.0, "power");
  REFUSE(c.options.light.shading.light_count = 9, "0..8");
  REFUSE(c.options.light.shading.light_count = -2, "0..8");
  REFUSE(c.options.light.shading.light_count = 1, "direction");
  REFUSE((c.options.light.shading.light_count = 1, c.options.light.shading.lights[0].vector[1] = (double)NAN), "light 0");
  REFUSE((c.options.light.shading.light_count = 1, c.options.light.shading.lights[0].positional = 1,
           c.options.light.shading.lights[0].color[2] = -1.0),
    "light 0");
  c.options = fine;
  c.camera.far_k = -1.0;
  refuse(context, &c, "near");
  assert_string_equal(stratus_mode_name(STRATUS_MODE_COMPOSITE), "composite");
  assert_string_equal(stratus_mode_name(STRATUS_MODE_FIRST_HIT), "first-hit");
  assert_string_equal(stratus_mode_name((stratus_mode)(STRATUS_MODE_QUANTITIES + 1)), "unknown");
  case_destroy(&c);
  stratus_context_destroy(context);
}

static void nothing_to_hit_is_an_empty_picture(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  picture_case c;
  static const double nothing[2] = { 0.0, 0.0 };
  case_create(context, &c, STRATUS_FLOAT32, 5, 5, 5, 1);
  c.options.mode = STRATUS_MODE_FIRST_HIT;
  c.transfer.opacity = nothing;
  c.transfer.opacity_count = 1;
  for (int structure = STRATUS_STRUCTURE_AUTO; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
    c.options.skipping.structure = (stratus_structure)structure;
    memset(&first, 0xff, sizeof first);
    case_render(context, &c, &first);
    assert_int_equal(case_lit(&first), 0);
    for (int at = 0; at < CASE_PIXELS; ++at) {
      assert_true(isinf(first.depth[at]) && first.samples[at] == 0);
    }
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

static void memory_that_runs_out_is_an_error_and_no_more(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  stratus_context_options options = faulty_options(&allocator, "host");
  options.threads = 1;
  stratus_context* context = NULL;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  picture_case c;
  case_create(context, &c, STRATUS_FLOAT64, 9, 8, 7, 3);
  c.options.mode = STRATUS_MODE_FIRST_HIT;
  c.options.skipping.audit = 1;
  c.camera.right[0] *= 3.0;
  case_render(context, &c, &first);
  size_t size = 0;
  stratus_criterion criterion = stratus_criterion_default();
  criterion.transfer = &c.transfer;
  void* bytes = tree_bytes(context, &c, &criterion, 0, &size);
  const stratus_image image = {
    .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = second.rgba, .depth = second.depth, .samples = second.samples
  };
  for (int offered = 0; offered < 2; ++offered) {
    stratus_status status = STRATUS_OUT_OF_MEMORY;
    int64_t n = 1;
    for (; n < 300 && status == STRATUS_OUT_OF_MEMORY; ++n) {
      const int64_t live = allocator.live;
      stratus_ray_caster* caster = NULL;
      assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
      allocator.fail_at = allocator.calls + n;
      status = offered ? stratus_ray_caster_offer_tree(caster, bytes, size) : STRATUS_OK;
      if (status == STRATUS_OK) {
        status = stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL);
      }
      assert_true(status == STRATUS_OK || status == STRATUS_OUT_OF_MEMORY);
      allocator.fail_at = 0;
      case_render_with(context, caster, &c, &second); /* fit for the next call */
      assert_same(&first, &second);
      stratus_ray_caster_destroy(caster);
      assert_int_equal(allocator.live, live);
    }
    assert_int_equal(status, STRATUS_OK);
    assert_true(n > 8);
  }
  free(bytes);
  case_destroy(&c);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

int test_first_hit_scene(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(structures_and_threads_change_no_bit),
    cmocka_unit_test(bytes_and_window_have_the_same_picture),
    cmocka_unit_test(only_what_changed_is_built_anew),
    cmocka_unit_test(a_tree_that_comes_with_the_data_is_used),
    cmocka_unit_test(a_tree_that_does_not_serve_is_not_used),
    cmocka_unit_test(what_makes_no_sense_is_refused),
    cmocka_unit_test(nothing_to_hit_is_an_empty_picture),
    cmocka_unit_test(memory_that_runs_out_is_an_error_and_no_more),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
