/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests the triangles of a cell: by the case table, for all decisions on faces and tunnels, and beside finer cells.
 * Cells side by side, with random nodes, must make a closed surface. */

#include "core_fixture.h"
#include "mcor_adaptive_cell.h"

/* A lattice with `ends` nodes along each axis. above: which nodes are above iso; nodes on the lattice's border are
 * below. vertex: for each node and axis, the number of the vertex on the edge that begins at the node. */
typedef struct lattice
{
  int ends;
  uint8_t* above;
  int32_t* vertex; /* [nodes][3], -1: none */
  double* points;
  int32_t* triangles;
  int64_t point_count, triangle_count;
} lattice;

static int node_at(const lattice* l, int x, int y, int z)
{
  return (z * l->ends + y) * l->ends + x;
}

/* Makes a lattice whose nodes change side every `pitch` nodes near z = 0, and less regularly at greater z. So cells of
 * all cases occur, many of them ambiguous. */
static lattice make_lattice(int ends, int pitch, uint64_t seed)
{
  const size_t nodes = (size_t)ends * (size_t)ends * (size_t)ends, cells = 12 * nodes;
  lattice l = { .ends = ends,
    .above = calloc(nodes, 1),
    .vertex = malloc(3 * nodes * sizeof(int32_t)),
    .points = malloc(3 * 3 * nodes * sizeof(double)),
    .triangles = malloc(3 * cells * sizeof(int32_t)) };
  assert_true(l.above && l.vertex && l.points && l.triangles);
  memset(l.vertex, -1, 3 * nodes * sizeof(int32_t));
  for (int n = 0; n < (int)nodes; ++n)
  {
    const int x = n % ends, y = n / ends % ends, z = n / ends / ends;
    const int border =
      x == 0 || y == 0 || z == 0 || x == ends - 1 || y == ends - 1 || z == ends - 1;
    const int other = random_unit(&seed) < 0.5 * z / ends;
    l.above[n] = !border && (((x ^ y ^ z) / pitch & 1) ^ other);
  }
  return l;
}

/* Returns the vertex on the edge from a node along an axis. A new vertex gets a random place. */
static int32_t vertex_on(lattice* l, int node, int axis, int length)
{
  int32_t* vertex = l->vertex + 3 * (size_t)node + axis;
  if (*vertex < 0)
  {
    uint64_t seed = 3 * (uint64_t)node + (uint64_t)axis;
    double* x = l->points + 3 * l->point_count;
    *vertex = (int32_t)l->point_count++;
    for (int a = 0; a < 3; ++a)
    {
      x[a] = a == 0 ? node % l->ends : a == 1 ? node / l->ends % l->ends : node / l->ends / l->ends;
    }
    x[axis] += length * (0.1 + 0.8 * random_unit(&seed));
  }
  return *vertex;
}

/* Fails unless the triangles are an oriented closed manifold that encloses more than 0.4 of volume_above. volume_above:
 * the volume of one cell for each node above iso; around a lone node the surface encloses less than a cell. Frees the
 * lattice. */
static void check_closed(lattice* l, double volume_above)
{
  const mcor_surface surface = { .points = l->points,
    .point_count = l->point_count,
    .triangles = l->triangles,
    .triangle_count = l->triangle_count };
  CORE_REPORT report = core_check_mesh(&surface);
  assert_int_equal(report.boundary_edges, 0);
  CORE_CHECK(report.volume > 0.4 * volume_above, report.triangles, report.volume, volume_above);
  free(l->above);
  free(l->vertex);
  free(l->points);
  free(l->triangles);
}

/* ---- the case table ---- */

static mcor_case_table table;

static int set_up(void** state)
{
  mcor_make_case_table(&table);
  return 0;
}

/* Returns the number of the edge from a corner along an axis: axis << 3 | lower corner. */
static int edge_of(int corner, int axis)
{
  return axis << 3 | (corner & ~(1 << axis));
}

static int crossed_edges(int cube_case)
{
  int count = 0;
  for (int i = 0; i < 24; ++i)
  {
    const int corner = i % 8, axis = i / 8;
    count +=
      !(corner >> axis & 1) && ((cube_case >> corner ^ cube_case >> (corner | 1 << axis)) & 1);
  }
  return count;
}

/* Checks ambiguous faces. If a face's bit in `joined` is set, its corners above iso are joined, so one triangle side
 * must cut off each corner below iso. Else one triangle side must cut off each corner above iso. */
static void check_faces(int cube_case, int joined, const mcor_cell_row* row)
{
  uint8_t side[24][24] = { { 0 } };
  for (int i = 0; i < 3 * row->triangles; ++i)
  {
    ++side[row->edges[i]][row->edges[i % 3 == 2 ? i - 2 : i + 1]];
  }
  for (int i = 0; i < 48; ++i)
  {
    const int face = i / 8, corner = i % 8, u = (face / 2 + 1) % 3, v = (face / 2 + 2) % 3;
    if ((table.cases[cube_case] >> face & 1) && (corner >> face / 2 & 1) == (face & 1) &&
      (cube_case >> corner & 1) != (joined >> face & 1))
    {
      const int a = edge_of(corner, u), b = edge_of(corner, v);
      CORE_CHECK(side[a][b] + side[b][a] == 1, cube_case, joined, corner, face);
    }
  }
}

/* Chooses a row of the table (a way to triangulate) for a case, at random with or without a tunnel, and checks the row.
 * Two loops with a and b sides have a + b - 4 triangles without a tunnel, and a + b with a tunnel. */
static const mcor_cell_row* choose_row(int cube_case, int joined, uint64_t* seed)
{
  const mcor_cell_row* first = table.rows + (table.cases[cube_case] >> 6);
  int number = 0, bit = 1;
  for (int face = 0; face < 6; ++face)
  {
    number |= joined >> face & 1 ? bit : 0;
    bit <<= table.cases[cube_case] >> face & 1;
  }
  const mcor_cell_row* row = first + number;
  const int loops = (crossed_edges(cube_case) - row->triangles) / 2;
  const int tunnels = (row->tunnel[0] > 0) + (row->tunnel[1] > 0);
  const uint64_t way = random_bits(seed) % 3;
  const int tunnel = way < 2 ? row->tunnel[way] : 0;
  CORE_CHECK(loops == 2 ? tunnels == 1 : loops > 2 || tunnels == 0, cube_case, joined, tunnels);
  CORE_CHECK(tunnel == 0 || first[tunnel].triangles == row->triangles + 4, cube_case, joined);
  check_faces(cube_case, joined, row);
  return tunnel > 0 ? first + tunnel : row;
}

/* Makes and checks the triangles of all cells, with random decisions on faces and tunnels. Marks in `used` which rows
 * of the case table the cells take. */
static void fill_by_table(lattice* l, uint64_t seed, uint8_t used[MCOR_CASE_ROWS])
{
  const int n = l->ends;
  const uint64_t of_round = seed << 40;
  double volume = 0;
  for (int c = 0; c < n * n * n; ++c)
  {
    const int at[3] = { c % n, c / n % n, c / n / n };
    int cube_case = 0, joined = 0, node[8];
    volume += l->above[c];
    if (at[0] == n - 1 || at[1] == n - 1 || at[2] == n - 1)
    {
      continue;
    }
    for (int k = 0; k < 8; ++k)
    {
      node[k] = node_at(l, at[0] + (k & 1), at[1] + (k >> 1 & 1), at[2] + (k >> 2));
      cube_case |= l->above[node[k]] << k;
    }
    for (int face = 0; face < 6; ++face)
    {
      /* The random decision depends on the face's lowest node, so that both cells at the face make
       * the same decision. */
      uint64_t chance = of_round + (uint64_t)(3 * node[(face & 1) << face / 2] + face / 2);
      joined |= (int)(random_bits(&chance) & (uint64_t)table.cases[cube_case] >> face & 1) << face;
    }
    const mcor_cell_row* row = choose_row(cube_case, joined, &seed);
    used[row - table.rows] = 1;
    for (int i = 0; i < 3 * row->triangles; ++i)
    {
      l->triangles[3 * l->triangle_count + i] =
        vertex_on(l, node[row->edges[i] & 7], row->edges[i] >> 3, 1);
    }
    l->triangle_count += row->triangles;
  }
  check_closed(l, volume);
}

/* Checks that the cells of random lattices make closed surfaces, and use all rows of the table. */
static void test_whole_table(void** state)
{
  static uint8_t used[MCOR_CASE_ROWS];
  for (int round = 0; round < 2; ++round)
  {
    lattice l = make_lattice(64, 1, (uint64_t)round);
    fill_by_table(&l, (uint64_t)round, used);
  }
  for (int r = 0; r < table.row_count; ++r)
  {
    CORE_CHECK(used[r], r);
  }
}

/* A cell without finer cells around it must get the triangles of its case's first row, which joins no nodes above iso
 * across a face and has no tunnel. If only two opposite corners are above iso, the case has a second row, with a tunnel
 * between these corners. */
static void test_first_rows(void** state)
{
  for (int c = 0; c < 256; ++c)
  {
    const mcor_cell_row* row = table.rows + (table.cases[c] >> 6);
    uint8_t triangles[3 * MCOR_ADAPTIVE_TRIANGLES];
    /* Bits of some nodes between corners are set, though only corners exist here: these bits must not matter. */
    uint32_t above = 0x2aaaaaa;
    int flat = 0;
    for (int k = 0; k < 8; ++k)
    {
      const int node = 2 * (k & 1) + 6 * (k >> 1 & 1) + 18 * (k >> 2);
      above = (above & ~(1u << node)) | (uint32_t)(c >> k & 1) << node;
    }
    assert_int_equal(mcor_adaptive_triangulate(0, above, triangles, &flat), row->triangles);
    for (int i = 0; i < 3 * row->triangles; ++i)
    {
      const int k = row->edges[i] & 7, axis = row->edges[i] >> 3;
      assert_int_equal(triangles[i], axis << 5 | (2 * (k & 1) + 6 * (k >> 1 & 1) + 18 * (k >> 2)));
    }
  }
  const mcor_cell_row* opposite = table.rows + (table.cases[0x81] >> 6);
  assert_int_equal(opposite->tunnel[0], 0);
  assert_int_equal((opposite + opposite->tunnel[1])->triangles, 6);
}

/* ---- cells beside finer ones ---- */

/* Checks side a, b of the triangles a, b, c and b, a, d of a cell. If the side lies in an undivided face or a quarter
 * of a divided face, both triangles must lie in this face, because the cell beyond may have the side, too. Unit: half
 * cells. */
static void check_inner_side(
  const double* a, const double* b, const double* c, const double* d, uint32_t split)
{
  for (int face = 0; face < 6; ++face)
  {
    static const int stride[3] = { 1, 3, 9 };
    const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double at = 2 * (face & 1);
    if (a[axis] != at || b[axis] != at)
    {
      continue;
    }
    const int divided = split >> (13 + (face & 1 ? 1 : -1) * stride[axis]) & 1;
    const int in_one = !divided || ((a[u] - 1) * (b[u] - 1) >= 0 && (a[v] - 1) * (b[v] - 1) >= 0);
    CORE_CHECK(!in_one || (c[axis] == at && d[axis] == at), split, face);
  }
}

static void check_inner_sides(
  const lattice* l, const int at[3], int step, uint32_t split, const int32_t* triangles, int count)
{
  double x[3 * MCOR_ADAPTIVE_TRIANGLES][3];
  for (int i = 0; i < 9 * count; ++i)
  {
    x[i / 3][i % 3] = (l->points[3 * triangles[i / 3] + i % 3] - at[i % 3]) * 2 / step;
  }
  for (int i = 0; i < 9 * count * count; ++i)
  {
    const int m = i / (3 * count), n = i % (3 * count);
    const int next = m - m % 3 + (m + 1) % 3, after = n - n % 3 + (n + 1) % 3;
    if (triangles[m] == triangles[after] && triangles[next] == triangles[n])
    {
      check_inner_side(
        x[m], x[next], x[m - m % 3 + (m + 2) % 3], x[n - n % 3 + (n + 2) % 3], split);
    }
  }
}

/* Adds the triangles of a cell of edge `step`. split: which middles of the cell's edges and faces are nodes. */
static void add_adaptive(lattice* l, const int at[3], int step, uint32_t split)
{
  static const int stride[3] = { 1, 3, 9 };
  uint8_t triangles[3 * MCOR_ADAPTIVE_TRIANGLES];
  uint32_t above = 0;
  int node[27], flat = 0;
  for (int n = 0; n < 27; ++n)
  {
    node[n] =
      node_at(l, at[0] + n % 3 * step / 2, at[1] + n / 3 % 3 * step / 2, at[2] + n / 9 * step / 2);
    above |= (uint32_t)l->above[node[n]] << n; /* bits of places that are no nodes do not matter */
  }
  const int count = mcor_adaptive_triangulate(split, above, triangles, &flat);
  assert_in_range(count, 0, MCOR_ADAPTIVE_TRIANGLES);
  for (int i = 0; i < 3 * count; ++i)
  {
    const int axis = triangles[i] >> 5, low = triangles[i] & 31, next = low + stride[axis];
    const int middle = low / stride[axis] % 3 == 1 || (split >> next & 1);
    l->triangles[3 * l->triangle_count + i] =
      vertex_on(l, node[low], axis, middle ? step / 2 : step);
  }
  check_inner_sides(l, at, step, split, l->triangles + 3 * l->triangle_count, count);
  l->triangle_count += count;
}

/* Returns which middles of a cell's edges and faces are nodes: the ones that a divided cell touches. */
static uint32_t find_split(const uint8_t* divided, int cells, const int cell[3])
{
  uint32_t split = 0;
  for (int n = 0; n < 27; ++n)
  {
    const int place[3] = { n % 3, n / 3 % 3, n / 9 };
    const int middles = (place[0] == 1) + (place[1] == 1) + (place[2] == 1);
    for (int touching = 0; touching < 8 && (middles == 1 || middles == 2); ++touching)
    {
      int index = 0, inside = 1;
      for (int a = 2; a >= 0; --a)
      {
        const int by = touching >> a & 1 ? place[a] - 1 : 0;
        inside = inside && cell[a] + by >= 0 && cell[a] + by < cells;
        index = index * cells + cell[a] + by;
      }
      split |= (uint32_t)(inside && divided[index]) << n;
    }
  }
  return split;
}

/* Checks closed surfaces on lattices where few or many cells are divided into eight, so that the other cells have all
 * kinds of split faces and edges. */
static void test_beside_finer(void** state)
{
  enum
  {
    N = 32,
    ENDS = 2 * N + 1
  };
  for (int round = 0; round < 4; ++round)
  {
    static uint8_t divided[N * N * N];
    lattice l = make_lattice(ENDS, 2, (uint64_t)round);
    uint64_t seed = (uint64_t)round;
    for (int c = 0; c < N * N * N; ++c)
    {
      divided[c] = random_unit(&seed) < 0.08 * (1 << round) - 0.07;
    }
    double volume = 0;
    for (int c = 0; c < N * N * N; ++c)
    {
      const int cell[3] = { c % N, c / N % N, c / N / N };
      const int at[3] = { 2 * cell[0], 2 * cell[1], 2 * cell[2] };
      volume += l.above[node_at(&l, at[0], at[1], at[2])] * 8;
      for (int part = 0; part < 8 && divided[c]; ++part)
      {
        const int child[3] = { at[0] + (part & 1), at[1] + (part >> 1 & 1), at[2] + (part >> 2) };
        add_adaptive(&l, child, 1, 0);
      }
      divided[c] ? (void)0 : add_adaptive(&l, at, 2, find_split(divided, N, cell));
    }
    check_closed(&l, volume);
  }
}

CORE_MAIN(set_up, NULL, test_first_rows, test_whole_table, test_beside_finer)
