/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Medians: about that of the scalar, and that of a few numbers. */

#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_ranks.h"

#include <stdlib.h>

#define MCOR_MEDIAN_BINS 1024
#define MCOR_MEDIAN_PASSES 8

typedef struct mcor_bin
{
  int64_t count;
  double low, high; /* of the values in it */
} mcor_bin;

typedef struct mcor_bin_job
{
  const mcor_input* input;
  double low, high;
  mcor_bin (*bins)[MCOR_MEDIAN_BINS]; /* [MCOR_SLICES] */
} mcor_bin_job;

/* Sorts the values of fluid particles in [low, high] into bins. */
static void mcor_fill_bins(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_bin_job* job = data;
  const mcor_input* input = job->input;
  const double low = job->low, high = job->high;
  const double width = high / MCOR_MEDIAN_BINS - low / MCOR_MEDIAN_BINS;
  mcor_bin* bins = job->bins[slice];
  for (int b = 0; b < MCOR_MEDIAN_BINS; ++b)
  {
    bins[b] = (mcor_bin){ 0, high, low };
  }
  double chunk[MCOR_CHUNK];
  for (int64_t i = first; i < last; ++i)
  {
    const int64_t at = (i - first) % MCOR_CHUNK, rest = last - i;
    if (at == 0)
    {
      mcor_read_scalar(input, i, rest < MCOR_CHUNK ? (int)rest : MCOR_CHUNK, chunk);
    }
    const double v = chunk[at];
    if ((!input->solid || !input->solid[i]) && v >= low && v <= high)
    {
      /* Halved, as the difference may be too large for a number. */
      const int b = (int)((0.5 * v - 0.5 * low) / width * 2);
      mcor_bin* bin = bins + (b < MCOR_MEDIAN_BINS ? b : MCOR_MEDIAN_BINS - 1);
      ++bin->count;
      bin->low = v < bin->low ? v : bin->low;
      bin->high = v > bin->high ? v : bin->high;
    }
  }
}

static mcor_status mcor_merge_bins(mcor_context* context, mcor_bin* bins)
{
  int64_t count[MCOR_MEDIAN_BINS];
  double low[MCOR_MEDIAN_BINS], high[MCOR_MEDIAN_BINS];
  for (int b = 0; b < MCOR_MEDIAN_BINS; ++b)
  {
    count[b] = bins[b].count;
    low[b] = bins[b].low;
    high[b] = bins[b].high;
  }
  MCOR_TRY(mcor_reduce_counts(context, MCOR_SUM_OF, count, MCOR_MEDIAN_BINS));
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_LEAST, low, MCOR_MEDIAN_BINS));
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_GREATEST, high, MCOR_MEDIAN_BINS));
  for (int b = 0; b < MCOR_MEDIAN_BINS; ++b)
  {
    bins[b] = (mcor_bin){ count[b], low[b], high[b] };
  }
  return MCOR_OK;
}

/* The bins of all particles, of all ranks, end in the first ones. */
static mcor_status mcor_make_bins(mcor_context* context, mcor_bin_job* job)
{
  mcor_bin* all = job->bins[0];
  mcor_fill_bins(job, 0, 0, 0); /* where there are no particles, nobody does */
  int slices;
  MCOR_TRY(
    mcor_parallel_run(context, job->input->count, MCOR_LIGHT_GRAIN, mcor_fill_bins, job, &slices));
  for (int s = 1; s < slices; ++s)
  {
    for (int b = 0; b < MCOR_MEDIAN_BINS; ++b)
    {
      const mcor_bin* bin = &job->bins[s][b];
      all[b].count += bin->count;
      all[b].low = bin->low < all[b].low ? bin->low : all[b].low;
      all[b].high = bin->high > all[b].high ? bin->high : all[b].high;
    }
  }
  return mcor_merge_bins(context, all);
}

/* Of the bin that holds the median, while many are in that bin. A bin ends where its values do, so
 * that a huge outlier does not move the median away from them. Counts, and least and greatest
 * values, do not depend on the order of the particles. */
static mcor_status mcor_narrow_median(
  mcor_context* context, mcor_bin_job* job, int64_t fluid_count, double* median)
{
  int64_t below = 0;
  for (int pass = 0; pass < MCOR_MEDIAN_PASSES; ++pass)
  {
    if (!(job->high / MCOR_MEDIAN_BINS - job->low / MCOR_MEDIAN_BINS > 0))
    {
      break;
    }
    MCOR_TRY(mcor_make_bins(context, job));
    const mcor_bin* bin = job->bins[0];
    const mcor_bin* last = bin + MCOR_MEDIAN_BINS - 1;
    for (; bin < last && 2 * (below + bin->count) < fluid_count; ++bin)
    {
      below += bin->count;
    }
    if (bin->count == 0)
    {
      break;
    }
    job->low = bin->low;
    job->high = bin->high;
    if (bin->count < fluid_count / 16)
    {
      break;
    }
  }
  *median = 0.5 * job->low + 0.5 * job->high;
  return MCOR_OK;
}

mcor_status mcor_find_median(mcor_context* context, const mcor_input* input, double* median)
{
  const mcor_measure* m = &context->measure;
  mcor_bin_job job = { input, m->scalar_min, m->scalar_max,
    malloc(MCOR_SLICES * sizeof *job.bins) };
  MCOR_RETURN_IF(!job.bins, context, MCOR_OUT_OF_CAPACITY, "Host memory for the median ran out.");
  const mcor_status status = mcor_narrow_median(context, &job, m->fluid_count, median);
  free(job.bins);
  return status;
}

static int mcor_compare_doubles(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

double mcor_median_of(double* values, int count)
{
  qsort(values, (size_t)count, sizeof *values, mcor_compare_doubles);
  return count > 0 ? values[count / 2] : 0;
}
