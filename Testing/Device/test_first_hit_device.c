/* SPDX-License-Identifier: BSD-3-Clause
 * First hits on an OpenCL device: packets of 16, as on a CPU, and one ray a work item, as on a GPU. The same answers as the host's, to the
 * bit. */
#include "first_hits.h"

#include "device_state.h"
#include "testing.h"

#include <stdio.h>

#define COUNT 270000 /* more than one launch */
#define SOME 30000
#define FEW 70 /* in a simulator */

static stratus_context* open_context(const char* device, bool as_gpu)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  options.device = device;
  options.threads = 2;
  if (stratus_context_create(&options, &context, NULL, 0) != STRATUS_OK) {
    return NULL;
  }
  if (as_gpu) {
    context->device->is_cpu = false;
  }
  return context;
}

/* Trees of one field and of many leaves, in each size of entries and cells; the last one, whose boxes may overlap, is walked on the host.
 */
static const struct {
  stratus_tree_method method;
  double fill, emptiness;
  int leaf_bricks, cluster;
  bool on_device;
} cases[] = {
  { STRATUS_TREE_HYBRID, 0.02, 512.0, 4, 0, true },
  { STRATUS_TREE_HYBRID, 0.0004, 2.0, 4, 0, true },  /* leaves of several bricks, and few fields */
  { STRATUS_TREE_HYBRID, 0.0004, 1.0, 1, 0, true },  /* leaves of a brick */
  { STRATUS_TREE_HYBRID, 0.3, 1.5, 2, 9, true },     /* dense fields, entries of three bytes */
  { STRATUS_TREE_HYBRID, 0.003, 3.0, 40, 20, true }, /* long lists of bricks */
  { STRATUS_TREE_HYBRID_PAPER, 0.05, 512.0, 4, 9, true },
  { STRATUS_TREE_OCTANT, 0.001, 512.0, 4, 0, true },
  { STRATUS_TREE_DISTANCE, 0.02, 512.0, 4, 0, true },
  { STRATUS_TREE_WIDE, 0.0001, 512.0, 4, 0, true }, /* nodes of few bricks */
  { STRATUS_TREE_WIDE, 0.02, 512.0, 4, 0, true },
  { STRATUS_TREE_WIDE, 0.3, 512.0, 4, 9, true },
  { STRATUS_TREE_LBVH, 0.02, 512.0, 4, 0, false },
};
#define CASES (sizeof cases / sizeof *cases)

static void device_and_host_hit_the_same(void** state)
{
  const int most = *(const int*)*state;
  static stratus_ray rays[COUNT];
  static stratus_hit ours[COUNT], theirs[COUNT];
  const int64_t dimensions[3] = { 90, 60, 75 };
  stratus_context* host = open_context("host", false);
  for (int as_gpu = 0; as_gpu < 2; ++as_gpu) {
    stratus_context* device = open_context("0", as_gpu);
    assert_non_null(device);
    print_message("on %s\n", stratus_context_device(device));
    for (size_t m = 0; m < CASES; ++m) {
      if (few_run() && m % 3 != (size_t)as_gpu) { /* a kernel each */
        continue;
      }
      const int count = m > 0 && most > SOME ? SOME : most;
      uint32_t random = 8;
      stratus_voxels* voxels = random_voxels(host, dimensions, cases[m].fill, cases[m].cluster, &random);
      stratus_tree_options options = stratus_tree_options_default();
      stratus_tree* tree = NULL;
      options.method = cases[m].method;
      options.field_emptiness = cases[m].emptiness;
      options.leaf_bricks = cases[m].leaf_bricks;
      for (int i = 0; i < count; ++i) {
        rays[i] = random_ray(dimensions, &random);
      }
      assert_int_equal(stratus_tree_create(host, voxels, &options, &tree), STRATUS_OK);
      assert_int_equal(stratus_tree_first_hit(host, tree, rays, (size_t)count, theirs), STRATUS_OK);
      const uint64_t launched = device->report.launched;
      if (stratus_tree_first_hit(device, tree, rays, (size_t)count, ours) != STRATUS_OK) {
        fail_msg("%s", stratus_context_message(device));
      }
      assert_true((device->report.launched > launched) == cases[m].on_device);
      for (int i = 0; i < count; ++i) {
        /* A wide hierarchy's rays visit other voxels where they share their way, and in doubt. */
        const bool visits = cases[m].method == STRATUS_TREE_WIDE || ours[i].visited == theirs[i].visited;
        if (ours[i].t != theirs[i].t || ours[i].face != theirs[i].face || !visits) {
          fail_msg("case %zu, ray %d: at %.17g face %d in %u steps, on the host %.17g, %d, %u", m, i, ours[i].t, ours[i].face,
            ours[i].visited, theirs[i].t, theirs[i].face, theirs[i].visited);
        }
        assert_memory_equal(ours[i].voxel, theirs[i].voxel, sizeof ours[i].voxel);
      }
      const int bad = count - 4;
      char name[32];
      snprintf(name, sizeof name, "ray %d ", bad);
      rays[bad].direction[1] = NAN;
      assert_int_equal(stratus_tree_first_hit(device, tree, rays, (size_t)count, ours), STRATUS_INVALID_ARGUMENT);
      assert_non_null(strstr(stratus_context_message(device), name));
      stratus_tree_destroy(tree);
      stratus_voxels_destroy(voxels);
    }
    stratus_context_destroy(device);
  }
  stratus_context_destroy(host);
}

static void rays_from_very_far_visit_no_place_without_a_child(void** state)
{
  (void)state;
  stratus_context* host = open_context("host", false);
  for (int as_gpu = 0; as_gpu < 2; ++as_gpu) {
    stratus_context* device = open_context("0", as_gpu);
    assert_non_null(device);
    rays_from_very_far_visit_only_children(host, device);
    stratus_context_destroy(device);
  }
  stratus_context_destroy(host);
}

/* --tiny: a few rays, for a simulator that checks each access. */
int test_first_hit_device(void)
{
  int most = test_option("--tiny") ? FEW : COUNT;
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  const struct CMUnitTest tests[] = { cmocka_unit_test_prestate(device_and_host_hit_the_same, &most),
    cmocka_unit_test(rays_from_very_far_visit_no_place_without_a_child) };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
