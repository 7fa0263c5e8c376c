/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds OpenCL at run time. The platforms are the built-in one, and the ones that the system's
 * loader lists. Without a loader there are no drivers; this is not an error. Every object of an
 * OpenCL driver begins with a table of its functions (extension cl_khr_icd), and so does every
 * object of the built-in device. So an object alone is enough to call a function. */

/* Included without mcor_opencl.h, which renames OpenCL's functions. */
#include "mcor_native.h"
#include "mcor_system.h"

#include <CL/cl_icd.h>

/* The type of clGetPlatformIDs, whose name differs between headers. */
typedef cl_int(CL_API_CALL* mcor_list_platforms)(cl_uint, cl_platform_id*, cl_uint*);

cl_int CL_API_CALL mcor_clGetPlatformIDs(cl_uint room, cl_platform_id* platforms, cl_uint* count);
cl_int CL_API_CALL mcor_clGetPlatformIDs(cl_uint room, cl_platform_id* platforms, cl_uint* count)
{
  cl_uint native = 0, found = 0;
  cl_platform_id own = mcor_native_platform();
  if (own && room > 0)
  {
    platforms[native++] = own;
  }
  const mcor_list_platforms list = (mcor_list_platforms)mcor_system_opencl();
  if (!list || room == native || list(room - native, platforms + native, &found) != CL_SUCCESS)
  {
    found = 0;
  }
  *count = native + (found < room - native ? found : room - native);
  return *count > 0 ? CL_SUCCESS : CL_INVALID_VALUE;
}

static const cl_icd_dispatch* mcor_table(const void* object)
{
  return *(const cl_icd_dispatch* const*)object;
}

/* Defines a function of OpenCL, which calls the function with the same name in the table of
 * `object`, one of its arguments. */
#define FORWARD(result, name, declared, passed, object)                                            \
  result CL_API_CALL mcor_##name declared;                                                         \
  result CL_API_CALL mcor_##name declared                                                          \
  {                                                                                                \
    return mcor_table(object)->name passed;                                                        \
  }

/* One function per line reads best here. */
/* clang-format off */
FORWARD(cl_int, clGetPlatformInfo, (cl_platform_id o, cl_platform_info w, size_t n, void* v, size_t* r), (o, w, n, v, r), o)
FORWARD(cl_int, clGetDeviceIDs, (cl_platform_id o, cl_device_type t, cl_uint n, cl_device_id* d, cl_uint* r), (o, t, n, d, r), o)
FORWARD(cl_int, clGetDeviceInfo, (cl_device_id o, cl_device_info w, size_t n, void* v, size_t* r), (o, w, n, v, r), o)
FORWARD(cl_context, clCreateContext, (const cl_context_properties* p, cl_uint n, const cl_device_id* o, void (CL_CALLBACK* f)(const char*, const void*, size_t, void*), void* u, cl_int* e), (p, n, o, f, u, e), *o)
FORWARD(cl_int, clCreateSubDevices, (cl_device_id o, const cl_device_partition_property* p, cl_uint n, cl_device_id* d, cl_uint* r), (o, p, n, d, r), o)
FORWARD(cl_int, clReleaseDevice, (cl_device_id o), (o), o)
FORWARD(cl_int, clReleaseContext, (cl_context o), (o), o)
FORWARD(cl_command_queue, clCreateCommandQueue, (cl_context o, cl_device_id d, cl_command_queue_properties p, cl_int* e), (o, d, p, e), o)
FORWARD(cl_int, clReleaseCommandQueue, (cl_command_queue o), (o), o)
FORWARD(cl_int, clFinish, (cl_command_queue o), (o), o)
FORWARD(cl_mem, clCreateBuffer, (cl_context o, cl_mem_flags f, size_t n, void* h, cl_int* e), (o, f, n, h, e), o)
FORWARD(cl_int, clReleaseMemObject, (cl_mem o), (o), o)
FORWARD(cl_int, clEnqueueReadBuffer, (cl_command_queue o, cl_mem m, cl_bool b, size_t s, size_t n, void* h, cl_uint c, const cl_event* w, cl_event* e), (o, m, b, s, n, h, c, w, e), o)
FORWARD(cl_int, clEnqueueReadBufferRect, (cl_command_queue o, cl_mem m, cl_bool b, const size_t* f, const size_t* t, const size_t* g, size_t r, size_t s, size_t h, size_t i, void* p, cl_uint c, const cl_event* w, cl_event* e), (o, m, b, f, t, g, r, s, h, i, p, c, w, e), o)
FORWARD(cl_int, clEnqueueWriteBuffer, (cl_command_queue o, cl_mem m, cl_bool b, size_t s, size_t n, const void* h, cl_uint c, const cl_event* w, cl_event* e), (o, m, b, s, n, h, c, w, e), o)
FORWARD(cl_int, clEnqueueWriteBufferRect, (cl_command_queue o, cl_mem m, cl_bool b, const size_t* f, const size_t* t, const size_t* g, size_t r, size_t s, size_t h, size_t i, const void* p, cl_uint c, const cl_event* w, cl_event* e), (o, m, b, f, t, g, r, s, h, i, p, c, w, e), o)
FORWARD(cl_int, clGetMemObjectInfo, (cl_mem o, cl_mem_info w, size_t n, void* v, size_t* r), (o, w, n, v, r), o)
FORWARD(cl_int, clGetContextInfo, (cl_context o, cl_context_info w, size_t n, void* v, size_t* r), (o, w, n, v, r), o)
FORWARD(cl_int, clEnqueueCopyBuffer, (cl_command_queue o, cl_mem f, cl_mem t, size_t x, size_t y, size_t n, cl_uint c, const cl_event* w, cl_event* e), (o, f, t, x, y, n, c, w, e), o)
FORWARD(cl_int, clEnqueueFillBuffer, (cl_command_queue o, cl_mem m, const void* p, size_t k, size_t s, size_t n, cl_uint c, const cl_event* w, cl_event* e), (o, m, p, k, s, n, c, w, e), o)
FORWARD(void*, clEnqueueMapBuffer, (cl_command_queue o, cl_mem m, cl_bool b, cl_map_flags f, size_t s, size_t n, cl_uint c, const cl_event* w, cl_event* e, cl_int* r), (o, m, b, f, s, n, c, w, e, r), o)
FORWARD(cl_int, clEnqueueUnmapMemObject, (cl_command_queue o, cl_mem m, void* p, cl_uint c, const cl_event* w, cl_event* e), (o, m, p, c, w, e), o)
FORWARD(cl_int, clEnqueueNDRangeKernel, (cl_command_queue o, cl_kernel k, cl_uint d, const size_t* s, const size_t* g, const size_t* l, cl_uint c, const cl_event* w, cl_event* e), (o, k, d, s, g, l, c, w, e), o)
FORWARD(cl_program, clCreateProgramWithSource, (cl_context o, cl_uint n, const char** s, const size_t* l, cl_int* e), (o, n, s, l, e), o)
FORWARD(cl_int, clReleaseProgram, (cl_program o), (o), o)
FORWARD(cl_int, clBuildProgram, (cl_program o, cl_uint n, const cl_device_id* d, const char* t, void (CL_CALLBACK* f)(cl_program, void*), void* u), (o, n, d, t, f, u), o)
FORWARD(cl_int, clGetProgramBuildInfo, (cl_program o, cl_device_id d, cl_program_build_info w, size_t n, void* v, size_t* r), (o, d, w, n, v, r), o)
FORWARD(cl_kernel, clCreateKernel, (cl_program o, const char* n, cl_int* e), (o, n, e), o)
FORWARD(cl_int, clReleaseKernel, (cl_kernel o), (o), o)
FORWARD(cl_int, clSetKernelArg, (cl_kernel o, cl_uint i, size_t n, const void* v), (o, i, n, v), o)
FORWARD(cl_int, clGetKernelInfo, (cl_kernel o, cl_kernel_info w, size_t n, void* v, size_t* r), (o, w, n, v, r), o)
FORWARD(cl_int, clGetEventProfilingInfo, (cl_event o, cl_profiling_info w, size_t n, void* v, size_t* r), (o, w, n, v, r), o)
FORWARD(cl_int, clReleaseEvent, (cl_event o), (o), o)
/* clang-format on */
