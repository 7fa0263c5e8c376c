/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The topology table, exhaustively: all cases with all decisions on faces and inside, and that cells side by side fit. */

#include "core_fixture.h"

#include <string.h>

#define EDGES                                                                                      \
  24 /* axis << 3 | lower corner; 12 of these numbers are edges; a face is axis * 2 + side */

/* The decisions on a cell, and the row of the table for them. */
typedef struct cells_choice
{
  int cube_case;
  int joined; /* faces whose corners above are joined */
  int tunnel; /* 0 joins regions below, 1 above, 2 none */
  const mcor_cell_row* row;
} cells_choice;

typedef struct cells_mesh
{
  int count; /* of triangles */
  int corner[64][3];
  uint8_t directed[EDGES][EDGES]; /* triangles with a side from one vertex to the other */
} cells_mesh;

/* ---- what must be on faces, derived from the corners alone ---- */

static int corner_above(int cube_case, int corner)
{
  return cube_case >> corner & 1;
}

static int lower_corner(int edge)
{
  return edge & 7;
}

static int upper_corner(int edge)
{
  return (edge & 7) | 1 << (edge >> 3);
}

/* 0 for a number that is no edge. */
static int is_crossed(int cube_case, int edge)
{
  return edge >> 3 < 3 && !(edge >> (edge >> 3) & 1) &&
    corner_above(cube_case, lower_corner(edge)) != corner_above(cube_case, upper_corner(edge));
}

static int in_face(int edge, int face)
{
  return edge >> 3 != face / 2 && (edge >> face / 2 & 1) == (face & 1);
}

/* Crossed edges of a face, 0, 2 or 4. */
static int face_crossings(int cube_case, int face, int crossed[4])
{
  int count = 0;
  for (int e = 0; e < 24; ++e)
  {
    if (is_crossed(cube_case, e) && in_face(e, face))
    {
      crossed[count++] = e;
    }
  }
  return count;
}

static int ambiguous_faces(int cube_case)
{
  int result = 0, crossed[4];
  for (int face = 0; face < 6; ++face)
  {
    result |= (face_crossings(cube_case, face, crossed) == 4) << face;
  }
  return result;
}

/* The edge that the surface connects with `edge` in a face: the other one that is crossed; of three, the one around the
 * same corner above, or below where those above are joined. */
static int partner(int cube_case, int joined, int face, int edge)
{
  int crossed[4];
  const int count = face_crossings(cube_case, face, crossed);
  const int lower_is_above = corner_above(cube_case, lower_corner(edge));
  const int around =
    lower_is_above != (joined >> face & 1) ? lower_corner(edge) : upper_corner(edge);
  for (int i = 0; i < count; ++i)
  {
    const int other = crossed[i];
    if (other != edge &&
      (count == 2 || lower_corner(other) == around || upper_corner(other) == around))
    {
      return other;
    }
  }
  return -1;
}

/* All rows of a case; returns their number. */
static int case_rows(const mcor_topology_table* table, int cube_case, cells_choice rows[256])
{
  const int ambiguous = ambiguous_faces(cube_case), entry = table->cases[cube_case];
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

/* Loops that the connections in faces make. */
static int count_loops(int cube_case, int joined)
{
  int seen[24] = { 0 }, loops = 0;
  for (int e = 0; e < 24; ++e)
  {
    int at = e, last_face = -1;
    loops += is_crossed(cube_case, e) && !seen[e];
    while (is_crossed(cube_case, at) && !seen[at])
    {
      seen[at] = 1;
      for (int face = 0; face < 6; ++face)
      {
        if (face != last_face && in_face(at, face))
        {
          at = partner(cube_case, joined, face, at);
          last_face = face;
          break;
        }
      }
    }
  }
  return loops;
}

static void add_row(cells_mesh* mesh, const mcor_cell_row* row)
{
  for (int t = 0; t < row->triangles; ++t)
  {
    int* corner = mesh->corner[mesh->count++];
    for (int k = 0; k < 3; ++k)
    {
      corner[k] = row->edges[3 * t + k];
    }
    for (int k = 0; k < 3; ++k)
    {
      ++mesh->directed[corner[k]][corner[(k + 1) % 3]];
    }
  }
}

/* Walks the link of a vertex, against the triangles' direction until its begin, then along it. Returns its length if it is
 * one simple path through all triangles of the vertex, else -1. */
static int walk_link(const cells_mesh* mesh, int vertex, int link[64])
{
  int next[EDGES], before[EDGES], triangles = 0, begin = -1;
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

/* ---- the table ---- */

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
    const double fall = corner_above(cube_case, lower_corner(edges[i])) ? 1 : -1;
    towards += fall * across[edges[i] >> 3];
  }
  return towards > 0;
}

static void check_sides(const cells_mesh* mesh, const cells_choice* choice)
{
  for (int e = 0; e < 24; ++e)
  {
    for (int f = 0; f < 24; ++f)
    {
      if (!is_crossed(choice->cube_case, e) || !is_crossed(choice->cube_case, f) || e == f)
      {
        continue;
      }
      const int a = e, b = f;
      int segment = -1;
      for (int face = 0; face < 6; ++face)
      {
        if (in_face(e, face) && in_face(f, face) &&
          partner(choice->cube_case, choice->joined, face, e) == f)
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

static int find_part(int part[EDGES], int vertex)
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
  int part[EDGES], vertices = 0, sides = 0, parts = 0;
  for (int v = 0; v < EDGES; ++v)
  {
    part[v] = v;
  }
  for (int a = 0; a < EDGES; ++a)
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
    if (is_crossed(choice->cube_case, e))
    {
      const int v = e;
      ++vertices;
      parts += find_part(part, v) == v;
    }
  }
  const int loops = count_loops(choice->cube_case, choice->joined), tunnel = choice->tunnel < 2;
  const int euler = vertices - sides + mesh->count;
  CORE_CHECK(euler == loops - 2 * tunnel && parts == loops - tunnel,
    "case %d, joined %x, tunnel %d: %d loops, Euler number %d, %d parts", choice->cube_case,
    choice->joined, choice->tunnel, loops, euler, parts);
}

/* The fan of an edge's vertex goes from one of the edge's faces to the other. */
static void check_fans(const cells_mesh* mesh, const cells_choice* choice)
{
  for (int e = 0; e < 24; ++e)
  {
    int link[64] = { 0 }, ends = 0;
    if (!is_crossed(choice->cube_case, e))
    {
      continue;
    }
    const int length = walk_link(mesh, e, link);
    CORE_CHECK(length >= 2, "case %d, joined %x, tunnel %d: edge %d has no fan", choice->cube_case,
      choice->joined, choice->tunnel, e);
    for (int face = 0; face < 6; ++face)
    {
      if (in_face(e, face))
      {
        const int end = partner(choice->cube_case, choice->joined, face, e);
        ends += link[0] == end || link[length - 1] == end;
      }
    }
    CORE_CHECK(ends == 2, "case %d, joined %x, tunnel %d: the fan of edge %d", choice->cube_case,
      choice->joined, choice->tunnel, e);
  }
}

/* Diagonals within a face, by the face's axis and corners above, and by the cell's side: its ends are of 12 edges. */
typedef uint8_t diagonal_table[3][16][2][EDGES][EDGES];

/* The edge's number in the lower cell's terms: that of the upper cell's lower face is its upper face. */
static void note_diagonals(const cells_mesh* mesh, const cells_choice* choice, diagonal_table used)
{
  for (int face = 0; face < 6; ++face)
  {
    int above = 0;
    for (int corner = 0, n = 0; corner < 8; ++corner)
    {
      if ((corner >> face / 2 & 1) == (face & 1))
      {
        above |= corner_above(choice->cube_case, corner) << n++;
      }
    }
    for (int a = 0; a < EDGES; ++a)
    {
      for (int b = 0; b < EDGES; ++b)
      {
        if (in_face(a, face) && in_face(b, face) && mesh->directed[a][b] && mesh->directed[b][a])
        {
          const int upper = 1 << face / 2;
          used[face / 2][above][face & 1][a | upper][b | upper] = 1;
        }
      }
    }
  }
}

/* If two cells share a face, at most one has a diagonal between the same two vertices there,
 * whatever is decided. So no side has more than two triangles, and fans around an edge's vertex
 * meet in their ends alone: with the above, any cells fit together. */
static void check_diagonals(diagonal_table used)
{
  int some = 0;
  for (int i = 0; i < 3 * 16 * EDGES * EDGES; ++i)
  {
    const int axis = i / EDGES / EDGES / 16, above = i / EDGES / EDGES % 16, a = i / EDGES % EDGES,
              b = i % EDGES;
    CORE_CHECK(!(used[axis][above][0][a][b] && used[axis][above][1][a][b]),
      "axis %d, corners %x: both cells have the diagonal %d-%d", axis, above, a, b);
    some += used[axis][above][0][a][b] || used[axis][above][1][a][b];
  }
  assert_true(some > 0);
}

static void test_single_cells(void** state)
{
  static diagonal_table used;
  cells_choice rows[256];
  int checked = 0;
  for (int cube_case = 0; cube_case < 256; ++cube_case)
  {
    const int count = case_rows(*state, cube_case, rows);
    for (int i = 0; i < count; ++i)
    {
      cells_mesh mesh = { .count = 0 };
      add_row(&mesh, rows[i].row);
      check_sides(&mesh, rows + i);
      check_shape(&mesh, rows + i);
      check_fans(&mesh, rows + i);
      note_diagonals(&mesh, rows + i, used);
      ++checked;
    }
  }
  assert_int_equal(checked, ((mcor_topology_table*)*state)->row_count);
  check_diagonals(used);
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
    const int count = case_rows(*state, c, rows);
    for (int i = 0; i < count; ++i)
    {
      const int loops = count_loops(c, rows[i].joined), tunnel = rows[i].tunnel < 2;
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
