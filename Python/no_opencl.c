/* SPDX-License-Identifier: BSD-3-Clause
 * The functions of OpenCL's loader that the core calls, for machines that have no loader: there is no platform, and so no device. The
 * core's library can be loaded then, and the host draws. The package loads this library only where libOpenCL.so.1 is not found. */
#include <stddef.h>

#define NO_PLATFORM (-1001) /* CL_PLATFORM_NOT_FOUND_KHR */
#define API __attribute__((visibility("default")))
#define CODE(name)                                                                                                                         \
  API int name(void);                                                                                                                      \
  int name(void)                                                                                                                           \
  {                                                                                                                                        \
    return NO_PLATFORM;                                                                                                                    \
  }
#define OBJECT(name)                                                                                                                       \
  API void* name(void);                                                                                                                    \
  void* name(void)                                                                                                                         \
  {                                                                                                                                        \
    return NULL;                                                                                                                           \
  }

API int clGetPlatformIDs(unsigned entries, void* platforms, unsigned* count);
int clGetPlatformIDs(unsigned entries, void* platforms, unsigned* count)
{
  (void)entries;
  (void)platforms;
  if (count) {
    *count = 0;
  }
  return NO_PLATFORM;
}

/* Nothing calls these without a platform. */
CODE(clGetPlatformInfo)
CODE(clGetDeviceIDs)
CODE(clGetDeviceInfo)
CODE(clBuildProgram)
CODE(clGetProgramInfo)
CODE(clGetProgramBuildInfo)
CODE(clSetKernelArg)
CODE(clEnqueueNDRangeKernel)
CODE(clEnqueueReadBuffer)
CODE(clEnqueueWriteBuffer)
CODE(clEnqueueUnmapMemObject)
CODE(clFinish)
CODE(clReleaseCommandQueue)
CODE(clReleaseContext)
CODE(clReleaseKernel)
CODE(clReleaseMemObject)
CODE(clReleaseProgram)
OBJECT(clCreateContext)
OBJECT(clCreateCommandQueue)
OBJECT(clCreateBuffer)
OBJECT(clCreateKernel)
OBJECT(clCreateProgramWithSource)
OBJECT(clCreateProgramWithBinary)
OBJECT(clEnqueueMapBuffer)
