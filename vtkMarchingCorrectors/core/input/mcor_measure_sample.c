/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Chooses a few particles that stand for all: those whose positions have the least hashes. So
 * neither the order of the input matters, nor how ranks share the particles. */

#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_ranks.h"

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

static void mcor_sample_particle(
  const mcor_sampling* job, mcor_samples_found* found, int64_t i, const double x[3])
{
  const uint64_t hash = mcor_hash_position(x);
  if (found->count == found->most && hash > found->sample[found->most - 1].hash)
  {
    return;
  }
  mcor_sample sample = { .hash = hash, .x = { x[0], x[1], x[2] } };
  if (job->which == MCOR_FLUID_PARTICLES)
  {
    mcor_read_smoothing_length(job->context, job->input, i, 1, &sample.h);
    mcor_read_size(job->input, i, mcor_needs_density(job->input) ? 0 : 1, &sample.volume);
  }
  mcor_add_sample(found, &sample);
}

static void mcor_sample_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_sampling* job = data;
  const uint8_t* solid = job->input->solid;
  const bool any = job->which == MCOR_ALL_PARTICLES, solids = job->which == MCOR_SOLID_PARTICLES;
  const mcor_input* input = job->input;
  double x[3][MCOR_CHUNK];
  for (int64_t begin = first; begin < last; begin += MCOR_CHUNK)
  {
    const int count = mcor_chunk_of(last - begin);
    mcor_read_positions(job->input, begin, count, x);
    for (int i = 0; i < count; ++i)
    {
      const bool present = any || solids ? mcor_is_present(input, begin + i) : true;
      const double at[3] = { x[0][i], x[1][i], x[2][i] };
      if (present && (any || (solid && solid[begin + i]) == solids) && isfinite(at[0]) &&
        isfinite(at[1]) && isfinite(at[2]))
      {
        mcor_sample_particle(job, &job->found[slice], begin + i, at);
      }
    }
  }
}

/* Merges the samples of all slices, then of all ranks. */
static mcor_status mcor_merge_samples(mcor_context* context, mcor_samples_found* found, int slices)
{
  for (int s = 1; s < slices; ++s)
  {
    for (int i = 0; i < found[s].count; ++i)
    {
      mcor_add_sample(&found[0], &found[s].sample[i]);
    }
  }
  const void* all;
  int64_t count;
  MCOR_TRY(
    mcor_gather(context, found[0].sample, found[0].count, sizeof found[0].sample[0], &all, &count));
  if (all != found[0].sample)
  {
    found[0].count = 0;
    for (int64_t i = 0; i < count; ++i)
    {
      mcor_add_sample(&found[0], (const mcor_sample*)all + i);
    }
  }
  return MCOR_OK;
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
  status = status == MCOR_OK ? mcor_merge_samples(context, job.found, slices) : status;
  *chosen = job.found[0];
  free(job.found);
  return status;
}
