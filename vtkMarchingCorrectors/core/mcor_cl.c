/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#include "mcor_cache.h"
#include "mcor_internal.h"
#include "mcor_program.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_PLATFORM_LIMIT 16
#define MCOR_DEVICE_LIMIT 64

/* The platform whose first device is the default. */
#define MCOR_DEFAULT_PLATFORM "Portable Computing Language"

typedef struct mcor_device_list
{
  int count;
  cl_platform_id platforms[MCOR_DEVICE_LIMIT];
  cl_device_id devices[MCOR_DEVICE_LIMIT];
} mcor_device_list;

static const char* mcor_cl_error_name(cl_int error)
{
#define MCOR_NAMED(code)                                                                           \
  {                                                                                                \
    code, #code                                                                                    \
  }
  static const struct
  {
    cl_int code;
    const char* name;
  } names[] = { MCOR_NAMED(CL_DEVICE_NOT_FOUND), MCOR_NAMED(CL_DEVICE_NOT_AVAILABLE),
    MCOR_NAMED(CL_COMPILER_NOT_AVAILABLE), MCOR_NAMED(CL_MEM_OBJECT_ALLOCATION_FAILURE),
    MCOR_NAMED(CL_OUT_OF_RESOURCES), MCOR_NAMED(CL_OUT_OF_HOST_MEMORY),
    MCOR_NAMED(CL_PROFILING_INFO_NOT_AVAILABLE), MCOR_NAMED(CL_MEM_COPY_OVERLAP),
    MCOR_NAMED(CL_IMAGE_FORMAT_MISMATCH), MCOR_NAMED(CL_IMAGE_FORMAT_NOT_SUPPORTED),
    MCOR_NAMED(CL_BUILD_PROGRAM_FAILURE), MCOR_NAMED(CL_MAP_FAILURE),
    MCOR_NAMED(CL_MISALIGNED_SUB_BUFFER_OFFSET),
    MCOR_NAMED(CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST),
    MCOR_NAMED(CL_COMPILE_PROGRAM_FAILURE), MCOR_NAMED(CL_LINKER_NOT_AVAILABLE),
    MCOR_NAMED(CL_LINK_PROGRAM_FAILURE), MCOR_NAMED(CL_DEVICE_PARTITION_FAILED),
    MCOR_NAMED(CL_KERNEL_ARG_INFO_NOT_AVAILABLE), MCOR_NAMED(CL_INVALID_VALUE),
    MCOR_NAMED(CL_INVALID_DEVICE_TYPE), MCOR_NAMED(CL_INVALID_PLATFORM),
    MCOR_NAMED(CL_INVALID_DEVICE), MCOR_NAMED(CL_INVALID_CONTEXT),
    MCOR_NAMED(CL_INVALID_QUEUE_PROPERTIES), MCOR_NAMED(CL_INVALID_COMMAND_QUEUE),
    MCOR_NAMED(CL_INVALID_HOST_PTR), MCOR_NAMED(CL_INVALID_MEM_OBJECT),
    MCOR_NAMED(CL_INVALID_IMAGE_FORMAT_DESCRIPTOR), MCOR_NAMED(CL_INVALID_IMAGE_SIZE),
    MCOR_NAMED(CL_INVALID_SAMPLER), MCOR_NAMED(CL_INVALID_BINARY),
    MCOR_NAMED(CL_INVALID_BUILD_OPTIONS), MCOR_NAMED(CL_INVALID_PROGRAM),
    MCOR_NAMED(CL_INVALID_PROGRAM_EXECUTABLE), MCOR_NAMED(CL_INVALID_KERNEL_NAME),
    MCOR_NAMED(CL_INVALID_KERNEL_DEFINITION), MCOR_NAMED(CL_INVALID_KERNEL),
    MCOR_NAMED(CL_INVALID_ARG_INDEX), MCOR_NAMED(CL_INVALID_ARG_VALUE),
    MCOR_NAMED(CL_INVALID_ARG_SIZE), MCOR_NAMED(CL_INVALID_KERNEL_ARGS),
    MCOR_NAMED(CL_INVALID_WORK_DIMENSION), MCOR_NAMED(CL_INVALID_WORK_GROUP_SIZE),
    MCOR_NAMED(CL_INVALID_WORK_ITEM_SIZE), MCOR_NAMED(CL_INVALID_GLOBAL_OFFSET),
    MCOR_NAMED(CL_INVALID_EVENT_WAIT_LIST), MCOR_NAMED(CL_INVALID_EVENT),
    MCOR_NAMED(CL_INVALID_OPERATION), MCOR_NAMED(CL_INVALID_GL_OBJECT),
    MCOR_NAMED(CL_INVALID_BUFFER_SIZE), MCOR_NAMED(CL_INVALID_MIP_LEVEL),
    MCOR_NAMED(CL_INVALID_GLOBAL_WORK_SIZE), MCOR_NAMED(CL_INVALID_PROPERTY),
    MCOR_NAMED(CL_INVALID_IMAGE_DESCRIPTOR), MCOR_NAMED(CL_INVALID_COMPILER_OPTIONS),
    MCOR_NAMED(CL_INVALID_LINKER_OPTIONS), MCOR_NAMED(CL_INVALID_DEVICE_PARTITION_COUNT),
    { -1001, "CL_PLATFORM_NOT_FOUND_KHR" } };
#undef MCOR_NAMED
  for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i)
  {
    if (names[i].code == error)
    {
      return names[i].name;
    }
  }
  return "an OpenCL error";
}

/* Drivers that allocate when memory is first needed say so in any later call. */
static bool mcor_is_no_memory(cl_int error)
{
  return error == CL_MEM_OBJECT_ALLOCATION_FAILURE || error == CL_OUT_OF_RESOURCES ||
    error == CL_OUT_OF_HOST_MEMORY;
}

static mcor_status mcor_cl_fail(mcor_context* context, cl_int error, const char* what)
{
  const char *device = context->cl.device_name, *name = mcor_cl_error_name(error);
  return mcor_is_no_memory(error)
    ? mcor_fail(context, MCOR_OUT_OF_CAPACITY,
        "OpenCL device %s ran out of memory: %s failed with %s (%d). Use a larger cube size, or "
        "fewer particles.",
        device, what, name, (int)error)
    : mcor_fail(context, MCOR_DEVICE_ERROR, "OpenCL device %s: %s failed with %s (%d).", device,
        what, name, (int)error);
}

#define MCOR_CL_TRY(context, call, what)                                                           \
  do                                                                                               \
  {                                                                                                \
    const cl_int mcor_cl_error_ = (call);                                                          \
    if (mcor_cl_error_ != CL_SUCCESS)                                                              \
    {                                                                                              \
      return mcor_cl_fail(context, mcor_cl_error_, what);                                          \
    }                                                                                              \
  } while (0)

static void mcor_find_devices(mcor_device_list* list)
{
  cl_platform_id platforms[MCOR_PLATFORM_LIMIT];
  cl_uint platform_count = 0;
  list->count = 0;
  if (clGetPlatformIDs(MCOR_PLATFORM_LIMIT, platforms, &platform_count) != CL_SUCCESS)
  {
    return;
  }
  for (cl_uint p = 0; p < platform_count && p < MCOR_PLATFORM_LIMIT; ++p)
  {
    const int room = MCOR_DEVICE_LIMIT - list->count;
    cl_uint found = 0;
    if (room <= 0 ||
      clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, (cl_uint)room, list->devices + list->count,
        &found) != CL_SUCCESS)
    {
      continue;
    }
    for (cl_uint d = 0; d < found && d < (cl_uint)room; ++d)
    {
      list->platforms[list->count++] = platforms[p];
    }
  }
}

static void mcor_device_names(
  cl_platform_id platform, cl_device_id device, char* device_name, char* platform_name, size_t size)
{
  device_name[0] = platform_name[0] = '\0';
  clGetDeviceInfo(device, CL_DEVICE_NAME, size, device_name, NULL);
  clGetPlatformInfo(platform, CL_PLATFORM_NAME, size, platform_name, NULL);
}

/* The devices' numbers and names, as far as there is room. */
static void mcor_write_devices(
  const mcor_device_list* list, const char* separator, char* text, size_t room)
{
  size_t length = 0;
  text[0] = '\0';
  for (int i = 0; i < list->count && length < room; ++i)
  {
    char device[128], platform[128];
    mcor_device_names(list->platforms[i], list->devices[i], device, platform, sizeof device);
    length += (size_t)snprintf(
      text + length, room - length, "%s%d: %s (%s)", i > 0 ? separator : "", i, device, platform);
  }
}

mcor_status mcor_list_devices(char** text)
{
  if (!text)
  {
    return MCOR_INVALID_ARGUMENT;
  }
  mcor_device_list list;
  mcor_find_devices(&list);
  const size_t room = (size_t)list.count * 300 + 2;
  *text = calloc(room, 1);
  if (!*text)
  {
    return MCOR_OUT_OF_CAPACITY;
  }
  mcor_write_devices(&list, "\n", *text, room - 1);
  strcat(*text, list.count > 0 ? "\n" : "");
  return MCOR_OK;
}

static char mcor_lower(char c)
{
  return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

/* Whether `part` occurs in `text`, in capitals or not. */
static bool mcor_contains(const char* text, const char* part)
{
  for (; *text; ++text)
  {
    size_t i = 0;
    while (part[i] && mcor_lower(text[i]) == mcor_lower(part[i]))
    {
      ++i;
    }
    if (!part[i])
    {
      return true;
    }
  }
  return false;
}

/* Index into the list of the device that the user named, or -1. */
static int mcor_choose_device(const mcor_device_list* list, const char* wanted)
{
  char* end = NULL;
  const bool is_default = !wanted || !*wanted;
  const long number = is_default ? -1 : strtol(wanted, &end, 10);
  if (!is_default && *end == '\0')
  {
    return number >= 0 && number < list->count ? (int)number : -1;
  }
  for (int i = 0; i < list->count; ++i)
  {
    char device[128], platform[128];
    mcor_device_names(list->platforms[i], list->devices[i], device, platform, sizeof device);
    if (is_default ? strcmp(platform, MCOR_DEFAULT_PLATFORM) == 0
                   : mcor_contains(device, wanted) || mcor_contains(platform, wanted))
    {
      return i;
    }
  }
  return is_default && list->count > 0 ? 0 : -1;
}

/* Whether the kernels' form for CPUs suits the device. One that claims to be a CPU without vectors
 * works as a GPU does, with a work-item in each lane. MCOR_DEVICE_FORM is for tests: cpu or gpu. */
static bool mcor_has_cpu_form(const mcor_cl* cl)
{
  const char* forced = getenv("MCOR_DEVICE_FORM");
  if (forced && *forced)
  {
    return strcmp(forced, "gpu") != 0;
  }
  cl_device_type type = 0;
  cl_uint width = 1;
  clGetDeviceInfo(cl->device, CL_DEVICE_TYPE, sizeof type, &type, NULL);
  clGetDeviceInfo(cl->device, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT, sizeof width, &width, NULL);
  return (type & CL_DEVICE_TYPE_CPU) != 0 && width > 1;
}

static bool mcor_is_pocl(const mcor_cl* cl)
{
  return strcmp(cl->platform_name, MCOR_DEFAULT_PLATFORM) == 0;
}

static void mcor_query_device(mcor_cl* cl)
{
  cl_uint units = 1;
  cl_device_fp_config fp32 = 0, fp64 = 0;
  clGetDeviceInfo(cl->device, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
  clGetDeviceInfo(cl->device, CL_DEVICE_SINGLE_FP_CONFIG, sizeof fp32, &fp32, NULL);
  clGetDeviceInfo(cl->device, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof fp64, &fp64, NULL);
  clGetDeviceInfo(
    cl->device, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof cl->device_memory, &cl->device_memory, NULL);
  cl->memory_limit = cl->device_memory;
  clGetDeviceInfo(
    cl->device, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof cl->largest_buffer, &cl->largest_buffer, NULL);
  cl->is_cpu = mcor_has_cpu_form(cl);
  cl->has_fp64 = fp64 != 0;
  cl->rounds_division = (fp32 & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
  /* PoCL has a cache of its own, and compiles every kernel anew when asked for its binaries. */
  cl->keeps_binaries = !mcor_is_pocl(cl);
  cl->segments = cl->is_cpu ? (int)units * 8 : 4096;
}

mcor_status mcor_open_device(mcor_context* context, const char* device)
{
  mcor_cl* cl = &context->cl;
  mcor_device_list list;
  mcor_find_devices(&list);
  char fault[1200];
  MCOR_RETURN_IF(list.count == 0 && mcor_pocl_folder_fault(fault, sizeof fault), context,
    MCOR_DEVICE_ERROR, "No OpenCL device was found. If PoCL is installed: %s", fault);
  MCOR_RETURN_IF(list.count == 0, context, MCOR_DEVICE_ERROR,
    "No OpenCL device was found. Install an OpenCL driver; PoCL (Debian package pocl-opencl-icd) "
    "runs on the CPU.");
  const int chosen = mcor_choose_device(&list, device);
  if (chosen < 0)
  {
    char devices[300];
    mcor_write_devices(&list, ", ", devices, sizeof devices);
    return mcor_fail(context, MCOR_DEVICE_ERROR,
      "There is no OpenCL device \"%s\"; give the number of one, or part of its name: %s.", device,
      devices);
  }
  cl->platform = list.platforms[chosen];
  cl->device = list.devices[chosen];
  mcor_device_names(
    cl->platform, cl->device, cl->device_name, cl->platform_name, sizeof cl->device_name);
  mcor_query_device(cl);
  cl_int error;
  cl->context = clCreateContext(NULL, 1, &cl->device, NULL, NULL, &error);
  MCOR_CL_TRY(context, error, "clCreateContext");
  cl->queue = clCreateCommandQueue(cl->context, cl->device, 0, &error);
  MCOR_CL_TRY(context, error, "clCreateCommandQueue");
  cl->timed_queue =
    clCreateCommandQueue(cl->context, cl->device, CL_QUEUE_PROFILING_ENABLE, &error);
  MCOR_CL_TRY(context, error, "clCreateCommandQueue");
  return MCOR_OK;
}

/* Drops the programs, or those that depend on what is computed, and their kernels. */
static void mcor_drop_programs(mcor_cl* cl, bool all)
{
  int kept = 0;
  for (int i = 0; i < cl->kernel_count; ++i)
  {
    if (!all && cl->kernels[i].program == MCOR_PROGRAM_LATTICE)
    {
      cl->kernels[kept++] = cl->kernels[i];
    }
    else
    {
      clReleaseKernel(cl->kernels[i].kernel);
    }
  }
  cl->kernel_count = kept;
  for (int p = all ? 0 : MCOR_PROGRAM_LATTICE + 1; p < MCOR_PROGRAM_COUNT; ++p)
  {
    if (cl->programs[p])
    {
      clReleaseProgram(cl->programs[p]);
      cl->programs[p] = NULL;
    }
  }
}

void mcor_close_device(mcor_context* context)
{
  mcor_cl* cl = &context->cl;
  mcor_drop_programs(cl, true);
  if (cl->timed_queue)
  {
    clReleaseCommandQueue(cl->timed_queue);
  }
  if (cl->queue)
  {
    clReleaseCommandQueue(cl->queue);
  }
  if (cl->context)
  {
    clReleaseContext(cl->context);
  }
}

/* Tells the caller, once in a phase, that the next is building, which may take seconds. */
static mcor_status mcor_report_building(mcor_context* context)
{
  const mcor_options* options = context->options;
  const char* phase = "building the OpenCL program (first time only)";
  const bool told = context->building_told;
  context->building_told = true;
  MCOR_RETURN_IF(!told && options && options->progress &&
      options->progress(options->progress_user, context->fraction, phase) != 0,
    context, MCOR_CANCELLED, "The extraction was cancelled while building the OpenCL program.");
  return MCOR_OK;
}

/* Building is reported apart from the phase in which it happens. */
static void mcor_add_build_seconds(mcor_context* context, double seconds)
{
  context->cl.build_seconds += seconds;
  context->phase_begin += seconds;
}

static mcor_status mcor_fail_build(
  mcor_context* context, cl_program program, cl_int error, const char* options)
{
  const mcor_cl* cl = &context->cl;
  size_t size = 0;
  clGetProgramBuildInfo(program, cl->device, CL_PROGRAM_BUILD_LOG, 0, NULL, &size);
  char* log = calloc(size + 1, 1);
  if (log)
  {
    clGetProgramBuildInfo(program, cl->device, CL_PROGRAM_BUILD_LOG, size, log, NULL);
  }
  const mcor_status status = mcor_fail(context, MCOR_DEVICE_ERROR,
    "OpenCL device %s could not build the program (%s); options %s; log:\n%s", cl->device_name,
    mcor_cl_error_name(error), options, log ? log : "");
  free(log);
  return status;
}

/* Of all that a compiled program depends on. */
static mcor_cache_key mcor_program_key(
  const mcor_cl* cl, const char* const* sources, cl_uint count, const char* options)
{
  mcor_cache_key key = { { 0 } };
  const cl_device_info infos[] = { CL_DEVICE_VENDOR, CL_DEVICE_VERSION, CL_DRIVER_VERSION };
  mcor_cache_add(&key, cl->platform_name);
  mcor_cache_add(&key, cl->device_name);
  mcor_cache_add(&key, options);
  for (size_t i = 0; i < sizeof infos / sizeof infos[0]; ++i)
  {
    char text[256] = "";
    clGetDeviceInfo(cl->device, infos[i], sizeof text - 1, text, NULL);
    mcor_cache_add(&key, text);
  }
  for (cl_uint i = 0; i < count; ++i)
  {
    mcor_cache_add(&key, sources[i]);
  }
  return key;
}

/* The program from the cache; NULL where it is not there, or no longer to the driver's liking. */
static cl_program mcor_load_program(
  const mcor_cl* cl, const mcor_cache_key* key, const char* options)
{
  size_t size = 0;
  void* binary = cl->keeps_binaries ? mcor_cache_load(key, &size) : NULL;
  if (!binary)
  {
    return NULL;
  }
  cl_int error, loaded = CL_SUCCESS;
  const unsigned char* data = binary;
  cl_program program =
    clCreateProgramWithBinary(cl->context, 1, &cl->device, &size, &data, &loaded, &error);
  free(binary);
  if (error != CL_SUCCESS)
  {
    return NULL;
  }
  if (loaded != CL_SUCCESS ||
    clBuildProgram(program, 1, &cl->device, options, NULL, NULL) != CL_SUCCESS)
  {
    clReleaseProgram(program);
    return NULL;
  }
  return program;
}

static void mcor_store_program(const mcor_cl* cl, const mcor_cache_key* key, cl_program program)
{
  size_t size = 0;
  if (!cl->keeps_binaries ||
    clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, NULL) != CL_SUCCESS ||
    size == 0)
  {
    return;
  }
  unsigned char* binary = malloc(size);
  if (binary &&
    clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof binary, &binary, NULL) == CL_SUCCESS)
  {
    mcor_cache_store(key, binary, size);
  }
  free(binary);
}

static mcor_status mcor_build_program(mcor_context* context, mcor_program number)
{
  mcor_cl* cl = &context->cl;
  const char* sources[MCOR_SOURCE_LIMIT];
  const cl_uint count = (cl_uint)mcor_program_sources(cl, number, sources);
  char options[512], fault[1200];
  mcor_program_options(cl, number, options, sizeof options);
  MCOR_RETURN_IF(mcor_is_pocl(cl) && mcor_pocl_folder_fault(fault, sizeof fault), context,
    MCOR_DEVICE_ERROR, "%s", fault);
  const mcor_cache_key key = mcor_program_key(cl, sources, count, options);
  cl->programs[number] = mcor_load_program(cl, &key, options);
  if (cl->programs[number])
  {
    return MCOR_OK;
  }
  cl_int error;
  cl_program program = clCreateProgramWithSource(cl->context, count, sources, NULL, &error);
  MCOR_CL_TRY(context, error, "clCreateProgramWithSource");
  error = clBuildProgram(program, 1, &cl->device, options, NULL, NULL);
  if (error != CL_SUCCESS)
  {
    const mcor_status status = mcor_fail_build(context, program, error, options);
    clReleaseProgram(program);
    return status;
  }
  mcor_store_program(cl, &key, program);
  cl->programs[number] = program;
  return MCOR_OK;
}

static mcor_status mcor_need_program(mcor_context* context, mcor_program number)
{
  if (context->cl.programs[number])
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_report_building(context));
  const double begin = mcor_seconds();
  const mcor_status status = mcor_build_program(context, number);
  mcor_add_build_seconds(context, mcor_seconds() - begin);
  return status;
}

/* What the device's compiler has registers for; of the width that it claims where that does not
 * say. */
static mcor_status mcor_ask_lanes(mcor_context* context)
{
  mcor_cl* cl = &context->cl;
  cl_uint width = 1;
  cl_int error;
  size_t lanes[3] = { 1, 1, 1 };
  MCOR_TRY(mcor_need_program(context, MCOR_PROGRAM_LATTICE));
  cl_kernel kernel =
    clCreateKernel(cl->programs[MCOR_PROGRAM_LATTICE], "mcor_register_lanes", &error);
  MCOR_CL_TRY(context, error, "mcor_register_lanes");
  clGetKernelWorkGroupInfo(
    kernel, cl->device, CL_KERNEL_COMPILE_WORK_GROUP_SIZE, sizeof lanes, lanes, NULL);
  clReleaseKernel(kernel);
  clGetDeviceInfo(cl->device, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT, sizeof width, &width, NULL);
  cl->register_lanes = lanes[0] > 1 ? (int)lanes[0] : width >= 16 ? 16 : 8;
  return MCOR_OK;
}

/* Evaluation points that a work-item treats at once, MCOR_LANES of the programs. */
static mcor_status mcor_choose_lanes(mcor_context* context, mcor_type precision, int* lanes)
{
  mcor_cl* cl = &context->cl;
  const char* forced = getenv("MCOR_LANES"); /* for tests */
  if (forced && *forced)
  {
    const int number = atoi(forced);
    *lanes = number == 8 || number == 16 ? number : 1;
    return MCOR_OK;
  }
  if (cl->is_cpu && cl->register_lanes == 0)
  {
    MCOR_TRY(mcor_ask_lanes(context));
  }
  *lanes = !cl->is_cpu ? 1 : precision == MCOR_FLOAT64 ? 8 : cl->register_lanes;
  return MCOR_OK;
}

static bool mcor_same_build(const mcor_build* a, const mcor_build* b)
{
  return a->sph_kernel == b->sph_kernel && a->field == b->field && a->precision == b->precision &&
    a->solids == b->solids;
}

mcor_status mcor_choose_build(mcor_context* context, const mcor_build* build)
{
  mcor_cl* cl = &context->cl;
  int lanes;
  MCOR_TRY(mcor_choose_lanes(context, build->precision, &lanes));
  if (cl->lanes == lanes && mcor_same_build(&cl->build, build))
  {
    return MCOR_OK;
  }
  MCOR_RETURN_IF(build->precision == MCOR_FLOAT64 && !cl->has_fp64, context, MCOR_DEVICE_ERROR,
    "OpenCL device %s has no double precision; choose another device or single precision.",
    cl->device_name);
  mcor_drop_programs(cl, (cl->lanes == 1) != (lanes == 1));
  cl->lanes = lanes;
  cl->build = *build;
  cl->real_size = build->precision == MCOR_FLOAT64 ? sizeof(cl_double) : sizeof(cl_float);
  cl->fix_size = build->precision == MCOR_FLOAT64 ? sizeof(cl_long) : sizeof(cl_int);
  return MCOR_OK;
}

void mcor_release(mcor_context* context, mcor_buffer* buffer)
{
  if (buffer->mem)
  {
    clReleaseMemObject(buffer->mem);
    context->cl.bytes -= (int64_t)buffer->size;
  }
  buffer->mem = NULL;
  buffer->size = 0;
}

/* A CPU's buffers are the host's memory. */
static mcor_status mcor_enlarge_pages(mcor_context* context, const mcor_buffer* buffer)
{
  void* memory;
  if (!context->cl.is_cpu || buffer->size < MCOR_LARGE_ARRAY)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_map(context, buffer, buffer->size, true, &memory));
  mcor_use_large_pages(memory, buffer->size);
  return mcor_unmap(context, buffer, &memory);
}

mcor_status mcor_reserve(mcor_context* context, mcor_buffer* buffer, size_t bytes)
{
  mcor_cl* cl = &context->cl;
  const size_t size = (bytes + 255) / 256 * 256 + 256; /* never empty */
  if (buffer->mem && buffer->size >= bytes)
  {
    return MCOR_OK;
  }
  mcor_release(context, buffer);
  MCOR_RETURN_IF(size > cl->largest_buffer || (uint64_t)cl->bytes + size > cl->memory_limit,
    context, MCOR_OUT_OF_CAPACITY,
    "This would need a buffer of %.1f MiB besides %.1f MiB in use, but %.1f MiB of device %s may "
    "be "
    "used, %.1f MiB at most in one buffer. Use a larger cube size, fewer particles, or a higher "
    "memory limit where one is set.",
    ldexp((double)size, -20), ldexp((double)cl->bytes, -20), ldexp((double)cl->memory_limit, -20),
    cl->device_name, ldexp((double)cl->largest_buffer, -20));
  cl_int error;
  buffer->mem = clCreateBuffer(cl->context, CL_MEM_READ_WRITE, size, NULL, &error);
  if (error != CL_SUCCESS)
  {
    buffer->mem = NULL;
    return mcor_fail(context,
      mcor_is_no_memory(error) || error == CL_INVALID_BUFFER_SIZE ? MCOR_OUT_OF_CAPACITY
                                                                  : MCOR_DEVICE_ERROR,
      "Device %s could not allocate %.0f MB (%s). Use a larger cube size, or fewer particles.",
      cl->device_name, (double)size / 1e6, mcor_cl_error_name(error));
  }
  buffer->size = size;
  cl->bytes += (int64_t)size;
  cl->bytes_peak = cl->bytes > cl->bytes_peak ? cl->bytes : cl->bytes_peak;
  return mcor_enlarge_pages(context, buffer);
}

mcor_status mcor_write(mcor_context* context, mcor_buffer* buffer, const void* data, size_t bytes)
{
  MCOR_TRY(mcor_reserve(context, buffer, bytes));
  if (bytes > 0)
  {
    MCOR_CL_TRY(context,
      clEnqueueWriteBuffer(context->cl.queue, buffer->mem, CL_TRUE, 0, bytes, data, 0, NULL, NULL),
      "clEnqueueWriteBuffer");
  }
  return MCOR_OK;
}

mcor_status mcor_read(
  mcor_context* context, const mcor_buffer* buffer, size_t offset, void* data, size_t bytes)
{
  if (bytes > 0)
  {
    MCOR_CL_TRY(context,
      clEnqueueReadBuffer(
        context->cl.queue, buffer->mem, CL_TRUE, offset, bytes, data, 0, NULL, NULL),
      "clEnqueueReadBuffer");
  }
  return MCOR_OK;
}

mcor_status mcor_map(
  mcor_context* context, const mcor_buffer* buffer, size_t bytes, bool write, void** data)
{
  cl_int error;
  *data = clEnqueueMapBuffer(context->cl.queue, buffer->mem, CL_TRUE,
    write ? CL_MAP_WRITE_INVALIDATE_REGION : CL_MAP_READ, 0, bytes > 0 ? bytes : 1, 0, NULL, NULL,
    &error);
  if (error != CL_SUCCESS)
  {
    *data = NULL;
  }
  MCOR_CL_TRY(context, error, "clEnqueueMapBuffer");
  return MCOR_OK;
}

mcor_status mcor_unmap(mcor_context* context, const mcor_buffer* buffer, void** data)
{
  void* const mapped = *data;
  *data = NULL;
  if (mapped)
  {
    MCOR_CL_TRY(context,
      clEnqueueUnmapMemObject(context->cl.queue, buffer->mem, mapped, 0, NULL, NULL),
      "clEnqueueUnmapMemObject");
  }
  return MCOR_OK;
}

mcor_status mcor_fill(mcor_context* context, mcor_buffer* buffer, uint8_t byte, size_t bytes)
{
  return mcor_fill_range(context, buffer, byte, 0, bytes);
}

mcor_status mcor_fill_range(
  mcor_context* context, mcor_buffer* buffer, uint8_t byte, size_t first, size_t last)
{
  MCOR_TRY(mcor_reserve(context, buffer, last));
  if (last > first)
  {
    MCOR_CL_TRY(context,
      clEnqueueFillBuffer(
        context->cl.queue, buffer->mem, &byte, sizeof byte, first, last - first, 0, NULL, NULL),
      "clEnqueueFillBuffer");
  }
  return MCOR_OK;
}

mcor_status mcor_copy(
  mcor_context* context, const mcor_buffer* from, mcor_buffer* to, size_t to_offset, size_t bytes)
{
  if (bytes > 0)
  {
    MCOR_CL_TRY(context,
      clEnqueueCopyBuffer(
        context->cl.queue, from->mem, to->mem, 0, to_offset, bytes, 0, NULL, NULL),
      "clEnqueueCopyBuffer");
  }
  return MCOR_OK;
}

mcor_status mcor_extend(mcor_context* context, mcor_buffer* buffer, size_t old, size_t bytes)
{
  if (buffer->size >= bytes)
  {
    return MCOR_OK;
  }
  mcor_buffer bigger = { 0 };
  mcor_status status = mcor_reserve(context, &bigger, bytes);
  if (status == MCOR_OK)
  {
    status = mcor_copy(context, buffer, &bigger, 0, old);
  }
  mcor_release(context, status == MCOR_OK ? buffer : &bigger);
  if (status == MCOR_OK)
  {
    *buffer = bigger;
  }
  return status;
}

/* Whether a program has a kernel. Asking for one that it has not is an error, on which PoCL crashes
 * while POCL_DEBUG is set. */
static bool mcor_has_kernel(cl_program program, const char* name)
{
  size_t size = 0;
  clGetProgramInfo(program, CL_PROGRAM_KERNEL_NAMES, 0, NULL, &size);
  char* names = calloc(size + 1, 1);
  bool has = false;
  if (names && clGetProgramInfo(program, CL_PROGRAM_KERNEL_NAMES, size, names, NULL) == CL_SUCCESS)
  {
    for (const char* at = names; *at && !has; at += strspn(at, ";"))
    {
      const size_t length = strcspn(at, ";");
      has = length == strlen(name) && memcmp(at, name, length) == 0;
      at += length;
    }
  }
  free(names);
  return has;
}

/* Makes a kernel of the first program that has it. */
static mcor_status mcor_make_kernel(mcor_context* context, const char* name, mcor_kernel* kernel)
{
  mcor_cl* cl = &context->cl;
  cl_int error = CL_INVALID_KERNEL_NAME;
  *kernel = (mcor_kernel){ 0 };
  snprintf(kernel->name, sizeof kernel->name, "%s", name);
  for (int p = 0; p < MCOR_PROGRAM_COUNT && !kernel->kernel; ++p)
  {
    kernel->program = (mcor_program)p;
    if (!mcor_program_may_have(kernel->program, name))
    {
      continue;
    }
    MCOR_TRY(mcor_need_program(context, kernel->program));
    if (mcor_has_kernel(cl->programs[p], name))
    {
      kernel->kernel = clCreateKernel(cl->programs[p], name, &error);
      MCOR_CL_TRY(context, error, name);
    }
  }
  MCOR_CL_TRY(context, error, name);
  return MCOR_OK;
}

static mcor_status mcor_find_kernel(mcor_context* context, const char* name, mcor_kernel** kernel)
{
  mcor_cl* cl = &context->cl;
  for (int i = 0; i < cl->kernel_count; ++i)
  {
    if (strcmp(cl->kernels[i].name, name) == 0)
    {
      *kernel = &cl->kernels[i];
      return MCOR_OK;
    }
  }
  MCOR_RETURN_IF(cl->kernel_count == MCOR_KERNEL_LIMIT, context, MCOR_DEVICE_ERROR,
    "There is no room for kernel %s.", name);
  *kernel = &cl->kernels[cl->kernel_count];
  (*kernel)->part = 0;
  const mcor_status status = mcor_make_kernel(context, name, *kernel);
  cl->kernel_count += status == MCOR_OK;
  return status;
}

static cl_int mcor_set_arg(const mcor_cl* cl, cl_kernel kernel, cl_uint i, const mcor_arg* arg)
{
  const cl_int integer = arg->integer;
  const cl_float single = (cl_float)arg->real;
  const cl_double real = arg->real;
  switch (arg->kind)
  {
    case MCOR_ARG_BUFFER:
      return clSetKernelArg(kernel, i, sizeof(cl_mem), &arg->buffer->mem);
    case MCOR_ARG_INT:
      return clSetKernelArg(kernel, i, sizeof integer, &integer);
    default:
      return cl->real_size == sizeof single ? clSetKernelArg(kernel, i, sizeof single, &single)
                                            : clSetKernelArg(kernel, i, sizeof real, &real);
  }
}

/* A kernel that was at hand takes less. */
#define MCOR_COMPILE_SECONDS 0.01

/* Launches a kernel for the first time, alone: drivers may compile it only now. What the kernel
 * itself does not take is building. */
static cl_int mcor_enqueue_first(
  mcor_context* context, cl_kernel kernel, const size_t* global, const size_t* group)
{
  mcor_cl* cl = &context->cl;
  cl_event event;
  cl_ulong start = 0, end = 0;
  cl_int error = clFinish(cl->queue);
  const double begin = mcor_seconds();
  if (error == CL_SUCCESS)
  {
    error =
      clEnqueueNDRangeKernel(cl->timed_queue, kernel, 1, NULL, global, group, 0, NULL, &event);
  }
  if (error != CL_SUCCESS)
  {
    return error;
  }
  error = clFinish(cl->timed_queue);
  const double seconds = mcor_seconds() - begin;
  if (error == CL_SUCCESS &&
    clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof start, &start, NULL) ==
      CL_SUCCESS &&
    clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, NULL) == CL_SUCCESS)
  {
    const double building = fmax(seconds - 1e-9 * (double)(end - start), 0);
    mcor_add_build_seconds(context, building);
    cl->compiles = building > MCOR_COMPILE_SECONDS;
  }
  clReleaseEvent(event);
  return error;
}

/* Drivers of GPUs end a launch that takes seconds: a heavy one is cut into parts, each to take about
 * so long, as far as single work-items allow. */
#define MCOR_PART_SECONDS 0.1
#define MCOR_FIRST_PART 65536

/* Launches the work-items from `offset` on. */
static cl_int mcor_enqueue_parts(
  mcor_cl* cl, mcor_kernel* kernel, size_t offset, size_t global, size_t group)
{
  cl_int error = global - offset > kernel->part ? clFinish(cl->queue) : CL_SUCCESS;
  while (offset < global && error == CL_SUCCESS)
  {
    const size_t rest = global - offset, part = rest < kernel->part ? rest : kernel->part;
    const double begin = mcor_seconds();
    error =
      clEnqueueNDRangeKernel(cl->queue, kernel->kernel, 1, &offset, &part, &group, 0, NULL, NULL);
    offset += part;
    if (offset < global && error == CL_SUCCESS)
    {
      error = clFinish(cl->queue);
      const double seconds = mcor_seconds() - begin;
      const size_t half = part / 2 / group * group;
      kernel->part = seconds < MCOR_PART_SECONDS / 2  ? 2 * part
        : seconds > 2 * MCOR_PART_SECONDS && half > 0 ? half
                                                      : part;
    }
  }
  return error;
}

/* From so many work-groups on, PoCL compiles a kernel once more. */
#define MCOR_LARGE_LAUNCH 65535

mcor_status mcor_launch(mcor_context* context, const char* name, mcor_load load, size_t items,
  const mcor_arg* args, size_t arg_count)
{
  mcor_cl* cl = &context->cl;
  if (items == 0)
  {
    return MCOR_OK;
  }
  mcor_kernel* kernel = NULL;
  MCOR_TRY(mcor_find_kernel(context, name, &kernel));
  cl_uint wanted = 0;
  clGetKernelInfo(kernel->kernel, CL_KERNEL_NUM_ARGS, sizeof wanted, &wanted, NULL);
  MCOR_RETURN_IF(arg_count != wanted, context, MCOR_DEVICE_ERROR,
    "Kernel %s has %u arguments; %zu were given.", name, (unsigned)wanted, arg_count);
  for (size_t i = 0; i < arg_count; ++i)
  {
    MCOR_CL_TRY(context, mcor_set_arg(cl, kernel->kernel, (cl_uint)i, args + i), name);
  }
  const size_t group = cl->is_cpu && load != MCOR_LIGHT ? 1 : 64;
  const size_t global = (items + group - 1) / group * group;
  const bool large = global / group >= MCOR_LARGE_LAUNCH;
  if (!kernel->launched[large] && cl->compiles)
  {
    MCOR_TRY(mcor_report_building(context));
  }
  const bool in_parts = !cl->is_cpu && load == MCOR_HEAVY;
  if (!in_parts || kernel->part == 0)
  {
    kernel->part = in_parts ? MCOR_FIRST_PART : global;
  }
  size_t launched = 0;
  if (!kernel->launched[large])
  {
    launched = global < kernel->part ? global : kernel->part;
    MCOR_CL_TRY(context, mcor_enqueue_first(context, kernel->kernel, &launched, &group), name);
    kernel->launched[large] = true;
  }
  MCOR_CL_TRY(context, mcor_enqueue_parts(cl, kernel, launched, global, group), name);
  return MCOR_OK;
}

mcor_status mcor_finish(mcor_context* context)
{
  MCOR_CL_TRY(context, clFinish(context->cl.queue), "clFinish");
  return MCOR_OK;
}
