/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The 256 cases of Marching Cubes, exhaustively: each alone, and all pairs that share a face. */

#include "core_fixture.h"

#include <string.h>

typedef uint8_t case_table[256][16];

static int set_up(void** state)
{
  static case_table table;
  mcor_make_case_table(table);
  *state = table;
  return 0;
}

static int corner_above(int cube_case, int corner)
{
  return cube_case >> corner & 1;
}

/* Lower and upper corner of edge axis << 3 | lower corner. */
static int lower_corner(int edge)
{
  return edge & 7;
}

static int upper_corner(int edge)
{
  return (edge & 7) | 1 << (edge >> 3);
}

static int is_edge(int edge)
{
  return edge >> 3 < 3 && !(edge >> (edge >> 3) & 1);
}

/* Which of the triangles' edges occur are exactly the crossed ones. */
static void test_edges_are_crossed(void** state)
{
  case_table* table = (case_table*)*state;
  for (int c = 0; c < 256; ++c)
  {
    const uint8_t* row = (*table)[c];
    int used[24] = { 0 };
    CORE_CHECK(row[15] <= 5, "case %d has %d triangles", c, row[15]);
    for (int i = 0; i < 3 * row[15]; ++i)
    {
      CORE_CHECK(is_edge(row[i]), "case %d names edge %d", c, row[i]);
      ++used[row[i]];
    }
    for (int t = 0; t < row[15]; ++t)
    {
      const uint8_t* e = row + 3 * t;
      CORE_CHECK(e[0] != e[1] && e[1] != e[2] && e[2] != e[0], "case %d, triangle %d", c, t);
    }
    for (int e = 0; e < 24; ++e)
    {
      const int crossed =
        is_edge(e) && corner_above(c, lower_corner(e)) != corner_above(c, upper_corner(e));
      CORE_CHECK(
        (used[e] > 0) == crossed, "case %d: edge %d, crossed %d, used %d", c, e, crossed, used[e]);
    }
  }
}

/* A number for an edge of one of two cells side by side along `axis`, equal for common edges. */
static int edge_of_pair(int edge, int axis, int second)
{
  const int c = lower_corner(edge);
  int at[3] = { c & 1, c >> 1 & 1, c >> 2 };
  at[axis] += second;
  return (edge >> 3) * 27 + at[0] * 9 + at[1] * 3 + at[2];
}

/* Whether both edges lie in a common face of their cell: axis * 2 + side, or -1. */
static int common_face(int a, int b)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    if (a >> 3 != axis && b >> 3 != axis && (a >> axis & 1) == (b >> axis & 1))
    {
      return axis * 2 + (a >> axis & 1);
    }
  }
  return -1;
}

/* directed[a][b]: how many triangles go from edge a to edge b. */
static void add_triangles(
  const uint8_t* row, int axis, int second, uint8_t directed[81][81], uint8_t in_face[81][81])
{
  for (int i = 0; i < 3 * row[15]; ++i)
  {
    const int from = row[i], to = row[i % 3 == 2 ? i - 2 : i + 1];
    const int a = edge_of_pair(from, axis, second), b = edge_of_pair(to, axis, second);
    const int face = common_face(from, to);
    const int inner = face == axis * 2 + !second;
    ++directed[a][b];
    in_face[a][b] = in_face[b][a] = (uint8_t)(face < 0 || inner ? 0 : 1);
  }
}

/* Every side of a triangle is matched by one opposite side, or lies in an outer face. */
static void check_pair(case_table* table, int axis, int pattern)
{
  static uint8_t directed[81][81], in_face[81][81];
  int first = 0, second = 0;
  for (int c = 0; c < 8; ++c)
  {
    /* Corners of the pair: 4 on each of 3 layers along the axis. */
    const int layer = c >> axis & 1;
    const int u = c >> (axis + 1) % 3 & 1, v = c >> (axis + 2) % 3 & 1;
    first |= (pattern >> (4 * layer + 2 * u + v) & 1) << c;
    second |= (pattern >> (4 * layer + 4 + 2 * u + v) & 1) << c;
  }
  memset(directed, 0, sizeof directed);
  memset(in_face, 0, sizeof in_face);
  add_triangles((*table)[first], axis, 0, directed, in_face);
  add_triangles((*table)[second], axis, 1, directed, in_face);
  for (int a = 0; a < 81; ++a)
  {
    for (int b = 0; b < 81; ++b)
    {
      CORE_CHECK(directed[a][b] <= 1, "axis %d, cases %d and %d: side %d-%d used %d times", axis,
        first, second, a, b, directed[a][b]);
      CORE_CHECK(
        in_face[a][b] ? directed[a][b] + directed[b][a] == 1 : directed[a][b] == directed[b][a],
        "axis %d, cases %d and %d: side %d-%d is open, or a diagonal in a face", axis, first,
        second, a, b);
    }
  }
}

static void test_pairs_are_watertight(void** state)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int pattern = 0; pattern < 4096; ++pattern)
    {
      check_pair((case_table*)*state, axis, pattern);
    }
  }
}

/* The volume on the side of the normals: with vertices at the middle of edges, each triangle's
 * normal looks from its corners above to those below. */
static void test_orientation(void** state)
{
  case_table* table = (case_table*)*state;
  for (int c = 1; c < 255; ++c)
  {
    const uint8_t* row = (*table)[c];
    for (int t = 0; t < row[15]; ++t)
    {
      double p[3][3], n[3], towards = 0;
      for (int k = 0; k < 3; ++k)
      {
        const int low = lower_corner(row[3 * t + k]), high = upper_corner(row[3 * t + k]);
        for (int a = 0; a < 3; ++a)
        {
          p[k][a] = 0.5 * ((low >> a & 1) + (high >> a & 1));
        }
      }
      for (int a = 0; a < 3; ++a)
      {
        const int u = (a + 1) % 3, v = (a + 2) % 3;
        n[a] =
          (p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) - (p[1][v] - p[0][v]) * (p[2][u] - p[0][u]);
      }
      for (int k = 0; k < 3; ++k)
      {
        const int e = row[3 * t + k], falls = corner_above(c, lower_corner(e));
        towards += falls ? n[e >> 3] : -n[e >> 3];
      }
      CORE_CHECK(towards > 0, "case %d, triangle %d faces the corners above", c, t);
    }
  }
}

/* One corner above: one triangle; complements have as many vertices. */
static void test_simple_cases(void** state)
{
  case_table* table = (case_table*)*state;
  assert_int_equal((*table)[0][15], 0);
  assert_int_equal((*table)[255][15], 0);
  for (int corner = 0; corner < 8; ++corner)
  {
    assert_int_equal((*table)[1 << corner][15], 1);
    assert_int_equal((*table)[255 ^ (1 << corner)][15], 1);
  }
  assert_int_equal((*table)[0x0f][15], 2);
  assert_int_equal((*table)[0x33][15], 2);
  assert_int_equal((*table)[0x55][15], 2);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_edges_are_crossed),
    cmocka_unit_test(test_pairs_are_watertight), cmocka_unit_test(test_orientation),
    cmocka_unit_test(test_simple_cases) };
  return cmocka_run_group_tests_name("case_table", tests, set_up, NULL);
}
