/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The linker puts these in front of OpenCL's own (CMakeLists.txt). CORE_FILL=BYTE in the environment:
 * new buffers are filled with this byte, so that reading what was never written changes results.
 * CORE_SHADOWS: for oclgrind --uninitialized, which takes a buffer for as large as what the host wrote
 * last, and a new one for the one released before: here none is released, and what the host has written
 * to is written once more as a whole. */

#include "mcor_cl.h"

#include <CL/cl_icd.h>

#include <stdlib.h>

#define WRAP(type, name, parameters)                                                               \
  type __real_##name parameters;                                                                   \
  type __wrap_##name parameters;                                                                   \
  type __wrap_##name parameters

/* The device of the context that was made last. */
static cl_device_id device_now;

WRAP(cl_context, mcor_clCreateContext,
  (const cl_context_properties* properties, cl_uint count, const cl_device_id* devices,
    void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*), void* user, cl_int* error))
{
  device_now = devices[0];
  return __real_mcor_clCreateContext(properties, count, devices, notify, user, error);
}

static cl_int fill(cl_context context, cl_mem mem, size_t size, unsigned char byte)
{
  cl_int error;
  cl_command_queue queue = clCreateCommandQueue(context, device_now, 0, &error);
  if (queue)
  {
    error = clEnqueueFillBuffer(queue, mem, &byte, 1, 0, size, 0, NULL, NULL);
    error = error == CL_SUCCESS ? clFinish(queue) : error;
    clReleaseCommandQueue(queue);
  }
  return error;
}

WRAP(cl_mem, mcor_clCreateBuffer,
  (cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error))
{
  const char* byte = getenv("CORE_FILL");
  cl_mem mem = __real_mcor_clCreateBuffer(context, flags, size, host, error);
  if (mem && byte)
  {
    *error = fill(context, mem, size, (unsigned char)atoi(byte));
  }
  return mem;
}

WRAP(cl_int, mcor_clReleaseMemObject, (cl_mem mem))
{
  return getenv("CORE_SHADOWS") ? CL_SUCCESS : __real_mcor_clReleaseMemObject(mem);
}

cl_int __real_mcor_clEnqueueWriteBuffer(cl_command_queue queue, cl_mem mem, cl_bool blocking,
  size_t offset, size_t size, const void* data, cl_uint waits, const cl_event* wait,
  cl_event* event);

static cl_int write_again(cl_command_queue queue, cl_mem mem, cl_int error)
{
  size_t size = 0;
  if (error != CL_SUCCESS || !getenv("CORE_SHADOWS"))
  {
    return error;
  }
  error = (*(cl_icd_dispatch* const*)mem)->clGetMemObjectInfo(mem, CL_MEM_SIZE, sizeof size, &size, NULL);
  void* data = calloc(size, 1);
  if (error == CL_SUCCESS && data)
  {
    error = clEnqueueReadBuffer(queue, mem, CL_TRUE, 0, size, data, 0, NULL, NULL);
    error = error == CL_SUCCESS
      ? __real_mcor_clEnqueueWriteBuffer(queue, mem, CL_TRUE, 0, size, data, 0, NULL, NULL)
      : error;
  }
  free(data);
  return error;
}

WRAP(cl_int, mcor_clEnqueueWriteBuffer,
  (cl_command_queue queue, cl_mem mem, cl_bool blocking, size_t offset, size_t size,
    const void* data, cl_uint waits, const cl_event* wait, cl_event* event))
{
  return write_again(queue, mem,
    __real_mcor_clEnqueueWriteBuffer(queue, mem, blocking, offset, size, data, waits, wait, event));
}

WRAP(cl_int, mcor_clEnqueueFillBuffer,
  (cl_command_queue queue, cl_mem mem, const void* pattern, size_t pattern_size, size_t offset,
    size_t size, cl_uint waits, const cl_event* wait, cl_event* event))
{
  return write_again(queue, mem,
    __real_mcor_clEnqueueFillBuffer(
      queue, mem, pattern, pattern_size, offset, size, waits, wait, event));
}

WRAP(cl_int, mcor_clEnqueueCopyBuffer,
  (cl_command_queue queue, cl_mem from, cl_mem to, size_t from_offset, size_t to_offset,
    size_t size, cl_uint waits, const cl_event* wait, cl_event* event))
{
  return write_again(queue, to,
    __real_mcor_clEnqueueCopyBuffer(queue, from, to, from_offset, to_offset, size, waits, wait, event));
}

WRAP(cl_int, mcor_clEnqueueUnmapMemObject,
  (cl_command_queue queue, cl_mem mem, void* mapped, cl_uint waits, const cl_event* wait,
    cl_event* event))
{
  return write_again(
    queue, mem, __real_mcor_clEnqueueUnmapMemObject(queue, mem, mapped, waits, wait, event));
}
