/* SPDX-License-Identifier: BSD-3-Clause
 * An OpenCL device that is lost at the n-th call, for every n. Each loss gives an error with the call's name and no leak, and when the
 * device is back the same ray caster draws the right picture. */
#include "device_state.h"
#include "faulty_allocator.h"
#include "small_scene.h"
#include "testing.h"

#include <setjmp.h>
#include <stdio.h>

#include <cmocka.h>

#define CALLS_MAX 2000

typedef struct fixture {
  faulty_allocator allocator;
  stratus_context* context;
  small_scene scene;
} fixture;

/* as_gpu: the device builds the structures, too, and a work item draws one ray. */
static stratus_status open_fixture(fixture* f, const int* as_gpu, char* message, size_t capacity)
{
  f->allocator = (faulty_allocator){ 0 };
  f->context = NULL;
  const stratus_context_options options = faulty_options(&f->allocator, "pthread");
  const stratus_status status = stratus_context_create(&options, &f->context, message, capacity);
  if (status == STRATUS_OK) {
    f->context->device->is_cpu = !*as_gpu;
    small_scene_fill(&f->scene);
    return small_scene_camera(f->context, &f->scene);
  }
  return status;
}

static void assert_lost(const stratus_context* context, stratus_status status)
{
  assert_int_equal(status, STRATUS_DEVICE_ERROR);
  assert_non_null(strstr(stratus_context_message(context), "cl"));
  assert_non_null(strstr(stratus_context_message(context), "CL_DEVICE_NOT_AVAILABLE"));
}

static void lose_after(stratus_context* context, int64_t calls)
{
  stratus_device_fail_after(context->device, calls, CL_DEVICE_NOT_AVAILABLE);
}

/* Draws with a new ray caster, whose device is lost after n calls. If that fails, draws again with the device back. Returns 1 if the first
 * attempt failed. */
static int draw_twice(fixture* f, int setting, int64_t n, small_picture* picture)
{
  stratus_ray_caster* caster = NULL;
  lose_after(f->context, n);
  stratus_status status = stratus_ray_caster_create(f->context, &caster);
  if (status == STRATUS_OK) {
    status = small_render(caster, &f->scene, &f->scene.transfer, setting, picture, NULL);
  }
  lose_after(f->context, -1);
  if (status != STRATUS_OK) {
    assert_lost(f->context, status);
    if (!caster) {
      assert_int_equal(stratus_ray_caster_create(f->context, &caster), STRATUS_OK);
    }
    assert_int_equal(small_render(caster, &f->scene, &f->scene.transfer, setting, picture, NULL), STRATUS_OK);
  }
  stratus_ray_caster_destroy(caster);
  return status != STRATUS_OK;
}

static void a_picture_survives_the_loss_at_any_call(void** state)
{
  static fixture f;
  static small_picture right, picture;
  assert_int_equal(open_fixture(&f, *state, NULL, 0), STRATUS_OK);
  for (int setting = 0; setting < SMALL_SETTINGS; ++setting) {
    assert_int_equal(draw_twice(&f, setting, -1, &right), 0);
    const int64_t live = f.allocator.live;
    int64_t n = 0;
    for (int failed = 1; failed; ++n) {
      assert_true(n < CALLS_MAX);
      failed = draw_twice(&f, setting, n, &picture);
      assert_memory_equal(&picture, &right, sizeof right);
      assert_int_equal(f.allocator.live, live);
    }
    assert_true(n > 4); /* at least a buffer, an argument, a launch and a read */
  }
  stratus_context_destroy(f.context);
  assert_int_equal(f.allocator.live, 0);
}

/* Nothing is built yet, so that the loss can also meet the build of programs. */
static void programs_are_built_at_the_next_attempt(void** state)
{
  static fixture f;
  static small_picture right, picture;
  assert_int_equal(open_fixture(&f, *state, NULL, 0), STRATUS_OK);
  assert_int_equal(draw_twice(&f, 3, -1, &right), 0);
  stratus_context_destroy(f.context);
  for (int64_t n = 0; n < 12; ++n) {
    assert_int_equal(open_fixture(&f, *state, NULL, 0), STRATUS_OK);
    assert_int_equal(draw_twice(&f, 3, n, &picture), 1);
    assert_memory_equal(&picture, &right, sizeof right);
    stratus_context_destroy(f.context);
    assert_int_equal(f.allocator.live, 0);
  }
}

static void an_edit_during_the_loss_leaves_the_earlier_result_intact(void** state)
{
  static fixture f;
  static small_picture before, after, picture;
  stratus_ray_caster* caster = NULL;
  assert_int_equal(open_fixture(&f, *state, NULL, 0), STRATUS_OK);
  assert_int_equal(stratus_ray_caster_create(f.context, &caster), STRATUS_OK);
  for (int setting = 0; setting < SMALL_SETTINGS; ++setting) {
    assert_int_equal(small_render(caster, &f.scene, &f.scene.edited, setting, &after, NULL), STRATUS_OK);
    assert_int_equal(small_render(caster, &f.scene, &f.scene.transfer, setting, &before, NULL), STRATUS_OK);
    int64_t n = 0;
    for (stratus_status status = STRATUS_DEVICE_ERROR; status != STRATUS_OK; ++n) {
      assert_true(n < CALLS_MAX);
      lose_after(f.context, n);
      status = small_render(caster, &f.scene, &f.scene.edited, setting, &picture, NULL);
      lose_after(f.context, -1);
      if (status != STRATUS_OK) {
        assert_lost(f.context, status);
        assert_int_equal(small_render(caster, &f.scene, &f.scene.transfer, setting, &picture, NULL), STRATUS_OK);
        assert_memory_equal(&picture, &before, sizeof before);
      }
    }
    assert_memory_equal(&picture, &after, sizeof after);
  }
  stratus_ray_caster_destroy(caster);
  stratus_context_destroy(f.context);
  assert_int_equal(f.allocator.live, 0);
}

static void structures_by_themselves_survive_the_loss_at_any_call(void** state)
{
  static fixture f;
  uint64_t right = 0, sum = 0;
  assert_int_equal(open_fixture(&f, *state, NULL, 0), STRATUS_OK);
  assert_int_equal(small_structures(f.context, &f.scene, &right), STRATUS_OK);
  const int64_t live = f.allocator.live;
  int64_t n = 0;
  for (stratus_status status = STRATUS_DEVICE_ERROR; status != STRATUS_OK; ++n) {
    assert_true(n < CALLS_MAX);
    lose_after(f.context, n);
    status = small_structures(f.context, &f.scene, &sum);
    lose_after(f.context, -1);
    assert_int_equal(f.allocator.live, live);
    if (status != STRATUS_OK) {
      assert_lost(f.context, status);
    }
  }
  assert_true(sum == right && n > 30); /* three stages, several kernels each */
  stratus_context_destroy(f.context);
  assert_int_equal(f.allocator.live, 0);
}

int test_device_lost(void)
{
  static fixture f;
  static int no = 0, yes = 1;
  char message[1024];
  if (open_fixture(&f, &no, message, sizeof message) == STRATUS_NO_DEVICE) {
    return test_skip(message);
  }
  stratus_context_destroy(f.context);
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_prestate(a_picture_survives_the_loss_at_any_call, &no),
    cmocka_unit_test_prestate(programs_are_built_at_the_next_attempt, &no),
    cmocka_unit_test_prestate(an_edit_during_the_loss_leaves_the_earlier_result_intact, &no),
    cmocka_unit_test_prestate(a_picture_survives_the_loss_at_any_call, &yes),
    cmocka_unit_test_prestate(programs_are_built_at_the_next_attempt, &yes),
    cmocka_unit_test_prestate(an_edit_during_the_loss_leaves_the_earlier_result_intact, &yes),
    cmocka_unit_test_prestate(structures_by_themselves_survive_the_loss_at_any_call, &yes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
