/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The cache of compiled programs: whatever is wrong with it, a program is right, or compiled. */

#if !defined(_DEFAULT_SOURCE)
#define _DEFAULT_SOURCE /* for mkdtemp, setenv */
#endif

#include "core_fixture.h"
#include "mcor_cache.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utime.h>

static char folder[64];
static const mcor_cache_key key = { { 0x1234, 0xABCDEF } };

static int set_up(void** state)
{
  strcpy(folder, "/tmp/test_core_cache_XXXXXX");
  assert_non_null(mkdtemp(folder));
  setenv("MCOR_CACHE_DIR", folder, 1);
  return core_set_up(state);
}

/* Files in the folder; the last one's path. */
static int list_files(char path[400])
{
  DIR* directory = opendir(folder);
  int count = 0;
  assert_non_null(directory);
  for (struct dirent* entry = readdir(directory); entry; entry = readdir(directory))
  {
    if (entry->d_name[0] != '.')
    {
      snprintf(path, 400, "%s/%s", folder, entry->d_name);
      ++count;
    }
  }
  closedir(directory);
  return count;
}

static void remove_files(void)
{
  char path[400];
  while (list_files(path) > 0)
  {
    assert_int_equal(unlink(path), 0);
  }
}

static int tear_down(void** state)
{
  remove_files();
  rmdir(folder);
  return core_tear_down(state);
}

static void expect_cached(const char* text)
{
  size_t size = 99;
  char* data = mcor_cache_load(&key, &size);
  if (!text)
  {
    assert_null(data);
    return;
  }
  assert_non_null(data);
  assert_int_equal(size, strlen(text));
  assert_memory_equal(data, text, size);
  free(data);
}

static void test_store_and_load(void** state)
{
  (void)state;
  char path[400];
  expect_cached(NULL);
  mcor_cache_store(&key, "first", 5);
  expect_cached("first");
  mcor_cache_store(&key, "the second", 10);
  expect_cached("the second");
  assert_int_equal(list_files(path), 1);
  const mcor_cache_key other = { { key.words[0], key.words[1] + 1 } };
  size_t size;
  assert_null(mcor_cache_load(&other, &size));
  remove_files();
}

/* Every text, and where one ends and the next begins, counts. */
static void test_key(void** state)
{
  (void)state;
  static const char* const texts[][2] = { { "a", "bc" }, { "ab", "c" }, { "abc", "" },
    { "", "abc" }, { "a", "bd" }, { "b", "ac" } };
  mcor_cache_key keys[6] = { { { 0 } } };
  for (int i = 0; i < 6; ++i)
  {
    mcor_cache_add(&keys[i], texts[i][0]);
    mcor_cache_add(&keys[i], texts[i][1]);
    for (int j = 0; j < i; ++j)
    {
      assert_true(keys[i].words[0] != keys[j].words[0] && keys[i].words[1] != keys[j].words[1]);
    }
  }
}

/* A file that is cut off anywhere, longer, or differs in any byte is not used. */
static void test_damaged(void** state)
{
  (void)state;
  char path[400], whole[200], damaged[201];
  mcor_cache_store(&key, "some program", 12);
  assert_int_equal(list_files(path), 1);
  FILE* file = fopen(path, "rb");
  const size_t size = fread(whole, 1, sizeof whole, file);
  fclose(file);
  assert_true(size > 12 && size < sizeof whole);
  for (size_t i = 0; i < 2 * size + 1; ++i)
  {
    memcpy(damaged, whole, size);
    damaged[size] = 'x';
    const size_t length = i <= size ? (i < size ? i : size + 1) : size;
    if (i > size)
    {
      damaged[i - size - 1] ^= 0x10;
    }
    file = fopen(path, "wb");
    assert_int_equal(fwrite(damaged, 1, length, file), length);
    fclose(file);
    expect_cached(NULL);
  }
  mcor_cache_store(&key, "some program", 12);
  expect_cached("some program");
  remove_files();
}

/* Processes that write and read the same file at once see one of the texts or nothing. */
static void test_several_processes(void** state)
{
  (void)state;
  enum
  {
    PROCESSES = 4,
    SIZE = 300000
  };
  pid_t children[PROCESSES];
  char path[400];
  for (int p = 0; p < PROCESSES; ++p)
  {
    children[p] = fork();
    if (children[p] == 0)
    {
      int wrong = 0;
      char* text = malloc(SIZE);
      memset(text, 'a' + p, SIZE);
      for (int i = 0; i < 50; ++i)
      {
        size_t size = 0;
        mcor_cache_store(&key, text, (size_t)(SIZE - p));
        char* data = mcor_cache_load(&key, &size);
        wrong += !data || size != (size_t)(SIZE - (data[0] - 'a')) || data[0] != data[size - 1] ||
          data[0] != data[size / 2];
        free(data);
      }
      _exit(wrong != 0);
    }
  }
  for (int p = 0; p < PROCESSES; ++p)
  {
    int status = -1;
    assert_int_equal(waitpid(children[p], &status, 0), children[p]);
    assert_int_equal(status, 0);
  }
  assert_int_equal(list_files(path), 1);
  remove_files();
}

/* Nowhere to write to, and turned off: nothing is kept, nothing fails. */
static void test_no_folder(void** state)
{
  (void)state;
  char path[400], saved[400];
  const char* home = getenv("HOME");
  snprintf(saved, sizeof saved, "%s", home ? home : "/");
  unsetenv("XDG_CACHE_HOME");
  for (int i = 0; i < 4; ++i)
  {
    i == 0 ? setenv("MCOR_CACHE_DIR", "", 1) : unsetenv("MCOR_CACHE_DIR");
    i == 1 ? unsetenv("HOME") : setenv("HOME", i == 2 ? "/dev/null" : "/proc", 1);
    mcor_cache_store(&key, "some program", 12);
    expect_cached(NULL);
  }
  /* A folder of the user's, made where it is missing. */
  setenv("HOME", folder, 1);
  mcor_cache_store(&key, "some program", 12);
  expect_cached("some program");
  setenv("MCOR_CACHE_DIR", folder, 1);
  expect_cached(NULL);
  snprintf(path, sizeof path, "rm -r %s/.cache", folder);
  assert_int_equal(system(path), 0);
  setenv("HOME", saved, 1);
}

static void test_read_only(void** state)
{
  (void)state;
  char path[400];
  assert_int_equal(chmod(folder, 0500), 0);
  const pid_t child = fork();
  if (child == 0)
  {
    /* To root every folder can be written. */
    const int failed = geteuid() == 0 && setuid(65534) != 0;
    mcor_cache_store(&key, "some program", 12);
    _exit(failed);
  }
  int status = -1;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_int_equal(status, 0);
  assert_int_equal(chmod(folder, 0700), 0);
  assert_int_equal(list_files(path), 0);
}

/* Where PoCL's folder cannot be made, a sentence names it. */
static void test_pocl_folder(void** state)
{
  (void)state;
  char text[600];
  const char* own = getenv("POCL_CACHE_DIR");
  char saved[400];
  snprintf(saved, sizeof saved, "%s", own ? own : "");
  setenv("POCL_CACHE_DIR", "/dev/null/folder", 1);
  assert_true(mcor_pocl_folder_fault(text, sizeof text));
  assert_non_null(strstr(text, "/dev/null/folder, which is not writable"));
  setenv("POCL_CACHE_DIR", folder, 1);
  assert_false(mcor_pocl_folder_fault(text, sizeof text));
  own ? setenv("POCL_CACHE_DIR", saved, 1) : unsetenv("POCL_CACHE_DIR");
}

/* Where nothing says where PoCL is to compile, a folder of this user's alone is made for it. */
static void test_pocl_folder_without_home(void** state)
{
  (void)state;
  static const char* const names[3] = { "POCL_CACHE_DIR", "XDG_CACHE_HOME", "HOME" };
  char saved[3][400] = { "", "", "" }, path[1024];
  struct stat status;
  for (int i = 0; i < 3; ++i)
  {
    const char* value = getenv(names[i]);
    snprintf(saved[i], sizeof saved[i], "%s", value ? value : "");
    unsetenv(names[i]);
  }
  mcor_pocl_folder(path, sizeof path);
  assert_non_null(getenv("POCL_CACHE_DIR"));
  assert_string_equal(path, getenv("POCL_CACHE_DIR"));
  assert_null(strstr(path, "/tmp/pocl"));
  assert_int_equal(lstat(path, &status), 0);
  assert_true(S_ISDIR(status.st_mode) && status.st_uid == geteuid());
  assert_int_equal(status.st_mode & (S_IWGRP | S_IWOTH), 0);
  for (int i = 0; i < 3; ++i)
  {
    saved[i][0] ? setenv(names[i], saved[i], 1) : unsetenv(names[i]);
  }
}

/* What a link leads to is not run. */
static void test_links(void** state)
{
  char path[400], aside[420];
  size_t size;
  (void)state;
  remove_files();
  mcor_cache_store(&key, "text", 5);
  assert_int_equal(list_files(path), 1);
  snprintf(aside, sizeof aside, "%s.aside", path);
  assert_int_equal(rename(path, aside), 0);
  assert_int_equal(symlink(aside, path), 0);
  assert_null(mcor_cache_load(&key, &size));
  assert_int_equal(unlink(path), 0);
  assert_int_equal(rename(aside, path), 0);
  void* data = mcor_cache_load(&key, &size);
  assert_non_null(data);
  free(data);
  remove_files();
}

/* Sums 1 + 2 + ... by a kernel. */
static void expect_scan(mcor_context* context)
{
  mcor_buffer buffer = { 0 };
  const int counts[4] = { 1, 2, 3, 0 };
  int total = 0;
  core_build(context, MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32);
  CORE_OK(context, mcor_write(context, &buffer, counts, sizeof counts));
  CORE_OK(context, mcor_scan(context, &buffer, 3, &total));
  assert_int_equal(total, 6);
  mcor_release(context, &buffer);
}

static size_t source_length(mcor_context* context)
{
  size_t length = 0;
  assert_int_equal(clGetProgramInfo(context->cl.programs[MCOR_PROGRAM_LATTICE], CL_PROGRAM_SOURCE,
                     0, NULL, &length),
    CL_SUCCESS);
  return length;
}

/* A context's programs come from the cache, if they are whole there. */
static void test_program(void** state)
{
  (void)state;
  char path[400];
  for (int run = 0; run < 3; ++run)
  {
    mcor_context* context = NULL;
    CORE_OK(context, mcor_create_context(NULL, &context));
    context->cl.keeps_binaries = true; /* also PoCL's, for this test */
    if (run == 2)
    {
      assert_int_equal(truncate(path, 1000), 0);
    }
    expect_scan(context);
    assert_int_equal(list_files(path), 1);
    CORE_CHECK((source_length(context) < 2) == (run == 1), "run %d: source of %zu characters", run,
      source_length(context));
    mcor_free_context(context);
  }
  remove_files();
}

/* Storing removes what was last used long ago, and nothing else. */
static void test_unused_programs_are_removed(void** state)
{
  (void)state;
  const mcor_cache_key other = { { 5, 6 } };
  const struct utimbuf long_ago = { 1000000, 1000000 };
  char path[400];
  size_t size;
  remove_files();
  mcor_cache_store(&other, "old", 3);
  assert_int_equal(list_files(path), 1);
  assert_int_equal(utime(path, &long_ago), 0);
  free(mcor_cache_load(&other, &size)); /* it is used */
  mcor_cache_store(&key, "new", 3);
  assert_int_equal(list_files(path), 2);
  remove_files();
  mcor_cache_store(&other, "old", 3);
  assert_int_equal(list_files(path), 1);
  assert_int_equal(utime(path, &long_ago), 0);
  snprintf(path, sizeof path, "%s/notes", folder);
  FILE* file = fopen(path, "w");
  assert_non_null(file);
  fclose(file);
  assert_int_equal(utime(path, &long_ago), 0);
  mcor_cache_store(&key, "new", 3);
  assert_int_equal(list_files(path), 2);
  assert_null(mcor_cache_load(&other, &size));
  expect_cached("new");
  remove_files();
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_store_and_load),
    cmocka_unit_test(test_key), cmocka_unit_test(test_damaged),
    cmocka_unit_test(test_several_processes), cmocka_unit_test(test_no_folder),
    cmocka_unit_test(test_read_only), cmocka_unit_test(test_pocl_folder),
    cmocka_unit_test(test_pocl_folder_without_home), cmocka_unit_test(test_links),
    cmocka_unit_test(test_program), cmocka_unit_test(test_unused_programs_are_removed) };
  return cmocka_run_group_tests_name("cache", tests, set_up, tear_down);
}
