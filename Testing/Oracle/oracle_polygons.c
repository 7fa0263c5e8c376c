/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle.h"

#include <stdlib.h>
#include <string.h>

/* Corner c of a cell has offsets (c & 1, c >> 1 & 1, c >> 2). The edge of a cell from its corner c
 * along an axis is 8 * axis + c here. */
enum
{
  POLYGON_EDGES = 24
};

static int polygon_edge(int from, int to)
{
  const int low = from < to ? from : to;
  const int difference = from ^ to;
  return 8 * (difference == 4 ? 2 : difference == 2 ? 1 : 0) + low;
}

/* Corners of the face towards -axis (side 0) or +axis, counter-clockwise seen from outside. */
static void polygon_face(int axis, int side, int corners[4])
{
  const int u = 1 << (axis + 1) % 3;
  const int v = 1 << (axis + 2) % 3;
  const int base = side << axis;
  corners[0] = base;
  corners[1] = base | (side ? u : v);
  corners[2] = base | u | v;
  corners[3] = base | (side ? v : u);
}

/* next[e]: the edge that follows edge e on its loop, -1 where e is not crossed. On a face, walked
 * counter-clockwise, a segment leads from where the walk enters "above" to where it leaves it. */
static void polygon_link(const int above[8], int next[POLYGON_EDGES])
{
  for (int e = 0; e < POLYGON_EDGES; ++e)
  {
    next[e] = -1;
  }
  for (int f = 0; f < 6; ++f)
  {
    int corners[4];
    polygon_face(f / 2, f % 2, corners);
    for (int n = 0; n < 4; ++n)
    {
      const int from = corners[n];
      const int to = corners[(n + 1) % 4];
      if (!above[from] && above[to])
      {
        int m = n + 1;
        while (above[corners[(m + 1) % 4]])
        {
          ++m;
        }
        next[polygon_edge(from, to)] = polygon_edge(corners[m % 4], corners[(m + 1) % 4]);
      }
    }
  }
}

/* Writes the triangles of one cell to out (NULL: only counts them); returns how many. */
static int64_t polygon_cell(
  const oracle_surface* surface, const oracle_lattice* lattice, int64_t cell, int32_t* out)
{
  const int64_t step[3] = { 1, lattice->size[0], lattice->size[0] * lattice->size[1] };
  int64_t node[8];
  int above[8];
  int next[POLYGON_EDGES];
  int64_t triangles = 0;
  for (int c = 0; c < 8; ++c)
  {
    node[c] = cell + (c & 1) * step[0] + (c >> 1 & 1) * step[1] + (c >> 2) * step[2];
    above[c] = lattice->flags[node[c]] & ORACLE_NODE_ABOVE;
  }
  polygon_link(above, next);
  for (int first = 0; first < POLYGON_EDGES; ++first)
  {
    int32_t loop[POLYGON_EDGES];
    int length = 0;
    for (int e = first; e >= 0 && next[e] >= 0;)
    {
      const int following = next[e];
      loop[length++] = (int32_t)oracle_find_edge(surface, 3 * node[e % 8] + e / 8);
      next[e] = -1;
      e = following;
    }
    for (int n = 1; n + 1 < length; ++n)
    {
      if (out)
      {
        out[3 * triangles] = loop[0];
        out[3 * triangles + 1] = loop[n];
        out[3 * triangles + 2] = loop[n + 1];
      }
      ++triangles;
    }
  }
  return triangles;
}

int oracle_create_mesh(oracle_mesh* mesh, const oracle_surface* surface,
  const oracle_lattice* lattice, const oracle_field* field, double iso)
{
  memset(mesh, 0, sizeof(*mesh));
  for (int64_t c = 0; c < surface->cell_count; ++c)
  {
    mesh->triangle_count += polygon_cell(surface, lattice, surface->cell[c], NULL);
  }
  mesh->point_count = surface->edge_count;
  mesh->points = malloc(((size_t)mesh->point_count + 1) * 3 * sizeof(double));
  mesh->triangles = malloc(((size_t)mesh->triangle_count + 1) * 3 * sizeof(int32_t));
  if (!mesh->points || !mesh->triangles)
  {
    oracle_free_mesh(mesh);
    return 0;
  }
  int64_t triangle = 0;
  for (int64_t c = 0; c < surface->cell_count; ++c)
  {
    triangle += polygon_cell(surface, lattice, surface->cell[c], &mesh->triangles[3 * triangle]);
  }
  for (int64_t e = 0; e < surface->edge_count; ++e)
  {
    oracle_sample sample;
    oracle_edge_root(lattice, field, iso, surface->edge[e], &mesh->points[3 * e], &sample);
  }
  return 1;
}

void oracle_free_mesh(oracle_mesh* mesh)
{
  free(mesh->points);
  free(mesh->triangles);
  memset(mesh, 0, sizeof(*mesh));
}
