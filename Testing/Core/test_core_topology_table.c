/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The topology table, exhaustively: all cases with all decisions on faces and inside; all pairs of
 * cells; all fours of cells around an edge. What must be is derived from the corners alone. */

#include "core_fixture.h"

#include <stdlib.h>
#include <string.h>

static int set_up(void** state)
{
  static mcor_topology_table table;
  mcor_make_topology_table(&table);
  *state = &table;
  return 0;
}

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

/* The edge that the surface connects with `edge` in a face: the other one that is crossed; of three,
 * the one around the same corner above, or below where those above are joined. */
static int partner(int cube_case, int joined, int face, int edge)
{
  int crossed[4];
  const int count = face_crossings(cube_case, face, crossed);
  const int lower_is_above = corner_above(cube_case, lower_corner(edge));
  const int around = lower_is_above != (joined >> face & 1) ? lower_corner(edge) : upper_corner(edge);
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

/* ---- rows ----------------------------------------------------------------------------------- */

typedef struct row_choice
{
  int cube_case, joined;
  int tunnel; /* 0 below, 1 above, 2 none */
  const mcor_cell_row* row;
} row_choice;

/* All rows of a case; returns their number. */
static int case_rows(const mcor_topology_table* table, int cube_case, row_choice rows[256])
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
        rows[count++] = (row_choice){ cube_case, joined, tunnel, first + other };
      }
    }
  }
  return count;
}

/* Loops of the face segments: how many, each traced once. */
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

/* ---- triangles ------------------------------------------------------------------------------ */

/* Edges of a few cells are numbered in a lattice of 3 x 3 x 3 nodes. */
#define EDGES 81

typedef struct complex
{
  int count; /* of triangles */
  int corner[64][3];
  uint8_t directed[EDGES][EDGES]; /* triangles that go from one edge's vertex to the other's */
} complex;

static int edge_number(int edge, const int cell[3])
{
  const int c = lower_corner(edge);
  return (edge >> 3) * 27 + (cell[0] + (c & 1)) * 9 + (cell[1] + (c >> 1 & 1)) * 3 + cell[2] + (c >> 2);
}

static void add_row(complex* mesh, const mcor_cell_row* row, const int cell[3])
{
  for (int t = 0; t < row->triangles; ++t)
  {
    int* corner = mesh->corner[mesh->count++];
    for (int k = 0; k < 3; ++k)
    {
      corner[k] = edge_number(row->edges[3 * t + k], cell);
    }
    for (int k = 0; k < 3; ++k)
    {
      ++mesh->directed[corner[k]][corner[(k + 1) % 3]];
    }
  }
}

/* Takes all triangles out again; much faster than to clear everything. */
static void clear_complex(complex* mesh)
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

/* Walks the link of a vertex, against the triangles' direction until its begin, then along it. Returns
 * its length if it is one simple path or circle through all triangles of the vertex, else -1. */
static int walk_link(const complex* mesh, int vertex, int link[64])
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

/* ---- one cell ------------------------------------------------------------------------------- */

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

static void check_sides(const complex* mesh, const row_choice* choice)
{
  static const int origin[3] = { 0, 0, 0 };
  for (int e = 0; e < 24; ++e)
  {
    for (int f = 0; f < 24; ++f)
    {
      if (!is_crossed(choice->cube_case, e) || !is_crossed(choice->cube_case, f) || e == f)
      {
        continue;
      }
      const int a = edge_number(e, origin), b = edge_number(f, origin);
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
static void check_shape(const complex* mesh, const row_choice* choice)
{
  static const int origin[3] = { 0, 0, 0 };
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
      const int v = edge_number(e, origin);
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
static void check_fans(const complex* mesh, const row_choice* choice)
{
  static const int origin[3] = { 0, 0, 0 };
  for (int e = 0; e < 24; ++e)
  {
    int link[64], ends = 0;
    if (!is_crossed(choice->cube_case, e))
    {
      continue;
    }
    const int length = walk_link(mesh, edge_number(e, origin), link);
    CORE_CHECK(length >= 2, "case %d, joined %x, tunnel %d: edge %d has no fan", choice->cube_case,
      choice->joined, choice->tunnel, e);
    for (int face = 0; face < 6; ++face)
    {
      if (in_face(e, face))
      {
        const int end =
          edge_number(partner(choice->cube_case, choice->joined, face, e), origin);
        ends += link[0] == end || link[length - 1] == end;
      }
    }
    CORE_CHECK(ends == 2, "case %d, joined %x, tunnel %d: the fan of edge %d", choice->cube_case,
      choice->joined, choice->tunnel, e);
  }
}

static void test_single_cells(void** state)
{
  static complex mesh;
  static const int origin[3] = { 0, 0, 0 };
  row_choice rows[256];
  int checked = 0;
  for (int cube_case = 0; cube_case < 256; ++cube_case)
  {
    const int count = case_rows(*state, cube_case, rows);
    for (int i = 0; i < count; ++i)
    {
      add_row(&mesh, rows[i].row, origin);
      check_sides(&mesh, rows + i);
      check_shape(&mesh, rows + i);
      check_fans(&mesh, rows + i);
      clear_complex(&mesh);
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
  row_choice rows[256];
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

/* ---- two cells ------------------------------------------------------------------------------ */

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
static void check_two_cells(const complex* mesh, const row_choice* first, const row_choice* second, int axis)
{
  int open = 0, expected = 0, crossed[4], link[64];
  for (int t = 0; t < mesh->count; ++t)
  {
    for (int k = 0; k < 3; ++k)
    {
      const int a = mesh->corner[t][k], b = mesh->corner[t][(k + 1) % 3];
      CORE_CHECK(mesh->directed[a][b] == 1, "axis %d, cases %d and %d, joined %x and %x: side %d-%d",
        axis, first->cube_case, second->cube_case, first->joined, second->joined, a, b);
      open += !mesh->directed[b][a];
    }
  }
  for (int face = 0; face < 6; ++face)
  {
    expected +=
      face == 2 * axis + 1 ? 0 : face_crossings(first->cube_case, face, crossed) / 2;
    expected += face == 2 * axis ? 0 : face_crossings(second->cube_case, face, crossed) / 2;
  }
  CORE_CHECK(open == expected, "axis %d, cases %d and %d, joined %x and %x: %d open sides, not %d",
    axis, first->cube_case, second->cube_case, first->joined, second->joined, open, expected);
  static const int origin[3] = { 0, 0, 0 };
  const int count = face_crossings(first->cube_case, 2 * axis + 1, crossed);
  for (int i = 0; i < count; ++i)
  {
    CORE_CHECK(walk_link(mesh, edge_number(crossed[i], origin), link) > 0,
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
  static complex mesh;
  row_choice rows[2][256];
  for (int axis = 0; axis < 3; ++axis)
  {
    int cells[2][3] = { { 0, 0, 0 }, { 0, 0, 0 } }, size[3] = { 2, 2, 2 };
    cells[1][axis] = 1;
    size[axis] = 3;
    for (uint32_t pattern = 0; pattern < 4096; ++pattern)
    {
      const uint32_t above = spread_nodes(pattern, size);
      const int count[2] = { case_rows(*state, case_at(above, cells[0]), rows[0]),
        case_rows(*state, case_at(above, cells[1]), rows[1]) };
      for (int i = 0; i < count[0] * count[1]; ++i)
      {
        const row_choice *first = rows[0] + i / count[1], *second = rows[1] + i % count[1];
        if ((first->joined >> (2 * axis + 1) & 1) == (second->joined >> (2 * axis) & 1))
        {
          add_row(&mesh, first->row, cells[0]);
          add_row(&mesh, second->row, cells[1]);
          check_two_cells(&mesh, first, second, axis);
          clear_complex(&mesh);
        }
      }
    }
  }
}

/* ---- four cells around an edge -------------------------------------------------------------- */

/* What all rows of a case put around the vertex of an edge. A decision matters here only if it
 * concerns one of the edge's two faces; all others, and tunnels, are taken together. */
typedef struct fan_set
{
  int end[2]; /* by side of the fan: first and last vertex of the link, as edges of the cell */
  uint32_t inner; /* all other vertices of the link that occur in any row */
} fan_set;

/* fans[case][edge][whether joined: first face, second face]; faces ascending. */
typedef fan_set fan_table[256][24][2][2];

static void edge_faces(int edge, int faces[2])
{
  int count = 0;
  for (int face = 0; face < 6; ++face)
  {
    if (in_face(edge, face))
    {
      faces[count++] = face;
    }
  }
}

static void fill_fans(const row_choice* choice, fan_set fans[24][2][2])
{
  static complex mesh;
  static const int origin[3] = { 0, 0, 0 };
  int edge_of[EDGES];
  for (int e = 0; e < 24; ++e)
  {
    edge_of[edge_number(e, origin)] = e;
  }
  add_row(&mesh, choice->row, origin);
  for (int e = 0; e < 24; ++e)
  {
    int faces[2], link[64];
    if (!is_crossed(choice->cube_case, e))
    {
      continue;
    }
    edge_faces(e, faces);
    const int length = walk_link(&mesh, edge_number(e, origin), link);
    fan_set* set = &fans[e][choice->joined >> faces[0] & 1][choice->joined >> faces[1] & 1];
    assert_true(length >= 2);
    set->end[0] = edge_of[link[0]];
    set->end[1] = edge_of[link[length - 1]];
    for (int i = 1; i < length - 1; ++i)
    {
      set->inner |= 1u << edge_of[link[i]];
    }
  }
  clear_complex(&mesh);
}

static fan_table* make_fans(const mcor_topology_table* table)
{
  static fan_table fans;
  row_choice rows[256];
  for (int c = 0; c < 256; ++c)
  {
    const int count = case_rows(table, c, rows);
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
    if (set >> e & 1 && in_face(e, face))
    {
      /* At most 64 numbers, as the lattice has two layers of nodes. */
      const int number = edge_number(e, cell);
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
    const int j = (i + 1) % 4, mine = face_towards(cells, i, 1), theirs = face_towards(cells, j, -1);
    const uint32_t ends[2] = { 1u << fan[i]->end[0] | 1u << fan[i]->end[1],
      1u << fan[j]->end[0] | 1u << fan[j]->end[1] };
    const uint64_t end = numbers_in_face(ends[0], mine, cells[i], axis);
    const uint64_t inner[2] = { numbers_in_face(fan[i]->inner, mine, cells[i], axis),
      numbers_in_face(fan[j]->inner, theirs, cells[j], axis) };
    CORE_CHECK(end != 0 && (end & (end - 1)) == 0 &&
        end == numbers_in_face(ends[1], theirs, cells[j], axis),
      "axis %d, nodes %x, joined %x: the fans of cells %d and %d do not meet", axis, above, joined, i, j);
    CORE_CHECK((inner[0] & inner[1]) == 0 && ((inner[0] | inner[1]) & end) == 0,
      "axis %d, nodes %x, joined %x: the fans of cells %d and %d overlap", axis, above, joined, i, j);
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
          (face_crossings(case_at(above, cells[i]), face_towards(cells, i, 1), crossed) == 4) << i;
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
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_single_cells),
    cmocka_unit_test(test_first_rows), cmocka_unit_test(test_tunnels),
    cmocka_unit_test(test_two_cells), cmocka_unit_test(test_four_cells) };
  return cmocka_run_group_tests_name("topology_table", tests, set_up, NULL);
}
