/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds whether the fluid has a free surface. A gas that fills its bounds has none. */

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

/* Finds the ranges of x, y, z, smoothing length and density over the fluid and, as sums, how many
 * particles are fluid and how many are solids. */
static mcor_findings mcor_measure_filling(const mcor_input* input)
{
  mcor_findings found = mcor_no_findings();
  const mcor_array positions = mcor_positions_of(input);
  for (int k = 0; k < 5; ++k)
  {
    const mcor_array* array = k < 3 ? &positions
      : k < 4                       ? &input->smoothing_length
                                    : &input->density;
    const mcor_findings range =
      mcor_find_range(NULL, array, input->solid, MCOR_SKIP_SOLIDS, input->count, k < 3 ? k : 0);
    mcor_add_range(&found, k, range.least[0], range.most[0]);
  }
  found.sums[0] = input->solid ? 0 : input->count;
  for (int64_t i = 0; i < input->count && input->solid; ++i)
  {
    found.sums[0] += !input->solid[i];
    found.sums[1] += input->solid[i] && input->solid[i] != MCOR_ABSENT;
  }
  return found;
}

/* mcor_mark_filling marks the cells that fluid particles reach by their smoothing lengths. */
typedef struct mcor_filling_job
{
  const mcor_input* input;
  const double* low; /* the lower corner of the fluid's bounds */
  double size;
  int cells[3], all;
  uint8_t* marks; /* [MCOR_SLICES][all] */
} mcor_filling_job;

static void mcor_mark_filling(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_filling_job* job = data;
  const mcor_input* input = job->input;
  uint8_t* marks = job->marks + (size_t)slice * (size_t)job->all;
  double x[3][MCOR_CHUNK], h[MCOR_CHUNK];
  for (int count; (count = mcor_chunk_of(last - first)) > 0; first += count)
  {
    mcor_read_positions(input, first, count, x);
    mcor_read_array(&input->smoothing_length, first, count, 0, h);
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
  mcor_context* context, const mcor_input* input, const mcor_findings* of)
{
  double longest = 0, filled = 1;
  int axes = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double side = of->most[a] - of->least[a];
    longest = fmax(longest, side);
    filled *= side > 0 ? side : 1;
    axes += side > 0;
  }
  mcor_input own = *input;
  own.positions.components = 3; /* whatever the caller has set */
  if (input->estimate_smoothing_length || !mcor_is_given(&input->smoothing_length))
  {
    own.smoothing_length =
      (mcor_array){ .constant = pow(filled / (double)of->sums[0], 1.0 / axes) };
  }
  mcor_filling_job job = {
    .input = &own, .low = of->least, .size = longest / MCOR_FILLING_CELLS, .all = 1
  };
  if (!(job.size > 0) || !isfinite(job.size))
  {
    return false;
  }
  for (int a = 0; a < 3; ++a)
  {
    job.cells[a] = (int)fmax(1, ceil((of->most[a] - of->least[a]) / job.size));
    job.all *= job.cells[a];
  }
  int64_t *reached = calloc((size_t)job.all, sizeof *reached), count = 0;
  job.marks = calloc((size_t)job.all, MCOR_SLICES);
  if (reached && job.marks)
  {
    const int slices =
      mcor_parallel_for(NULL, input->count, MCOR_LIGHT_GRAIN, mcor_mark_filling, &job);
    for (int i = 0; i < slices * job.all; ++i)
    {
      reached[i % job.all] |= job.marks[i];
    }
    const bool is_heard = mcor_reduce_counts(context, MCOR_GREATEST, reached, job.all) == MCOR_OK;
    for (int i = 0; i < job.all && is_heard; ++i)
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
  const mcor_options options = { .ranks = ranks };
  mcor_context* context = mcor_make_bare_context(&options);
  mcor_findings found = mcor_measure_filling(input);
  bool has = true; /* also if memory ran out, or another rank failed */
  if (context && mcor_reduce_findings(context, &found) == MCOR_OK)
  {
    const double rho = found.least[4];
    const bool is_liquid =
      rho > 0 && found.most[4] <= MCOR_LIQUID_RANGE * rho && found.most[3] == found.least[3];
    has = found.sums[1] > 0 || found.sums[0] == 0 || is_liquid ||
      !mcor_fills_bounds(context, input, &found);
  }
  mcor_free_bare_context(context);
  return has;
}
