/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Normals from triangles [III-D.4]: of all vertices in a preview, else of those where the gradient
 * vanishes. The length of the cross product weighs a triangle by its area. */

#include "mcor_internal.h"

#include <math.h>
#include <stdlib.h>

static void mcor_triangle_normal(const mcor_surface* surface, const int32_t* t, double n[3])
{
  double u[3], v[3];
  for (int a = 0; a < 3; ++a)
  {
    u[a] = surface->points[3 * (int64_t)t[1] + a] - surface->points[3 * (int64_t)t[0] + a];
    v[a] = surface->points[3 * (int64_t)t[2] + a] - surface->points[3 * (int64_t)t[0] + a];
  }
  for (int a = 0; a < 3; ++a)
  {
    n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
  }
}

mcor_status mcor_finish_normals(mcor_context* context, mcor_surface* surface)
{
  const bool all = context->options->preview || context->options->triangle_normals;
  bool some = all;
  for (int64_t i = 0; !some && i < surface->point_count; ++i)
  {
    const float* n = surface->normals + 3 * i;
    some = n[0] == 0 && n[1] == 0 && n[2] == 0;
  }
  if (!some)
  {
    return MCOR_OK;
  }
  double* sums = calloc((size_t)surface->point_count * 3 + 1, sizeof(double));
  MCOR_RETURN_IF(
    !sums, context, MCOR_OUT_OF_CAPACITY, "Host memory for the normals could not be allocated.");
  for (int64_t i = 0; i < surface->triangle_count; ++i)
  {
    const int32_t* t = surface->triangles + 3 * i;
    double n[3];
    mcor_triangle_normal(surface, t, n);
    for (int c = 0; c < 9; ++c)
    {
      sums[3 * (int64_t)t[c / 3] + c % 3] += n[c % 3];
    }
  }
  for (int64_t i = 0; i < surface->point_count; ++i)
  {
    float* n = surface->normals + 3 * i;
    const double* s = sums + 3 * i;
    const double length = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
    if (!all && (n[0] != 0 || n[1] != 0 || n[2] != 0))
    {
      continue;
    }
    for (int a = 0; a < 3; ++a)
    {
      n[a] = length > 0 ? (float)(s[a] / length) : (a == 2 ? 1.0f : 0.0f);
    }
  }
  free(sums);
  return MCOR_OK;
}
