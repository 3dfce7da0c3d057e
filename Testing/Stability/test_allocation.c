/* SPDX-License-Identifier: BSD-3-Clause
 * Memory refused at the n-th request, for every n until all are granted. Each refusal gives an error that names it and no leak, and the
 * same objects give the right result at the next attempt. */
#include "device_state.h"
#include "faulty_allocator.h"
#include "pocl.h"
#include "small_scene.h"
#include "testing.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

#define REQUESTS_MAX 500 /* for one call: far more than any needs, so that a loop which never succeeds ends */

static const char* name_of(const char* device)
{
  return strcmp(device, "host") == 0 ? device : pocl_name();
}

/* Device "pocl", and "gpu": PoCL that claims to be a GPU, so that the device builds the structures, too. */
static stratus_context* open_context(faulty_allocator* allocator, const char* device)
{
  const bool as_gpu = strcmp(device, "gpu") == 0;
  stratus_context* context = NULL;
  stratus_context_options options = faulty_options(allocator, name_of(device));
  options.threads = 1; /* in hundreds of tiny calls threads would only wait for each other */
  if (stratus_context_create(&options, &context, NULL, 0) != STRATUS_OK) {
    return NULL;
  }
  if (as_gpu) {
    context->device->is_cpu = false;
  }
  return context;
}

static void assert_out_of_memory(const stratus_context* context, stratus_status status)
{
  assert_int_equal(status, STRATUS_OUT_OF_MEMORY);
  assert_non_null(strstr(stratus_context_message(context), "bytes"));
}

/* Refuses the n-th request from now on. */
static void refuse(faulty_allocator* allocator, int64_t n)
{
  allocator->fail_at = n ? allocator->calls + n : 0;
}

/* Where some cases are enough, each setting refuses every third request, and the settings begin at different ones. */
static int64_t first_refused(int setting)
{
  return few_run() ? 1 + setting % 3 : 1;
}

static int64_t refused_step(void)
{
  return few_run() ? 3 : 1;
}

/* Returns whether a request was refused. A request that only saves time may be refused, and the picture is drawn without it. */
static int has_refused(const faulty_allocator* allocator)
{
  return allocator->fail_at && allocator->calls >= allocator->fail_at;
}

static void a_context_is_made_whole_or_not_at_all(void** state)
{
  const char* device = *state;
  for (int64_t n = 1; n < REQUESTS_MAX; ++n) {
    faulty_allocator allocator = { .fail_at = n };
    stratus_context_options options = faulty_options(&allocator, name_of(device));
    stratus_context* context = NULL;
    char message[256];
    const stratus_status status = stratus_context_create(&options, &context, message, sizeof message);
    if (status == STRATUS_OK) {
      stratus_context_destroy(context);
      assert_int_equal(allocator.live, 0);
      assert_true(n > 1);
      return;
    }
    assert_int_equal(status, STRATUS_OUT_OF_MEMORY);
    assert_null(context);
    assert_non_null(strstr(message, "bytes"));
    assert_int_equal(allocator.live, 0);
  }
  fail_msg("a context was never made");
}

static void structures_are_made_whole_or_not_at_all(void** state)
{
  static small_scene scene;
  faulty_allocator allocator = { 0 };
  stratus_context* context = open_context(&allocator, *state);
  assert_non_null(context);
  small_scene_fill(&scene);
  uint64_t right = 0, sum = 0;
  assert_int_equal(small_structures(context, &scene, &right), STRATUS_OK);
  const int64_t live = allocator.live;
  int64_t n = 1;
  for (; n < REQUESTS_MAX; ++n) {
    refuse(&allocator, n);
    const stratus_status status = small_structures(context, &scene, &sum);
    assert_int_equal(allocator.live, live);
    if (status == STRATUS_OK) {
      break;
    }
    assert_out_of_memory(context, status);
    refuse(&allocator, 0);
    assert_int_equal(small_structures(context, &scene, &sum), STRATUS_OK);
    assert_true(sum == right);
  }
  assert_in_range(n, 1 + 2 * 5, REQUESTS_MAX - 1); /* at least one request for each object */
  assert_true(sum == right);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

/* A new ray caster whose first picture fails draws it correctly at the next attempt. */
static void a_first_picture_fails_cleanly_and_comes_at_the_next_attempt(void** state)
{
  static small_scene scene;
  static small_picture right, picture;
  faulty_allocator allocator = { 0 };
  stratus_context* context = open_context(&allocator, *state);
  assert_non_null(context);
  small_scene_fill(&scene);
  assert_int_equal(small_scene_camera(context, &scene), STRATUS_OK);
  for (int setting = 0; setting < SMALL_SETTINGS; ++setting) {
    stratus_ray_caster* caster = NULL;
    assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    assert_int_equal(small_render(caster, &scene, &scene.transfer, setting, &right, NULL), STRATUS_OK);
    stratus_ray_caster_destroy(caster);
    int64_t live = allocator.live, n = first_refused(setting);
    for (; n < REQUESTS_MAX; n += refused_step()) {
      caster = NULL;
      refuse(&allocator, n);
      stratus_status status = stratus_ray_caster_create(context, &caster);
      if (status == STRATUS_OK) {
        status = small_render(caster, &scene, &scene.transfer, setting, &picture, NULL);
      } else {
        assert_null(caster);
      }
      const int refused = has_refused(&allocator), done = status == STRATUS_OK && !refused;
      if (!done) {
        if (status != STRATUS_OK) {
          assert_out_of_memory(context, status);
        }
        refuse(&allocator, 0);
        if (caster) {
          assert_int_equal(small_render(caster, &scene, &scene.transfer, setting, &picture, NULL), STRATUS_OK);
        }
      }
      if (caster) {
        assert_memory_equal(&picture, &right, sizeof right);
      }
      stratus_ray_caster_destroy(caster);
      refuse(&allocator, 0);
      live = status == STRATUS_OK && refused ? allocator.live : live; /* the context keeps the kernel that was taken instead */
      assert_int_equal(allocator.live, live);
      if (done) {
        break;
      }
    }
    assert_in_range(n, 3, REQUESTS_MAX - 1);
  }
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

/* A ray caster that has drawn one transfer function and fails at the next can still draw the first, and then the next. */
static void an_edit_that_fails_leaves_the_earlier_result_intact(void** state)
{
  static small_scene scene;
  static small_picture before, after, picture;
  faulty_allocator allocator = { 0 };
  stratus_context* context = open_context(&allocator, *state);
  stratus_ray_caster* caster = NULL;
  assert_non_null(context);
  small_scene_fill(&scene);
  assert_int_equal(small_scene_camera(context, &scene), STRATUS_OK);
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  for (int setting = 0; setting < SMALL_SETTINGS; ++setting) {
    assert_int_equal(small_render(caster, &scene, &scene.edited, setting, &after, NULL), STRATUS_OK);
    assert_int_equal(small_render(caster, &scene, &scene.transfer, setting, &before, NULL), STRATUS_OK);
    assert_memory_not_equal(&before, &after, sizeof before);
    int64_t n = first_refused(setting);
    for (; n < REQUESTS_MAX; n += refused_step()) {
      refuse(&allocator, n);
      const stratus_status status = small_render(caster, &scene, &scene.edited, setting, &picture, NULL);
      const int refused = has_refused(&allocator);
      refuse(&allocator, 0);
      if (status == STRATUS_OK && !refused) {
        break;
      }
      if (status != STRATUS_OK) {
        assert_out_of_memory(context, status);
      }
      assert_int_equal(small_render(caster, &scene, &scene.transfer, setting, &picture, NULL), STRATUS_OK);
      assert_memory_equal(&picture, &before, sizeof before);
    }
    assert_in_range(n, 2, REQUESTS_MAX - 1);
    assert_memory_equal(&picture, &after, sizeof after);
  }
  stratus_ray_caster_destroy(caster);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

static void a_scene_is_made_whole_or_not_at_all(void** state)
{
  static const char* names[] = { "voxel", "cloud" };
  faulty_allocator allocator = { 0 };
  stratus_context* context = open_context(&allocator, *state);
  assert_non_null(context);
  const int64_t live = allocator.live;
  for (int s = 0; s < 2; ++s) {
    stratus_status status = STRATUS_OUT_OF_MEMORY;
    for (int64_t n = 1; n < REQUESTS_MAX && status != STRATUS_OK; ++n) {
      stratus_scene* scene = NULL;
      refuse(&allocator, n);
      status = stratus_scene_create(context, names[s], &scene);
      if (status != STRATUS_OK) {
        assert_out_of_memory(context, status);
        assert_null(scene);
      }
      stratus_scene_destroy(context, scene);
      assert_int_equal(allocator.live, live);
    }
    assert_int_equal(status, STRATUS_OK);
  }
  stratus_context_destroy(context);
}

#define ON(device, test) cmocka_unit_test_prestate(test, device)

static char host[] = "host", pocl[] = "pocl", gpu[] = "gpu";

int test_allocation(void)
{
  const struct CMUnitTest tests[] = {
    ON(host, a_context_is_made_whole_or_not_at_all),
    ON(host, structures_are_made_whole_or_not_at_all),
    ON(host, a_first_picture_fails_cleanly_and_comes_at_the_next_attempt),
    ON(host, an_edit_that_fails_leaves_the_earlier_result_intact),
    ON(host, a_scene_is_made_whole_or_not_at_all),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

int test_allocation_device(void)
{
  const struct CMUnitTest tests[] = {
    ON(pocl, a_context_is_made_whole_or_not_at_all),
    ON(pocl, structures_are_made_whole_or_not_at_all),
    ON(pocl, a_first_picture_fails_cleanly_and_comes_at_the_next_attempt),
    ON(pocl, an_edit_that_fails_leaves_the_earlier_result_intact),
    ON(gpu, structures_are_made_whole_or_not_at_all),
    ON(gpu, a_first_picture_fails_cleanly_and_comes_at_the_next_attempt),
    ON(gpu, an_edit_that_fails_leaves_the_earlier_result_intact),
  };
  faulty_allocator allocator = { 0 };
  stratus_context* context = open_context(&allocator, pocl);
  if (!context) {
    return test_skip("no PoCL device on this machine");
  }
  stratus_context_destroy(context);
  return cmocka_run_group_tests(tests, NULL, NULL);
}
