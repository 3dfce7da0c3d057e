/* SPDX-License-Identifier: BSD-3-Clause
 * OpenCL 1.2: choice of a device, and buffers. Calls that release are never refused, so that everything can be freed after a device is
 * lost. */
#define _POSIX_C_SOURCE 200809L
#include "device_state.h"

#include "device.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PLATFORMS_MAX 16
/* Alignment that malloc() guarantees: enough for the scalar loads of kernels. A host pointer of less is copied. */
#define BORROW_ALIGNMENT 16

typedef struct device_list {
  int count;
  const char* call; /* the last call that found nothing, and its error */
  cl_int error;
  cl_device_id ids[STRATUS_DEVICES_MAX];
} device_list;

/* ---------------------------------------------------------------- errors */

/* ---------------------------------------------------------------- choice */

static device_list find_devices(void)
{
  device_list list = { .call = "clGetPlatformIDs" };
  cl_platform_id platforms[PLATFORMS_MAX];
  cl_uint platform_count = 0;
  list.error = clGetPlatformIDs(PLATFORMS_MAX, platforms, &platform_count);
  if (list.error != CL_SUCCESS) {
    return list;
  }
  for (cl_uint p = 0; p < platform_count && p < PLATFORMS_MAX && list.count < STRATUS_DEVICES_MAX; ++p) {
    const cl_uint space = (cl_uint)(STRATUS_DEVICES_MAX - list.count);
    cl_uint found = 0;
    /* A platform without devices is not an error: other platforms may have some. */
    const cl_int error = clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, space, list.ids + list.count, &found);
    if (error == CL_SUCCESS) {
      list.count += (int)(found < space ? found : space);
    } else {
      list.call = "clGetDeviceIDs";
      list.error = error;
    }
  }
  return list;
}

static device_list list_devices(void)
{
  stratus_device_enter();
  const device_list list = find_devices();
  stratus_device_leave();
  return list;
}

static void device_name(cl_device_id id, char* name, size_t capacity)
{
  char whole[1024] = "";
  if (clGetDeviceInfo(id, CL_DEVICE_NAME, sizeof whole - 1, whole, NULL) != CL_SUCCESS) {
    snprintf(whole, sizeof whole, "unnamed device");
  }
  const char* start = whole;
  while (isspace((unsigned char)*start)) {
    ++start;
  }
  size_t length = strlen(start);
  while (length && isspace((unsigned char)start[length - 1])) {
    --length;
  }
  snprintf(name, capacity, "%.*s", (int)length, start);
}

int stratus_device_count(void)
{
  return list_devices().count;
}

stratus_status stratus_device_name(int index, char* name, size_t capacity)
{
  if (!name || !capacity) {
    return STRATUS_INVALID_ARGUMENT;
  }
  const device_list list = list_devices();
  if (index < 0 || index >= list.count) {
    return STRATUS_NO_DEVICE;
  }
  device_name(list.ids[index], name, capacity);
  return STRATUS_OK;
}

static bool contains(const char* text, const char* part)
{
  for (; *text; ++text) {
    size_t i = 0;
    while (part[i] && tolower((unsigned char)text[i]) == tolower((unsigned char)part[i])) {
      ++i;
    }
    if (!part[i]) {
      return true;
    }
  }
  return false;
}

/* A GPU that is also a CPU is none: a simulator may report every type at once. */
static bool is_candidate(cl_device_id id, bool processors)
{
  cl_device_type type = 0;
  return clGetDeviceInfo(id, CL_DEVICE_TYPE, sizeof type, &type, NULL) == CL_SUCCESS &&
    (type & CL_DEVICE_TYPE_CPU ? processors : (type & CL_DEVICE_TYPE_GPU) != 0);
}

int stratus_device_candidates(bool processors, cl_device_id ids[STRATUS_DEVICES_MAX])
{
  const device_list list = list_devices();
  int count = 0;
  for (int i = 0; i < list.count; ++i) {
    if (is_candidate(list.ids[i], processors)) {
      ids[count] = list.ids[i];
      ++count;
    }
  }
  return count;
}

void stratus_device_describe(cl_device_id id, char* text, size_t capacity)
{
  char name[192], driver[128] = "";
  device_name(id, name, sizeof name);
  if (clGetDeviceInfo(id, CL_DRIVER_VERSION, sizeof driver - 1, driver, NULL) != CL_SUCCESS) {
    snprintf(driver, sizeof driver, "unknown");
  }
  snprintf(text, capacity, "%s, driver %s", name, driver);
}

/* Returns the index of the device that the selector names, -1 if there is none. */
static int select_device(const device_list* list, const char* selector)
{
  if (selector[strspn(selector, "0123456789")] == '\0') {
    const unsigned long index = strtoul(selector, NULL, 10);
    return index < (unsigned long)list->count ? (int)index : -1;
  }
  for (int i = 0; i < list->count; ++i) {
    char name[192];
    device_name(list->ids[i], name, sizeof name);
    if (contains(name, selector)) {
      return i;
    }
  }
  return -1;
}

static stratus_status no_such_device(stratus_context* context, const device_list* list, const char* selector)
{
  char text[768] = "";
  size_t used = 0;
  for (int i = 0; i < list->count && used < sizeof text - 1; ++i) {
    char name[192];
    device_name(list->ids[i], name, sizeof name);
    const int written = snprintf(text + used, sizeof text - used, "%s%d \"%s\"", i ? ", " : "", i, name);
    used += written > 0 ? (size_t)written : 0;
  }
  if (!list->count) {
    snprintf(text, sizeof text, "none (%s: %s)", list->call, stratus_device_error_name(list->error));
  }
  return stratus_fail(context, STRATUS_NO_DEVICE, "no OpenCL device \"%.100s\"; there are: %s", selector, text);
}

static stratus_status query(
  stratus_context* context, stratus_device* device, cl_device_info what, const char* name, size_t size, void* value)
{
  return stratus_device_check(context, device, name, clGetDeviceInfo(device->id, what, size, value, NULL));
}

static stratus_status describe(stratus_context* context, stratus_device* device)
{
  cl_device_type type = 0;
  cl_ulong largest = 0;
  cl_bool unified = CL_FALSE;
  cl_uint align_bits = 0;
  cl_device_fp_config doubles = 0;
  TRY(query(context, device, CL_DEVICE_TYPE, "clGetDeviceInfo(CL_DEVICE_TYPE)", sizeof type, &type));
  TRY(query(context, device, CL_DEVICE_MAX_MEM_ALLOC_SIZE, "clGetDeviceInfo(CL_DEVICE_MAX_MEM_ALLOC_SIZE)", sizeof largest, &largest));
  TRY(query(context, device, CL_DEVICE_HOST_UNIFIED_MEMORY, "clGetDeviceInfo(CL_DEVICE_HOST_UNIFIED_MEMORY)", sizeof unified, &unified));
  TRY(query(
    context, device, CL_DEVICE_MEM_BASE_ADDR_ALIGN, "clGetDeviceInfo(CL_DEVICE_MEM_BASE_ADDR_ALIGN)", sizeof align_bits, &align_bits));
  /* Devices without doubles may not know this question instead of answering 0. Any other error is one: a lost device has no answer. */
  const cl_int error = clGetDeviceInfo(device->id, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof doubles, &doubles, NULL);
  if (error == CL_INVALID_VALUE) {
    doubles = 0;
  } else {
    TRY(stratus_device_check(context, device, "clGetDeviceInfo(CL_DEVICE_DOUBLE_FP_CONFIG)", error));
  }
  device->is_cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
  device->has_double = doubles != 0;
  device->builds = !device->is_cpu;
  device->shares_memory = device->is_cpu || unified;
  device->borrow_alignment = device->is_cpu || align_bits / 8 < BORROW_ALIGNMENT ? BORROW_ALIGNMENT : align_bits / 8;
  device->largest_allocation = largest > SIZE_MAX ? SIZE_MAX : (size_t)largest;
  return STRATUS_OK;
}

stratus_status stratus_device_open_id(stratus_context* context, cl_device_id id, stratus_device** out)
{
  void* memory = NULL;
  *out = NULL;
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_device), &memory));
  stratus_device* device = memory;
  device->owner = context;
  device->id = id;
  device->calls_left = -1;
  device_name(id, device->label, sizeof device->label);

  cl_int error = CL_SUCCESS;
  stratus_status status;
  TRY_CLEANUP(describe(context, device));
  const char* call = "clCreateContext";
  stratus_device_enter();
  device->context = clCreateContext(NULL, 1, &id, NULL, NULL, &error);
  if (error == CL_SUCCESS) {
    call = "clCreateCommandQueue";
    device->queue = clCreateCommandQueue(device->context, id, 0, &error);
  }
  stratus_device_leave();
  TRY_CLEANUP(stratus_device_check(context, device, call, error));
cleanup:
  if (status != STRATUS_OK) {
    stratus_device_close(device);
    return status;
  }
  *out = device;
  return STRATUS_OK;
}

stratus_status stratus_device_open(stratus_context* context, const char* selector, stratus_device** device)
{
  const device_list list = list_devices();
  const int index = select_device(&list, selector);
  *device = NULL;
  if (index < 0) {
    return no_such_device(context, &list, selector);
  }
  TRY(stratus_device_open_id(context, list.ids[index], device));
  (*device)->builds = (*device)->named = true;
  return STRATUS_OK;
}

cl_int stratus_device_close(stratus_device* device)
{
  if (!device) {
    return CL_SUCCESS;
  }
  const cl_int error = device->queue ? clFinish(device->queue) : CL_SUCCESS;
  stratus_device_programs_release(device);
  if (device->queue) {
    clReleaseCommandQueue(device->queue);
  }
  if (device->context) {
    clReleaseContext(device->context);
  }
  stratus_release(device->owner, device);
  return error;
}

const char* stratus_device_label(const stratus_device* device)
{
  return device->label;
}

cl_device_id stratus_device_id(const stratus_device* device)
{
  return device->id;
}

bool stratus_device_is_cpu(const stratus_device* device)
{
  return device->is_cpu;
}

bool stratus_device_has_double(const stratus_device* device)
{
  return device->has_double;
}

size_t stratus_device_largest_allocation(const stratus_device* device)
{
  return device->largest_allocation;
}

/* ---------------------------------------------------------------- buffers */

stratus_status stratus_device_buffer(
  stratus_context* context, cl_mem_flags access, size_t bytes, const void* host, bool borrow, cl_mem* buffer)
{
  stratus_device* device = context->device;
  if (bytes > device->largest_allocation) {
    device->failure = STRATUS_OUT_OF_MEMORY;
    return stratus_fail(context, STRATUS_OUT_OF_MEMORY, "a buffer of %zu bytes exceeds the largest allocation of %s, %zu bytes", bytes,
      device->label, device->largest_allocation);
  }
  const bool in_place = borrow && device->shares_memory && (uintptr_t)host % device->borrow_alignment == 0;
  if (host && bytes) {
    access |= in_place ? CL_MEM_USE_HOST_PTR : CL_MEM_COPY_HOST_PTR;
  } else {
    host = NULL;
  }
  cl_int error = stratus_device_next_error(device);
  cl_mem result = NULL;
  if (error == CL_SUCCESS) {
    result = clCreateBuffer(device->context, access, bytes ? bytes : 1, (void*)(uintptr_t)host, &error);
  }
  TRY(stratus_device_check(context, device, "clCreateBuffer", error));
  *buffer = result;
  return STRATUS_OK;
}

void stratus_device_buffer_release(cl_mem buffer)
{
  if (buffer) {
    clReleaseMemObject(buffer);
  }
}

stratus_status stratus_device_write(stratus_context* context, cl_mem buffer, size_t offset, size_t bytes, const void* host)
{
  stratus_device* device = context->device;
  return bytes == 0 ? STRATUS_OK
                    : CALL(context, device, "clEnqueueWriteBuffer",
                        clEnqueueWriteBuffer(device->queue, buffer, CL_TRUE, offset, bytes, host, 0, NULL, NULL));
}

stratus_status stratus_device_read(stratus_context* context, cl_mem buffer, size_t offset, size_t bytes, void* host)
{
  stratus_device* device = context->device;
  if (bytes == 0) {
    return STRATUS_OK;
  }
  TRY(
    CALL(context, device, "clEnqueueReadBuffer", clEnqueueReadBuffer(device->queue, buffer, CL_TRUE, offset, bytes, host, 0, NULL, NULL)));
  device->running = false;
  return STRATUS_OK;
}

bool stratus_device_lends(const stratus_device* device, const void* host)
{
  return device->is_cpu && (uintptr_t)host % device->borrow_alignment == 0;
}

stratus_status stratus_device_settle(stratus_context* context, cl_mem buffer, size_t bytes)
{
  stratus_device* device = context->device;
  cl_int error = stratus_device_next_error(device);
  void* mapped = NULL;
  if (error == CL_SUCCESS) {
    mapped = clEnqueueMapBuffer(device->queue, buffer, CL_TRUE, CL_MAP_READ, 0, bytes, 0, NULL, NULL, &error);
  }
  TRY(stratus_device_check(context, device, "clEnqueueMapBuffer", error));
  device->running = false;
  return CALL(context, device, "clEnqueueUnmapMemObject", clEnqueueUnmapMemObject(device->queue, buffer, mapped, 0, NULL, NULL));
}

bool stratus_device_builds(const stratus_context* context)
{
  return context->device && context->device->builds;
}
