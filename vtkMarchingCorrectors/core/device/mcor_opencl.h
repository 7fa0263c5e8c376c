/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_opencl_h
#define mcor_opencl_h

/* OpenCL's functions, found at run time. Every object of an OpenCL driver begins with a table of
 * the driver's functions (extension cl_khr_icd), and so does every object of the built-in device.
 * So an object alone is enough to call a function, and a program with this library linked in may
 * link OpenCL, too. */

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl_icd.h>
/* On Windows, cl_icd.h includes windows.h, which defines these words. */
#undef far
#undef near
#undef small

/* Lists the platforms, the built-in one first. */
cl_uint mcor_list_platforms(cl_uint room, cl_platform_id* platforms);
/* Returns the functions of the driver that made an object. */
static inline const cl_icd_dispatch* mcor_driver(const void* object)
{
  return *(const cl_icd_dispatch* const*)object;
}

#define clBuildProgram(o, ...) mcor_driver(o)->clBuildProgram(o, __VA_ARGS__)
#define clCreateBuffer(o, ...) mcor_driver(o)->clCreateBuffer(o, __VA_ARGS__)
#define clCreateCommandQueue(o, ...) mcor_driver(o)->clCreateCommandQueue(o, __VA_ARGS__)
#define clCreateContext(p, n, o, ...) mcor_driver(*(o))->clCreateContext(p, n, o, __VA_ARGS__)
#define clCreateKernel(o, ...) mcor_driver(o)->clCreateKernel(o, __VA_ARGS__)
#define clCreateProgramWithSource(o, ...) mcor_driver(o)->clCreateProgramWithSource(o, __VA_ARGS__)
#define clCreateSubDevices(o, ...) mcor_driver(o)->clCreateSubDevices(o, __VA_ARGS__)
#define clEnqueueCopyBuffer(o, ...) mcor_driver(o)->clEnqueueCopyBuffer(o, __VA_ARGS__)
#define clEnqueueFillBuffer(o, ...) mcor_driver(o)->clEnqueueFillBuffer(o, __VA_ARGS__)
#define clEnqueueMapBuffer(o, ...) mcor_driver(o)->clEnqueueMapBuffer(o, __VA_ARGS__)
#define clEnqueueNDRangeKernel(o, ...) mcor_driver(o)->clEnqueueNDRangeKernel(o, __VA_ARGS__)
#define clEnqueueReadBuffer(o, ...) mcor_driver(o)->clEnqueueReadBuffer(o, __VA_ARGS__)
#define clEnqueueReadBufferRect(o, ...) mcor_driver(o)->clEnqueueReadBufferRect(o, __VA_ARGS__)
#define clEnqueueUnmapMemObject(o, ...) mcor_driver(o)->clEnqueueUnmapMemObject(o, __VA_ARGS__)
#define clEnqueueWriteBuffer(o, ...) mcor_driver(o)->clEnqueueWriteBuffer(o, __VA_ARGS__)
#define clEnqueueWriteBufferRect(o, ...) mcor_driver(o)->clEnqueueWriteBufferRect(o, __VA_ARGS__)
#define clFinish(o) mcor_driver(o)->clFinish(o)
#define clFlush(o) mcor_driver(o)->clFlush(o)
#define clGetContextInfo(o, ...) mcor_driver(o)->clGetContextInfo(o, __VA_ARGS__)
#define clGetDeviceIDs(o, ...) mcor_driver(o)->clGetDeviceIDs(o, __VA_ARGS__)
#define clGetDeviceInfo(o, ...) mcor_driver(o)->clGetDeviceInfo(o, __VA_ARGS__)
#define clGetEventProfilingInfo(o, ...) mcor_driver(o)->clGetEventProfilingInfo(o, __VA_ARGS__)
#define clGetKernelInfo(o, ...) mcor_driver(o)->clGetKernelInfo(o, __VA_ARGS__)
#define clGetMemObjectInfo(o, ...) mcor_driver(o)->clGetMemObjectInfo(o, __VA_ARGS__)
#define clGetPlatformInfo(o, ...) mcor_driver(o)->clGetPlatformInfo(o, __VA_ARGS__)
#define clGetProgramBuildInfo(o, ...) mcor_driver(o)->clGetProgramBuildInfo(o, __VA_ARGS__)
#define clReleaseCommandQueue(o) mcor_driver(o)->clReleaseCommandQueue(o)
#define clReleaseContext(o) mcor_driver(o)->clReleaseContext(o)
#define clReleaseDevice(o) mcor_driver(o)->clReleaseDevice(o)
#define clReleaseEvent(o) mcor_driver(o)->clReleaseEvent(o)
#define clReleaseKernel(o) mcor_driver(o)->clReleaseKernel(o)
#define clReleaseMemObject(o) mcor_driver(o)->clReleaseMemObject(o)
#define clReleaseProgram(o) mcor_driver(o)->clReleaseProgram(o)
#define clSetKernelArg(o, ...) mcor_driver(o)->clSetKernelArg(o, __VA_ARGS__)

#endif
