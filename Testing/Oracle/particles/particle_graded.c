/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Sets whose smoothing lengths differ by a large ratio. */

#include "particle_sets.h"

#include <math.h>

static double length_of(const double x[3])
{
  return sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

/* Adds a ball of particles that are moved at random from a lattice. */
static void graded_drop(particle_set* set, const double centre[3], double radius, uint64_t* state)
{
  const int64_t n = 10;
  const double spacing = 2.0 * radius / (double)n;
  for (int64_t c = 0; c < n * n * n; ++c)
  {
    const int64_t at[3] = { c % n, c / n % n, c / n / n };
    double x[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      const double jitter = 0.3 * (random_unit(state) - 0.5);
      x[axis] = ((double)at[axis] + 0.5 + jitter) * spacing - radius;
    }
    if (length_of(x) < radius)
    {
      const double scalar = x[0] / radius + 0.5 * sin(4.0 * x[1] / radius);
      for (int axis = 0; axis < 3; ++axis)
      {
        x[axis] += centre[axis];
      }
      particle_set_add(set, x, 1.2 * spacing, pow(spacing, 3.0), scalar);
    }
  }
}

particle_set particle_set_drops(double ratio)
{
  particle_set set = { 0 };
  uint64_t state = 11;
  double centre[3] = { 0.0, 0.0, 0.0 };
  const int drops = 5;
  for (int drop = 0; drop < drops; ++drop)
  {
    /* Each drop lies beside a larger one, made before it. Their weights overlap. */
    const double radius = pow(ratio, -(double)drop / (drops - 1));
    const double before = drop > 0 ? pow(ratio, -(double)(drop - 1) / (drops - 1)) : 0.0;
    const double turn = 0.7 * drop;
    const double away = drop > 0 ? before + 1.15 * radius : 0.0;
    centre[0] += away * cos(turn);
    centre[1] += away * sin(turn);
    centre[2] += 0.05 * away;
    graded_drop(&set, centre, radius, &state);
  }
  return set;
}

particle_set particle_set_medium(double ratio)
{
  particle_set set = { 0 };
  const double fineness = 0.3; /* spacing / distance from the origin */
  const double least = 1.0 / ratio;
  uint64_t state = 12;
  /* Adds blocks around the origin; each one leaves out the block before it. */
  for (double size = least; size < 1.6; size *= 2.0)
  {
    const int64_t n = 2 * (int64_t)ceil(1.0 / fineness);
    const double spacing = 2.0 * size / (double)n;
    for (int64_t c = 0; c < n * n * n; ++c)
    {
      const int64_t at[3] = { c % n, c / n % n, c / n / n };
      double x[3];
      double largest = 0.0;
      for (int axis = 0; axis < 3; ++axis)
      {
        x[axis] = ((double)at[axis] + 0.5) * spacing - size;
        largest = fmax(largest, fabs(x[axis]));
        x[axis] += 0.3 * (random_unit(&state) - 0.5) * spacing;
      }
      if (largest > 0.5 * size || size == least)
      {
        /* The scalar is the distance from a sphere that comes close to the origin, relative to the
         * distance from the origin. */
        const double r = length_of(x);
        const double from[3] = { x[0] - 0.7 - 0.5 * least, x[1], x[2] };
        const double scalar = (length_of(from) - 0.7) / (r + least);
        particle_set_add(&set, x, 1.3 * fineness * fmax(r, 0.7 * least), pow(spacing, 3.0), scalar);
      }
    }
  }
  return set;
}

/* Adds a lattice of particles in a box; fluid particles are moved at random. The number of
 * particles along each axis is rounded. */
static void graded_block(particle_set* set, const double low[3], const double high[3],
  double spacing, int solid, uint64_t* state)
{
  int64_t n[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    n[axis] = (int64_t)floor((high[axis] - low[axis]) / spacing + 0.5);
  }
  for (int64_t c = 0; c < n[0] * n[1] * n[2]; ++c)
  {
    const int64_t at[3] = { c % n[0], c / n[0] % n[1], c / n[0] / n[1] };
    double x[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      const double jitter = solid ? 0.0 : 0.2 * (random_unit(state) - 0.5);
      x[axis] = low[axis] + ((double)at[axis] + 0.5 + jitter) * spacing;
    }
    const double scalar = x[0] - 0.1 + 0.4 * sin(3.0 * x[1]) + 0.3 * cos(4.0 * x[2]);
    particle_set_add(set, x, 1.3 * spacing, pow(spacing, 3.0), scalar);
    set->solid[set->count - 1] = (uint8_t)solid;
  }
}

particle_set particle_set_basin(double ratio)
{
  particle_set set = { 0 };
  const double coarse = 0.25, fine = coarse / ratio, floor_spacing = 0.1;
  const double low[3] = { -1.0, -0.6, 0.0 }, high[3] = { 0.0, 0.6, 0.8 };
  const double fine_low[3] = { 0.0, -0.6, 0.0 }, fine_high[3] = { 0.6, 0.6, 0.6 };
  const double floor_low[3] = { -1.4, -0.8, -0.3 }, floor_high[3] = { 0.9, 0.8, 0.0 };
  uint64_t state = 13;
  set.has_solids = 1;
  graded_block(&set, low, high, coarse, 0, &state);
  graded_block(&set, fine_low, fine_high, fine, 0, &state);
  graded_block(&set, floor_low, floor_high, floor_spacing, 1, &state);
  return set;
}
