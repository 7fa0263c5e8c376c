/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The 256 cases of Marching Cubes, derived rather than listed. On each face, every run of corners
 * above the iso value is cut off by one segment; this depends on the face's corners alone, so two
 * cells agree on their common face. Segments join to loops, loops are cut into triangles. A diagonal
 * within a face would meet the neighbour's in an edge of four triangles; none is used. */

#include "mcor_internal.h"

#include <assert.h>
#include <string.h>

#define MCOR_CELL_EDGES 24 /* axis << 3 | lower corner; not all numbers are edges */

static int mcor_corner_above(int cube_case, int corner)
{
  return cube_case >> corner & 1;
}

/* The edge between two neighbouring corners. */
static int mcor_edge_between(int a, int b)
{
  const int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
  return axis << 3 | (a & b);
}

/* Corners of a face, counter-clockwise seen from outside. */
static void mcor_face_corners(int axis, int side, int corners[4])
{
  const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
  corners[0] = base;
  corners[1] = base | (side ? u : v);
  corners[2] = base | u | v;
  corners[3] = base | (side ? v : u);
}

/* next[edge]: the edge that follows on the loop, -1 where the edge is not crossed. The direction makes
 * triangles face the corners below. */
static void mcor_link_edges(int cube_case, int next[MCOR_CELL_EDGES])
{
  for (int e = 0; e < MCOR_CELL_EDGES; ++e)
  {
    next[e] = -1;
  }
  for (int face = 0; face < 6; ++face)
  {
    int corner[4];
    mcor_face_corners(face >> 1, face & 1, corner);
    for (int i = 0; i < 4; ++i)
    {
      const int from = corner[i], to = corner[(i + 1) % 4];
      if (mcor_corner_above(cube_case, from) || !mcor_corner_above(cube_case, to))
      {
        continue;
      }
      int last = i + 1; /* of the run of corners above that begins at `to` */
      while (mcor_corner_above(cube_case, corner[(last + 1) % 4]))
      {
        ++last;
      }
      next[mcor_edge_between(from, to)] =
        mcor_edge_between(corner[last % 4], corner[(last + 1) % 4]);
    }
  }
}

static int mcor_share_face(int edge_a, int edge_b)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    if (axis != edge_a >> 3 && axis != edge_b >> 3 && ((edge_a ^ edge_b) >> axis & 1) == 0)
    {
      return 1;
    }
  }
  return 0;
}

/* Cuts loop[first..last] into triangles without a diagonal in a face; 0 if there is no such way. */
static int mcor_cut_loop(const int* loop, int first, int last, uint8_t* row)
{
  if (last - first < 2)
  {
    return 1;
  }
  const uint8_t triangles = row[15];
  for (int apex = first + 1; apex < last; ++apex)
  {
    if ((apex > first + 1 && mcor_share_face(loop[first], loop[apex])) ||
      (apex < last - 1 && mcor_share_face(loop[apex], loop[last])))
    {
      continue;
    }
    uint8_t* triangle = row + 3 * row[15]++;
    triangle[0] = (uint8_t)loop[first];
    triangle[1] = (uint8_t)loop[apex];
    triangle[2] = (uint8_t)loop[last];
    if (mcor_cut_loop(loop, first, apex, row) && mcor_cut_loop(loop, apex, last, row))
    {
      return 1;
    }
    row[15] = triangles;
  }
  return 0;
}

void mcor_make_case_table(uint8_t table[256][16])
{
  memset(table, 0, 256 * 16);
  for (int cube_case = 0; cube_case < 256; ++cube_case)
  {
    int next[MCOR_CELL_EDGES];
    mcor_link_edges(cube_case, next);
    for (int e = 0; e < MCOR_CELL_EDGES; ++e)
    {
      int loop[12], length = 0;
      for (int at = e; next[at] >= 0; ++length)
      {
        loop[length] = at;
        const int following = next[at];
        next[at] = -1;
        at = following;
      }
      const int cut = length == 0 || mcor_cut_loop(loop, 0, length - 1, table[cube_case]);
      assert(cut);
      (void)cut;
    }
  }
}
