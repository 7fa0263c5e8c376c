/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Measures the particles for the other phases: ranges, bounds, the lattice. */

#include "mcor_box.h"
#include "mcor_input.h"
#include "mcor_plane.h"
#include "mcor_tree.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* The least support radius, in cubes. Below it, hardly any node would see a particle. */
#define MCOR_LEAST_SUPPORT 1e-3

/* Cube sizes for which volumes, areas and gradients are finite numbers above 0. */
#define MCOR_LEAST_CUBE 1e-100
#define MCOR_MOST_CUBE 1e100

/* Findings over all particles: the ranges, and the sums. */
enum
{
  MCOR_REACHES = 0, /* positions minus and plus support radii: x, y, z */
  MCOR_PLACES = 3,  /* positions of fluid particles: x, y, z */
  MCOR_LENGTHS = 6, /* smoothing lengths of fluid particles */
  MCOR_SUPPORTS = 7,
  MCOR_SCALARS = 8,
  MCOR_SPOTS = 9,    /* positions of all particles in use: x, y, z */
  MCOR_FACTORS = 12, /* of smoothing lengths of fluid particles */

  MCOR_FLUID = 0, /* particles: sum k is that of part k of a chunk */
  MCOR_SOLIDS = 1,
  MCOR_FACTOR_SUM = 2
};

/* Greatest contribution of one factor to their sum. */
#define MCOR_MOST_FACTOR 256.0

/* Measures the places of a chunk's fluid, or of its solids. If all lengths are one, the extremes
 * may be taken first: rounding keeps the order of numbers. */
static void mcor_measure_chunk(
  const mcor_places* chunk, bool solids, double reach, mcor_findings* r)
{
  double h_min = DBL_MAX, h_max = -DBL_MAX, least = DBL_MAX, most = -DBL_MAX;
  mcor_widen_range(chunk->h, chunk->count, &h_min, &h_max);
  mcor_widen_range(chunk->length, chunk->count, &least, &most);
  for (int a = 0; a < 3 && chunk->count > 0; ++a)
  {
    const double* x = chunk->x[a];
    double low = DBL_MAX, high = -DBL_MAX;
    mcor_widen_range(x, chunk->count, &low, &high);
    mcor_add_range(r, MCOR_SPOTS + a, low, high);
    if (!solids)
    {
      mcor_add_range(r, MCOR_PLACES + a, low, high);
    }
    if (least == most)
    {
      mcor_add_range(r, MCOR_REACHES + a, low - least * reach, high + least * reach);
      continue;
    }
    for (int i = 0; i < chunk->count; ++i)
    {
      const double support = chunk->length[i] * reach;
      mcor_add_range(r, MCOR_REACHES + a, x[i] - support, x[i] + support);
    }
  }
  if (chunk->count > 0)
  {
    mcor_add_range(r, MCOR_SUPPORTS, least * reach, most * reach);
    mcor_add_range(r, MCOR_LENGTHS, solids ? DBL_MAX : h_min, solids ? -DBL_MAX : h_max);
  }
}

/* Moves the solids out of a chunk, and drops absent particles. `solid`: the marks of the chunk's
 * particles, or NULL. */
static void mcor_part_chunk(const uint8_t* solid, mcor_places* chunk, mcor_places* solids)
{
  const int count = chunk->count;
  solids->count = 0;
  chunk->count = solid ? 0 : count;
  for (int i = 0; i < count && solid; ++i)
  {
    mcor_places* to = solid[i] ? solids : chunk;
    for (int a = 0; a < 3; ++a)
    {
      to->x[a][to->count] = chunk->x[a][i];
    }
    to->h[to->count] = chunk->h[i];
    to->length[to->count] = chunk->length[i];
    to->count += solid[i] != MCOR_ABSENT;
  }
}

typedef struct mcor_measuring
{
  const mcor_context* context;
  const mcor_input* input;
  double reach; /* support radius / smoothing length */
  mcor_watch watch;
  mcor_findings slices[MCOR_SLICES];
} mcor_measuring;

static void mcor_measure_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_measuring* job = data;
  const mcor_context* context = job->context;
  const mcor_input* input = job->input;
  const bool has_scalar = context->run.options->field != MCOR_WEIGHT_SUM,
             is_widened = mcor_is_given(&input->widening);
  mcor_findings r = mcor_no_findings();
  mcor_places part[2]; /* fluid, solids */
  double value[MCOR_CHUNK];
  for (int count; (count = mcor_read_places(context, input, first, last, part)) > 0; first += count)
  {
    const uint8_t* solid = input->solid ? input->solid + first : NULL;
    mcor_read_scalar(input, first, has_scalar ? count : 0, value);
    for (int i = 0; i < count && has_scalar; ++i)
    {
      if (!solid || !solid[i])
      {
        mcor_add_range(&r, MCOR_SCALARS, value[i], value[i]);
        r.first = !isfinite(value[i]) && first + i < r.first ? first + i : r.first;
      }
    }
    for (int i = 0; i < count && is_widened; ++i)
    {
      if (!solid || !solid[i])
      {
        const double factor = mcor_array_at(&input->widening, first + i, 0);
        mcor_add_range(&r, MCOR_FACTORS, factor, factor);
        r.sums[MCOR_FACTOR_SUM] += (int64_t)ldexp(fmin(factor, MCOR_MOST_FACTOR), 23);
      }
    }
    mcor_part_chunk(solid, &part[0], &part[1]);
    for (int k = 0; k < 2; ++k)
    {
      r.sums[k] += part[k].count;
      if (k == 0 || !input->ignore_solids)
      {
        mcor_watch_positions(&job->watch, slice, part[k].count, part[k].x);
      }
      if (k == 0 || context->kept.uses_solids)
      {
        mcor_measure_chunk(&part[k], k == 1, job->reach, &r);
      }
    }
  }
  job->slices[slice] = r;
}

/* Measures the particles of all ranks. A particle that is not finite is reported by its own rank
 * alone. */
static mcor_status mcor_measure_particles(
  mcor_context* context, const mcor_input* input, mcor_findings* r)
{
  mcor_measure* m = &context->measure;
  const mcor_options* options = context->run.options;
  mcor_measuring job = { .context = context,
    .input = input,
    .reach = mcor_support_factor(options->sph_kernel) * options->h_scale };
  int slices;
  mcor_begin_watch(context, &job.watch);
  MCOR_TRY(
    mcor_parallel_run(context, input->count, MCOR_HEAVY_GRAIN, mcor_measure_slice, &job, &slices));
  *r = mcor_merge_findings(job.slices, slices);
  MCOR_TRY(mcor_end_watch(context, &job.watch, slices));
  MCOR_TRY(mcor_reduce_findings(context, r));
  m->fluid_count = r->sums[MCOR_FLUID];
  m->solid_count = r->sums[MCOR_SOLIDS];
  for (int a = 0; a < 3; ++a)
  {
    m->low[a] = r->least[MCOR_REACHES + a];
    m->high[a] = r->most[MCOR_REACHES + a];
    m->x_low[a] = r->least[MCOR_PLACES + a];
    m->x_high[a] = r->most[MCOR_PLACES + a];
  }
  m->h_min = r->least[MCOR_LENGTHS];
  m->h_max = r->most[MCOR_LENGTHS];
  m->support_min = r->least[MCOR_SUPPORTS];
  m->support_max = r->most[MCOR_SUPPORTS];
  m->widening_sum = r->sums[MCOR_FACTOR_SUM];
  m->widening_min = m->widening_sum > 0 ? r->least[MCOR_FACTORS] : 0;
  m->widening_max = m->widening_sum > 0 ? r->most[MCOR_FACTORS] : 0;
  m->scalar_min = r->least[MCOR_SCALARS];
  m->scalar_max = r->most[MCOR_SCALARS];
  m->not_finite = r->first;
  return MCOR_OK;
}

/* Whether keys have enough bits for all nodes and cells of a lattice, as far as there are
 * surfaces. */
static bool mcor_has_keys(const mcor_measure* m, const mcor_lattice* lattice, int top)
{
  const double unit = top > 0 ? ldexp(MCOR_BRICK, top + 1) : MCOR_BLOCK_CUBES;
  double cells = top > 0 ? 8.0 / 7 : 1; /* counts the bricks of all levels */
  bool good = true;
  for (int a = 0; a < 3; ++a)
  {
    const double end = m->cut ? m->cut_high[a] : m->high[a];
    const double nodes = (end - m->low[a]) / lattice->edge[a] + 2 * unit;
    cells *= a == 2 ? nodes : (m->high[a] - m->low[a]) / lattice->edge[a] + 3 * unit;
    good = good && nodes <= MCOR_NODE_LIMIT;
  }
  return good && cells < MCOR_KEY_LIMIT;
}

/* Lays the virtual grid over everything that the particles' supports reach. */
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
  int top = mcor_tree_top(m, options);
  MCOR_TRY(mcor_fit_period(context, options, cube, &top));
  while (top > 0 && !mcor_has_keys(m, lattice, top))
  {
    --top;
  }
  lattice->levels = top + 1;
  /* Whole bricks of all levels, and space around them for finer bricks beside. */
  const int64_t unit = top > 0 ? (int64_t)MCOR_BRICK << (top + 1) : 0;
  int64_t extent = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double edge = lattice->edge[a];
    const double first = floor(m->low[a] / edge) - 1, last = ceil(m->high[a] / edge) + 1;
    const int limit = m->cut ? MCOR_CUT_LIMIT : MCOR_LATTICE_LIMIT;
    context->run.is_too_long = !(last - first <= limit);
    MCOR_RETURN_IF(context->run.is_too_long, context, MCOR_OUT_OF_CAPACITY,
      "With cube size %g the virtual grid would have %.3g cells along %c; the limit is %d. Use a "
      "larger cube size, or remove particles that are far away from the rest.",
      edge, last - first, mcor_axis_letter(context, a), limit);
    MCOR_TRY(mcor_check_digits(context, m->low[a], m->high[a], edge));
    if (a >= context->space.axes) /* one layer of cells */
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
  context->run.is_too_long = !mcor_has_keys(m, lattice, top);
  MCOR_RETURN_IF(context->run.is_too_long, context, MCOR_OUT_OF_CAPACITY,
    "With cube size %g the virtual grid would be %.3g cells long, which is too long together with "
    "its other sides. Use a larger cube size, or remove particles that are far away from the rest.",
    cube, (double)extent);
  lattice->fix_bits = options->precision == MCOR_FLOAT64 ? 40 : 20;
  /* Needs the last bit: where smoothing lengths differ much, lattices are long. */
  const int bits = options->precision == MCOR_FLOAT64 ? 62 : top > 0 ? 31 : 30;
  while ((extent + 64 + 2 * unit) << lattice->fix_bits >= INT64_C(1) << bits)
  {
    --lattice->fix_bits;
  }
  mcor_fit_steps(context, extent);
  return MCOR_OK;
}

/* Measures bounds and ranges, then the lattice. */
mcor_status mcor_measure_input(
  mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  mcor_measure* m = &context->measure;
  mcor_findings found;
  *m = (mcor_measure){ .plane = context->plane, .not_finite = INT64_MAX };
  if (options->globals)
  {
    *m = options->globals->measured;
    return mcor_measure_lattice(context, options);
  }
  MCOR_TRY(mcor_choose_samples(
    context, input, input->estimate_smoothing_length ? MCOR_SAMPLES : MCOR_WATCHED));
  if (input->estimate_smoothing_length)
  {
    MCOR_TRY(mcor_estimate_smoothing_length(context, input, &m->h_estimate));
  }
  MCOR_TRY(mcor_measure_particles(context, input, &found));
  if (context->run.far)
  {
    mcor_cut_bounds(context, found.least + MCOR_SPOTS, found.most + MCOR_SPOTS);
  }
  MCOR_RETURN_IF(m->fluid_count == 0, context, MCOR_INVALID_DATA,
    "None of the %lld particles is marked as fluid.", (long long)m->solid_count);
  if (options->field == MCOR_WEIGHT_SUM)
  {
    m->scalar_min = 0;
    m->scalar_max = 1;
  }
  /* A magnitude, or a dot product, may overflow although its components are finite. */
  const char* name = mcor_array_name(&input->scalar, "scalar");
  MCOR_RETURN_IF(m->not_finite < INT64_MAX && input->scalar_dot.data, context, MCOR_INVALID_DATA,
    "The dot product of arrays %s and %s at particle %lld is too large for a double. Use other "
    "units, or remove such particles.",
    name, mcor_array_name(&input->scalar_dot, "scalar"), (long long)m->not_finite);
  MCOR_RETURN_IF(m->not_finite < INT64_MAX, context, MCOR_INVALID_DATA,
    "The magnitude of array %s at particle %lld is too large for a double. Use another unit, or "
    "remove such particles.",
    name, (long long)m->not_finite);
  return mcor_measure_lattice(context, options);
}

/* A smoothing length that differs from the median by this factor is named in the error. */
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
    const int n = mcor_chunk_of(input->count - i);
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
      " Particle %lld has a smoothing length of %g; the median is %g.", (long long)particle,
      outlier, m->h_median);
  }
}
