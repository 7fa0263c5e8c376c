/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compares periodic boxes with the oracle, which has all images as particles. */

#include "oracle_case.h"
#include "particle_sets.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PI 3.14159265358979323846

/* make_period moves evenly spaced X to x = X + AMOUNT L / (2 pi) sin(2 pi X / L) along each axis.
 * So the density at x is the product of 1 / (1 + AMOUNT cos(2 pi X / L)) over the axes. */
#define AMOUNT 0.35

static const double lengths[3] = { 12.0, 10.0, 10.0 };

static particle_set make_period(uint64_t seed)
{
  const int64_t n[3] = { (int64_t)lengths[0], (int64_t)lengths[1], (int64_t)lengths[2] };
  particle_set p = particle_set_make(n[0] * n[1] * n[2]);
  for (int64_t i = 0; i < p.count; ++i)
  {
    const int64_t at[3] = { i % n[0], i / n[0] % n[1], i / n[0] / n[1] };
    p.volume[i] = 1.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double jitter = 0.25 * (2.0 * random_unit(&seed) - 1.0);
      const double from = (double)at[axis] + 0.5 + jitter, turn = 2.0 * PI * from / lengths[axis];
      const double x = from + AMOUNT * lengths[axis] / (2.0 * PI) * sin(turn);
      /* Coordinates are rounded to multiples of 2^-16, so that a shift by one of `lengths` is exact. */
      p.position[3 * i + axis] = floor(x * 0x1p16) * 0x1p-16;
      p.volume[i] *= 1.0 + AMOUNT * cos(turn);
    }
    p.scalar[i] = 1.0 / p.volume[i];
    p.smoothing_length[i] = 1.25 * cbrt(p.volume[i]);
  }
  return p;
}

typedef struct period_case
{
  const char* name;
  mcor_sph_kernel kernel;
  mcor_field field;
  double iso, cube, h_scale;
  const char* open; /* axes that have no period */
  int volumes;      /* 0: computed */
  int precise;      /* double precision */
} period_case;

static const period_case cases[] = {
  { "cubic", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1.2, 0.7, 1.0, "", 1, 0 },
  { "cubic", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 0.8, 0.7, 1.0, "", 1, 1 },
  { "cubic-open", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1.0, 0.5, 1.0, "z", 1, 0 },
  { "cubic-open2", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1.2, 0.7, 1.0, "xz", 1, 0 },
  { "cubic-volumes", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1.2, 0.9, 0.75, "", 0, 0 },
  { "sum", MCOR_CUBIC_SPLINE, MCOR_SUM, 1.0, 0.7, 1.0, "y", 1, 0 },
  { "free", MCOR_CUBIC_SPLINE, MCOR_WEIGHT_SUM, 0.5, 0.7, 1.0, "z", 1, 0 },
  { "free-open2", MCOR_WENDLAND_C2, MCOR_WEIGHT_SUM, 0.4, 0.7, 1.0, "yz", 0, 1 },
  { "quadratic", MCOR_QUADRATIC, MCOR_SHEPARD, 1.2, 0.9, 1.0, "", 1, 0 },
  { "wendland", MCOR_WENDLAND_C2, MCOR_SHEPARD, 1.5, 0.7, 1.0, "x", 1, 0 },
  { "quintic", MCOR_QUINTIC_SPLINE, MCOR_SHEPARD, 1.0, 0.9, 0.75, "", 1, 0 },
  { "mprime4", MCOR_M_PRIME_4, MCOR_SHEPARD, 1.2, 0.9, 1.0, "y", 1, 1 },
  { "mprime4-volumes", MCOR_M_PRIME_4, MCOR_SHEPARD, 1.2, 0.9, 1.0, "", 0, 0 },
};

/* unequal: cubes have a different edge along each axis. */
static void run_case(oracle_suite* suite, const period_case* one, int unequal)
{
  static const double factors[3] = { 1.0, 1.0331, 1.0713 };
  particle_set particles = make_period(3);
  oracle_case at;
  double iso = one->iso;
  memset(&at, 0, sizeof(at));
  at.input = core_input(&particles);
  at.input.volume = one->volumes ? at.input.volume : (mcor_array){ 0 };
  at.options = oracle_case_options(&iso);
  at.options.sph_kernel = one->kernel;
  at.options.field = one->field;
  at.options.cube_size_factor = one->cube;
  at.options.h_scale = one->h_scale;
  at.options.precision = one->precise ? MCOR_FLOAT64 : MCOR_FLOAT32;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double length = strchr(one->open, 'x' + axis) ? 0.0 : lengths[axis];
    at.options.periodic[2 * axis + 1] = length * (unequal ? factors[axis] : 1.0);
  }
  for (int64_t i = 0; i < 3 * particles.count && unequal; ++i)
  {
    particles.position[i] *= factors[i % 3];
  }
  at.skip_pairs = one->field == MCOR_WEIGHT_SUM;
  snprintf(at.name, sizeof(at.name), "period/%s/%g%s%s", one->name, iso,
    one->precise ? "/double" : "", unequal ? "/unequal" : "");
  oracle_run_case(suite, &at);
  particle_set_free(&particles);
}

int main(int argc, char** argv)
{
  oracle_suite suite;
  if (!oracle_begin_suite(&suite, argc, argv))
  {
    return 1;
  }
  for (size_t n = 0; n < sizeof(cases) / sizeof(cases[0]); ++n)
  {
    for (int unequal = 0; unequal < (strlen(cases[n].open) < 2 ? 2 : 1); ++unequal)
    {
      run_case(&suite, &cases[n], unequal);
    }
  }
  return oracle_end_suite(&suite);
}
