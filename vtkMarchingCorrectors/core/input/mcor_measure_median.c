/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Values in the middle: the median of the scalar, which the device subtracts from all values; a
 * default iso value; and the median of a few numbers. Medians of particles are found by counting
 * values in bins, then counting again within the bin that holds the median. The result depends
 * neither on the order of the particles nor on how ranks share them. */

#include "mcor_input.h"

#include <math.h>
#include <stdlib.h>

#define MCOR_BINS 1024
#define MCOR_MEDIAN_PASSES 8
#define MCOR_ISO_PASSES 64

#define MCOR_THREE_DECADES 1000.0

/* A value at most this share of the range away from an end of the range counts as at the end. */
#define MCOR_NEAR_END 0.01

/* If high values are more than this many times the low ones, and the median is at an end of the
 * range, the low values count as zeros that rounding has changed. */
#define MCOR_MANY_DECADES 1e6

typedef struct mcor_bin_job
{
  const mcor_input* input;
  double low, high; /* the bins' range */
  int64_t count[MCOR_SLICES][MCOR_BINS];
  double least[MCOR_SLICES][MCOR_BINS]; /* least value in each bin, and minus the greatest */
  double minus[MCOR_SLICES][MCOR_BINS];
} mcor_bin_job;

static void mcor_fill_bins(void* data, int slice, int64_t first, int64_t last)
{
  mcor_bin_job* job = data;
  const uint8_t* solid = job->input->solid;
  const double width = job->high / MCOR_BINS - job->low / MCOR_BINS;
  double chunk[MCOR_CHUNK], part[MCOR_CHUNK];
  for (int b = 0; b < MCOR_BINS; ++b)
  {
    job->count[slice][b] = 0;
    job->least[slice][b] = job->minus[slice][b] = INFINITY;
  }
  for (int n; (n = mcor_chunk_of(last - first)) > 0; first += n)
  {
    mcor_read_scalar(job->input, first, n, chunk);
    for (int i = 0; i < n; ++i)
    {
      /* Halves both values, because their difference may overflow. */
      part[i] = (0.5 * chunk[i] - 0.5 * job->low) / width * 2;
    }
    for (int i = 0; i < n; ++i)
    {
      const double v = chunk[i];
      if (isfinite(v) && v >= job->low && v <= job->high && !(solid && solid[first + i]))
      {
        const int b = part[i] < MCOR_BINS - 1 ? (int)part[i] : MCOR_BINS - 1;
        double *least = &job->least[slice][b], *minus = &job->minus[slice][b];
        ++job->count[slice][b];
        *least = v < *least ? v : *least;
        *minus = -v < *minus ? -v : *minus;
      }
    }
  }
}

/* Counts values by bin; the sums over all slices and ranks end in slice 0. */
static mcor_status mcor_make_bins(mcor_context* context, mcor_bin_job* job)
{
  int slices;
  mcor_fill_bins(job, 0, 0, 0); /* no slice fills the bins if there are no particles */
  MCOR_TRY(
    mcor_parallel_run(context, job->input->count, MCOR_LIGHT_GRAIN, mcor_fill_bins, job, &slices));
  for (int n = MCOR_BINS; n < slices * MCOR_BINS; ++n)
  {
    const int s = n / MCOR_BINS, b = n % MCOR_BINS;
    job->count[0][b] += job->count[s][b];
    job->least[0][b] = fmin(job->least[0][b], job->least[s][b]);
    job->minus[0][b] = fmin(job->minus[0][b], job->minus[s][b]);
  }
  MCOR_TRY(mcor_reduce_counts(context, MCOR_SUM_OF, job->count[0], MCOR_BINS));
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_LEAST, job->least[0], MCOR_BINS));
  return mcor_reduce_doubles(context, MCOR_LEAST, job->minus[0], MCOR_BINS);
}

/* Narrows the bins' range to the bin that holds value `number` in ascending order (from 0). Repeats
 * this until the bin has fewer than `many` values, at most `passes` times. A bin's range ends at
 * its least and its greatest value, so that a huge outlier does not move the median. */
static mcor_status mcor_narrow_bins(
  mcor_context* context, mcor_bin_job* job, int passes, int64_t number, int64_t many)
{
  int64_t count = many;
  for (int pass = 0; pass < passes && count >= many; ++pass)
  {
    if (!(job->high / MCOR_BINS - job->low / MCOR_BINS > 0))
    {
      break;
    }
    MCOR_TRY(mcor_make_bins(context, job));
    int b = 0;
    for (; b < MCOR_BINS - 1 && number >= job->count[0][b]; ++b)
    {
      number -= job->count[0][b];
    }
    count = job->count[0][b];
    if (count == 0)
    {
      break;
    }
    job->low = job->least[0][b];
    job->high = -job->minus[0][b];
  }
  return MCOR_OK;
}

mcor_status mcor_find_median(mcor_context* context, const mcor_input* input, double* median)
{
  const mcor_measure* m = &context->measure;
  mcor_bin_job* job = malloc(sizeof *job);
  MCOR_TRY(mcor_allocated(context, job));
  job->input = input;
  job->low = m->scalar_min;
  job->high = m->scalar_max;
  const mcor_status status = mcor_narrow_bins(
    context, job, MCOR_MEDIAN_PASSES, (m->fluid_count - 1) / 2, m->fluid_count / 16);
  *median = 0.5 * job->low + 0.5 * job->high;
  free(job);
  return status;
}

/* ---- An iso value ---- */

static bool mcor_choose_iso(
  mcor_context* context, mcor_bin_job* job, double range[2], double* iso_value)
{
  double found[2] = { INFINITY, -INFINITY }, value[5];
  int64_t count = 0;
  job->low = -INFINITY; /* the last bin holds all of the values */
  job->high = INFINITY;
  if (mcor_make_bins(context, job) != MCOR_OK)
  {
    return false;
  }
  for (int b = 0; b < MCOR_BINS; ++b)
  {
    count += job->count[0][b];
    found[0] = fmin(found[0], job->least[0][b]);
    found[1] = fmax(found[1], -job->minus[0][b]);
  }
  /* Finds five values by narrowing bins: the values 2 % and 5 % from either end, and the median. */
  const int64_t numbers[5] = { count / 50, count - 1 - count / 50, count / 20,
    count - 1 - count / 20, (count - 1) / 2 };
  for (int i = 0; i < 5; ++i)
  {
    job->low = found[0];
    job->high = found[1];
    if (count == 0 || mcor_narrow_bins(context, job, MCOR_ISO_PASSES, numbers[i], 1) != MCOR_OK)
    {
      return false;
    }
    value[i] = job->low;
  }
  const double *ends = value, *most = value + 2, median = value[4];
  /* The median may show nothing. If most values are alike (walls at rest, gas before a shock), the
   * median's surface is noise or empty, so the middle of the range is chosen. If values span
   * decades, the median is far below the greatest ones, so a geometric mean is chosen. */
  const double* span = most[0] < most[1] ? most : found;
  const double near = MCOR_NEAR_END * (span[1] - span[0]), ratio = ends[1] / ends[0];
  const bool at_end = median - span[0] <= near || span[1] - median <= near;
  const bool decades =
    ends[0] > 0 && ratio >= MCOR_THREE_DECADES && (ratio <= MCOR_MANY_DECADES || !at_end);
  *iso_value = decades && found[0] > 0 ? sqrt(ends[0]) * sqrt(ends[1])
    : at_end && !decades               ? 0.5 * span[0] + 0.5 * span[1]
                                       : median;
  range[0] = found[0];
  range[1] = found[1];
  return true;
}

int mcor_find_iso_value(
  const mcor_input* input, const mcor_ranks* ranks, double range[2], double* iso_value)
{
  const mcor_options options = { .ranks = ranks };
  mcor_context* context = mcor_make_bare_context(&options);
  mcor_bin_job* job = malloc(sizeof *job);
  bool found = false;
  if (context && job)
  {
    job->input = input;
    int64_t wrong = input->count > 0 && mcor_check_scalar_form(context, input) != MCOR_OK;
    found = mcor_reduce_counts(context, MCOR_SUM_OF, &wrong, 1) == MCOR_OK && wrong == 0 &&
      mcor_choose_iso(context, job, range, iso_value);
  }
  free(job);
  mcor_free_bare_context(context);
  return found;
}

/* ---- The median of a few numbers ---- */

int mcor_compare_doubles(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

double mcor_median_of(double* values, int count)
{
  qsort(values, (size_t)count, sizeof *values, mcor_compare_doubles);
  return count > 0 ? values[count / 2] : 0;
}
