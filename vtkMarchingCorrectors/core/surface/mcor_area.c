/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Area and volume of the whole surface. */

#include "mcor_internal.h"

#include <math.h>

/* A number of an edge that looks as if it were random: of edges that are not run through both ways, the sum
 * with signs is 0 by chance once in 2^64. */
static uint64_t mcor_edge_number(int32_t low, int32_t high)
{
  uint64_t x = ((uint64_t)low << 32 | (uint32_t)high) + 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

/* One triangle after the other, so that sums have one order; about one of the points, as coordinates may be
 * large. */
void mcor_measure_surface(mcor_surface* surface)
{
  mcor_statistics* s = &surface->statistics;
  uint64_t open = 0;
  if (surface->line_offsets)
  {
    return; /* lines are measured where they are joined */
  }
  s->area = s->volume = 0;
  for (int64_t t = 0; t < surface->triangle_count; ++t)
  {
    const int32_t* triangle = surface->triangles + 3 * t;
    double c[3][3], u[3], v[3];
    for (int i = 0; i < 3; ++i)
    {
      const int32_t a = triangle[i], b = triangle[(i + 1) % 3];
      const uint64_t number = a < b ? mcor_edge_number(a, b) : mcor_edge_number(b, a);
      open += a < b ? number : 0 - number;
      for (int d = 0; d < 3; ++d)
      {
        c[i][d] = surface->points[3 * (int64_t)a + d] - surface->points[d];
      }
    }
    for (int d = 0; d < 3; ++d)
    {
      u[d] = c[1][d] - c[0][d];
      v[d] = c[2][d] - c[0][d];
    }
    const double n[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
      u[0] * v[1] - u[1] * v[0] };
    s->area += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    s->volume += (c[0][0] * n[0] + c[0][1] * n[1] + c[0][2] * n[2]) / 6;
  }
  s->is_closed = open == 0 && surface->triangle_count > 0;
  s->volume = s->is_closed ? s->volume : 0;
}
