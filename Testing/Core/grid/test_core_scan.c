/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compares prefix sums, sort, distinct keys and the key index with plain versions on the host. */

#include "core_fixture.h"

#include <limits.h>

static const int sizes[] = { 0, 1, 2, 15, 16, 17, 255, 1000, 40000, 100003 };
#define SIZE_COUNT (int)(sizeof sizes / sizeof sizes[0])

/* Kinds of key sets: random keys below `limit`. In the last kind all keys but one are equal. */
typedef struct key_kind
{
  const char* name;
  uint64_t limit;
} key_kind;
static const key_kind kinds[] = { { "dense", 1000 }, { "one byte", 256 }, { "nine bits", 257 },
  { "sparse", UINT64_C(1) << 52 }, { "huge", UINT64_C(1) << 62 }, { "one value", 1 },
  { "two values", UINT64_C(0x123456789A) } };
#define KIND_COUNT (int)(sizeof kinds / sizeof kinds[0])

static uint64_t* make_keys(int kind, int count)
{
  uint64_t seed = (uint64_t)(count * 8 + kind);
  uint64_t* keys = malloc((size_t)count * sizeof *keys + 1);
  assert_non_null(keys);
  for (int i = 0; i < count; ++i)
  {
    keys[i] = kind == 6 ? (i == count / 2 ? kinds[kind].limit - 1 : 7)
                        : random_bits(&seed) % kinds[kind].limit;
  }
  return keys;
}

/* Reads `count` elements of `width` bytes; free the result. */
static void* read_back(mcor_context* context, const mcor_buffer* buffer, int count, size_t width)
{
  void* data = malloc((size_t)count * width + 1);
  assert_non_null(data);
  CORE_OK(context, mcor_read(context, buffer, 0, data, (size_t)count * width));
  return data;
}

static int set_up(void** state)
{
  if (core_set_up(state))
  {
    return -1;
  }
  core_build(*state, MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32);
  return 0;
}

static void check_scan(mcor_context* context, int count, int largest)
{
  uint64_t seed = (uint64_t)count;
  CORE_FREED int* counts = oracle_allocate(count + 1, sizeof(int));
  for (int i = 0; i < count; ++i)
  {
    counts[i] = (int)(random_bits(&seed) % (unsigned)(largest + 1));
  }
  mcor_buffer buffer = { 0 };
  int total = -1;
  CORE_OK(context, mcor_write(context, &buffer, counts, ((size_t)count + 1) * sizeof(int)));
  CORE_OK(context, mcor_scan(context, &buffer, count, &total));
  CORE_FREED int* scanned = read_back(context, &buffer, count + 1, sizeof(int));
  int sum = 0;
  for (int i = 0; i <= count; ++i)
  {
    CORE_CHECK(scanned[i] == sum, count, i, scanned[i], sum);
    sum += i < count ? counts[i] : 0;
  }
  assert_int_equal(total, sum);
  mcor_release(context, &buffer);
}

static void test_scan(void** state)
{
  for (int s = 0; s < SIZE_COUNT; ++s)
  {
    check_scan(*state, sizes[s], 1);
    check_scan(*state, sizes[s], 20000);
  }
}

static void test_scan_overflow(void** state)
{
  mcor_context* context = *state;
  /* The total must fit an int even after it is rounded up. */
  const int most[] = { INT_MAX, INT_MAX - 1024, INT_MAX - 5000 };
  for (int k = 0; k < 3; ++k)
  {
    const int counts[4] = { most[k], 0, 1, 0 };
    mcor_buffer buffer = { 0 };
    int total = 0;
    CORE_OK(context, mcor_write(context, &buffer, counts, sizeof counts));
    const mcor_status status = mcor_scan(context, &buffer, 3, &total);
    assert_int_equal(status, k == 2 ? MCOR_OK : MCOR_OUT_OF_CAPACITY);
    CORE_CHECK(
      k == 2 ? total == most[k] + 1 : strstr(mcor_last_error(context), "too large") != NULL,
      most[k], mcor_last_error(context));
    mcor_release(context, &buffer);
  }
}

/* A launch must count its arguments, because a missing one would keep its value from an earlier
 * launch. */
static void test_argument_count(void** state)
{
  mcor_context* context = *state;
  const int counts[2] = { 5, 0 };
  int total;
  mcor_buffer buffer = { 0 };
  CORE_OK(context, mcor_write(context, &buffer, counts, sizeof counts));
  CORE_OK(context, mcor_scan(context, &buffer, 1, &total));
  assert_int_equal(MCOR_LAUNCH(context, "mcor_scan_fill", MCOR_HEAVY, 1, MCOR_BUFFER(&buffer),
                     MCOR_INT(1), MCOR_INT(1)),
    MCOR_DEVICE_ERROR);
  CORE_CHECK(strstr(mcor_last_error(context), "mcor_scan_fill"), mcor_last_error(context));
  mcor_release(context, &buffer);
}

/* Checks the sorted keys, and the place that each had before; the first key of each bucket; the distinct keys, and
 * where the run of each begins. */
static void check_keys(mcor_context* context, int kind, int count)
{
  const uint64_t limit = kinds[kind].limit;
  CORE_FREED uint64_t* keys = make_keys(kind, count);
  mcor_buffer buffer = { 0 }, order = { 0 }, buckets = { 0 }, distinct = { 0 }, index_of = { 0 },
              runs = { 0 };
  CORE_OK(context, mcor_write(context, &buffer, keys, (size_t)count * sizeof *keys));
  CORE_OK(context, mcor_sort(context, &buffer, &order, count, limit));
  CORE_FREED uint64_t* sorted = read_back(context, &buffer, count, sizeof *keys);
  CORE_FREED int* from = read_back(context, &order, count, sizeof(int));
  CORE_FREED uint8_t* seen = oracle_allocate(count + 1, 1);
  for (int i = 0; i < count; ++i)
  {
    CORE_CHECK(
      from[i] >= 0 && from[i] < count && !seen[from[i]], kinds[kind].name, count, i, from[i]);
    seen[from[i]] = 1;
    CORE_CHECK(sorted[i] == keys[from[i]], kinds[kind].name, count, i);
    CORE_CHECK(
      i == 0 || sorted[i - 1] < sorted[i] || (sorted[i - 1] == sorted[i] && from[i - 1] < from[i]),
      kinds[kind].name, count, i);
  }
  int shift = -1, next = 0, found = -1;
  CORE_OK(context, mcor_index_keys(context, &buffer, count, limit, &buckets, &shift));
  const uint64_t bucket_count = (limit >> shift) + 2;
  CORE_CHECK(
    bucket_count <= 4 * (uint64_t)count + (1 << 20) + 2, kinds[kind].name, count, bucket_count);
  CORE_FREED int* first = read_back(context, &buckets, (int)bucket_count, sizeof(int));
  for (uint64_t b = 0; b < bucket_count; ++b)
  {
    while (next < count && sorted[next] >> shift < b)
    {
      ++next;
    }
    CORE_CHECK(first[b] == next, kinds[kind].name, count, b, first[b], next);
  }
  CORE_OK(context, mcor_write(context, &buffer, keys, (size_t)count * sizeof *keys));
  CORE_OK(context, mcor_unique(context, &buffer, count, limit, &distinct, &index_of, &found));
  int expected = 0;
  if (count > 0)
  {
    CORE_FREED uint64_t* values = read_back(context, &distinct, found, sizeof *values);
    CORE_FREED int* index = read_back(context, &index_of, count, sizeof(int));
    int run_count = -1;
    CORE_OK(context, mcor_list_runs(context, &buffer, count, &distinct, &runs, &run_count));
    assert_int_equal(run_count, found);
    CORE_FREED int* begins = read_back(context, &runs, found + 1, sizeof(int));
    assert_int_equal(begins[found], count);
    for (int i = 0; i < count; ++i)
    {
      CORE_CHECK(index[i] >= 0 && index[i] < found && values[index[i]] == keys[i], kinds[kind].name,
        count, index[i], i);
      if (i == 0 || sorted[i] != sorted[i - 1])
      {
        CORE_CHECK(expected < found && values[expected] == sorted[i] && begins[expected] == i,
          kinds[kind].name, count, expected);
        ++expected;
      }
    }
  }
  assert_int_equal(found, expected);
  mcor_buffer* const buffers[] = { &buffer, &order, &buckets, &distinct, &index_of, &runs };
  for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; ++i)
  {
    mcor_release(context, buffers[i]);
  }
}

static void test_keys(void** state)
{
  for (int kind = 0; kind < KIND_COUNT; ++kind)
  {
    for (int s = 0; s < SIZE_COUNT; ++s)
    {
      check_keys(*state, kind, sizes[s]);
    }
  }
}

/* Checks a launch that is cut into parts: each work-item must run once. */
static void test_parts(void** state)
{
  enum
  {
    ITEMS = 1000003
  };
  mcor_context* gpu = NULL;
  core_create_with(&gpu, "MCOR_DEVICE_FORM", "gpu");
  core_build(gpu, MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32);
  core_extend_program(gpu,
    "__kernel void test_visit(const int count, __global int* visits)\n"
    "{\n"
    "  if (get_global_id(0) < count)\n"
    "    atomic_inc(visits + get_global_id(0));\n"
    "}\n");
  mcor_buffer visits = { 0 };
  CORE_OK(gpu, mcor_fill(gpu, &visits, 0, ITEMS * sizeof(int)));
  for (int round = 1; round <= 3; ++round)
  {
    CORE_OK(gpu,
      MCOR_LAUNCH(gpu, "test_visit", MCOR_HEAVY, ITEMS, MCOR_INT(ITEMS), MCOR_BUFFER(&visits)));
    CORE_FREED int* count = read_back(gpu, &visits, ITEMS, sizeof(int));
    for (int i = 0; i < ITEMS; ++i)
    {
      CORE_CHECK(count[i] == round, i, count[i], round);
    }
  }
  mcor_release(gpu, &visits);
  check_scan(gpu, 100003, 20000);
  check_scan(gpu, 4097, 1);
  mcor_free_context(gpu);
}

CORE_MAIN(
  set_up, core_tear_down, test_parts, test_scan, test_scan_overflow, test_argument_count, test_keys)
