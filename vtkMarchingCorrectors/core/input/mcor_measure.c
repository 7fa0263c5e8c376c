/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* What the other phases need to know of the particles: ranges, bounds, the lattice. */

#include "mcor_box.h"
#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_plane.h"
#include "mcor_ranks.h"
#include "mcor_tree.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Support radius in cubes at least: below, no node is likely to see a particle. */
#define MCOR_LEAST_SUPPORT 1e-3

/* Cube sizes whose cubes, areas and gradients are numbers. */
#define MCOR_LEAST_CUBE 1e-100
#define MCOR_MOST_CUBE 1e100

/* One chunk of the particles, as double. */
typedef struct mcor_chunk
{
  int count;
  double x[3][MCOR_CHUNK], h[MCOR_CHUNK], scalar[MCOR_CHUNK];
} mcor_chunk;

static void mcor_read_chunk(
  const mcor_context* context, const mcor_input* input, int64_t first, mcor_chunk* chunk)
{
  mcor_read_positions(input, first, chunk->count, chunk->x);
  mcor_read_smoothing_length(context, input, first, chunk->count, chunk->h);
  if (context->run.options->field != MCOR_WEIGHT_SUM)
  {
    mcor_read_scalar(input, first, chunk->count, chunk->scalar);
  }
}

static double mcor_least(double a, double b)
{
  return b < a ? b : a;
}

static double mcor_most(double a, double b)
{
  return b > a ? b : a;
}

static void mcor_measure_particle(
  mcor_measure* m, const mcor_chunk* chunk, int i, bool solid, double reach)
{
  const double h = chunk->h[i], support = h * reach;
  m->support_min = mcor_least(m->support_min, support);
  m->support_max = mcor_most(m->support_max, support);
  for (int a = 0; a < 3; ++a)
  {
    m->low[a] = mcor_least(m->low[a], chunk->x[a][i] - support);
    m->high[a] = mcor_most(m->high[a], chunk->x[a][i] + support);
  }
  for (int a = 0; a < 3 && !solid; ++a)
  {
    m->x_low[a] = mcor_least(m->x_low[a], chunk->x[a][i]);
    m->x_high[a] = mcor_most(m->x_high[a], chunk->x[a][i]);
  }
  if (!solid)
  {
    m->h_min = mcor_least(m->h_min, h);
    m->h_max = mcor_most(m->h_max, h);
  }
}

static const mcor_measure mcor_nothing = { .low = { DBL_MAX, DBL_MAX, DBL_MAX },
  .high = { -DBL_MAX, -DBL_MAX, -DBL_MAX },
  .x_low = { DBL_MAX, DBL_MAX, DBL_MAX },
  .x_high = { -DBL_MAX, -DBL_MAX, -DBL_MAX },
  .h_min = DBL_MAX,
  .support_min = DBL_MAX,
  .scalar_min = DBL_MAX,
  .scalar_max = -DBL_MAX,
  .not_finite = INT64_MAX };

static void mcor_merge_measure(mcor_measure* m, const mcor_measure* other)
{
  m->fluid_count += other->fluid_count;
  m->solid_count += other->solid_count;
  for (int a = 0; a < 3; ++a)
  {
    m->low[a] = mcor_least(m->low[a], other->low[a]);
    m->high[a] = mcor_most(m->high[a], other->high[a]);
    m->x_low[a] = mcor_least(m->x_low[a], other->x_low[a]);
    m->x_high[a] = mcor_most(m->x_high[a], other->x_high[a]);
  }
  m->h_min = mcor_least(m->h_min, other->h_min);
  m->h_max = mcor_most(m->h_max, other->h_max);
  m->support_min = mcor_least(m->support_min, other->support_min);
  m->support_max = mcor_most(m->support_max, other->support_max);
  m->scalar_min = mcor_least(m->scalar_min, other->scalar_min);
  m->scalar_max = mcor_most(m->scalar_max, other->scalar_max);
  m->not_finite = other->not_finite < m->not_finite ? other->not_finite : m->not_finite;
}

/* Elements that are measured at a time: each alone would wait for the one before. */
#define MCOR_MEASURED 4

/* Widens [*low, *high] to hold x. */
static void mcor_measure_extent(const double* x, int count, double* low, double* high)
{
  double least[MCOR_MEASURED], most[MCOR_MEASURED];
  int i = 0;
  for (int l = 0; l < MCOR_MEASURED; ++l)
  {
    least[l] = *low;
    most[l] = *high;
  }
  for (; i + MCOR_MEASURED <= count; i += MCOR_MEASURED)
  {
    for (int l = 0; l < MCOR_MEASURED; ++l)
    {
      least[l] = mcor_least(least[l], x[i + l]);
      most[l] = mcor_most(most[l], x[i + l]);
    }
  }
  for (; i < count; ++i)
  {
    least[0] = mcor_least(least[0], x[i]);
    most[0] = mcor_most(most[0], x[i]);
  }
  for (int l = 0; l < MCOR_MEASURED; ++l)
  {
    *low = mcor_least(*low, least[l]);
    *high = mcor_most(*high, most[l]);
  }
}

/* The same of the supports along axis a. */
static void mcor_measure_reach(const mcor_chunk* chunk, int a, double reach, mcor_measure* m)
{
  for (int i = 0; i < chunk->count; ++i)
  {
    const double support = chunk->h[i] * reach;
    m->low[a] = mcor_least(m->low[a], chunk->x[a][i] - support);
    m->high[a] = mcor_most(m->high[a], chunk->x[a][i] + support);
  }
}

/* Of a chunk without solids, all but the scalar. Rounding keeps the order of numbers: what is least before
 * a product or a difference with the same number is so after it. */
static void mcor_measure_fluid(mcor_measure* m, const mcor_chunk* chunk, double reach)
{
  double h_min = DBL_MAX, h_max = 0;
  mcor_measure_extent(chunk->h, chunk->count, &h_min, &h_max);
  for (int a = 0; a < 3; ++a)
  {
    double low = DBL_MAX, high = -DBL_MAX;
    mcor_measure_extent(chunk->x[a], chunk->count, &low, &high);
    m->x_low[a] = mcor_least(m->x_low[a], low);
    m->x_high[a] = mcor_most(m->x_high[a], high);
    if (h_min < h_max)
    {
      mcor_measure_reach(chunk, a, reach, m);
      continue;
    }
    m->low[a] = mcor_least(m->low[a], low - h_min * reach);
    m->high[a] = mcor_most(m->high[a], high + h_min * reach);
  }
  m->h_min = mcor_least(m->h_min, h_min);
  m->h_max = mcor_most(m->h_max, h_max);
  m->support_min = mcor_least(m->support_min, h_min * reach);
  m->support_max = mcor_most(m->support_max, h_max * reach);
  m->fluid_count += chunk->count;
}

/* Of a chunk with solids, the same. */
static void mcor_measure_mixed(const mcor_context* context, const mcor_input* input, int64_t first,
  const mcor_chunk* chunk, double reach, mcor_measure* m)
{
  for (int i = 0; i < chunk->count; ++i)
  {
    const bool solid = input->solid[first + i];
    m->solid_count += solid;
    m->fluid_count += !solid;
    if (mcor_is_used(context, input, first + i))
    {
      mcor_measure_particle(m, chunk, i, solid, reach);
    }
  }
}

/* The scalar of a chunk's fluid particles. */
static void mcor_measure_scalar(
  const mcor_input* input, int64_t first, const mcor_chunk* chunk, mcor_measure* m)
{
  for (int i = 0; i < chunk->count; ++i)
  {
    const double value = chunk->scalar[i];
    if (input->solid && input->solid[first + i])
    {
      continue;
    }
    m->scalar_min = mcor_least(m->scalar_min, value);
    m->scalar_max = mcor_most(m->scalar_max, value);
    if (!isfinite(value) && first + i < m->not_finite)
    {
      m->not_finite = first + i;
    }
  }
}

typedef struct mcor_measuring
{
  const mcor_context* context;
  const mcor_input* input;
  double reach; /* support radius / smoothing length */
  mcor_watch* watch;
  mcor_measure measures[MCOR_SLICES];
} mcor_measuring;

static void mcor_measure_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_measuring* job = data;
  const mcor_input* input = job->input;
  const bool has_scalar = job->context->run.options->field != MCOR_WEIGHT_SUM;
  mcor_measure m = mcor_nothing;
  mcor_chunk chunk;
  for (int64_t begin = first; begin < last; begin += MCOR_CHUNK)
  {
    chunk.count = last - begin < MCOR_CHUNK ? (int)(last - begin) : MCOR_CHUNK;
    mcor_read_chunk(job->context, input, begin, &chunk);
    mcor_watch_positions(job->watch, slice, chunk.count, (const double(*)[MCOR_CHUNK])chunk.x);
    if (input->solid)
    {
      mcor_measure_mixed(job->context, input, begin, &chunk, job->reach, &m);
    }
    else
    {
      mcor_measure_fluid(&m, &chunk, job->reach);
    }
    if (has_scalar)
    {
      mcor_measure_scalar(input, begin, &chunk, &m);
    }
  }
  job->measures[slice] = m;
}

static mcor_status mcor_measure_particles(
  mcor_context* context, const mcor_input* input, double reach)
{
  mcor_measuring job = { .context = context, .input = input, .reach = reach };
  mcor_status status = mcor_begin_watch(context, input, &job.watch);
  int slices;
  status = status == MCOR_OK
    ? mcor_parallel_run(context, input->count, MCOR_HEAVY_GRAIN, mcor_measure_slice, &job, &slices)
    : status;
  if (status == MCOR_OK)
  {
    for (int s = 0; s < slices; ++s)
    {
      mcor_merge_measure(&context->measure, &job.measures[s]);
    }
    status = mcor_end_watch(context, job.watch, slices);
  }
  mcor_free_watch(job.watch);
  return status;
}

/* What all ranks have measured. Which particle is not finite is for its rank to say. */
static mcor_status mcor_merge_ranks(mcor_context* context)
{
  mcor_measure* m = &context->measure;
  double* least[] = { m->low, m->low + 1, m->low + 2, m->x_low, m->x_low + 1, m->x_low + 2,
    &m->h_min, &m->support_min, &m->scalar_min };
  double* most[] = { m->high, m->high + 1, m->high + 2, m->x_high, m->x_high + 1, m->x_high + 2,
    &m->h_max, &m->support_max, &m->scalar_max };
  enum
  {
    count = sizeof least / sizeof least[0]
  };
  int64_t particles[2] = { m->fluid_count, m->solid_count };
  double low[count], high[count];
  for (int i = 0; i < count; ++i)
  {
    low[i] = *least[i];
    high[i] = *most[i];
  }
  MCOR_TRY(mcor_reduce_counts(context, MCOR_SUM_OF, particles, 2));
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_LEAST, low, count));
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_GREATEST, high, count));
  for (int i = 0; i < count; ++i)
  {
    *least[i] = low[i];
    *most[i] = high[i];
  }
  m->fluid_count = particles[0];
  m->solid_count = particles[1];
  return MCOR_OK;
}

/* The components are finite, but the magnitude or the dot product may not be. */
static mcor_status mcor_check_derived(mcor_context* context, const mcor_input* input)
{
  const char* name = mcor_array_name(&input->scalar, "scalar");
  const char* other = mcor_array_name(&input->scalar_dot, "scalar");
  const long long i = context->measure.not_finite;
  MCOR_RETURN_IF(i < INT64_MAX && input->scalar_dot.data, context, MCOR_INVALID_DATA,
    "The dot product of arrays %s and %s at particle %lld is too large for a double. Use other "
    "units, or remove such particles.",
    name, other, i);
  MCOR_RETURN_IF(i < INT64_MAX, context, MCOR_INVALID_DATA,
    "The magnitude of array %s at particle %lld is too large for a double. Use another unit, or "
    "remove such particles.",
    name, i);
  return MCOR_OK;
}

/* The virtual grid that covers what the particles' supports reach. */
static mcor_status mcor_measure_lattice(mcor_context* context, const mcor_options* options)
{
  mcor_measure* m = &context->measure;
  mcor_lattice* lattice = &context->lattice;
  const double cube =
    options->cube_size > 0 ? options->cube_size : options->cube_size_factor * m->h_min;
  MCOR_RETURN_IF(!(cube > MCOR_LEAST_CUBE && cube < MCOR_MOST_CUBE), context, MCOR_OUT_OF_CAPACITY,
    "The cube size is %g; it must be between %g and %g. Use another cube size, or another unit of "
    "length.",
    cube, MCOR_LEAST_CUBE, MCOR_MOST_CUBE);
  MCOR_RETURN_IF(!(m->support_min > MCOR_LEAST_SUPPORT * cube), context, MCOR_OUT_OF_CAPACITY,
    "The cube size %g is more than %g times the smallest support radius %g. Use a smaller cube "
    "size, or remove particles with such a small smoothing length.",
    cube, 1 / MCOR_LEAST_SUPPORT, m->support_min);
  lattice->top = mcor_tree_top(m, options);
  MCOR_TRY(mcor_fit_period(context, options, cube));
  /* Whole bricks of all levels; with space around, so that finer bricks beside it have a place. */
  const int64_t unit = lattice->top > 0 ? (int64_t)MCOR_BRICK << (lattice->top + 1) : 0;
  int64_t extent = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double edge = lattice->edge[a];
    const double first = floor(m->low[a] / edge) - 1, last = ceil(m->high[a] / edge) + 1;
    MCOR_RETURN_IF(!(last - first <= MCOR_LATTICE_LIMIT), context, MCOR_OUT_OF_CAPACITY,
      "With cube size %g the virtual grid would have %.3g cells along %c; the limit is %d. "
      "Use a larger cube size, or remove particles that are far away from the rest.",
      edge, last - first, mcor_axis_letter(context, a), MCOR_LATTICE_LIMIT);
    MCOR_TRY(mcor_check_digits(context, m->low[a], m->high[a], edge));
    if (a == 2 && mcor_is_plane(context)) /* one layer of cells */
    {
      lattice->origin[a] = lattice->first[a] = 0;
      lattice->last[a] = lattice->blocks[a] = 1;
      lattice->period_first[a] = 0;
      continue;
    }
    lattice->origin[a] = (int64_t)floor(first / MCOR_BLOCK_CUBES) * MCOR_BLOCK_CUBES;
    if (unit > 0)
    {
      lattice->origin[a] = ((int64_t)floor(first / (double)unit) - 1) * unit;
    }
    lattice->first[a] = (int64_t)first - lattice->origin[a];
    lattice->last[a] = (int64_t)last - lattice->origin[a];
    lattice->blocks[a] = (int)((lattice->last[a] + 4) / MCOR_BLOCK_CUBES + 1);
    lattice->period_first[a] = lattice->period[a] > 0
      ? (int)(ceil(options->periodic[2 * a] / edge - 0.5) - (double)lattice->origin[a])
      : 0;
    extent = lattice->last[a] > extent ? lattice->last[a] : extent;
  }
  lattice->fix_bits = options->precision == MCOR_FLOAT64 ? 40 : 20;
  /* Where smoothing lengths differ much, lattices are long, and the last bit is needed. */
  const int bits = options->precision == MCOR_FLOAT64 ? 62 : lattice->top > 0 ? 31 : 30;
  while ((extent + 64 + 2 * unit) << lattice->fix_bits >= INT64_C(1) << bits)
  {
    --lattice->fix_bits;
  }
  mcor_fit_steps(context, extent);
  return MCOR_OK;
}

/* Bounds and ranges; then the lattice. */
mcor_status mcor_measure_input(
  mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  mcor_measure* m = &context->measure;
  *m = mcor_nothing;
  m->plane = context->plane;
  if (options->globals)
  {
    *m = options->globals->measured;
    return mcor_measure_lattice(context, options);
  }
  if (input->estimate_smoothing_length)
  {
    MCOR_TRY(mcor_estimate_smoothing_length(context, input, &m->h_estimate));
  }
  MCOR_TRY(mcor_measure_particles(
    context, input, mcor_support_factor(options->sph_kernel) * options->h_scale));
  MCOR_TRY(mcor_merge_ranks(context));
  MCOR_RETURN_IF(m->fluid_count == 0, context, MCOR_INVALID_DATA,
    "None of the %lld particles is marked as fluid.", (long long)m->solid_count);
  if (options->field == MCOR_WEIGHT_SUM)
  {
    m->scalar_min = 0;
    m->scalar_max = 1;
  }
  MCOR_TRY(mcor_check_derived(context, input));
  return mcor_measure_lattice(context, options);
}

/* Smoothing lengths that differ from the median by this factor are named. */
#define MCOR_OUTLIER 100

void mcor_blame_outlier(mcor_context* context, const mcor_input* input)
{
  const mcor_measure* m = &context->measure;
  const double below = m->h_median / m->h_min, above = m->h_max / m->h_median;
  const double outlier = below > above ? m->h_min : m->h_max;
  double h[MCOR_CHUNK];
  int64_t particle = -1;
  if (!(m->h_median > 0) || m->fluid_count < 2 || !(fmax(below, above) > MCOR_OUTLIER))
  {
    return;
  }
  for (int64_t i = 0; i < input->count && particle < 0; i += MCOR_CHUNK)
  {
    const int n = (int)(input->count - i < MCOR_CHUNK ? input->count - i : MCOR_CHUNK);
    mcor_read_smoothing_length(context, input, i, n, h);
    for (int k = 0; k < n && particle < 0; ++k)
    {
      particle = h[k] == outlier && !(input->solid && input->solid[i + k]) ? i + k : -1;
    }
  }
  if (particle >= 0)
  {
    const size_t length = strlen(context->error);
    snprintf(context->error + length, sizeof context->error - length,
      " Particle %lld has a smoothing length of %g, where the median is %g.", (long long)particle,
      outlier, m->h_median);
  }
}
