/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* How many neighbours a fluid particle has, and how near the nearest is: from a few of them, as this is
 * to notice smoothing lengths that cannot be meant. They are told of all positions while these are
 * measured. */

#include "mcor_input.h"
#include "mcor_parallel.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#define MCOR_WATCHED 32     /* fluid particles, bits of a mask */
#define MCOR_WATCH_CELLS 64 /* along each axis of a coarse grid; the outermost are in no reach */

/* Fluid particles, and whether any cell is in reach of each. */
struct mcor_watch
{
  const mcor_input* input;
  mcor_array positions;
  double low[3], cells_per_length[3];
  uint32_t* reached; /* [cells], bit s: of watched particle s */
  int count;
  double x[MCOR_WATCHED][3], h[MCOR_WATCHED], volume[MCOR_WATCHED], support;
  int64_t neighbours[MCOR_SLICES][MCOR_WATCHED];
  double nearest[MCOR_SLICES][MCOR_WATCHED]; /* squared distance */
};

static int mcor_watch_cell(const mcor_watch* watch, int axis, double x)
{
  const double cell = (x - watch->low[axis]) * watch->cells_per_length[axis];
  return cell > 0 ? (cell < MCOR_WATCH_CELLS ? (int)cell : MCOR_WATCH_CELLS - 1) : 0;
}

/* The volume of particle i where the input has it, else 0. */
static double mcor_given_volume(const mcor_input* input, int64_t i)
{
  return input->has_volume ? mcor_array_at(&input->volume, i, 0)
    : input->has_mass && input->has_density
    ? mcor_array_at(&input->mass, i, 0) / mcor_array_at(&input->density, i, 0)
    : 0;
}

/* Chooses fluid particles at even distances in the order of the input. */
static void mcor_choose_watched(const mcor_context* context, mcor_watch* watch)
{
  const mcor_input* input = watch->input;
  for (int s = 0; s < MCOR_WATCHED; ++s)
  {
    const int64_t first = input->count * s / MCOR_WATCHED;
    const int64_t last = input->count * (s + 1) / MCOR_WATCHED;
    int64_t i = first + (last - first) / 2;
    while (i < last && input->solid && input->solid[i])
    {
      ++i;
    }
    if (i < last)
    {
      for (int a = 0; a < 3; ++a)
      {
        watch->x[watch->count][a] = mcor_array_at(&watch->positions, i, a);
      }
      watch->volume[watch->count] = mcor_given_volume(input, i);
      mcor_read_smoothing_length(context, input, i, 1, &watch->h[watch->count++]);
    }
  }
}

/* Lays the grid over what is in reach of the watched. */
static void mcor_place_watch(mcor_watch* watch)
{
  for (int a = 0; a < 3; ++a)
  {
    double low = DBL_MAX, high = -DBL_MAX;
    for (int s = 0; s < watch->count; ++s)
    {
      const double reach = watch->support * watch->h[s];
      low = fmin(low, watch->x[s][a] - reach);
      high = fmax(high, watch->x[s][a] + reach);
    }
    const double cell = (high - low) / (MCOR_WATCH_CELLS - 3);
    watch->low[a] = low - cell;
    watch->cells_per_length[a] = cell > 0 ? 1 / cell : 0;
  }
}

static void mcor_mark_reached(mcor_watch* watch, int s)
{
  const double reach = watch->support * watch->h[s];
  int low[3], high[3];
  for (int a = 0; a < 3; ++a)
  {
    low[a] = mcor_watch_cell(watch, a, watch->x[s][a] - reach);
    high[a] = mcor_watch_cell(watch, a, watch->x[s][a] + reach);
  }
  for (int z = low[2]; z <= high[2]; ++z)
  {
    for (int y = low[1]; y <= high[1]; ++y)
    {
      for (int x = low[0]; x <= high[0]; ++x)
      {
        watch->reached[(z * MCOR_WATCH_CELLS + y) * MCOR_WATCH_CELLS + x] |= UINT32_C(1) << s;
      }
    }
  }
}

static void mcor_watch_particle(mcor_watch* watch, int slice, uint32_t reached, const double x[3])
{
  for (int s = 0; reached; ++s, reached >>= 1)
  {
    if (reached & 1)
    {
      const double reach = watch->support * watch->h[s];
      double square = 0;
      for (int a = 0; a < 3; ++a)
      {
        square += (x[a] - watch->x[s][a]) * (x[a] - watch->x[s][a]);
      }
      watch->neighbours[slice][s] += square < reach * reach;
      watch->nearest[slice][s] =
        square > 0 ? fmin(watch->nearest[slice][s], square) : watch->nearest[slice][s];
    }
  }
}

void mcor_watch_positions(mcor_watch* watch, int slice, int count, const double x[3][MCOR_CHUNK])
{
  for (int i = 0; i < count; ++i)
  {
    const double at[3] = { x[0][i], x[1][i], x[2][i] };
    int cell = 0;
    for (int a = 2; a >= 0; --a)
    {
      cell = cell * MCOR_WATCH_CELLS + mcor_watch_cell(watch, a, at[a]);
    }
    if (watch->reached[cell])
    {
      mcor_watch_particle(watch, slice, watch->reached[cell], at);
    }
  }
}

/* The medians over watched particles. */
static void mcor_sum_up_watch(mcor_watch* watch, int slices, mcor_measure* m)
{
  double neighbours[MCOR_WATCHED], spacing[MCOR_WATCHED], filled[MCOR_WATCHED];
  for (int s = 0; s < watch->count; ++s)
  {
    neighbours[s] = 0;
    spacing[s] = DBL_MAX;
    for (int slice = 0; slice < slices; ++slice)
    {
      neighbours[s] += (double)watch->neighbours[slice][s];
      spacing[s] = fmin(spacing[s], sqrt(watch->nearest[slice][s]));
    }
    const double reach = watch->support * watch->h[s];
    filled[s] = neighbours[s] * watch->volume[s] / (4.0 / 3 * 3.14159265358979323846) /
      (reach * reach * reach);
    spacing[s] = spacing[s] < reach ? spacing[s] : 0;
  }
  m->neighbours = mcor_median_of(neighbours, watch->count);
  m->spacing = mcor_median_of(spacing, watch->count);
  m->filled = mcor_median_of(filled, watch->count);
  m->h_median = mcor_median_of(watch->h, watch->count);
}

mcor_status mcor_begin_watch(mcor_context* context, const mcor_input* input, mcor_watch** begun)
{
  const size_t cells = (size_t)MCOR_WATCH_CELLS * MCOR_WATCH_CELLS * MCOR_WATCH_CELLS;
  mcor_watch* watch = calloc(1, sizeof *watch);
  uint32_t* reached = calloc(cells, sizeof *reached);
  if (!watch || !reached)
  {
    free(watch);
    free(reached);
    return mcor_fail(
      context, MCOR_OUT_OF_CAPACITY, "Host memory for %d particles ran out.", MCOR_WATCHED);
  }
  watch->input = input;
  watch->positions = input->positions;
  watch->positions.components = 3;
  watch->reached = reached;
  watch->support = mcor_support_factor(context->options->sph_kernel);
  mcor_choose_watched(context, watch);
  mcor_place_watch(watch);
  for (int s = 0; s < watch->count; ++s)
  {
    mcor_mark_reached(watch, s);
    for (int slice = 0; slice < MCOR_SLICES; ++slice)
    {
      watch->nearest[slice][s] = DBL_MAX;
    }
  }
  *begun = watch;
  return MCOR_OK;
}

void mcor_end_watch(mcor_watch* watch, int slices, mcor_measure* m)
{
  mcor_sum_up_watch(watch, slices, m);
  free(watch->reached);
  free(watch);
}
