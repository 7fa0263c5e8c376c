/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* OpenCL calls that fail, one after the other: each gives a status and a sentence, an empty surface
 * and no buffer left over, and the next run on the same context is right. */

#include "core_fixture.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>

/* The call that fails, counted from 0; -1: none. */
static int fail_at = -1, call_count;
static cl_int fail_with;
static char failed_call[64];

/* Buffers that OpenCL still holds; its threads release them. */
static atomic_int live_buffers;

static int fails(const char* name)
{
  if (call_count++ != fail_at)
  {
    return 0;
  }
  snprintf(failed_call, sizeof failed_call, "%s", name);
  return 1;
}

#define FAULT_CALL(name, parameters, arguments)                                                    \
  cl_int __real_##name parameters;                                                                 \
  cl_int __wrap_##name parameters;                                                                 \
  cl_int __wrap_##name parameters                                                                  \
  {                                                                                                \
    return fails(#name) ? fail_with : __real_##name arguments;                                     \
  }

FAULT_CALL(clBuildProgram,
  (cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
    void(CL_CALLBACK* notify)(cl_program, void*), void* data),
  (program, count, devices, options, notify, data))
FAULT_CALL(clSetKernelArg, (cl_kernel kernel, cl_uint index, size_t size, const void* value),
  (kernel, index, size, value))
FAULT_CALL(clEnqueueNDRangeKernel,
  (cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
    const size_t* global, const size_t* local, cl_uint waits, const cl_event* wait,
    cl_event* event),
  (queue, kernel, dimensions, offset, global, local, waits, wait, event))
FAULT_CALL(clEnqueueReadBuffer,
  (cl_command_queue queue, cl_mem mem, cl_bool blocking, size_t offset, size_t size, void* data,
    cl_uint waits, const cl_event* wait, cl_event* event),
  (queue, mem, blocking, offset, size, data, waits, wait, event))
FAULT_CALL(clEnqueueWriteBuffer,
  (cl_command_queue queue, cl_mem mem, cl_bool blocking, size_t offset, size_t size,
    const void* data, cl_uint waits, const cl_event* wait, cl_event* event),
  (queue, mem, blocking, offset, size, data, waits, wait, event))
FAULT_CALL(clEnqueueFillBuffer,
  (cl_command_queue queue, cl_mem mem, const void* pattern, size_t pattern_size, size_t offset,
    size_t size, cl_uint waits, const cl_event* wait, cl_event* event),
  (queue, mem, pattern, pattern_size, offset, size, waits, wait, event))
FAULT_CALL(clEnqueueCopyBuffer,
  (cl_command_queue queue, cl_mem from, cl_mem to, size_t from_offset, size_t to_offset,
    size_t size, cl_uint waits, const cl_event* wait, cl_event* event),
  (queue, from, to, from_offset, to_offset, size, waits, wait, event))
FAULT_CALL(clFinish, (cl_command_queue queue), (queue))

/* Reports a failure but unmaps, as else the buffer would stay mapped by this test's fault. */
cl_int __real_clEnqueueUnmapMemObject(cl_command_queue queue, cl_mem mem, void* mapped,
  cl_uint waits, const cl_event* wait, cl_event* event);
cl_int __wrap_clEnqueueUnmapMemObject(cl_command_queue queue, cl_mem mem, void* mapped,
  cl_uint waits, const cl_event* wait, cl_event* event);
cl_int __wrap_clEnqueueUnmapMemObject(cl_command_queue queue, cl_mem mem, void* mapped,
  cl_uint waits, const cl_event* wait, cl_event* event)
{
  const cl_int error = __real_clEnqueueUnmapMemObject(queue, mem, mapped, waits, wait, event);
  return fails("clEnqueueUnmapMemObject") ? fail_with : error;
}

/* Of a build that failed. Like real ones, it is not handed over in part. */
static const char* long_log;

cl_int __wrap_clGetProgramBuildInfo(cl_program program, cl_device_id device,
  cl_program_build_info info, size_t size, void* value, size_t* needed);
cl_int __wrap_clGetProgramBuildInfo(cl_program program, cl_device_id device,
  cl_program_build_info info, size_t size, void* value, size_t* needed)
{
  (void)program;
  (void)device;
  assert_int_equal(info, CL_PROGRAM_BUILD_LOG);
  if (needed)
  {
    *needed = strlen(long_log) + 1;
  }
  if (value && size < strlen(long_log) + 1)
  {
    return CL_INVALID_VALUE;
  }
  if (value)
  {
    strcpy(value, long_log);
  }
  return CL_SUCCESS;
}

static void CL_CALLBACK on_destroyed(cl_mem mem, void* data)
{
  (void)mem;
  (void)data;
  atomic_fetch_sub(&live_buffers, 1);
}

cl_mem __real_clCreateBuffer(
  cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error);
cl_mem __wrap_clCreateBuffer(
  cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error);
cl_mem __wrap_clCreateBuffer(
  cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error)
{
  if (fails("clCreateBuffer"))
  {
    *error = fail_with;
    return NULL;
  }
  cl_mem mem = __real_clCreateBuffer(context, flags, size, host, error);
  if (mem && clSetMemObjectDestructorCallback(mem, on_destroyed, NULL) == CL_SUCCESS)
  {
    atomic_fetch_add(&live_buffers, 1);
  }
  return mem;
}

void* __real_clEnqueueMapBuffer(cl_command_queue queue, cl_mem mem, cl_bool blocking,
  cl_map_flags flags, size_t offset, size_t size, cl_uint waits, const cl_event* wait,
  cl_event* event, cl_int* error);
void* __wrap_clEnqueueMapBuffer(cl_command_queue queue, cl_mem mem, cl_bool blocking,
  cl_map_flags flags, size_t offset, size_t size, cl_uint waits, const cl_event* wait,
  cl_event* event, cl_int* error);
void* __wrap_clEnqueueMapBuffer(cl_command_queue queue, cl_mem mem, cl_bool blocking,
  cl_map_flags flags, size_t offset, size_t size, cl_uint waits, const cl_event* wait,
  cl_event* event, cl_int* error)
{
  if (fails("clEnqueueMapBuffer"))
  {
    *error = fail_with;
    return NULL;
  }
  return __real_clEnqueueMapBuffer(
    queue, mem, blocking, flags, offset, size, waits, wait, event, error);
}

cl_kernel __real_clCreateKernel(cl_program program, const char* name, cl_int* error);
cl_kernel __wrap_clCreateKernel(cl_program program, const char* name, cl_int* error);
cl_kernel __wrap_clCreateKernel(cl_program program, const char* name, cl_int* error)
{
  if (fails("clCreateKernel"))
  {
    *error = fail_with;
    return NULL;
  }
  return __real_clCreateKernel(program, name, error);
}

/* OpenCL's threads may release a buffer a little after the last command that uses it. */
static void wait_for_release(mcor_context* context, int buffers)
{
  const double begin = mcor_seconds();
  assert_int_equal(clFinish(context->cl.queue), CL_SUCCESS);
  while (live_buffers != buffers && mcor_seconds() - begin < 10)
  {
    thrd_yield();
  }
}

static void set_fault(int at, cl_int error)
{
  fail_at = at;
  fail_with = error;
  call_count = 0;
  failed_call[0] = '\0';
}

/* What a context holds on the device when it holds nothing of a run. */
static void expect_nothing_held(mcor_context* context, int64_t bytes, int buffers)
{
  mcor_release_memory(context);
  CORE_CHECK(context->cl.bytes == bytes, "after a fault in %s: %lld bytes are held, not %lld",
    failed_call, (long long)context->cl.bytes, (long long)bytes);
  wait_for_release(context, buffers);
  CORE_CHECK(live_buffers == buffers, "after a fault in %s: %d buffers are held, not %d",
    failed_call, (int)live_buffers, buffers);
}

typedef struct sweep
{
  mcor_input input;
  mcor_options options;
  uint64_t expected;
  int64_t bytes;
  int buffers, step;
} sweep;

static void expect_right(mcor_context* context, const sweep* s)
{
  mcor_surface surface = core_extract(context, &s->input, &s->options);
  CORE_CHECK(
    core_hash(&surface) == s->expected, "after a fault in %s: another surface", failed_call);
  mcor_free_surface(&surface);
}

/* Lets every step-th call of a run fail. kept: something is on the device that can be given back,
 * so that a run without memory succeeds at the second attempt. */
static int run_sweep(mcor_context* context, const sweep* s, cl_int error, int kept)
{
  const mcor_status expected = error == CL_INVALID_COMMAND_QUEUE ? MCOR_DEVICE_ERROR
    : kept                                                       ? MCOR_OK
                                                                 : MCOR_OUT_OF_CAPACITY;
  int n = 0;
  for (;; n += s->step)
  {
    mcor_surface surface;
    kept ? expect_right(context, s) : expect_nothing_held(context, s->bytes, s->buffers);
    mcor_input input = s->input; /* other numbers: nothing is reused, only given back */
    input.particles_version += 1 + (uint64_t)n;
    input.scalar_version += 1 + (uint64_t)n;
    set_fault(n, error);
    const mcor_status status = mcor_extract(context, &input, &s->options, &surface);
    fail_at = -1;
    if (!failed_call[0])
    {
      CORE_OK(context, status);
      mcor_free_surface(&surface);
      break;
    }
    CORE_CHECK(status == expected, "call %d, %s fails with %d: status %s, not %s: %s", n,
      failed_call, (int)error, mcor_status_name(status), mcor_status_name(expected),
      mcor_last_error(context));
    if (status == MCOR_OK)
    {
      CORE_CHECK(core_hash(&surface) == s->expected, "fault in %s: another surface", failed_call);
    }
    else
    {
      CORE_CHECK(strstr(mcor_last_error(context), "failed with CL_") ||
          strstr(mcor_last_error(context), "could not allocate"),
        "fault in %s: %s", failed_call, mcor_last_error(context));
      CORE_CHECK(!surface.points && !surface.triangles && !surface.attributes, "not empty");
      expect_nothing_held(context, s->bytes, s->buffers);
      expect_right(context, s);
    }
    mcor_free_surface(&surface);
  }
  return n;
}

static double flat(const double x[3])
{
  return x[2];
}

/* All that a run may do on the device: attributes, topology by the field, both kinds of trimming
 * quantities, pairs that grow. */
static void test_every_call_fails_once(void** state)
{
  mcor_context* context = *state;
  static const double iso = 0.3;
  core_set set = core_make_block(6, 0.3, 3, flat);
  const mcor_array attribute = core_array(set.smoothing_length, 1);
  set.smoothing_length[7] *= 1.5;
  sweep s = { .input = core_input(&set), .options = core_options(&iso), .step = 1 };
  s.input.attributes = &attribute;
  s.input.attribute_count = 1;
  s.input.particles_version = s.input.scalar_version = 1000000;
  s.options.topology = MCOR_TOPOLOGY_FIELD;
  s.options.seeds = MCOR_PAIRS;
  s.options.boundary_eigenvalue = s.options.nearest_particle = 1;
  mcor_surface surface = core_extract(context, &s.input, &s.options);
  s.expected = core_hash(&surface);
  CORE_CHECK(surface.triangle_count > 20, "%d triangles", (int)surface.triangle_count);
  mcor_free_surface(&surface);
  mcor_release_memory(context);
  s.bytes = context->cl.bytes;
  s.buffers = 3; /* tables that a context keeps */
  const int calls = run_sweep(context, &s, CL_INVALID_COMMAND_QUEUE, 0);
  CORE_CHECK(calls > 500, "only %d calls", calls);
  run_sweep(context, &s, CL_MEM_OBJECT_ALLOCATION_FAILURE, 0);
  s.step = 7;
  run_sweep(context, &s, CL_MEM_OBJECT_ALLOCATION_FAILURE, 1);
  s.step = 37;
  run_sweep(context, &s, CL_OUT_OF_RESOURCES, 1);
  run_sweep(context, &s, CL_OUT_OF_HOST_MEMORY, 1);
  core_free_set(&set);
}

/* A large buffer's pages are asked for through a view of it, which may fail. */
static void test_extend(void** state)
{
  mcor_context* context = *state;
  mcor_release_memory(context);
  const int64_t bytes = context->cl.bytes;
  const int buffers = 3; /* as above */
  int n = 0;
  for (;; ++n)
  {
    mcor_buffer buffer = { 0 };
    CORE_OK(context, mcor_fill(context, &buffer, 1, 1000));
    set_fault(n, CL_MEM_OBJECT_ALLOCATION_FAILURE);
    const mcor_status status = mcor_extend(context, &buffer, 1000, 2 * MCOR_LARGE_ARRAY);
    fail_at = -1;
    assert_int_equal(status, failed_call[0] ? MCOR_OUT_OF_CAPACITY : MCOR_OK);
    uint8_t last = 0;
    CORE_OK(context, mcor_read(context, &buffer, 999, &last, 1));
    assert_int_equal(last, 1);
    mcor_release(context, &buffer);
    expect_nothing_held(context, bytes, buffers);
    if (status == MCOR_OK)
    {
      break;
    }
  }
  assert_int_equal(n, 4); /* create, map, unmap, copy */
}

/* A program that declares what is built in, and does not build, is built without that. */
static void test_build_again(void** state)
{
  mcor_context* context = *state;
  const mcor_build build = { .sph_kernel = MCOR_QUADRATIC };
  const bool declares = context->cl.declares_builtins;
  long_log = "";
  CORE_OK(context, mcor_choose_build(context, &build));
  set_fault(0, CL_BUILD_PROGRAM_FAILURE);
  const mcor_status status = MCOR_LAUNCH(context, "mcor_seed_regions", MCOR_HEAVY, 1, MCOR_INT(0));
  fail_at = -1;
  assert_int_equal(status, MCOR_DEVICE_ERROR);
  assert_string_equal(failed_call, "clBuildProgram");
  assert_false(context->cl.declares_builtins);
  CORE_CHECK(declares == !strstr(mcor_last_error(context), "CL_BUILD_PROGRAM_FAILURE") &&
      declares == !!strstr(mcor_last_error(context), "arguments; 1 were given"),
    "%s", mcor_last_error(context));
}

/* A program that does not build says so, with the beginning of its log, however long that is. */
static void test_build_fails(void** state)
{
  mcor_context* context = *state;
  const mcor_build build = { .sph_kernel = MCOR_WENDLAND_C2 };
  char log[20000];
  memset(log, '.', sizeof log - 1);
  memcpy(log, "line 7: no such thing", 21);
  log[sizeof log - 1] = '\0';
  long_log = log;
  context->cl.declares_builtins = false;
  set_fault(0, CL_BUILD_PROGRAM_FAILURE);
  CORE_OK(context, mcor_choose_build(context, &build));
  const mcor_status status = MCOR_LAUNCH(context, "mcor_seed_regions", MCOR_HEAVY, 1, MCOR_INT(0));
  fail_at = -1;
  assert_int_equal(status, MCOR_DEVICE_ERROR);
  assert_non_null(strstr(mcor_last_error(context), "CL_BUILD_PROGRAM_FAILURE"));
  assert_non_null(strstr(mcor_last_error(context), "mcor_w_wendland"));
  assert_non_null(strstr(mcor_last_error(context), "line 7: no such thing"));
}

static void test_error_names(void** state)
{
  mcor_context* context = *state;
  mcor_buffer buffer = { 0 };
  static const struct
  {
    cl_int code;
    const char* name;
  } names[] = { { -12, "CL_MAP_FAILURE" }, { -15, "CL_COMPILE_PROGRAM_FAILURE" },
    { -17, "CL_LINK_PROGRAM_FAILURE" }, { -45, "CL_INVALID_PROGRAM_EXECUTABLE" },
    { -68, "CL_INVALID_DEVICE_PARTITION_COUNT" }, { -1001, "CL_PLATFORM_NOT_FOUND_KHR" } };
  for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i)
  {
    CORE_OK(context, mcor_reserve(context, &buffer, 1));
    set_fault(0, names[i].code);
    assert_int_equal(mcor_fill(context, &buffer, 0, 1), MCOR_DEVICE_ERROR);
    fail_at = -1;
    CORE_CHECK(strstr(mcor_last_error(context), names[i].name), "%s", mcor_last_error(context));
  }
  /* Every code of OpenCL 1.2: -1 to -19, and -30 to -68. */
  for (cl_int code = -68; code < 0; ++code)
  {
    set_fault(0, code);
    mcor_fill(context, &buffer, 0, 1);
    fail_at = -1;
    CORE_CHECK((code < -19 && code > -30) || strstr(mcor_last_error(context), "with CL_"), "%d: %s",
      (int)code, mcor_last_error(context));
  }
  mcor_release(context, &buffer);
}

/* A context that could not be made: its sentence says why, and a run on it fails. */
static void test_no_context(void** state)
{
  (void)state;
  static const double iso = 0;
  core_set set = core_make_block(4, 0, 1, core_slope);
  mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  for (int n = 0, done = 0; !done; ++n)
  {
    mcor_context* context = NULL;
    set_fault(n, CL_OUT_OF_RESOURCES);
    const mcor_status status = mcor_create_context(NULL, &context);
    fail_at = -1;
    done = !failed_call[0];
    CORE_CHECK(done == (status == MCOR_OK), "call %d: %s", n, mcor_status_name(status));
    CORE_CHECK(!done || n >= 2, "only %d calls", n);
    if (!done)
    {
      mcor_surface surface = { .point_count = 7 };
      mcor_release_memory(context);
      assert_int_equal(mcor_extract(context, &input, &options, &surface), MCOR_DEVICE_ERROR);
      CORE_CHECK(strstr(mcor_last_error(context), "CL_OUT_OF_RESOURCES"), "%s: %s", failed_call,
        mcor_last_error(context));
      assert_int_equal(surface.point_count, 0);
    }
    mcor_free_context(context);
  }
  core_free_set(&set);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_no_context),
    cmocka_unit_test(test_every_call_fails_once), cmocka_unit_test(test_extend),
    cmocka_unit_test(test_build_again), cmocka_unit_test(test_build_fails),
    cmocka_unit_test(test_error_names) };
  return cmocka_run_group_tests_name("fault", tests, core_set_up, core_tear_down);
}
