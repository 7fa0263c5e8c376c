/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* An iso value for those who have named none. Values are counted in bins, and those in the bin that is
 * looked for again, until it holds one value alone: what is found depends neither on the order of the
 * particles nor on who of several ranks has which. */

#include "mcor_input.h"
#include "mcor_parallel.h"

#include <math.h>
#include <stdlib.h>

#define MCOR_ISO_BINS 512
#define MCOR_ISO_PASSES 64

#define MCOR_THREE_DECADES 1000.0

typedef struct mcor_iso_job
{
  const mcor_input* input;
  const mcor_ranks* ranks;
  double low, high; /* of the bins */
  int64_t count[MCOR_SLICES][MCOR_ISO_BINS];
  double least[MCOR_SLICES][MCOR_ISO_BINS]; /* of the values in it, and minus the greatest */
  double minus[MCOR_SLICES][MCOR_ISO_BINS];
} mcor_iso_job;

/* Which of the bins holds a value; halved, as the difference may be too large for a number. */
static int mcor_iso_bin(const mcor_iso_job* job, double value)
{
  const double width = 0.5 * job->high - 0.5 * job->low;
  const double part = width > 0 ? (0.5 * value - 0.5 * job->low) / width * MCOR_ISO_BINS : 0;
  return part < MCOR_ISO_BINS - 1 ? (int)part : MCOR_ISO_BINS - 1;
}

static void mcor_fill_iso_bins(void* data, int slice, int64_t first, int64_t last)
{
  mcor_iso_job* job = data;
  const uint8_t* solid = job->input->solid;
  double chunk[MCOR_CHUNK];
  for (int b = 0; b < MCOR_ISO_BINS; ++b)
  {
    job->count[slice][b] = 0;
    job->least[slice][b] = job->minus[slice][b] = INFINITY;
  }
  for (int64_t i = first; i < last; ++i)
  {
    const int64_t at = (i - first) % MCOR_CHUNK, rest = last - i;
    if (at == 0)
    {
      mcor_read_scalar(job->input, i, rest < MCOR_CHUNK ? (int)rest : MCOR_CHUNK, chunk);
    }
    const double v = chunk[at];
    if (isfinite(v) && v >= job->low && v <= job->high && !(solid && solid[i]))
    {
      const int b = mcor_iso_bin(job, v);
      ++job->count[slice][b];
      job->least[slice][b] = fmin(job->least[slice][b], v);
      job->minus[slice][b] = fmin(job->minus[slice][b], -v);
    }
  }
}

/* Those of all particles, of all ranks, end in the first slice. */
static bool mcor_make_iso_bins(mcor_iso_job* job)
{
  mcor_fill_iso_bins(job, 0, 0, 0); /* where there are no particles, nobody does */
  const int slices =
    mcor_parallel_for(job->input->count, MCOR_LIGHT_GRAIN, mcor_fill_iso_bins, job);
  for (int n = MCOR_ISO_BINS; n < slices * MCOR_ISO_BINS; ++n)
  {
    const int s = n / MCOR_ISO_BINS, b = n % MCOR_ISO_BINS;
    job->count[0][b] += job->count[s][b];
    job->least[0][b] = fmin(job->least[0][b], job->least[s][b]);
    job->minus[0][b] = fmin(job->minus[0][b], job->minus[s][b]);
  }
  const mcor_ranks* ranks = job->ranks;
  return !ranks ||
    (ranks->reduce_counts(ranks->user, MCOR_SUM_OF, job->count[0], MCOR_ISO_BINS) == 0 &&
      ranks->reduce_doubles(ranks->user, MCOR_LEAST, job->least[0], MCOR_ISO_BINS) == 0 &&
      ranks->reduce_doubles(ranks->user, MCOR_LEAST, job->minus[0], MCOR_ISO_BINS) == 0);
}

/* Of the values in order the one of this number. */
static bool mcor_select_iso(mcor_iso_job* job, const double range[2], int64_t number, double* value)
{
  job->low = range[0];
  job->high = range[1];
  for (int pass = 0; pass < MCOR_ISO_PASSES && job->low < job->high; ++pass)
  {
    if (!mcor_make_iso_bins(job))
    {
      return false;
    }
    int b = 0;
    for (; b < MCOR_ISO_BINS - 1 && number >= job->count[0][b]; ++b)
    {
      number -= job->count[0][b];
    }
    job->low = job->least[0][b];
    job->high = -job->minus[0][b];
  }
  *value = job->low;
  return true;
}

static bool mcor_choose_iso(mcor_iso_job* job, double range[2], double* iso_value)
{
  double found[2] = { INFINITY, -INFINITY }, ends[2], median;
  int64_t count = 0;
  job->low = -INFINITY; /* all are in the last bin */
  job->high = INFINITY;
  if (!mcor_make_iso_bins(job))
  {
    return false;
  }
  for (int b = 0; b < MCOR_ISO_BINS; ++b)
  {
    count += job->count[0][b];
    found[0] = fmin(found[0], job->least[0][b]);
    found[1] = fmax(found[1], -job->minus[0][b]);
  }
  if (count == 0 || !mcor_select_iso(job, found, count / 50, &ends[0]) ||
    !mcor_select_iso(job, found, count - 1 - count / 50, &ends[1]) ||
    !mcor_select_iso(job, found, (count - 1) / 2, &median))
  {
    return false;
  }
  const bool decades = found[0] > 0 && ends[1] / ends[0] >= MCOR_THREE_DECADES;
  *iso_value = decades ? sqrt(ends[0]) * sqrt(ends[1]) : median;
  range[0] = found[0];
  range[1] = found[1];
  return true;
}

int mcor_find_iso_value(
  const mcor_input* input, const mcor_ranks* ranks, double range[2], double* iso_value)
{
  mcor_iso_job* job = malloc(sizeof *job);
  if (!job)
  {
    return 0;
  }
  job->input = input;
  job->ranks = ranks;
  const bool found = mcor_choose_iso(job, range, iso_value);
  free(job);
  return found;
}
