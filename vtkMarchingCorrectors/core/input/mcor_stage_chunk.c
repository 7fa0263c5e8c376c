/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* One chunk of the caller's particles, in the units of the staging arrays. */

#include "mcor_stage.h"
#include "mcor_tree.h"

#include <float.h>
#include <math.h>
#include <string.h>

void mcor_read_stage_places(const mcor_context* context, const mcor_input* input, int64_t first,
  const mcor_reach_box* reach, mcor_stage_chunk* chunk)
{
  const mcor_lattice* lattice = &context->lattice;
  const int count = chunk->count;
  mcor_array positions = input->positions;
  positions.components = 3;
  for (int a = 0; a < 3; ++a)
  {
    const double origin = (double)lattice->origin[a], scale = (double)lattice->step[a];
    double* x = chunk->x[a];
    mcor_read_array(&positions, first, count, a, x);
    for (int i = 0; i < count; ++i)
    {
      x[i] = (x[i] / lattice->edge[a] - origin) * scale;
    }
    for (int i = 0; i < count && reach && reach->period[a] > 0; ++i)
    {
      x[i] = mcor_wrap(reach, a, x[i]);
    }
  }
  double h[MCOR_CHUNK];
  mcor_read_smoothing_length(context, input, first, count, h);
  mcor_widen_lengths(input, first, count, h, chunk->h);
  for (int i = 0; i < count; ++i)
  {
    chunk->level[i] = (uint8_t)mcor_tree_level_of(h[i], context->measure.h_min, lattice->levels - 1);
    chunk->source[i] = (int32_t)(first + i);
  }
}

void mcor_read_stage_chunk(const mcor_context* context, const mcor_input* input, int64_t first,
  const mcor_staging* staging, const mcor_reach_box* reach, mcor_stage_chunk* chunk)
{
  mcor_read_stage_places(context, input, first, reach, chunk);
  mcor_read_size(input, first, chunk->count, chunk->size);
  for (int i = 0; i < chunk->count; ++i)
  {
    chunk->size[i] *= staging->size_scale;
  }
  const int areas = context->space.flat && !mcor_needs_density(input) ? chunk->count : 0;
  for (int i = 0; i < areas; ++i)
  {
    chunk->size[i] *= chunk->h[i];
  }
}

double mcor_weight_limit(const mcor_context* context)
{
  return context->cl.real_size == sizeof(float) ? 1e30 : 1e290;
}

double mcor_stage_weight(const mcor_context* context, const mcor_stage_chunk* chunk, int i)
{
  const double inv_h = context->lattice.cube / context->run.options->h_scale / chunk->h[i];
  return chunk->size[i] * inv_h * inv_h * inv_h;
}

int64_t mcor_find_heavy(const mcor_context* context, const mcor_input* input,
  const mcor_stage_chunk* chunk, double* largest_weight)
{
  const double limit = mcor_weight_limit(context);
  const int count = mcor_needs_density(input) ? 0 : chunk->count;
  int64_t heavy = -1;
  double largest = *largest_weight;
  for (int i = 0; i < count; ++i)
  {
    const double weight = mcor_stage_weight(context, chunk, i);
    heavy = heavy < 0 && !(weight < limit) ? chunk->source[i] : heavy;
    largest = weight > largest ? weight : largest;
  }
  *largest_weight = largest;
  return heavy;
}

int mcor_spared_bits(const mcor_context* context, double support, double cube, int level)
{
  const int digits = context->run.options->precision == MCOR_FLOAT64 ? DBL_MANT_DIG : FLT_MANT_DIG;
  int exponent;
  frexp(1.0001 * support / cube + ldexp(MCOR_POINT_EXTENT, level), &exponent);
  const int bits = exponent + context->lattice.fix_bits - digits;
  return bits > 0 ? bits : 0;
}

/* Rounds positions to the digits that evaluations use. reach: support radius per smoothing
 * length. */
static void mcor_round_positions(const mcor_context* context, double reach, mcor_stage_chunk* chunk)
{
  const double cube = context->lattice.cube;
  for (int i = 0; i < chunk->count; ++i)
  {
    const double unit =
      ldexp(1, mcor_spared_bits(context, chunk->h[i] * reach, cube, chunk->level[i]));
    for (int a = 0; a < 3; ++a)
    {
      chunk->x[a][i] = unit * floor(chunk->x[a][i] / unit + 0.5);
    }
  }
}

static int mcor_level_of(double support_max, double support)
{
  const int level = support < support_max ? ilogb(support_max / support) : 0;
  return level < 0 ? 0 : level >= MCOR_LEVEL_LIMIT ? MCOR_LEVEL_LIMIT - 1 : level;
}

void mcor_store_reals(
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

/* Converts coordinates. No position is below the lattice's origin, so adding 1/2 and truncating
 * rounds. */
static void mcor_store_fixed(
  const mcor_context* context, void* array, int64_t first, const double* values, int count)
{
  if (context->cl.fix_size == sizeof(int32_t))
  {
    int32_t* to = (int32_t*)array + first;
    for (int i = 0; i < count; ++i)
    {
      to[i] = (int32_t)(values[i] + 0.5);
    }
  }
  else
  {
    int64_t* to = (int64_t*)array + first;
    for (int i = 0; i < count; ++i)
    {
      to[i] = (int64_t)(values[i] + 0.5);
    }
  }
}

void mcor_store_stage_chunk(const mcor_context* context, const mcor_input* input,
  mcor_stage_chunk* chunk, const mcor_staging* staging, int64_t to)
{
  const mcor_measure* m = &context->measure;
  const double h_scale = context->run.options->h_scale,
               scaled_cube = context->lattice.cube / h_scale;
  const double reach = mcor_support_factor(context->run.options->sph_kernel) * h_scale;
  uint8_t* level = (uint8_t*)staging->level + to;
  if (mcor_spared_bits(
        context, m->support_max, context->lattice.cube, context->lattice.levels - 1) > 0)
  {
    mcor_round_positions(context, reach, chunk);
  }
  for (int a = 0; a < 3; ++a)
  {
    mcor_store_fixed(context, staging->x[a], to, chunk->x[a], chunk->count);
  }
  for (int i = 0; i < chunk->count && input->solid; ++i)
  {
    chunk->size[i] = input->solid[chunk->source[i]] ? -chunk->size[i] : chunk->size[i];
  }
  mcor_store_reals(context, staging->size, to, chunk->size, chunk->count);
  memset(level, 0, (size_t)chunk->count);
  for (int i = 0; i < chunk->count && m->support_min < m->support_max; ++i)
  {
    level[i] = (uint8_t)mcor_level_of(m->support_max, chunk->h[i] * reach);
  }
  for (int i = 0; i < chunk->count; ++i)
  {
    chunk->h[i] = scaled_cube / chunk->h[i];
  }
  mcor_store_reals(context, staging->inv_h, to, chunk->h, chunk->count);
  if (context->source)
  {
    memcpy(context->source + to, chunk->source, (size_t)chunk->count * sizeof chunk->source[0]);
  }
}
