/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests extraction: cells in any pattern, made node by node; outliers; surfaces of parts of the particles. */

#include "core_parts.h"
#include "mcor_vector.h"

/* The surface around a particle with a huge scalar must be found, near the end of the particle's support. */
static void test_outlier(void** state)
{
  for (int sign = -1; sign <= 1; sign += 2)
  {
    CORE_SET set = core_make_block(9, 0, 1, core_ball);
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.scalar[i] = i == set.count / 2 ? sign * 1e30 : 0;
    }
    const double iso = sign, reach = 2 * set.smoothing_length[0];
    const mcor_input input = core_input(&set);
    const mcor_options options = core_options(&iso);
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    CORE_REPORT report = core_check_mesh(&surface);
    CORE_CHECK(report.triangles >= 8 && report.boundary_edges == 0, sign, report.triangles,
      report.boundary_edges);
    for (int64_t i = 0; i < surface.point_count; ++i)
    {
      const double* x = surface.points + 3 * i;
      const double r = sqrt(mcor_dot(x, x));
      CORE_CHECK(r > 0.9 * reach && r < 1.01 * reach, sign, r);
    }
  }
}

/* Makes a block of particles, some with a far larger support. twice: also copies the particles of ordinary support to a
 * place far away at smaller x, so that the lattice begins there. */
static particle_set make_mixed(int twice)
{
  particle_set block = core_make_block(10, 0.3, 5, core_ball),
               set = particle_set_make(2 * block.count);
  uint64_t seed = 3;
  set.count = 0;
  for (int64_t i = 0; i < block.count * (1 + twice); ++i)
  {
    const int64_t from = i % block.count, to = set.count;
    const double factor = from % 3 ? 1 : pow(64, random_unit(&seed));
    memcpy(set.position + 3 * to, block.position + 3 * from, 3 * sizeof(double));
    set.position[3 * to] -= i == from ? 0 : 200;
    set.smoothing_length[to] = block.smoothing_length[from] * factor;
    set.volume[to] = factor * factor * factor;
    set.scalar[to] = block.scalar[from];
    set.count += i == from || from % 3;
  }
  particle_set_free(&block);
  return set;
}

/* A point's bits depend only on its place and on the particles that reach it, not on where the lattice and its blocks
 * begin, nor on other points. */
static void test_parts_have_the_bits_of_the_whole(void** state)
{
  const double iso = -14;
  mcor_options options = core_options(&iso);
  options.outputs |=
    MCOR_OUT_GRADIENTS | MCOR_OUT_WEIGHT_SUM | MCOR_OUT_RESIDUAL | MCOR_OUT_NEAREST_PARTICLE;
  CORE_SET part = make_mixed(0), whole = make_mixed(1);
  mcor_input input = core_input(&part);
  CORE_SURFACE a = core_extract(*state, &input, &options);
  input = core_input(&whole);
  CORE_SURFACE b = core_extract(*state, &input, &options);
  int64_t i = 0;
  for (int64_t j = 0; j < b.point_count; ++j)
  {
    if (b.points[3 * j] > -100)
    {
      unsigned char one[200], other[200];
      assert_true(i < a.point_count);
      const size_t bytes = (size_t)(core_put_point(one, &input, &a, i++, false) - one);
      core_put_point(other, &input, &b, j, false);
      assert_memory_equal(one, other, bytes);
    }
  }
  assert_int_equal(i, a.point_count);
  assert_true(i > 100 && i < b.point_count);
}

/* ---- Node by node. Each particle lies on a node and reaches no other node, so the field at a node is the value of its
 * particle, and nodes without a particle have no weight. Such sets make any pattern of valid and invalid cells. ---- */

#define NODES 8

typedef struct node_pattern
{
  int sign[NODES * NODES * NODES]; /* x fastest; 0: no particle */
  int64_t points, triangles;       /* of the surface that the pattern must give */
  /* Edges with two vertices, because only two opposite cells around them are valid: [axis][which two]. */
  int64_t pinched[3][2];
} node_pattern;

static int pattern_at(const node_pattern* p, const int at[3])
{
  for (int a = 0; a < 3; ++a)
  {
    if (at[a] < 0 || at[a] >= NODES)
    {
      return 0;
    }
  }
  return p->sign[(at[2] * NODES + at[1]) * NODES + at[0]];
}

/* Returns the Marching Cubes case of a cell, or -1 if the cell is not valid. */
static int pattern_case(const node_pattern* p, const int cell[3])
{
  int result = 0;
  for (int c = 0; c < 8; ++c)
  {
    const int node[3] = { cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2) };
    const int sign = pattern_at(p, node);
    if (sign == 0)
    {
      return -1;
    }
    result |= (sign > 0) << c;
  }
  return result;
}

/* Adds to the pattern's counts the vertices on the edge from a node: 0, 1, or 2 if only two cells around the edge are
 * valid and they touch only in this edge. */
static void count_edge(node_pattern* p, const int node[3], int axis)
{
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  int end[3] = { node[0], node[1], node[2] };
  ++end[axis];
  if (pattern_at(p, node) * pattern_at(p, end) >= 0)
  {
    return;
  }
  int valid[4], count = 0;
  for (int c = 0; c < 4; ++c)
  {
    int cell[3] = { node[0], node[1], node[2] };
    cell[u] -= c & 1;
    cell[v] -= c >> 1;
    valid[c] = pattern_case(p, cell) >= 0;
    count += valid[c];
  }
  const int pinched = count == 2 && valid[0] == valid[3];
  p->points += (count > 0) + pinched;
  p->pinched[axis][valid[0]] += pinched;
}

static void make_pattern(node_pattern* p, uint64_t seed)
{
  static mcor_case_table table;
  mcor_make_case_table(&table);
  *p = (node_pattern){ 0 };
  for (int n = 0; n < NODES * NODES * NODES; ++n)
  {
    p->sign[n] = random_unit(&seed) < 0.12 ? 0 : random_bits(&seed) % 2 ? 1 : -1;
  }
  for (int n = 0; n < NODES * NODES * NODES; ++n)
  {
    const int at[3] = { n % NODES, n / NODES % NODES, n / NODES / NODES };
    const int cube_case = pattern_case(p, at);
    p->triangles += cube_case >= 0 ? table.rows[table.cases[cube_case] >> 6].triangles : 0;
    for (int axis = 0; axis < 3; ++axis)
    {
      count_edge(p, at, axis);
    }
  }
}

static particle_set pattern_particles(const node_pattern* p)
{
  particle_set set = particle_set_make(NODES * NODES * NODES);
  set.count = 0;
  for (int n = 0; n < NODES * NODES * NODES; ++n)
  {
    const int at[3] = { n % NODES, n / NODES % NODES, n / NODES / NODES };
    const int64_t i = set.count;
    for (int a = 0; a < 3; ++a)
    {
      /* The pattern lies across borders of bricks and blocks. */
      set.position[3 * i + a] = at[a] - 3;
    }
    set.smoothing_length[i] = 0.45;
    set.volume[i] = 1;
    set.scalar[i] = pattern_at(p, at) * (1 + 0.001 * n);
    set.count += set.scalar[i] != 0;
  }
  return set;
}

static void check_pattern(
  mcor_context* context, const node_pattern* p, const particle_set* set, mcor_topology topology)
{
  const double iso = 0;
  const mcor_input input = core_input(set);
  mcor_options options = core_options(&iso);
  options.cube_size = 1;
  options.vertex_threshold = 0;
  options.topology = topology;
  CORE_SURFACE surface = core_extract(context, &input, &options);
  int64_t pinched = 0;
  for (int k = 0; k < 6; ++k)
  {
    pinched += p->pinched[k / 2][k % 2];
  }
  assert_int_equal(surface.point_count, p->points);
  CORE_CHECK(topology == MCOR_TOPOLOGY_FIELD || surface.triangle_count == p->triangles,
    surface.triangle_count, p->triangles);
  CORE_REPORT report = core_check_pinched_mesh(&surface);
  assert_int_equal(report.faults[MESH_COINCIDENT_POINT], pinched);
}

static void test_node_by_node(void** state)
{
  int64_t pinched[6] = { 0 };
  for (uint64_t seed = 1; seed <= 4; ++seed)
  {
    node_pattern p;
    make_pattern(&p, seed);
    CORE_SET set = pattern_particles(&p);
    check_pattern(*state, &p, &set, MCOR_TOPOLOGY_TABLE);
    check_pattern(*state, &p, &set, MCOR_TOPOLOGY_FIELD);
    for (int k = 0; k < 6; ++k)
    {
      pinched[k] += p.pinched[k / 2][k % 2];
    }
  }
  for (int k = 0; k < 6; ++k)
  {
    CORE_CHECK(pinched[k] > 0, k / 2, k % 2);
  }
}

CORE_MAIN(core_set_up, core_tear_down, test_outlier, test_parts_have_the_bits_of_the_whole,
  test_node_by_node)
