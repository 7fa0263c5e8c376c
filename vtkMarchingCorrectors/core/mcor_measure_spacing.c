/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The smoothing length of particles that have none. */

#include "mcor_input.h"
#include "mcor_parallel.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The order of samples by a hash of their position, so that input order does not matter. */
typedef struct mcor_sample
{
  uint64_t hash;
  double x[3];
} mcor_sample;

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

#define MCOR_SAMPLES 256
#define MCOR_SAMPLE_NEIGHBOURS 32

/* Those of a slice of the particles, in order. */
typedef struct mcor_spacing_samples
{
  int count;
  mcor_sample sample[MCOR_SAMPLES];
} mcor_spacing_samples;

typedef struct mcor_sampling
{
  const mcor_input* input;
  mcor_array positions;
  double scale;                  /* a power of 2 that brings all coordinates below 1 */
  mcor_spacing_samples* samples; /* [MCOR_SLICES]; in the end the first has those of all */
  double spacing[MCOR_SAMPLES];
} mcor_sampling;

/* Keeps a sample if it is among the first. */
static void mcor_add_sample(mcor_spacing_samples* samples, const mcor_sample* sample)
{
  const bool full = samples->count == MCOR_SAMPLES;
  if (full && sample->hash >= samples->sample[MCOR_SAMPLES - 1].hash)
  {
    return;
  }
  int to = full ? MCOR_SAMPLES - 1 : samples->count++;
  for (; to > 0 && samples->sample[to - 1].hash > sample->hash; --to)
  {
    samples->sample[to] = samples->sample[to - 1];
  }
  samples->sample[to] = *sample;
}

static void mcor_sample_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_sampling* job = data;
  mcor_spacing_samples* samples = &job->samples[slice];
  samples->count = 0;
  for (int64_t i = first; i < last; ++i)
  {
    mcor_sample sample;
    for (int a = 0; a < 3; ++a)
    {
      sample.x[a] = mcor_array_at(&job->positions, i, a);
    }
    sample.hash = mcor_hash_position(sample.x);
    mcor_add_sample(samples, &sample);
  }
}

/* Squared distances, times the squared scale, from a sample to the particle itself and its 32 nearest
 * others, or all there are; the least first. */
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

/* The spacing at each sample of a slice: the distance of the farthest of these neighbours, over how
 * many lie within. */
static void mcor_space_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_sampling* job = data;
  const double scale = job->scale;
  mcor_neighbours nearest[MCOR_SAMPLES / MCOR_SLICES] = { 0 };
  double x[3][MCOR_CHUNK], d2[MCOR_CHUNK];
  for (int64_t begin = 0; begin < job->input->count; begin += MCOR_CHUNK)
  {
    const int64_t rest = job->input->count - begin;
    const int count = rest < MCOR_CHUNK ? (int)rest : MCOR_CHUNK;
    for (int a = 0; a < 3; ++a)
    {
      mcor_read_array(&job->positions, begin, count, a, x[a]);
    }
    for (int64_t s = first; s < last; ++s)
    {
      const double* at = job->samples[0].sample[s].x;
      for (int i = 0; i < count; ++i)
      {
        const double dx = x[0][i] * scale - at[0] * scale, dy = x[1][i] * scale - at[1] * scale,
                     dz = x[2][i] * scale - at[2] * scale;
        d2[i] = dx * dx + dy * dy + dz * dz;
      }
      mcor_add_neighbours(&nearest[s - first], d2, count);
    }
  }
  for (int64_t s = first; s < last; ++s)
  {
    const mcor_neighbours* n = &nearest[s - first];
    job->spacing[s] =
      sqrt(n->d2[n->count - 1]) * cbrt(4.0 / 3.0 * 3.14159265358979323846 / n->count);
  }
  (void)slice;
}

/* 1.3 times the median, over a sample of particles, of the spacing of a lattice that has as many
 * particles within the distance of the 32nd neighbour. */
mcor_status mcor_estimate_smoothing_length(
  mcor_context* context, const mcor_input* input, double* estimate)
{
  mcor_sampling job = { .input = input, .positions = input->positions };
  int exponent = 0, most = INT_MIN;
  job.positions.components = 3;
  for (int a = 0; a < 3; ++a)
  {
    frexp(mcor_largest(&job.positions, NULL, input->count, a), &exponent);
    most = exponent > most ? exponent : most;
  }
  job.scale = ldexp(1, most > -1000 ? -most : 1000);
  job.samples = malloc(MCOR_SLICES * sizeof *job.samples);
  MCOR_RETURN_IF(!job.samples, context, MCOR_OUT_OF_CAPACITY, "Host memory ran out.");
  const int slices = mcor_parallel_for(input->count, MCOR_HEAVY_GRAIN, mcor_sample_slice, &job);
  for (int s = 1; s < slices; ++s)
  {
    for (int i = 0; i < job.samples[s].count; ++i)
    {
      mcor_add_sample(&job.samples[0], &job.samples[s].sample[i]);
    }
  }
  const int count = job.samples[0].count;
  mcor_parallel_for(count, 1, mcor_space_slice, &job);
  free(job.samples);
  *estimate = 1.3 * mcor_median_of(job.spacing, count) / job.scale;
  MCOR_RETURN_IF(!(*estimate > 0), context, MCOR_INVALID_DATA,
    "The smoothing length cannot be estimated: most particles lie at one point.");
  return MCOR_OK;
}
