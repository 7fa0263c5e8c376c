/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests the built-in device: its functions, compared with PoCL's; its threads; surfaces made on it. */

#include "core_fixture.h"
#include "mcor_parallel.h"

#include <fenv.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* The kernels of native_functions.cl, compiled for the built-in device. */
void test_native(unsigned number, void* const* arguments, size_t first, size_t last);
extern const char test_native_kernels[];

enum
{
  ITEMS = 4096,
  ITEM_BYTES = 128, /* the size of the largest type */
  BYTES = ITEMS * ITEM_BYTES
};

/* Numbers for which implementations may differ, used as float and as double. */
static const float extremes[] = { 0.0f, -0.0f, 1.0f, -1.0f, 0.5f, -0.5f, 1.5f, 2.5f, -2.5f, 1e-45f,
  -1e-45f, 1.17549435e-38f, 1.1754942e-38f, 3.4028235e38f, -3.4028235e38f, 8388607.5f, 16777217.0f,
  -0.49999997f, 0.49999997f, 1e10f, -1e10f, 0x1p-126f, 0x1p127f };

/* Fills `bytes` with numbers of `size` bytes each: extreme ones, infinities, NaN, small integers, and random ones. */
static void fill(unsigned char* bytes, size_t size, uint64_t seed)
{
  const size_t many = sizeof extremes / sizeof extremes[0];
  for (size_t i = 0; i < BYTES / size; ++i)
  {
    const uint64_t kind = (random_bits(&seed) >> 20) % 8, pick = random_bits(&seed) >> 20;
    const float real = kind == 0 ? 1.0f / 0.0f * (pick & 1 ? 1.0f : -1.0f)
      : kind == 1                ? 0.0f / 0.0f
      : kind < 5                 ? extremes[pick % many]
                                 : (float)(int)(pick % 41) - 20;
    const double wide = kind == 4 ? (double)real * 0x1p-1000 : (double)real;
    const uint64_t any = random_bits(&seed);
    memcpy(bytes + i * size,
      kind == 7     ? (const void*)&any
        : size == 4 ? (const void*)&real
                    : (const void*)&wide,
      size);
  }
}

static int is_nan(const unsigned char* bytes, size_t size)
{
  float single;
  double wide;
  memcpy(&single, bytes, sizeof single);
  memcpy(&wide, bytes, size == 8 ? sizeof wide : 0);
  return size == 4 ? single != single : wide != wide;
}

/* Runs a kernel on a driver's device. data: the kernel's arguments; data[3] is read and written. */
static void run_driver(
  mcor_context* context, cl_program program, const char* name, unsigned char* const data[4])
{
  const mcor_cl* cl = &context->cl;
  const size_t items = ITEMS;
  cl_int error;
  cl_kernel kernel = clCreateKernel(program, name, &error);
  assert_int_equal(error, CL_SUCCESS);
  mcor_buffer buffers[4] = { { 0 } };
  for (int i = 0; i < 4; ++i)
  {
    CORE_OK(context, mcor_write(context, &buffers[i], data[i], BYTES));
    assert_int_equal(
      clSetKernelArg(kernel, (cl_uint)i, sizeof(cl_mem), &buffers[i].mem), CL_SUCCESS);
  }
  assert_int_equal(
    clEnqueueNDRangeKernel(cl->queue, kernel, 1, NULL, &items, NULL, 0, NULL, NULL), CL_SUCCESS);
  CORE_OK(context, mcor_read(context, &buffers[3], 0, data[3], BYTES));
  for (int i = 0; i < 4; ++i)
  {
    mcor_release(context, &buffers[i]);
  }
  clReleaseKernel(kernel);
}

static cl_program build(mcor_context* context)
{
  static char text[1 << 16];
  const char* source = text;
  cl_int error;
  FILE* file = fopen(CORE_NATIVE_FUNCTIONS, "r");
  assert_non_null(file);
  assert_true(fread(text, 1, sizeof text - 1, file) > 1000);
  fclose(file);
  cl_program program = clCreateProgramWithSource(context->cl.context, 1, &source, NULL, &error);
  assert_int_equal(error, CL_SUCCESS);
  assert_int_equal(clBuildProgram(program, 1, &context->cl.device,
                     "-w -cl-std=CL1.2 -cl-fp32-correctly-rounded-divide-sqrt", NULL, NULL),
    CL_SUCCESS);
  return program;
}

/* Returns the size in bytes of one number in a kernel's results. */
static size_t result_size(const char* name)
{
  const int wide = strstr(name, "_double") || strncmp(name, "try_double", 10) == 0 ||
    strncmp(name, "try_long", 8) == 0 || strncmp(name, "try_ulong", 9) == 0;
  return wide && !strstr(name, "_float") && !strstr(name, "_any") && !strstr(name, "_all") ? 8 : 4;
}

static void test_functions(void** state)
{
  CORE_CONTEXT context = NULL;
  if (mcor_create_context("pocl", &context) != MCOR_OK)
  {
    mcor_free_context(context);
    skip();
  }
  cl_program program = build(context);
  unsigned char* data[5];
  for (int i = 0; i < 5; ++i)
  {
    data[i] = aligned_alloc(ITEM_BYTES, BYTES);
    assert_non_null(data[i]);
  }
  unsigned number = 0;
  for (const char* at = test_native_kernels; *at; at = strchr(at, ';') + 1, ++number)
  {
    char name[64] = "";
    memcpy(name, at, strcspn(at, ";"));
    const size_t size = result_size(name);
    for (int i = 0; i < 3; ++i)
    {
      fill(data[i], size, 7u * number + (unsigned)i);
    }
    memset(data[3], 0, BYTES);
    memset(data[4], 0, BYTES);
    run_driver(context, program, name, data);
    void* const arguments[] = { &data[0], &data[1], &data[2], &data[4] };
    test_native(number, arguments, 0, ITEMS);
    for (size_t i = 0; i < BYTES; i += size)
    {
      if (memcmp(data[3] + i, data[4] + i, size) != 0 &&
        !(is_nan(data[3] + i, size) && is_nan(data[4] + i, size)))
      {
        fail_msg("%s differs in number %zu", name, i / size);
      }
    }
  }
  assert_true(number > 150);
  for (int i = 0; i < 5; ++i)
  {
    free(data[i]);
  }
  clReleaseProgram(program);
}

/* ---- Threads ---- */

typedef struct
{
  unsigned char seen[100000];
  int rounding;
} marks;

static void mark(void* data, size_t first, size_t last)
{
  marks* m = data;
  for (size_t i = first; i < last; ++i)
  {
    ++m->seen[i];
  }
  if (fegetround() != FE_TONEAREST)
  {
    m->rounding = 1;
  }
}

static void check_loops(mcor_pool* pool)
{
  CORE_FREED marks* m = oracle_allocate(1, sizeof *m);
  for (int i = 0; i < 200; ++i)
  {
    const size_t first = (size_t)i, last = sizeof m->seen - (size_t)i * 7;
    memset(m->seen, 0, sizeof m->seen);
    mcor_pool_run(pool, NULL, first, last, (size_t)(1 + i * i), mark, m);
    for (size_t k = 0; k < sizeof m->seen; ++k)
    {
      assert_int_equal(m->seen[k], k >= first && k < last);
    }
  }
  assert_int_equal(m->rounding, 0);
}

static void test_loops(void** state)
{
  for (int threads = 1; threads < 9; ++threads)
  {
    mcor_pool pool = { .threads = threads };
    fesetround(FE_UPWARD); /* the caller may round as it likes */
    check_loops(&pool);
    assert_int_equal(fegetround(), FE_UPWARD);
    fesetround(FE_TONEAREST);
    assert_int_equal(pool.count, threads - 1);
    mcor_end_pool(&pool);
  }
}

/* ---- The device ---- */

static uint64_t extract(mcor_context* context)
{
  CORE_SET set = core_make_block(9, 0.3, 3, core_ball);
  const double iso = 3;
  const mcor_input input = core_input(&set);
  const mcor_options options = core_options(&iso);
  CORE_SURFACE surface = core_extract(context, &input, &options);
  assert_true(surface.triangle_count > 100);
  return core_hash(&surface);
}

static mcor_context* make_native(void)
{
  mcor_context* context = NULL;
  CORE_OK(context, mcor_create_context("built in", &context));
  return context;
}

/* A process made by fork has threads of its own. */
static void test_fork(void** state)
{
  CORE_CONTEXT context = make_native();
  const uint64_t hash = extract(context);
  const pid_t child = fork();
  if (child == 0)
  {
    const int same = extract(context) == hash;
    mcor_free_context(context);
    _exit(same ? 0 : 1);
  }
  int status = -1;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_int_equal(status, 0);
  assert_true(extract(context) == hash);
}

/* Limits the address space of a child process so far that some drivers would end it. The built-in device must work,
 * named or by default, and a driver's device must be refused with a message. */
static void test_little_room_for_drivers(void** state)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  skip(); /* sanitizers reserve all address space */
#endif
  const pid_t child = fork();
  if (child == 0)
  {
    alarm(120); /* a driver may wait for its threads for ever */
    long pages = 0;
    FILE* file = fopen("/proc/self/statm", "r");
    const int read = file && fscanf(file, "%ld", &pages) == 1;
    const rlim_t room =
      (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + ((rlim_t)192 << 20); /* bytes */
    const struct rlimit limit = { room, room };
    if (!read || setrlimit(RLIMIT_AS, &limit) != 0)
    {
      _exit(1);
    }
    unsetenv("MCOR_DEVICE");
    static const char* const names[] = { "built in", "0", "", "pocl" };
    for (int i = 0; i < 4; ++i)
    {
      CORE_CONTEXT context = NULL;
      const int status = mcor_create_context(names[i], &context);
      const int refused = status == MCOR_DEVICE_ERROR && strstr(mcor_last_error(context), "pocl") &&
        strstr(mcor_last_error(context), "ulimit");
      if (i < 3 ? status != MCOR_OK || extract(context) == 0 : !refused)
      {
        fprintf(stderr, "\"%s\": %d, %s\n", names[i], status, mcor_last_error(context));
        _exit(2);
      }
    }
    _exit(0);
  }
  int status = -1;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_int_equal(status, 0);
}

static void* extract_alone(void* hash)
{
  CORE_CONTEXT context = make_native();
  *(uint64_t*)hash = extract(context);
  return NULL;
}

static void test_contexts_side_by_side(void** state)
{
  pthread_t threads[4];
  uint64_t hashes[4];
  for (int t = 0; t < 4; ++t)
  {
    assert_int_equal(pthread_create(&threads[t], NULL, extract_alone, &hashes[t]), 0);
  }
  for (int t = 0; t < 4; ++t)
  {
    pthread_join(threads[t], NULL);
    assert_true(hashes[t] == hashes[0]);
  }
}

static void test_threads_of_environment(void** state)
{
  setenv("MCOR_THREADS", "1", 1);
  mcor_context* context = make_native();
  assert_int_equal(context->cl.units, 1);
  const uint64_t hash = extract(context);
  mcor_free_context(context);
  unsetenv("MCOR_THREADS");
  context = make_native();
  assert_true(extract(context) == hash);
  mcor_free_context(context);
}

/* Checks that processes that share a machine have fewer threads each, and the same result. */
static void test_shares(void** state)
{
  uint64_t hash = 0;
  for (int count = 1; count < 4; ++count)
  {
    const int most = mcor_limit_threads(mcor_processors(1)), share = mcor_processors(count);
    CORE_CONTEXT context = NULL;
    CORE_OK(context, mcor_create_shared_context("built in", count - 1, count, &context));
    assert_int_equal(context->cl.units, share < most ? share : most);
    const uint64_t own = extract(context);
    assert_true(count == 1 || own == hash);
    hash = own;
  }
}

/* Memory of the host that is locked for mappings, as with a GPU, must not exceed the largest buffer
 * that a driver allows. */
static void test_locked(void** state)
{
  enum
  {
    LARGEST = 1 << 20,
    MAPPED = LARGEST - 512
  };
  CORE_CONTEXT context = make_native();
  context->cl.is_apart = true;
  context->cl.largest_buffer = LARGEST;
  mcor_buffer buffer = { 0 };
  void* view = NULL;
  CORE_OK(context, mcor_reserve(context, &buffer, MAPPED));
  CORE_OK(context, mcor_map(context, &buffer, MAPPED, true, &view));
  assert_ptr_equal(view, context->cl.locked[0].host);
  assert_in_range(context->cl.locked[0].size, MAPPED, LARGEST);
  memset(view, 7, MAPPED);
  CORE_OK(context, mcor_unmap(context, &buffer, &view));
  uint8_t last = 0;
  CORE_OK(context, mcor_read(context, &buffer, MAPPED - 1, &last, 1));
  assert_int_equal(last, 7);
  mcor_release(context, &buffer);
}

/* If a device has memory of its own, particles are copied to it in portions, and arrays of equal elements are not
 * copied. No bit changes. */
static void test_device_apart(void** state)
{
  CORE_SET set = core_make_block(70, 0.3, 3, core_slope);
  const double iso[] = { -14, 0, 15 };
  mcor_input input = core_input(&set);
  mcor_options options = core_options(iso);
  options.iso_count = 3;
  options.h_scale = 1.1;
  input.volume = (mcor_array){ .constant = 1 };
  for (int lengths = 1; lengths <= 2; ++lengths)
  {
    uint64_t hash[2];
    for (int apart = 0; apart < 2; ++apart)
    {
      CORE_CONTEXT context = make_native();
      context->cl.is_apart = apart;
      hash[apart] = core_hash_of(context, &input, &options);
    }
    assert_true(hash[0] == hash[1]);
    for (int64_t i = 0; i < set.count; i += 3) /* for the second round */
    {
      set.smoothing_length[i] = 1.2;
    }
  }
}

CORE_MAIN(NULL, NULL, test_functions, test_loops, test_fork, test_little_room_for_drivers,
  test_contexts_side_by_side, test_threads_of_environment, test_shares, test_locked, test_device_apart)
