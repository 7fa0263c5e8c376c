/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Chooses the OpenCL device, and finds what it can do. */

#include "mcor_cl_call.h"
#include "mcor_program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_PLATFORM_LIMIT 16
#define MCOR_DEVICE_LIMIT 64

typedef struct mcor_device_list
{
  int count;
  bool drivers_fail; /* drivers were not listed, because they would end the process */
  struct mcor_listed
  {
    cl_platform_id platform;
    cl_device_id device;
    char device_name[128], platform_name[128];
  } of[MCOR_DEVICE_LIMIT];
} mcor_device_list;

/* Lists the devices, the built-in one first. drivers: also lists devices of drivers, unless listing
 * them would end the process, as PoCL does if it cannot start its threads. */
static void mcor_find_devices(mcor_device_list* list, bool drivers)
{
  cl_platform_id platforms[MCOR_PLATFORM_LIMIT] = { mcor_native_platform() };
  cl_device_id devices[MCOR_DEVICE_LIMIT];
  cl_uint platform_count = platforms[0] != NULL, found;
  list->count = 0;
  list->drivers_fail = drivers && !mcor_system_bears_drivers();
  if (drivers && !list->drivers_fail)
  {
    platform_count = mcor_list_platforms(MCOR_PLATFORM_LIMIT, platforms);
  }
  for (cl_uint p = 0; p < platform_count && list->count < MCOR_DEVICE_LIMIT; ++p)
  {
    const cl_uint room = (cl_uint)(MCOR_DEVICE_LIMIT - list->count);
    if (clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, room, devices, &found) != CL_SUCCESS)
    {
      continue;
    }
    for (cl_uint d = 0; d < found && d < room; ++d)
    {
      struct mcor_listed* listed = &list->of[list->count++];
      *listed = (struct mcor_listed){ .platform = platforms[p], .device = devices[d] };
      clGetDeviceInfo(
        devices[d], CL_DEVICE_NAME, sizeof listed->device_name, listed->device_name, NULL);
      clGetPlatformInfo(
        platforms[p], CL_PLATFORM_NAME, sizeof listed->platform_name, listed->platform_name, NULL);
    }
  }
}

/* Writes the devices' numbers and names into `text`, and stops when it is full. */
static void mcor_write_devices(
  const mcor_device_list* list, const char* separator, char* text, size_t room)
{
  size_t length = 0;
  text[0] = '\0';
  for (int i = 0; i < list->count && length < room; ++i)
  {
    const char *device = list->of[i].device_name, *platform = list->of[i].platform_name;
    const bool same =
      strncmp(device, platform, strlen(platform)) == 0; /* true for the built-in device */
    length += (size_t)snprintf(text + length, room - length, "%s%d: %s%s%s%s",
      i > 0 ? separator : "", i, device, same ? "" : " (", same ? "" : platform, same ? "" : ")");
  }
}

mcor_status mcor_list_devices(char** text)
{
  if (!text)
  {
    return MCOR_INVALID_ARGUMENT;
  }
  mcor_device_list list;
  mcor_find_devices(&list, true);
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

/* Returns the list index of the device that the user named; -1: there is none. wanted: the index or
 * a part of the name of the device or its platform. *by_number: whether `wanted` is a number. */
static int mcor_find_device(const mcor_device_list* list, const char* wanted, bool* by_number)
{
  char* end = NULL;
  const long number = strtol(wanted, &end, 10);
  *by_number = *end == '\0';
  if (*by_number)
  {
    return number >= 0 && number < list->count ? (int)number : -1;
  }
  int i = 0;
  while (i < list->count && !mcor_contains(list->of[i].device_name, wanted) &&
    !mcor_contains(list->of[i].platform_name, wanted) &&
    !(mcor_contains("pocl", wanted) && mcor_is_pocl(list->of[i].platform_name)))
  {
    ++i;
  }
  return i < list->count ? i : -1;
}

static cl_device_type mcor_type_of(cl_device_id device)
{
  cl_device_type type = 0;
  clGetDeviceInfo(device, CL_DEVICE_TYPE, sizeof type, &type, NULL);
  return type & ~(cl_device_type)CL_DEVICE_TYPE_DEFAULT;
}

static void mcor_query_device(mcor_cl* cl)
{
  cl_uint units = 1;
  cl_bool unified = CL_FALSE;
  cl_device_fp_config fp32 = 0, fp64 = 0;
  clGetDeviceInfo(cl->device, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
  clGetDeviceInfo(cl->device, CL_DEVICE_SINGLE_FP_CONFIG, sizeof fp32, &fp32, NULL);
  clGetDeviceInfo(cl->device, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof fp64, &fp64, NULL);
  clGetDeviceInfo(
    cl->device, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof cl->device_memory, &cl->device_memory, NULL);
  cl->memory_limit = cl->device_memory;
  clGetDeviceInfo(
    cl->device, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof cl->largest_buffer, &cl->largest_buffer, NULL);
  clGetDeviceInfo(cl->device, CL_DEVICE_HOST_UNIFIED_MEMORY, sizeof unified, &unified, NULL);
  /* The kernels' form for CPUs suits CPUs with vectors. A device without vectors that claims to be
   * a CPU gets the form for GPUs, in which a work-item treats one point. The variable
   * MCOR_DEVICE_FORM, cpu or gpu, is for tests. */
  const char* forced = mcor_test_setting("MCOR_DEVICE_FORM");
  const bool claims_cpu = (mcor_type_of(cl->device) & CL_DEVICE_TYPE_CPU) != 0;
  clGetDeviceInfo(
    cl->device, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT, sizeof cl->width, &cl->width, NULL);
  cl->is_cpu = forced && *forced ? strcmp(forced, "gpu") != 0 : claims_cpu && cl->width > 1;
  /* Builds large programs where small ones save nothing: with PoCL, which reads its long headers
   * anew for each program, one program at a time, and compiles kernels when they are launched; and
   * on the built-in device, which compiles nothing. */
  cl->builds_sets = cl->is_cpu && (mcor_is_native(cl) || mcor_is_pocl(cl->platform_name));
  /* A CPU with the form for GPUs counts as a device with memory of its own, so that tests reach the
   * code for such devices, too. */
  cl->is_apart = !cl->is_cpu && (!unified || claims_cpu);
  cl->has_fp64 = fp64 != 0;
  cl->rounds_division = (fp32 & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
  cl->units = (int)units;
}

/* Distributes `count` processes over the devices with the platform and type of device `chosen`.
 * Returns the list index of the device for process *place. *count becomes the number of processes
 * on this device, and *place the number of this process among them. */
static int mcor_take_turn(const mcor_device_list* list, int chosen, int* place, int* count)
{
  int like[MCOR_DEVICE_LIMIT], n = 0;
  for (int i = 0; i < list->count; ++i)
  {
    if (list->of[i].platform == list->of[chosen].platform &&
      mcor_type_of(list->of[i].device) == mcor_type_of(list->of[chosen].device))
    {
      like[n++] = i;
    }
  }
  const int turn = *place % n;
  *count = (*count - turn + n - 1) / n;
  *place = *place / n;
  return like[turn];
}

/* Divides a CPU among `count` processes, of which this one is number `place`. If the driver cannot
 * divide the CPU, each process uses all of it. Does not divide the built-in device; its pool has
 * fewer threads instead. */
static void mcor_take_share(mcor_cl* cl, int place, int count)
{
  cl_uint units = 1, parts = 0;
  clGetDeviceInfo(cl->device, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
  const cl_uint wanted = (cl_uint)mcor_processors(count);
  const cl_device_partition_property equally[] = { CL_DEVICE_PARTITION_EQUALLY, wanted, 0 };
  if (count < 2 || mcor_is_native(cl) || !(mcor_type_of(cl->device) & CL_DEVICE_TYPE_CPU) ||
    wanted >= units || clCreateSubDevices(cl->device, equally, 0, NULL, &parts) != CL_SUCCESS ||
    parts == 0)
  {
    return;
  }
  cl_device_id* made = calloc(parts, sizeof *made);
  if (made && clCreateSubDevices(cl->device, equally, parts, made, NULL) == CL_SUCCESS)
  {
    const cl_uint own = (cl_uint)place % parts;
    for (cl_uint i = 0; i < parts; ++i)
    {
      if (i != own)
      {
        clReleaseDevice(made[i]);
      }
    }
    cl->device = cl->share = made[own];
  }
  free(made);
}

/* Whether a device has what a build needs. The built-in device has only the kernels that were
 * compiled with this library. */
static bool mcor_can_build(cl_platform_id platform, cl_device_id device, const mcor_build* build)
{
  mcor_cl tried = { .platform = platform, .device = device };
  mcor_query_device(&tried);
  return mcor_is_native(&tried) ? mcor_has_ahead(&tried, build)
                                : build->precision == MCOR_FLOAT32 || tried.has_fp64;
}

/* The build that a call with the default options needs. */
static const mcor_build mcor_usual_build = { 0 };

/* Returns the index of the best device that can do a build: the built-in one, which starts at once,
 * then a GPU, then PoCL, then any other; -1: none. */
static int mcor_choose_device(const mcor_device_list* list, const mcor_build* build)
{
  int best = -1, best_rank = 0;
  for (int i = 0; i < list->count; ++i)
  {
    const struct mcor_listed* listed = &list->of[i];
    const int rank = listed->platform == mcor_native_platform()  ? 4
      : (mcor_type_of(listed->device) & CL_DEVICE_TYPE_GPU) != 0 ? 3
      : mcor_is_pocl(listed->platform_name)                      ? 2
                                                                 : 1;
    if (rank > best_rank && mcor_can_build(listed->platform, listed->device, build))
    {
      best = i;
      best_rank = rank;
    }
  }
  return best;
}

static mcor_status mcor_start_device(
  mcor_context* context, const mcor_device_list* list, int chosen, int place, int count)
{
  mcor_cl* cl = &context->cl;
  cl->platform = list->of[chosen].platform;
  cl->device = list->of[chosen].device;
  cl->device_number = chosen;
  memcpy(cl->device_name, list->of[chosen].device_name, sizeof cl->device_name);
  memcpy(cl->platform_name, list->of[chosen].platform_name, sizeof cl->platform_name);
  mcor_take_share(cl, place, count);
  mcor_query_device(cl);
  cl_int error;
  cl->context = clCreateContext(NULL, 1, &cl->device, NULL, NULL, &error);
  MCOR_CL_TRY(context, error, "clCreateContext");
  if (mcor_is_native(cl))
  {
    const int share = mcor_processors(count);
    cl->pool = mcor_native_pool(cl->context);
    cl->units = cl->pool->threads = share < cl->units ? share : cl->units;
  }
  const bool is_small = cl->is_cpu && cl->units < MCOR_SEGMENT_LIMIT / 8;
  cl->segments = is_small ? cl->units * 8 : MCOR_SEGMENT_LIMIT;
  cl->queue = clCreateCommandQueue(
    cl->context, cl->device, cl->profile ? CL_QUEUE_PROFILING_ENABLE : 0, &error);
  MCOR_CL_TRY(context, error, "clCreateCommandQueue");
  cl->timed_queue =
    clCreateCommandQueue(cl->context, cl->device, CL_QUEUE_PROFILING_ENABLE, &error);
  MCOR_CL_TRY(context, error, "clCreateCommandQueue");
  return MCOR_OK;
}

/* Returns a sentence, to follow another sentence, about drivers that were not listed; "" if all
 * were listed. */
static const char* mcor_driver_fault(const mcor_device_list* list)
{
  return list->drivers_fail
    ? " OpenCL drivers were not listed, as they would end the process: it may not start as many "
      "threads as there are processors, or has too little address space. Raise these limits "
      "(ulimit -u, ulimit -v), or use the built-in device."
    : "";
}

static mcor_status mcor_fail_without_device(
  mcor_context* context, const mcor_device_list* list, const mcor_build* build)
{
  mcor_build single = *build;
  single.precision = MCOR_FLOAT32;
  char missing[MCOR_BUILD_NAME];
  mcor_name_build(build, missing, sizeof missing);
  MCOR_FAIL_IF(mcor_choose_device(list, &mcor_usual_build) >= 0, context, MCOR_DEVICE_ERROR,
    MCOR_SAY(NO_KERNELS), missing,
    mcor_choose_device(list, &single) >= 0 ? "Choose {precision single}, install" : "Install",
    MCOR_POCL_HINT, mcor_driver_fault(list));
  return mcor_fail(
    context, MCOR_DEVICE_ERROR, MCOR_SAY(NO_DEVICE), MCOR_POCL_HINT, mcor_driver_fault(list));
}

/* Starts the best device for a build; called if the user named no device. Sets cl->is_replaced:
 * whether a call with the default options would have taken another device. */
static mcor_status mcor_start_default(
  mcor_context* context, const mcor_device_list* list, const mcor_build* build)
{
  mcor_cl* cl = &context->cl;
  const int best = mcor_choose_device(list, &mcor_usual_build),
            chosen = mcor_choose_device(list, build);
  if (chosen < 0)
  {
    return mcor_fail_without_device(context, list, build);
  }
  int place = cl->place, count = cl->count;
  cl->is_replaced = chosen != best;
  const int own = mcor_take_turn(list, chosen, &place, &count);
  return mcor_start_device(context, list, own, place, count);
}

mcor_status mcor_open_device(mcor_context* context, const char* device, int place, int count)
{
  mcor_cl* cl = &context->cl;
  const char* wanted = device && *device ? device : getenv("MCOR_DEVICE");
  mcor_device_list list;
  bool by_number = false;
  MCOR_TRY(mcor_open_profile(context));
  cl->place = place;
  cl->count = count;
  cl->is_default = !wanted || !*wanted;
  int chosen = -1;
  /* Looks for drivers last, because they take a while to start. */
  for (int drivers = 0; drivers < 2 && chosen < 0; ++drivers)
  {
    mcor_find_devices(&list, drivers);
    chosen = cl->is_default ? mcor_choose_device(&list, &mcor_usual_build)
                            : mcor_find_device(&list, wanted, &by_number);
  }
  if (cl->is_default)
  {
    return mcor_start_default(context, &list, &mcor_usual_build);
  }
  if (chosen < 0)
  {
    char devices[300];
    mcor_write_devices(&list, ", ", devices, sizeof devices);
    return mcor_fail(context, MCOR_DEVICE_ERROR, MCOR_SAY(NO_SUCH_DEVICE), wanted, devices,
      mcor_driver_fault(&list));
  }
  const int own = by_number ? chosen : mcor_take_turn(&list, chosen, &place, &count);
  return mcor_start_device(context, &list, own, place, count);
}

void mcor_close_device(mcor_context* context)
{
  mcor_cl* cl = &context->cl;
  mcor_drop_programs(cl, MCOR_PARTS_ALL);
  free(cl->kernels);
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
  if (cl->share)
  {
    clReleaseDevice(cl->share);
  }
}

mcor_status mcor_settle_device(
  mcor_context* context, const mcor_build* build, void (*release)(mcor_context* context))
{
  mcor_cl* cl = &context->cl;
  const mcor_cl before = *cl;
  const bool is_open = cl->timed_queue != NULL; /* false if the last change of devices failed */
  if (!cl->is_default ||
    (is_open && !cl->is_replaced && mcor_can_build(cl->platform, cl->device, build)))
  {
    return MCOR_OK;
  }
  mcor_device_list list;
  mcor_find_devices(&list, true);
  const int chosen = mcor_choose_device(&list, build);
  if (chosen < 0)
  {
    return mcor_fail_without_device(context, &list, build);
  }
  if (is_open && list.of[chosen].platform == cl->platform)
  {
    return MCOR_OK;
  }
  release(context);
  mcor_close_device(context);
  *cl = (mcor_cl){ .is_default = true,
    .place = before.place,
    .count = before.count,
    .observer = before.observer,
    .profile = before.profile };
  const mcor_status status = mcor_start_default(context, &list, build);
  cl->memory_limit = status != MCOR_OK || before.memory_limit < cl->device_memory
    ? before.memory_limit
    : cl->device_memory;
  return status;
}
