/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Chooses a few particles that stand for all: those whose positions have the least hashes. So
 * neither the order of the input matters, nor how ranks share the particles. From such a sample one
 * smoothing length is estimated for particles that have none. */

#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_ranks.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint64_t mcor_hash_position(const double x[3])
{
  uint64_t hash = 0x9E3779B97F4A7C15u;
  for (int a = 0; a < 3; ++a)
  {
    uint64_t bits;
    memcpy(&bits, x + a, sizeof bits);
    hash = (hash ^ bits) * 0xBF58476D1CE4E5B9u;
    hash ^= hash >> 31;
  }
  return hash;
}

/* Orders particles at one place by their other values. */
static bool mcor_comes_before(const mcor_sample* a, const mcor_sample* b)
{
  return a->hash != b->hash ? a->hash < b->hash
    : a->h != b->h          ? a->h < b->h
                            : a->volume < b->volume;
}

static void mcor_add_sample(mcor_samples_found* found, const mcor_sample* sample)
{
  if (found->count == found->most)
  {
    if (!mcor_comes_before(sample, &found->sample[found->most - 1]))
    {
      return;
    }
    --found->count;
  }
  int to = found->count++;
  for (; to > 0 && mcor_comes_before(sample, &found->sample[to - 1]); --to)
  {
    found->sample[to] = found->sample[to - 1];
  }
  found->sample[to] = *sample;
}

typedef struct mcor_sampling
{
  const mcor_context* context;
  const mcor_input* input;
  mcor_sampled which;
  mcor_samples_found* found; /* [MCOR_SLICES] */
} mcor_sampling;

static void mcor_sample_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_sampling* job = data;
  const mcor_input* input = job->input;
  mcor_samples_found* found = &job->found[slice];
  const bool any = job->which == MCOR_ALL_PARTICLES, solids = job->which == MCOR_SOLID_PARTICLES;
  double x[3][MCOR_CHUNK];
  for (int64_t begin = first; begin < last; begin += MCOR_CHUNK)
  {
    const int count = mcor_chunk_of(last - begin);
    mcor_read_positions(input, begin, count, x);
    for (int i = 0; i < count; ++i)
    {
      const int64_t particle = begin + i;
      const bool is_solid = input->solid && input->solid[particle];
      mcor_sample sample = { .x = { x[0][i], x[1][i], x[2][i] } };
      if ((is_solid && !mcor_is_present(input, particle)) || (!any && is_solid != solids) ||
        !isfinite(x[0][i]) || !isfinite(x[1][i]) || !isfinite(x[2][i]))
      {
        continue;
      }
      sample.hash = mcor_hash_position(sample.x);
      if (found->count == found->most && sample.hash > found->sample[found->most - 1].hash)
      {
        continue;
      }
      if (!any && !solids)
      {
        mcor_read_smoothing_length(job->context, input, particle, 1, &sample.h);
        mcor_read_size(input, particle, mcor_needs_density(input) ? 0 : 1, &sample.volume);
      }
      mcor_add_sample(found, &sample);
    }
  }
}

mcor_status mcor_choose_samples(
  mcor_context* context, const mcor_input* input, mcor_sampled which, mcor_samples_found* chosen)
{
  mcor_sampling job = { .context = context, .input = input, .which = which };
  job.found = malloc(MCOR_SLICES * sizeof *job.found);
  MCOR_TRY(mcor_allocated(context, job.found));
  for (int s = 0; s < MCOR_SLICES; ++s)
  {
    job.found[s].count = 0;
    job.found[s].most = chosen->most;
  }
  int slices;
  mcor_status status =
    mcor_parallel_run(context, input->count, MCOR_HEAVY_GRAIN, mcor_sample_slice, &job, &slices);
  for (int s = 1; s < slices && status == MCOR_OK; ++s)
  {
    for (int i = 0; i < job.found[s].count; ++i)
    {
      mcor_add_sample(&job.found[0], &job.found[s].sample[i]);
    }
  }
  const mcor_sample* own = job.found[0].sample;
  const void* all = own;
  int64_t count = job.found[0].count;
  MCOR_THEN(status, mcor_gather(context, own, count, sizeof *own, &all, &count));
  if (all != own && status == MCOR_OK)
  {
    job.found[0].count = 0;
    for (int64_t i = 0; i < count; ++i)
    {
      mcor_add_sample(&job.found[0], (const mcor_sample*)all + i);
    }
  }
  *chosen = job.found[0];
  free(job.found);
  return status;
}

/* ---- One smoothing length for all ---- */

#define MCOR_SAMPLE_NEIGHBOURS 32

/* Squared, scaled distances from a sample to itself and its 32 nearest others (or all there
 * are), ascending. */
typedef struct mcor_neighbours
{
  int sample, count;
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

/* Merges the nearest neighbours that all ranks have found. */
static mcor_status mcor_merge_neighbours(mcor_context* context, mcor_spacing* job)
{
  const void* found;
  int64_t count = job->samples.count;
  for (int s = 0; s < job->samples.count; ++s)
  {
    job->nearest[s].sample = s;
  }
  MCOR_TRY(mcor_gather(context, job->nearest, count, sizeof *job->nearest, &found, &count));
  if (found == job->nearest)
  {
    return MCOR_OK;
  }
  for (int s = 0; s < job->samples.count; ++s)
  {
    job->nearest[s].count = 0;
  }
  for (int64_t i = 0; i < count; ++i)
  {
    const mcor_neighbours* of = (const mcor_neighbours*)found + i;
    mcor_add_neighbours(&job->nearest[of->sample], of->d2, of->count);
  }
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
  MCOR_TRY(mcor_merge_neighbours(context, job));
  for (int s = 0; s < count; ++s)
  {
    const mcor_neighbours* nearest = &job->nearest[s];
    const double share = context->space.ball / (double)nearest->count;
    spacing[s] = sqrt(nearest->d2[nearest->count - 1]) *
      (context->space.axes == 2 ? sqrt(share) : mcor_cube_root(share));
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
