/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Periodic boxes: a region of one period, which images of the particles reach. See mcor_box.c. */

#include "mcor_box.h"

#include <math.h>

/* How far a period may be from a whole number of cubes, as a factor of it. */
#define MCOR_PERIOD_ERROR 1e-9

/* Supports beyond so many periods would take too many images. */
#define MCOR_MOST_PERIODS 2

/* Whether all periods are whole numbers of cubes where that along `axis` is `count` of them. */
static bool mcor_periods_fit(const double length[3], int axis, int64_t count)
{
  bool fit = true;
  for (int a = 0; a < 3; ++a)
  {
    const double cubes = length[a] * (double)count / length[axis];
    fit = fit && fabs(cubes - round(cubes)) <= MCOR_PERIOD_ERROR * cubes;
  }
  return fit;
}

/* The fewest cubes along `axis`, from `least` on, that let all periods fit; 0: none less than twice as
 * many. */
static int64_t mcor_count_cubes(const double length[3], int axis, int64_t least)
{
  for (int64_t count = least; count < 2 * least + 8; ++count)
  {
    if (mcor_periods_fit(length, axis, count))
    {
      return count;
    }
  }
  return 0;
}

/* Images that lie farther away than this from the period are not needed, L. */
static double mcor_image_reach(
  const mcor_context* context, const mcor_options* options, double cube)
{
  return context->measure.support_max * (2 + 1 / options->h_scale) + 8 * cube;
}

mcor_status mcor_fit_period(mcor_context* context, const mcor_options* options, double* cube)
{
  mcor_measure* m = &context->measure;
  mcor_lattice* lattice = &context->lattice;
  double length[3];
  int axis = -1;
  for (int a = 2; a >= 0; --a)
  {
    length[a] = options->periodic[2 * a + 1] - options->periodic[2 * a];
    lattice->period[a] = 0;
    axis = length[a] > 0 ? a : axis;
  }
  if (axis < 0)
  {
    return MCOR_OK;
  }
  const double least = ceil(length[axis] / *cube * (1 - MCOR_PERIOD_ERROR));
  const int64_t count = least < 1e6 ? mcor_count_cubes(length, axis, (int64_t)least) : 0;
  MCOR_RETURN_IF(count == 0, context, MCOR_INVALID_ARGUMENT,
    "The periods %g, %g and %g (0: open) are not all whole numbers of a cube size near %g. Give "
    "another cube size, or periods to all their digits.",
    length[0], length[1], length[2], *cube);
  *cube = length[axis] / (double)count;
  const double reach = mcor_image_reach(context, options, *cube);
  for (int a = 0; a < 3; ++a)
  {
    if (length[a] > 0)
    {
      MCOR_RETURN_IF(reach > MCOR_MOST_PERIODS * length[a], context, MCOR_INVALID_ARGUMENT,
        "The period along %c is %g, too little for support radii of up to %g.", 'x' + a, length[a],
        m->support_max);
      lattice->period[a] = (int)round(length[a] / *cube);
      m->low[a] = options->periodic[2 * a] - reach - m->support_max;
      m->high[a] = options->periodic[2 * a + 1] + reach + m->support_max;
    }
  }
  return MCOR_OK;
}
