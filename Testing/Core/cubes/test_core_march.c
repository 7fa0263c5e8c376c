/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Extraction: bit masks of bricks against naive twins, and cells in any pattern, node by node. */

#include "core_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Masks of a brick and its 7 neighbours -> shifted masks, cells with some / all nodes. */
static const char source[] =
  "__kernel void test_masks(const int count, __global const ulong* in, __global ulong* out)\n"
  "{\n"
  "  const int i = get_global_id(0);\n"
  "  if (i >= count)\n"
  "    return;\n"
  "  ulong m[8];\n"
  "  for (int d = 0; d < 8; ++d)\n"
  "    m[d] = in[8 * i + d];\n"
  "  __global ulong* o = out + 9 * i;\n"
  "  o[0] = mcor_from_next(0, m[0], m[1]);\n"
  "  o[1] = mcor_from_next(1, m[0], m[2]);\n"
  "  o[2] = mcor_from_next(2, m[0], m[4]);\n"
  "  o[3] = mcor_from_last(0, m[0], m[1]);\n"
  "  o[4] = mcor_from_last(1, m[0], m[2]);\n"
  "  o[5] = mcor_from_last(2, m[0], m[4]);\n"
  "  mcor_cell_corners(m);\n"
  "  o[6] = mcor_cell_some(m);\n"
  "  o[7] = mcor_cell_all(m);\n"
  "  o[8] = m[0] ? mcor_ctz(in[8 * i] | 1UL << (i & 63)) : 0;\n"
  "}\n";

/* Node (x, y, z), 0 <= x < 8 and so on, of a brick and its upper neighbours. */
static int node_at(const uint64_t* m, int x, int y, int z)
{
  const int d = x / 4 + y / 4 * 2 + z / 4 * 4;
  return (int)(m[d] >> (x % 4 + y % 4 * 4 + z % 4 * 16) & 1);
}

static void check_masks(const uint64_t* m, const uint64_t* out)
{
  for (int n = 0; n < 64; ++n)
  {
    const int at[3] = { n % 4, n / 4 % 4, n / 16 };
    for (int a = 0; a < 3; ++a)
    {
      int up[3] = { at[0], at[1], at[2] };
      ++up[a];
      CORE_CHECK(
        (int)(out[a] >> n & 1) == node_at(m, up[0], up[1], up[2]), "from_next %d, node %d", a, n);
      int down[3] = { at[0], at[1], at[2] };
      down[a] = (at[a] + 3) % 4;
      const uint64_t from = at[a] == 0 ? m[1 << a] : m[0];
      CORE_CHECK((out[3 + a] >> n & 1) == (from >> (down[0] + 4 * down[1] + 16 * down[2]) & 1),
        "from_last %d, node %d", a, n);
    }
    int set = 0;
    for (int c = 0; c < 8; ++c)
    {
      set += node_at(m, at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2));
    }
    CORE_CHECK((out[6] >> n & 1) == (set > 0), "some, cell %d", n);
    CORE_CHECK((out[7] >> n & 1) == (set == 8), "all, cell %d", n);
  }
}

static void test_masks(void** state)
{
  enum
  {
    N = 256
  };
  mcor_context* context = *state;
  static uint64_t in[N][8], out[N][9];
  uint64_t seed = 3;
  for (int i = 0; i < N; ++i)
  {
    for (int d = 0; d < 8; ++d)
    {
      const uint64_t a = random_bits(&seed), b = random_bits(&seed), c = random_bits(&seed);
      in[i][d] = i == 0 ? 0 : i == 1 ? ~UINT64_C(0) : i % 3 ? a : i % 2 ? a & b & c : a | b | c;
    }
  }
  mcor_buffer masks = { 0 }, results = { 0 };
  core_build(context, MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32);
  core_extend_program(context, source);
  CORE_OK(context, mcor_write(context, &masks, in, sizeof in));
  CORE_OK(context, mcor_reserve(context, &results, sizeof out));
  CORE_OK(context,
    MCOR_LAUNCH(context, "test_masks", MCOR_LIGHT, N, MCOR_INT(N), MCOR_BUFFER(&masks),
      MCOR_BUFFER(&results)));
  CORE_OK(context, mcor_read(context, &results, 0, out, sizeof out));
  for (int i = 0; i < N; ++i)
  {
    check_masks(in[i], out[i]);
    if (~in[i][0] != 0)
    {
      const uint64_t mask = in[i][0] | UINT64_C(1) << (i & 63);
      uint64_t lowest = 0;
      while (!(mask >> lowest & 1))
      {
        ++lowest;
      }
      CORE_CHECK(out[i][8] == lowest, "lowest bit %d", (int)out[i][8]);
    }
  }
  mcor_release(context, &masks);
  mcor_release(context, &results);
}

/* The surface around one huge value is found, and ends where the support does. */
static void test_outlier(void** state)
{
  for (int sign = -1; sign <= 1; sign += 2)
  {
    core_set set = core_make_block(9, 0, 1, core_ball);
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.scalar[i] = i == set.count / 2 ? sign * 1e30 : 0;
    }
    const double iso = sign, reach = 2 * set.smoothing_length[0];
    const mcor_input input = core_input(&set);
    const mcor_options options = core_options(&iso);
    mcor_surface surface = core_extract(*state, &input, &options);
    mesh_report report = core_check_mesh(&surface);
    CORE_CHECK(report.triangles >= 8 && report.boundary_edges == 0,
      "sign %d: %lld triangles, %lld boundary edges", sign, (long long)report.triangles,
      (long long)report.boundary_edges);
    for (int64_t i = 0; i < surface.point_count; ++i)
    {
      const double* x = surface.points + 3 * i;
      const double r = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
      CORE_CHECK(r > 0.9 * reach && r < 1.01 * reach, "sign %d: a point at distance %g", sign, r);
    }
    mesh_free_report(&report);
    mcor_free_surface(&surface);
    core_free_set(&set);
  }
}

/* A block of particles, of which some have a far larger support; and the others once more, far away on
 * the left, where the lattice then begins. */
static core_set make_mixed(int twice)
{
  core_set block = core_make_block(10, 0.3, 5, core_ball), set = core_make_set(2 * block.count);
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
  core_free_set(&block);
  return set;
}

/* A point's bits depend on it and the particles that reach it alone: not on where the lattice, and so
 * blocks, begin, nor on other points. */
static void test_parts_have_the_bits_of_the_whole(void** state)
{
  const double iso = -14;
  mcor_options options = core_options(&iso);
  options.outputs |=
    MCOR_OUT_GRADIENTS | MCOR_OUT_WEIGHT_SUM | MCOR_OUT_RESIDUAL | MCOR_OUT_NEAREST_PARTICLE;
  core_set part = make_mixed(0), whole = make_mixed(1);
  mcor_input input = core_input(&part);
  mcor_surface a = core_extract(*state, &input, &options);
  input = core_input(&whole);
  mcor_surface b = core_extract(*state, &input, &options);
  int64_t i = 0;
  for (int64_t j = 0; j < b.point_count; ++j)
  {
    if (b.points[3 * j] > -100)
    {
      assert_true(i < a.point_count);
      assert_memory_equal(a.points + 3 * i, b.points + 3 * j, 3 * sizeof(double));
      assert_memory_equal(a.gradients + 3 * i, b.gradients + 3 * j, 3 * sizeof(double));
      assert_memory_equal(a.weight_sum + i, b.weight_sum + j, sizeof(float));
      assert_memory_equal(a.residual + i, b.residual + j, sizeof(float));
      assert_true(a.nearest_particle[i] == b.nearest_particle[j]);
      ++i;
    }
  }
  assert_int_equal(i, a.point_count);
  assert_true(i > 100 && i < b.point_count);

  mcor_free_surface(&a);
  mcor_free_surface(&b);
  core_free_set(&part);
  core_free_set(&whole);
}

/* ---- Node by node: a particle on a node reaches no other one, so that the value there is its own,
 * and a node without a particle has no weight. Cells then are valid, or not, in any pattern. ---- */

#define NODES 8

typedef struct node_pattern
{
  int sign[NODES * NODES * NODES]; /* x fastest; 0: no particle */
  int64_t points, triangles;       /* of its surface */
  int64_t pinched[3][2];           /* edges by axis, and by which two of the cells are valid */
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

/* The Marching Cubes case of a cell; -1 if it is not valid. */
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

/* Counts the vertices on the edge from a node: 0, 1, or 2 where only two cells around it are valid
 * and touch in nothing else. */
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
  uint8_t table[256][16];
  mcor_make_case_table(table);
  *p = (node_pattern){ 0 };
  for (int n = 0; n < NODES * NODES * NODES; ++n)
  {
    p->sign[n] = random_unit(&seed) < 0.12 ? 0 : random_bits(&seed) % 2 ? 1 : -1;
  }
  for (int n = 0; n < NODES * NODES * NODES; ++n)
  {
    const int at[3] = { n % NODES, n / NODES % NODES, n / NODES / NODES };
    const int cube_case = pattern_case(p, at);
    p->triangles += cube_case >= 0 ? table[cube_case][15] : 0;
    for (int axis = 0; axis < 3; ++axis)
    {
      count_edge(p, at, axis);
    }
  }
}

static core_set pattern_particles(const node_pattern* p)
{
  core_set set = core_make_set(NODES * NODES * NODES);
  set.count = 0;
  for (int n = 0; n < NODES * NODES * NODES; ++n)
  {
    const int at[3] = { n % NODES, n / NODES % NODES, n / NODES / NODES };
    const int64_t i = set.count;
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] = at[a] - 3; /* across the borders of bricks and of blocks */
    }
    set.smoothing_length[i] = 0.45;
    set.volume[i] = 1;
    set.scalar[i] = pattern_at(p, at) * (1 + 0.001 * n);
    set.count += set.scalar[i] != 0;
  }
  return set;
}

static void check_pattern(
  mcor_context* context, const node_pattern* p, const core_set* set, mcor_topology topology)
{
  const double iso = 0;
  const mcor_input input = core_input(set);
  mcor_options options = core_options(&iso);
  options.cube_size = 1;
  options.vertex_threshold = 0;
  options.topology = topology;
  mcor_surface surface = core_extract(context, &input, &options);
  int64_t pinched = 0;
  for (int k = 0; k < 6; ++k)
  {
    pinched += p->pinched[k / 2][k % 2];
  }
  assert_int_equal(surface.point_count, p->points);
  CORE_CHECK(topology == MCOR_TOPOLOGY_FIELD || surface.triangle_count == p->triangles,
    "%lld triangles, not %lld", (long long)surface.triangle_count, (long long)p->triangles);
  mesh_report report;
  assert_true(mesh_check(
    surface.points, surface.point_count, surface.triangles, surface.triangle_count, &report));
  for (int fault = 0; fault < MESH_FAULT_COUNT; ++fault)
  {
    /* The two vertices of a pinched edge lie in one place. */
    CORE_CHECK(report.faults[fault] == (fault == MESH_COINCIDENT_POINT ? pinched : 0),
      "topology %d, %lld of: %s; %s", (int)topology, (long long)report.faults[fault],
      mesh_fault_name(fault), report.first[fault]);
  }
  mesh_free_report(&report);
  mcor_free_surface(&surface);
}

static void test_node_by_node(void** state)
{
  int64_t pinched[6] = { 0 };
  for (uint64_t seed = 1; seed <= 4; ++seed)
  {
    node_pattern p;
    make_pattern(&p, seed);
    core_set set = pattern_particles(&p);
    check_pattern(*state, &p, &set, MCOR_TOPOLOGY_TABLE);
    check_pattern(*state, &p, &set, MCOR_TOPOLOGY_FIELD);
    core_free_set(&set);
    for (int k = 0; k < 6; ++k)
    {
      pinched[k] += p.pinched[k / 2][k % 2];
    }
  }
  for (int k = 0; k < 6; ++k)
  {
    CORE_CHECK(pinched[k] > 0, "no pinched edge along axis %d with diagonal %d", k / 2, k % 2);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_masks),
    cmocka_unit_test(test_outlier), cmocka_unit_test(test_parts_have_the_bits_of_the_whole),
    cmocka_unit_test(test_node_by_node) };
  return cmocka_run_group_tests_name("march", tests, core_set_up, core_tear_down);
}
