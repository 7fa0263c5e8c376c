/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Orientation of sections made of triangles: if they form a closed surface, normals point
 * outwards. */

#include "mcor_flux.h"
#include "mcor_vector.h"

#include <stdlib.h>
#include <string.h>

/* An edge of a triangle, its lesser end first. turned: the triangle has it the other way round. */
typedef struct mcor_flux_edge
{
  double ends[2][3];
  bool turned;
} mcor_flux_edge;

static int mcor_compare_numbers(const double* a, const double* b, int count)
{
  for (int i = 0; i < count; ++i)
  {
    if (a[i] != b[i])
    {
      return a[i] < b[i] ? -1 : 1;
    }
  }
  return 0;
}

static int mcor_compare_flux_edges(const void* a, const void* b)
{
  const mcor_flux_edge *left = a, *right = b;
  const int order = mcor_compare_numbers(left->ends[0], right->ends[0], 6);
  return order != 0 ? order : (int)left->turned - (int)right->turned;
}

mcor_status mcor_orient_triangles(
  mcor_context* context, const double* points, int64_t point_count, double* sign)
{
  mcor_flux_edge* edges = malloc((size_t)point_count * sizeof *edges);
  MCOR_TRY(mcor_allocated(context, edges));
  double volume = 0;
  for (int64_t i = 0; i < point_count; ++i)
  {
    const double *from = points + 3 * i, *to = points + 3 * (i % 3 == 2 ? i - 2 : i + 1);
    edges[i].turned = mcor_compare_numbers(from, to, 3) > 0;
    memcpy(edges[i].ends[edges[i].turned], from, sizeof edges[i].ends[0]);
    memcpy(edges[i].ends[!edges[i].turned], to, sizeof edges[i].ends[0]);
    if (i % 3 == 0)
    {
      double corners[3][3], product[3];
      for (int c = 0; c < 3; ++c)
      {
        mcor_subtract(from + 3 * c, points, corners[c]);
      }
      mcor_cross(corners[1], corners[2], product);
      volume += mcor_dot(corners[0], product);
    }
  }
  qsort(edges, (size_t)point_count, sizeof *edges, mcor_compare_flux_edges);
  bool closed = point_count % 2 == 0;
  for (int64_t i = 0; i + 1 < point_count && closed;
       i += 2) /* every edge must occur once in each direction */
  {
    closed = !edges[i].turned && edges[i + 1].turned &&
      mcor_compare_numbers(edges[i].ends[0], edges[i + 1].ends[0], 6) == 0;
  }
  free(edges);
  *sign = closed && volume < 0 ? -1 : 1;
  return MCOR_OK;
}
