/* SPDX-License-Identifier: BSD-3-Clause
 * Morton codes and the hierarchy over them on the context's OpenCL device: buffers and launches of kernels/morton.cl. */
#include "bvh.h"
#include "device.h"
#include "structures_device.h"

#define GROUP 64

typedef struct argument {
  size_t size;
  const void* value;
} argument;

static stratus_status run_kernel(stratus_context* context, const char* name, const argument* arguments, unsigned count, size_t items)
{
  cl_kernel kernel;
  const size_t local = GROUP, global = (items + GROUP - 1) / GROUP * GROUP;
  TRY(stratus_device_kernel(context, "morton", "", name, &kernel));
  for (unsigned i = 0; i < count; i++) {
    TRY(stratus_device_argument(context, kernel, i, arguments[i].size, arguments[i].value));
  }
  return stratus_device_run(context, kernel, 1, &global, &local);
}

bool stratus_device_takes_boxes(const stratus_context* context, uint32_t count)
{
  return stratus_structures_on_device(context) && count <= stratus_device_largest_allocation(context->device) / sizeof(stratus_box);
}

stratus_status stratus_device_morton_codes(
  stratus_context* context, const stratus_box* boxes, uint32_t count, const int32_t least[3], int shift, uint64_t* codes)
{
  stratus_status status = STRATUS_OK;
  cl_mem input = NULL, output = NULL;
  const cl_int bits = shift;
  const cl_uint items = count;

  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_READ_ONLY, (size_t)count * sizeof *boxes, boxes, true, &input));
  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_WRITE_ONLY, (size_t)count * sizeof *codes, NULL, false, &output));
  const argument arguments[] = { { sizeof(cl_mem), &input }, { sizeof items, &items }, { sizeof(cl_int), least },
    { sizeof(cl_int), least + 1 }, { sizeof(cl_int), least + 2 }, { sizeof bits, &bits }, { sizeof(cl_mem), &output } };
  TRY_CLEANUP(run_kernel(context, "codes", arguments, sizeof arguments / sizeof *arguments, count));
  TRY_CLEANUP(stratus_device_read(context, output, 0, (size_t)count * sizeof *codes, codes));

cleanup:
  stratus_device_buffer_release(input);
  stratus_device_buffer_release(output);
  return status;
}

stratus_status stratus_device_morton_hierarchy(stratus_context* context, const uint64_t* codes, uint32_t count, stratus_bvh_pair* pairs)
{
  stratus_status status = STRATUS_OK;
  cl_mem input = NULL, output = NULL;
  const cl_uint items = count;
  const size_t bytes = (size_t)(count - 1) * sizeof *pairs;

  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_READ_ONLY, (size_t)count * sizeof *codes, codes, true, &input));
  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_WRITE_ONLY, bytes, NULL, false, &output));
  const argument arguments[] = { { sizeof(cl_mem), &input }, { sizeof items, &items }, { sizeof(cl_mem), &output } };
  TRY_CLEANUP(run_kernel(context, "hierarchy", arguments, sizeof arguments / sizeof *arguments, count - 1));
  TRY_CLEANUP(stratus_device_read(context, output, 0, bytes, pairs));

cleanup:
  stratus_device_buffer_release(input);
  stratus_device_buffer_release(output);
  return status;
}
