/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "particle_sets.h"

#include <math.h>
#include <string.h>

static int64_t random_below(uint64_t* state, int64_t n)
{
  return (int64_t)(random_bits(state) % (uint64_t)n);
}

static void random_scalar(particle_set* set, int64_t j, int sort, uint64_t* state)
{
  const double* x = &set->position[3 * j];
  switch (sort)
  {
    case 0:
      set->scalar[j] = sin(3.0 * x[0]) + cos(4.0 * x[1] + x[2]);
      break;
    case 1:
      set->scalar[j] = 2.0 * random_unit(state) - 1.0;
      break;
    case 2: /* a few values; iso values are among them */
      set->scalar[j] = (double)random_below(state, 3) - 1.0;
      break;
    default: /* outliers */
      set->scalar[j] = sin(5.0 * x[2]) + (random_below(state, 50) == 0 ? 1e4 : 0.0);
      break;
  }
}

/* Adds one block of particles: a lattice, in some sets moved at random or full of holes. */
static void random_block(particle_set* set, int64_t capacity, uint64_t* state)
{
  const double spacing = 0.05 + 0.15 * random_unit(state);
  const double jitter = random_below(state, 3) == 0 ? 0.0 : 0.5 * random_unit(state);
  const double keep = random_below(state, 2) == 0 ? 1.0 : random_unit(state);
  const double ratio = 0.8 + random_unit(state);
  const double spread = random_below(state, 2) == 0 ? 0.0 : 3.0 * random_unit(state);
  const int on_lattice = random_below(state, 4) == 0;
  double corner[3];
  int64_t n[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    corner[axis] = on_lattice ? 0.25 * (double)random_below(state, 8) : 2.0 * random_unit(state);
    n[axis] = 1 + random_below(state, 7);
  }
  for (int64_t c = 0; c < n[0] * n[1] * n[2] && set->count < capacity; ++c)
  {
    const int64_t at[3] = { c % n[0], c / n[0] % n[1], c / n[0] / n[1] };
    double x[3];
    if (random_unit(state) > keep)
    {
      continue;
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      x[axis] =
        corner[axis] + spacing * ((double)at[axis] + jitter * (2.0 * random_unit(state) - 1.0));
    }
    const double h = ratio * spacing * exp2(spread * random_unit(state));
    particle_set_add(set, x, h, pow(spacing, 3.0) * (0.5 + random_unit(state)), 0.0);
  }
}

particle_set particle_set_random(uint64_t seed)
{
  uint64_t state = seed;
  particle_set set = { 0 };
  const int64_t blocks = 1 + random_below(&state, 6);
  const int sort = (int)random_below(&state, 4);
  const int solids = random_below(&state, 3) == 0;
  for (int64_t b = 0; b < blocks; ++b)
  {
    const int64_t first = set.count;
    random_block(&set, 1500, &state);
    const int solid = solids && b > 0 && random_below(&state, 2) == 0;
    for (int64_t j = first; j < set.count; ++j)
    {
      random_scalar(&set, j, sort, &state);
      set.solid[j] = (uint8_t)solid;
      set.has_solids = set.has_solids || solid;
    }
  }
  if (set.count > 1 && random_below(&state, 5) == 0) /* two particles lie in one place */
  {
    memcpy(&set.position[3], set.position, 3 * sizeof(double));
  }
  return set;
}
