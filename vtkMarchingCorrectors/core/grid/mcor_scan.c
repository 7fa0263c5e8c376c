/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#include "mcor_internal.h"

/* With more elements than this, launches take long. Each then waits for the one before, so that a
 * run may be cancelled between them. With fewer elements, waiting would take longer than the
 * work. */
#define MCOR_LONG_WALK (1 << 20)

static mcor_load mcor_walk(int count)
{
  return count > MCOR_LONG_WALK ? MCOR_HEAVY : MCOR_MEDIUM;
}

/* Returns into how many segments `count` elements are cut. No segment is so short that walking
 * it takes less time than the launches that several segments need. */
static int mcor_segments(const mcor_context* context, int count)
{
  const int most = count / (context->cl.lanes == 1 ? 64 : 16384);
  return most < 1 ? 1 : most < context->cl.segments ? most : context->cl.segments;
}

/* Replaces counts[0..count) by their exclusive prefix sums, and element `count` by the total. The
 * buffer holds count + 1 ints. The host makes the prefix sums of the segments' sums. */
static mcor_status mcor_scan_segments(
  mcor_context* context, const mcor_buffer* counts, int count, int segments, int64_t* total)
{
  mcor_buffer* buffer = &context->scan_sums;
  cl_long sums[MCOR_SEGMENT_LIMIT];
  const size_t bytes = (size_t)segments * sizeof sums[0];
  *total = 0;
  MCOR_TRY(mcor_reserve(context, buffer, bytes));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_scan_sum", mcor_walk(count), segments, MCOR_BUFFER(counts),
    MCOR_INT(count), MCOR_INT(segments), MCOR_BUFFER(buffer)));
  MCOR_TRY(mcor_read(context, buffer, 0, sums, bytes));
  for (int s = 0; s < segments; ++s)
  {
    const cl_long sum = sums[s];
    sums[s] = *total;
    *total += sum;
  }
  MCOR_TRY(mcor_write(context, buffer, sums, bytes));
  return MCOR_LAUNCH(context, "mcor_scan_fill", mcor_walk(count), segments, MCOR_BUFFER(counts),
    MCOR_INT(count), MCOR_INT(segments), MCOR_BUFFER(buffer));
}

/* Scans as mcor_scan_segments does. Fails if the total is above MCOR_COUNT_LIMIT. */
mcor_status mcor_scan(mcor_context* context, mcor_buffer* counts, int count, int* total)
{
  int64_t sum;
  MCOR_TRY(mcor_scan_segments(context, counts, count, mcor_segments(context, count), &sum));
  MCOR_FAIL_IF(sum > MCOR_COUNT_LIMIT, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(TABLE_TOO_LARGE),
    (long long)sum, MCOR_COUNT_LIMIT);
  *total = (int)sum;
  return MCOR_OK;
}

/* Counts the bits set in both arrays of masks. bricks.bit_counts gets the counts' prefix sums. */
mcor_status mcor_count_bits(
  mcor_context* context, const mcor_buffer* masks, const mcor_buffer* within, int count, int* total)
{
  mcor_buffer* counts = &context->bricks.bit_counts;
  MCOR_TRY(mcor_reserve(context, counts, ((size_t)count + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_march_bits", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(masks), MCOR_BUFFER(within), MCOR_BUFFER(counts)));
  return mcor_scan(context, counts, count, total);
}

static void mcor_swap(mcor_buffer* a, mcor_buffer* b)
{
  const mcor_buffer c = *a;
  *a = *b;
  *b = c;
}

/* Returns how many bits hold any number below a limit. */
static int mcor_bits_below(uint64_t limit)
{
  int bits = 1;
  while (bits < 64 && (limit - 1) >> bits)
  {
    ++bits;
  }
  return bits;
}

/* Sorts keys, which are below key_limit, in ascending order. values[i] becomes the former position
 * of the key that is now at i. Equal keys keep their order. */
mcor_status mcor_sort(
  mcor_context* context, mcor_buffer* keys, mcor_buffer* values, int count, uint64_t key_limit)
{
  const int segments = mcor_segments(context, count);
  const int key_bits = mcor_bits_below(key_limit), value_bits = mcor_bits_below((uint64_t)count);
  const size_t n = (size_t)count;
  /* Chooses how many bits one round treats. Rounds are as few as possible, and of about equal size.
   * With more than 8 bits in a round, the histogram is no larger than the sorted array. */
  int most = MCOR_DIGIT_BITS_OF(context->cl.lanes);
  while (most > 8 && segments << most > count)
  {
    --most;
  }
  const int rounds = (key_bits + most - 1) / most, bits = (key_bits + rounds - 1) / rounds;
  /* Between two rounds, each key shares one number with its value, if both fit into it. */
  const bool packs = key_bits + value_bits <= 64;
  mcor_buffer* sorted = packs ? values : &context->sort.values;
  MCOR_TRY(mcor_reserve(context, values, n * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, sorted, n * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &context->sort.keys, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(
    context, &context->sort.histogram, (((size_t)segments << bits) + 1) * sizeof(cl_int)));
  for (int shift = 0, in = 0, out; shift < key_bits; shift += bits, in = out)
  {
    out = packs && shift + bits < key_bits ? value_bits : 0;
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_sort_count", mcor_walk(count), segments, MCOR_BUFFER(keys),
      MCOR_INT(count), MCOR_INT(segments), MCOR_INT(shift + in), MCOR_INT(bits),
      MCOR_BUFFER(&context->sort.histogram)));
    const int counters = segments << bits; /* their sum is `count` */
    int64_t sum;
    MCOR_TRY(mcor_scan_segments(
      context, &context->sort.histogram, counters, mcor_segments(context, counters), &sum));
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_sort_fill", mcor_walk(count), segments, MCOR_BUFFER(keys),
      MCOR_BUFFER(values), MCOR_INT(count), MCOR_INT(segments), MCOR_INT(shift), MCOR_INT(bits),
      MCOR_INT(in), MCOR_INT(out), MCOR_BUFFER(&context->sort.histogram),
      MCOR_BUFFER(&context->sort.keys), MCOR_BUFFER(sorted)));
    mcor_swap(keys, &context->sort.keys);
    mcor_swap(values, sorted);
  }
  return MCOR_OK;
}

/* Flags the first key of each run of equal keys, and numbers the runs. `keys` are sorted. */
static mcor_status mcor_number_runs(
  mcor_context* context, const mcor_buffer* keys, int count, int* distinct_count)
{
  mcor_buffer* flags = &context->sort.flags;
  MCOR_TRY(mcor_reserve(context, flags, ((size_t)count + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_unique_count", MCOR_LIGHT, count, MCOR_BUFFER(keys),
    MCOR_INT(count), MCOR_BUFFER(flags)));
  return mcor_scan(context, flags, count, distinct_count);
}

/* Sorts `keys`, and lists the distinct ones. index_of[i] becomes the index, in this list, of the
 * key that was at i before sorting. */
mcor_status mcor_unique(mcor_context* context, mcor_buffer* keys, int count, uint64_t key_limit,
  mcor_buffer* distinct, mcor_buffer* index_of, int* distinct_count)
{
  mcor_buffer* values = &context->sort.order;
  *distinct_count = 0;
  if (count == 0)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_sort(context, keys, values, count, key_limit));
  MCOR_TRY(mcor_number_runs(context, keys, count, distinct_count));
  MCOR_TRY(mcor_reserve(context, distinct, (size_t)*distinct_count * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, index_of, (size_t)count * sizeof(cl_int)));
  return MCOR_LAUNCH(context, "mcor_unique_fill", MCOR_LIGHT, count, MCOR_BUFFER(keys),
    MCOR_BUFFER(values), MCOR_INT(count), MCOR_BUFFER(&context->sort.flags), MCOR_BUFFER(distinct),
    MCOR_BUFFER(index_of));
}

/* Lists the distinct keys among sorted keys. begins: for each distinct key, the index at which it
 * first occurs; then, as the last element, the number of all keys. */
mcor_status mcor_list_runs(mcor_context* context, const mcor_buffer* keys, int count,
  mcor_buffer* distinct, mcor_buffer* begins, int* distinct_count)
{
  MCOR_TRY(mcor_number_runs(context, keys, count, distinct_count));
  const size_t n = (size_t)*distinct_count;
  MCOR_TRY(mcor_reserve(context, distinct, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, begins, (n + 1) * sizeof(cl_int)));
  MCOR_TRY(
    MCOR_LAUNCH(context, "mcor_run_fill", MCOR_LIGHT, count, MCOR_BUFFER(keys), MCOR_INT(count),
      MCOR_BUFFER(&context->sort.flags), MCOR_BUFFER(distinct), MCOR_BUFFER(begins)));
  mcor_release(context, &context->sort.flags);
  return MCOR_OK;
}

/* Returns the most buckets for `keys` keys. Memory stays in proportion to the number of keys. */
uint64_t mcor_most_buckets(int keys)
{
  const uint64_t most = 4 * (uint64_t)keys + (1 << 20);
  return most < INT32_MAX / 2 ? most : INT32_MAX / 2;
}

/* Indexes sorted keys, which are below key_limit. Bucket b begins at the first key that is at least
 * b << *shift. */
mcor_status mcor_index_keys(mcor_context* context, const mcor_buffer* keys, int count,
  uint64_t key_limit, mcor_buffer* buckets, int* shift)
{
  *shift = 0;
  while (key_limit >> *shift > mcor_most_buckets(count))
  {
    ++*shift;
  }
  const uint64_t bucket_count = (key_limit >> *shift) + 2;
  MCOR_TRY(mcor_reserve(context, buckets, bucket_count * sizeof(cl_int)));
  const size_t per_item = MCOR_ITEM_BUCKETS_OF(context->cl.lanes);
  return MCOR_LAUNCH(context, "mcor_bucket_fill", MCOR_MEDIUM,
    (bucket_count + per_item - 1) / per_item, MCOR_BUFFER(keys), MCOR_INT(count), MCOR_INT(*shift),
    MCOR_INT((int)bucket_count), MCOR_BUFFER(buckets));
}
