/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cap_check.h"

#include <math.h>

void cap_check_prefix(const mcor_surface* open, const mcor_surface* closed)
{
  const size_t points = (size_t)open->point_count, triangles = (size_t)open->triangle_count;
  assert_true(closed->point_count >= open->point_count);
  assert_memory_equal(open->points, closed->points, points * 3 * sizeof(double));
  assert_memory_equal(open->normals, closed->normals, points * 3 * sizeof(float));
  assert_memory_equal(open->triangles, closed->triangles, triangles * 3 * sizeof *open->triangles);
  assert_int_equal(closed->triangle_count - open->triangle_count, closed->statistics.cap_triangles);
  assert_true(closed->statistics.residual_max == open->statistics.residual_max);
}

void cap_check_volume(const mcor_surface* closed, const particle_set* set,
  const mcor_options* options, const double planes[6])
{
  enum
  {
    SAMPLES = 20000
  };
  const double share = options->wall_share > 0 ? options->wall_share : 1;
  oracle_field field =
    oracle_make_field(set, (oracle_kernel)options->sph_kernel, (oracle_kind)options->field, 1);
  uint64_t seed = 3;
  int inside = 0;
  for (int i = 0; i < SAMPLES; ++i)
  {
    double at[3];
    oracle_sample sample;
    for (int a = 0; a < 3; ++a)
    {
      at[a] = planes[2 * a] + random_unit(&seed) * (planes[2 * a + 1] - planes[2 * a]);
    }
    oracle_evaluate(&field, NULL, at, &sample);
    inside +=
      sample.value >= options->iso_values[0] && sample.weight > (1 - share) * sample.trim_weight;
  }
  oracle_free_field(&field);
  const double part = (double)inside / SAMPLES;
  const double whole = (planes[1] - planes[0]) * (planes[3] - planes[2]) * (planes[5] - planes[4]);
  const double expected = whole * part, error = whole * sqrt(part * (1 - part) / SAMPLES);
  CORE_CHECK(fabs(closed->statistics.volume - expected) < 4 * error + 1e-9 * whole,
    "volume %g instead of %g +- %g", closed->statistics.volume, expected, error);
}
