/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Chooses a few particles that stand for all: the particles whose positions have the least hashes.
 * So it does not matter in which order particles come, or how ranks share them. If particles have
 * no smoothing lengths, one length is estimated for all of them from such samples. */

#include "mcor_input.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

uint64_t mcor_hash_position(const double x[3])
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

/* Orders samples by hash. Samples at one place are ordered by smoothing length, then by volume. */
static bool mcor_comes_before(const mcor_sample* a, const mcor_sample* b)
{
  return a->hash != b->hash ? a->hash < b->hash
    : a->h != b->h          ? a->h < b->h
                            : a->volume < b->volume;
}

void mcor_add_sample(mcor_sample_list* found, const mcor_sample* sample)
{
  int to = found->count;
  while (to > 0 && mcor_comes_before(sample, &found->of[to - 1]))
  {
    --to;
  }
  const int last = found->count < found->most ? found->count++ : found->most - 1;
  if (to <= last)
  {
    memmove(found->of + to + 1, found->of + to, (size_t)(last - to) * sizeof *sample);
    found->of[to] = *sample;
  }
}

typedef struct mcor_sampling
{
  const mcor_context* context;
  const mcor_input* input;
  mcor_sample_list found[MCOR_SLICES][2]; /* samples of fluid, of solids */
} mcor_sampling;

static void mcor_sample_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_sampling* job = data;
  const mcor_input* input = job->input;
  double x[3][MCOR_CHUNK];
  uint64_t hash[MCOR_CHUNK];
  for (int count; (count = mcor_chunk_of(last - first)) > 0; first += count)
  {
    mcor_read_positions(input, first, count, x);
    for (int i = 0; i < count; ++i) /* a loop of its own, so that processors hash several at once */
    {
      const double at[3] = { x[0][i], x[1][i], x[2][i] };
      hash[i] = mcor_hash_position(at);
    }
    for (int i = 0; i < count; ++i)
    {
      const int64_t particle = first + i;
      const bool is_solid = input->solid && input->solid[particle];
      mcor_sample_list* found = &job->found[slice][is_solid];
      if ((found->count == found->most && hash[i] > found->of[found->most - 1].hash) ||
        !mcor_is_present(input, particle) || !isfinite(x[0][i]) || !isfinite(x[1][i]) ||
        !isfinite(x[2][i]))
      {
        continue;
      }
      mcor_sample sample = { .hash = hash[i], .x = { x[0][i], x[1][i], x[2][i] } };
      if (!is_solid)
      {
        mcor_read_smoothing_length(job->context, input, particle, 1, &sample.h);
        mcor_read_size(input, particle, mcor_needs_density(input) ? 0 : 1, &sample.volume);
      }
      mcor_add_sample(found, &sample);
    }
  }
}

mcor_status mcor_choose_samples(mcor_context* context, const mcor_input* input, int most_fluid)
{
  mcor_sampling* job = calloc(1, sizeof *job);
  MCOR_TRY(mcor_allocated(context, job));
  job->context = context;
  job->input = input;
  for (int n = 0; n < 2 * MCOR_SLICES; ++n)
  {
    job->found[n / 2][n % 2].most = n % 2 == 0 ? most_fluid : MCOR_SAMPLES;
  }
  int slices;
  mcor_status status =
    mcor_parallel_run(context, input->count, MCOR_HEAVY_GRAIN, mcor_sample_slice, job, &slices);
  for (int k = 0; k < 2; ++k)
  {
    mcor_sample_list *own = &job->found[0][k], *list = &context->samples[k];
    const void* all = NULL;
    int64_t count = 0;
    for (int s = 1; s < slices; ++s)
    {
      for (int i = 0; i < job->found[s][k].count; ++i)
      {
        mcor_add_sample(own, &job->found[s][k].of[i]);
      }
    }
    MCOR_THEN(
      status, mcor_gather_records(context, own->of, own->count, sizeof *own->of, &all, &count));
    *list = (mcor_sample_list){ .most = own->most };
    for (int64_t i = 0; i < count; ++i)
    {
      mcor_add_sample(list, (const mcor_sample*)all + i);
    }
  }
  free(job);
  return status;
}

/* ---- One smoothing length for all ---- */

#define MCOR_SAMPLE_NEIGHBOURS 32

/* Squared distances, ascending, from a sample to itself and to the 32 nearest particles (or to all,
 * if there are fewer). The distances are multiplied by mcor_spacing.scale. */
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
  double scale;             /* a power of 2 that brings all coordinates below 1 */
  mcor_sample_list samples; /* samples of the fluid, then of solids */
  /* The neighbours of each sample: on this rank, on all ranks. */
  mcor_neighbours nearest[MCOR_SAMPLES], merged[MCOR_SAMPLES];
} mcor_spacing;

/* Finds the nearest of this rank's particles for each sample of a slice. */
static void mcor_near_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_spacing* job = data;
  const double scale = job->scale;
  double x[3][MCOR_CHUNK], d2[MCOR_CHUNK];
  for (int64_t begin = 0; begin < job->input->count; begin += MCOR_CHUNK)
  {
    const int read = mcor_chunk_of(job->input->count - begin);
    int count = 0; /* only present, finite particles count; they move to the front */
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
      const double* at = job->samples.of[s].x;
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

/* *estimate becomes 1.3 times the median of the samples' spacings. A sample's spacing is the cube
 * root of V / 33: the ball around the sample up to its 32nd neighbour has the volume V, and holds
 * 33 particles. In two dimensions, the spacing is the square root of A / 33, and A is the area of a
 * disc. If there are only n < 33 particles, n takes the place of 33. */
static mcor_status mcor_find_spacing(mcor_context* context, mcor_spacing* job, double* estimate)
{
  double spacing[MCOR_SAMPLES], largest = 0;
  int exponent;
  for (int i = 0; i < context->samples[1].count; ++i)
  {
    mcor_add_sample(&job->samples, &context->samples[1].of[i]);
  }
  for (int a = 0; a < 3; ++a)
  {
    largest = fmax(largest, mcor_largest(context, job->input, &job->input->positions, a));
  }
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_GREATEST, &largest, 1));
  frexp(largest, &exponent);
  job->scale = ldexp(1, exponent > -1000 ? -exponent : 1000);
  const int samples = job->samples.count;
  MCOR_TRY(mcor_parallel_run(context, samples, 1, mcor_near_slice, job, NULL));
  const void* found;
  int64_t count;
  for (int s = 0; s < samples; ++s)
  {
    job->nearest[s].sample = s;
  }
  MCOR_TRY(
    mcor_gather_records(context, job->nearest, samples, sizeof job->nearest[0], &found, &count));
  for (int64_t i = 0; i < count; ++i)
  {
    const mcor_neighbours* of = (const mcor_neighbours*)found + i;
    mcor_add_neighbours(&job->merged[of->sample], of->d2, of->count);
  }
  for (int s = 0; s < samples; ++s)
  {
    const mcor_neighbours* merged = &job->merged[s];
    const double share = context->space.ball / (double)merged->count;
    spacing[s] = sqrt(merged->d2[merged->count - 1]) *
      (context->space.axes == 2 ? sqrt(share) : mcor_cube_root(share));
  }
  *estimate = 1.3 * mcor_median_of(spacing, samples) / job->scale;
  MCOR_FAIL_IF(!(*estimate > 0), context, MCOR_INVALID_DATA, MCOR_SAY(ESTIMATE_AT_ONE_POINT));
  for (int s = 0; s < context->samples[0].count; ++s)
  {
    context->samples[0].of[s].h = *estimate;
  }
  return MCOR_OK;
}

mcor_status mcor_estimate_smoothing_length(
  mcor_context* context, const mcor_input* input, double* estimate)
{
  mcor_spacing* job = calloc(1, sizeof *job); /* too large for the stacks of some threads */
  MCOR_TRY(mcor_allocated(context, job));
  job->input = input;
  job->samples = context->samples[0];
  const mcor_status status = mcor_find_spacing(context, job, estimate);
  free(job);
  return status;
}
