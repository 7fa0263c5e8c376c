/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef particle_sets_h
#define particle_sets_h

/* Particle sets from formulas, for tests. The same name always gives the same particles. */

#include "mcor.h"
#include "oracle.h"

/* A block of a lattice, moved at random by `jitter`. Its cells have the edge `spacing`; their centres lie within size /
 * 2 of `center` along each axis. */
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
  void (*change)(particle_set* set); /* called last; may be NULL */
} particle_set_entry;

const particle_set_entry* particle_set_find(const char* name);
particle_set particle_set_of(const particle_set_entry* entry);

/* Returns random particles: lattice blocks, some moved at random or with holes, with equal or different smoothing
 * lengths, some solid, at times two in one place. Scalars are smooth, random, of three values, or have outliers. */
particle_set particle_set_random(uint64_t seed);

/* Return particles whose largest and smallest smoothing length have this ratio. drops: five drops that touch. medium:
 * fluid that is finer nearer to the origin; scalar = 0 is a sphere that comes close to the origin. */
particle_set particle_set_drops(double ratio);
particle_set particle_set_medium(double ratio);
/* Returns a coarse and a fine block of fluid side by side, on a floor of solids whose smoothing length differs from
 * both. */
particle_set particle_set_basin(double ratio);

/* Return an array of doubles, or a set, as input of the core. The input keeps pointers to the same
 * data. */
mcor_array core_array(const double* data, int components);
mcor_input core_input(const particle_set* set);

/* A small fast generator (splitmix64), the same on every machine. */
uint64_t random_bits(uint64_t* state);
double random_unit(uint64_t* state); /* in [0, 1) */

#endif
