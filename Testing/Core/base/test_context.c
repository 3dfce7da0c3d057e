/* SPDX-License-Identifier: BSD-3-Clause
 * The context: options that it takes and refuses, and that log, progress, cancellation and the allocator's hook reach the caller. */
#include "faulty_allocator.h"
#include "base.h"

#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void defaults_work_and_nothing_may_be_null(void** state)
{
  (void)state;
  stratus_context* context = NULL;
  char message[256] = "untouched";
  assert_int_equal(stratus_context_create(NULL, &context, message, sizeof message), STRATUS_OK);
  assert_string_equal(message, "");
  assert_string_equal(stratus_context_message(context), "");
  assert_true(stratus_context_threads(context) >= 1);
  assert_true(strlen(stratus_context_device(context)) > 0);
  stratus_context_destroy(context);
  stratus_context_destroy(NULL);
  assert_int_equal(stratus_context_create(NULL, NULL, NULL, 0), STRATUS_INVALID_ARGUMENT);
  assert_string_equal(stratus_context_device(NULL), "");
  assert_int_equal(stratus_context_on_device(NULL), 0);
  assert_int_equal(stratus_context_threads(NULL), 0);
  assert_non_null(stratus_context_message(NULL));
}

static void host_is_plain_c_and_says_how_many_threads(void** state)
{
  (void)state;
  stratus_context* context = NULL;
  stratus_context_options options = stratus_context_options_default();
  options.device = "host";
  options.threads = 3;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  assert_int_equal(stratus_context_on_device(context), 0);
  assert_int_equal(stratus_context_threads(context), 3);
  assert_non_null(strstr(stratus_context_device(context), "host ("));
  assert_non_null(strstr(stratus_context_device(context), "3 threads)"));
  stratus_context_destroy(context);
}

static void assert_refused(const stratus_context_options* options, stratus_status status, const char* part)
{
  stratus_context* context = (stratus_context*)(uintptr_t)8;
  char message[1024] = "";
  assert_int_equal(stratus_context_create(options, &context, message, sizeof message), status);
  assert_null(context);
  assert_non_null(strstr(message, part));
}

static void wrong_options_are_refused_by_their_value(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  stratus_context_options options = faulty_options(&allocator, "host");
  options.threads = -1;
  assert_refused(&options, STRATUS_INVALID_ARGUMENT, "-1");
  options.threads = 1025;
  assert_refused(&options, STRATUS_INVALID_ARGUMENT, "1025");
  options.threads = 1024;
  options.release = NULL;
  assert_refused(&options, STRATUS_INVALID_ARGUMENT, "release");
  options = faulty_options(&allocator, "host");
  options.allocate = NULL;
  assert_refused(&options, STRATUS_INVALID_ARGUMENT, "allocate");
  assert_int_equal(allocator.live, 0);
}

static void an_unknown_device_is_named_and_the_known_ones_listed(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  stratus_context_options options = faulty_options(&allocator, "no such accelerator");
  assert_refused(&options, STRATUS_NO_DEVICE, "no such accelerator");
  if (stratus_device_count() > 0) {
    char name[192];
    assert_int_equal(stratus_device_name(0, name, sizeof name), STRATUS_OK);
    assert_refused(&options, STRATUS_NO_DEVICE, name);
  } else {
    assert_refused(&options, STRATUS_NO_DEVICE, "none");
  }
  options.device = "4711";
  assert_refused(&options, STRATUS_NO_DEVICE, "4711");
  options.device = "99999999999999999999999999"; /* beyond any integer */
  assert_refused(&options, STRATUS_NO_DEVICE, "99999999999999999999999999");
  assert_int_equal(allocator.live, 0);
}

static void a_short_message_buffer_is_not_overrun(void** state)
{
  (void)state;
  stratus_context* context = NULL;
  stratus_context_options options = stratus_context_options_default();
  char message[8] = { 'a', 'a', 'a', 'a', 'a', 'a', 'a', 'z' };
  options.threads = -5;
  assert_int_equal(stratus_context_create(&options, &context, message, 7), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(strlen(message), 6);
  assert_int_equal(message[7], 'z');
}

static void device_names_exist_exactly_below_the_count(void** state)
{
  (void)state;
  char name[192];
  const int count = stratus_device_count();
  assert_true(count >= 0);
  for (int i = 0; i < count; ++i) {
    char whole[192];
    assert_int_equal(stratus_device_name(i, whole, sizeof whole), STRATUS_OK);
    assert_true(strlen(whole) > 0);
    assert_int_equal(stratus_device_name(i, name, 4), STRATUS_OK);
    assert_true(strlen(name) <= 3 && strncmp(name, whole, strlen(name)) == 0);
    assert_int_equal(stratus_device_name(i, NULL, 4), STRATUS_INVALID_ARGUMENT);
  }
  assert_int_equal(stratus_device_name(-1, name, sizeof name), STRATUS_NO_DEVICE);
  assert_int_equal(stratus_device_name(count, name, sizeof name), STRATUS_NO_DEVICE);
}

typedef struct log_lines {
  int count;
  char last[1024];
} log_lines;

static void keep_line(void* user, stratus_log_level level, const char* line)
{
  log_lines* lines = user;
  (void)level;
  ++lines->count;
  snprintf(lines->last, sizeof lines->last, "%s", line);
}

static void auto_takes_a_gpu_or_says_that_the_host_draws(void** state)
{
  (void)state;
  log_lines lines = { 0 };
  stratus_context* context = NULL;
  stratus_context_options options = stratus_context_options_default();
  options.log = keep_line;
  options.log_user = &lines;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  if (!stratus_context_on_device(context)) {
    assert_true(lines.count >= 1);
    assert_non_null(strstr(lines.last, "drawing on the host"));
  }
  stratus_context_destroy(context);
}

typedef struct stopper {
  int calls;
  int stop_at; /* call that asks to stop, from 1; 0: none does */
  double last;
} stopper;

static int watch(void* user, const char* stage, double fraction)
{
  stopper* s = user;
  assert_string_equal(stage, "scene");
  assert_true(fraction >= s->last && fraction <= 1.0);
  s->last = fraction;
  return ++s->calls == s->stop_at;
}

static void progress_rises_and_can_cancel_at_every_report_without_a_leak(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  stopper s = { 0 };
  stratus_context* context = NULL;
  stratus_context_options options = faulty_options(&allocator, "host");
  options.progress = watch;
  options.progress_user = &s;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  const int64_t live = allocator.live;
  stratus_scene* scene = NULL;
  static const int stops[] = { 1, 2, 17, 32 };
  for (size_t i = 0; i < sizeof stops / sizeof stops[0]; ++i) {
    s = (stopper){ .stop_at = stops[i] };
    assert_int_equal(stratus_scene_create(context, "cloud", &scene), STRATUS_CANCELLED);
    assert_null(scene);
    assert_int_equal(s.calls, stops[i]);
    assert_non_null(strstr(stratus_context_message(context), "cancelled during scene"));
    assert_int_equal(allocator.live, live);
  }
  s = (stopper){ 0 };
  assert_int_equal(stratus_scene_create(context, "cloud", &scene), STRATUS_OK);
  assert_true(s.calls >= 32);
  stratus_scene_destroy(context, scene);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

static void the_callers_allocator_serves_everything_and_gets_it_back(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  stratus_context* context = NULL;
  stratus_context_options options = faulty_options(&allocator, "host");
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  assert_true(allocator.live > 0);
  const int64_t calls = allocator.calls;
  stratus_scene* scene = NULL;
  assert_int_equal(stratus_scene_create(context, "voxel", &scene), STRATUS_OK);
  assert_true(allocator.calls > calls);
  stratus_scene_destroy(context, scene);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);

  allocator = (faulty_allocator){ .fail_at = 1 };
  assert_refused(&options, STRATUS_OUT_OF_MEMORY, "bytes");
  assert_int_equal(allocator.live, 0);
}

static void memory_of_any_size_is_aligned(void** state)
{
  (void)state;
  stratus_context* context = NULL;
  void* memory[200];
  assert_int_equal(stratus_context_create(NULL, &context, NULL, 0), STRATUS_OK);
  for (size_t i = 0; i < 200; ++i) {
    assert_int_equal(stratus_allocate(context, i * i * i / 7 + 1, 1, &memory[i]), STRATUS_OK);
    assert_int_equal((uintptr_t)memory[i] % 64, 0);
    memset(memory[i], (int)i, i * i * i / 7 + 1);
  }
  for (size_t i = 0; i < 200; ++i) {
    assert_int_equal(((unsigned char*)memory[i])[i * i * i / 7], i);
    stratus_release(context, memory[i]);
  }
  stratus_release(context, NULL);
  stratus_context_destroy(context);
}

static void sizes_that_overflow_are_reported_not_wrapped(void** state)
{
  (void)state;
  stratus_context* context = NULL;
  stratus_context_options options = stratus_context_options_default();
  options.device = "host";
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  void* memory = NULL;
  size_t product = 7;
  const size_t big = (size_t)1 << (4 * sizeof(size_t));
  assert_int_equal(stratus_product(context, "volume", big, big, 1, &product), STRATUS_OVERFLOW);
  assert_int_equal(stratus_product(context, "volume", big, big - 1, 2, &product), STRATUS_OVERFLOW);
  assert_non_null(strstr(stratus_context_message(context), "volume"));
  assert_int_equal(stratus_allocate(context, big, big, &memory), STRATUS_OVERFLOW);
  assert_int_equal(stratus_allocate(context, SIZE_MAX, 1, &memory), STRATUS_OUT_OF_MEMORY);
  assert_null(memory);
  assert_int_equal(stratus_product(context, "volume", 3, 5, 7, &product), STRATUS_OK);
  assert_int_equal(product, 105);
  stratus_context_destroy(context);
}

static void every_status_and_type_has_its_name_or_size(void** state)
{
  (void)state;
  for (int i = STRATUS_OK; i <= STRATUS_FILE_ERROR; ++i) {
    for (int j = STRATUS_OK; j < i; ++j) {
      assert_string_not_equal(stratus_status_name((stratus_status)i), stratus_status_name((stratus_status)j));
    }
  }
  assert_non_null(stratus_status_name((stratus_status)99));
  assert_int_equal(stratus_type_size(STRATUS_INT8), 1);
  assert_int_equal(stratus_type_size(STRATUS_UINT16), 2);
  assert_int_equal(stratus_type_size(STRATUS_FLOAT32), 4);
  assert_int_equal(stratus_type_size(STRATUS_FLOAT64), 8);
  assert_int_equal(stratus_type_size((stratus_type)99), 0);
}

int test_context(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(defaults_work_and_nothing_may_be_null),
    cmocka_unit_test(host_is_plain_c_and_says_how_many_threads),
    cmocka_unit_test(wrong_options_are_refused_by_their_value),
    cmocka_unit_test(an_unknown_device_is_named_and_the_known_ones_listed),
    cmocka_unit_test(a_short_message_buffer_is_not_overrun),
    cmocka_unit_test(device_names_exist_exactly_below_the_count),
    cmocka_unit_test(auto_takes_a_gpu_or_says_that_the_host_draws),
    cmocka_unit_test(progress_rises_and_can_cancel_at_every_report_without_a_leak),
    cmocka_unit_test(the_callers_allocator_serves_everything_and_gets_it_back),
    cmocka_unit_test(memory_of_any_size_is_aligned),
    cmocka_unit_test(sizes_that_overflow_are_reported_not_wrapped),
    cmocka_unit_test(every_status_and_type_has_its_name_or_size),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
