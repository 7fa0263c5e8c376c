/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Kernels compiled ahead by a second process, which is started once and leaves nothing behind. With
 * PoCL; other drivers have no such process, which is tested instead. */

#if !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* for nftw, setenv, mkdtemp */
#endif

#include "core_fixture.h"

#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static char folder[64];
static int compiled; /* kernels in the folder */
static int linked;   /* those that our own linker made, which writes no sections */

static int remove_file(const char* path, const struct stat* stat, int type, struct FTW* at)
{
  (void)stat;
  (void)type;
  (void)at;
  return remove(path);
}

static int count_file(const char* path, const struct stat* stat, int type, struct FTW* at)
{
  (void)stat;
  (void)at;
  const size_t length = strlen(path);
  if (type == FTW_F && length > 3 && strcmp(path + length - 3, ".so") == 0 &&
    !strstr(path, "tempfile"))
  {
    unsigned char header[64] = { 0 };
    FILE* file = fopen(path, "rb");
    ++compiled;
    linked += file && fread(header, sizeof header, 1, file) == 1 && header[60] + header[61] == 0;
    fclose(file);
  }
  return 0;
}

/* The device, with the folder that it was given; then an empty one, for what is started. */
static int set_up(void** state)
{
  setenv("MCOR_COMPILER", "", 1);
  const int status = core_set_up(state);
  strcpy(folder, "/tmp/test_core_ahead_XXXXXX");
  assert_non_null(mkdtemp(folder));
  setenv("POCL_CACHE_DIR", folder, 1);
  return status;
}

static int tear_down(void** state)
{
  nftw(folder, remove_file, 16, FTW_DEPTH | FTW_PHYS);
  return core_tear_down(state);
}

static bool has_pocl(mcor_context* context)
{
  return mcor_can_compile_ahead(&context->cl, &(mcor_build){ 0 });
}

/* Seconds until so many kernels are compiled, at most `limit`. */
static double wait_for_kernels(int count, double limit)
{
  const double begin = mcor_seconds();
  const struct timespec pause = { 0, 50000000 };
  for (compiled = linked = 0; compiled < count && mcor_seconds() - begin < limit;)
  {
    nanosleep(&pause, NULL);
    compiled = linked = 0;
    nftw(folder, count_file, 16, FTW_PHYS);
  }
  return mcor_seconds() - begin;
}

static bool is_listed(
  const mcor_ahead_kernel* kernels, int count, const char* name, mcor_program program)
{
  for (int i = 0; i < count; ++i)
  {
    if (strcmp(kernels[i].name, name) == 0)
    {
      return kernels[i].program == program;
    }
  }
  return false;
}

/* The list is what usual surfaces launch, no more and no less. */
static void expect_list(mcor_context* context, mcor_field field)
{
  const double iso = field == MCOR_WEIGHT_SUM ? 0.5 : 0;
  core_set set = core_make_block(14, 0.1, 3, core_slope); /* cut by the end of the fluid */
  mcor_input input = core_input(&set);
  mcor_array attribute = core_array(set.position, 3);
  mcor_options options = core_options(&iso);
  mcor_ahead_kernel kernels[MCOR_AHEAD_LIMIT];
  input.attributes = &attribute;
  input.attribute_count = 1;
  options.field = field;
  mcor_surface surface = core_extract(context, &input, &options);
  const int count = mcor_list_ahead(&context->cl.build, set.count, kernels);
  for (int i = 0; i < context->cl.kernel_count; ++i)
  {
    const mcor_kernel* kernel = &context->cl.kernels[i];
    CORE_CHECK(is_listed(kernels, count, kernel->name, kernel->program) ||
        strcmp(kernel->name, "mcor_attribute_means") == 0,
      "%s is not listed", kernel->name);
  }
  int launched = 0;
  for (int i = 0; i < count; ++i)
  {
    for (int k = 0; k < context->cl.kernel_count; ++k)
    {
      launched += strcmp(kernels[i].name, context->cl.kernels[k].name) == 0;
    }
  }
  /* Those for arrays of many components, and for many points, are not needed here. */
  CORE_CHECK(launched + 3 >= count, "%d of %d listed kernels were launched", launched, count);
  mcor_free_surface(&surface);
  core_free_set(&set);
}

static void test_list(void** state)
{
  expect_list(*state, MCOR_WEIGHT_SUM);
  mcor_context* context = NULL;
  CORE_OK(context, mcor_create_context(NULL, &context));
  expect_list(context, MCOR_SHEPARD);
  mcor_free_context(context);
}

/* Each kernel of the list compiles by a launch whose counts are 0, and that does nothing. */
static void test_zero_launches(void** state)
{
  mcor_context* context = *state;
  for (int field = MCOR_SHEPARD; field <= MCOR_WEIGHT_SUM; field += MCOR_WEIGHT_SUM)
  {
    mcor_ahead_kernel kernels[MCOR_AHEAD_LIMIT];
    core_build(context, MCOR_CUBIC_SPLINE, (mcor_field)field, MCOR_FLOAT32);
    const int count = mcor_list_ahead(&context->cl.build, 1000, kernels);
    for (int i = 0; i < count; ++i)
    {
      CORE_OK(context, mcor_compile_kernel(context, kernels + i));
    }
  }
  const mcor_ahead_kernel none = { "mcor_no_such_kernel", MCOR_PROGRAM_FIELD, MCOR_LIGHT, false };
  assert_int_equal(mcor_compile_kernel(context, &none), MCOR_DEVICE_ERROR);
}

/* The process begins at once, ends when it is no longer wanted, and is not started a second time. */
static void test_process(void** state)
{
  mcor_context* context = NULL;
  core_set set = core_make_block(6, 0, 1, core_ball);
  const mcor_input input = core_input(&set);
  const mcor_build build = { .sph_kernel = MCOR_QUADRATIC, .field = MCOR_WEIGHT_SUM };
  CORE_OK(context, mcor_create_context(NULL, &context));
  if (!has_pocl(*state))
  {
    mcor_begin_ahead(context, &build, &input);
    assert_false(context->ahead.started);
    mcor_free_context(context);
    core_free_set(&set);
    return;
  }
  setenv("MCOR_COMPILER", CORE_COMPILER, 1);
  mcor_begin_ahead(context, &build, &input);
  assert_true(context->ahead.started);
  assert_true(waitpid(-1, NULL, WNOHANG) < 0 && errno == ECHILD); /* nobody is left to wait for */
  wait_for_kernels(2, 300);
  assert_true(compiled >= 2);
#ifdef __x86_64__
  /* Later versions' object files may have more than our linker knows. */
  char version[64] = "";
  clGetDeviceInfo(context->cl.device, CL_DRIVER_VERSION, sizeof version - 1, version, NULL);
  assert_true(linked >= 2 || strncmp(version, "3.", 2) != 0);
#endif
  mcor_end_ahead(context, false);
  wait_for_kernels(1 << 20, 3); /* it may be in the middle of one */
  const int last = compiled;
  wait_for_kernels(1 << 20, 1);
  assert_true(compiled <= last + 1);
  assert_true(compiled < 20);
  /* The call failed: once more. It succeeds: no more. */
  mcor_begin_ahead(context, &build, &input);
  assert_true(context->ahead.started);
  mcor_end_ahead(context, true);
  mcor_begin_ahead(context, &build, &input);
  assert_false(context->ahead.started);
  const mcor_build other = { .sph_kernel = MCOR_QUINTIC_SPLINE, .field = MCOR_WEIGHT_SUM };
  mcor_begin_ahead(context, &other, &input);
  assert_true(context->ahead.started);
  mcor_end_ahead(context, false);
  mcor_free_context(context);
  core_free_set(&set);
}

/* Without the program, with one that fails, or in a folder that cannot be written, all goes on. */
static void test_no_process(void** state)
{
  mcor_context* context = *state;
  core_set set = core_make_block(6, 0, 1, core_ball);
  const mcor_input input = core_input(&set);
  const mcor_build build = { .sph_kernel = MCOR_WENDLAND_C2, .field = MCOR_WEIGHT_SUM };
  const char* const compilers[] = { "", "/nowhere", "/tmp", "/bin/false" };
  for (int i = 0; i < 4; ++i)
  {
    setenv("MCOR_COMPILER", compilers[i], 1);
    mcor_begin_ahead(context, &build, &input);
    assert_int_equal(context->ahead.started, i == 3 && has_pocl(context));
    mcor_end_ahead(context, false);
  }
  setenv("POCL_CACHE_DIR", "/proc/nowhere", 1);
  mcor_begin_ahead(context, &build, &input);
  mcor_end_ahead(context, true);
  setenv("POCL_CACHE_DIR", folder, 1);
  assert_true(waitpid(-1, NULL, WNOHANG) < 0 && errno == ECHILD);
  core_free_set(&set);
}

static void write_text(const char* in, const char* name, const char* text)
{
  char path[512];
  snprintf(path, sizeof path, "%s/%s", in, name);
  FILE* file = fopen(path, "w");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

static void expect_text(const char* in, const char* name, const char* text)
{
  char path[512], read[64] = "";
  snprintf(path, sizeof path, "%s/%s", in, name);
  FILE* file = fopen(path, "r");
  CORE_CHECK((file != NULL) == (text != NULL), "%s", path);
  if (file)
  {
    CORE_CHECK(!fgets(read, sizeof read, file) || strcmp(read, text) == 0, "%s: %s", path, read);
    fclose(file);
  }
}

/* Kernels that a machine keeps are taken if they are those that are needed, and are not touched. */
static void test_kept(void** state)
{
  mcor_context* context = *state;
  core_set set = core_make_block(6, 0, 1, core_ball);
  const mcor_input input = core_input(&set);
  const mcor_build build = { .sph_kernel = MCOR_M_PRIME_4, .field = MCOR_WEIGHT_SUM };
  const mcor_build other = { .sph_kernel = MCOR_M_PRIME_4, .field = MCOR_SUM };
  char kept[] = "/tmp/test_core_kept_XXXXXX", path[512], ready[1024], request[MCOR_AHEAD_BYTES];
  mcor_ahead_kernel kernels[MCOR_AHEAD_LIMIT];
  if (!has_pocl(context))
  {
    core_free_set(&set);
    skip();
  }
  assert_non_null(mkdtemp(kept));
  for (int i = 0; i < 2; ++i) /* one program is there already */
  {
    static const char* const names[] = { "XY", "XY/NEW", "XY/NEW/kernel", "XY/OLD" };
    for (int n = 0; n < 4; n += i ? 3 : 1)
    {
      snprintf(path, sizeof path, "%s/%s", i ? folder : kept, names[n]);
      assert_int_equal(mkdir(path, 0700), 0);
    }
    write_text(i ? folder : kept, "XY/OLD/program.bc", i ? "user's" : "kept");
  }
  write_text(kept, "XY/NEW/kernel/k.so", "kernel");
  write_text(kept, "else", "");
  const int count = mcor_list_ahead(&build, set.count, kernels);
  mcor_write_request(&context->cl, &build, kernels, count, request);
  assert_true(mcor_ready_file(&context->cl, &build, request, ready));
  write_text(kept, strrchr(ready, '/') + 1, "");
  setenv("MCOR_COMPILER", "/bin/false", 1);
  const struct
  {
    const char* kept;
    const mcor_build* build;
    bool started, taken;
  } steps[] = { { "", &build, true, false }, { "/nowhere", &build, true, false },
    { kept, &other, true, false }, { kept, &build, false, true } };
  for (int i = 0; i < 4; ++i)
  {
    setenv("MCOR_KERNEL_DIR", steps[i].kept, 1);
    mcor_begin_ahead(context, steps[i].build, &input);
    assert_int_equal(context->ahead.started, steps[i].started);
    mcor_end_ahead(context, false);
    expect_text(folder, "XY/NEW/kernel/k.so", steps[i].taken ? "kernel" : NULL);
    expect_text(folder, strrchr(ready, '/') + 1, steps[i].taken ? "" : NULL);
    expect_text(folder, "XY/OLD/program.bc", "user's");
    expect_text(folder, "else", NULL);
  }
  unsetenv("MCOR_KERNEL_DIR");
  expect_text(kept, "XY/NEW/kernel/k.so", "kernel");
  nftw(kept, remove_file, 16, FTW_DEPTH | FTW_PHYS);
  core_free_set(&set);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_list),
    cmocka_unit_test(test_zero_launches), cmocka_unit_test(test_process),
    cmocka_unit_test(test_no_process), cmocka_unit_test(test_kept) };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
