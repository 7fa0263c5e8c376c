/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Estimates one smoothing length for particles that have none. */

#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_ranks.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_SAMPLE_NEIGHBOURS 32

/* Squared, scaled distances from a sample to itself and its 32 nearest others (or all there
 * are), ascending. */
typedef struct mcor_neighbours
{
  int count;
  double d2[MCOR_SAMPLE_NEIGHBOURS + 1];
} mcor_neighbours;

static void mcor_add_neighbours(mcor_neighbours* nearest, const double* d2, int count)
{
  for (int i = 0; i < count; ++i)
  {
    const bool full = nearest->count == MCOR_SAMPLE_NEIGHBOURS + 1;
    if (!full || d2[i] < nearest->d2[MCOR_SAMPLE_NEIGHBOURS])
    {
      int to = full ? MCOR_SAMPLE_NEIGHBOURS : nearest->count++;
      for (; to > 0 && nearest->d2[to - 1] > d2[i]; --to)
      {
        nearest->d2[to] = nearest->d2[to - 1];
      }
      nearest->d2[to] = d2[i];
    }
  }
}

typedef struct mcor_spacing
{
  const mcor_input* input;
  double scale; /* a power of 2 that brings all coordinates below 1 */
  mcor_samples_found samples;
  mcor_neighbours nearest[MCOR_SAMPLES];
} mcor_spacing;

/* Finds, for each sample of a slice, the nearest of this rank's particles. */
static void mcor_near_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_spacing* job = data;
  const double scale = job->scale;
  double x[3][MCOR_CHUNK], d2[MCOR_CHUNK];
  for (int64_t begin = 0; begin < job->input->count; begin += MCOR_CHUNK)
  {
    const int read = mcor_chunk_of(job->input->count - begin);
    int count = 0; /* of present, finite particles, which move to the front */
    mcor_read_positions(job->input, begin, read, x);
    for (int i = 0; i < read; ++i)
    {
      for (int a = 0; a < 3; ++a)
      {
        x[a][count] = x[a][i];
      }
      count += !job->input->solid ||
        (mcor_is_present(job->input, begin + i) && isfinite(x[0][i]) && isfinite(x[1][i]) &&
          isfinite(x[2][i]));
    }
    for (int64_t s = first; s < last; ++s)
    {
      const double* at = job->samples.sample[s].x;
      for (int i = 0; i < count; ++i)
      {
        const double dx = x[0][i] * scale - at[0] * scale, dy = x[1][i] * scale - at[1] * scale,
                     dz = x[2][i] * scale - at[2] * scale;
        d2[i] = dx * dx + dy * dy + dz * dz;
      }
      mcor_add_neighbours(&job->nearest[s], d2, count);
    }
  }
  (void)slice;
}

/* Finds each sample's farthest neighbour over all ranks, and the number of neighbours: bit by
 * bit, since ranks exchange counts only. */
static mcor_status mcor_find_farthest(mcor_context* context, const mcor_spacing* job,
  double farthest[MCOR_SAMPLES], int64_t neighbours[MCOR_SAMPLES])
{
  const int count = job->samples.count;
  int64_t below[MCOR_SAMPLES] = { 0 }, found[MCOR_SAMPLES];
  for (int s = 0; s < count; ++s)
  {
    neighbours[s] = job->nearest[s].count;
  }
  MCOR_TRY(mcor_reduce_counts(context, MCOR_SUM_OF, neighbours, count));
  for (int s = 0; s < count; ++s)
  {
    neighbours[s] =
      neighbours[s] < MCOR_SAMPLE_NEIGHBOURS + 1 ? neighbours[s] : MCOR_SAMPLE_NEIGHBOURS + 1;
  }
  for (int bit = 62; bit >= 0; --bit)
  {
    for (int s = 0; s < count; ++s)
    {
      /* Bits of numbers above 0 have the order of the numbers. */
      const int64_t bits = below[s] + ((INT64_C(1) << bit) - 1);
      const mcor_neighbours* nearest = &job->nearest[s];
      double limit;
      memcpy(&limit, &bits, sizeof limit);
      for (found[s] = 0; found[s] < nearest->count && nearest->d2[found[s]] <= limit;)
      {
        ++found[s];
      }
    }
    MCOR_TRY(mcor_reduce_counts(context, MCOR_SUM_OF, found, count));
    for (int s = 0; s < count; ++s)
    {
      below[s] += found[s] < neighbours[s] ? INT64_C(1) << bit : 0;
    }
  }
  memcpy(farthest, below, (size_t)count * sizeof *farthest);
  return MCOR_OK;
}

double mcor_cube_root(double value)
{
  int exponent;
  double rest = frexp(value, &exponent), root = 1;
  for (; exponent % 3; ++exponent)
  {
    rest /= 2;
  }
  for (int i = 0; i < 9; ++i) /* Newton's method, from above; rest is from 1/8 to 1 */
  {
    root = (2 * root + rest / (root * root)) / 3;
  }
  return ldexp(root, exponent / 3);
}

/* Returns 1.3 times the median spacing: that of a lattice with as many particles within the
 * distance of the 32nd neighbour. */
static mcor_status mcor_find_spacing(
  mcor_context* context, const mcor_input* input, mcor_spacing* job, double* estimate)
{
  double spacing[MCOR_SAMPLES], largest[3];
  int64_t neighbours[MCOR_SAMPLES];
  int exponent = 0, most = INT_MIN;
  job->samples.most = MCOR_SAMPLES;
  job->input = input;
  for (int a = 0; a < 3; ++a)
  {
    largest[a] = mcor_largest(context, input, &input->positions, a);
  }
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_GREATEST, largest, 3));
  for (int a = 0; a < 3; ++a)
  {
    frexp(largest[a], &exponent);
    most = exponent > most ? exponent : most;
  }
  job->scale = ldexp(1, most > -1000 ? -most : 1000);
  MCOR_TRY(mcor_choose_samples(context, input, MCOR_ALL_PARTICLES, &job->samples));
  const int count = job->samples.count;
  MCOR_TRY(mcor_parallel_run(context, count, 1, mcor_near_slice, job, NULL));
  MCOR_TRY(mcor_find_farthest(context, job, spacing, neighbours));
  for (int s = 0; s < count; ++s)
  {
    const double share = context->space.ball / (double)neighbours[s];
    spacing[s] =
      sqrt(spacing[s]) * (context->space.axes == 2 ? sqrt(share) : mcor_cube_root(share));
  }
  *estimate = 1.3 * mcor_median_of(spacing, count) / job->scale;
  return MCOR_OK;
}

mcor_status mcor_estimate_smoothing_length(
  mcor_context* context, const mcor_input* input, double* estimate)
{
  mcor_spacing* job = calloc(1, sizeof *job);
  MCOR_TRY(mcor_allocated(context, job));
  const mcor_status status = mcor_find_spacing(context, input, job, estimate);
  free(job);
  MCOR_TRY(status);
  MCOR_RETURN_IF(!(*estimate > 0), context, MCOR_INVALID_DATA,
    "The smoothing length cannot be estimated: most particles lie at one point.");
  return MCOR_OK;
}
