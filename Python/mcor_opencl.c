/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* OpenCL found at run time, for the Python wheel: the functions that the core calls, without a
 * library to link with. Platforms are those of the system's loader; where there is no loader, those
 * of the drivers in the vendors' folder; and where these give no device, that of the driver that the
 * wheel's extra brings. Every object of an OpenCL driver begins with a table of its functions
 * (extension cl_khr_icd), which is all that calling them takes. */

#ifndef _DEFAULT_SOURCE
#define _DEFAULT_SOURCE /* for scandir */
#endif

#include <CL/cl_icd.h>

#include <dirent.h>
#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mcor_opencl.h"

#define MCOR_PLATFORM_LIMIT 16
#define MCOR_PATH_LIMIT 4096

/* clGetPlatformIDs; headers differ in the name of its type. */
typedef cl_int(CL_API_CALL* mcor_list_platforms)(cl_uint, cl_platform_id*, cl_uint*);

static char mcor_own_driver[MCOR_PATH_LIMIT];
static cl_platform_id mcor_platforms[MCOR_PLATFORM_LIMIT];
static cl_uint mcor_platform_count;
static pthread_once_t mcor_platforms_found = PTHREAD_ONCE_INIT;
static pthread_mutex_t mcor_own_lock = PTHREAD_MUTEX_INITIALIZER;
static int mcor_own_loaded;

static const cl_icd_dispatch* mcor_table(const void* object)
{
  return *(const cl_icd_dispatch* const*)object;
}

static void mcor_add_platforms(mcor_list_platforms list)
{
  cl_uint found = 0;
  const cl_uint room = MCOR_PLATFORM_LIMIT - mcor_platform_count;
  if (room > 0 && list(room, mcor_platforms + mcor_platform_count, &found) == CL_SUCCESS)
  {
    mcor_platform_count += found < room ? found : room;
  }
}

/* A driver's library. It stays open: drivers do not bear being closed. */
static void mcor_add_driver(const char* path)
{
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  void* (*function_of)(const char*) = NULL;
  mcor_list_platforms list = NULL;
  if (library)
  {
    *(void**)&function_of = dlsym(library, "clGetExtensionFunctionAddress");
  }
  if (function_of)
  {
    *(void**)&list = function_of("clIcdGetPlatformIDsKHR");
  }
  if (list)
  {
    mcor_add_platforms(list);
  }
}

static int mcor_is_icd(const struct dirent* entry)
{
  const char* ending = strrchr(entry->d_name, '.');
  return ending && strcmp(ending, ".icd") == 0;
}

/* Each file in the folder has a driver's path on its first line. */
static void mcor_add_vendors(void)
{
  const char* own = getenv("OCL_ICD_VENDORS");
  const char* folder = own && *own ? own : "/etc/OpenCL/vendors";
  struct dirent** entries = NULL;
  const int count = scandir(folder, &entries, mcor_is_icd, alphasort);
  for (int i = 0; i < count; ++i)
  {
    char path[MCOR_PATH_LIMIT];
    snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
    free(entries[i]);
    FILE* file = fopen(path, "r");
    if (file && fgets(path, sizeof path, file))
    {
      path[strcspn(path, "\r\n")] = '\0';
      mcor_add_driver(path);
    }
    if (file)
    {
      fclose(file);
    }
  }
  free(entries);
}

static int mcor_has_device(void)
{
  for (cl_uint p = 0; p < mcor_platform_count; ++p)
  {
    cl_uint count = 0;
    if (mcor_table(mcor_platforms[p])
          ->clGetDeviceIDs(mcor_platforms[p], CL_DEVICE_TYPE_ALL, 0, NULL, &count) == CL_SUCCESS &&
      count > 0)
    {
      return 1;
    }
  }
  return 0;
}

static void mcor_find_platforms(void)
{
  mcor_list_platforms list = NULL;
  void* loader = dlopen("libOpenCL.so.1", RTLD_NOW | RTLD_LOCAL);
  if (loader)
  {
    *(void**)&list = dlsym(loader, "clGetPlatformIDs");
  }
  if (list)
  {
    mcor_add_platforms(list);
  }
  else
  {
    mcor_add_vendors();
  }
  /* Of a process that one with a driver of its own has started. */
  const char* inherited = getenv("MCOR_OPENCL_DRIVER");
  if (inherited && *inherited)
  {
    mcor_own_loaded = 1;
    mcor_add_driver(inherited);
  }
}

void mcor_opencl_set_driver(const char* path)
{
  pthread_mutex_lock(&mcor_own_lock);
  snprintf(mcor_own_driver, sizeof mcor_own_driver, "%s", path ? path : "");
  pthread_mutex_unlock(&mcor_own_lock);
}

int mcor_opencl_use_driver(int always)
{
  pthread_once(&mcor_platforms_found, mcor_find_platforms);
  pthread_mutex_lock(&mcor_own_lock);
  if (!mcor_own_loaded && mcor_own_driver[0] && (always || !mcor_has_device()))
  {
    mcor_own_loaded = 1;
    mcor_add_driver(mcor_own_driver);
  }
  const int loaded = mcor_own_loaded;
  pthread_mutex_unlock(&mcor_own_lock);
  return loaded;
}

CL_API_ENTRY cl_int CL_API_CALL clGetPlatformIDs(
  cl_uint room, cl_platform_id* platforms, cl_uint* count)
{
  mcor_opencl_use_driver(0);
  for (cl_uint p = 0; platforms && p < room && p < mcor_platform_count; ++p)
  {
    platforms[p] = mcor_platforms[p];
  }
  if (count)
  {
    *count = mcor_platform_count;
  }
  return mcor_platform_count > 0 ? CL_SUCCESS : CL_PLATFORM_NOT_FOUND_KHR;
}

/* The rest is handed on. FORWARD: of a function whose first argument is an object. */
#define FORWARD(result, name, declared, passed, object)                                            \
  CL_API_ENTRY result CL_API_CALL name declared                                                    \
  {                                                                                                \
    return mcor_table(object)->name passed;                                                        \
  }

/* A function a line reads best here. */
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
FORWARD(cl_int, clFlush, (cl_command_queue o), (o), o)
FORWARD(cl_mem, clCreateBuffer, (cl_context o, cl_mem_flags f, size_t n, void* h, cl_int* e), (o, f, n, h, e), o)
FORWARD(cl_int, clReleaseMemObject, (cl_mem o), (o), o)
FORWARD(cl_int, clEnqueueReadBuffer, (cl_command_queue o, cl_mem m, cl_bool b, size_t s, size_t n, void* h, cl_uint c, const cl_event* w, cl_event* e), (o, m, b, s, n, h, c, w, e), o)
FORWARD(cl_int, clEnqueueWriteBuffer, (cl_command_queue o, cl_mem m, cl_bool b, size_t s, size_t n, const void* h, cl_uint c, const cl_event* w, cl_event* e), (o, m, b, s, n, h, c, w, e), o)
FORWARD(cl_int, clEnqueueCopyBuffer, (cl_command_queue o, cl_mem f, cl_mem t, size_t x, size_t y, size_t n, cl_uint c, const cl_event* w, cl_event* e), (o, f, t, x, y, n, c, w, e), o)
FORWARD(cl_int, clEnqueueFillBuffer, (cl_command_queue o, cl_mem m, const void* p, size_t k, size_t s, size_t n, cl_uint c, const cl_event* w, cl_event* e), (o, m, p, k, s, n, c, w, e), o)
FORWARD(void*, clEnqueueMapBuffer, (cl_command_queue o, cl_mem m, cl_bool b, cl_map_flags f, size_t s, size_t n, cl_uint c, const cl_event* w, cl_event* e, cl_int* r), (o, m, b, f, s, n, c, w, e, r), o)
FORWARD(cl_int, clEnqueueUnmapMemObject, (cl_command_queue o, cl_mem m, void* p, cl_uint c, const cl_event* w, cl_event* e), (o, m, p, c, w, e), o)
FORWARD(cl_int, clEnqueueNDRangeKernel, (cl_command_queue o, cl_kernel k, cl_uint d, const size_t* s, const size_t* g, const size_t* l, cl_uint c, const cl_event* w, cl_event* e), (o, k, d, s, g, l, c, w, e), o)
FORWARD(cl_program, clCreateProgramWithSource, (cl_context o, cl_uint n, const char** s, const size_t* l, cl_int* e), (o, n, s, l, e), o)
FORWARD(cl_program, clCreateProgramWithBinary, (cl_context o, cl_uint n, const cl_device_id* d, const size_t* l, const unsigned char** b, cl_int* s, cl_int* e), (o, n, d, l, b, s, e), o)
FORWARD(cl_int, clReleaseProgram, (cl_program o), (o), o)
FORWARD(cl_int, clBuildProgram, (cl_program o, cl_uint n, const cl_device_id* d, const char* t, void (CL_CALLBACK* f)(cl_program, void*), void* u), (o, n, d, t, f, u), o)
FORWARD(cl_int, clGetProgramInfo, (cl_program o, cl_program_info w, size_t n, void* v, size_t* r), (o, w, n, v, r), o)
FORWARD(cl_int, clGetProgramBuildInfo, (cl_program o, cl_device_id d, cl_program_build_info w, size_t n, void* v, size_t* r), (o, d, w, n, v, r), o)
FORWARD(cl_kernel, clCreateKernel, (cl_program o, const char* n, cl_int* e), (o, n, e), o)
FORWARD(cl_int, clReleaseKernel, (cl_kernel o), (o), o)
FORWARD(cl_int, clSetKernelArg, (cl_kernel o, cl_uint i, size_t n, const void* v), (o, i, n, v), o)
FORWARD(cl_int, clGetKernelArgInfo, (cl_kernel o, cl_uint i, cl_kernel_arg_info w, size_t n, void* v, size_t* r), (o, i, w, n, v, r), o)
FORWARD(cl_int, clGetKernelInfo, (cl_kernel o, cl_kernel_info w, size_t n, void* v, size_t* r), (o, w, n, v, r), o)
FORWARD(cl_int, clGetKernelWorkGroupInfo, (cl_kernel o, cl_device_id d, cl_kernel_work_group_info w, size_t n, void* v, size_t* r), (o, d, w, n, v, r), o)
FORWARD(cl_int, clGetEventProfilingInfo, (cl_event o, cl_profiling_info w, size_t n, void* v, size_t* r), (o, w, n, v, r), o)
FORWARD(cl_int, clReleaseEvent, (cl_event o), (o), o)
/* clang-format on */
