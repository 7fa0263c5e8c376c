/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Neighbours by the topology table, exhaustively: all pairs of cells that share a face, and all
 * fours of cells around an edge, with all decisions. */

#include "core_cells.h"
#include "core_fixture.h"

static int set_up(void** state)
{
  static mcor_topology_table table;
  mcor_make_topology_table(&table);
  *state = &table;
  return 0;
}

/* ---- two cells ---- */

/* Cases of the cells (x, y, z), each 0 or 1, from the nodes above in 3 x 3 x 3. */
static int case_at(uint32_t above, const int cell[3])
{
  int cube_case = 0;
  for (int c = 0; c < 8; ++c)
  {
    const int x = cell[0] + (c & 1), y = cell[1] + (c >> 1 & 1), z = cell[2] + (c >> 2);
    cube_case |= (int)(above >> (x * 9 + y * 3 + z) & 1) << c;
  }
  return cube_case;
}

/* Each side has at most one triangle in either direction. An open one lies on an outer face, where
 * each cell has as many as segments. */
static void check_two_cells(
  const cells_mesh* mesh, const cells_choice* first, const cells_choice* second, int axis)
{
  int open = 0, expected = 0, crossed[4], link[64];
  for (int t = 0; t < mesh->count; ++t)
  {
    for (int k = 0; k < 3; ++k)
    {
      const int a = mesh->corner[t][k], b = mesh->corner[t][(k + 1) % 3];
      CORE_CHECK(mesh->directed[a][b] == 1,
        "axis %d, cases %d and %d, joined %x and %x: side %d-%d", axis, first->cube_case,
        second->cube_case, first->joined, second->joined, a, b);
      open += !mesh->directed[b][a];
    }
  }
  for (int face = 0; face < 6; ++face)
  {
    expected +=
      face == 2 * axis + 1 ? 0 : cells_face_crossings(first->cube_case, face, crossed) / 2;
    expected += face == 2 * axis ? 0 : cells_face_crossings(second->cube_case, face, crossed) / 2;
  }
  CORE_CHECK(open == expected, "axis %d, cases %d and %d, joined %x and %x: %d open sides, not %d",
    axis, first->cube_case, second->cube_case, first->joined, second->joined, open, expected);
  static const int origin[3] = { 0, 0, 0 };
  const int count = cells_face_crossings(first->cube_case, 2 * axis + 1, crossed);
  for (int i = 0; i < count; ++i)
  {
    CORE_CHECK(cells_walk_link(mesh, cells_edge_number(crossed[i], origin), link) > 0,
      "axis %d, cases %d and %d, joined %x and %x: the vertex of edge %d", axis, first->cube_case,
      second->cube_case, first->joined, second->joined, crossed[i]);
  }
}

/* Spreads the bits of `pattern` over the nodes with coordinates below `size`. */
static uint32_t spread_nodes(uint32_t pattern, const int size[3])
{
  uint32_t above = 0;
  for (int n = 0; n < 27; ++n)
  {
    if (n / 9 < size[0] && n / 3 % 3 < size[1] && n % 3 < size[2])
    {
      above |= (pattern & 1) << n;
      pattern >>= 1;
    }
  }
  return above;
}

static void test_two_cells(void** state)
{
  static cells_mesh mesh;
  cells_choice rows[2][256];
  for (int axis = 0; axis < 3; ++axis)
  {
    int cells[2][3] = { { 0, 0, 0 }, { 0, 0, 0 } }, size[3] = { 2, 2, 2 };
    cells[1][axis] = 1;
    size[axis] = 3;
    for (uint32_t pattern = 0; pattern < 4096; ++pattern)
    {
      const uint32_t above = spread_nodes(pattern, size);
      const int count[2] = { cells_case_rows(*state, case_at(above, cells[0]), rows[0]),
        cells_case_rows(*state, case_at(above, cells[1]), rows[1]) };
      for (int i = 0; i < count[0] * count[1]; ++i)
      {
        const cells_choice *first = rows[0] + i / count[1], *second = rows[1] + i % count[1];
        if ((first->joined >> (2 * axis + 1) & 1) == (second->joined >> (2 * axis) & 1))
        {
          cells_add_row(&mesh, first->row, cells[0]);
          cells_add_row(&mesh, second->row, cells[1]);
          check_two_cells(&mesh, first, second, axis);
          cells_clear(&mesh);
        }
      }
    }
  }
}

/* ---- four cells around an edge ---- */

/* What all rows of a case put around the vertex of an edge. A decision matters here only if it
 * concerns one of the edge's two faces; all others, and tunnels, are taken together. */
typedef struct fan_set
{
  int end[2];     /* by side of the fan: first and last vertex of the link, as edges of the cell */
  uint32_t inner; /* all other vertices of the link that occur in any row */
} fan_set;

/* fans[case][edge][whether joined: first face, second face]; faces ascending. */
typedef fan_set fan_table[256][24][2][2];

static void edge_faces(int edge, int faces[2])
{
  int count = 0;
  for (int face = 0; face < 6; ++face)
  {
    if (cells_in_face(edge, face))
    {
      faces[count++] = face;
    }
  }
}

static void fill_fans(const cells_choice* choice, fan_set fans[24][2][2])
{
  static cells_mesh mesh;
  static const int origin[3] = { 0, 0, 0 };
  int edge_of[CELLS_EDGES];
  for (int e = 0; e < 24; ++e)
  {
    edge_of[cells_edge_number(e, origin)] = e;
  }
  cells_add_row(&mesh, choice->row, origin);
  for (int e = 0; e < 24; ++e)
  {
    int faces[2], link[64];
    if (!cells_is_crossed(choice->cube_case, e))
    {
      continue;
    }
    edge_faces(e, faces);
    const int length = cells_walk_link(&mesh, cells_edge_number(e, origin), link);
    fan_set* set = &fans[e][choice->joined >> faces[0] & 1][choice->joined >> faces[1] & 1];
    assert_true(length >= 2);
    set->end[0] = edge_of[link[0]];
    set->end[1] = edge_of[link[length - 1]];
    for (int i = 1; i < length - 1; ++i)
    {
      set->inner |= 1u << edge_of[link[i]];
    }
  }
  cells_clear(&mesh);
}

static fan_table* make_fans(const mcor_topology_table* table)
{
  static fan_table fans;
  cells_choice rows[256];
  for (int c = 0; c < 256; ++c)
  {
    const int count = cells_case_rows(table, c, rows);
    for (int i = 0; i < count; ++i)
    {
      fill_fans(rows + i, fans[c]);
    }
  }
  return &fans;
}

/* The four cells around the middle edge of 3 x 3 x 2 nodes, in turn. */
static void cells_around(int axis, int cells[4][3])
{
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (int i = 0; i < 4; ++i)
  {
    cells[i][axis] = 0;
    cells[i][u] = i == 1 || i == 2;
    cells[i][v] = i == 2 || i == 3;
  }
}

/* The face of cell `i` towards the next cell around the edge, and towards the one before. */
static int face_towards(int cells[4][3], int i, int step)
{
  const int* from = cells[i];
  const int* to = cells[(i + step + 4) % 4];
  for (int a = 0; a < 3; ++a)
  {
    if (from[a] != to[a])
    {
      return 2 * a + (to[a] > from[a]);
    }
  }
  return -1;
}

/* Numbers, in the lattice, of those edges of a set that lie in a face of their cell. */
static uint64_t numbers_in_face(uint32_t set, int face, const int cell[3], int axis)
{
  uint64_t numbers = 0;
  for (int e = 0; e < 24; ++e)
  {
    if (set >> e & 1 && cells_in_face(e, face))
    {
      /* At most 64 numbers, as the lattice has two layers of nodes. */
      const int number = cells_edge_number(e, cell);
      const int at[3] = { number % 27 / 9, number % 9 / 3, number % 3 };
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      numbers |= UINT64_C(1) << ((number / 27 * 2 + at[axis]) * 9 + at[u] * 3 + at[v]);
    }
  }
  return numbers;
}

/* The link of the middle edge's vertex is one circle: each fan ends in a face where the next one
 * begins, and two cells share no other vertex of their fans, whatever their other decisions are. */
static void check_four_cells(
  const fan_table* fans, uint32_t above, int axis, int joined, int cells[4][3])
{
  const fan_set* fan[4];
  for (int i = 0; i < 4; ++i)
  {
    int faces[2];
    const int edge = axis << 3 | (cells[i][(axis + 1) % 3] ? 0 : 1 << (axis + 1) % 3) |
      (cells[i][(axis + 2) % 3] ? 0 : 1 << (axis + 2) % 3);
    edge_faces(edge, faces);
    /* Face i of the four is the one between cells i and i + 1. */
    const int next = face_towards(cells, i, 1) == faces[0] ? i : (i + 3) % 4;
    const int other = next == i ? (i + 3) % 4 : i;
    fan[i] = &(*fans)[case_at(above, cells[i])][edge][joined >> next & 1][joined >> other & 1];
  }
  for (int i = 0; i < 4; ++i)
  {
    const int j = (i + 1) % 4, mine = face_towards(cells, i, 1),
              theirs = face_towards(cells, j, -1);
    const uint32_t ends[2] = { 1u << fan[i]->end[0] | 1u << fan[i]->end[1],
      1u << fan[j]->end[0] | 1u << fan[j]->end[1] };
    const uint64_t end = numbers_in_face(ends[0], mine, cells[i], axis);
    const uint64_t inner[2] = { numbers_in_face(fan[i]->inner, mine, cells[i], axis),
      numbers_in_face(fan[j]->inner, theirs, cells[j], axis) };
    CORE_CHECK(
      end != 0 && (end & (end - 1)) == 0 && end == numbers_in_face(ends[1], theirs, cells[j], axis),
      "axis %d, nodes %x, joined %x: the fans of cells %d and %d do not meet", axis, above, joined,
      i, j);
    CORE_CHECK((inner[0] & inner[1]) == 0 && ((inner[0] | inner[1]) & end) == 0,
      "axis %d, nodes %x, joined %x: the fans of cells %d and %d overlap", axis, above, joined, i,
      j);
  }
}

static void test_four_cells(void** state)
{
  const fan_table* fans = (const fan_table*)make_fans(*state);
  for (int axis = 0; axis < 3; ++axis)
  {
    int cells[4][3], size[3] = { 3, 3, 3 };
    const int stride[3] = { 9, 3, 1 }, middle = stride[(axis + 1) % 3] + stride[(axis + 2) % 3];
    size[axis] = 2;
    cells_around(axis, cells);
    for (uint32_t pattern = 0; pattern < 1u << 18; ++pattern)
    {
      const uint32_t above = spread_nodes(pattern, size);
      if ((above >> middle & 1) == (above >> (middle + stride[axis]) & 1))
      {
        continue;
      }
      int ambiguous = 0;
      for (int i = 0; i < 4; ++i)
      {
        int crossed[4];
        ambiguous |=
          (cells_face_crossings(case_at(above, cells[i]), face_towards(cells, i, 1), crossed) == 4)
          << i;
      }
      for (int joined = 0; joined < 16; ++joined)
      {
        if (!(joined & ~ambiguous))
        {
          check_four_cells(fans, above, axis, joined, cells);
        }
      }
    }
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_two_cells),
    cmocka_unit_test(test_four_cells) };
  return cmocka_run_group_tests_name("topology_cells", tests, set_up, NULL);
}
