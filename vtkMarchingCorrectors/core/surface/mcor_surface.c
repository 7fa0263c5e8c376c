/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* A surface's arrays. */

#include "mcor_input.h"

#include <stdlib.h>
#include <string.h>

/* Lists the points, then the other arrays in the order of mcor_output. */
void mcor_list_surface_arrays(mcor_surface* s, mcor_surface_array arrays[MCOR_SURFACE_ARRAYS])
{
  const mcor_surface_array all[MCOR_SURFACE_ARRAYS] = { { (void**)&s->points, 3 * sizeof(double) },
    { (void**)&s->normals, 3 * sizeof(float) }, { (void**)&s->gradients, 3 * sizeof(double) },
    { (void**)&s->weight_sum, sizeof(float) }, { (void**)&s->boundary_eigenvalue, sizeof(float) },
    { (void**)&s->correction_length, sizeof(float) }, { (void**)&s->residual, sizeof(float) },
    { (void**)&s->boundary_flag, 1 }, { (void**)&s->iso_value, sizeof(double) },
    { (void**)&s->nearest_particle, sizeof(int64_t) },
    { (void**)&s->point_keys, MCOR_POINT_KEY * sizeof(uint64_t) },
    { (void**)&s->mean_curvature, sizeof(double) },
    { (void**)&s->gauss_curvature, sizeof(double) } };
  memcpy(arrays, all, sizeof all);
}

mcor_status mcor_begin_surface(
  mcor_context* context, const mcor_input* input, mcor_surface* surface)
{
  const size_t count = (size_t)input->attribute_count;
  surface->attribute_count = input->attribute_count;
  surface->attributes = calloc(count + 1, sizeof *surface->attributes);
  surface->attribute_not_finite = calloc(count + 1, sizeof *surface->attribute_not_finite);
  MCOR_TRY(mcor_allocated(context, surface->attributes && surface->attribute_not_finite));
  return mcor_list_components(context, input, true, surface->attribute_not_finite);
}

mcor_status mcor_grow(mcor_context* context, void** array, int64_t old, int64_t count, size_t width)
{
  const size_t bytes = (size_t)(old + count) * width + 1;
  void* grown = realloc(*array, bytes);
  MCOR_FAIL_IF(!grown, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(HOST_MEMORY_FOR),
    (long long)(old + count), "points of the surface");
  mcor_use_large_pages(grown, bytes);
  *array = grown;
  return MCOR_OK;
}

mcor_status mcor_grow_surface(
  mcor_context* context, const mcor_input* input, mcor_surface* s, int64_t points)
{
  const mcor_options* o = context->run.options;
  const int64_t n = s->point_count;
  mcor_surface_array arrays[MCOR_SURFACE_ARRAYS];
  mcor_list_surface_arrays(s, arrays);
  for (int i = 0; i < MCOR_SURFACE_ARRAYS; ++i)
  {
    if (i == 0 || o->outputs >> (i - 1) & 1)
    {
      MCOR_TRY(mcor_grow(context, arrays[i].array, n, points, arrays[i].width));
    }
  }
  for (int a = 0; a < input->attribute_count; ++a)
  {
    const size_t components = (size_t)mcor_components(&input->attributes[a]);
    if (s->attribute_not_finite[a] < 0)
    {
      MCOR_TRY(
        mcor_grow(context, (void**)&s->attributes[a], n, points, components * sizeof(double)));
    }
  }
  return MCOR_OK;
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
