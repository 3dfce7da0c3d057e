/* SPDX-License-Identifier: BSD-3-Clause
 * Gives a context its device. "auto" measures the host and every candidate by the calibration picture, and takes the fastest. */
#include "device_choice.h"

#include "calibration.h"
#include "calibration_picture.h"
#include "instruction_set.h"

#include <stdio.h>
#include <string.h>

#define NAME_MOST 320

/* Draw in a context like `context`, but on the device of `job`; NULL: on the host. The user did not request this image, so the caller's
 * callbacks are not called. */
static stratus_status measure(stratus_context* context, void* job, double* numbers)
{
  const cl_device_id* id = job;
  stratus_context scratch = *context;
  void* rgba = NULL;
  stratus_status status = STRATUS_OK;
  scratch.options.progress = NULL;
  scratch.options.log = NULL;
  scratch.device = NULL;
  if (id) {
    TRY_CLEANUP(stratus_device_open_id(&scratch, *id, &scratch.device));
  }
  TRY_CLEANUP(stratus_allocate(&scratch, STRATUS_CALIBRATION_FLOATS, sizeof(float), &rgba));
  status = stratus_calibration_picture(&scratch, rgba, numbers);
cleanup:
  stratus_release(&scratch, rgba);
  const cl_int end = stratus_device_close(scratch.device);
  if (status == STRATUS_OK && end != CL_SUCCESS) {
    status =
      stratus_fail(&scratch, STRATUS_DEVICE_ERROR, "clFinish failed behind the picture: %s (%d)", stratus_device_error_name(end), end);
  }
  if (status != STRATUS_OK) {
    (void)stratus_fail(context, status, "%s", scratch.message);
  }
  return status;
}

static stratus_status time_host(stratus_context* context, double* ms)
{
  stratus_calibration calibration = stratus_calibration_of_host(context, STRATUS_CALIBRATION_HOST, 1);
  TRY(stratus_calibrate(context, &calibration, measure, NULL));
  *ms = calibration.numbers[0];
  return STRATUS_OK;
}

/* The message of a device that is left out belongs to the log: the context's creation does not fail by it. */
static void leave_out(stratus_context* context, const char* name)
{
  stratus_log(context, STRATUS_LOG_WARNING, "%s cannot be used: %s", name, context->message);
  context->message[0] = '\0';
}

/* Returns INFINITY for a device that fails. */
static double time_device(stratus_context* context, cl_device_id id, double host_ms)
{
  char name[NAME_MOST];
  stratus_device_describe(id, name, sizeof name);
  stratus_calibration calibration = stratus_calibration_of(STRATUS_CALIBRATION_DEVICE, name, 1);
  if (stratus_calibrate(context, &calibration, measure, &id) != STRATUS_OK) {
    leave_out(context, name);
    return INFINITY;
  }
  stratus_log(context, STRATUS_LOG_INFO, "the picture of the calibration takes %.2f ms on %s, %.2f ms on the host", calibration.numbers[0],
    name, host_ms);
  return calibration.numbers[0];
}

int stratus_device_fastest(double host_ms, const double* device_ms, int count)
{
  int fastest = -1;
  double least = host_ms;
  for (int i = 0; i < count; ++i) {
    if (device_ms[i] < least) {
      least = device_ms[i];
      fastest = i;
    }
  }
  return fastest;
}

/* Leaves the context's device NULL where the host draws. */
static stratus_status choose_fastest(stratus_context* context, bool processors)
{
  cl_device_id ids[STRATUS_DEVICES_MAX];
  double host_ms = 0.0, device_ms[STRATUS_DEVICES_MAX];
  const int count = stratus_device_candidates(processors, ids);
  if (count == 0) {
    stratus_log(
      context, STRATUS_LOG_INFO, "no OpenCL GPU among %d device(s): drawing on the %s", stratus_device_count(), context->device_name);
    return STRATUS_OK;
  }
  TRY(time_host(context, &host_ms));
  for (int i = 0; i < count; ++i) {
    device_ms[i] = time_device(context, ids[i], host_ms);
  }
  const int taken = stratus_device_fastest(host_ms, device_ms, count);
  if (taken >= 0) {
    char name[NAME_MOST];
    stratus_device_describe(ids[taken], name, sizeof name);
    if (stratus_device_open_id(context, ids[taken], &context->device) == STRATUS_OK) {
      stratus_log(context, STRATUS_LOG_INFO, "drawing on %s", name);
      return STRATUS_OK;
    }
    leave_out(context, name);
  }
  stratus_log(context, STRATUS_LOG_INFO, "drawing on the %s", context->device_name);
  return STRATUS_OK;
}

stratus_status stratus_device_choose(stratus_context* context, const char* selector, bool processors)
{
  if (!selector || !*selector) {
    selector = "auto";
  }
  snprintf(context->device_name, sizeof context->device_name, "host (%s, %d thread%s)", stratus_isa_name(), context->threads,
    context->threads == 1 ? "" : "s");
  if (strcmp(selector, "auto") == 0) {
    TRY(choose_fastest(context, processors));
  } else if (strcmp(selector, "host") != 0) {
    TRY(stratus_device_open(context, selector, &context->device));
  }
  if (context->device) {
    snprintf(context->device_name, sizeof context->device_name, "%s", stratus_device_label(context->device));
  }
  return STRATUS_OK;
}
