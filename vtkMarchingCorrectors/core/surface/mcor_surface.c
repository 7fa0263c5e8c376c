/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* A surface's arrays. */

#include "mcor_internal.h"

#include <stdlib.h>
#include <string.h>

void mcor_list_surface_arrays(mcor_surface* s, mcor_surface_array arrays[MCOR_SURFACE_ARRAYS])
{
  const mcor_surface_array all[MCOR_SURFACE_ARRAYS] = { { (void**)&s->points, 3 * sizeof(double) },
    { (void**)&s->normals, 3 * sizeof(float) }, { (void**)&s->gradients, 3 * sizeof(double) },
    { (void**)&s->weight_sum, sizeof(float) }, { (void**)&s->boundary_eigenvalue, sizeof(float) },
    { (void**)&s->correction_length, sizeof(float) }, { (void**)&s->residual, sizeof(float) },
    { (void**)&s->boundary_flag, 1 }, { (void**)&s->iso_value, sizeof(double) },
    { (void**)&s->nearest_particle, sizeof(int64_t) },
    { (void**)&s->point_keys, MCOR_POINT_KEY * sizeof(uint64_t) } };
  memcpy(arrays, all, sizeof all);
}

void mcor_free_surface(mcor_surface* surface)
{
  if (!surface)
  {
    return;
  }
  mcor_surface_array arrays[MCOR_SURFACE_ARRAYS];
  mcor_list_surface_arrays(surface, arrays);
  for (int i = 0; i < MCOR_SURFACE_ARRAYS; ++i)
  {
    free(*arrays[i].array);
  }
  free(surface->triangles);
  free(surface->triangle_keys);
  free(surface->line_offsets);
  free(surface->line_points);
  free(surface->band_value);
  for (int a = 0; surface->attributes && a < surface->attribute_count; ++a)
  {
    free(surface->attributes[a]);
  }
  free(surface->attributes);
  free(surface->attribute_not_finite);
  *surface = (mcor_surface){ 0 };
}
