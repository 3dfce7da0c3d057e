/* SPDX-License-Identifier: BSD-3-Clause
 * The OpenCL layer on PoCL: choice by name, build log, program cache, buffers, launches, and every call failing. */
#include "device.h"
#include "faulty_allocator.h"
#include "pocl.h"
#include "testing.h"

#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define COUNT 100
#define GROUP 16

static const char* const scale_source = "#pragma OPENCL FP_CONTRACT OFF\n"
                                        "__kernel void scale(__global float* values, float factor, uint count)\n"
                                        "{ const uint i = get_global_id(0); if (i < count) { values[i] *= factor + ADDED; } }\n"
                                        "__kernel void clear(__global float* values, uint count)\n"
                                        "{ const uint i = get_global_id(0); if (i < count) { values[i] = 0.0f; } }\n";

typedef struct log_lines {
  int built;
} log_lines;

static void count_builds(void* user, stratus_log_level level, const char* line)
{
  (void)level;
  ((log_lines*)user)->built += strncmp(line, "built ", 6) == 0;
}

static stratus_context* open_pocl(faulty_allocator* allocator, log_lines* lines)
{
  stratus_context* context = NULL;
  char message[1024];
  /* Upper and lower case are the same. */
  stratus_context_options options = faulty_options(allocator, strcmp(pocl_name(), "pthread") == 0 ? "PTHREAD" : "CPU-");
  options.log = lines ? count_builds : NULL;
  options.log_user = lines;
  options.program_folder = ""; /* each context builds its own */
  if (stratus_context_create(&options, &context, message, sizeof message) != STRATUS_OK) {
    fail_msg("%s", message);
  }
  return context;
}

/* Everything that a stage does with a device; values come back scaled by 3. */
static stratus_status use_device(stratus_context* context, float* values, bool borrow)
{
  cl_kernel kernel = NULL;
  cl_mem buffer = NULL;
  stratus_status status;
  const float factor = 2.0f;
  const cl_uint count = COUNT;
  const size_t global = COUNT, local = GROUP, half = COUNT / 2 * sizeof(float);
  TRY_CLEANUP(stratus_device_kernel_from(context, "test", scale_source, "-DADDED=1.0f", "scale", &kernel));
  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_READ_WRITE, COUNT * sizeof(float), borrow ? values : NULL, borrow, &buffer));
  if (!borrow) {
    TRY_CLEANUP(stratus_device_write(context, buffer, 0, half, values));
    TRY_CLEANUP(stratus_device_write(context, buffer, half, COUNT * sizeof(float) - half, values + COUNT / 2));
  }
  TRY_CLEANUP(stratus_device_argument(context, kernel, 0, sizeof buffer, &buffer));
  TRY_CLEANUP(stratus_device_argument(context, kernel, 1, sizeof factor, &factor));
  TRY_CLEANUP(stratus_device_argument(context, kernel, 2, sizeof count, &count));
  TRY_CLEANUP(stratus_device_run(context, kernel, 1, &global, &local));
  TRY_CLEANUP(stratus_device_finish(context));
  TRY_CLEANUP(stratus_device_read(context, buffer, 0, COUNT * sizeof(float), values));
cleanup:
  stratus_device_buffer_release(buffer);
  return status;
}

static void fill(float* values)
{
  for (int i = 0; i < COUNT; ++i) {
    values[i] = (float)i;
  }
}

static void assert_tripled(const float* values)
{
  for (int i = 0; i < COUNT; ++i) {
    assert_true(values[i] == 3.0f * (float)i);
  }
}

static void a_device_is_found_by_index_and_by_part_of_its_name(void** state)
{
  (void)state;
  for (int i = 0; i < stratus_device_count(); ++i) {
    char name[192], index[16];
    stratus_context* context = NULL;
    stratus_context_options options = stratus_context_options_default();
    assert_int_equal(stratus_device_name(i, name, sizeof name), STRATUS_OK);
    snprintf(index, sizeof index, "%d", i);
    options.device = index;
    assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
    assert_int_equal(stratus_context_on_device(context), 1);
    assert_string_equal(stratus_context_device(context), name);
    stratus_context_destroy(context);
  }
  faulty_allocator allocator = { 0 };
  stratus_context* context = open_pocl(&allocator, NULL);
  assert_non_null(strstr(stratus_context_device(context), pocl_name()));
  assert_true(stratus_device_is_cpu(context->device));
  assert_true(stratus_device_largest_allocation(context->device) > 1 << 20);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

static void kernels_compute_on_written_and_on_borrowed_buffers(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  stratus_context* context = open_pocl(&allocator, NULL);
  _Alignas(64) float values[COUNT + 1];
  fill(values);
  assert_int_equal(use_device(context, values, false), STRATUS_OK);
  assert_tripled(values);
  fill(values);
  assert_int_equal(use_device(context, values, true), STRATUS_OK);
  assert_tripled(values);
  /* Aligned for a float only: such memory is copied, not shared. */
  fill(values + 1);
  assert_int_equal(use_device(context, values + 1, true), STRATUS_OK);
  assert_tripled(values + 1);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

static void a_program_is_built_once_for_each_set_of_defines(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  log_lines lines = { 0 };
  stratus_context* context = open_pocl(&allocator, &lines);
  cl_kernel scale = NULL, again = NULL, clear = NULL, other = NULL;
  assert_int_equal(stratus_device_kernel_from(context, "test", scale_source, "-DADDED=1.0f", "scale", &scale), STRATUS_OK);
  assert_int_equal(lines.built, 1);
  assert_int_equal(stratus_device_kernel_from(context, "test", scale_source, "-DADDED=1.0f", "scale", &again), STRATUS_OK);
  assert_int_equal(stratus_device_kernel_from(context, "test", scale_source, "-DADDED=1.0f", "clear", &clear), STRATUS_OK);
  assert_int_equal(lines.built, 1);
  assert_ptr_equal(scale, again);
  assert_ptr_not_equal(scale, clear);
  assert_int_equal(stratus_device_kernel_from(context, "test", scale_source, "-DADDED=2.0f", "scale", &other), STRATUS_OK);
  assert_int_equal(lines.built, 2);
  assert_ptr_not_equal(scale, other);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

static void a_broken_source_leaves_its_build_log_in_the_message(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  stratus_context* context = open_pocl(&allocator, NULL);
  cl_kernel kernel = NULL;
  const int64_t live = allocator.live;
  for (int attempt = 0; attempt < 2; ++attempt) { /* a failed build must not be cached */
    assert_int_equal(stratus_device_kernel_from(context, "broken", "__kernel void f() { unheard_of_name = 1; }", NULL, "f", &kernel),
      STRATUS_DEVICE_ERROR);
    assert_null(kernel);
    assert_non_null(strstr(stratus_context_message(context), "broken"));
    assert_non_null(strstr(stratus_context_message(context), "CL_BUILD_PROGRAM_FAILURE"));
    assert_non_null(strstr(stratus_context_message(context), "unheard_of_name"));
    assert_int_equal(allocator.live, live);
  }
  assert_int_equal(stratus_device_kernel(context, "no_such_file", "", "f", &kernel), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "no_such_file"));
  assert_int_equal(stratus_device_kernel_from(context, "test", scale_source, "-DADDED=1.0f", "missing", &kernel), STRATUS_DEVICE_ERROR);
  assert_non_null(strstr(stratus_context_message(context), "CL_INVALID_KERNEL_NAME"));
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

static void a_launch_that_opencl_refuses_is_named(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  stratus_context* context = open_pocl(&allocator, NULL);
  cl_kernel kernel = NULL;
  cl_mem buffer = NULL;
  const size_t global = 10, local = (size_t)1 << 40; /* no device has such groups */
  float value = 1.0f;
  assert_int_equal(stratus_device_kernel_from(context, "test", scale_source, "-DADDED=1.0f", "clear", &kernel), STRATUS_OK);
  assert_int_equal(stratus_device_argument(context, kernel, 7, sizeof value, &value), STRATUS_DEVICE_ERROR);
  assert_non_null(strstr(stratus_context_message(context), "clSetKernelArg"));
  assert_non_null(strstr(stratus_context_message(context), "CL_INVALID_ARG_INDEX"));
  assert_int_equal(stratus_device_run(context, kernel, 1, &global, &local), STRATUS_DEVICE_ERROR);
  assert_non_null(strstr(stratus_context_message(context), "clEnqueueNDRangeKernel"));

  const size_t largest = stratus_device_largest_allocation(context->device);
  assert_int_equal(stratus_device_buffer(context, CL_MEM_READ_ONLY, largest + 1, NULL, false, &buffer), STRATUS_OUT_OF_MEMORY);
  assert_null(buffer);
  char number[32];
  snprintf(number, sizeof number, "%zu", largest + 1);
  assert_non_null(strstr(stratus_context_message(context), number));

  assert_int_equal(stratus_device_buffer(context, CL_MEM_READ_ONLY, 0, NULL, false, &buffer), STRATUS_OK); /* at least one byte */
  assert_int_equal(stratus_device_write(context, buffer, 0, 0, NULL), STRATUS_OK);
  assert_int_equal(stratus_device_read(context, buffer, 0, sizeof value, &value), STRATUS_DEVICE_ERROR);
  assert_non_null(strstr(stratus_context_message(context), "CL_INVALID_VALUE"));
  stratus_device_buffer_release(buffer);
  stratus_device_buffer_release(NULL);
  stratus_context_destroy(context);
}

static void a_device_lost_at_any_call_is_an_error_and_comes_back(void** state)
{
  (void)state;
  static const struct {
    int error;
    stratus_status status;
  } losses[] = { { CL_DEVICE_NOT_AVAILABLE, STRATUS_DEVICE_ERROR }, { CL_INVALID_COMMAND_QUEUE, STRATUS_DEVICE_ERROR },
    { CL_OUT_OF_RESOURCES, STRATUS_OUT_OF_MEMORY }, { CL_MEM_OBJECT_ALLOCATION_FAILURE, STRATUS_OUT_OF_MEMORY },
    { CL_OUT_OF_HOST_MEMORY, STRATUS_OUT_OF_MEMORY } };
  for (size_t l = 0; l < sizeof losses / sizeof losses[0]; ++l) {
    int64_t call = 0;
    for (; call < 100; ++call) {
      faulty_allocator allocator = { 0 };
      stratus_context* context = open_pocl(&allocator, NULL);
      float values[COUNT];
      fill(values);
      stratus_device_fail_after(context->device, call, losses[l].error);
      const stratus_status status = use_device(context, values, false);
      stratus_device_fail_after(context->device, -1, CL_SUCCESS);
      if (status != STRATUS_OK) {
        assert_int_equal(status, losses[l].status);
        assert_non_null(strstr(stratus_context_message(context), stratus_device_error_name(losses[l].error)));
        fill(values);
        assert_int_equal(use_device(context, values, false), STRATUS_OK);
      }
      assert_tripled(values);
      stratus_context_destroy(context);
      assert_int_equal(allocator.live, 0);
      if (status == STRATUS_OK) {
        break;
      }
    }
    assert_int_equal(call, 12); /* source, build, kernel, buffer, 2 writes, 3 arguments, launch, finish, read: none was missed */
  }
}

static void memory_refused_at_any_call_is_an_error_and_leaves_no_leak(void** state)
{
  (void)state;
  int64_t n = 1;
  for (bool done = false; !done; ++n) {
    assert_true(n < 50);
    faulty_allocator allocator = { .fail_at = n };
    stratus_context_options options = faulty_options(&allocator, pocl_name());
    stratus_context* context = NULL;
    char message[1024];
    float values[COUNT];
    fill(values);
    stratus_status status = stratus_context_create(&options, &context, message, sizeof message);
    if (status == STRATUS_OK) {
      status = use_device(context, values, false);
      done = status == STRATUS_OK;
      if (!done) {
        assert_int_equal(status, STRATUS_OUT_OF_MEMORY);
        assert_int_equal(use_device(context, values, false), STRATUS_OK);
      }
      assert_tripled(values);
    } else {
      assert_int_equal(status, STRATUS_OUT_OF_MEMORY);
      assert_null(context);
    }
    stratus_context_destroy(context);
    assert_int_equal(allocator.live, 0);
  }
  assert_true(n > 4); /* context, device, program, kernel at least */
}

static void error_names_are_those_of_the_standard(void** state)
{
  (void)state;
  assert_string_equal(stratus_device_error_name(-5), "CL_OUT_OF_RESOURCES");
  assert_string_equal(stratus_device_error_name(-54), "CL_INVALID_WORK_GROUP_SIZE");
  assert_string_equal(stratus_device_error_name(-1001), "CL_PLATFORM_NOT_FOUND_KHR");
  assert_string_equal(stratus_device_error_name(-123456), "unknown OpenCL error");
}

int test_device(void)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  char message[1024];
  options.device = pocl_name();
  if (stratus_context_create(&options, &context, message, sizeof message) == STRATUS_NO_DEVICE) {
    return test_skip(message);
  }
  stratus_context_destroy(context);
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_device_is_found_by_index_and_by_part_of_its_name),
    cmocka_unit_test(kernels_compute_on_written_and_on_borrowed_buffers),
    cmocka_unit_test(a_program_is_built_once_for_each_set_of_defines),
    cmocka_unit_test(a_broken_source_leaves_its_build_log_in_the_message),
    cmocka_unit_test(a_launch_that_opencl_refuses_is_named),
    cmocka_unit_test(a_device_lost_at_any_call_is_an_error_and_comes_back),
    cmocka_unit_test(memory_refused_at_any_call_is_an_error_and_leaves_no_leak),
    cmocka_unit_test(error_names_are_those_of_the_standard),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
