/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests MCOR_TOPOLOGY_FIELD, with which the field decides how nodes are connected. The particles here form bridges and
 * gaps of known shape; the oracle's tests use noise. */

#include "core_fixture.h"
#include "mcor_vector.h"

/* Makes particles of spacing 0.5 around end / 2. The scalar is sign * value(x, end). */
static particle_set make_particles(
  double (*value)(const double x[3], const double end[3]), const double end[3], double sign)
{
  enum
  {
    N = 24
  };
  const double spacing = 0.5;
  particle_set set = particle_set_make(N * N * N);
  for (int i = 0; i < N * N * N; ++i)
  {
    double* x = set.position + 3 * i;
    const int at[3] = { i % N, i / N % N, i / N / N };
    for (int a = 0; a < 3; ++a)
    {
      x[a] = spacing * (at[a] - 0.5 * (N - 1)) + 0.5 * end[a];
    }
    set.smoothing_length[i] = 1.3 * spacing;
    set.volume[i] = spacing * spacing * spacing;
    set.scalar[i] = sign * value(x, end);
  }
  return set;
}

/* Returns a scalar that is above 0 in a straight thread, thinner than a cube, from the origin to `end`. */
static double thread(const double x[3], const double end[3])
{
  const double along = fmin(fmax(mcor_dot(x, end) / mcor_dot(end, end), 0), 1);
  const double d[3] = { x[0] - along * end[0], x[1] - along * end[1], x[2] - along * end[2] };
  return 1.2 * 1.2 - mcor_dot(d, d);
}

/* Returns a scalar that is above 0 in two balls, around the origin and `end`, that do not touch. */
static double balls(const double x[3], const double end[3])
{
  double d[3];
  mcor_subtract(x, end, d);
  return 1.2 * 1.2 - fmin(mcor_dot(x, x), mcor_dot(d, d));
}

/* Extracts a surface, checks that each of its parts is closed and has no handle, and returns the number of parts. */
static int64_t count_parts(mcor_context* context, const particle_set* set, double cube,
  mcor_topology topology, mcor_statistics* statistics)
{
  const double iso = 0;
  const mcor_input input = core_input(set);
  mcor_options options = core_options(&iso);
  options.cube_size = cube;
  options.topology = topology;
  CORE_SURFACE surface = core_extract(context, &input, &options);
  CORE_REPORT report = core_check_mesh(&surface);
  const int64_t parts = report.components;
  *statistics = surface.statistics;
  CORE_CHECK(report.boundary_edges == 0 && report.euler == 2 * parts, report.boundary_edges, parts,
    report.euler);
  return parts;
}

/* The diagonals of a cube's faces and of the cube itself. */
static const double diagonals[][3] = { { 3, 3, 0 }, { 3, -3, 0 }, { 3, 0, 3 }, { -3, 0, 3 },
  { 0, 3, 3 }, { 0, -3, 3 }, { 3, 3, 3 }, { -3, 3, 3 }, { 3, -3, 3 }, { 3, 3, -3 } };

/* With MCOR_TOPOLOGY_FIELD, a thread stays whole and balls that do not touch stay apart, above or below iso, as on a
 * fine lattice. The case table always joins nodes below iso across a face, and keeps nodes above iso apart. The
 * expected numbers are counted by hand: ambiguous faces (the face that the diagonal crosses, between two cells); faces
 * whose nodes above iso are joined; cells with two loops; tunnels. */
static void test_diagonals(void** state)
{
  for (int i = 0; i < 40; ++i)
  {
    const int apart = i / 20, sign = i % 2 ? 1 : -1, on_face = i / 2 % 10 < 6;
    CORE_SET set = make_particles(apart ? balls : thread, diagonals[i / 2 % 10], sign);
    mcor_statistics s;
    assert_int_equal(count_parts(*state, &set, 0.37, MCOR_TOPOLOGY_TABLE, &s), 1 + apart);
    assert_int_equal(
      count_parts(*state, &set, 3, MCOR_TOPOLOGY_TABLE, &s), sign < 0 && on_face ? 1 : 2);
    assert_int_equal(count_parts(*state, &set, 3, MCOR_TOPOLOGY_FIELD, &s), 1 + apart);
    assert_int_equal(s.ambiguous_faces, on_face);
    assert_int_equal(s.joined_faces, on_face && (sign > 0) != apart);
    assert_int_equal(s.ambiguous_cells, on_face ? 2 * apart : 1);
    assert_int_equal(s.tunnels, !on_face && !apart);
  }
}

CORE_MAIN(core_set_up, core_tear_down, test_diagonals)
