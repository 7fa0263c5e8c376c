/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Topology by the field: saddle points against a search, bridges and tunnels of known shape,
 * noise. */

#include "core_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- known shapes ---- */

/* Particles around the origin, closer together than the cubes, whose scalar is given by `value`. */
static core_set make_particles(double (*value)(const double x[3], const double end[3], double sign),
  const double end[3], double sign)
{
  enum
  {
    N = 24
  };
  const double spacing = 0.5;
  core_set set = core_make_set(N * N * N);
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
    set.scalar[i] = sign * value(x, end, sign);
  }
  return set;
}

/* A straight thread from the origin to `end`, thinner than a cube. */
static double thread(const double x[3], const double end[3], double sign)
{
  double along = 0, length2 = 0, distance2 = 0;
  (void)sign;
  for (int a = 0; a < 3; ++a)
  {
    along += x[a] * end[a];
    length2 += end[a] * end[a];
  }
  along = fmin(fmax(along / length2, 0), 1);
  for (int a = 0; a < 3; ++a)
  {
    distance2 += (x[a] - along * end[a]) * (x[a] - along * end[a]);
  }
  return 1.2 * 1.2 - distance2;
}

/* Two balls around the ends that do not touch. */
static double balls(const double x[3], const double end[3], double sign)
{
  double first = 0, second = 0;
  (void)sign;
  for (int a = 0; a < 3; ++a)
  {
    first += x[a] * x[a];
    second += (x[a] - end[a]) * (x[a] - end[a]);
  }
  return 1.2 * 1.2 - fmin(first, second);
}

/* Checks a closed surface, and returns its parts. */
static int64_t count_parts(
  mcor_context* context, const core_set* set, double cube, mcor_topology topology)
{
  const double iso = 0;
  const mcor_input input = core_input(set);
  mcor_options options = core_options(&iso);
  options.cube_size = cube;
  options.topology = topology;
  mcor_surface surface = core_extract(context, &input, &options);
  mesh_report report = core_check_mesh(&surface);
  const int64_t parts = report.components;
  CORE_CHECK(report.boundary_edges == 0 && report.euler == 2 * parts,
    "%lld boundary edges, %lld components, Euler number %lld", (long long)report.boundary_edges,
    (long long)parts, (long long)report.euler);
  mesh_free_report(&report);
  mcor_free_surface(&surface);
  return parts;
}

/* Diagonals of a cube's faces and of the cube itself. */
static const double diagonals[][3] = { { 3, 3, 0 }, { 3, -3, 0 }, { 3, 0, 3 }, { -3, 0, 3 },
  { 0, 3, 3 }, { 0, -3, 3 }, { 3, 3, 3 }, { -3, 3, 3 }, { 3, -3, 3 }, { 3, 3, -3 } };

/* Above or below the iso value, a thread stays whole, as it does on a fine lattice; the table
 * cuts it, except where it connects nodes below on a face. */
static void test_threads(void** state)
{
  for (size_t i = 0; i < sizeof diagonals / sizeof diagonals[0]; ++i)
  {
    for (int sign = -1; sign <= 1; sign += 2)
    {
      core_set set = make_particles(thread, diagonals[i], sign);
      assert_int_equal(count_parts(*state, &set, 0.37, MCOR_TOPOLOGY_TABLE), 1);
      assert_int_equal(count_parts(*state, &set, 3, MCOR_TOPOLOGY_FIELD), 1);
      assert_int_equal(
        count_parts(*state, &set, 3, MCOR_TOPOLOGY_TABLE), sign < 0 && i < 6 ? 1 : 2);
      core_free_set(&set);
    }
  }
}

/* Balls that do not touch stay apart; the table connects those below across a face. */
static void test_balls(void** state)
{
  for (size_t i = 0; i < sizeof diagonals / sizeof diagonals[0]; ++i)
  {
    for (int sign = -1; sign <= 1; sign += 2)
    {
      core_set set = make_particles(balls, diagonals[i], sign);
      assert_int_equal(count_parts(*state, &set, 0.37, MCOR_TOPOLOGY_TABLE), 2);
      assert_int_equal(count_parts(*state, &set, 3, MCOR_TOPOLOGY_FIELD), 2);
      assert_int_equal(
        count_parts(*state, &set, 3, MCOR_TOPOLOGY_TABLE), sign < 0 && i < 6 ? 1 : 2);
      core_free_set(&set);
    }
  }
}

/* ---- noise ---- */

static double noise(const double x[3])
{
  uint64_t seed = 0;
  memcpy(&seed, x, sizeof seed);
  return 2 * random_unit(&seed) - 1;
}

typedef struct noise_case
{
  mcor_sph_kernel kernel;
  mcor_field field;
  mcor_type precision;
  double cube_factor, iso;
  int solids;
  mcor_seed_mode seeds;
} noise_case;

static const noise_case noise_cases[] = {
  { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32, 1, 0.01, 0, MCOR_COMPLETE },
  { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32, 2, 0.01, 1, MCOR_COMPLETE },
  { MCOR_QUADRATIC, MCOR_SHEPARD, MCOR_FLOAT64, 1.3, 0, 0, MCOR_PAIRS },
  { MCOR_CUBIC_SPLINE, MCOR_SUM, MCOR_FLOAT32, 1.5, 0.02, 1, MCOR_COMPLETE },
  { MCOR_WENDLAND_C2, MCOR_SUM, MCOR_FLOAT64, 1, -0.01, 0, MCOR_PAIRS },
};

static core_set make_noise(const noise_case* at)
{
  uint64_t seed = 9;
  core_set set = core_make_block(14, 0.4, 3, noise);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.smoothing_length[i] = 0.8;
    set.solid[i] = random_bits(&seed) % 10 == 0;
  }
  set.has_solids = at->solids;
  return set;
}

/* Compares the surfaces of table and field before trimming. */
static void check_noise(const mcor_surface* table, const mcor_surface* field)
{
  mesh_report by_table = core_check_pinched_mesh(table), by_field = core_check_pinched_mesh(field);
  core_check_decisions(&field->statistics);
  assert_int_equal(table->statistics.ambiguous_faces, 0);
  assert_int_equal(table->point_count, field->point_count);
  assert_memory_equal(
    table->points, field->points, (size_t)table->point_count * 3 * sizeof(double));
  assert_int_equal(by_table.boundary_edges, by_field.boundary_edges);
  mesh_free_report(&by_table);
  mesh_free_report(&by_field);
}

/* The same vertices, connected in another way: a manifold all the same, and watertight where the
 * table's surface is. */
static void test_noise(void** state)
{
  for (size_t i = 0; i < sizeof noise_cases / sizeof noise_cases[0]; ++i)
  {
    const noise_case* at = noise_cases + i;
    core_set set = make_noise(at);
    const mcor_input input = core_input(&set);
    mcor_options options = core_options(&at->iso);
    options.sph_kernel = at->kernel;
    options.field = at->field;
    options.precision = at->precision;
    options.cube_size_factor = at->cube_factor;
    options.seeds = at->seeds;
    mcor_surface whole[2];
    for (int topology = 0; topology < 2; ++topology)
    {
      options.topology = (mcor_topology)topology;
      options.vertex_threshold = 0;
      whole[topology] = core_extract(*state, &input, &options);
    }
    check_noise(whole, whole + 1);
    options.vertex_threshold = 0.5;
    mcor_surface trimmed = core_extract(*state, &input, &options);
    mesh_report report = core_check_pinched_mesh(&trimmed);
    mesh_free_report(&report);
    mcor_free_surface(&trimmed);
    mcor_free_surface(whole);
    mcor_free_surface(whole + 1);
    core_free_set(&set);
  }
}

/* A free surface of scattered drops is closed. */
static void test_free_surface(void** state)
{
  int64_t joined = 0, tunnels = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed)
  {
    core_set set = core_make_random(400, 6, 0.4, seed % 2 ? 0.4 : 0.9, seed);
    const double iso = 0.05 * (double)seed;
    const mcor_input input = core_input(&set);
    mcor_options options = core_options(&iso);
    options.field = MCOR_WEIGHT_SUM;
    options.cube_size_factor = 1.2;
    options.topology = MCOR_TOPOLOGY_FIELD;
    mcor_surface surface = core_extract(*state, &input, &options);
    mesh_report report = core_check_mesh(&surface);
    assert_int_equal(report.boundary_edges, 0);
    joined += surface.statistics.joined_faces;
    tunnels += surface.statistics.tunnels;
    mesh_free_report(&report);
    mcor_free_surface(&surface);
    core_free_set(&set);
  }
  CORE_CHECK(joined > 100 && tunnels > 10, "%lld joined, %lld tunnels", (long long)joined,
    (long long)tunnels);
}

/* The order of the particles, and what ran before on the context, do not matter. */
static void test_same_bits(void** state)
{
  core_set set = make_noise(noise_cases + 1);
  int64_t* order = core_make_order(set.count, 5);
  core_set permuted = core_permute(&set, order);
  const double iso = noise_cases[1].iso;
  mcor_options options = core_options(&iso);
  options.cube_size_factor = 1.5;
  uint64_t hash[4];
  for (int i = 0; i < 4; ++i)
  {
    const mcor_input input = core_input(i % 2 ? &permuted : &set);
    options.topology = i == 2 ? MCOR_TOPOLOGY_TABLE : MCOR_TOPOLOGY_FIELD;
    mcor_surface surface = core_extract(*state, &input, &options);
    hash[i] = core_hash(&surface);
    mcor_free_surface(&surface);
  }
  assert_true(hash[0] == hash[1] && hash[0] == hash[3] && hash[0] != hash[2]);
  free(order);
  core_free_set(&set);
  core_free_set(&permuted);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_threads), cmocka_unit_test(test_balls),
    cmocka_unit_test(test_noise), cmocka_unit_test(test_free_surface),
    cmocka_unit_test(test_same_bits) };
  return cmocka_run_group_tests_name("topology", tests, core_set_up, core_tear_down);
}
