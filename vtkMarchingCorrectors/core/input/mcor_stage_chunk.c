/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The caller's numbers in the device's: chunks of particles, in the units of the staging arrays;
 * values of particles, in the order of the search grid. */

#include "mcor_stage.h"
#include "mcor_tree.h"

#include <float.h>
#include <math.h>
#include <string.h>

void mcor_read_stage_places(const mcor_staging* staging, int64_t first, mcor_stage_chunk* chunk)
{
  const mcor_context* context = staging->context;
  const mcor_lattice* lattice = &context->lattice;
  const mcor_reach_box* reach = staging->reach;
  const int count = chunk->count;
  double h[MCOR_CHUNK];
  for (int a = 0; a < 3; ++a)
  {
    const double origin = (double)lattice->origin[a], scale = (double)lattice->step[a];
    double* x = chunk->x[a];
    mcor_read_array(&staging->input->positions, first, count, a, x);
    for (int i = 0; i < count; ++i)
    {
      x[i] = (x[i] / lattice->edge[a] - origin) * scale;
    }
    for (int i = 0; i < count && reach && reach->period[a] > 0; ++i)
    {
      x[i] = mcor_wrap(reach, a, x[i]);
    }
  }
  mcor_read_smoothing_length(context, staging->input, first, count, h);
  mcor_widen_lengths(staging->input, first, count, h, chunk->h);
  for (int i = 0; i < count; ++i)
  {
    chunk->level[i] =
      (uint8_t)mcor_tree_level_of(h[i], context->measure.h_min, lattice->levels - 1);
    chunk->source[i] = (int32_t)(first + i);
  }
}

void mcor_read_stage_sizes(const mcor_staging* staging, int64_t first, mcor_stage_chunk* chunk)
{
  const bool are_areas = staging->context->space.flat && !mcor_needs_density(staging->input);
  mcor_read_size(staging->input, first, chunk->count, chunk->size);
  for (int i = 0; i < chunk->count; ++i)
  {
    chunk->size[i] *= staging->size_scale;
  }
  for (int i = 0; i < chunk->count && are_areas; ++i)
  {
    chunk->size[i] *= chunk->h[i];
  }
}

int mcor_spared_bits(const mcor_context* context, double support, double cube, int level)
{
  const int digits = context->run.options->precision == MCOR_FLOAT64 ? DBL_MANT_DIG : FLT_MANT_DIG;
  int exponent;
  frexp(1.0001 * support / cube + ldexp(MCOR_POINT_EXTENT, level), &exponent);
  const int bits = exponent + context->lattice.fix_bits - digits;
  return bits > 0 ? bits : 0;
}

/* Writes numbers to `array` from element `first` on, in the device's precision. */
static void mcor_store_reals(
  const mcor_context* context, void* array, int64_t first, const double* values, int count)
{
  if (context->cl.real_size == sizeof(float))
  {
    float* to = (float*)array + first;
    for (int i = 0; i < count; ++i)
    {
      to[i] = (float)values[i];
    }
  }
  else
  {
    memcpy((double*)array + first, values, (size_t)count * sizeof *values);
  }
}

void mcor_store_stage_chunk(const mcor_staging* staging, mcor_stage_chunk* chunk, int64_t to)
{
  const mcor_context* context = staging->context;
  const uint8_t* solid = staging->input->solid;
  const mcor_measure* m = &context->measure;
  const int count = chunk->count, top = context->lattice.levels - 1;
  const double h_scale = context->run.options->h_scale, cube = context->lattice.cube,
               scaled_cube = cube / h_scale;
  const double reach = mcor_support_factor(context->run.options->sph_kernel) * h_scale;
  uint8_t* level = (uint8_t*)staging->level + to;
  /* Rounds positions to the digits that evaluations use. */
  const bool are_rounded = mcor_spared_bits(context, m->support_max, cube, top) > 0;
  for (int i = 0; i < count && are_rounded; ++i)
  {
    const double unit =
      ldexp(1, mcor_spared_bits(context, chunk->h[i] * reach, cube, chunk->level[i]));
    for (int a = 0; a < 3; ++a)
    {
      chunk->x[a][i] = unit * floor(chunk->x[a][i] / unit + 0.5);
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    /* No position is below the lattice's origin, so adding 1/2 and truncating rounds. */
    const double* x = chunk->x[a];
    int32_t* narrow = (int32_t*)staging->x[a] + to;
    int64_t* wide = (int64_t*)staging->x[a] + to;
    if (context->cl.fix_size == sizeof *narrow)
    {
      for (int i = 0; i < count; ++i)
      {
        narrow[i] = (int32_t)(x[i] + 0.5);
      }
    }
    else
    {
      for (int i = 0; i < count; ++i)
      {
        wide[i] = (int64_t)(x[i] + 0.5);
      }
    }
  }
  for (int i = 0; i < count && solid; ++i)
  {
    chunk->size[i] = solid[chunk->source[i]] ? -chunk->size[i] : chunk->size[i];
  }
  mcor_store_reals(context, staging->size, to, chunk->size, count);
  memset(level, 0, (size_t)count);
  for (int i = 0; i < count && m->support_min < m->support_max; ++i)
  {
    const double support = chunk->h[i] * reach;
    const int of = support < m->support_max ? ilogb(m->support_max / support) : 0;
    level[i] = (uint8_t)(of < 0 ? 0 : of >= MCOR_LEVEL_LIMIT ? MCOR_LEVEL_LIMIT - 1 : of);
  }
  for (int i = 0; i < count; ++i)
  {
    chunk->h[i] = scaled_cube / chunk->h[i];
  }
  mcor_store_reals(context, staging->inv_h, to, chunk->h, count);
  if (context->source)
  {
    memcpy(context->source + to, chunk->source, (size_t)count * sizeof chunk->source[0]);
  }
}

/* ---- Values ---- */

typedef struct mcor_value_job
{
  const mcor_context* context;
  const mcor_input* input;
  const mcor_array* array;
  int component;
  double shift, scale;
  bool fixed;
  void* values;
} mcor_value_job;

static void mcor_store_value_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_value_job* job = data;
  const mcor_input* input = job->input;
  const double shift = job->shift, scale = job->scale;
  const bool single = job->context->cl.fix_size == sizeof(int32_t);
  int n = 0;
  for (int64_t begin = first; begin < last; begin += n)
  {
    const int64_t from = mcor_source_of(job->context, begin);
    const int count = mcor_chunk_of(input->count - from);
    double chunk[MCOR_CHUNK], used[MCOR_CHUNK];
    job->array ? mcor_read_array(job->array, from, count, job->component, chunk)
               : mcor_read_scalar(input, from, count, chunk);
    /* The images of a particle stand side by side. */
    for (n = 0; n < MCOR_CHUNK && begin + n < last &&
         mcor_source_of(job->context, begin + n) < from + count;
         ++n)
    {
      used[n] = (chunk[mcor_source_of(job->context, begin + n) - from] - shift) * scale;
    }
    /* Values of solids play no part, whatever they are. */
    for (int i = 0; i < n && input->solid; ++i)
    {
      used[i] = input->solid[mcor_source_of(job->context, begin + i)] ? 0 : used[i];
    }
    for (int i = 0; i < n && job->fixed; ++i)
    {
      if (single)
      {
        ((int32_t*)job->values)[begin + i] = (int32_t)lrint(used[i]);
      }
      else
      {
        ((int64_t*)job->values)[begin + i] = (int64_t)llrint(used[i]);
      }
    }
    mcor_store_reals(job->context, job->values, begin, used, job->fixed ? 0 : n);
  }
  (void)slice;
}

/* Copies one component of an array (or the scalar, if `array` is NULL), less `shift`, times
 * `scale`, as real or fixed-point numbers, into row `to_row`; a row has one value per particle. */
mcor_status mcor_sort_values(mcor_context* context, const mcor_input* input,
  const mcor_array* array, int component, double shift, double scale, bool fixed, mcor_buffer* to,
  int to_row)
{
  const mcor_grid* grid = &context->grid;
  const size_t bytes = (size_t)grid->count * context->cl.real_size;
  mcor_buffer* raw = &context->stage.values;
  mcor_value_job job = { context, input, array, component, shift, scale, fixed, NULL };
  MCOR_TRY(mcor_reserve(context, raw, bytes));
  MCOR_TRY(mcor_map(context, raw, bytes, true, &job.values));
  const mcor_status status =
    mcor_parallel_run(context, grid->count, MCOR_LIGHT_GRAIN, mcor_store_value_slice, &job, NULL);
  MCOR_TRY(mcor_unmap(context, raw, &job.values));
  MCOR_TRY(status);
  return MCOR_LAUNCH(context, "mcor_grid_gather_value", MCOR_LIGHT, grid->count,
    MCOR_INT(grid->count), MCOR_BUFFER(&grid->order), MCOR_BUFFER(raw), MCOR_BUFFER(to),
    MCOR_INT(to_row));
}
