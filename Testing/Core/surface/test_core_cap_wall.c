/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Caps where the free surface ends at solids: they close it, leave its own points and triangles as they are, and
 * hold the volume where fluid weighs enough; in boxes, too. */

#include "cap_check.h"
#include "core_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double iso = 0.5;
static const double tank[6] = { -10, 10, -10, 10, -10, 10 };

static mcor_options wall_options(double share)
{
  mcor_options options = core_options(&iso);
  options.field = MCOR_WEIGHT_SUM;
  options.wall_share = share;
  return options;
}

/* A tank with a step in its ground, half full, with waves, a hole and a drop; particles are off a lattice. */
static particle_set make_tank(double noise)
{
  enum
  {
    N = 20
  };
  particle_set set = particle_set_make(N * N * N);
  uint64_t seed = 17;
  int64_t n = 0;
  for (int i = 0; i < N * N * N; ++i)
  {
    const double x[3] = { i % N - 9.5, i / N % N - 9.5, i / (N * N) - 9.5 };
    const bool is_wall = fabs(x[0]) > 7 || fabs(x[1]) > 7 || x[2] < -7 || (x[0] < -2 && x[2] < -4);
    const double top = 1.5 + sin(0.5 * x[0]) + sin(0.4 * x[1]);
    const double hole = hypot(hypot(x[0] - 3, x[1]), x[2] + 3),
                 drop = hypot(hypot(x[0], x[1] - 7), x[2] - 6);
    if (is_wall || (x[2] < top && hole > 2.5) || drop < 2.2)
    {
      for (int a = 0; a < 3; ++a)
      {
        set.position[3 * n + a] = x[a] + noise * (random_unit(&seed) - 0.5);
      }
      set.smoothing_length[n] = 1.3;
      set.volume[n] = 1;
      set.solid[n++] = is_wall;
    }
  }
  set.count = n;
  set.has_solids = 1;
  return set;
}

static void check_tank(mcor_context* context, double share, mcor_topology topology)
{
  CORE_SET set = make_tank(0.2);
  const mcor_input input = core_input(&set);
  mcor_options options = wall_options(share);
  options.topology = topology;
  options.outputs |= MCOR_OUT_NORMALS | MCOR_OUT_BOUNDARY_FLAG;
  options.level_limit = 0; /* as with caps */
  CORE_SURFACE open, closed;
  CORE_OK(context, mcor_extract(context, &input, &options, &open));
  options.capping = MCOR_CAP_PERIOD;
  CORE_OK(context, mcor_extract(context, &input, &options, &closed));
  assert_true(!open.statistics.is_closed && open.point_count > 1000);
  cap_check_prefix(&open, &closed);
  assert_true(closed.statistics.is_closed);
  mesh_report report = core_check_pinched_mesh(&closed);
  assert_int_equal(report.boundary_edges, 0);
  mesh_free_report(&report);
  cap_check_volume(&closed, &set, &options, tank);
  for (int64_t p = open.point_count; p < closed.point_count; ++p)
  {
    const float* n = closed.normals + 3 * p;
    CORE_CHECK(closed.boundary_flag[p] == 8, "flag %d", closed.boundary_flag[p]);
    CORE_CHECK(fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5, "a normal of %g %g %g",
      n[0], n[1], n[2]);
  }
}

static void test_tank(void** state)
{
  check_tank(*state, 0.5, MCOR_TOPOLOGY_FIELD);
  check_tank(*state, 0.35, MCOR_TOPOLOGY_TABLE);
}

/* Points of caps alone are where solids have the share, and in fluid. */
static void check_share(mcor_context* context, double noise)
{
  CORE_SET set = make_tank(noise);
  const mcor_input input = core_input(&set);
  mcor_options options = wall_options(0.35);
  options.capping = MCOR_CAP_PERIOD;
  options.outputs |= MCOR_OUT_BOUNDARY_FLAG;
  CORE_SURFACE surface;
  CORE_OK(context, mcor_extract(context, &input, &options, &surface));
  CORE_FIELD field = oracle_make_field(&set, ORACLE_CUBIC_SPLINE, ORACLE_WEIGHT, 1);
  int64_t caps = 0;
  for (int64_t p = 0; p < surface.point_count; ++p)
  {
    oracle_sample sample;
    if (surface.boundary_flag[p] & 8)
    {
      oracle_evaluate(&field, NULL, surface.points + 3 * p, &sample);
      CORE_CHECK(
        fabs(sample.weight / sample.trim_weight - 0.65) < 1e-5 && sample.weight > iso - 1e-5,
        "fluid weighs %g of %g", sample.weight, sample.trim_weight);
      ++caps;
    }
  }
  CORE_CHECK(caps > 500, "%lld points", (long long)caps);
  assert_int_equal(surface.statistics.trim_vertices_linear, 0);
}

static void test_share(void** state)
{
  check_share(*state, 0.2);
  check_share(*state, 0.9);
}

/* Full to the lid: caps alone, somewhat inside of half the way to the solids. */
static void test_full(void** state)
{
  CORE_SET set = core_make_block(14, 0.1, 5, core_ball);
  for (int64_t i = 0; i < set.count; ++i)
  {
    double far = 0;
    for (int a = 0; a < 3; ++a)
    {
      far = fmax(far, fabs(set.position[3 * i + a]));
    }
    set.solid[i] = far > 4;
  }
  set.has_solids = 1;
  const mcor_input input = core_input(&set);
  mcor_options options = wall_options(0.4);
  options.capping = MCOR_CAP_PERIOD;
  CORE_SURFACE surface;
  CORE_OK(*state, mcor_extract(*state, &input, &options, &surface));
  assert_true(surface.statistics.is_closed);
  assert_int_equal(surface.triangle_count, surface.statistics.cap_triangles);
  cap_check_volume(&surface, &set, &options, tank);
}

/* Boxes make the whole, with all that its points carry; sides of boxes and of a period are closed beside walls. */
static void test_parts(void** state)
{
  CORE_SET set = make_tank(0.2);
  const mcor_input input = core_input(&set);
  mcor_options options = wall_options(0.5);
  options.capping = MCOR_CAP_PERIOD;
  core_ask_for_all(&options);
  core_check_cuts(*state, "caps at walls", &input, &options);
  options.periodic[3] = 12;
  core_check_cuts(*state, "caps at walls in a period", &input, &options);
  CORE_SURFACE surface;
  options = wall_options(0.5);
  options.capping = MCOR_CAP_BOX;
  const double box[6] = { -5.2, 4.1, -INFINITY, 3.7, -5.6, INFINITY };
  memcpy(options.box, box, sizeof box);
  CORE_OK(*state, mcor_extract(*state, &input, &options, &surface));
  assert_true(surface.statistics.is_closed && surface.statistics.cap_triangles > 500);
}

/* Solids that reach too much are found before the fluid beside them, which would take minutes. */
static void test_limit(void** state)
{
  CORE_SET set = particle_set_make(2);
  for (int i = 0; i < 2; ++i)
  {
    set.position[3 * i] = i;
    set.smoothing_length[i] = 1;
    set.volume[i] = 1;
    set.solid[i] = i == 1;
  }
  set.has_solids = 1;
  const mcor_input input = core_input(&set);
  const double out_of_reach = 9;
  mcor_options options = wall_options(0.5);
  options.iso_values = &out_of_reach;
  options.cube_size = 1.0 / 450; /* a support of 1800^3 nodes */
  options.capping = MCOR_CAP_PERIOD;
  CORE_SURFACE surface;
  assert_int_equal(mcor_extract(*state, &input, &options, &surface), MCOR_OUT_OF_CAPACITY);
  assert_non_null(strstr(mcor_last_error(*state), "nodes are near solids"));
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_tank), cmocka_unit_test(test_share),
    cmocka_unit_test(test_full), cmocka_unit_test(test_parts), cmocka_unit_test(test_limit) };
  return cmocka_run_group_tests(tests, core_set_up, core_tear_down);
}
