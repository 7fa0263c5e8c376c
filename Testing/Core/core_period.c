/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core_period.h"

#define PI 3.14159265358979323846

particle_set core_make_period(const int length[3], uint64_t seed)
{
  particle_set set = particle_set_make((int64_t)length[0] * length[1] * length[2]);
  for (int64_t i = 0; i < set.count; ++i)
  {
    double* x = set.position + 3 * i;
    const int64_t at[3] = { i % length[0], i / length[0] % length[1], i / length[0] / length[1] };
    for (int a = 0; a < 3; ++a)
    {
      x[a] = (double)at[a] + 0.5 + 0.2 * (2 * random_unit(&seed) - 1);
      set.scalar[i] += sin(2 * PI * x[a] / length[a] + a);
    }
    set.smoothing_length[i] = 1.3 * (1 + 0.4 * random_unit(&seed));
    set.volume[i] = 1;
  }
  return set;
}

particle_set core_add_images(const particle_set* set, const double period[6])
{
  particle_set all = { .has_solids = set->has_solids };
  for (int image = 0; image < 27; ++image)
  {
    const int at[3] = { image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1 };
    int open = 0;
    for (int a = 0; a < 3; ++a)
    {
      open = open || (at[a] != 0 && period[2 * a] == period[2 * a + 1]);
    }
    for (int64_t i = 0; i < set->count && !open; ++i)
    {
      particle_set_append(&all, set, i);
      for (int a = 0; a < 3; ++a)
      {
        all.position[3 * (all.count - 1) + a] += at[a] * (period[2 * a + 1] - period[2 * a]);
      }
    }
  }
  return all;
}

mcor_options core_period_options(const double* iso, const double period[6])
{
  mcor_options options = core_options(iso);
  memcpy(options.periodic, period, sizeof options.periodic);
  options.outputs |=
    MCOR_OUT_BOUNDARY_FLAG | MCOR_OUT_GRADIENTS | MCOR_OUT_WEIGHT_SUM | MCOR_OUT_RESIDUAL;
  return options;
}

void core_stretch_period(particle_set* set, double period[6])
{
  static const double factors[3] = { 1, 1 + 5.0 / 128, 1 + 3.0 / 128 };
  for (int64_t i = 0; i < 3 * set->count; ++i)
  {
    set->position[i] *= factors[i % 3];
  }
  for (int side = 0; side < 6; ++side)
  {
    period[side] *= factors[side / 2];
  }
}
