/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Periodic boxes: one period, which images of the particles reach. See mcor_box.c. */

#include "mcor_box.h"
#include "mcor_plane.h"
#include "mcor_stage.h"

#include <float.h>
#include <math.h>

/* By which share a period may miss a whole number of cubes. */
#define MCOR_PERIOD_ERROR 1e-9

/* How many numbers of units of an edge are tried. */
#define MCOR_STEP_TRIES (1 << 17)

/* Adaptive cubes may shrink by this factor to keep all their levels. */
#define MCOR_FINER_CUBES 1.3

#define MCOR_FARTHEST 1e15 /* in cubes from the origin: nodes are whole numbers */

/* The longest support, in periods; longer ones would take too many images. */
#define MCOR_MOST_PERIODS 2

/* Finds the fewest cubes along `axis`, from `least` to `most`, for which all periods are whole
 * numbers of `unit` cubes; 0: none. */
static int64_t mcor_count_cubes(
  const double length[3], int axis, int64_t least, int64_t most, int64_t unit)
{
  for (int64_t count = (least + unit - 1) / unit * unit; count <= most; count += unit)
  {
    bool fit = true;
    for (int a = 0; a < 3; ++a)
    {
      const double units = length[a] * (double)count / length[axis] / (double)unit;
      fit = fit && fabs(units - round(units)) <= MCOR_PERIOD_ERROR * units;
    }
    if (fit)
    {
      return count;
    }
  }
  return 0;
}

/* Finds edges that divide the periods and are no longer than a cube, all equal if possible. */
static mcor_status mcor_fit_edges(
  mcor_context* context, const double length[3], int axis, double cube, double edge[3], int* top)
{
  int64_t fewest[3] = { 0 };
  for (int a = 0; a < 3; ++a)
  {
    const double least = ceil(length[a] / cube * (1 - MCOR_PERIOD_ERROR));
    MCOR_RETURN_IF(!(least < MCOR_LATTICE_LIMIT), context, MCOR_OUT_OF_CAPACITY,
      "With cube size %g there would be %.3g cubes in the period along %c; the limit is %d. Use a "
      "larger cube size, or a shorter period.",
      cube, least, mcor_axis_letter(context, a), MCOR_LATTICE_LIMIT);
    fewest[a] = (int64_t)least;
  }
  /* With adaptive cubes a period is a whole number of bricks of the level above the highest one, so
   * that levels repeat with it. Drops levels where cubes would have to shrink too much. */
  int levels = *top;
  int64_t count = 0;
  for (; count == 0 && *top > 0; *top -= count == 0)
  {
    count = mcor_count_cubes(length, axis, fewest[axis],
      (int64_t)(MCOR_FINER_CUBES * (double)fewest[axis]), (int64_t)MCOR_BRICK << (*top + 1));
  }
  count =
    count == 0 ? mcor_count_cubes(length, axis, fewest[axis], 2 * fewest[axis] + 7, 1) : count;
  if (count > 0)
  {
    edge[0] = edge[1] = edge[2] = length[axis] / (double)count;
    return MCOR_OK;
  }
  /* Where no cube divides all periods, each has cells of its own: as few as are no longer than the
   * cube along any axis, and whole bricks as above. */
  for (bool fits = false; !fits; levels -= !fits)
  {
    const int64_t unit = levels > 0 ? (int64_t)MCOR_BRICK << (levels + 1) : 1;
    fits = true;
    for (int a = 0; a < 3; ++a)
    {
      const int64_t cells = (fewest[a] + unit - 1) / unit * unit;
      edge[a] = length[a] > 0 ? length[a] / (double)cells : 0;
      fits = fits && (levels == 0 || (double)cells <= MCOR_FINER_CUBES * (double)fewest[a]);
    }
  }
  const double longest = fmax(edge[0], fmax(edge[1], edge[2]));
  for (int a = 0; a < 3; ++a)
  {
    edge[a] = length[a] > 0 ? edge[a] : longest;
  }
  *top = levels;
  return MCOR_OK;
}

mcor_status mcor_check_digits(mcor_context* context, double low, double high, double cube)
{
  const double farthest = fmax(fabs(low), fabs(high));
  MCOR_RETURN_IF(!(farthest / cube < MCOR_FARTHEST), context, MCOR_OUT_OF_CAPACITY,
    "Particles are about %g away from the origin, where a double cannot resolve cubes of size %g. "
    "Leave out those that are far away by a range of positions, or move all towards the origin.",
    farthest, cube);
  return MCOR_OK;
}

/* May lower *top, the highest level. */
mcor_status mcor_fit_period(
  mcor_context* context, const mcor_options* options, double cube, int* top)
{
  mcor_measure* m = &context->measure;
  mcor_lattice* lattice = &context->lattice;
  double length[3], *edge = lattice->edge;
  int axis = -1;
  for (int a = 2; a >= 0; --a)
  {
    length[a] = fmax(options->periodic[2 * a + 1] - options->periodic[2 * a], 0);
    edge[a] = cube;
    lattice->period[a] = 0;
    axis = length[a] > 0 ? a : axis;
  }
  /* Forces one size: large cubes would stick out of periods and boxes and leave no flat side to
   * close. Caps at walls consist of equal cubes. */
  const bool walls =
    options->field == MCOR_WEIGHT_SUM && mcor_asked_share(options) != 0 && m->solid_count > 0;
  *top = options->capping && (axis >= 0 || options->capping == MCOR_CAP_BOX || walls) ? 0 : *top;
  if (axis < 0)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_fit_edges(context, length, axis, cube, edge, top));
  const double longest = fmax(edge[0], fmax(edge[1], edge[2]));
  /* How far from the period an image may be and still be needed, L; see mcor_stage. */
  const double beyond = context->run.widest * (1 + 1 / options->h_scale);
  const double reach = m->support_max * (2 + 1 / options->h_scale + beyond) + 8 * longest;
  const double margin = *top > 0 ? ldexp(8 * longest, *top) : 0;
  for (int a = 0; a < 3; ++a)
  {
    if (length[a] > 0)
    {
      const double most = MCOR_MOST_PERIODS * length[a];
      MCOR_RETURN_IF(reach - 8 * longest > most, context, MCOR_INVALID_ARGUMENT,
        "The period along %c is %g, too short for support radii of up to %g. Correct the period, "
        "or the smoothing lengths.",
        mcor_axis_letter(context, a), length[a], m->support_max);
      MCOR_RETURN_IF(reach > most, context, MCOR_INVALID_ARGUMENT,
        "The cube size %g is too large for the period %g along %c. Use a cube size of no more than "
        "%.3g.",
        cube, length[a], mcor_axis_letter(context, a), (most - (reach - 8 * longest)) / 8);
      MCOR_TRY(mcor_check_digits(context, m->low[a], m->high[a], edge[a]));
      lattice->period[a] = (int)round(length[a] / edge[a]);
      m->low[a] = options->periodic[2 * a] - reach - margin - m->support_max;
      m->high[a] = options->periodic[2 * a + 1] + reach + margin + m->support_max;
    }
  }
  return MCOR_OK;
}

/* ---- Unequal edges ---- */

/* The least edge, in cubes: 15/16, rounded down a bit. */
#define MCOR_STEP_RANGE 16

/* Chooses the edges in fixed-point units. Particles keep their positions in units of the edge
 * along each axis, so for right distances the edges must be to each other as their numbers of
 * units are. Among the last 1 / MCOR_STEP_RANGE of numbers for the longest edge, takes the one
 * for which they are so best, to about 1e-8. */
void mcor_fit_steps(mcor_context* context, int64_t extent)
{
  mcor_lattice* lattice = &context->lattice;
  const double* edge = lattice->edge;
  const double longest = fmax(edge[0], fmax(edge[1], edge[2]));
  const bool equal = edge[0] == edge[1] && edge[1] == edge[2];
  /* The trailing zeros that an edge needs as a fixed-point number: nodes must be as round as the
   * particles with long supports, and whole numbers of units in a double. */
  int exponent;
  frexp((double)extent + 64, &exponent);
  const int exact = exponent + lattice->fix_bits - DBL_MANT_DIG;
  const int round_as =
    mcor_spared_bits(context, context->measure.support_max, longest, lattice->levels - 1);
  const int spared = equal ? 0 : exact > round_as ? exact : round_as;
  const int bits = lattice->fix_bits - spared > 1 ? lattice->fix_bits - spared : 1;
  const int64_t most = INT64_C(1) << bits, rest = most / MCOR_STEP_RANGE;
  const int64_t tries = equal ? 0 : rest < MCOR_STEP_TRIES ? rest : MCOR_STEP_TRIES;
  int64_t best = most;
  double least = INFINITY;
  for (int64_t count = most; count >= most - tries; --count)
  {
    double error = 0;
    for (int a = 0; a < 3; ++a)
    {
      const double steps = edge[a] / longest * (double)count;
      error = fmax(error, fabs(round(steps) / steps - 1));
    }
    best = error < least ? count : best;
    least = fmin(least, error);
  }
  for (int a = 0; a < 3; ++a)
  {
    lattice->step[a] = (int64_t)round(edge[a] / longest * (double)best)
      << (lattice->fix_bits - bits);
    context->measure.edge[a] = edge[a];
  }
  lattice->cube = longest * ((double)most / (double)best);
  context->measure.cube = lattice->cube;
}
