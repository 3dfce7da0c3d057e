/* SPDX-License-Identifier: BSD-3-Clause
 * A process whose locale writes decimal commas draws the same pictures and builds the same trees. */
#define _XOPEN_SOURCE 700
#include "comma_locale.h"
#include "picture_case.h"
#include "testing.h"

static picture pictures[2][2];

static void* tree_of(stratus_context* context, const picture_case* c, size_t* size)
{
  stratus_criterion criterion = stratus_criterion_default();
  stratus_voxels* voxels = NULL;
  stratus_tree *tree = NULL, *loaded = NULL;
  criterion.transfer = &c->transfer;
  assert_int_equal(stratus_voxels_create(context, &c->volume, &criterion, &voxels), STRATUS_OK);
  assert_int_equal(stratus_tree_create(context, voxels, NULL, &tree), STRATUS_OK);
  *size = stratus_tree_bytes(tree);
  void* bytes = malloc(*size);
  assert_non_null(bytes);
  stratus_tree_save(tree, bytes);
  assert_int_equal(stratus_tree_load(context, bytes, *size, &loaded), STRATUS_OK);
  stratus_tree_destroy(loaded);
  stratus_tree_destroy(tree);
  stratus_voxels_destroy(voxels);
  return bytes;
}

static void decimal_commas_change_nothing(void** state)
{
  void* bytes[2];
  size_t sizes[2];
  (void)state;
  for (int commas = 0; commas < 2; ++commas) {
    for (int automatic = 0; automatic < 2; ++automatic) {
      stratus_context* context = case_context(automatic ? "auto" : "host", 2);
      picture_case c;
      case_create(context, &c, STRATUS_FLOAT32, 20, 21, 22, 8);
      c.options.sampling.rule = STRATUS_SAMPLING_AUTO;
      c.options.sampling.distance = 0.0;
      c.options.skipping.structure = STRATUS_STRUCTURE_DISTANCE;
      case_render(context, &c, &pictures[commas][automatic]);
      assert_true(case_lit(&pictures[commas][automatic]) > case_share(100));
      if (automatic) {
        bytes[commas] = tree_of(context, &c, &sizes[commas]);
      }
      case_destroy(&c);
      stratus_context_destroy(context);
    }
    if (!commas && !comma_locale_begin()) {
      comma_locale_end();
      free(bytes[0]);
      print_message("SKIPPED: no locale with decimal commas (Debian: locales)\n");
      skip();
    }
  }
  comma_locale_end();
  for (int automatic = 0; automatic < 2; ++automatic) {
    assert_memory_equal(pictures[0][automatic].rgba, pictures[1][automatic].rgba, sizeof pictures[0][0].rgba);
    assert_memory_equal(pictures[0][automatic].depth, pictures[1][automatic].depth, sizeof pictures[0][0].depth);
    assert_true(pictures[0][automatic].report.sample_distance == pictures[1][automatic].report.sample_distance);
  }
  assert_int_equal(sizes[0], sizes[1]);
  assert_memory_equal(bytes[0], bytes[1], sizes[0]);
  free(bytes[0]);
  free(bytes[1]);
}

int test_locale(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(decimal_commas_change_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
