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

/* A block of a jittered lattice: cells of the given spacing centred in [-size/2, size/2]. */
typedef struct set_block
{
  double size[3];
  double center[3];
  double spacing;
  double ratio;  /* smoothing length / spacing */
  double jitter; /* in spacings, to either side */
  uint64_t seed;
  int (*inside)(const double x[3]);    /* NULL: everything */
  double (*scalar)(const double x[3]); /* NULL: random, either -1 or 1 */
} set_block;

static void set_fill(particle_set* set, const set_block* block)
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

/* Saddles everywhere: most crossed cells have a face with four crossings. */
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

static void fill_ball(particle_set* set, double (*scalar)(const double x[3]))
{
  const set_block block = { { 2.0, 2.0, 2.0 }, { 0.0, 0.0, 0.0 }, 0.11, 1.3, 0.2, 1, in_ball,
    scalar };
  set_fill(set, &block);
}

static void fill_box(
  particle_set* set, double spacing, double jitter, double (*scalar)(const double x[3]))
{
  const set_block block = { { 1.2, 1.3, 1.1 }, { 0.013, -0.021, 0.007 }, spacing, 1.25, jitter, 2,
    NULL, scalar };
  set_fill(set, &block);
}

static void make_sphere(particle_set* set)
{
  fill_ball(set, radius);
}

static void make_torus(particle_set* set)
{
  fill_ball(set, scalar_torus);
}

static void make_gyroid(particle_set* set)
{
  fill_box(set, 0.1, 0.25, scalar_gyroid);
}

static void make_saddle(particle_set* set)
{
  fill_box(set, 0.1, 0.1, scalar_saddle);
}

static void make_noise(particle_set* set)
{
  fill_box(set, 0.12, 0.4, NULL);
}

/* A sheet of high values one particle thick inside fluid, and a sheet of particles on its own. */
static void make_sheets(particle_set* set)
{
  const set_block alone = { { 1.0, 1.0, 0.09 }, { 0.0, 0.0, 1.1 }, 0.1, 1.3, 0.05, 3, NULL,
    scalar_one };
  fill_box(set, 0.1, 0.1, scalar_sheet);
  set_fill(set, &alone);
}

/* Single particles with nothing in reach, heavy enough for a surface of their own, two pairs, and
 * single high values within fluid. */
static void make_blobs(particle_set* set)
{
  const double lone[7][3] = { { 2.0, 0.1, 0.2 }, { 2.03, 1.07, -0.3 }, { 2.5, 2.5, 2.5 },
    { 2.6, 2.5, 2.5 }, { -2.0, 0.0, 0.0 }, { -2.0, 0.15, 0.0 }, { 0.01, 0.02, -3.0 } };
  fill_box(set, 0.1, 0.2, scalar_one);
  for (int64_t j = 0; j < set->count; ++j)
  {
    set->scalar[j] = j % 97 == 5 ? 1.0 : 0.0;
  }
  for (int n = 0; n < 7; ++n)
  {
    particle_set_add(set, lone[n], 0.125, 4.0 * pow(0.125, 3.0), n % 2 ? 1.0 : 0.4);
  }
}

static void make_drops(particle_set* set)
{
  const set_block block = { { 2.2, 1.2, 1.2 }, { 0.0, 0.0, 0.0 }, 0.08, 1.3, 0.15, 4, in_drops,
    scalar_one };
  set_fill(set, &block);
}

/* A shallow puddle with a wavy surface on a floor and against one wall of solid particles. */
static void make_puddle(particle_set* set)
{
  const set_block water = { { 1.6, 1.2, 0.4 }, { 0.0, 0.0, 0.2 }, 0.06, 1.3, 0.1, 5, in_puddle,
    scalar_wave };
  const set_block floor_block = { { 1.8, 1.4, 0.12 }, { 0.0, 0.0, -0.06 }, 0.06, 1.3, 0.0, 6, NULL,
    scalar_wave };
  const set_block wall = { { 0.12, 1.4, 0.4 }, { -0.86, 0.0, 0.2 }, 0.06, 1.3, 0.0, 7, NULL,
    scalar_wave };
  set_fill(set, &water);
  const int64_t fluid = set->count;
  set_fill(set, &floor_block);
  set_fill(set, &wall);
  for (int64_t j = fluid; j < set->count; ++j)
  {
    set->solid[j] = 1;
    set->scalar[j] = 1000.0; /* must not be seen in any value or range */
  }
  set->has_solids = 1;
}

/* Cells are halved until they are small enough for their distance from the centre. */
static void set_refine(particle_set* set, const double center[3], double size, double finest,
  double coarsest, uint64_t* state)
{
  const double r = radius(center);
  const double wanted = fmin(coarsest, fmax(finest, 0.18 * r));
  if (size > wanted)
  {
    for (int c = 0; c < 8; ++c)
    {
      const double child[3] = { center[0] + (c & 1 ? 0.25 : -0.25) * size,
        center[1] + (c & 2 ? 0.25 : -0.25) * size, center[2] + (c & 4 ? 0.25 : -0.25) * size };
      set_refine(set, child, 0.5 * size, finest, coarsest, state);
    }
    return;
  }
  double x[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    x[axis] = center[axis] + 0.2 * size * (2.0 * random_unit(state) - 1.0);
  }
  /* log r, disturbed so that the surface has some shape at every scale. */
  const double scalar = log(radius(x) + 1e-3) + 0.3 * sin(9.0 * atan2(x[1], x[0]));
  particle_set_add(set, x, 1.4 * size, size * size * size, scalar);
}

static void fill_graded(particle_set* set, double finest, double coarsest)
{
  const double center[3] = { 0.0, 0.0, 0.0 };
  uint64_t state = 8;
  set_refine(set, center, 2.0, finest, coarsest, &state);
}

static void make_variable_4(particle_set* set)
{
  fill_graded(set, 0.0625, 0.25);
}

static void make_variable_16(particle_set* set)
{
  fill_graded(set, 0.015625, 0.25);
}

static void make_variable_128(particle_set* set)
{
  fill_graded(set, 0.25 / 128.0, 0.25);
}

static void make_variable_1024(particle_set* set)
{
  fill_graded(set, 0.25 / 1024.0, 0.25);
}

/* Symmetric about x = 0 with A = x, spacing a power of 2: the surface A = 0 runs through nodes. */
static void make_on_nodes(particle_set* set)
{
  const set_block block = { { 1.5, 1.5, 1.5 }, { 0.0, 0.0, 0.0 }, 0.125, 1.0, 0.0, 9, NULL,
    scalar_x };
  set_fill(set, &block);
}

/* Values that are exactly the iso value over a whole region. */
static void make_plateau(particle_set* set)
{
  const set_block block = { { 1.0, 1.0, 1.0 }, { 0.0, 0.0, 0.0 }, 0.1, 1.3, 0.2, 10, NULL,
    scalar_step };
  set_fill(set, &block);
}

static void make_single(particle_set* set)
{
  const double x[3] = { 0.3, 0.2, 0.1 };
  particle_set_add(set, x, 0.1, 4.0 * pow(0.1, 3.0), 1.0);
}

/* Every particle twice, at the same place. */
static void make_coincident(particle_set* set)
{
  const set_block block = { { 1.0, 1.0, 1.0 }, { 0.0, 0.0, 0.0 }, 0.1, 1.3, 0.2, 11, NULL,
    scalar_wave };
  set_fill(set, &block);
  set_fill(set, &block);
}

const particle_set_entry particle_sets[] = {
  { "sphere", "a closed surface far from the free surface", make_sphere, 0.6, MCOR_SHEPARD },
  { "torus", "genus 1", make_torus, 0.2, MCOR_SHEPARD },
  { "gyroid", "curved everywhere, cut by the free surface", make_gyroid, 0.1, MCOR_SHEPARD },
  { "saddle", "many ambiguous faces", make_saddle, 0.0, MCOR_SHEPARD },
  { "noise", "values without any smoothness", make_noise, 0.1, MCOR_SHEPARD },
  { "sheets", "sheets one particle thick", make_sheets, 0.3, MCOR_SHEPARD },
  { "blobs", "surfaces around single particles", make_blobs, 0.15, MCOR_SUM },
  { "drops", "two touching drops", make_drops, 0.5, MCOR_WEIGHT_SUM },
  { "puddle", "a free surface on solid particles", make_puddle, 0.2, MCOR_SHEPARD },
  { "variable_4", "smoothing lengths 1:4", make_variable_4, -1.0, MCOR_SHEPARD },
  { "variable_16", "smoothing lengths 1:16", make_variable_16, -1.5, MCOR_SHEPARD },
  { "variable_128", "smoothing lengths 1:128", make_variable_128, -1.0, MCOR_SHEPARD },
  { "variable_1024", "smoothing lengths 1:1024, a surface where they are small", make_variable_1024,
    -5.3, MCOR_SHEPARD },
  { "on_nodes", "the surface runs through nodes", make_on_nodes, 0.0, MCOR_SHEPARD },
  { "plateau", "values equal to the iso value in a region", make_plateau, 1.0, MCOR_SHEPARD },
  { "single", "one particle", make_single, 0.5, MCOR_WEIGHT_SUM },
  { "coincident", "pairs of particles at one place", make_coincident, 0.1, MCOR_SHEPARD },
  { NULL, NULL, NULL, 0.0, MCOR_SHEPARD }
};

const particle_set_entry* particle_set_find(const char* name)
{
  for (const particle_set_entry* entry = particle_sets; entry->name; ++entry)
  {
    if (strcmp(entry->name, name) == 0)
    {
      return entry;
    }
  }
  return NULL;
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
