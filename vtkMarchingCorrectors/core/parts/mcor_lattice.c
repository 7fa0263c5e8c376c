/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The virtual grid [III-B]. If particles repeat with a period, the grid covers one period and,
 * around it, all that the needed periodic images of particles may reach, see mcor_box.c. */

#include "mcor_box.h"
#include "mcor_plane.h"
#include "mcor_stage.h"
#include "mcor_tree.h"

#include <float.h>
#include <math.h>

/* The least support radius, in cubes. With a smaller one, particles would reach hardly any node. */
#define MCOR_LEAST_SUPPORT 1e-3

/* Limits of the cube size, so that volumes, areas and gradients are finite numbers above 0. */
#define MCOR_LEAST_CUBE 1e-100
#define MCOR_MOST_CUBE 1e100

/* Greatest relative error of a period that counts as a whole number of cubes. */
#define MCOR_PERIOD_ERROR 1e-9

/* mcor_fit_steps tries at most this number of lengths (in fixed-point units) of the longest
 * edge. */
#define MCOR_STEP_TRIES (1 << 17)

/* Adaptive cubes may shrink by this factor to keep all their levels. */
#define MCOR_FINER_CUBES 1.3

#define MCOR_FARTHEST 1e15 /* in cubes from the origin; nodes are whole numbers up to here */

/* A particle may reach over at most this many periods; more would need too many images. */
#define MCOR_MOST_PERIODS 2

/* Returns the fewest cubes along `axis`, from `least` to `most`, for which all periods are whole
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

/* Finds edges that divide the periods and are at most `cube` long. If possible, all edges are
 * equal. axis: the first axis with a period. May lower *top, the highest level. */
static mcor_status mcor_fit_edges(
  mcor_context* context, const double length[3], int axis, double cube, double edge[3], int* top)
{
  int64_t fewest[3] = { 0 };
  for (int a = 0; a < 3; ++a)
  {
    const double least = ceil(length[a] / cube * (1 - MCOR_PERIOD_ERROR));
    MCOR_FAIL_IF(!(least < MCOR_LATTICE_LIMIT), context, MCOR_OUT_OF_CAPACITY,
      MCOR_SAY(PERIOD_TOO_LONG), cube, least, mcor_axis_letter(context, a), MCOR_LATTICE_LIMIT);
    fewest[a] = (int64_t)least;
  }
  /* With adaptive cubes, a period is a whole number of bricks of the level above the highest, so
   * that bricks repeat with the period. Leaves out levels for which cubes would have to shrink too
   * much. */
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
  /* If no cube divides all periods, each axis has its own edge: the longest that is at most a cube
   * and divides the period into whole cells or, as above, whole bricks. */
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

static mcor_status mcor_check_digits(mcor_context* context, double low, double high, double cube)
{
  const double farthest = fmax(fabs(low), fabs(high));
  MCOR_FAIL_IF(!(farthest / cube < MCOR_FARTHEST), context, MCOR_OUT_OF_CAPACITY,
    MCOR_SAY(PARTICLES_TOO_FAR), farthest, cube);
  return MCOR_OK;
}

/* Finds the edges of the cubes and, along each axis with a period, the period's length in cells and
 * the bounds (measure.low, high) that hold all needed images. May lower *top, the highest level. */
static mcor_status mcor_fit_period(
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
  /* Caps need cubes of one size: large cubes would stick out of periods and boxes, without a flat
   * side to close. */
  *top = options->capping && (axis >= 0 || options->capping == MCOR_CAP_BOX) ? 0 : *top;
  if (axis < 0)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_fit_edges(context, length, axis, cube, edge, top));
  const double longest = fmax(edge[0], fmax(edge[1], edge[2]));
  /* How far from the period, in unit L, an image of a particle may be needed, see mcor_stage. */
  const double reach = m->support_max +
    mcor_reach_around(options, true, context->run.widest, m->support_max, 0) + 8 * longest;
  const double margin = longest *
    (*top > 0 ? ldexp(mcor_box_slack(options) + 1.5, *top) : mcor_ring_of(options) - MCOR_BOX_RING);
  for (int a = 0; a < 3; ++a)
  {
    if (length[a] > 0)
    {
      const double most = MCOR_MOST_PERIODS * length[a];
      const double widest = context->run.widest,
                   fits = (most / m->support_max - 1) / (1 + 1 / options->h_scale) - 1;
      MCOR_FAIL_IF(reach - 8 * longest > most && widest > 0, context, MCOR_INVALID_ARGUMENT,
        MCOR_SAY(PERIOD_TOO_SHORT_WIDENED), mcor_axis_letter(context, a), length[a], m->support_max,
        widest * m->support_max,
        fits > 1 ? "Choose {widen} of no more than" : "Leave out {widen} of",
        fits > 1 ? fits : widest);
      MCOR_FAIL_IF(reach - 8 * longest > most, context, MCOR_INVALID_ARGUMENT,
        MCOR_SAY(PERIOD_TOO_SHORT), mcor_axis_letter(context, a), length[a], m->support_max);
      MCOR_FAIL_IF(reach > most, context, MCOR_INVALID_ARGUMENT,
        MCOR_SAY(CUBE_TOO_LARGE_FOR_PERIOD), cube, length[a], mcor_axis_letter(context, a),
        (most - (reach - 8 * longest)) / 8);
      MCOR_TRY(mcor_check_digits(context, m->low[a], m->high[a], edge[a]));
      lattice->period[a] = (int)round(length[a] / edge[a]);
      m->low[a] = options->periodic[2 * a] - reach - margin - m->support_max;
      m->high[a] = options->periodic[2 * a + 1] + reach + margin + m->support_max;
    }
  }
  return MCOR_OK;
}

/* ---- Unequal edges ---- */

/* If edges along x, y, z differ, the longest is at least 1 - 1 / MCOR_STEP_RANGE cubes long. */
#define MCOR_STEP_RANGE 16

/* Chooses how many fixed-point units long each edge is. A unit must have the same length along all
 * axes, so these whole numbers must have the ratios of the edges. For the longest edge, tries at
 * most MCOR_STEP_TRIES numbers: from n, the units of a cube, down to (1 - 1 / MCOR_STEP_RANGE) n.
 * Takes the number for which rounding changes the ratios least, by about 1e-8. */
static void mcor_fit_steps(mcor_context* context, int64_t extent)
{
  mcor_lattice* lattice = &context->lattice;
  const double* edge = lattice->edge;
  const double longest = fmax(edge[0], fmax(edge[1], edge[2]));
  const bool equal = edge[0] == edge[1] && edge[1] == edge[2];
  /* Unequal edges are rounded: in fixed-point units, the lowest `spared` bits of their lengths are
   * 0. These are as many bits as are 0 in positions of particles with the longest supports. They
   * are more if a double needs this to hold the coordinates of all nodes exactly. */
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

/* ---- The lattice ---- */

/* Whether keys have enough bits for all nodes and cells of the lattice that a surface may reach. */
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

mcor_status mcor_measure_lattice(mcor_context* context, const mcor_options* options)
{
  mcor_measure* m = &context->measure;
  mcor_lattice* lattice = &context->lattice;
  const double cube =
    options->cube_size > 0 ? options->cube_size : options->cube_size_factor * m->h_min;
  MCOR_FAIL_IF(!(cube > MCOR_LEAST_CUBE && cube < MCOR_MOST_CUBE), context, MCOR_OUT_OF_CAPACITY,
    MCOR_SAY(CUBE_ILLEGAL), cube, MCOR_LEAST_CUBE, MCOR_MOST_CUBE);
  MCOR_FAIL_IF(!(m->support_min > MCOR_LEAST_SUPPORT * cube), context, MCOR_OUT_OF_CAPACITY,
    MCOR_SAY(CUBE_TOO_LARGE), cube, 1 / MCOR_LEAST_SUPPORT, m->support_min);
  int top = mcor_tree_level_of(m->h_max, m->h_min, options->level_limit);
  MCOR_TRY(mcor_fit_period(context, options, cube, &top));
  while (top > 0 && !mcor_has_keys(m, lattice, top))
  {
    --top;
  }
  lattice->levels = top + 1;
  /* With adaptive cubes, the origin is a multiple of `unit`, the edge of a brick one level above
   * the highest. There is room for one such brick below the lowest node. */
  const int64_t unit = top > 0 ? (int64_t)MCOR_BRICK << (top + 1) : 0;
  int64_t extent = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double edge = lattice->edge[a];
    const double first = floor(m->low[a] / edge) - 1, last = ceil(m->high[a] / edge) + 1;
    const int limit = m->cut ? MCOR_CUT_LIMIT : MCOR_LATTICE_LIMIT;
    context->run.is_too_long = !(last - first <= limit);
    MCOR_FAIL_IF(context->run.is_too_long, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(GRID_TOO_LONG),
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
  MCOR_FAIL_IF(context->run.is_too_long, context, MCOR_OUT_OF_CAPACITY,
    MCOR_SAY(GRID_TOO_LONG_AT_ALL), cube, (double)extent);
  lattice->fix_bits = options->precision == MCOR_FLOAT64 ? 40 : 20;
  /* In single precision, adaptive cubes use one bit more, because their lattices are often long. */
  const int bits = options->precision == MCOR_FLOAT64 ? 62 : top > 0 ? 31 : 30;
  while ((extent + 64 + 2 * unit) << lattice->fix_bits >= INT64_C(1) << bits)
  {
    --lattice->fix_bits;
  }
  mcor_fit_steps(context, extent);
  return MCOR_OK;
}
