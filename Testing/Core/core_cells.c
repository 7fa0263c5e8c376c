/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core_cells.h"
#include "core_fixture.h"

#include <string.h>

int cells_corner_above(int cube_case, int corner)
{
  return cube_case >> corner & 1;
}

int cells_lower_corner(int edge)
{
  return edge & 7;
}

int cells_upper_corner(int edge)
{
  return (edge & 7) | 1 << (edge >> 3);
}

int cells_is_crossed(int cube_case, int edge)
{
  return edge >> 3 < 3 && !(edge >> (edge >> 3) & 1) &&
    cells_corner_above(cube_case, cells_lower_corner(edge)) !=
    cells_corner_above(cube_case, cells_upper_corner(edge));
}

int cells_in_face(int edge, int face)
{
  return edge >> 3 != face / 2 && (edge >> face / 2 & 1) == (face & 1);
}

int cells_face_crossings(int cube_case, int face, int crossed[4])
{
  int count = 0;
  for (int e = 0; e < 24; ++e)
  {
    if (cells_is_crossed(cube_case, e) && cells_in_face(e, face))
    {
      crossed[count++] = e;
    }
  }
  return count;
}

static int cells_ambiguous_faces(int cube_case)
{
  int result = 0, crossed[4];
  for (int face = 0; face < 6; ++face)
  {
    result |= (cells_face_crossings(cube_case, face, crossed) == 4) << face;
  }
  return result;
}

int cells_partner(int cube_case, int joined, int face, int edge)
{
  int crossed[4];
  const int count = cells_face_crossings(cube_case, face, crossed);
  const int lower_is_above = cells_corner_above(cube_case, cells_lower_corner(edge));
  const int around =
    lower_is_above != (joined >> face & 1) ? cells_lower_corner(edge) : cells_upper_corner(edge);
  for (int i = 0; i < count; ++i)
  {
    const int other = crossed[i];
    if (other != edge &&
      (count == 2 || cells_lower_corner(other) == around || cells_upper_corner(other) == around))
    {
      return other;
    }
  }
  return -1;
}

int cells_case_rows(const mcor_topology_table* table, int cube_case, cells_choice rows[256])
{
  const int ambiguous = cells_ambiguous_faces(cube_case), entry = table->cases[cube_case];
  const mcor_cell_row* first = table->rows + (entry >> 6);
  int count = 0;
  CORE_CHECK((entry & 63) == ambiguous, "case %d: ambiguous faces %x", cube_case, entry & 63);
  for (int joined = 0; joined < 64; ++joined)
  {
    if (joined & ~ambiguous)
    {
      continue;
    }
    int number = 0, bit = 1;
    for (int face = 0; face < 6; ++face)
    {
      number |= joined >> face & 1 ? bit : 0;
      bit <<= ambiguous >> face & 1;
    }
    for (int tunnel = 0; tunnel <= 2; ++tunnel)
    {
      const int other = tunnel < 2 ? first[number].tunnel[tunnel] : number;
      if (tunnel == 2 || other > 0)
      {
        rows[count++] = (cells_choice){ cube_case, joined, tunnel, first + other };
      }
    }
  }
  return count;
}

int cells_count_loops(int cube_case, int joined)
{
  int seen[24] = { 0 }, loops = 0;
  for (int e = 0; e < 24; ++e)
  {
    int at = e, last_face = -1;
    loops += cells_is_crossed(cube_case, e) && !seen[e];
    while (cells_is_crossed(cube_case, at) && !seen[at])
    {
      seen[at] = 1;
      for (int face = 0; face < 6; ++face)
      {
        if (face != last_face && cells_in_face(at, face))
        {
          at = cells_partner(cube_case, joined, face, at);
          last_face = face;
          break;
        }
      }
    }
  }
  return loops;
}

int cells_edge_number(int edge, const int cell[3])
{
  const int c = cells_lower_corner(edge);
  return (edge >> 3) * 27 + (cell[0] + (c & 1)) * 9 + (cell[1] + (c >> 1 & 1)) * 3 + cell[2] +
    (c >> 2);
}

void cells_add_row(cells_mesh* mesh, const mcor_cell_row* row, const int cell[3])
{
  for (int t = 0; t < row->triangles; ++t)
  {
    int* corner = mesh->corner[mesh->count++];
    for (int k = 0; k < 3; ++k)
    {
      corner[k] = cells_edge_number(row->edges[3 * t + k], cell);
    }
    for (int k = 0; k < 3; ++k)
    {
      ++mesh->directed[corner[k]][corner[(k + 1) % 3]];
    }
  }
}

void cells_clear(cells_mesh* mesh)
{
  for (; mesh->count > 0; --mesh->count)
  {
    const int* corner = mesh->corner[mesh->count - 1];
    for (int k = 0; k < 3; ++k)
    {
      mesh->directed[corner[k]][corner[(k + 1) % 3]] = 0;
    }
  }
}

int cells_walk_link(const cells_mesh* mesh, int vertex, int link[64])
{
  int next[CELLS_EDGES], before[CELLS_EDGES], triangles = 0, begin = -1;
  memset(next, -1, sizeof next);
  memset(before, -1, sizeof before);
  for (int t = 0; t < mesh->count; ++t)
  {
    for (int k = 0; k < 3; ++k)
    {
      const int a = mesh->corner[t][(k + 1) % 3], b = mesh->corner[t][(k + 2) % 3];
      if (mesh->corner[t][k] == vertex)
      {
        if (next[a] >= 0 || before[b] >= 0)
        {
          return -1;
        }
        next[a] = b;
        before[b] = a;
        begin = a;
        ++triangles;
      }
    }
  }
  for (int i = 0; i < triangles && before[begin] >= 0; ++i)
  {
    begin = before[begin];
  }
  int length = 1, at = begin;
  link[0] = begin;
  while (next[at] >= 0 && next[at] != begin)
  {
    at = next[at];
    link[length++] = at;
  }
  return length - (next[at] < 0) == triangles ? length : -1;
}
