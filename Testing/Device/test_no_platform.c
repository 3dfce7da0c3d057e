/* SPDX-License-Identifier: BSD-3-Clause
 * A machine without any OpenCL platform: the core works on the host, says so, and refuses devices by name. */
#define _POSIX_C_SOURCE 200809L
#include "stratus.h"
#include "testing.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void keep_line(void* user, stratus_log_level level, const char* line)
{
  (void)level;
  snprintf(user, 1024, "%s", line);
}

static void auto_works_on_the_host_and_says_so(void** state)
{
  (void)state;
  char line[1024] = "";
  stratus_context* context = NULL;
  stratus_context_options options = stratus_context_options_default();
  options.log = keep_line;
  options.log_user = line;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  assert_int_equal(stratus_context_on_device(context), 0);
  assert_non_null(strstr(stratus_context_device(context), "host"));
  assert_non_null(strstr(line, "host"));
  stratus_context_destroy(context);
}

static void a_named_device_is_refused_with_the_reason(void** state)
{
  (void)state;
  stratus_context* context = NULL;
  char message[1024] = "", name[8];
  stratus_context_options options = stratus_context_options_default();
  options.device = "pthread";
  assert_int_equal(stratus_device_count(), 0);
  assert_int_equal(stratus_device_name(0, name, sizeof name), STRATUS_NO_DEVICE);
  assert_int_equal(stratus_context_create(&options, &context, message, sizeof message), STRATUS_NO_DEVICE);
  assert_null(context);
  assert_non_null(strstr(message, "pthread"));
  assert_non_null(strstr(message, "CL_PLATFORM_NOT_FOUND_KHR"));
}

int test_no_platform(void)
{
  /* The loader reads this once, at the first call of OpenCL in the process. */
  if (setenv("OCL_ICD_VENDORS", "/a folder that is not there", 1) != 0) {
    return 1;
  }
  if (stratus_device_count() != 0) {
    return test_skip("this machine's OpenCL loader cannot be pointed away from its platforms");
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(auto_works_on_the_host_and_says_so),
    cmocka_unit_test(a_named_device_is_refused_with_the_reason),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
