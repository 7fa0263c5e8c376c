/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_opencl_h
#define mcor_opencl_h

/* OpenCL's functions, found at run time (mcor_opencl.c), under names of their own, so that a
 * program with this library linked in may link OpenCL, too. */

#define CL_TARGET_OPENCL_VERSION 120

#define clBuildProgram mcor_clBuildProgram
#define clCreateBuffer mcor_clCreateBuffer
#define clCreateCommandQueue mcor_clCreateCommandQueue
#define clCreateContext mcor_clCreateContext
#define clCreateKernel mcor_clCreateKernel
#define clCreateProgramWithSource mcor_clCreateProgramWithSource
#define clCreateSubDevices mcor_clCreateSubDevices
#define clEnqueueCopyBuffer mcor_clEnqueueCopyBuffer
#define clEnqueueFillBuffer mcor_clEnqueueFillBuffer
#define clEnqueueMapBuffer mcor_clEnqueueMapBuffer
#define clEnqueueNDRangeKernel mcor_clEnqueueNDRangeKernel
#define clEnqueueReadBuffer mcor_clEnqueueReadBuffer
#define clEnqueueReadBufferRect mcor_clEnqueueReadBufferRect
#define clEnqueueUnmapMemObject mcor_clEnqueueUnmapMemObject
#define clEnqueueWriteBuffer mcor_clEnqueueWriteBuffer
#define clEnqueueWriteBufferRect mcor_clEnqueueWriteBufferRect
#define clFinish mcor_clFinish
#define clGetDeviceIDs mcor_clGetDeviceIDs
#define clGetDeviceInfo mcor_clGetDeviceInfo
#define clGetEventProfilingInfo mcor_clGetEventProfilingInfo
#define clGetKernelInfo mcor_clGetKernelInfo
#define clGetContextInfo mcor_clGetContextInfo
#define clGetMemObjectInfo mcor_clGetMemObjectInfo
#define clGetPlatformIDs mcor_clGetPlatformIDs
#define clGetPlatformInfo mcor_clGetPlatformInfo
#define clGetProgramBuildInfo mcor_clGetProgramBuildInfo
#define clReleaseCommandQueue mcor_clReleaseCommandQueue
#define clReleaseContext mcor_clReleaseContext
#define clReleaseDevice mcor_clReleaseDevice
#define clReleaseEvent mcor_clReleaseEvent
#define clReleaseKernel mcor_clReleaseKernel
#define clReleaseMemObject mcor_clReleaseMemObject
#define clReleaseProgram mcor_clReleaseProgram
#define clSetKernelArg mcor_clSetKernelArg

#include <CL/cl.h>

#endif
