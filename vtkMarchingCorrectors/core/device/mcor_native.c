/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The built-in device's objects, memory, programs and kernels: the functions of OpenCL that
 * mcor_cl_*.c call. A buffer is memory of the host. A command queue is always empty, and is the
 * same object as its context. */

#include "mcor_native.h"
#include "mcor_parallel.h"
#include "mcor_system.h"

#include <CL/cl_icd.h>

#include <stdlib.h>
#include <string.h>

/* OpenCL's functions have many parameters that do not matter to this device. */
#pragma GCC diagnostic ignored "-Wunused-parameter"

#define MCOR_ARGUMENT_LIMIT 64
#define MCOR_BUFFER_ALIGNMENT 128
/* A launch of fewer light work-items than this does not wake other threads: a light work-item takes
 * only some nanoseconds. Light work-items come in groups of 64, medium and heavy ones in groups of
 * one. A medium or heavy launch wakes threads even for few work-items. */
#define MCOR_FEW_LIGHT_ITEMS 8192
/* How many parts each thread gets: MCOR_LIGHT_PARTS of a light launch, MCOR_HEAVY_PARTS of another
 * one. Parts are many, because threads without work wait for the last part, and work-items take
 * different times, heavy ones above all. A part has at most MCOR_PART_ITEMS work-items. */
#define MCOR_LIGHT_PARTS 16
#define MCOR_HEAVY_PARTS 64
#define MCOR_PART_ITEMS 4096

extern const cl_icd_dispatch mcor_native_table;

struct _cl_platform_id
{
  const cl_icd_dispatch* table;
};

struct _cl_device_id
{
  const cl_icd_dispatch* table;
};

struct _cl_context
{
  const cl_icd_dispatch* table;
  mcor_pool pool;
};

struct _cl_mem
{
  const cl_icd_dispatch* table;
  char* data; /* the bytes follow this struct */
};

struct _cl_program
{
  const cl_icd_dispatch* table;
  const mcor_native_program* program; /* NULL: not built */
};

struct _cl_kernel
{
  const cl_icd_dispatch* table;
  const mcor_native_program* program;
  unsigned number;
  cl_uint count;
  const char* kinds; /* see mcor_native_program */
  char values[MCOR_ARGUMENT_LIMIT][8];
  void* arguments[MCOR_ARGUMENT_LIMIT];
};

static struct _cl_platform_id mcor_platform = { &mcor_native_table };
static struct _cl_device_id mcor_device = { &mcor_native_table };

/* ---- Platform and device ---- */

cl_platform_id mcor_native_platform(void)
{
  return mcor_best_instructions() >= 0 ? &mcor_platform : NULL;
}

/* Answers a query of OpenCL with the `size` bytes at `from`. No caller asks for the size alone. */
static cl_int mcor_answer(const void* from, size_t size, size_t room, void* to)
{
  if (room < size)
  {
    return CL_INVALID_VALUE;
  }
  memcpy(to, from, size);
  return CL_SUCCESS;
}

static cl_int mcor_platform_info(
  cl_platform_id platform, cl_platform_info what, size_t room, void* to, size_t* needed)
{
  static const char name[] = "built in";
  return what == CL_PLATFORM_NAME ? mcor_answer(name, sizeof name, room, to) : CL_INVALID_VALUE;
}

static cl_int mcor_device_ids(
  cl_platform_id platform, cl_device_type type, cl_uint room, cl_device_id* devices, cl_uint* count)
{
  devices[0] = &mcor_device;
  *count = 1;
  return CL_SUCCESS;
}

static cl_int mcor_device_info(
  cl_device_id device, cl_device_info what, size_t room, void* to, size_t* needed)
{
  static const char* const names[] = { "built in: this CPU", "built in: this CPU, AVX2",
    "built in: this CPU, AVX-512" };
  const int best = mcor_best_instructions();
  const cl_device_type type = CL_DEVICE_TYPE_CPU;
  const cl_uint units = (cl_uint)mcor_limit_threads(mcor_processors(1));
  const cl_uint width = best == MCOR_INSTRUCTIONS_V4 ? 16 : 8;
  const cl_device_fp_config rounding = CL_FP_DENORM | CL_FP_INF_NAN | CL_FP_ROUND_TO_NEAREST |
    CL_FP_FMA | CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT;
  /* The machine's memory; what other programs use of it is not known. */
  const cl_ulong bytes = mcor_system_memory(), memory = bytes > 0 ? bytes : (cl_ulong)1 << 32;
  const struct
  {
    cl_device_info what;
    const void* from;
    size_t size;
  } answers[] = { { CL_DEVICE_NAME, names[best], strlen(names[best]) + 1 },
    { CL_DEVICE_TYPE, &type, sizeof type }, { CL_DEVICE_MAX_COMPUTE_UNITS, &units, sizeof units },
    { CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT, &width, sizeof width },
    { CL_DEVICE_SINGLE_FP_CONFIG, &rounding, sizeof rounding },
    { CL_DEVICE_DOUBLE_FP_CONFIG, &rounding, sizeof rounding },
    { CL_DEVICE_GLOBAL_MEM_SIZE, &memory, sizeof memory },
    { CL_DEVICE_MAX_MEM_ALLOC_SIZE, &memory, sizeof memory } };
  for (size_t i = 0; i < sizeof answers / sizeof answers[0]; ++i)
  {
    if (answers[i].what == what)
    {
      return mcor_answer(answers[i].from, answers[i].size, room, to);
    }
  }
  return CL_INVALID_VALUE;
}

/* ---- Objects ---- */

/* Defines a function that frees an object of a type; such objects own no other memory. */
#define MCOR_RELEASE_ALONE(name, type)                                                             \
  static cl_int name(type object)                                                                  \
  {                                                                                                \
    free(object);                                                                                  \
    return CL_SUCCESS;                                                                             \
  }
MCOR_RELEASE_ALONE(mcor_release_program, cl_program)
MCOR_RELEASE_ALONE(mcor_release_kernel, cl_kernel)

/* Makes an object with its table of functions; all else is 0. Sets *error. NULL: memory ran out. */
static void* mcor_make_object(size_t size, cl_int* error)
{
  struct _cl_platform_id* object = calloc(1, size);
  if (object)
  {
    object->table = &mcor_native_table;
  }
  *error = object ? CL_SUCCESS : CL_OUT_OF_HOST_MEMORY;
  return object;
}

static cl_context mcor_make_context(const cl_context_properties* properties, cl_uint count,
  const cl_device_id* devices, void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*),
  void* user, cl_int* error)
{
  return mcor_make_object(sizeof(struct _cl_context), error);
}

static cl_int mcor_release_context(cl_context context)
{
  mcor_end_pool(&context->pool);
  free(context);
  return CL_SUCCESS;
}

static cl_command_queue mcor_make_queue(
  cl_context context, cl_device_id device, cl_command_queue_properties properties, cl_int* error)
{
  *error = CL_SUCCESS;
  return (cl_command_queue)context;
}

/* Finishes or releases a queue: there is nothing to wait for, and nothing to free. */
static cl_int mcor_leave_queue(cl_command_queue queue)
{
  return CL_SUCCESS;
}

/* ---- Buffers ---- */

static cl_mem mcor_make_buffer(
  cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error)
{
  cl_mem buffer = mcor_system_allocate(MCOR_BUFFER_ALIGNMENT, MCOR_BUFFER_ALIGNMENT + size);
  if (buffer)
  {
    *buffer = (struct _cl_mem){ &mcor_native_table, (char*)buffer + MCOR_BUFFER_ALIGNMENT };
  }
  *error = buffer ? CL_SUCCESS : CL_MEM_OBJECT_ALLOCATION_FAILURE;
  return buffer;
}

static cl_int mcor_release_buffer(cl_mem buffer)
{
  mcor_system_release(buffer);
  return CL_SUCCESS;
}

static cl_int mcor_read_buffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
  size_t offset, size_t size, void* to, cl_uint count, const cl_event* wait, cl_event* event)
{
  memcpy(to, buffer->data + offset, size);
  return CL_SUCCESS;
}

static cl_int mcor_write_buffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
  size_t offset, size_t size, const void* from, cl_uint count, const cl_event* wait,
  cl_event* event)
{
  memcpy(buffer->data + offset, from, size);
  return CL_SUCCESS;
}

static cl_int mcor_copy_buffer(cl_command_queue queue, cl_mem from, cl_mem to, size_t from_offset,
  size_t to_offset, size_t size, cl_uint count, const cl_event* wait, cl_event* event)
{
  memcpy(to->data + to_offset, from->data + from_offset, size);
  return CL_SUCCESS;
}

static cl_int mcor_fill_buffer(cl_command_queue queue, cl_mem buffer, const void* pattern,
  size_t pattern_size, size_t offset, size_t size, cl_uint count, const cl_event* wait,
  cl_event* event)
{
  memset(buffer->data + offset, *(const unsigned char*)pattern, size);
  for (size_t i = 0; i < size && pattern_size > 1; i += pattern_size)
  {
    memcpy(buffer->data + offset + i, pattern, pattern_size);
  }
  return CL_SUCCESS;
}

static void* mcor_map_buffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
  cl_map_flags flags, size_t offset, size_t size, cl_uint count, const cl_event* wait,
  cl_event* event, cl_int* error)
{
  *error = CL_SUCCESS;
  return buffer->data + offset;
}

static cl_int mcor_unmap_buffer(cl_command_queue queue, cl_mem buffer, void* mapped, cl_uint count,
  const cl_event* wait, cl_event* event)
{
  return CL_SUCCESS;
}

/* ---- Programs and kernels ---- */

/* Ignores the sources: they were compiled with the library. */
static cl_program mcor_make_program(
  cl_context context, cl_uint count, const char** texts, const size_t* lengths, cl_int* error)
{
  return mcor_make_object(sizeof(struct _cl_program), error);
}

static cl_int mcor_build_program(cl_program program, cl_uint count, const cl_device_id* devices,
  const char* options, void(CL_CALLBACK* notify)(cl_program, void*), void* user)
{
  program->program = mcor_find_program(options);
  return program->program ? CL_SUCCESS : CL_BUILD_PROGRAM_FAILURE;
}

static cl_kernel mcor_make_kernel(cl_program program, const char* name, cl_int* error)
{
  const size_t length = strlen(name);
  const char *at = program->program->kernels, *kinds = program->program->arguments;
  unsigned number = 0;
  for (; *at && !(strncmp(at, name, length) == 0 && at[length] == ';'); ++number)
  {
    at = strchr(at, ';') + 1;
    kinds = strchr(kinds, ';') + 1;
  }
  if (!*at)
  {
    *error = CL_INVALID_KERNEL_NAME;
    return NULL;
  }
  cl_kernel kernel = mcor_make_object(sizeof *kernel, error);
  if (!kernel)
  {
    return NULL;
  }
  kernel->program = program->program;
  kernel->number = number;
  kernel->kinds = kinds;
  kernel->count = (cl_uint)strcspn(kinds, ";");
  for (cl_uint i = 0; i < kernel->count; ++i)
  {
    kernel->arguments[i] = kernel->values[i];
  }
  return kernel;
}

static cl_int mcor_set_argument(cl_kernel kernel, cl_uint i, size_t size, const void* value)
{
  const bool is_buffer = kernel->kinds[i] == 'b';
  const cl_mem buffer = is_buffer ? *(const cl_mem*)value : NULL;
  char* const data = buffer ? buffer->data : NULL;
  if (!is_buffer && size != (size_t)(kernel->kinds[i] - '0'))
  {
    return CL_INVALID_ARG_SIZE;
  }
  memcpy(kernel->values[i], is_buffer ? &data : value, size);
  return CL_SUCCESS;
}

static cl_int mcor_kernel_info(
  cl_kernel kernel, cl_kernel_info what, size_t room, void* to, size_t* needed)
{
  return what == CL_KERNEL_NUM_ARGS ? mcor_answer(&kernel->count, sizeof kernel->count, room, to)
                                    : CL_INVALID_VALUE;
}

/* ---- Launches ---- */

static void mcor_run_items(void* data, size_t first, size_t last)
{
  const cl_kernel kernel = data;
  kernel->program->run(kernel->number, kernel->arguments, first, last);
}

mcor_pool* mcor_native_pool(cl_context context)
{
  return &context->pool;
}

static cl_int mcor_launch_kernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
  const size_t* offset, const size_t* items, const size_t* group, cl_uint count,
  const cl_event* wait, cl_event* event)
{
  const size_t first = offset ? *offset : 0;
  mcor_pool* pool = &((cl_context)queue)->pool;
  const size_t parts = (size_t)pool->threads * (*group > 1 ? MCOR_LIGHT_PARTS : MCOR_HEAVY_PARTS);
  const size_t step = (*items + parts - 1) / parts;
  const bool is_short = *group > 1 && *items < MCOR_FEW_LIGHT_ITEMS;
  mcor_pool_run(pool, NULL, first, first + *items,
    is_short                   ? *items
      : step < MCOR_PART_ITEMS ? step
                               : MCOR_PART_ITEMS,
    mcor_run_items, kernel);
  return CL_SUCCESS;
}

const cl_icd_dispatch mcor_native_table = { .clGetPlatformInfo = mcor_platform_info,
  .clGetDeviceIDs = mcor_device_ids,
  .clGetDeviceInfo = mcor_device_info,
  .clCreateContext = mcor_make_context,
  .clReleaseContext = mcor_release_context,
  .clCreateCommandQueue = mcor_make_queue,
  .clReleaseCommandQueue = mcor_leave_queue,
  .clFinish = mcor_leave_queue,
  .clFlush = mcor_leave_queue,
  .clCreateBuffer = mcor_make_buffer,
  .clReleaseMemObject = mcor_release_buffer,
  .clEnqueueReadBuffer = mcor_read_buffer,
  .clEnqueueWriteBuffer = mcor_write_buffer,
  .clEnqueueCopyBuffer = mcor_copy_buffer,
  .clEnqueueFillBuffer = mcor_fill_buffer,
  .clEnqueueMapBuffer = mcor_map_buffer,
  .clEnqueueUnmapMemObject = mcor_unmap_buffer,
  .clCreateProgramWithSource = mcor_make_program,
  .clBuildProgram = mcor_build_program,
  .clReleaseProgram = mcor_release_program,
  .clCreateKernel = mcor_make_kernel,
  .clReleaseKernel = mcor_release_kernel,
  .clSetKernelArg = mcor_set_argument,
  .clGetKernelInfo = mcor_kernel_info,
  .clEnqueueNDRangeKernel = mcor_launch_kernel };
