/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Periodic boxes: a region of one period, which images of the particles reach. See mcor_box.c. */

#include "mcor_box.h"

#include <math.h>

/* How far a period may be from a whole number of cubes, as a factor of it. */
#define MCOR_PERIOD_ERROR 1e-9

/* Adaptive cubes may become smaller by this factor to have all their levels. */
#define MCOR_FINER_CUBES 1.3

/* Supports beyond so many periods would take too many images. */
#define MCOR_MOST_PERIODS 2

/* Whether all periods are whole numbers of `unit` cubes where that along `axis` is `count` cubes. */
static bool mcor_periods_fit(const double length[3], int axis, int64_t count, int64_t unit)
{
  bool fit = true;
  for (int a = 0; a < 3; ++a)
  {
    const double units = length[a] * (double)count / length[axis] / (double)unit;
    fit = fit && fabs(units - round(units)) <= MCOR_PERIOD_ERROR * units;
  }
  return fit;
}

/* The fewest cubes along `axis`, from `least` up to `most`, that let all periods fit; 0: there are
 * none. */
static int64_t mcor_count_cubes(
  const double length[3], int axis, int64_t least, int64_t most, int64_t unit)
{
  for (int64_t count = (least + unit - 1) / unit * unit; count <= most; count += unit)
  {
    if (mcor_periods_fit(length, axis, count, unit))
    {
      return count;
    }
  }
  return 0;
}

/* Adaptive cubes: a period is a whole number of bricks of the level above the highest one, so that levels
 * repeat with it. Where cubes would become too small for that, there are fewer levels. */
static int64_t mcor_count_adaptive_cubes(const double length[3], int axis, int64_t least, int* top)
{
  int64_t count = 0;
  for (++*top; count == 0 && *top > 0;)
  {
    --*top;
    count = *top > 0
      ? mcor_count_cubes(length, axis, least, (int64_t)(MCOR_FINER_CUBES * (double)least),
          (int64_t)MCOR_BRICK << (*top + 1))
      : 0;
  }
  return count;
}

/* Images that lie farther away than this from the period are not needed, L. */
static double mcor_image_reach(
  const mcor_context* context, const mcor_options* options, double cube)
{
  return context->measure.support_max * (2 + 1 / options->h_scale) + 8 * cube;
}

/* May lower lattice.top. */
mcor_status mcor_fit_period(mcor_context* context, const mcor_options* options, double* cube)
{
  mcor_measure* m = &context->measure;
  mcor_lattice* lattice = &context->lattice;
  const double asked = *cube;
  double length[3];
  int axis = -1;
  for (int a = 2; a >= 0; --a)
  {
    length[a] = options->periodic[2 * a + 1] - options->periodic[2 * a];
    lattice->period[a] = 0;
    axis = length[a] > 0 ? a : axis;
  }
  /* Large cubes stick out of periods and boxes: no flat side would be left to close. */
  lattice->top =
    options->capping && (axis >= 0 || options->capping == MCOR_CAP_BOX) ? 0 : lattice->top;
  if (axis < 0)
  {
    return MCOR_OK;
  }
  const double least = ceil(length[axis] / *cube * (1 - MCOR_PERIOD_ERROR));
  MCOR_RETURN_IF(!(least < MCOR_LATTICE_LIMIT), context, MCOR_OUT_OF_CAPACITY,
    "With cube size %g there would be %.3g cubes in the period along %c; the limit is %d. Use a "
    "larger cube size, or a shorter period.",
    *cube, least, 'x' + axis, MCOR_LATTICE_LIMIT);
  const int64_t fewest = (int64_t)least;
  int64_t count = mcor_count_adaptive_cubes(length, axis, fewest, &lattice->top);
  count = count == 0 ? mcor_count_cubes(length, axis, fewest, 2 * fewest + 7, 1) : count;
  MCOR_RETURN_IF(count == 0, context, MCOR_INVALID_ARGUMENT,
    "The periods %g, %g and %g (0: not periodic) are not whole multiples of any cube size near %g. "
    "Use another cube size, or give the periods with all their digits.",
    length[0], length[1], length[2], *cube);
  *cube = length[axis] / (double)count;
  const double reach = mcor_image_reach(context, options, *cube);
  const double margin = lattice->top > 0 ? ldexp(8 * *cube, lattice->top) : 0;
  for (int a = 0; a < 3; ++a)
  {
    if (length[a] > 0)
    {
      const double most = MCOR_MOST_PERIODS * length[a];
      MCOR_RETURN_IF(reach - 8 * *cube > most, context, MCOR_INVALID_ARGUMENT,
        "The period along %c is %g, too short for support radii of up to %g.", 'x' + a, length[a],
        m->support_max);
      MCOR_RETURN_IF(reach > most, context, MCOR_INVALID_ARGUMENT,
        "The cube size %g is too large for the period %g along %c. Use a cube size of no more than "
        "%.3g.",
        asked, length[a], 'x' + a, (most - (reach - 8 * *cube)) / 8);
      MCOR_TRY(mcor_check_digits(context, m->low[a], m->high[a], *cube));
      lattice->period[a] = (int)round(length[a] / *cube);
      m->low[a] = options->periodic[2 * a] - reach - margin - m->support_max;
      m->high[a] = options->periodic[2 * a + 1] + reach + margin + m->support_max;
    }
  }
  return MCOR_OK;
}
