/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef particle_sets_h
#define particle_sets_h

/* Analytic particle sets for tests. The same name always gives the same particles. */

#include "mcor.h"
#include "oracle.h"

typedef struct particle_set_entry
{
  const char* name;
  const char* purpose;
  void (*make)(particle_set* set); /* adds to an empty one */
  double iso;                      /* of the scalar */
  mcor_field field;                /* the one that the set was made for */
} particle_set_entry;

/* All sets; the last entry has the name NULL. */
extern const particle_set_entry particle_sets[];
const particle_set_entry* particle_set_find(const char* name);

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
