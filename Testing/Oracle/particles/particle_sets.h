/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef particle_sets_h
#define particle_sets_h

/* Analytic particle sets for tests. The same name always gives the same particles. */

#include "mcor.h"

#include <stdint.h>

typedef struct particle_set
{
  int64_t count, capacity;
  double* position;         /* [count][3] */
  double* smoothing_length; /* [count] */
  double* volume;           /* [count] */
  double* scalar;           /* [count] */
  uint8_t* solid;           /* [count] */
  int has_solids;
} particle_set;

typedef struct particle_set_entry
{
  const char* name;
  const char* purpose;
  int (*make)(particle_set* set); /* 0 if memory ran out */
  double iso;                     /* of the scalar */
  mcor_field field;               /* the one that the set was made for */
} particle_set_entry;

/* All sets; the last entry has the name NULL. */
extern const particle_set_entry particle_sets[];
const particle_set_entry* particle_set_find(const char* name);

/* A borrowed array of doubles; a constant where data is NULL. */
mcor_array particle_array(const double* data, int components, double constant);

/* Particles without any plan: blocks and clouds, with or without jitter, equal or very different
 * smoothing lengths, some solid, some at one place; scalars smooth, random or of few values. 0 if
 * memory ran out. */
int particle_set_random(particle_set* set, uint64_t seed);

/* Five drops that touch, and a medium that is the finer the nearer to the origin, with the sphere
 * scalar = 0 from there to far away; smoothing lengths differ by the ratio. 0 if memory ran out. */
int particle_set_drops(particle_set* set, double ratio);
int particle_set_medium(particle_set* set, double ratio);
/* A coarse and a fine block of fluid, side by side on a floor of solids of a smoothing length of its own. 0 if
 * memory ran out. */
int particle_set_basin(particle_set* set, double ratio);

void particle_set_free(particle_set* set);

/* The set as input of mcor_extract; borrowed from the set. */
mcor_input particle_set_input(const particle_set* set);

/* x -> scale * x + offset, with lengths and volumes. */
void particle_set_transform(particle_set* set, double scale, const double offset[3]);

/* A small fast generator (splitmix64), the same on every machine. */
uint64_t random_bits(uint64_t* state);
double random_unit(uint64_t* state); /* in [0, 1) */

#endif
