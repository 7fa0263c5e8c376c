/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds whether the free surface is what users want to see first. */

#include "mcor_input.h"
#include "mcor_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How many cells divide the bounds of the fluid along their longest side. */
#define MCOR_FILLING_CELLS 32
/* The fluid fills its bounds if it reaches this share of the cells. */
#define MCOR_FILLING_SHARE 0.98
/* The densities of a liquid differ by at most this factor, even if they are low at its surface. */
#define MCOR_LIQUID_RANGE 2.0

/* least: the least x, y, z, smoothing length and density of the fluid, then minus the greatest of
 * each, so that one reduction finds all. counts: the numbers of fluid particles and of solids. */
typedef struct mcor_filling
{
  double least[10];
  int64_t counts[2];
} mcor_filling;

static mcor_filling mcor_measure_filling(const mcor_input* input)
{
  mcor_filling found = { .counts = { input->solid ? 0 : input->count } };
  const mcor_array positions = mcor_positions_of(input);
  for (int k = 0; k < 5; ++k)
  {
    const mcor_array* array = k < 3 ? &positions
      : k < 4                       ? &input->smoothing_length
                                    : &input->density;
    double range[2];
    mcor_find_range(
      NULL, array, input->solid, MCOR_SKIP_SOLIDS, input->count, k < 3 ? k : 0, range);
    found.least[k] = range[0];
    found.least[5 + k] = -range[1];
  }
  for (int64_t i = 0; i < input->count && input->solid; ++i)
  {
    found.counts[0] += !input->solid[i];
    found.counts[1] += input->solid[i] && input->solid[i] != MCOR_ABSENT;
  }
  return found;
}

/* Marks the cells that particles reach by their smoothing length. */
typedef struct mcor_filling_job
{
  const mcor_input* input;
  const double* low; /* the lower corner of the fluid's bounds */
  double length;     /* the smoothing length of all particles; 0: they have their own */
  double size;
  int cells[3], all;
  uint8_t* marks; /* [MCOR_SLICES][all] */
} mcor_filling_job;

static void mcor_mark_filling(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_filling_job* job = data;
  const mcor_input* input = job->input;
  const mcor_array constant = { .constant = job->length }, positions = mcor_positions_of(input);
  uint8_t* marks = job->marks + (size_t)slice * (size_t)job->all;
  double x[3][MCOR_CHUNK], h[MCOR_CHUNK];
  for (int count; (count = mcor_chunk_of(last - first)) > 0; first += count)
  {
    for (int a = 0; a < 3; ++a)
    {
      mcor_read_array(&positions, first, count, a, x[a]);
    }
    mcor_read_array(job->length > 0 ? &constant : &input->smoothing_length, first, count, 0, h);
    for (int i = 0; i < count; ++i)
    {
      int from[3], to[3];
      for (int a = 0; a < 3; ++a)
      {
        const double at = x[a][i] - job->low[a], most = job->cells[a] - 1;
        from[a] = (int)fmax(0, fmin(most, floor((at - h[i]) / job->size)));
        to[a] = (int)fmax(0, fmin(most, floor((at + h[i]) / job->size)));
      }
      const bool is_marked = (!input->solid || !input->solid[first + i]) && from[0] <= to[0];
      for (int z = from[2]; z <= to[2] && is_marked; ++z)
      {
        for (int y = from[1]; y <= to[1]; ++y)
        {
          const size_t row = (size_t)job->cells[0] * (size_t)(y + job->cells[1] * z);
          memset(marks + row + from[0], 1, (size_t)(to[0] - from[0] + 1));
        }
      }
    }
  }
}

static bool mcor_fills_bounds(
  const mcor_input* input, const mcor_ranks* ranks, const mcor_filling* of)
{
  double longest = 0, filled = 1;
  int axes = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double side = -of->least[5 + a] - of->least[a];
    longest = fmax(longest, side);
    filled *= side > 0 ? side : 1;
    axes += side > 0;
  }
  const bool is_known =
    !input->estimate_smoothing_length && mcor_is_given(&input->smoothing_length);
  mcor_filling_job job = { .input = input,
    .low = of->least,
    .length = is_known ? 0 : pow(filled / (double)of->counts[0], 1.0 / axes),
    .size = longest / MCOR_FILLING_CELLS,
    .all = 1 };
  if (!(job.size > 0) || !isfinite(job.size))
  {
    return false;
  }
  for (int a = 0; a < 3; ++a)
  {
    job.cells[a] = (int)fmax(1, ceil((-of->least[5 + a] - of->least[a]) / job.size));
    job.all *= job.cells[a];
  }
  int64_t* reached = calloc((size_t)job.all, sizeof *reached);
  job.marks = calloc((size_t)job.all, MCOR_SLICES);
  int64_t count = 0;
  if (reached && job.marks)
  {
    const int slices =
      mcor_parallel_for(NULL, input->count, MCOR_LIGHT_GRAIN, mcor_mark_filling, &job);
    for (int i = 0; i < slices * job.all; ++i)
    {
      reached[i % job.all] |= job.marks[i];
    }
    const bool failed = ranks && ranks->reduce_counts(ranks->user, MCOR_GREATEST, reached, job.all);
    for (int i = 0; i < job.all && !failed; ++i)
    {
      count += reached[i];
    }
  }
  free(reached);
  free(job.marks);
  return (double)count >= MCOR_FILLING_SHARE * job.all;
}

int mcor_has_free_surface(const mcor_input* input, const mcor_ranks* ranks)
{
  mcor_filling found = mcor_measure_filling(input);
  if (ranks &&
    (ranks->reduce_counts(ranks->user, MCOR_SUM_OF, found.counts, 2) ||
      ranks->reduce_doubles(ranks->user, MCOR_LEAST, found.least, 10)))
  {
    return 1; /* another rank failed */
  }
  const double h = found.least[3], rho = found.least[4];
  const bool is_liquid =
    rho > 0 && -found.least[9] <= MCOR_LIQUID_RANGE * rho && -found.least[8] == h;
  return found.counts[1] > 0 || found.counts[0] == 0 || is_liquid ||
    !mcor_fills_bounds(input, ranks, &found);
}
