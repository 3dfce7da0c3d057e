/* SPDX-License-Identifier: BSD-3-Clause
 * Programs and kernels of an OpenCL device, built or loaded from disk once for each source and set of defines, and their launches. */
#include "device_state.h"
#include "program_cache.h"

#include <stdio.h>
#include <string.h>

/* Leaves the build log in the message, from its first error on: a log may be far longer than the message. */
static stratus_status build_failed(stratus_context* context, stratus_device* device, cl_program program, const char* what, cl_int error)
{
  size_t size = 0;
  void* memory = NULL;
  const char* log = "no build log";
  if (clGetProgramBuildInfo(program, device->id, CL_PROGRAM_BUILD_LOG, 0, NULL, &size) == CL_SUCCESS &&
    stratus_allocate_zero(context, size + 1, 1, &memory) == STRATUS_OK &&
    clGetProgramBuildInfo(program, device->id, CL_PROGRAM_BUILD_LOG, size, memory, NULL) == CL_SUCCESS && *(const char*)memory) {
    log = memory;
    const char* found = strstr(log, "error:");
    while (found && found > log && found[-1] != '\n') {
      --found;
    }
    log = found ? found : log;
  }
  const stratus_status status = stratus_fail(context, STRATUS_DEVICE_ERROR, "building the kernels of %s for %s failed: %s (%d): %s", what,
    device->label, stratus_device_error_name(error), error, log);
  stratus_release(context, memory);
  return status;
}

static cl_int build(const stratus_device* device, cl_program program, const char* options)
{
  stratus_device_enter();
  const cl_int error = clBuildProgram(program, 1, &device->id, options, NULL, NULL);
  stratus_device_leave();
  return error;
}

static stratus_status compile(
  stratus_context* context, stratus_device* device, const char* source, const char* text, const char* options, cl_program* program)
{
  stratus_status status;
  cl_int error = stratus_device_next_error(device);
  if (error == CL_SUCCESS) {
    *program = clCreateProgramWithSource(device->context, 1, &text, NULL, &error);
  }
  TRY(stratus_device_check(context, device, "clCreateProgramWithSource", error));
  error = stratus_device_next_error(device);
  if (error == CL_SUCCESS) {
    error = build(device, *program, options);
  }
  if (error == CL_BUILD_PROGRAM_FAILURE || error == CL_INVALID_BUILD_OPTIONS) {
    status = build_failed(context, device, *program, source, error);
  } else {
    status = stratus_device_check(context, device, "clBuildProgram", error);
  }
  if (status != STRATUS_OK) {
    clReleaseProgram(*program);
    *program = NULL;
  }
  return status;
}

/* Makes the program of the binary that is stored for the key. NULL where there is none, or where OpenCL refuses it. */
static stratus_status load(stratus_context* context, stratus_device* device, const char* key, const char* options, cl_program* program)
{
  void* binary;
  size_t size = 0;
  *program = NULL;
  TRY(stratus_program_read(context, key, &binary, &size));
  if (!binary) {
    return STRATUS_OK;
  }
  const unsigned char* bytes = binary;
  cl_int answer = CL_SUCCESS, error = stratus_device_next_error(device);
  if (error == CL_SUCCESS) {
    *program = clCreateProgramWithBinary(device->context, 1, &device->id, &size, &bytes, &answer, &error);
  }
  if (error == CL_SUCCESS && answer == CL_SUCCESS) {
    error = stratus_device_next_error(device);
    if (error == CL_SUCCESS) {
      error = build(device, *program, options);
    }
  }
  if (*program && (error != CL_SUCCESS || answer != CL_SUCCESS)) {
    clReleaseProgram(*program);
    *program = NULL;
  }
  stratus_release(context, binary);
  return STRATUS_OK;
}

/* Stores the program's binary for the key. A device that does not give it is no failure. */
static stratus_status store(stratus_context* context, const char* key, cl_program program)
{
  cl_uint devices = 0;
  size_t size = 0;
  void* binary = NULL;
  if (!*context->program_folder || clGetProgramInfo(program, CL_PROGRAM_NUM_DEVICES, sizeof devices, &devices, NULL) != CL_SUCCESS ||
    devices != 1 || clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, NULL) != CL_SUCCESS || size == 0) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(context, size, 1, &binary));
  unsigned char* bytes = binary;
  if (clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof bytes, &bytes, NULL) == CL_SUCCESS) {
    stratus_program_write(context, key, binary, size);
  }
  stratus_release(context, binary);
  return STRATUS_OK;
}

static stratus_status make_program(
  stratus_context* context, stratus_device* device, const char* source, const char* text, const char* defines, cached_program* program)
{
  stratus_program_statistics* done = &context->programs;
  char key[STRATUS_PROGRAM_KEY];
  void* memory = NULL;
  const size_t options_size = strlen(defines) + 32;
  TRY(stratus_allocate(context, options_size, 1, &memory));
  char* options = memory;
  /* No relaxed mathematics: the device must round as the host does. */
  snprintf(options, options_size, "-cl-std=CL1.2 %s", defines);

  const double start = stratus_now_ms();
  const bool kept = *context->program_folder && stratus_program_key(device->id, text, options, key);
  stratus_status status = kept ? load(context, device, key, options, &program->program) : STRATUS_OK;
  if (status == STRATUS_OK && program->program) {
    const double ms = stratus_now_ms() - start;
    ++done->loaded;
    done->load_ms += ms;
    stratus_log(context, STRATUS_LOG_DEBUG, "loaded %s %s for %s in %.0f ms", source, defines, device->label, ms);
  } else if (status == STRATUS_OK) {
    status = compile(context, device, source, text, options, &program->program);
    if (status == STRATUS_OK && kept) {
      status = store(context, key, program->program);
    }
    if (status == STRATUS_OK) {
      const double ms = stratus_now_ms() - start;
      ++done->built;
      done->build_ms += ms;
      stratus_log(context, STRATUS_LOG_DEBUG, "built %s %s for %s in %.0f ms", source, defines, device->label, ms);
    } else if (program->program) {
      clReleaseProgram(program->program);
    }
  }
  stratus_release(context, memory);
  return status;
}

static stratus_status find_program(
  stratus_context* context, stratus_device* device, const char* source, const char* text, const char* defines, cached_program** result)
{
  for (cached_program* p = device->programs; p; p = p->next) {
    if (strcmp(p->name, source) == 0 && (!defines || strcmp(p->defines, defines) == 0)) {
      *result = p;
      return STRATUS_OK;
    }
  }
  void* memory = NULL;
  defines = defines ? defines : "";
  const size_t name_size = strlen(source) + 1;
  const size_t defines_size = strlen(defines) + 1;
  TRY(stratus_allocate_zero(context, sizeof(cached_program) + name_size + defines_size, 1, &memory));
  cached_program* program = memory;
  memcpy(program->name, source, name_size);
  memcpy(program->name + name_size, defines, defines_size);
  program->defines = program->name + name_size;
  const stratus_status status = make_program(context, device, source, text, defines, program);
  if (status != STRATUS_OK) {
    stratus_release(context, program);
    return status;
  }
  program->next = device->programs;
  device->programs = program;
  *result = program;
  return STRATUS_OK;
}

stratus_status stratus_device_kernel_from(
  stratus_context* context, const char* source, const char* text, const char* defines, const char* kernel, cl_kernel* result)
{
  stratus_device* device = context->device;
  cached_program* program = NULL;
  TRY(find_program(context, device, source, text, defines, &program));
  for (const cached_kernel* k = device->kernels; k; k = k->next) {
    if (k->program == program && strcmp(k->name, kernel) == 0) {
      *result = k->kernel;
      return STRATUS_OK;
    }
  }
  void* memory = NULL;
  const size_t name_size = strlen(kernel) + 1;
  TRY(stratus_allocate_zero(context, sizeof(cached_kernel) + name_size, 1, &memory));
  cached_kernel* entry = memory;
  cl_int error = stratus_device_next_error(device);
  if (error == CL_SUCCESS) {
    entry->kernel = clCreateKernel(program->program, kernel, &error);
  }
  if (error != CL_SUCCESS) {
    stratus_release(context, entry);
    return stratus_device_check(context, device, "clCreateKernel", error);
  }
  memcpy(entry->name, kernel, name_size);
  entry->program = program;
  entry->next = device->kernels;
  device->kernels = entry;
  *result = entry->kernel;
  return STRATUS_OK;
}

stratus_status stratus_device_kernel(
  stratus_context* context, const char* source, const char* defines, const char* kernel, cl_kernel* result)
{
  const char* text = stratus_kernel_source(source);
  if (!text) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "no kernel source is named \"%s\"", source);
  }
  return stratus_device_kernel_from(context, source, text, defines, kernel, result);
}

void stratus_device_programs_release(stratus_device* device)
{
  while (device->kernels) {
    cached_kernel* kernel = device->kernels;
    device->kernels = kernel->next;
    clReleaseKernel(kernel->kernel);
    stratus_release(device->owner, kernel);
  }
  while (device->programs) {
    cached_program* program = device->programs;
    device->programs = program->next;
    clReleaseProgram(program->program);
    stratus_release(device->owner, program);
  }
}

/* ---------------------------------------------------------------- launches */

stratus_status stratus_device_argument(stratus_context* context, cl_kernel kernel, unsigned index, size_t size, const void* value)
{
  return CALL(context, context->device, "clSetKernelArg", clSetKernelArg(kernel, index, size, value));
}

stratus_status stratus_device_run(
  stratus_context* context, cl_kernel kernel, unsigned dimensions, const size_t* global, const size_t* local)
{
  stratus_device* device = context->device;
  size_t rounded[3] = { 1, 1, 1 };
  for (unsigned d = 0; d < dimensions && d < 3; ++d) {
    rounded[d] = (global[d] + local[d] - 1) / local[d] * local[d];
  }
  TRY(CALL(context, device, "clEnqueueNDRangeKernel",
    clEnqueueNDRangeKernel(device->queue, kernel, dimensions, NULL, rounded, local, 0, NULL, NULL)));
  device->running = true;
  ++context->report.launched;
  return STRATUS_OK;
}

/* Finds a kernel and sets its arguments. */
static stratus_status prepare_kernel(stratus_context* context, const char* source, const char* defines, const char* name,
  const stratus_kernel_argument* arguments, size_t count, cl_kernel* kernel)
{
  TRY(stratus_device_kernel(context, source, defines, name, kernel));
  for (size_t i = 0; i < count; ++i) {
    TRY(stratus_device_argument(context, *kernel, (unsigned)i, arguments[i].size, arguments[i].value));
  }
  return STRATUS_OK;
}

stratus_status stratus_device_launch_groups(stratus_context* context, const char* source, const char* defines, const char* name,
  const stratus_kernel_argument* arguments, size_t count, size_t groups, size_t group)
{
  const size_t items = groups * group;
  cl_kernel kernel;
  TRY(prepare_kernel(context, source, defines, name, arguments, count, &kernel));
  return stratus_device_run(context, kernel, 1, &items, &group);
}

stratus_status stratus_device_launch(stratus_context* context, const char* source, const char* defines, const char* name,
  const stratus_kernel_argument* arguments, size_t count, const int64_t items[3])
{
  cl_kernel kernel;
  TRY(prepare_kernel(context, source, defines, name, arguments, count, &kernel));
  const size_t local[3] = { STRATUS_DEVICE_GROUP, 1, 1 };
  const size_t global[3] = { (size_t)items[0], (size_t)items[1], (size_t)items[2] };
  return stratus_device_run(context, kernel, 3, global, local);
}

stratus_status stratus_device_finish(stratus_context* context)
{
  stratus_device* device = context->device;
  TRY(CALL(context, device, "clFinish", clFinish(device->queue)));
  device->running = false;
  return STRATUS_OK;
}

void stratus_device_drain(const stratus_context* context)
{
  stratus_device* device = context->device;
  if (device->running) {
    (void)clFinish(device->queue);
    device->running = false;
  }
}
