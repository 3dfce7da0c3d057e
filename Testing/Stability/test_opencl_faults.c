/* SPDX-License-Identifier: BSD-3-Clause
 * Every call of OpenCL fails, once each, in everything that the core does on a device. A layer below the loader refuses the call, or every
 * call from there on, or lets the device vanish: later commands then seem to succeed, but have no effect. Each fault gives an error with
 * OpenCL's name for it, leaves no command running and holds no object, and the next try gives equal bits.
 *
 * Testing/run takes some calls of each job, STRATUS_LONG=1 all of them. */
#define _GNU_SOURCE
#include "calibration.h"
#include "device_jobs.h"
#include "faulty_allocator.h"
#include "opencl_tries.h"

#include <stdio.h>

#define SHORT_CALLS 4 /* of a job, for each kind of fault, without STRATUS_LONG */

static faulty_allocator allocator;
static int64_t without_it;
static uint64_t right_colors; /* of the job */

static const int errors[] = { CL_DEVICE_NOT_AVAILABLE, CL_OUT_OF_RESOURCES, CL_MEM_OBJECT_ALLOCATION_FAILURE, CL_OUT_OF_HOST_MEMORY,
  CL_INVALID_COMMAND_QUEUE, CL_INVALID_VALUE, CL_BUILD_PROGRAM_FAILURE, -9999 };

static bool is_memory(int error)
{
  return error == CL_OUT_OF_RESOURCES || error == CL_MEM_OBJECT_ALLOCATION_FAILURE || error == CL_OUT_OF_HOST_MEMORY;
}

static stratus_context* open_context(bool as_gpu)
{
  stratus_context* context = NULL;
  stratus_context_options options = faulty_options(&allocator, "0");
  options.threads = 1; /* in hundreds of tiny calls threads would only wait for each other */
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  context->device->is_cpu = !as_gpu;
  return context;
}

static stratus_status attempt(stratus_context* context, const device_job* job, void** kept, uint64_t* sum)
{
  *sum = 0;
  if (job->open && !*kept) {
    const stratus_status status = job->open(context, job->number, kept);
    if (status != STRATUS_OK) {
      assert_null(*kept);
      return status;
    }
  }
  return job->run(context, job->number, *kept, sum);
}

static void close_kept(const device_job* job, void** kept)
{
  if (*kept) {
    job->close(*kept);
    *kept = NULL;
  }
}

static void assert_message(const char* job, const char* message, stratus_status status)
{
  const int64_t n = faults->first;
  assert_true(n >= 0); /* a vanished device that nobody waited for would leave the picture undrawn */
  const int error = faults->error;
  const char* call = faults->trace[n];
  const bool listing = strcmp(call, "clGetPlatformIDs") == 0 || strcmp(call, "clGetDeviceIDs") == 0;
  const stratus_status expected = listing ? STRATUS_NO_DEVICE : is_memory(error) ? STRATUS_OUT_OF_MEMORY : STRATUS_DEVICE_ERROR;
  if (status != expected || !strstr(message, stratus_device_error_name(error)) ||
    !strstr(message, listing ? "no OpenCL device" : " failed")) {
    fail_msg("%s, fault %d at call %d (%s), %s: %s: \"%s\"", job, (int)faults->fault, (int)n, call, stratus_device_error_name(error),
      stratus_status_name(status), message);
  }
}

/* Work for which the device has no memory is done on the host, with equal bits. The ray caster may leave out work that only saves time
 * (ray_trial.c, ray_probe.c). */
static bool done_on_host(stratus_status status)
{
  return status == STRATUS_OK && is_memory(faults->error);
}

static bool draws_without(const device_job* job, stratus_status status)
{
  return done_on_host(status) && job->open == job_picture_open;
}

/* One fault in a job of a context whose programs are built. Returns whether the fault met a call. */
static bool try_job(stratus_context* context, const device_job* job, opencl_fault fault, int64_t n, uint64_t right, int64_t* live)
{
  const int error = errors[n % (int64_t)COUNT_OF(errors)];
  const int64_t held = faults->live;
  uint64_t sum, before = 0, again = 0;
  void* kept = NULL;
  if (job->before) {
    assert_int_equal(job->open(context, job->number, &kept), STRATUS_OK);
    assert_int_equal(job->before(context, job->number, kept, &before), STRATUS_OK);
  }
  begin_fault(fault, n, error);
  const stratus_status status = attempt(context, job, &kept, &sum);
  const bool met = end_fault(), without = met && draws_without(job, status), on_host = met && done_on_host(status);
  const uint64_t colors = job_colors;
  without_it += on_host;
  assert_true(!on_host || without || sum == right);
  if (met && !on_host) {
    assert_message(job->name, stratus_context_message(context), status);
  }
  if (met) {
    if (job->before) {
      assert_int_equal(job->before(context, job->number, kept, &again), STRATUS_OK);
      assert_true(again == before || without);
    }
    assert_int_equal(attempt(context, job, &kept, &sum), STRATUS_OK);
  } else {
    assert_int_equal(status, STRATUS_OK);
  }
  /* Without a structure the picture is the same. Without the probe, which modes other than composite do not need, it keeps the last rule
   * and step, and the next try has the probe's. */
  if (!without) {
    assert_true(sum == right);
  } else {
    assert_true(job_colors == right_colors);
    assert_true(colors == right_colors || small_setting(job->number).mode == STRATUS_MODE_COMPOSITE);
  }
  close_kept(job, &kept);
  /* Another structure may need other kernels, which the context keeps. */
  if (on_host) {
    *live = allocator.live;
  } else {
    assert_int_equal(allocator.live, *live);
    assert_int_equal(faults->live, held);
  }
  assert_int_equal(faults->pending, 0);
  return met;
}

static void every_job_survives_a_fault_at_any_call(void** state)
{
  const bool as_gpu = *(const int*)*state;
  stratus_context* context = open_context(as_gpu);
  int asked = 0;
  for (size_t j = 0; j < COUNT_OF(device_jobs); ++j) {
    const device_job* job = device_jobs + j;
    uint64_t right = 0, sum = 0;
    void* kept = NULL;
    assert_int_equal(attempt(context, job, &kept, &right), STRATUS_OK);
    right_colors = job_colors;
    assert_true(!job->before || job->before(context, job->number, kept, &sum) == STRATUS_OK); /* its programs are built, too */
    close_kept(job, &kept);
    if (job->before) { /* a fault meets only calls after this */
      assert_int_equal(job->open(context, job->number, &kept), STRATUS_OK);
      assert_int_equal(job->before(context, job->number, kept, &sum), STRATUS_OK);
    }
    begin_fault(OPENCL_FAULT_ONCE, -1, 0);
    assert_int_equal(attempt(context, job, &kept, &sum), STRATUS_OK);
    close_kept(job, &kept);
    assert_false(end_fault());
    assert_true(sum == right);
    const int64_t calls = faults->calls;
    int64_t live = allocator.live;
    const int64_t step = long_run() || calls <= SHORT_CALLS ? 1 : calls / SHORT_CALLS;
    asked += calls > 0;
    for (int fault = 0; fault < OPENCL_FAULTS && calls > 0; ++fault) {
      int64_t n = step == 1 ? 0 : (int64_t)(j + (size_t)fault) % step;
      while (try_job(context, job, (opencl_fault)fault, n, right, &live)) {
        n += step;
      }
      assert_true(n > 0);
    }
    if (calls > 0) {
      print_message("%s %d: %d calls\n", job->name, job->number, (int)calls);
    }
  }
  /* As a CPU's, the device only draws, and finds first hits of the trees that are not of boxes; a GPU does all of it. */
  assert_in_range(asked, as_gpu ? (int)COUNT_OF(device_jobs) : 20, COUNT_OF(device_jobs));
  stratus_context_destroy(context);
  assert_int_equal(faults->live, 0);
  assert_int_equal(allocator.live, 0);
}

/* Once there is a queue, the device's name is read only to keep a program on disk; without the name it is not kept. */
static bool reads_a_key(int64_t n)
{
  bool queue = false;
  for (int64_t c = 0; c < n; ++c) {
    queue = queue || strcmp(faults->trace[c], "clCreateCommandQueue") == 0;
  }
  return queue && (strcmp(faults->trace[n], "clGetDeviceInfo") == 0 || strcmp(faults->trace[n], "clGetPlatformInfo") == 0);
}

/* The fault may meet the search for devices, their properties, context and queue, and programs. */
static void a_context_is_made_and_draws_or_says_what_failed(void** state)
{
  const bool as_gpu = *(const int*)*state;
  const device_job* job = device_jobs + 3;
  uint64_t right = 0;
  for (int fault = OPENCL_FAULTS - 1; fault >= 0; --fault) {
    bool met = true;
    for (int64_t n = -1; met; n = next_call(n, 40)) {
      char message[1024] = "";
      uint64_t sum = 0;
      void* kept = NULL;
      stratus_context* context = NULL;
      stratus_context_options options = faulty_options(&allocator, "0");
      options.threads = 1;
      begin_fault((opencl_fault)fault, n, n < 0 ? 0 : errors[(n + fault) % 6]);
      stratus_status status = stratus_context_create(&options, &context, message, sizeof message);
      if (status == STRATUS_OK) {
        context->device->is_cpu = !as_gpu;
        status = attempt(context, job, &kept, &sum);
        snprintf(message, sizeof message, "%s", stratus_context_message(context));
      } else {
        assert_null(context);
      }
      const bool failed = status != STRATUS_OK;
      met = end_fault() || n < 0;
      if (n < 0) {
        keep_usual();
      }
      const bool without = met && n >= 0 && kept && draws_without(job, status);
      if (failed) {
        assert_message("context", message, status);
      } else {
        /* The device's name is for people: where it cannot be had, the device is an unnamed one. A device may not know of doubles. */
        const bool known = strcmp(stratus_context_device(context), "unnamed device") == 0 ||
          (faults->error == CL_INVALID_VALUE && !context->device->has_double);
        if (n >= 0 && met && !known && !without && !reads_a_key(n)) {
          fail_msg("fault %d at call %d (%s) goes unnoticed", fault, (int)n, faults->trace[n]);
        }
      }
      if (!context) {
        assert_int_equal(faults->live, 0);
        context = open_context(as_gpu);
      }
      assert_int_equal(attempt(context, job, &kept, &sum), STRATUS_OK);
      right = n < 0 ? sum : right;
      assert_true(sum == right);
      close_kept(job, &kept);
      stratus_context_destroy(context);
      assert_int_equal(faults->live, 0);
      assert_int_equal(faults->pending, 0);
      assert_int_equal(allocator.live, 0);
    }
  }
}

/* If the compiler refuses a program, the core reads its log; that may fail, too. */
static void a_program_that_does_not_compile_says_so(void** state)
{
  (void)state;
  for (int64_t later = 0; later < 3; ++later) {
    stratus_context* context = open_context(true);
    uint64_t sum;
    void* kept = NULL;
    int64_t at = 0;
    begin_fault(OPENCL_FAULT_ONCE, -1, CL_BUILD_PROGRAM_FAILURE);
    assert_int_equal(attempt(context, device_jobs + 3, &kept, &sum), STRATUS_OK);
    (void)end_fault();
    close_kept(device_jobs + 3, &kept);
    stratus_context_destroy(context);
    while (strcmp(faults->trace[at], "clBuildProgram") != 0) {
      ++at;
    }
    context = open_context(true);
    begin_fault(later == 0 ? OPENCL_FAULT_ONCE : OPENCL_FAULT_ALL, at, CL_BUILD_PROGRAM_FAILURE);
    assert_int_equal(attempt(context, device_jobs + 3, &kept, &sum), STRATUS_DEVICE_ERROR);
    assert_true(end_fault());
    assert_string_equal(faults->trace[at + 1], "clGetProgramBuildInfo");
    note_calls(at + 1, at + 2, later > 0);
    assert_non_null(strstr(stratus_context_message(context), "building the kernels"));
    assert_non_null(strstr(stratus_context_message(context), "CL_BUILD_PROGRAM_FAILURE"));
    close_kept(device_jobs + 3, &kept);
    stratus_context_destroy(context);
    assert_int_equal(faults->live, 0);
    assert_int_equal(allocator.live, 0);
  }
}

static stratus_status take_forever(stratus_context* context, void* job, double* numbers)
{
  (void)context;
  (void)job;
  numbers[0] = 1e9; /* milliseconds that any device beats */
  return STRATUS_OK;
}

/* Makes a context of a host so slow that "auto" takes any device that works. */
static stratus_context* open_slow_host(void)
{
  const stratus_context_options options = faulty_options(&allocator, "host");
  stratus_context* context = NULL;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  stratus_calibration_forget();
  stratus_calibration host = stratus_calibration_of_host(context, STRATUS_CALIBRATION_HOST, 1);
  assert_int_equal(stratus_calibrate(context, &host, take_forever, NULL), STRATUS_OK);
  return context;
}

/* "auto" leaves out a device that fails, whatever it fails at, and then the host draws. */
static void a_device_that_fails_is_left_out_by_auto(void** state)
{
  bool met = true;
  (void)state;
  for (int64_t n = -1; met || n < usual.count; n = next_call(n, OPENCL_TRACE_MAX)) {
    stratus_context* context = open_slow_host();
    begin_fault(n % 2 ? OPENCL_FAULT_VANISH : OPENCL_FAULT_ALL, n, n < 0 ? 0 : errors[n % 6]);
    assert_int_equal(stratus_device_choose(context, "auto", true), STRATUS_OK);
    met = end_fault() || n < 0;
    if (n < 0) {
      assert_non_null(context->device);
      keep_usual();
    } else {
      assert_true(!met || !context->device);
    }
    stratus_context_destroy(context);
    assert_int_equal(faults->live, 0);
    assert_int_equal(allocator.live, 0);
  }
  stratus_calibration_forget();
}

/* Every picture is drawn and read; then the device is gone, which only the end of its queue reports. */
static void a_device_lost_behind_its_measurement_is_left_out_by_auto(void** state)
{
  stratus_context* context = open_slow_host();
  (void)state;
  begin_fault(OPENCL_FAULT_VANISH, -1, CL_DEVICE_NOT_AVAILABLE);
  faults->at_first = "clFinish";
  assert_int_equal(stratus_device_choose(context, "auto", true), STRATUS_OK);
  assert_true(end_fault());
  assert_string_equal(faults->trace[faults->first], "clFinish");
  assert_null(context->device);
  assert_string_equal(stratus_context_message(context), "");
  stratus_context_destroy(context);
  assert_int_equal(faults->live, 0);
  assert_int_equal(allocator.live, 0);
  stratus_calibration_forget();
}

/* Runs last: the cases before must have met each function that the core calls. */
static void each_function_that_the_core_calls_has_failed(void** state)
{
  (void)state;
  int functions = 0;
  for (; functions < NAMES_MAX && seen[functions]; ++functions) {
    /* clFinish() only clears up after another call that failed, and that call's error is reported. */
    if (!refused[functions] && strcmp(seen[functions], "clFinish") != 0) {
      fail_msg("%s never failed", seen[functions]);
    }
  }
  print_message(
    "%d functions of OpenCL, %d tries, %d of them done on the host for want of memory\n", functions, (int)tries, (int)without_it);
  assert_true(functions >= 16);
}

int test_opencl_faults(void)
{
  static int no = 0, yes = 1;
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_prestate(a_context_is_made_and_draws_or_says_what_failed, &no),
    cmocka_unit_test_prestate(a_context_is_made_and_draws_or_says_what_failed, &yes),
    cmocka_unit_test(a_program_that_does_not_compile_says_so),
    cmocka_unit_test_prestate(every_job_survives_a_fault_at_any_call, &no),
    cmocka_unit_test_prestate(every_job_survives_a_fault_at_any_call, &yes),
    cmocka_unit_test(a_device_that_fails_is_left_out_by_auto),
    cmocka_unit_test(a_device_lost_behind_its_measurement_is_left_out_by_auto),
    cmocka_unit_test(each_function_that_the_core_calls_has_failed),
  };
  if (setenv("STRATUS_CACHE_DIR", "", 1) != 0) { /* each choice measures */
    return 1;
  }
  faults = load_opencl_faults();
  if (!faults) {
    return test_skip("no OpenCL device on this machine, or a loader without layers");
  }
  jobs_prepare();
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  jobs_release();
  return failed;
}
