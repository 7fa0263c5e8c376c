/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* What an OpenCL device can do at most: bytes copied and floating-point operations per second.
 *
 *   benchmark-limits DEVICE PLATFORM [MEBIBYTES]    both by their exact names, see clinfo
 *
 * Writes one line of JSON. MEBIBYTES is the size of each of the two arrays that are copied, 512 by
 * default; it should be well above the caches. Every figure is the best of several runs: a limit is
 * not a typical value. */

#include <CL/cl.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define RUNS 7
#define DEVICE_LIMIT 64
#define GROUP_ITEMS 64 /* PoCL, left to choose, may make one group, for one core, of them all */
#define FMA_ITEMS 4096
#define FMA_ROUNDS 8192
#define FMA_CHAINS 8

/* WIDE: as many floats as a vector register of a CPU has at most, 1 on a GPU. Eight chains of FMAs
 * that do not wait for each other hide the latency of the unit; the sum keeps them from being
 * removed. */
static const char* const kernel_source =
  "__kernel void copy(__global const float4* restrict a, __global float4* restrict b)\n"
  "{ b[get_global_id(0)] = a[get_global_id(0)]; }\n"
  "__kernel void multiply_add(const int rounds, const float f, __global WIDE* out)\n"
  "{\n"
  "  const WIDE m = (WIDE)f, c = (WIDE)(1 - f);\n"
  "  WIDE x0 = get_global_id(0), x1 = x0 + 1, x2 = x0 + 2, x3 = x0 + 3;\n"
  "  WIDE x4 = x0 + 4, x5 = x0 + 5, x6 = x0 + 6, x7 = x0 + 7;\n"
  "  for (int i = 0; i < rounds; ++i)\n"
  "  {\n"
  "    x0 = fma(x0, m, c); x1 = fma(x1, m, c); x2 = fma(x2, m, c); x3 = fma(x3, m, c);\n"
  "    x4 = fma(x4, m, c); x5 = fma(x5, m, c); x6 = fma(x6, m, c); x7 = fma(x7, m, c);\n"
  "  }\n"
  "  out[get_global_id(0)] = x0 + x1 + x2 + x3 + x4 + x5 + x6 + x7;\n"
  "}\n";

typedef struct probe
{
  cl_device_id device;
  cl_context context;
  cl_command_queue queue;
  cl_program program;
  int width; /* floats of WIDE */
} probe;

static void check(cl_int error, const char* what)
{
  if (error != CL_SUCCESS)
  {
    fprintf(stderr, "benchmark-limits: %s: OpenCL error %d\n", what, (int)error);
    exit(1);
  }
}

static double seconds_now(void)
{
  struct timespec t;
  timespec_get(&t, TIME_UTC);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool find_on_platform(cl_platform_id platform, const char* name, cl_device_id* found)
{
  cl_device_id devices[DEVICE_LIMIT];
  cl_uint count = 0;
  char text[512];
  if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, DEVICE_LIMIT, devices, &count) != CL_SUCCESS)
  {
    return false; /* a platform without devices */
  }
  for (cl_uint i = 0; i < count && i < DEVICE_LIMIT; ++i)
  {
    check(clGetDeviceInfo(devices[i], CL_DEVICE_NAME, sizeof text, text, NULL), "device name");
    if (strcmp(text, name) == 0 || strncmp(name, "built in", 8) == 0) /* any is this CPU, too */
    {
      *found = devices[i];
      return true;
    }
  }
  return false;
}

static cl_device_id find_device(const char* device_name, const char* platform_name)
{
  cl_platform_id platforms[DEVICE_LIMIT];
  cl_uint count = 0;
  char text[512];
  cl_device_id device;
  check(clGetPlatformIDs(DEVICE_LIMIT, platforms, &count), "platforms");
  for (cl_uint i = 0; i < count && i < DEVICE_LIMIT; ++i)
  {
    check(
      clGetPlatformInfo(platforms[i], CL_PLATFORM_NAME, sizeof text, text, NULL), "platform name");
    if ((strcmp(text, platform_name) == 0 || strcmp(platform_name, "built in") == 0) && find_on_platform(platforms[i], device_name, &device))
    {
      return device;
    }
  }
  fprintf(stderr, "benchmark-limits: no device %s (%s)\n", device_name, platform_name);
  exit(1);
}

static probe open_probe(cl_device_id device)
{
  probe p = { .device = device };
  cl_int error;
  cl_device_type type;
  char build[64];
  check(clGetDeviceInfo(device, CL_DEVICE_TYPE, sizeof type, &type, NULL), "device type");
  p.width = type & CL_DEVICE_TYPE_CPU ? 16 : 1;
  p.context = clCreateContext(NULL, 1, &device, NULL, NULL, &error);
  check(error, "context");
  p.queue = clCreateCommandQueue(p.context, device, 0, &error);
  check(error, "queue");
  const char* source = kernel_source;
  p.program = clCreateProgramWithSource(p.context, 1, &source, NULL, &error);
  check(error, "program");
  snprintf(build, sizeof build, "-DWIDE=%s", p.width == 16 ? "float16" : "float");
  check(clBuildProgram(p.program, 1, &device, build, NULL, NULL), "program build");
  return p;
}

static cl_mem make_buffer(const probe* p, size_t bytes)
{
  const cl_float zero = 0;
  cl_int error;
  cl_mem buffer = clCreateBuffer(p->context, CL_MEM_READ_WRITE, bytes, NULL, &error);
  check(error, "buffer");
  check(clEnqueueFillBuffer(p->queue, buffer, &zero, sizeof zero, 0, bytes, 0, NULL, NULL), "fill");
  check(clFinish(p->queue), "fill");
  return buffer;
}

/* Seconds of the fastest of several launches; the first, which compiles, is not counted. */
static double fastest_launch(const probe* p, cl_kernel kernel, size_t items)
{
  const size_t group = GROUP_ITEMS;
  double best = 0;
  for (int run = 0; run <= RUNS; ++run)
  {
    const double begin = seconds_now();
    check(
      clEnqueueNDRangeKernel(p->queue, kernel, 1, NULL, &items, &group, 0, NULL, NULL), "launch");
    check(clFinish(p->queue), "launch");
    const double seconds = seconds_now() - begin;
    best = run == 1 || (run > 1 && seconds < best) ? seconds : best;
  }
  return best;
}

static double copy_bytes_per_second(const probe* p, size_t bytes)
{
  cl_int error;
  cl_mem from = make_buffer(p, bytes), to = make_buffer(p, bytes);
  cl_kernel kernel = clCreateKernel(p->program, "copy", &error);
  check(error, "kernel copy");
  check(clSetKernelArg(kernel, 0, sizeof from, &from), "argument");
  check(clSetKernelArg(kernel, 1, sizeof to, &to), "argument");
  const double seconds = fastest_launch(p, kernel, bytes / sizeof(cl_float4));
  clReleaseKernel(kernel);
  clReleaseMemObject(from);
  clReleaseMemObject(to);
  return 2.0 * (double)bytes / seconds; /* read and written */
}

/* Writes a string of the device as a member of the JSON object. */
static void print_text(const char* name, const char* text)
{
  printf("\"%s\": \"", name);
  for (; *text; ++text)
  {
    printf(*text == '"' || *text == '\\' ? "\\%c" : "%c", *text);
  }
  printf("\", ");
}

static void print_versions(cl_device_id device)
{
  char text[512];
  cl_platform_id platform;
  cl_uint units;
  check(clGetDeviceInfo(device, CL_DEVICE_PLATFORM, sizeof platform, &platform, NULL), "platform");
  check(clGetPlatformInfo(platform, CL_PLATFORM_VERSION, sizeof text, text, NULL), "version");
  print_text("platform_version", text);
  check(clGetDeviceInfo(device, CL_DRIVER_VERSION, sizeof text, text, NULL), "driver version");
  print_text("driver_version", text);
  check(clGetDeviceInfo(device, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL), "units");
  printf("\"compute_units\": %u, ", (unsigned)units);
}

static double operations_per_second(const probe* p)
{
  const size_t items = p->width == 1 ? FMA_ITEMS * 256 : FMA_ITEMS;
  const cl_int rounds = FMA_ROUNDS;
  const cl_float factor = 0.999f;
  cl_int error;
  cl_mem out = make_buffer(p, items * (size_t)p->width * sizeof(cl_float));
  cl_kernel kernel = clCreateKernel(p->program, "multiply_add", &error);
  check(error, "kernel multiply_add");
  check(clSetKernelArg(kernel, 0, sizeof rounds, &rounds), "argument");
  check(clSetKernelArg(kernel, 1, sizeof factor, &factor), "argument");
  check(clSetKernelArg(kernel, 2, sizeof out, &out), "argument");
  const double seconds = fastest_launch(p, kernel, items);
  clReleaseKernel(kernel);
  clReleaseMemObject(out);
  return 2.0 * FMA_CHAINS * rounds * (double)items * p->width / seconds;
}

int main(int argc, char* argv[])
{
  if (argc != 3 && argc != 4)
  {
    fprintf(stderr, "usage: benchmark-limits DEVICE PLATFORM [MEBIBYTES]\n");
    return 2;
  }
  const long mebibytes = argc == 4 ? strtol(argv[3], NULL, 10) : 512;
  if (mebibytes < 1 || mebibytes > 65536)
  {
    fprintf(stderr, "benchmark-limits: MEBIBYTES is a number from 1 to 65536\n");
    return 2;
  }
  const probe p = open_probe(find_device(argv[1], argv[2]));
  printf("{");
  print_versions(p.device);
  printf("\"copy_bytes_per_second\": %.6g, \"operations_per_second\": %.6g}\n",
    copy_bytes_per_second(&p, (size_t)mebibytes << 20), operations_per_second(&p));
  clReleaseProgram(p.program);
  clReleaseCommandQueue(p.queue);
  clReleaseContext(p.context);
  return 0;
}
