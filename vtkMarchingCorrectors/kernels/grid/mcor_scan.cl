/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Prefix sums, stable radix sort, and lists of distinct keys. An array is cut into `segments` runs
 * of equal length; one work-item walks one run. */

#define MCOR_DIGIT_BITS MCOR_DIGIT_BITS_OF(MCOR_LANES)

int mcor_segment_begin(int segment, int segments, int count)
{
  return (int)((long)count * segment / segments);
}

/* One work-item = one segment. Reads the counts of the segment. Writes their sum. */
__kernel void mcor_scan_sum(
  __global const int* counts, const int count, const int segments, __global long* sums)
{
  MCOR_ITEM(segment, segment < segments);
  long sum = 0;
  const int end = mcor_segment_begin(segment + 1, segments, count);
  for (int i = mcor_segment_begin(segment, segments, count); i < end; ++i)
  {
    sum += counts[i];
  }
  sums[segment] = sum;
}

/* One work-item = one segment. Reads counts, and the prefix sums of the segments' sums. Replaces
 * the counts by their exclusive prefix sums. Writes the total to element `count`. */
__kernel void mcor_scan_fill(
  __global int* counts, const int count, const int segments, __global const long* sums)
{
  MCOR_ITEM(segment, segment < segments);
  long sum = sums[segment];
  const int end = mcor_segment_begin(segment + 1, segments, count);
  for (int i = mcor_segment_begin(segment, segments, count); i < end; ++i)
  {
    const int c = counts[i];
    counts[i] = (int)sum;
    sum += c;
  }
  if (segment == segments - 1)
  {
    counts[count] = (int)sum;
  }
}

/* One work-item = one segment. Reads the segment's keys. Writes how often each value of the digit
 * occurs. The digit of a key has `bits` bits, from bit `shift` on. */
__kernel void mcor_sort_count(__global const ulong* keys, const int count, const int segments,
  const int shift, const int bits, __global int* histogram)
{
  MCOR_ITEM(segment, segment < segments);
  int bins[1 << MCOR_DIGIT_BITS];
  const int radix = 1 << bits;
  for (int b = 0; b < radix; ++b)
  {
    bins[b] = 0;
  }
  const int end = mcor_segment_begin(segment + 1, segments, count);
  for (int i = mcor_segment_begin(segment, segments, count); i < end; ++i)
  {
    ++bins[(int)(keys[i] >> shift) & (radix - 1)];
  }
  for (int b = 0; b < radix; ++b)
  {
    histogram[b * segments + segment] = bins[b];
  }
}

/* One work-item = one segment. Reads keys, values (in the first round the value of key i is i) and
 * the scanned histogram. Writes keys and values in the order of the digit; equal digits keep their
 * order. If in_bits is above 0, each number of `keys` has the value in its lowest in_bits bits, and
 * the key above. If in_bits is 0, values are an array of their own. out_bits: the same for the
 * sorted numbers. */
__kernel void mcor_sort_fill(__global const ulong* keys, __global const int* values,
  const int count, const int segments, const int shift, const int bits, const int in_bits,
  const int out_bits, __global const int* histogram, __global ulong* sorted_keys,
  __global int* sorted_values)
{
  MCOR_ITEM(segment, segment < segments);
  int bins[1 << MCOR_DIGIT_BITS];
  const int radix = 1 << bits;
  for (int b = 0; b < radix; ++b)
  {
    bins[b] = histogram[b * segments + segment];
  }
  const int end = mcor_segment_begin(segment + 1, segments, count);
  for (int i = mcor_segment_begin(segment, segments, count); i < end; ++i)
  {
    const ulong key = keys[i] >> in_bits;
    const ulong value = in_bits > 0 ? keys[i] - (key << in_bits) : shift == 0 ? i : values[i];
    const int to = bins[(int)(key >> shift) & (radix - 1)]++;
    sorted_keys[to] = out_bits > 0 ? key << out_bits | value : key;
    if (out_bits == 0)
    {
      sorted_values[to] = (int)value;
    }
  }
}

/* One work-item = one sorted key. Writes 1 if the key differs from the key before it, or is the
 * first; else 0. */
__kernel void mcor_unique_count(__global const ulong* keys, const int count, __global int* flags)
{
  MCOR_ITEM(i, i < count);
  flags[i] = i == 0 || keys[i] != keys[i - 1];
}

/* One work-item = one sorted key. Reads keys and scanned flags. Writes each distinct key once.
 * Writes to index_of[values[i]] the index of key i among the distinct keys. */
__kernel void mcor_unique_fill(__global const ulong* keys, __global const int* values,
  const int count, __global const int* scanned, __global ulong* distinct, __global int* index_of)
{
  MCOR_ITEM(i, i < count);
  const bool first = i == 0 || keys[i] != keys[i - 1];
  const int index = scanned[i + 1] - 1;
  if (first)
  {
    distinct[index] = keys[i];
  }
  index_of[values[i]] = index;
}

/* One work-item = one sorted key. Reads keys and scanned flags. Writes each distinct key once, and
 * to `begins` the index of its first occurrence. The last entry of `begins` is `count`. */
__kernel void mcor_run_fill(__global const ulong* keys, const int count,
  __global const int* scanned, __global ulong* distinct, __global int* begins)
{
  MCOR_ITEM(i, i < count);
  if (i == 0 || keys[i] != keys[i - 1])
  {
    distinct[scanned[i]] = keys[i];
    begins[scanned[i]] = i;
  }
  if (i == count - 1)
  {
    begins[scanned[count]] = count;
  }
}

#define MCOR_ITEM_BUCKETS MCOR_ITEM_BUCKETS_OF(MCOR_LANES)

/* One work-item = MCOR_ITEM_BUCKETS buckets. Reads sorted keys. Bucket b begins at key b << shift.
 * Writes, for each bucket, the index of the first sorted key that is at least the bucket's first
 * key. */
__kernel void mcor_bucket_fill(__global const ulong* keys, const int count, const int shift,
  const int bucket_count, __global int* buckets)
{
  const long begin = (long)get_global_id(0) * MCOR_ITEM_BUCKETS;
  const long end = min(begin + MCOR_ITEM_BUCKETS, (long)bucket_count);
  int first = begin < end ? mcor_find_key(keys, 0, count, (ulong)begin << shift) : 0;
  for (long b = begin; b < end; ++b)
  {
    while (first < count && keys[first] >> shift < (ulong)b)
    {
      ++first;
    }
    buckets[b] = first;
  }
}

/* One work-item = one point. Reads the scanned flags of mcor_group_count. Writes where each group
 * starts, and in the last entry where the last group ends. */
__kernel void mcor_group_fill(
  const int first, const int count, __global const int* scanned, __global int* groups)
{
  const int i = get_global_id(0);
  if (i < count && scanned[i] != scanned[i + 1])
  {
    groups[scanned[i]] = first + i;
  }
  if (i == count)
  {
    groups[scanned[count]] = first + count;
  }
}
