/* SPDX-License-Identifier: BSD-3-Clause
 * OpenCL's errors: their names, their statuses, and the injection of errors by tests. */
#include "device_state.h"

const char* stratus_device_error_name(int error)
{
  /* clang-format off */
  static const struct {
    int code;
    const char* name;
  } names[] = {
#define NAME(code) { code, #code }
    NAME(CL_SUCCESS), NAME(CL_DEVICE_NOT_FOUND), NAME(CL_DEVICE_NOT_AVAILABLE), NAME(CL_COMPILER_NOT_AVAILABLE),
    NAME(CL_MEM_OBJECT_ALLOCATION_FAILURE), NAME(CL_OUT_OF_RESOURCES), NAME(CL_OUT_OF_HOST_MEMORY), NAME(CL_PROFILING_INFO_NOT_AVAILABLE),
    NAME(CL_MEM_COPY_OVERLAP), NAME(CL_IMAGE_FORMAT_MISMATCH), NAME(CL_IMAGE_FORMAT_NOT_SUPPORTED), NAME(CL_BUILD_PROGRAM_FAILURE),
    NAME(CL_MAP_FAILURE), NAME(CL_MISALIGNED_SUB_BUFFER_OFFSET), NAME(CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST),
    NAME(CL_COMPILE_PROGRAM_FAILURE), NAME(CL_LINKER_NOT_AVAILABLE), NAME(CL_LINK_PROGRAM_FAILURE), NAME(CL_DEVICE_PARTITION_FAILED),
    NAME(CL_KERNEL_ARG_INFO_NOT_AVAILABLE), NAME(CL_INVALID_VALUE), NAME(CL_INVALID_DEVICE_TYPE), NAME(CL_INVALID_PLATFORM),
    NAME(CL_INVALID_DEVICE), NAME(CL_INVALID_CONTEXT), NAME(CL_INVALID_QUEUE_PROPERTIES), NAME(CL_INVALID_COMMAND_QUEUE),
    NAME(CL_INVALID_HOST_PTR), NAME(CL_INVALID_MEM_OBJECT), NAME(CL_INVALID_IMAGE_FORMAT_DESCRIPTOR), NAME(CL_INVALID_IMAGE_SIZE),
    NAME(CL_INVALID_SAMPLER), NAME(CL_INVALID_BINARY), NAME(CL_INVALID_BUILD_OPTIONS), NAME(CL_INVALID_PROGRAM),
    NAME(CL_INVALID_PROGRAM_EXECUTABLE), NAME(CL_INVALID_KERNEL_NAME), NAME(CL_INVALID_KERNEL_DEFINITION), NAME(CL_INVALID_KERNEL),
    NAME(CL_INVALID_ARG_INDEX), NAME(CL_INVALID_ARG_VALUE), NAME(CL_INVALID_ARG_SIZE), NAME(CL_INVALID_KERNEL_ARGS),
    NAME(CL_INVALID_WORK_DIMENSION), NAME(CL_INVALID_WORK_GROUP_SIZE), NAME(CL_INVALID_WORK_ITEM_SIZE), NAME(CL_INVALID_GLOBAL_OFFSET),
    NAME(CL_INVALID_EVENT_WAIT_LIST), NAME(CL_INVALID_EVENT), NAME(CL_INVALID_OPERATION), NAME(CL_INVALID_GL_OBJECT),
    NAME(CL_INVALID_BUFFER_SIZE), NAME(CL_INVALID_MIP_LEVEL), NAME(CL_INVALID_GLOBAL_WORK_SIZE), NAME(CL_INVALID_PROPERTY),
    NAME(CL_INVALID_IMAGE_DESCRIPTOR), NAME(CL_INVALID_COMPILER_OPTIONS), NAME(CL_INVALID_LINKER_OPTIONS),
    NAME(CL_INVALID_DEVICE_PARTITION_COUNT), { -1001, "CL_PLATFORM_NOT_FOUND_KHR" },
#undef NAME
  };
  /* clang-format on */
  for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
    if (names[i].code == error) {
      return names[i].name;
    }
  }
  return "unknown OpenCL error";
}

stratus_status stratus_device_check(stratus_context* context, stratus_device* device, const char* call, cl_int error)
{
  if (error == CL_SUCCESS) {
    return STRATUS_OK;
  }
  if (device->queue) {
    clFinish(device->queue); /* the caller will release memory that launched kernels may still borrow */
    device->running = false;
  }
  const bool memory = error == CL_OUT_OF_RESOURCES || error == CL_MEM_OBJECT_ALLOCATION_FAILURE || error == CL_OUT_OF_HOST_MEMORY;
  device->failure = memory ? STRATUS_OUT_OF_MEMORY : STRATUS_DEVICE_ERROR;
  return stratus_fail(context, device->failure, "%s failed on %s: %s (%d)", call, device->label, stratus_device_error_name(error), error);
}

bool stratus_device_hands_back(stratus_context* context, stratus_status status)
{
  stratus_device* const device = context->device;
  if (status == STRATUS_OK || device->failure != status || (status == STRATUS_DEVICE_ERROR && device->named)) {
    return false;
  }
  device->failure = STRATUS_OK;
  ++context->report.returned;
  stratus_log(context, STRATUS_LOG_WARNING, "done on the host: %s", context->message);
  context->message[0] = '\0';
  return true;
}

cl_int stratus_device_next_error(stratus_device* device)
{
  if (device->calls_left < 0) {
    return CL_SUCCESS;
  }
  if (device->calls_left == 0) {
    return device->injected;
  }
  --device->calls_left;
  return CL_SUCCESS;
}

void stratus_device_fail_after(stratus_device* device, int64_t calls, int error)
{
  device->calls_left = calls;
  device->injected = error;
}
