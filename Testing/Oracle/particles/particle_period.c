/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "particle_period.h"
#include "particle_sets.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

/* One of a unit volume at X, on average, is taken to x = X + AMOUNT L / (2 pi) sin(2 pi X / L) along
 * each axis: so the density at x is the product of 1 / (1 + AMOUNT cos(2 pi X / L)). */
#define AMOUNT 0.35

const double particle_period_lengths[3] = { 12.0, 10.0, 10.0 };

static double stretch(double from, double length)
{
  return 1.0 + AMOUNT * cos(2.0 * PI * from / length);
}

static double move(double from, double length)
{
  return from + AMOUNT * length / (2.0 * PI) * sin(2.0 * PI * from / length);
}

/* A position that shifts by multiples of 1/2 leave exact. */
static double on_grid(double x)
{
  return floor(x * 0x1p16) * 0x1p-16;
}

particle_set particle_period_make(uint64_t seed)
{
  const int64_t n[3] = { (int64_t)particle_period_lengths[0], (int64_t)particle_period_lengths[1],
    (int64_t)particle_period_lengths[2] };
  particle_set p = particle_set_make(n[0] * n[1] * n[2]);
  for (int64_t i = 0; i < p.count; ++i)
  {
    const int64_t at[3] = { i % n[0], i / n[0] % n[1], i / n[0] / n[1] };
    p.volume[i] = 1.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double jitter = 0.25 * (2.0 * random_unit(&seed) - 1.0);
      const double from = (double)at[axis] + 0.5 + jitter;
      p.position[3 * i + axis] = on_grid(move(from, particle_period_lengths[axis]));
      p.volume[i] *= stretch(from, particle_period_lengths[axis]);
    }
    p.scalar[i] = 1.0 / p.volume[i];
    p.smoothing_length[i] = 1.25 * cbrt(p.volume[i]);
  }
  return p;
}

void particle_period_set(mcor_options* options, const char* open)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    options->periodic[2 * axis] = 0.0;
    options->periodic[2 * axis + 1] =
      strchr(open, 'x' + axis) ? 0.0 : particle_period_lengths[axis];
  }
}

void particle_period_stretch(particle_set* particles, mcor_options* options)
{
  static const double factors[3] = { 1.0, 1.0331, 1.0713 };
  for (int64_t i = 0; i < 3 * particles->count; ++i)
  {
    particles->position[i] *= factors[i % 3];
  }
  for (int side = 0; side < 6; ++side)
  {
    options->periodic[side] *= factors[side / 2];
  }
}
