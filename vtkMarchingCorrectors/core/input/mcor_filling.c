/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Whether the free surface is what users want to see first. */

#include "mcor_input.h"
#include "mcor_parts.h"

#include <math.h>
#include <stdlib.h>

/* The bounds of the fluid are divided into so many cells along their longest side. */
#define MCOR_FILLING_CELLS 32
/* The fluid fills its bounds if it reaches this share of the cells. */
#define MCOR_FILLING_SHARE 0.98
/* The densities of a liquid are within this factor, the low sums at its surface included. */
#define MCOR_LIQUID_RANGE 2.0

/* The ranges of x, y, z, smoothing length and density, each with the sign of the greatest value
 * changed, so that one reduction finds all; and whether there are solids. */
typedef struct mcor_filling
{
  double least[10];
  int64_t count, solids;
} mcor_filling;

static mcor_filling mcor_measure_filling(const mcor_input* input)
{
  mcor_filling found = { .count = 0 };
  const mcor_array positions = mcor_positions_of(input);
  for (int k = 0; k < 10; ++k)
  {
    found.least[k] = INFINITY;
  }
  for (int64_t i = 0; i < input->count; ++i)
  {
    found.solids += input->solid && input->solid[i] && input->solid[i] != MCOR_ABSENT;
    if (input->solid && input->solid[i])
    {
      continue;
    }
    ++found.count;
    for (int k = 0; k < 5; ++k)
    {
      const double value = k < 3 ? mcor_array_at(&positions, i, k)
        : k < 4                  ? mcor_array_at(&input->smoothing_length, i, 0)
                                 : mcor_array_at(&input->density, i, 0);
      found.least[k] = mcor_least(found.least[k], value);
      found.least[5 + k] = mcor_least(found.least[5 + k], -value);
    }
  }
  return found;
}

/* Marks the cells that particles reach by their smoothing length. */
static void mcor_mark_filling(const mcor_input* input, const mcor_filling* of, double length,
  double size, const int cells[3], int64_t* marks)
{
  const mcor_array positions = mcor_positions_of(input);
  for (int64_t i = 0; i < input->count; ++i)
  {
    if (input->solid && input->solid[i])
    {
      continue;
    }
    const double h = length > 0 ? length : mcor_array_at(&input->smoothing_length, i, 0);
    int from[3], to[3];
    for (int a = 0; a < 3; ++a)
    {
      const double x = mcor_array_at(&positions, i, a) - of->least[a];
      from[a] = (int)fmax(0, fmin(cells[a] - 1, floor((x - h) / size)));
      to[a] = (int)fmax(0, fmin(cells[a] - 1, floor((x + h) / size)));
    }
    for (int z = from[2]; z <= to[2]; ++z)
    {
      for (int y = from[1]; y <= to[1]; ++y)
      {
        for (int x = from[0]; x <= to[0]; ++x)
        {
          marks[x + cells[0] * (y + (int64_t)cells[1] * z)] = 1;
        }
      }
    }
  }
}

static bool mcor_fills_bounds(
  const mcor_input* input, const mcor_ranks* ranks, const mcor_filling* of)
{
  double longest = 0, filled = 1;
  int axes = 0, cells[3], all = 1;
  for (int a = 0; a < 3; ++a)
  {
    const double side = -of->least[5 + a] - of->least[a];
    longest = fmax(longest, side);
    filled *= side > 0 ? side : 1;
    axes += side > 0;
  }
  const double size = longest / MCOR_FILLING_CELLS;
  if (!(size > 0) || !isfinite(size))
  {
    return false;
  }
  for (int a = 0; a < 3; ++a)
  {
    cells[a] = (int)fmax(1, ceil((-of->least[5 + a] - of->least[a]) / size));
    all *= cells[a];
  }
  const bool is_known =
    !input->estimate_smoothing_length && mcor_is_given(&input->smoothing_length);
  const double spacing = pow(filled / (double)of->count, 1.0 / axes);
  int64_t* marks = calloc((size_t)all, sizeof *marks);
  int64_t reached = 0;
  if (marks)
  {
    mcor_mark_filling(input, of, is_known ? 0 : spacing, size, cells, marks);
    if (ranks && ranks->reduce_counts(ranks->user, MCOR_GREATEST, marks, all))
    {
      all = INT32_MAX; /* another rank failed */
    }
    for (int i = 0; i < all && all < INT32_MAX; ++i)
    {
      reached += marks[i];
    }
  }
  free(marks);
  return (double)reached >= MCOR_FILLING_SHARE * all;
}

int mcor_has_free_surface(const mcor_input* input, const mcor_ranks* ranks)
{
  mcor_filling found = mcor_measure_filling(input);
  int64_t counts[2] = { found.count, found.solids };
  if (ranks &&
    (ranks->reduce_counts(ranks->user, MCOR_SUM_OF, counts, 2) ||
      ranks->reduce_doubles(ranks->user, MCOR_LEAST, found.least, 10)))
  {
    return 1; /* another rank failed */
  }
  found.count = counts[0];
  const double h = found.least[3], rho = found.least[4];
  const bool is_liquid =
    rho > 0 && -found.least[9] <= MCOR_LIQUID_RANGE * rho && -found.least[8] == h;
  return counts[1] > 0 || found.count == 0 || is_liquid || !mcor_fills_bounds(input, ranks, &found);
}
