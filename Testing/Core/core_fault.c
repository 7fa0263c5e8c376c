/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#include "core_fault.h"

#include <stdatomic.h>
#include <sys/mman.h>
#include <threads.h>
#include <unistd.h>

/* fail_at: which call fails, counted from 0; -1: none. call_count: how many calls came so far. */
static int fail_at = -1, call_count;

/* The kinds of calls that may fail: setting an argument of a launch, any other OpenCL call, an
 * allocation of the host. */
enum
{
  ARGUMENT = 1,
  COMMAND = 2,
  ALLOCATION = 4
};
static int counted;
static cl_int fail_with;
static char failed_call[64];

/* The number of buffers that were made and not released. */
static atomic_int live_buffers;

static int fails(const char* name, int kind)
{
  if (fail_at < 0 || !(kind & counted) || call_count++ != fail_at)
  {
    return 0;
  }
  snprintf(failed_call, sizeof failed_call, "%s", name);
  return 1;
}

/* The functions that a driver had in its table before core_fault.c put others there. */
typedef struct real_driver
{
  const cl_icd_dispatch* table;
  cl_icd_dispatch functions;
} real_driver;

/* Returns the driver with this table, or an empty place for it. */
static real_driver* find_driver(const cl_icd_dispatch* table)
{
  static real_driver drivers[64];
  real_driver* driver = drivers;
  for (; driver->table && driver->table != table; ++driver)
  {
  }
  return driver;
}

#define REAL(object) (find_driver(mcor_driver(object))->functions)

/* Defines try_NAME, which fails or calls the driver's NAME. object: the parameter that says which driver is called. */
#define FAULT_CALL(name, object, parameters, arguments)                                            \
  static cl_int try_##name parameters                                                              \
  {                                                                                                \
    const int kind = strcmp(#name, "clSetKernelArg") == 0 ? ARGUMENT : COMMAND;                    \
    return fails(#name, kind) ? fail_with : (REAL(object).name)arguments;                          \
  }

/* If CORE_SHADOWS is set, writes once more to the whole buffer that the host has written to (see
 * core_fault.h). */
static cl_int write_again(cl_command_queue queue, cl_mem mem, cl_int error);

#define FAULT_WRITE(name, mem, parameters, arguments)                                              \
  static cl_int try_##name parameters                                                              \
  {                                                                                                \
    return fails(#name, COMMAND) ? fail_with                                                       \
                                 : write_again(queue, mem, (REAL(queue).name)arguments);           \
  }

FAULT_CALL(clBuildProgram, program,
  (cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
    void(CL_CALLBACK* notify)(cl_program, void*), void* data),
  (program, count, devices, options, notify, data))
FAULT_CALL(clSetKernelArg, kernel,
  (cl_kernel kernel, cl_uint index, size_t size, const void* value), (kernel, index, size, value))
FAULT_CALL(clEnqueueNDRangeKernel, queue,
  (cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
    const size_t* global, const size_t* local, cl_uint waits, const cl_event* wait,
    cl_event* event),
  (queue, kernel, dimensions, offset, global, local, waits, wait, event))
FAULT_CALL(clEnqueueReadBuffer, queue,
  (cl_command_queue queue, cl_mem mem, cl_bool blocking, size_t offset, size_t size, void* data,
    cl_uint waits, const cl_event* wait, cl_event* event),
  (queue, mem, blocking, offset, size, data, waits, wait, event))
FAULT_WRITE(clEnqueueWriteBuffer, mem,
  (cl_command_queue queue, cl_mem mem, cl_bool blocking, size_t offset, size_t size,
    const void* data, cl_uint waits, const cl_event* wait, cl_event* event),
  (queue, mem, blocking, offset, size, data, waits, wait, event))
FAULT_WRITE(clEnqueueFillBuffer, mem,
  (cl_command_queue queue, cl_mem mem, const void* pattern, size_t pattern_size, size_t offset,
    size_t size, cl_uint waits, const cl_event* wait, cl_event* event),
  (queue, mem, pattern, pattern_size, offset, size, waits, wait, event))
FAULT_WRITE(clEnqueueCopyBuffer, to,
  (cl_command_queue queue, cl_mem from, cl_mem to, size_t from_offset, size_t to_offset,
    size_t size, cl_uint waits, const cl_event* wait, cl_event* event),
  (queue, from, to, from_offset, to_offset, size, waits, wait, event))
FAULT_CALL(clFinish, queue, (cl_command_queue queue), (queue))

/* Unmaps even when the caller is told of a failure: otherwise the buffer would stay mapped. */
static cl_int try_clEnqueueUnmapMemObject(cl_command_queue queue, cl_mem mem, void* mapped,
  cl_uint waits, const cl_event* wait, cl_event* event)
{
  const cl_int error = write_again(
    queue, mem, (REAL(queue).clEnqueueUnmapMemObject)(queue, mem, mapped, waits, wait, event));
  return fails("clEnqueueUnmapMemObject", COMMAND) ? fail_with : error;
}

static cl_int write_again(cl_command_queue queue, cl_mem mem, cl_int error)
{
  size_t size = 0;
  if (error != CL_SUCCESS || !getenv("CORE_SHADOWS"))
  {
    return error;
  }
  error = clGetMemObjectInfo(mem, CL_MEM_SIZE, sizeof size, &size, NULL);
  void* data = calloc(size, 1);
  if (error == CL_SUCCESS && data)
  {
    error = clEnqueueReadBuffer(queue, mem, CL_TRUE, 0, size, data, 0, NULL, NULL);
    error = error == CL_SUCCESS
      ? (REAL(queue).clEnqueueWriteBuffer)(queue, mem, CL_TRUE, 0, size, data, 0, NULL, NULL)
      : error;
  }
  free(data);
  return error;
}

static const char* build_log;

void core_set_build_log(const char* log)
{
  build_log = log;
}

static cl_int try_clGetProgramBuildInfo(cl_program program, cl_device_id device,
  cl_program_build_info info, size_t size, void* value, size_t* needed)
{
  if (!build_log)
  {
    return (REAL(program).clGetProgramBuildInfo)(program, device, info, size, value, needed);
  }
  assert_int_equal(info, CL_PROGRAM_BUILD_LOG);
  if (needed)
  {
    *needed = strlen(build_log) + 1;
  }
  if (value && size < strlen(build_log) + 1)
  {
    return CL_INVALID_VALUE;
  }
  if (value)
  {
    strcpy(value, build_log);
  }
  return CL_SUCCESS;
}

static cl_int try_clReleaseMemObject(cl_mem mem)
{
  atomic_fetch_sub(&live_buffers, 1);
  return getenv("CORE_SHADOWS") ? CL_SUCCESS : (REAL(mem).clReleaseMemObject)(mem);
}

/* Decides whether a call that returns a new object fails. Sets *error if it fails. */
static int fails_to_make(const char* name, cl_int* error)
{
  const int failed = fails(name, COMMAND);
  if (failed)
  {
    *error = fail_with;
  }
  return failed;
}

/* The device of the context that was created last. */
static cl_device_id device_now;

static cl_context try_clCreateContext(const cl_context_properties* properties, cl_uint count,
  const cl_device_id* devices, void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*),
  void* user, cl_int* error)
{
  device_now = *devices;
  return fails_to_make("clCreateContext", error)
    ? NULL
    : (REAL(*devices).clCreateContext)(properties, count, devices, notify, user, error);
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

static cl_mem try_clCreateBuffer(
  cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error)
{
  cl_mem mem = fails_to_make("clCreateBuffer", error)
    ? NULL
    : (REAL(context).clCreateBuffer)(context, flags, size, host, error);
  const char* byte = getenv("CORE_FILL");
  if (mem && byte)
  {
    *error = fill(context, mem, size, (unsigned char)atoi(byte));
  }
  atomic_fetch_add(&live_buffers, mem != NULL);
  return mem;
}

static void* try_clEnqueueMapBuffer(cl_command_queue queue, cl_mem mem, cl_bool blocking,
  cl_map_flags flags, size_t offset, size_t size, cl_uint waits, const cl_event* wait,
  cl_event* event, cl_int* error)
{
  return fails_to_make("clEnqueueMapBuffer", error)
    ? NULL
    : (REAL(queue).clEnqueueMapBuffer)(
        queue, mem, blocking, flags, offset, size, waits, wait, event, error);
}

static cl_kernel try_clCreateKernel(cl_program program, const char* name, cl_int* error)
{
  return fails_to_make("clCreateKernel", error)
    ? NULL
    : (REAL(program).clCreateKernel)(program, name, error);
}

/* Puts the try_ functions above in place of a driver's own, also where its table is constant. */
static void replace_functions(cl_icd_dispatch* table)
{
  const size_t size = offsetof(cl_icd_dispatch, clCreateCommandQueueWithProperties);
  const size_t past = (size_t)table % (size_t)sysconf(_SC_PAGESIZE);
  real_driver* driver = find_driver(table);
  if (driver->table)
  {
    return;
  }
  driver->table = table;
  memcpy(&driver->functions, table, size);
  assert_int_equal(mprotect((char*)table - past, past + size, PROT_READ | PROT_WRITE), 0);
  table->clBuildProgram = try_clBuildProgram;
  table->clCreateBuffer = try_clCreateBuffer;
  table->clCreateContext = try_clCreateContext;
  table->clCreateKernel = try_clCreateKernel;
  table->clSetKernelArg = try_clSetKernelArg;
  table->clEnqueueNDRangeKernel = try_clEnqueueNDRangeKernel;
  table->clEnqueueReadBuffer = try_clEnqueueReadBuffer;
  table->clEnqueueWriteBuffer = try_clEnqueueWriteBuffer;
  table->clEnqueueFillBuffer = try_clEnqueueFillBuffer;
  table->clEnqueueCopyBuffer = try_clEnqueueCopyBuffer;
  table->clEnqueueMapBuffer = try_clEnqueueMapBuffer;
  table->clEnqueueUnmapMemObject = try_clEnqueueUnmapMemObject;
  table->clFinish = try_clFinish;
  table->clGetProgramBuildInfo = try_clGetProgramBuildInfo;
  table->clReleaseMemObject = try_clReleaseMemObject;
}

cl_uint __real_mcor_list_platforms(cl_uint room, cl_platform_id* platforms);
cl_uint __wrap_mcor_list_platforms(cl_uint room, cl_platform_id* platforms);
cl_uint __wrap_mcor_list_platforms(cl_uint room, cl_platform_id* platforms)
{
  const cl_uint count = __real_mcor_list_platforms(room, platforms);
  for (cl_uint i = 0; i < count; ++i)
  {
    replace_functions((cl_icd_dispatch*)mcor_driver(platforms[i]));
  }
  return count;
}

#define FAULT_ALLOCATION(name, parameters, arguments)                                              \
  void* __real_##name parameters;                                                                  \
  void* __wrap_##name parameters;                                                                  \
  void* __wrap_##name parameters                                                                   \
  {                                                                                                \
    return fails(#name, ALLOCATION) ? NULL : __real_##name arguments;                              \
  }

FAULT_ALLOCATION(malloc, (size_t size), (size))
FAULT_ALLOCATION(calloc, (size_t count, size_t size), (count, size))
FAULT_ALLOCATION(realloc, (void* memory, size_t size), (memory, size))

/* Waits until no more than `buffers` buffers live: OpenCL's threads may release a buffer a little
 * after the last command that uses it. */
static void wait_for_release(mcor_context* context, int buffers)
{
  const double begin = mcor_seconds();
  assert_int_equal(clFinish(context->cl.queue), CL_SUCCESS);
  while (live_buffers != buffers && mcor_seconds() - begin < 10)
  {
    thrd_yield();
  }
}

static void set_fault(int n, cl_int error, int kinds)
{
  fail_at = n;
  fail_with = error;
  counted = kinds;
  call_count = 0;
  failed_call[0] = '\0';
}

void core_fail_call(int n, cl_int error)
{
  set_fault(n, error, ARGUMENT | COMMAND);
}

void core_fail_command(int n, cl_int error)
{
  set_fault(n, error, COMMAND);
}

void core_fail_allocation(int n)
{
  set_fault(n, 0, ALLOCATION);
}

void core_fail_nothing(void)
{
  fail_at = -1;
}

const char* core_failed_call(void)
{
  return failed_call;
}

void core_expect_nothing_held(mcor_context* context, int64_t bytes, int buffers)
{
  mcor_release_memory(context);
  CORE_CHECK(context->cl.bytes == bytes, failed_call, context->cl.bytes, bytes);
  wait_for_release(context, buffers);
  CORE_CHECK(live_buffers == buffers, failed_call, live_buffers, buffers);
}
