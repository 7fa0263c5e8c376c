/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The topology table, exhaustively: all cases with all decisions on faces and inside. */

#include "core_cells.h"
#include "core_fixture.h"

#include <stdlib.h>

static int set_up(void** state)
{
  static mcor_topology_table table;
  mcor_make_topology_table(&table);
  *state = &table;
  return 0;
}

/* Whether the side from one edge to another goes the right way along a face, vertices being at the
 * edges' middles: normals look to the corners below, the surface is inside the cell. */
static int goes_right(int cube_case, int face, int from, int to)
{
  double along[3], across[3], p[2][3], towards = 0;
  const int edges[2] = { from, to };
  const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (int i = 0; i < 2; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      p[i][a] = (edges[i] >> a & 1) + (edges[i] >> 3 == a ? 0.5 : 0);
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    along[a] = p[1][a] - p[0][a];
  }
  /* The face's outer normal times the side. */
  across[axis] = 0;
  across[u] = (face & 1 ? -1 : 1) * along[v];
  across[v] = (face & 1 ? 1 : -1) * along[u];
  for (int i = 0; i < 2; ++i)
  {
    const double fall = cells_corner_above(cube_case, cells_lower_corner(edges[i])) ? 1 : -1;
    towards += fall * across[edges[i] >> 3];
  }
  return towards > 0;
}

static void check_sides(const cells_mesh* mesh, const cells_choice* choice)
{
  static const int origin[3] = { 0, 0, 0 };
  for (int e = 0; e < 24; ++e)
  {
    for (int f = 0; f < 24; ++f)
    {
      if (!cells_is_crossed(choice->cube_case, e) || !cells_is_crossed(choice->cube_case, f) ||
        e == f)
      {
        continue;
      }
      const int a = cells_edge_number(e, origin), b = cells_edge_number(f, origin);
      int segment = -1;
      for (int face = 0; face < 6; ++face)
      {
        if (cells_in_face(e, face) && cells_in_face(f, face) &&
          cells_partner(choice->cube_case, choice->joined, face, e) == f)
        {
          segment = face;
        }
      }
      const int expected =
        segment >= 0 ? goes_right(choice->cube_case, segment, e, f) : mesh->directed[b][a];
      CORE_CHECK(mesh->directed[a][b] <= 1 && mesh->directed[a][b] == expected,
        "case %d, joined %x, tunnel %d: side %d-%d used %d times, not %d", choice->cube_case,
        choice->joined, choice->tunnel, e, f, mesh->directed[a][b], expected);
    }
  }
}

static int find_part(int part[CELLS_EDGES], int vertex)
{
  while (part[vertex] != vertex)
  {
    vertex = part[vertex];
  }
  return vertex;
}

/* Every loop bounds a disc; or two bound a tube: Euler number and connected parts. */
static void check_shape(const cells_mesh* mesh, const cells_choice* choice)
{
  static const int origin[3] = { 0, 0, 0 };
  int part[CELLS_EDGES], vertices = 0, sides = 0, parts = 0;
  for (int v = 0; v < CELLS_EDGES; ++v)
  {
    part[v] = v;
  }
  for (int a = 0; a < CELLS_EDGES; ++a)
  {
    for (int b = 0; b < a; ++b)
    {
      if (mesh->directed[a][b] || mesh->directed[b][a])
      {
        ++sides;
        part[find_part(part, a)] = find_part(part, b);
      }
    }
  }
  for (int e = 0; e < 24; ++e)
  {
    if (cells_is_crossed(choice->cube_case, e))
    {
      const int v = cells_edge_number(e, origin);
      ++vertices;
      parts += find_part(part, v) == v;
    }
  }
  const int loops = cells_count_loops(choice->cube_case, choice->joined),
            tunnel = choice->tunnel < 2;
  const int euler = vertices - sides + mesh->count;
  CORE_CHECK(euler == loops - 2 * tunnel && parts == loops - tunnel,
    "case %d, joined %x, tunnel %d: %d loops, Euler number %d, %d parts", choice->cube_case,
    choice->joined, choice->tunnel, loops, euler, parts);
}

/* The fan of an edge's vertex goes from one of the edge's faces to the other. */
static void check_fans(const cells_mesh* mesh, const cells_choice* choice)
{
  static const int origin[3] = { 0, 0, 0 };
  for (int e = 0; e < 24; ++e)
  {
    int link[64], ends = 0;
    if (!cells_is_crossed(choice->cube_case, e))
    {
      continue;
    }
    const int length = cells_walk_link(mesh, cells_edge_number(e, origin), link);
    CORE_CHECK(length >= 2, "case %d, joined %x, tunnel %d: edge %d has no fan", choice->cube_case,
      choice->joined, choice->tunnel, e);
    for (int face = 0; face < 6; ++face)
    {
      if (cells_in_face(e, face))
      {
        const int end =
          cells_edge_number(cells_partner(choice->cube_case, choice->joined, face, e), origin);
        ends += link[0] == end || link[length - 1] == end;
      }
    }
    CORE_CHECK(ends == 2, "case %d, joined %x, tunnel %d: the fan of edge %d", choice->cube_case,
      choice->joined, choice->tunnel, e);
  }
}

static void test_single_cells(void** state)
{
  static cells_mesh mesh;
  static const int origin[3] = { 0, 0, 0 };
  cells_choice rows[256];
  int checked = 0;
  for (int cube_case = 0; cube_case < 256; ++cube_case)
  {
    const int count = cells_case_rows(*state, cube_case, rows);
    for (int i = 0; i < count; ++i)
    {
      cells_add_row(&mesh, rows[i].row, origin);
      check_sides(&mesh, rows + i);
      check_shape(&mesh, rows + i);
      check_fans(&mesh, rows + i);
      cells_clear(&mesh);
      ++checked;
    }
  }
  assert_int_equal(checked, ((mcor_topology_table*)*state)->row_count);
}

/* Where nothing is joined, cells without a tunnel are those of the case table. */
static void test_first_rows(void** state)
{
  const mcor_topology_table* table = *state;
  uint8_t cases[256][16];
  mcor_make_case_table(cases);
  for (int c = 0; c < 256; ++c)
  {
    const mcor_cell_row* row = table->rows + (table->cases[c] >> 6);
    assert_int_equal(row->triangles, cases[c][15]);
    assert_memory_equal(row->edges, cases[c], 3 * (size_t)row->triangles);
  }
}

/* Which tunnels there are: for two opposite corners; for none of the cases with one loop. */
static void test_tunnels(void** state)
{
  cells_choice rows[256];
  int tunnels = 0;
  for (int c = 0; c < 256; ++c)
  {
    const int count = cells_case_rows(*state, c, rows);
    for (int i = 0; i < count; ++i)
    {
      const int loops = cells_count_loops(c, rows[i].joined), tunnel = rows[i].tunnel < 2;
      CORE_CHECK(!tunnel || loops >= 2, "case %d has a tunnel of one loop", c);
      /* Two loops have one region between them: exactly one tunnel. */
      if (!tunnel && loops == 2)
      {
        const mcor_cell_row* row = rows[i].row;
        CORE_CHECK((row->tunnel[0] > 0) + (row->tunnel[1] > 0) == 1, "case %d, joined %x", c,
          rows[i].joined);
      }
      tunnels += tunnel;
    }
  }
  const mcor_topology_table* table = *state;
  const mcor_cell_row* opposite = table->rows + (table->cases[0x81] >> 6);
  assert_int_equal(opposite->tunnel[0], 0);
  assert_int_equal((opposite + opposite->tunnel[1])->triangles, 6);
  assert_true(tunnels > 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_single_cells),
    cmocka_unit_test(test_first_rows), cmocka_unit_test(test_tunnels) };
  return cmocka_run_group_tests_name("topology_table", tests, set_up, NULL);
}
