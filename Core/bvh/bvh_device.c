/* SPDX-License-Identifier: BSD-3-Clause
 * Morton codes and the hierarchy over them on the context's OpenCL device: buffers for the kernels in morton.cl, and their launches. */
#include "bvh_build.h"
#include "device.h"

bool stratus_device_takes_boxes(const stratus_context* context, uint32_t count)
{
  return stratus_device_builds(context) && count <= stratus_device_largest_allocation(context->device) / sizeof(stratus_box);
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
  const stratus_kernel_argument arguments[] = { ARGUMENT(input), ARGUMENT(items), ARGUMENT(least[0]), ARGUMENT(least[1]),
    ARGUMENT(least[2]), ARGUMENT(bits), ARGUMENT(output) };
  TRY_CLEANUP(stratus_device_launch(context, "morton", "", "codes", arguments, COUNT_OF(arguments), (const int64_t[]){ count, 1, 1 }));
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
  const stratus_kernel_argument arguments[] = { ARGUMENT(input), ARGUMENT(items), ARGUMENT(output) };
  const int64_t pair_count[3] = { (int64_t)count - 1, 1, 1 };
  TRY_CLEANUP(stratus_device_launch(context, "morton", "", "hierarchy", arguments, COUNT_OF(arguments), pair_count));
  TRY_CLEANUP(stratus_device_read(context, output, 0, bytes, pairs));

cleanup:
  stratus_device_buffer_release(input);
  stratus_device_buffer_release(output);
  return status;
}
