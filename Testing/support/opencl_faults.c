/* SPDX-License-Identifier: BSD-3-Clause
 * An OpenCL layer that counts calls, makes chosen ones fail, and holds references to account. The loader loads it by the variable
 * OPENCL_LAYERS. Handles are the platform's own: only the table of functions is replaced. */
#include "opencl_faults.h"

#include <CL/cl_layer.h>
#include <pthread.h>
#include <stdbool.h>
#include <string.h>

__attribute__((visibility("default"))) opencl_faults stratus_opencl_faults = { .at = -1 };

static opencl_faults* const faults = &stratus_opencl_faults;
static cl_icd_dispatch next, table;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

#include "opencl_held.h"

/* ---- faults */

typedef enum call_kind { CALL_ASKS, CALL_ENQUEUES, CALL_WAITS } call_kind;

/* Counts the call. Returns its error, CL_SUCCESS if the platform is to do it. *lost: the device runs nothing any more. */
static cl_int count_call(const char* name, call_kind kind, bool* lost)
{
  cl_int error = CL_SUCCESS;
  pthread_mutex_lock(&lock);
  const int64_t number = faults->calls;
  if (number < OPENCL_TRACE_MAX) {
    faults->trace[number] = name;
  }
  ++faults->calls;
  if (faults->at < 0 && faults->at_first && strcmp(name, faults->at_first) == 0) {
    faults->at = number;
  }
  *lost = faults->at >= 0 && number >= faults->at;
  if (*lost &&
    (faults->fault == OPENCL_FAULT_ALL || (faults->fault == OPENCL_FAULT_ONCE && number == faults->at) ||
      (faults->fault == OPENCL_FAULT_VANISH && kind == CALL_WAITS))) {
    error = faults->error;
  }
  *lost &= faults->fault == OPENCL_FAULT_VANISH;
  if (error != CL_SUCCESS && faults->first < 0) {
    faults->first = number;
  }
  faults->refused += error != CL_SUCCESS || (*lost && kind == CALL_ENQUEUES);
  if (error == CL_SUCCESS && !*lost) {
    faults->pending = kind == CALL_WAITS ? 0 : faults->pending + (kind == CALL_ENQUEUES);
  }
  pthread_mutex_unlock(&lock);
  return error;
}

static cl_int after_release(cl_int error)
{
  return faults->at >= 0 && faults->calls > faults->at && faults->fault != OPENCL_FAULT_ONCE ? faults->error : error;
}

/* Every function begins with it; `failed` is the result of a refused call. */
#define COUNT(kind, failed)                                                                                                                \
  bool lost;                                                                                                                               \
  const cl_int error = count_call(__func__ + 6, kind, &lost); /* behind "layer_" */                                                        \
  if (error != CL_SUCCESS) {                                                                                                               \
    failed;                                                                                                                                \
  }                                                                                                                                        \
  (void)lost
#define HELD(handle, error)                                                                                                                \
  if (!is_held(__func__ + 6, handle)) {                                                                                                    \
    return error;                                                                                                                          \
  }
#define REFUSE_OBJECT                                                                                                                      \
  {                                                                                                                                        \
    if (result) {                                                                                                                          \
      *result = error;                                                                                                                     \
    }                                                                                                                                      \
    return NULL;                                                                                                                           \
  }

static cl_int layer_clGetPlatformIDs(cl_uint room, cl_platform_id* ids, cl_uint* count)
{
  COUNT(CALL_ASKS, return error);
  return next.clGetPlatformIDs(room, ids, count);
}

static cl_int layer_clGetDeviceIDs(cl_platform_id platform, cl_device_type type, cl_uint room, cl_device_id* ids, cl_uint* count)
{
  COUNT(CALL_ASKS, return error);
  return next.clGetDeviceIDs(platform, type, room, ids, count);
}

static cl_int layer_clGetDeviceInfo(cl_device_id id, cl_device_info what, size_t size, void* value, size_t* needed)
{
  COUNT(CALL_ASKS, return error);
  return next.clGetDeviceInfo(id, what, size, value, needed);
}

static cl_context layer_clCreateContext(const cl_context_properties* properties, cl_uint count, const cl_device_id* ids,
  void (*notify)(const char*, const void*, size_t, void*), void* user, cl_int* result)
{
  COUNT(CALL_ASKS, REFUSE_OBJECT);
  cl_context context = next.clCreateContext(properties, count, ids, notify, user, result);
  hold(context);
  return context;
}

static cl_command_queue layer_clCreateCommandQueue(
  cl_context context, cl_device_id id, cl_command_queue_properties properties, cl_int* result)
{
  COUNT(CALL_ASKS, REFUSE_OBJECT);
  cl_command_queue queue = next.clCreateCommandQueue(context, id, properties, result);
  hold(queue);
  return queue;
}

static cl_mem layer_clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* result)
{
  COUNT(CALL_ASKS, REFUSE_OBJECT);
  cl_mem memory = next.clCreateBuffer(context, flags, size, host, result);
  hold(memory);
  return memory;
}

static cl_program layer_clCreateProgramWithSource(
  cl_context context, cl_uint count, const char** texts, const size_t* lengths, cl_int* result)
{
  COUNT(CALL_ASKS, REFUSE_OBJECT);
  cl_program program = next.clCreateProgramWithSource(context, count, texts, lengths, result);
  hold(program);
  return program;
}

static cl_program layer_clCreateProgramWithBinary(cl_context context, cl_uint count, const cl_device_id* ids, const size_t* lengths,
  const unsigned char** binaries, cl_int* statuses, cl_int* result)
{
  COUNT(CALL_ASKS, REFUSE_OBJECT);
  cl_program program = next.clCreateProgramWithBinary(context, count, ids, lengths, binaries, statuses, result);
  hold(program);
  return program;
}

static cl_int layer_clBuildProgram(
  cl_program program, cl_uint count, const cl_device_id* ids, const char* options, void (*notify)(cl_program, void*), void* user)
{
  COUNT(CALL_WAITS, return error);
  HELD(program, CL_INVALID_PROGRAM);
  return next.clBuildProgram(program, count, ids, options, notify, user);
}

static cl_int layer_clGetProgramInfo(cl_program program, cl_program_info what, size_t size, void* value, size_t* needed)
{
  COUNT(CALL_ASKS, return error);
  HELD(program, CL_INVALID_PROGRAM);
  return next.clGetProgramInfo(program, what, size, value, needed);
}

static cl_int layer_clGetProgramBuildInfo(
  cl_program program, cl_device_id id, cl_program_build_info what, size_t size, void* value, size_t* needed)
{
  COUNT(CALL_ASKS, return error);
  HELD(program, CL_INVALID_PROGRAM);
  return next.clGetProgramBuildInfo(program, id, what, size, value, needed);
}

static cl_kernel layer_clCreateKernel(cl_program program, const char* name, cl_int* result)
{
  COUNT(CALL_ASKS, REFUSE_OBJECT);
  cl_kernel kernel = next.clCreateKernel(program, name, result);
  hold(kernel);
  return kernel;
}

static cl_int layer_clSetKernelArg(cl_kernel kernel, cl_uint index, size_t size, const void* value)
{
  COUNT(CALL_ASKS, return error);
  HELD(kernel, CL_INVALID_KERNEL);
  remember_argument(kernel, index, size, value);
  return next.clSetKernelArg(kernel, index, size, value);
}

static cl_int layer_clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
  const size_t* global, const size_t* local, cl_uint events, const cl_event* wait, cl_event* event)
{
  COUNT(CALL_ENQUEUES, return error);
  HELD(kernel, CL_INVALID_KERNEL);
  if (!arguments_are_held(kernel)) {
    return CL_INVALID_KERNEL_ARGS;
  }
  return lost ? CL_SUCCESS : next.clEnqueueNDRangeKernel(queue, kernel, dimensions, offset, global, local, events, wait, event);
}

static cl_int layer_clEnqueueReadBuffer(cl_command_queue queue, cl_mem memory, cl_bool blocking, size_t offset, size_t size, void* host,
  cl_uint events, const cl_event* wait, cl_event* event)
{
  COUNT(blocking ? CALL_WAITS : CALL_ENQUEUES, return error);
  HELD(memory, CL_INVALID_MEM_OBJECT);
  return lost ? CL_SUCCESS : next.clEnqueueReadBuffer(queue, memory, blocking, offset, size, host, events, wait, event);
}

static cl_int layer_clEnqueueWriteBuffer(cl_command_queue queue, cl_mem memory, cl_bool blocking, size_t offset, size_t size,
  const void* host, cl_uint events, const cl_event* wait, cl_event* event)
{
  COUNT(blocking ? CALL_WAITS : CALL_ENQUEUES, return error);
  HELD(memory, CL_INVALID_MEM_OBJECT);
  return lost ? CL_SUCCESS : next.clEnqueueWriteBuffer(queue, memory, blocking, offset, size, host, events, wait, event);
}

static void* layer_clEnqueueMapBuffer(cl_command_queue queue, cl_mem memory, cl_bool blocking, cl_map_flags flags, size_t offset,
  size_t size, cl_uint events, const cl_event* wait, cl_event* event, cl_int* result)
{
  COUNT(CALL_WAITS, REFUSE_OBJECT);
  return next.clEnqueueMapBuffer(queue, memory, blocking, flags, offset, size, events, wait, event, result);
}

static cl_int layer_clEnqueueUnmapMemObject(
  cl_command_queue queue, cl_mem memory, void* mapped, cl_uint events, const cl_event* wait, cl_event* event)
{
  COUNT(CALL_ASKS, return error); /* the core maps for reading only, so that nothing remains to be done */
  HELD(memory, CL_INVALID_MEM_OBJECT);
  return next.clEnqueueUnmapMemObject(queue, memory, mapped, events, wait, event);
}

static cl_int layer_clFinish(cl_command_queue queue)
{
  bool lost;
  const cl_int error = count_call("clFinish", CALL_WAITS, &lost);
  const cl_int done = next.clFinish(queue); /* a device that is gone runs nothing: PoCL must not either, once the call returns */
  pthread_mutex_lock(&lock);
  faults->pending = 0;
  pthread_mutex_unlock(&lock);
  return error != CL_SUCCESS ? error : done;
}

#define RELEASE(Name, type)                                                                                                                \
  static cl_int layer_clRelease##Name(type handle)                                                                                         \
  {                                                                                                                                        \
    return let_go("clRelease" #Name, handle) ? after_release(next.clRelease##Name(handle)) : CL_INVALID_VALUE;                             \
  }                                                                                                                                        \
  static cl_int layer_clRetain##Name(type handle)                                                                                          \
  {                                                                                                                                        \
    HELD(handle, CL_INVALID_VALUE)                                                                                                         \
    hold(handle);                                                                                                                          \
    return next.clRetain##Name(handle);                                                                                                    \
  }
RELEASE(Context, cl_context)
RELEASE(CommandQueue, cl_command_queue)
RELEASE(MemObject, cl_mem)
RELEASE(Program, cl_program)
RELEASE(Kernel, cl_kernel)

/* ---- the loader's interface */

__attribute__((visibility("default"))) cl_int clGetLayerInfo(cl_layer_info what, size_t size, void* value, size_t* needed)
{
  const cl_layer_api_version version = CL_LAYER_API_VERSION_100;
  if (what != CL_LAYER_API_VERSION || (value && size < sizeof version)) {
    return CL_INVALID_VALUE;
  }
  if (value) {
    memcpy(value, &version, sizeof version);
  }
  if (needed) {
    *needed = sizeof version;
  }
  return CL_SUCCESS;
}

__attribute__((visibility("default"))) cl_int clInitLayer(
  cl_uint count, const cl_icd_dispatch* target, cl_uint* layer_count, const cl_icd_dispatch** layer)
{
  if (!target || !layer_count || !layer || count < sizeof next / sizeof(void*)) {
    return CL_INVALID_VALUE;
  }
  next = table = *target;
#define TAKE(name) table.name = layer_##name
#define TAKE_PAIR(name)                                                                                                                    \
  TAKE(clRetain##name);                                                                                                                    \
  TAKE(clRelease##name)
  TAKE(clGetPlatformIDs), TAKE(clGetDeviceIDs), TAKE(clGetDeviceInfo), TAKE(clCreateContext), TAKE(clCreateCommandQueue);
  TAKE(clCreateBuffer), TAKE(clCreateProgramWithSource), TAKE(clCreateProgramWithBinary), TAKE(clBuildProgram), TAKE(clGetProgramInfo);
  TAKE(clGetProgramBuildInfo), TAKE(clCreateKernel), TAKE(clSetKernelArg), TAKE(clEnqueueNDRangeKernel), TAKE(clEnqueueReadBuffer);
  TAKE(clEnqueueWriteBuffer), TAKE(clEnqueueMapBuffer), TAKE(clEnqueueUnmapMemObject), TAKE(clFinish);
  TAKE_PAIR(Context);
  TAKE_PAIR(CommandQueue);
  TAKE_PAIR(MemObject);
  TAKE_PAIR(Program);
  TAKE_PAIR(Kernel);
  *layer_count = (cl_uint)(sizeof table / sizeof(void*));
  *layer = &table;
  return CL_SUCCESS;
}
