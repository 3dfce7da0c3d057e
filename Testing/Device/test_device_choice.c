/* SPDX-License-Identifier: BSD-3-Clause
 * What "auto" takes. The devices of this machine's CPUs stand for GPUs here: they are compiled for, measured, compared and taken in the
 * same way. */
#define _XOPEN_SOURCE 700
#include "device_choice.h"

#include "calibration.h"
#include "calibration_picture.h"
#include "device_state.h"
#include "faulty_allocator.h"
#include "testing.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#define FOREVER 1e9 /* milliseconds that any device beats */

static faulty_allocator allocator;
static stratus_context* context; /* on the host, until stratus_device_choose() */
static char folder[64], file[128], lines[8192];

static void keep_lines(void* user, stratus_log_level level, const char* line)
{
  (void)user;
  const size_t used = strlen(lines);
  snprintf(lines + used, sizeof lines - used, "%d %s\n", (int)level, line);
}

static stratus_context* open_context(const char* device)
{
  stratus_context* result = NULL;
  stratus_context_options options = faulty_options(&allocator, device);
  options.threads = 2;
  options.log = keep_lines;
  options.program_folder = ""; /* the folder of the case is for measured costs */
  assert_int_equal(stratus_context_create(&options, &result, NULL, 0), STRATUS_OK);
  return result;
}

static int begin(void** state)
{
  (void)state;
  allocator = (faulty_allocator){ 0 };
  snprintf(folder, sizeof folder, "/tmp/stratus-choice-XXXXXX");
  stratus_calibration_forget();
  if (!mkdtemp(folder) || setenv("STRATUS_CACHE_DIR", folder, 1) != 0) {
    return 1;
  }
  snprintf(file, sizeof file, "%s/calibration-1-%s.txt", folder, stratus_version());
  context = open_context("host");
  lines[0] = '\0';
  return 0;
}

static int end(void** state)
{
  (void)state;
  stratus_context_destroy(context);
  (void)unlink(file);
  return rmdir(folder) != 0 || allocator.live != 0;
}

static bool file_exists(void)
{
  struct stat status;
  return stat(file, &status) == 0;
}

/* Stores a time as one that three processes have measured. */
static void store(stratus_calibration calibration, double ms)
{
  stratus_calibration_forget();
  for (int process = 0; process < STRATUS_CALIBRATION_PROCESSES; ++process) {
    calibration.numbers[0] = ms;
    stratus_calibration_add(&calibration);
  }
}

static stratus_calibration of_host(void)
{
  return stratus_calibration_of_host(context, STRATUS_CALIBRATION_HOST, 1);
}

static stratus_calibration of_device(cl_device_id id)
{
  char name[320];
  stratus_device_describe(id, name, sizeof name);
  return stratus_calibration_of(STRATUS_CALIBRATION_DEVICE, name, 1);
}

static void forget_choice(void)
{
  (void)stratus_device_close(context->device);
  context->device = NULL;
  lines[0] = '\0';
}

static void host_and_device_draw_the_same_bits(void** state)
{
  stratus_context* device = open_context("0");
  float *by_host = calloc(STRATUS_CALIBRATION_FLOATS, sizeof(float)), *by_device = calloc(STRATUS_CALIBRATION_FLOATS, sizeof(float));
  double ms[2] = { 0.0, 0.0 };
  (void)state;
  assert_true(by_host && by_device);
  assert_int_equal(stratus_calibration_picture(context, by_host, ms), STRATUS_OK);
  assert_int_equal(stratus_calibration_picture(device, by_device, ms + 1), STRATUS_OK);
  assert_memory_equal(by_host, by_device, STRATUS_CALIBRATION_FLOATS * sizeof(float));
  assert_true(ms[0] > 0.0 && ms[0] < INFINITY && ms[1] > 0.0 && ms[1] < INFINITY);
  printf("calibration picture: host %.2f ms, %s %.2f ms\n", ms[0], stratus_context_device(device), ms[1]);
  free(by_host);
  free(by_device);
  stratus_context_destroy(device);
}

static void auto_measures_and_takes_the_fastest(void** state)
{
  cl_device_id ids[STRATUS_DEVICES_MAX];
  double ms[STRATUS_DEVICES_MAX];
  const int count = stratus_device_candidates(true, ids);
  (void)state;
  assert_true(count > 0);
  for (int process = 1; process <= 4; ++process) {
    stratus_calibration_forget();
    assert_int_equal(stratus_device_choose(context, "auto", true), STRATUS_OK);
    stratus_calibration host = of_host();
    stratus_calibration_read(&host);
    assert_int_equal(host.processes, process < 4 ? process : 3);
    for (int i = 0; i < count; ++i) {
      stratus_calibration device = of_device(ids[i]);
      char text[64];
      stratus_calibration_read(&device);
      assert_int_equal(device.processes, process < 4 ? process : 3);
      ms[i] = device.numbers[0];
      snprintf(text, sizeof text, "takes %.2f ms on ", ms[i]);
      assert_non_null(strstr(lines, text));
      snprintf(text, sizeof text, ", %.2f ms on the host\n", host.numbers[0]);
      assert_non_null(strstr(lines, text));
    }
    const int fastest = stratus_device_fastest(host.numbers[0], ms, count);
    assert_int_equal(stratus_context_on_device(context), fastest >= 0);
    assert_true(fastest < 0 || context->device->id == ids[fastest]);
    assert_string_equal(stratus_context_message(context), "");
    forget_choice();
  }
}

static void stored_times_decide(void** state)
{
  static const double times[][2] = { { 2.0, 1.0 }, { 1.0, 2.0 }, { 1.0, 1.0 } }; /* of the host, of every device */
  cl_device_id ids[STRATUS_DEVICES_MAX];
  const int count = stratus_device_candidates(true, ids);
  (void)state;
  for (size_t i = 0; i < sizeof times / sizeof *times; ++i) {
    const bool device = times[i][1] < times[i][0];
    (void)unlink(file);
    store(of_host(), times[i][0]);
    for (int d = 0; d < count; ++d) {
      store(of_device(ids[d]), times[i][1]);
    }
    assert_int_equal(stratus_device_choose(context, i == 0 ? NULL : "auto", true), STRATUS_OK);
    assert_int_equal(stratus_context_on_device(context), device);
    if (device) {
      assert_string_equal(stratus_context_device(context), stratus_device_label(context->device));
    } else {
      assert_non_null(strstr(stratus_context_device(context), "host ("));
      assert_non_null(strstr(lines, "drawing on the host ("));
    }
    assert_null(strstr(lines, "measured"));
    forget_choice();
  }
}

/* A context that has nothing to choose costs nothing. */
static void nothing_is_measured_without_a_choice(void** state)
{
  static const char* const devices[] = { "host", "0", "auto" };
  cl_device_id ids[STRATUS_DEVICES_MAX];
  const size_t count = stratus_device_candidates(false, ids) == 0 ? 3 : 2; /* where there is a GPU, "auto" measures */
  (void)state;
  for (size_t i = 0; i < count; ++i) {
    stratus_context* other = open_context(devices[i]);
    assert_int_equal(stratus_context_on_device(other), i == 1);
    stratus_context_destroy(other);
  }
  assert_null(strstr(lines, "measured"));
  assert_false(file_exists());
}

/* Memory is refused at the n-th request of a device's measurement, and then when it is opened to draw. */
static void a_device_that_fails_is_left_out(void** state)
{
  (void)state;
  store(of_host(), FOREVER);
  for (int n = 1;; ++n) {
    const int64_t live = allocator.live;
    assert_true(n < 100);
    stratus_calibration_forget();
    allocator.fail_at = allocator.calls + n;
    assert_int_equal(stratus_device_choose(context, "auto", true), STRATUS_OK);
    assert_string_equal(stratus_context_message(context), "");
    if (allocator.calls < allocator.fail_at) {
      assert_int_equal(stratus_context_on_device(context), 1);
      assert_true(n > 3);
      return;
    }
    assert_non_null(strstr(lines, "cannot be used: out of memory"));
    if (!stratus_context_on_device(context)) { /* else there is a second device */
      assert_int_equal(allocator.live, live);
      assert_non_null(strstr(lines, "drawing on the host"));
      assert_non_null(strstr(stratus_context_device(context), "host"));
    }
    forget_choice();
  }
}

static void a_host_without_memory_is_an_error(void** state)
{
  (void)state;
  for (int n = 1; n <= 2; ++n) {
    const int64_t live = allocator.live;
    allocator.fail_at = allocator.calls + n;
    assert_int_equal(stratus_device_choose(context, "auto", true), STRATUS_OUT_OF_MEMORY);
    assert_non_null(strstr(stratus_context_message(context), "out of memory"));
    assert_int_equal(allocator.live, live);
    assert_int_equal(stratus_context_on_device(context), 0);
  }
  assert_false(file_exists());
}

static void a_device_lost_at_any_call_fails_the_picture(void** state)
{
  enum { CALLS = 14 }; /* some more than a first picture makes */
  stratus_context* device = open_context("0");
  float* rgba = calloc(STRATUS_CALIBRATION_FLOATS, sizeof(float));
  double ms;
  (void)state;
  assert_non_null(rgba);
  for (int calls = 0; calls < CALLS; ++calls) {
    stratus_device_programs_release(device->device);
    const int64_t live = allocator.live;
    stratus_device_fail_after(device->device, calls, CL_DEVICE_NOT_AVAILABLE);
    assert_int_equal(stratus_calibration_picture(device, rgba, &ms), STRATUS_DEVICE_ERROR);
    assert_non_null(strstr(stratus_context_message(device), "CL_DEVICE_NOT_AVAILABLE"));
    stratus_device_fail_after(device->device, -1, CL_SUCCESS);
    stratus_device_programs_release(device->device);
    assert_int_equal(allocator.live, live);
  }
  assert_int_equal(stratus_calibration_picture(device, rgba, &ms), STRATUS_OK);
  free(rgba);
  stratus_context_destroy(device);
}

int test_device_choice(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(host_and_device_draw_the_same_bits, begin, end),
    cmocka_unit_test_setup_teardown(auto_measures_and_takes_the_fastest, begin, end),
    cmocka_unit_test_setup_teardown(stored_times_decide, begin, end),
    cmocka_unit_test_setup_teardown(nothing_is_measured_without_a_choice, begin, end),
  };
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  return cmocka_run_group_tests(tests, NULL, NULL);
}

int test_device_choice_fails(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(a_device_that_fails_is_left_out, begin, end),
    cmocka_unit_test_setup_teardown(a_host_without_memory_is_an_error, begin, end),
    cmocka_unit_test_setup_teardown(a_device_lost_at_any_call_fails_the_picture, begin, end),
  };
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  return cmocka_run_group_tests(tests, NULL, NULL);
}
