/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* How many neighbours a fluid particle has, and how near the nearest one is. A few watched
 * particles suffice to notice smoothing lengths that cannot be meant. They see all positions
 * while these are measured. If the watched particles lie in a plane that is tilted in space, it
 * is also seen whether all others do. */

#include "mcor_input.h"
#include "mcor_vector.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Written to be vectorised. */
static inline int mcor_watch_cell(const mcor_watch* watch, int axis, double x)
{
  const double cell = (x - watch->low[axis]) * watch->per_length[axis];
  const double above = cell > 0 ? cell : 0;
  return (int)(above < MCOR_WATCH_CELLS - 1 ? above : MCOR_WATCH_CELLS - 1);
}

/* ---- A plane that is tilted in space ---- */

/* In smoothing lengths: the greatest extent along the normal, the least one in the plane. */
#define MCOR_THIN 0.1
#define MCOR_BROAD 8

/* Finds the normal of the plane through the first watched particle, the one farthest from it,
 * and the one farthest from the line between these. */
static void mcor_find_normal(mcor_watch* watch)
{
  double from[MCOR_WATCHED][3], along[3] = { 0 }, normal[3] = { 0 }, h = DBL_MAX;
  for (int s = 0; s < watch->count; ++s)
  {
    for (int a = 0; a < 3; ++a)
    {
      from[s][a] = watch->sample[s].x[a] - watch->sample[0].x[a];
    }
    h = fmin(h, watch->sample[s].h);
    if (mcor_dot(from[s], from[s]) > mcor_dot(along, along))
    {
      memcpy(along, from[s], sizeof along);
    }
  }
  const double length = sqrt(mcor_dot(along, along));
  for (int s = 0; s < watch->count; ++s)
  {
    double cross[3];
    mcor_cross(along, from[s], cross);
    if (mcor_dot(cross, cross) > mcor_dot(normal, normal))
    {
      memcpy(normal, cross, sizeof normal);
    }
  }
  const double size = sqrt(mcor_dot(normal, normal));
  bool in_plane = length > MCOR_BROAD * h && size > MCOR_BROAD * h * length;
  for (int s = 0; s < watch->count && in_plane; ++s)
  {
    in_plane = fabs(mcor_dot(normal, from[s])) < MCOR_THIN * h * size;
  }
  for (int a = 0; a < 3 && in_plane; ++a)
  {
    watch->normal[a] = normal[a] / size;
  }
}

static bool mcor_has_normal(const mcor_watch* watch)
{
  return mcor_dot(watch->normal, watch->normal) > 0;
}

void mcor_watch_positions(mcor_watch* watch, int slice, int count, double x[3][MCOR_CHUNK])
{
  const double *n = watch->normal, from = mcor_dot(n, watch->sample[0].x);
  double* beyond = watch->beyond[slice];
  for (int i = 0; i < count && mcor_has_normal(watch); ++i)
  {
    const double d = n[0] * x[0][i] + n[1] * x[1][i] + n[2] * x[2][i] - from;
    beyond[0] = d > beyond[0] ? d : beyond[0];
    beyond[1] = -d > beyond[1] ? -d : beyond[1];
  }
  int cell[3][MCOR_CHUNK];
  for (int a = 0; a < 3; ++a)
  {
    for (int i = 0; i < count; ++i)
    {
      cell[a][i] = mcor_watch_cell(watch, a, x[a][i]);
    }
  }
  for (int i = 0; i < count; ++i)
  {
    uint32_t reached =
      watch->reached[0][cell[0][i]] & watch->reached[1][cell[1][i]] & watch->reached[2][cell[2][i]];
    for (int s = 0; reached; ++s, reached >>= 1)
    {
      const double reach = watch->support * watch->sample[s].h;
      double square = 0, *nearest = &watch->nearest[slice][s];
      for (int a = 0; a < 3 && (reached & 1); ++a)
      {
        const double d = x[a][i] - watch->sample[s].x[a];
        square += d * d;
      }
      watch->neighbours[slice][s] += (reached & 1) && square < reach * reach;
      *nearest = square > 0 ? fmin(*nearest, square) : *nearest;
    }
  }
}

/* Takes the medians over the watched particles. */
mcor_status mcor_end_watch(mcor_context* context, mcor_watch* watch, int slices)
{
  mcor_measure* m = &context->measure;
  const mcor_space* space = &context->space;
  int64_t neighbours[MCOR_WATCHED] = { 0 };
  double nearest[MCOR_WATCHED], count[MCOR_WATCHED], spacing[MCOR_WATCHED], filled[MCOR_WATCHED],
    h[MCOR_WATCHED], *beyond = watch->beyond[0];
  for (int s = 0; s < watch->count; ++s)
  {
    nearest[s] = DBL_MAX;
    for (int slice = 0; slice < slices; ++slice)
    {
      neighbours[s] += watch->neighbours[slice][s];
      nearest[s] = fmin(nearest[s], watch->nearest[slice][s]);
    }
  }
  MCOR_TRY(mcor_reduce_counts(context, MCOR_SUM_OF, neighbours, watch->count));
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_LEAST, nearest, watch->count));
  for (int s = 0; s < watch->count; ++s)
  {
    const double reach = watch->support * watch->sample[s].h, distance = sqrt(nearest[s]);
    count[s] = (double)neighbours[s];
    filled[s] = count[s] * watch->sample[s].volume / space->ball / mcor_power(reach, space->axes);
    spacing[s] = distance < reach ? distance : 0;
    h[s] = watch->sample[s].h;
  }
  m->neighbours = mcor_median_of(count, watch->count);
  m->spacing = mcor_median_of(spacing, watch->count);
  m->filled = mcor_median_of(filled, watch->count);
  m->h_median = mcor_median_of(h, watch->count);
  if (!mcor_has_normal(watch))
  {
    return MCOR_OK;
  }
  for (int s = 1; s < slices; ++s)
  {
    beyond[0] = fmax(beyond[0], watch->beyond[s][0]);
    beyond[1] = fmax(beyond[1], watch->beyond[s][1]);
  }
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_GREATEST, beyond, 2));
  if (beyond[0] + beyond[1] < MCOR_THIN * m->h_median)
  {
    memcpy(m->plane_normal, watch->normal, sizeof m->plane_normal);
    m->plane_extent = beyond[0] + beyond[1];
  }
  return MCOR_OK;
}

void mcor_begin_watch(const mcor_context* context, mcor_watch* watch)
{
  const mcor_sample_list* fluid = &context->samples[0];
  *watch = (mcor_watch){ .sample = fluid->of,
    .count = fluid->count < MCOR_WATCHED ? fluid->count : MCOR_WATCHED,
    .support = mcor_support_factor(context->run.options->sph_kernel) };
  for (int a = 0; a < 3; ++a)
  {
    double low = DBL_MAX, high = -DBL_MAX;
    for (int s = 0; s < watch->count; ++s)
    {
      const double reach = watch->support * watch->sample[s].h;
      low = fmin(low, watch->sample[s].x[a] - reach);
      high = fmax(high, watch->sample[s].x[a] + reach);
    }
    const double cell = (high - low) / (MCOR_WATCH_CELLS - 3);
    watch->low[a] = low - cell;
    watch->per_length[a] = cell > 0 ? 1 / cell : 0;
    for (int s = 0; s < watch->count; ++s)
    {
      const double x = watch->sample[s].x[a], reach = watch->support * watch->sample[s].h;
      const int last = mcor_watch_cell(watch, a, x + reach);
      for (int c = mcor_watch_cell(watch, a, x - reach); c <= last; ++c)
      {
        watch->reached[a][c] |= UINT32_C(1) << s;
      }
    }
  }
  for (int n = 0; n < MCOR_SLICES * MCOR_WATCHED; ++n)
  {
    watch->nearest[n / MCOR_WATCHED][n % MCOR_WATCHED] = DBL_MAX;
  }
  if (context->space.axes == 3)
  {
    mcor_find_normal(watch);
  }
}
