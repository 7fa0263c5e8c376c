/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "particle_sets.h"

#include <math.h>
#include <string.h>

uint64_t random_bits(uint64_t* state)
{
  *state += 0x9E3779B97F4A7C15u;
  uint64_t z = *state;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

double random_unit(uint64_t* state)
{
  return (double)(random_bits(state) >> 11) * 0x1p-53;
}

static void set_fill(particle_set* set, const particle_block* block)
{
  int64_t n[3];
  uint64_t state = block->seed;
  for (int axis = 0; axis < 3; ++axis)
  {
    n[axis] = (int64_t)floor(block->size[axis] / block->spacing + 0.5);
    n[axis] = n[axis] > 0 ? n[axis] : 1;
  }
  for (int64_t c = 0; c < n[0] * n[1] * n[2]; ++c)
  {
    const int64_t at[3] = { c % n[0], c / n[0] % n[1], c / n[0] / n[1] };
    double x[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      const double jitter = block->jitter * (2.0 * random_unit(&state) - 1.0);
      x[axis] = block->center[axis] +
        ((double)at[axis] + 0.5 - 0.5 * (double)n[axis] + jitter) * block->spacing;
    }
    const double value = block->scalar ? block->scalar(x) : (random_bits(&state) & 1 ? 1.0 : -1.0);
    if (!block->inside || block->inside(x))
    {
      particle_set_add(set, x, block->ratio * block->spacing, pow(block->spacing, 3.0), value);
    }
  }
}

/* ---- shapes and scalars ---- */

static double radius(const double x[3])
{
  return sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

static int in_ball(const double x[3])
{
  return radius(x) < 1.0;
}

static double scalar_torus(const double x[3])
{
  const double ring = hypot(x[0], x[1]) - 0.6;
  return hypot(ring, x[2]);
}

static double scalar_gyroid(const double x[3])
{
  const double s = 5.0;
  return sin(s * x[0]) * cos(s * x[1]) + sin(s * x[1]) * cos(s * x[2]) +
    sin(s * x[2]) * cos(s * x[0]);
}

/* A scalar with saddles everywhere: most crossed cells have a face with four crossings. */
static double scalar_saddle(const double x[3])
{
  const double s = 14.0;
  return sin(s * x[0]) * sin(s * x[1]) * sin(s * x[2]) + 0.02 * x[0];
}

static double scalar_sheet(const double x[3])
{
  return fabs(x[2] + 0.1 * x[0]) < 0.05 ? 1.0 : 0.0;
}

static double scalar_one(const double x[3])
{
  (void)x;
  return 1.0;
}

static double scalar_x(const double x[3])
{
  return x[0];
}

static double scalar_step(const double x[3])
{
  return x[0] < 0.0 ? 1.0 : 0.0;
}

static double scalar_wave(const double x[3])
{
  return sin(4.0 * x[0]) * cos(3.0 * x[1]) + 2.0 * x[2];
}

static int in_drops(const double x[3])
{
  const double a[3] = { x[0] - 0.5, x[1], x[2] };
  const double b[3] = { x[0] + 0.5, x[1] + 0.05, x[2] };
  return radius(a) < 0.5 || radius(b) < 0.5;
}

static int in_puddle(const double x[3])
{
  return x[2] > 0.0 && x[2] < 0.18 + 0.08 * sin(5.0 * x[0]) * cos(4.0 * x[1]);
}

/* ---- the sets ---- */

/* Changes the set: adds single particles, heavy enough for their own surfaces, that reach no other
 * particle; two pairs; and single high values within the fluid. */
static void add_blobs(particle_set* set)
{
  const double lone[7][3] = { { 2.0, 0.1, 0.2 }, { 2.03, 1.07, -0.3 }, { 2.5, 2.5, 2.5 },
    { 2.6, 2.5, 2.5 }, { -2.0, 0.0, 0.0 }, { -2.0, 0.15, 0.0 }, { 0.01, 0.02, -3.0 } };
  for (int64_t j = 0; j < set->count; ++j)
  {
    set->scalar[j] = j % 97 == 5 ? 1.0 : 0.0;
  }
  for (int n = 0; n < 7; ++n)
  {
    particle_set_add(set, lone[n], 0.125, 4.0 * pow(0.125, 3.0), n % 2 ? 1.0 : 0.4);
  }
}

/* Adds solids to a shallow puddle with a wavy surface: a floor below it and one wall beside it. */
static void add_walls(particle_set* set)
{
  const particle_block floor_block = { { 1.8, 1.4, 0.12 }, { 0.0, 0.0, -0.06 }, 0.06, 1.3, 0.0, 6,
    NULL, scalar_wave };
  const particle_block wall = { { 0.12, 1.4, 0.4 }, { -0.86, 0.0, 0.2 }, 0.06, 1.3, 0.0, 7, NULL,
    scalar_wave };
  const int64_t fluid = set->count;
  set_fill(set, &floor_block);
  set_fill(set, &wall);
  for (int64_t j = fluid; j < set->count; ++j)
  {
    set->solid[j] = 1;
    set->scalar[j] = 1000.0; /* a solid's scalar must not show in any value or range */
  }
  set->has_solids = 1;
}

/* Adds particles in cells. A cell is divided into eight as long as it is too large for its distance
 * from the origin. */
static void set_refine(
  particle_set* set, const double center[3], double size, double finest, uint64_t* state)
{
  const double r = radius(center);
  const double wanted = fmin(0.25, fmax(finest, 0.18 * r));
  if (size > wanted)
  {
    for (int c = 0; c < 8; ++c)
    {
      const double child[3] = { center[0] + (c & 1 ? 0.25 : -0.25) * size,
        center[1] + (c & 2 ? 0.25 : -0.25) * size, center[2] + (c & 4 ? 0.25 : -0.25) * size };
      set_refine(set, child, 0.5 * size, finest, state);
    }
    return;
  }
  double x[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    x[axis] = center[axis] + 0.2 * size * (2.0 * random_unit(state) - 1.0);
  }
  /* The scalar is log r, disturbed so that surfaces have some shape at every scale. */
  const double scalar = log(radius(x) + 1e-3) + 0.3 * sin(9.0 * atan2(x[1], x[0]));
  particle_set_add(set, x, 1.4 * size, size * size * size, scalar);
}

static void add_one(particle_set* set)
{
  const double x[3] = { 0.3, 0.2, 0.1 };
  particle_set_add(set, x, 0.1, 4.0 * pow(0.1, 3.0), 1.0);
}

#define BALL(scalar)                                                                               \
  {                                                                                                \
    {                                                                                              \
      { 2.0, 2.0, 2.0 }, { 0.0 }, 0.11, 1.3, 0.2, 1, in_ball, scalar                               \
    }                                                                                              \
  }
#define IN_BOX(spacing, jitter, scalar)                                                            \
  {                                                                                                \
    { 1.2, 1.3, 1.1 }, { 0.013, -0.021, 0.007 }, spacing, 1.25, jitter, 2, NULL, scalar            \
  }
#define IN_CUBE(size, spacing, ratio, jitter, seed, scalar)                                        \
  {                                                                                                \
    { size, size, size }, { 0.0 }, spacing, ratio, jitter, seed, NULL, scalar                      \
  }

static const particle_set_entry particle_sets[] = {
  /* a closed surface far from the free surface */
  { "sphere", 0.6, .blocks = BALL(radius) },
  /* genus 1 */
  { "torus", 0.2, .blocks = BALL(scalar_torus) },
  /* curved everywhere, cut by the free surface */
  { "gyroid", 0.1, .blocks = { IN_BOX(0.1, 0.25, scalar_gyroid) } },
  /* many ambiguous faces */
  { "saddle", 0.0, .blocks = { IN_BOX(0.1, 0.1, scalar_saddle) } },
  /* values without any smoothness */
  { "noise", 0.1, .blocks = { IN_BOX(0.12, 0.4, NULL) } },
  /* a sheet of high values one particle thick inside fluid, and a sheet of particles on its own */
  { "sheets", 0.3,
    .blocks = { IN_BOX(0.1, 0.1, scalar_sheet),
      { { 1.0, 1.0, 0.09 }, { 0.0, 0.0, 1.1 }, 0.1, 1.3, 0.05, 3, NULL, scalar_one } } },
  /* surfaces around single particles */
  { "blobs", 0.15, MCOR_SUM, { IN_BOX(0.1, 0.2, scalar_one) }, .change = add_blobs },
  /* two touching drops */
  { "drops", 0.5, MCOR_WEIGHT_SUM,
    { { { 2.2, 1.2, 1.2 }, { 0.0 }, 0.08, 1.3, 0.15, 4, in_drops, scalar_one } }, .finest = 0.0 },
  /* a free surface on solid particles */
  { "puddle", 0.2,
    .blocks = { { { 1.6, 1.2, 0.4 }, { 0.0, 0.0, 0.2 }, 0.06, 1.3, 0.1, 5, in_puddle,
      scalar_wave } },
    .change = add_walls },
  /* smoothing lengths that differ by a factor from 4 to 1024; the surface is where they are small */
  { "variable_4", -1.0, .finest = 0.0625 },
  { "variable_16", -1.5, .finest = 0.015625 },
  { "variable_128", -1.0, .finest = 0.25 / 128.0 },
  { "variable_1024", -5.3, .finest = 0.25 / 1024.0 },
  /* The set is symmetric about x = 0. Its spacing is a power of 2, so A = x is 0 at nodes. */
  { "on_nodes", 0.0, .blocks = { IN_CUBE(1.5, 0.125, 1.0, 0.0, 9, scalar_x) } },
  /* values that are exactly the iso value over a whole region */
  { "plateau", 1.0, .blocks = { IN_CUBE(1.0, 0.1, 1.3, 0.2, 10, scalar_step) } },
  { "single", 0.5, MCOR_WEIGHT_SUM, .change = add_one },
  /* every particle twice, at the same place */
  { "coincident", 0.1,
    .blocks = { IN_CUBE(1.0, 0.1, 1.3, 0.2, 11, scalar_wave),
      IN_CUBE(1.0, 0.1, 1.3, 0.2, 11, scalar_wave) } },
};

const particle_set_entry* particle_set_find(const char* name)
{
  for (size_t n = 0; n < sizeof(particle_sets) / sizeof(particle_sets[0]); ++n)
  {
    if (strcmp(particle_sets[n].name, name) == 0)
    {
      return &particle_sets[n];
    }
  }
  return NULL;
}

particle_set particle_set_of(const particle_set_entry* entry)
{
  const double center[3] = { 0.0, 0.0, 0.0 };
  uint64_t state = 8;
  particle_set set = { 0 };
  for (int b = 0; b < 2 && entry->blocks[b].spacing > 0.0; ++b)
  {
    set_fill(&set, &entry->blocks[b]);
  }
  if (entry->finest > 0.0)
  {
    set_refine(&set, center, 2.0, entry->finest, &state);
  }
  if (entry->change)
  {
    entry->change(&set);
  }
  return set;
}

mcor_array core_array(const double* data, int components)
{
  return (mcor_array){ .data = data, .type = MCOR_FLOAT64, .components = components };
}

mcor_input core_input(const particle_set* set)
{
  return (mcor_input){ .count = set->count,
    .positions = core_array(set->position, 3),
    .smoothing_length = core_array(set->smoothing_length, 1),
    .volume = core_array(set->volume, 1),
    .scalar = core_array(set->scalar, 1),
    .solid = set->has_solids ? set->solid : NULL };
}
