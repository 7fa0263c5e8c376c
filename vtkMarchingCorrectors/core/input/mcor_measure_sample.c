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
  status = status == MCOR_OK ? mcor_gather(context, own, count, sizeof *own, &all, &count) : status;
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
