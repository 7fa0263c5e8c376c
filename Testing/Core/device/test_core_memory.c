/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests arrays in OpenCL buffers. The buffers belong to an OpenCL context that the caller has made, here on PoCL. */

#include "core_fixture.h"
#include "mcor_cl_memory.h"

#include <stdlib.h>

/* Bytes before the first particle, and from each particle to the next. */
enum
{
  OFFSET = 64,
  STRIDE = 56
};

typedef struct own_opencl
{
  cl_context context;
  cl_command_queue queue;
} own_opencl;

static own_opencl open_pocl(void)
{
  own_opencl own = { NULL, NULL };
  cl_platform_id platforms[16];
  const cl_uint count = mcor_list_platforms(16, platforms);
  cl_int error;
  for (cl_uint p = 0; p < count; ++p)
  {
    char name[64] = "";
    cl_device_id device;
    cl_uint found;
    clGetPlatformInfo(platforms[p], CL_PLATFORM_NAME, sizeof name, name, NULL);
    if (strcmp(name, "Portable Computing Language") == 0 &&
      clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, 1, &device, &found) == CL_SUCCESS)
    {
      own.context = clCreateContext(NULL, 1, &device, NULL, NULL, &error);
      assert_int_equal(error, CL_SUCCESS);
      own.queue = clCreateCommandQueue(own.context, device, 0, &error);
      assert_int_equal(error, CL_SUCCESS);
    }
  }
  CORE_CHECK(own.context != NULL, "PoCL was not found");
  return own;
}

static void close_pocl(const own_opencl* own)
{
  clReleaseCommandQueue(own->queue);
  clReleaseContext(own->context);
}

static cl_mem make_memory(const own_opencl* own, const void* data, size_t size)
{
  cl_int error;
  cl_mem memory = clCreateBuffer(own->context, CL_MEM_READ_WRITE, size, NULL, &error);
  assert_int_equal(error, CL_SUCCESS);
  assert_int_equal(
    clEnqueueWriteBuffer(own->queue, memory, CL_TRUE, 0, size, data, 0, NULL, NULL), CL_SUCCESS);
  return memory;
}

/* Moves an array of doubles to a buffer: packed, or in rows of STRIDE bytes that begin OFFSET bytes
 * into the buffer. */
static void move_array(
  const own_opencl* own, mcor_array* array, int components, int64_t count, bool in_rows)
{
  const size_t width = (size_t)components * sizeof(double);
  const size_t offset = in_rows ? OFFSET : 0, stride = in_rows ? STRIDE : width;
  const size_t size = offset + (size_t)count * stride - (stride - width);
  char* bytes = malloc(size);
  assert_non_null(bytes);
  memset(bytes, 0xff, size);
  for (int64_t i = 0; i < count; ++i)
  {
    memcpy(
      bytes + offset + (size_t)i * stride, (const char*)array->data + (size_t)i * width, width);
  }
  array->memory = make_memory(own, bytes, size);
  array->offset = offset;
  array->stride = in_rows ? stride : 0;
  array->data = NULL;
  free(bytes);
}

/* Arrays in buffers give the same surfaces as the same arrays in the host's memory. On a CPU, arrays that have nothing
 * between their values are not copied. */
static void test_input(void** state)
{
  mcor_context* context = *state;
  CORE_SET set = core_make_block(9, 0.3, 3, core_ball);
  const double iso = 2.5;
  const mcor_input input = core_input(&set);
  const mcor_options options = core_options(&iso);
  CORE_SURFACE expected = core_extract(context, &input, &options);
  assert_true(expected.triangle_count > 100);
  assert_int_equal(input.positions.type, MCOR_FLOAT64);
  const own_opencl own = open_pocl();
  for (int in_rows = 0; in_rows < 2; ++in_rows)
  {
    mcor_input other = input;
    mcor_array attribute = input.scalar,
               *const arrays[] = { &other.positions, &other.smoothing_length, &other.volume,
                 &other.scalar, &attribute };
    for (int i = 0; i < 5; ++i)
    {
      move_array(&own, arrays[i], i == 0 ? 3 : 1, input.count, in_rows);
    }
    other.positions.components = in_rows ? 0 : 3; /* positions always have 3 */
    other.attributes = &attribute;
    other.attribute_count = 1;
    mcor_sight sight;
    cl_int error;
    CORE_OK(context, mcor_see_input(context, &other, &sight));
    void* const view = clEnqueueMapBuffer(own.queue, other.positions.memory, CL_TRUE, CL_MAP_READ,
      other.positions.offset, sizeof(double), 0, NULL, NULL, &error);
    assert_true((sight.input.positions.data == view) == !in_rows);
    clEnqueueUnmapMemObject(own.queue, other.positions.memory, view, 0, NULL, NULL);
    mcor_end_sight(&sight);
    CORE_SURFACE surface = core_extract(context, &other, &options);
    assert_int_equal(surface.point_count, expected.point_count);
    assert_memory_equal(surface.points, expected.points, 24 * (size_t)surface.point_count);
    assert_memory_equal(surface.triangles, expected.triangles, 12 * (size_t)surface.triangle_count);
    for (int64_t i = 0; i < surface.point_count; ++i)
    {
      CORE_CHECK(
        fabs(surface.attributes[0][i] - iso) < 0.3, "attribute %g", surface.attributes[0][i]);
    }
    ++other.scalar.offset;
    CORE_SURFACE refused;
    CORE_FAILS(context, MCOR_INVALID_ARGUMENT, mcor_extract(context, &other, &options, &refused),
      "MEMORY_TOO_SMALL");
    for (int i = 0; i < 5; ++i)
    {
      clReleaseMemObject(arrays[i]->memory);
    }
  }
  close_pocl(&own);
}

/* Results are written in the buffer's type and stride. All other bytes of the buffer stay. */
static void test_store(void** state)
{
  mcor_context* context = *state;
  const own_opencl own = open_pocl();
  const double points[] = { 1, 2, 3, 4, 5, 6.25 };
  const int32_t triangle[] = { 7, 8, 9 };
  unsigned char bytes[OFFSET + 2 * STRIDE];
  float row[3];
  memset(bytes, 0xAB, sizeof bytes);
  const cl_mem memory = make_memory(&own, bytes, sizeof bytes);
  const mcor_array from = { .data = points, .type = MCOR_FLOAT64, .components = 3 };
  mcor_array to = { .memory = memory, .components = 3, .offset = OFFSET, .stride = STRIDE };
  CORE_OK(context, mcor_store(context, &from, 2, &to));
  const mcor_array whole = { .data = triangle, .type = MCOR_FLOAT32, .components = 3 };
  to.offset = to.stride = 0;
  CORE_OK(context, mcor_store(context, &whole, 1, &to));
  assert_int_equal(
    clEnqueueReadBuffer(own.queue, memory, CL_TRUE, 0, sizeof bytes, bytes, 0, NULL, NULL),
    CL_SUCCESS);
  assert_memory_equal(bytes, triangle, sizeof triangle);
  for (int i = 0; i < 2; ++i)
  {
    memcpy(row, bytes + OFFSET + i * STRIDE, sizeof row);
    for (int a = 0; a < 3; ++a)
    {
      assert_true(row[a] == (float)points[3 * i + a]);
    }
  }
  for (size_t i = 12; i < sizeof bytes; ++i)
  {
    const bool is_written = i >= OFFSET && (i - OFFSET) % STRIDE < sizeof row;
    CORE_CHECK(is_written || bytes[i] == 0xAB, "byte %zu was changed", i);
  }
  to.offset = sizeof bytes - 20;
  CORE_FAILS(
    context, MCOR_INVALID_ARGUMENT, mcor_store(context, &from, 2, &to), "MEMORY_TOO_SMALL");
  to.components = 1;
  CORE_FAILS(
    context, MCOR_INVALID_ARGUMENT, mcor_store(context, &from, 2, &to), "MEMORY_COMPONENTS");
  clReleaseMemObject(memory);
  close_pocl(&own);
}

CORE_MAIN(core_set_up, core_tear_down, test_input, test_store)
