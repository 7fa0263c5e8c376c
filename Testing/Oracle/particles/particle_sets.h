/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef particle_sets_h
#define particle_sets_h

/* Analytic particle sets for tests. The same name always gives the same particles. */

#include "mcor.h"
#include "oracle.h"

/* A block of a jittered lattice: cells of the given spacing centred in [-size/2, size/2]. */
typedef struct particle_block
{
  double size[3];
  double center[3];
  double spacing;
  double ratio;  /* smoothing length / spacing */
  double jitter; /* in spacings, to either side */
  uint64_t seed;
  int (*inside)(const double x[3]);    /* NULL: everything */
  double (*scalar)(const double x[3]); /* NULL: random, either -1 or 1 */
} particle_block;

typedef struct particle_set_entry
{
  const char* name;
  double iso;       /* of the scalar */
  mcor_field field; /* the one that the set was made for */
  particle_block blocks[2];
  double finest;                     /* above 0: cells from this size to 1/4 */
  void (*change)(particle_set* set); /* NULL, or what goes on from there */
} particle_set_entry;

const particle_set_entry* particle_set_find(const char* name);
particle_set particle_set_of(const particle_set_entry* entry);

/* Particles without any plan: blocks and clouds, with or without jitter, equal or very different
 * smoothing lengths, some solid, some at one place; scalars smooth, random or of few values. */
particle_set particle_set_random(uint64_t seed);

/* Five drops that touch, and a medium that is the finer the nearer to the origin, with the sphere
 * scalar = 0 from there to far away; smoothing lengths differ by the ratio. */
particle_set particle_set_drops(double ratio);
particle_set particle_set_medium(double ratio);
/* A coarse and a fine block of fluid, side by side on a floor of solids of a smoothing length of its own. */
particle_set particle_set_basin(double ratio);

/* Arrays of doubles and sets as input of the core; borrowed. */
mcor_array core_array(const double* data, int components);
mcor_input core_input(const particle_set* set);

/* A small fast generator (splitmix64), the same on every machine. */
uint64_t random_bits(uint64_t* state);
double random_unit(uint64_t* state); /* in [0, 1) */

#endif
