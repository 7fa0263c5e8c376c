/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Measures the wall share: surfaces end where solids have this share of the weight sum. Surfaces
 * then end on the layer of solids that faces the fluid. The wall share is the median of the solids'
 * shares at sampled solids. Each sample counts in proportion to the fluid's weight sum at the
 * sample, so solids that no fluid reaches do not count. Weights are added as whole numbers, so the
 * result depends neither on the order of the particles nor on how ranks share them. */

#include "mcor_input.h"
#include "mcor_vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* MCOR_WHOLE_WEIGHT: the whole number that stands for a weight of 1. MCOR_MOST_WEIGHT: the most
 * that one particle adds to a sum, so that no sum overflows. */
#define MCOR_WHOLE_WEIGHT 1073741824.0
#define MCOR_MOST_WEIGHT 4.0

#define MCOR_FREE_WALL_SHARE 0.5

typedef struct mcor_wall_sample
{
  double x[3], fluid, share; /* fluid: the fluid's weight; share: the solids' share */
} mcor_wall_sample;

typedef struct mcor_wall_measure
{
  const mcor_context* context;
  const mcor_input* input;
  int count, axis;  /* axis: along which the samples are sorted; -1: none */
  double period[3]; /* 0: open */
  double reach;     /* the largest support radius */
  double mass_max;
  mcor_wall_sample sample[MCOR_SAMPLES];
  int64_t weights[MCOR_SLICES][MCOR_SAMPLES][2]; /* weight of the fluid, of the solids */
} mcor_wall_measure;

static void mcor_wall_add(
  mcor_wall_measure* wall, int slice, int64_t i, const double x[3], double h, double length)
{
  const mcor_options* options = wall->context->run.options;
  const bool solid = wall->input->solid && wall->input->solid[i];
  const mcor_sph_kernel kernel = options->sph_kernel;
  const double scaled = length * options->h_scale, along = wall->axis >= 0 ? x[wall->axis] : 0,
               inv_h = 1 / scaled;
  double weight = 0;
  int first = 0, end = wall->axis >= 0 ? wall->count : 0;
  while (first < end) /* finds the first sample that is near enough along the axis */
  {
    const int middle = (first + end) / 2;
    const bool before = wall->sample[middle].x[wall->axis] < along - wall->reach;
    first = before ? middle + 1 : first;
    end = before ? end : middle;
  }
  for (int s = first; s < wall->count; ++s)
  {
    double d[3];
    bool near = true;
    for (int a = 0; a < 3; ++a)
    {
      d[a] = wall->sample[s].x[a] - x[a];
      d[a] -= wall->period[a] > 0 ? wall->period[a] * floor(d[a] / wall->period[a] + 0.5) : 0;
      near = near && fabs(d[a]) <= wall->reach;
    }
    if (wall->axis >= 0 && d[wall->axis] > wall->reach)
    {
      break;
    }
    const double w = !near                ? 0
      : mcor_kernel_of(kernel)->is_tensor ? mcor_w_of(kernel, fabs(d[0]) * inv_h) *
        mcor_w_of(kernel, fabs(d[1]) * inv_h) * mcor_w_of(kernel, fabs(d[2]) * inv_h)
                                          : mcor_w_of(kernel, sqrt(mcor_dot(d, d)) * inv_h);
    if (w != 0 && weight == 0)
    {
      /* The solids' share of the weight depends neither on the unit of volumes nor on the kernel's
       * norm. So mass times h^d (d: the dimension) replaces a volume that is not known yet, and the
       * norm of three dimensions is used in two dimensions, too. */
      const int axes = wall->context->space.axes;
      const bool is_mass = mcor_needs_density(wall->input);
      mcor_read_size(wall->input, i, 1, &weight);
      weight = is_mass ? weight / wall->mass_max : weight;
      for (int a = 0; a < axes && is_mass; ++a)
      {
        weight *= h;
      }
      weight *= mcor_kernel_of(kernel)->norm;
      weight /= mcor_power(scaled, axes);
    }
    if (w != 0)
    {
      const double most = fmin(fmax(weight * w, -MCOR_MOST_WEIGHT), MCOR_MOST_WEIGHT);
      wall->weights[slice][s][solid] += llrint(most * MCOR_WHOLE_WEIGHT);
    }
  }
}

static void mcor_wall_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_wall_measure* wall = data;
  mcor_places p;
  for (; mcor_read_places(wall->context, wall->input, first, last, &p) > 0; first += p.count)
  {
    for (int i = 0; i < p.count; ++i)
    {
      const double at[3] = { p.x[0][i], p.x[1][i], p.x[2][i] };
      if (mcor_is_used(wall->context, wall->input, first + i))
      {
        mcor_wall_add(wall, slice, first + i, at, p.h[i], p.length[i]);
      }
    }
  }
}

/* Returns the median of the solids' shares at the samples, from 0.01 to 0.99. Each sample counts by
 * the fluid's weight sum. Returns MCOR_FREE_WALL_SHARE if no sample has fluid near. */
static double mcor_median_share(mcor_wall_measure* wall)
{
  double sum = 0, median = INFINITY;
  for (int s = 0; s < wall->count; ++s)
  {
    const double fluid = (double)wall->weights[0][s][0], solid = (double)wall->weights[0][s][1];
    wall->sample[s].fluid = fluid > 0 && solid > 0 ? fluid : 0;
    wall->sample[s].share = solid / (fluid + solid);
    sum += wall->sample[s].fluid;
  }
  for (int s = 0; s < wall->count; ++s)
  {
    double counted = 0; /* the weight at samples whose share is not greater */
    for (int t = 0; t < wall->count; ++t)
    {
      counted += wall->sample[t].share <= wall->sample[s].share ? wall->sample[t].fluid : 0;
    }
    const bool is_enough = wall->sample[s].fluid > 0 && counted >= 0.5 * sum;
    median = is_enough ? fmin(median, wall->sample[s].share) : median;
  }
  return median < INFINITY ? fmin(fmax(median, 0.01), 0.99) : MCOR_FREE_WALL_SHARE;
}

/* Sorts the samples along an axis without a period, if there is one, and weighs fluid and solids at
 * each sample. */
static mcor_status mcor_weigh_samples(mcor_context* context, mcor_wall_measure* wall)
{
  const mcor_input* input = wall->input;
  const mcor_sample_list* solids = &context->samples[1];
  wall->axis = -1;
  for (int a = 2; a >= 0; --a)
  {
    const double* period = context->run.options->periodic + 2 * a;
    wall->period[a] = period[1] - period[0];
    wall->axis = wall->period[a] > 0 ? wall->axis : a;
  }
  for (int i = 0; i < solids->count; ++i)
  {
    const double* x = solids->of[i].x;
    int to = wall->count++;
    for (; to > 0 && wall->axis >= 0 && wall->sample[to - 1].x[wall->axis] > x[wall->axis]; --to)
    {
      wall->sample[to] = wall->sample[to - 1];
    }
    memcpy(wall->sample[to].x, x, sizeof wall->sample[to].x);
  }
  wall->mass_max = mcor_is_given(&input->mass) ? mcor_largest(context, input, &input->mass, 0) : 1;
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_GREATEST, &wall->mass_max, 1));
  int slices;
  MCOR_TRY(
    mcor_parallel_run(context, input->count, MCOR_HEAVY_GRAIN, mcor_wall_slice, wall, &slices));
  for (int n = 2 * wall->count; n < 2 * wall->count * slices; ++n)
  {
    const int slice = n / 2 / wall->count, s = n / 2 % wall->count;
    wall->weights[0][s][n % 2] += wall->weights[slice][s][n % 2];
  }
  return mcor_reduce_counts(context, MCOR_SUM_OF, wall->weights[0][0], 2 * wall->count);
}

mcor_status mcor_measure_wall(mcor_context* context, const mcor_input* input)
{
  mcor_measure* m = &context->measure;
  if (mcor_asked_share(context->run.options) >= 0 || m->wall_share > 0 || m->solid_count == 0 ||
    !context->kept.uses_solids)
  {
    return MCOR_OK;
  }
  MCOR_FAIL_IF(context->run.options->globals, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(GLOBALS_LACK_WALL_SHARE));
  if (context->run.options->field == MCOR_WEIGHT_SUM)
  {
    m->wall_share = MCOR_FREE_WALL_SHARE;
    return MCOR_OK;
  }
  mcor_wall_measure* wall = calloc(1, sizeof *wall);
  MCOR_TRY(mcor_allocated(context, wall));
  wall->context = context;
  wall->input = input;
  wall->reach = m->support_max;
  const mcor_status status = mcor_weigh_samples(context, wall);
  m->wall_share = status == MCOR_OK ? mcor_median_share(wall) : 0;
  free(wall);
  return status;
}
