/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Whether CUDA's memory can become an OpenCL buffer of the same card without a copy: CUDA exports
 * memory as a file descriptor, cl_khr_external_memory_opaque_fd imports it. Decides whether arrays of
 * CuPy or PyTorch could reach the kernels by one copy on the card. Its second half has not run on a
 * card yet. Both drivers are found at run time; of several cards it takes CUDA's first.
 *
 *   cc Examples/Benchmark/cuda_memory.c -ldl -o cuda_memory && ./cuda_memory
 *
 * Status 0: yes; 1: no, the last line says why. */

#define CL_TARGET_OPENCL_VERSION 300
#include <CL/cl.h>

#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* CUmemAllocationProp and CUmemAccessDesc of cuda.h. */
typedef struct cuda_place
{
  int type, id; /* 1: a device */
} cuda_place;

typedef struct cuda_properties
{
  int type, handle_types; /* type 1: pinned to the place; handle_types 1: a file descriptor */
  cuda_place place;
  void* win32;
  unsigned char compressible, direct_access;
  unsigned short usage;
  unsigned char reserved[4];
} cuda_properties;

typedef struct cuda_access
{
  cuda_place place;
  int flags; /* 3: read and write */
} cuda_access;

#ifndef CL_EXTERNAL_MEMORY_HANDLE_OPAQUE_FD_KHR
#define CL_EXTERNAL_MEMORY_HANDLE_OPAQUE_FD_KHR 0x2060
#endif

static int no(const char* what, int error)
{
  printf("no: %s (%d)\n", what, error);
  return 1;
}

/* Finds a function of a library, and calls it. Returns the function's error, or -1 if it is
 * missing. */
#define CALL(library, name, parameters, ...)                                                       \
  (dlsym(library, name) ? ((int(*) parameters)dlsym(library, name))(__VA_ARGS__) : -1)
#define TRY(library, name, parameters, ...)                                                        \
  do                                                                                               \
  {                                                                                                \
    const int error = CALL(library, name, parameters, __VA_ARGS__);                                \
    if (error != 0)                                                                                \
      return no(name, error);                                                                      \
  } while (0)
/* The type of an OpenCL function, which the headers declare. */
#define CL(name) ((__typeof__(&name))dlsym(opencl, #name))

/* Prints all devices and what they import. Returns the first that imports file descriptors. */
static cl_device_id find_device(void* opencl)
{
  cl_platform_id platforms[16];
  cl_device_id devices[16], found = NULL;
  cl_uint platform_count = 0, count;
  CL(clGetPlatformIDs)(16, platforms, &platform_count);
  for (cl_uint p = 0; p < platform_count && p < 16; ++p)
  {
    count = 0;
    CL(clGetDeviceIDs)(platforms[p], CL_DEVICE_TYPE_ALL, 16, devices, &count);
    for (cl_uint d = 0; d < count && d < 16; ++d)
    {
      static char name[256], extensions[16384];
      CL(clGetDeviceInfo)(devices[d], CL_DEVICE_NAME, sizeof name, name, NULL);
      CL(clGetDeviceInfo)(devices[d], CL_DEVICE_EXTENSIONS, sizeof extensions, extensions, NULL);
      const int imports = strstr(extensions, "cl_khr_external_memory_opaque_fd") != NULL;
      printf("%s: cl_khr_external_memory_opaque_fd %s\n", name, imports ? "yes" : "no");
      found = imports && !found ? devices[d] : found;
    }
  }
  return found;
}

/* Makes CUDA memory that holds a pattern, and exports it. */
static int export_memory(void* cuda, const uint32_t* pattern, size_t* size, int* descriptor)
{
  const cuda_properties wanted = { .type = 1, .handle_types = 1, .place = { 1, 0 } };
  const cuda_access access = { .place = { 1, 0 }, .flags = 3 };
  void* context = NULL;
  size_t step = 0;
  unsigned long long memory = 0, address = 0;
  TRY(cuda, "cuDevicePrimaryCtxRetain", (void**, int), &context, 0);
  TRY(cuda, "cuCtxSetCurrent", (void*), context);
  TRY(cuda, "cuMemGetAllocationGranularity", (size_t*, const cuda_properties*, int), &step, &wanted, 0);
  *size = (*size + step - 1) / step * step;
  TRY(cuda, "cuMemCreate", (unsigned long long*, size_t, const cuda_properties*, unsigned long long),
    &memory, *size, &wanted, 0);
  TRY(cuda, "cuMemAddressReserve",
    (unsigned long long*, size_t, size_t, unsigned long long, unsigned long long), &address, *size, 0, 0, 0);
  TRY(cuda, "cuMemMap", (unsigned long long, size_t, size_t, unsigned long long, unsigned long long),
    address, *size, 0, memory, 0);
  TRY(cuda, "cuMemSetAccess", (unsigned long long, size_t, const cuda_access*, size_t), address, *size,
    &access, 1);
  TRY(cuda, "cuMemcpyHtoD_v2", (unsigned long long, const void*, size_t), address, pattern, 4096);
  TRY(cuda, "cuMemExportToShareableHandle", (void*, unsigned long long, int, unsigned long long),
    descriptor, memory, 1, 0);
  return 0;
}

int main(void)
{
  uint32_t pattern[1024], seen[1024] = { 0 };
  size_t size = sizeof pattern;
  int descriptor = -1, error = 0;
  void* opencl = dlopen("libOpenCL.so.1", RTLD_NOW);
  void* cuda = dlopen("libcuda.so.1", RTLD_NOW);
  const cl_device_id device = opencl ? find_device(opencl) : NULL;
  if (!opencl)
    return no("no OpenCL here: libOpenCL.so.1 was not found", 0);
  if (!cuda)
    return no("no CUDA here: libcuda.so.1 was not found", 0);
  TRY(cuda, "cuInit", (unsigned), 0);
  if (!device)
    return no("no OpenCL device imports file descriptors", 0);
  for (unsigned i = 0; i < 1024; ++i)
    pattern[i] = i * 2654435761u;
  if (export_memory(cuda, pattern, &size, &descriptor))
    return 1;
  cl_context context = CL(clCreateContext)(NULL, 1, &device, NULL, NULL, &error);
  cl_command_queue queue = error ? NULL : CL(clCreateCommandQueueWithProperties)(context, device, NULL, &error);
  if (error || !CL(clCreateBufferWithProperties))
    return no("clCreateContext, clCreateCommandQueue, clCreateBufferWithProperties", error);
  const cl_mem_properties properties[] = { CL_EXTERNAL_MEMORY_HANDLE_OPAQUE_FD_KHR,
    (cl_mem_properties)descriptor, 0 };
  cl_mem buffer =
    CL(clCreateBufferWithProperties)(context, properties, CL_MEM_READ_WRITE, size, NULL, &error);
  if (error)
    return no("clCreateBufferWithProperties", error);
  error = CL(clEnqueueReadBuffer)(queue, buffer, CL_TRUE, 0, sizeof seen, seen, 0, NULL, NULL);
  if (error || memcmp(seen, pattern, sizeof seen) != 0)
    return no("clEnqueueReadBuffer: OpenCL does not see what CUDA wrote", error);
  printf("yes: OpenCL sees what CUDA wrote, without a copy\n");
  return 0;
}
