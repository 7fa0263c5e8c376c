/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests surfaces that end at solids (mcor_options.wall_share): which share is measured, and when it is used. The oracle
 * checks where such a surface ends. */

#include "core_fixture.h"
#include "mcor_input.h"

/* Makes a block of particles. Those below a plane oblique to the lattice are solids. */
static particle_set make_tank(void)
{
  particle_set set = core_make_block(10, 0.2, 3, core_slope);
  for (int64_t j = 0; j < set.count; ++j)
  {
    const double* x = set.position + 3 * j;
    set.solid[j] = x[2] + 0.3 * x[0] < -1.7;
  }
  set.has_solids = 1;
  return set;
}

static mcor_options make_options(double share, mcor_field field)
{
  static const double isos[] = { [MCOR_SHEPARD] = 0, [MCOR_SUM] = 0.7, [MCOR_WEIGHT_SUM] = 0.5 };
  mcor_options options = core_options(&isos[field]);
  options.field = field;
  options.wall_share = share;
  options.outputs |= MCOR_OUT_WEIGHT_SUM | MCOR_OUT_BOUNDARY_FLAG | MCOR_OUT_RESIDUAL;
  return options;
}

/* Without solids that matter the surface ends at no wall, so the wall share must not change any bit. */
static void test_without_solids(void** state)
{
  CORE_SET set = make_tank();
  for (int field = 0; field < 3; ++field)
  {
    for (int ignored = 0; ignored < 2; ++ignored)
    {
      uint64_t hash[2];
      for (int share = 0; share < 2; ++share)
      {
        mcor_input input = core_input(&set);
        input.solid = ignored ? set.solid : NULL;
        input.ignore_solids = ignored;
        const mcor_options options = make_options(0.5 * share, (mcor_field)field);
        hash[share] = core_hash_of(*state, &input, &options);
      }
      CORE_CHECK(hash[0] == hash[1], field, ignored);
    }
  }
}

typedef struct wall_weight
{
  double share, fluid;
} wall_weight;

static int compare_shares(const void* a, const void* b)
{
  const double s = ((const wall_weight*)a)->share, t = ((const wall_weight*)b)->share;
  return (s > t) - (s < t);
}

/* Returns the expected share. At each solid particle the solids have a share of the weight. The
 * result is the median of these shares, weighted by the fluid's weight at the solid. Images lie one
 * period away along y. */
static double find_share(const particle_set* set, oracle_kernel kernel, double period)
{
  wall_weight at[1000];
  int count = 0;
  double sum = 0, counted = 0;
  CORE_FIELD field = oracle_make_field(set, kernel, ORACLE_SHEPARD, 1);
  for (int64_t j = 0; j < set->count; ++j)
  {
    const double* x = set->position + 3 * j;
    double fluid = 0, both = 0;
    for (int image = -(period > 0); image <= (period > 0); ++image)
    {
      const double place[3] = { x[0], x[1] + image * period, x[2] };
      oracle_sample sample;
      oracle_evaluate(&field, NULL, place, &sample);
      fluid += sample.weight;
      both += sample.trim_weight;
    }
    if (set->solid[j] && fluid > 0)
    {
      at[count++] = (wall_weight){ 1 - fluid / both, fluid };
      sum += fluid;
    }
  }
  assert_in_range(count, 20, 200);
  qsort(at, (size_t)count, sizeof at[0], compare_shares);
  int i = 0;
  for (; counted < 0.5 * sum; ++i)
  {
    counted += at[i].fluid;
  }
  return at[i - 1].share;
}

/* Makes the tank with only 200 solids, so that all of them are used as samples. */
static particle_set make_small_tank(void)
{
  particle_set set = make_tank();
  double height[2][1000];
  assert_int_equal(set.count, 1000);
  for (int64_t j = 0; j < set.count; ++j)
  {
    height[0][j] = height[1][j] = set.position[3 * j + 2] + 0.3 * set.position[3 * j];
  }
  qsort(height[1], 1000, sizeof(double), mcor_compare_doubles);
  for (int64_t j = 0; j < set.count; ++j)
  {
    set.solid[j] = height[0][j] < height[1][200];
  }
  return set;
}

/* Checks that the measured share equals find_share's, with any kernel, and also across a period. */
static void test_share(void** state)
{
  CORE_SET set = make_small_tank();
  const mcor_input input = core_input(&set);
  for (int i = 0; i < 2 * MCOR_SPH_KERNEL_COUNT; ++i)
  {
    const int kernel = i / 2, periodic = i % 2;
    mcor_options options = make_options(MCOR_WALL_SHARE_MEASURED, MCOR_SHEPARD);
    options.sph_kernel = (mcor_sph_kernel)kernel;
    options.periodic[2] = periodic ? -5 : 0;
    options.periodic[3] = periodic ? 5 : 0;
    const double expected = find_share(&set, (oracle_kernel)kernel, periodic ? 10 : 0);
    CORE_OWNED(mcor_free_globals) mcor_globals globals;
    CORE_OK(*state, mcor_measure_globals(*state, &input, &options, &globals));
    CORE_CHECK(fabs(globals.measured.wall_share - expected) < 1e-6, kernel,
      periodic ? ", periodic" : "", globals.measured.wall_share, expected);
  }
}

/* Checks that a measured wall share gives the same surface as this share set by hand. The measured share comes
 * from a call that keeps the search grid of a call with another share, and from mcor_measure_globals. */
static void test_measured(void** state)
{
  CORE_SET set = make_tank();
  mcor_input input = core_input(&set);
  input.particles_version = input.scalar_version = 1;
  mcor_options options = make_options(0.5, MCOR_SHEPARD);
  CORE_OWNED(mcor_free_globals) mcor_globals globals;
  mcor_surface surface[4];
  surface[0] = core_extract(*state, &input, &options);
  options.wall_share = MCOR_WALL_SHARE_MEASURED;
  surface[1] = core_extract(*state, &input, &options);
  CORE_OK(*state, mcor_measure_globals(*state, &input, &options, &globals));
  options.globals = &globals;
  surface[2] = core_extract(*state, &input, &options);
  options.globals = NULL;
  options.wall_share = globals.measured.wall_share;
  surface[3] = core_extract(*state, &input, &options);
  uint64_t hash[4];
  for (int i = 0; i < 4; ++i)
  {
    hash[i] = core_hash(&surface[i]);
    assert_true(surface[i].statistics.wall_share == (i == 0 ? 0.5 : globals.measured.wall_share));
    mcor_free_surface(&surface[i]);
  }
  CORE_CHECK(
    hash[1] == hash[2] && hash[1] == hash[3] && hash[1] != hash[0], globals.measured.wall_share);
}

/* Checks the default, also with global values: the wall share is measured for a scalar, and 0 for the free surface. */
static void test_auto(void** state)
{
  CORE_SET set = make_tank();
  mcor_options options;
  mcor_set_default_options(&options);
  assert_true(options.wall_share == MCOR_WALL_SHARE_AUTO);
  for (int field = MCOR_SHEPARD; field <= MCOR_WEIGHT_SUM; ++field)
  {
    const mcor_input input = core_input(&set);
    uint64_t hash[3];
    mcor_globals globals;
    options = make_options(MCOR_WALL_SHARE_AUTO, (mcor_field)field);
    for (int i = 0; i < 3; ++i)
    {
      options.wall_share = i < 2   ? MCOR_WALL_SHARE_AUTO
        : field == MCOR_WEIGHT_SUM ? 0
                                   : MCOR_WALL_SHARE_MEASURED;
      if (i == 1)
      {
        CORE_OK(*state, mcor_measure_globals(*state, &input, &options, &globals));
        assert_true((globals.measured.wall_share > 0) == (field != MCOR_WEIGHT_SUM));
      }
      options.globals = i == 1 ? &globals : NULL;
      CORE_SURFACE surface = core_extract(*state, &input, &options);
      assert_true((surface.statistics.wall_share > 0) == (field != MCOR_WEIGHT_SUM));
      assert_true(surface.triangle_count > 0);
      hash[i] = core_hash(&surface);
    }
    CORE_CHECK(hash[0] == hash[1] && hash[0] == hash[2], field);
    mcor_free_globals(&globals);
  }
}

/* With MCOR_WALL_SHARE_MEASURED a free surface must take the share one half. Global values measured with another wall
 * share must be refused. */
static void test_measured_elsewhere(void** state)
{
  CORE_SET set = make_tank();
  const mcor_input input = core_input(&set);
  mcor_options options = make_options(MCOR_WALL_SHARE_MEASURED, MCOR_WEIGHT_SUM);
  mcor_surface surface = core_extract(*state, &input, &options);
  assert_true(surface.statistics.wall_share == 0.5);
  mcor_free_surface(&surface);
  options.wall_share = 0.5;
  CORE_OWNED(mcor_free_globals) mcor_globals globals;
  CORE_OK(*state, mcor_measure_globals(*state, &input, &options, &globals));
  options.wall_share = MCOR_WALL_SHARE_MEASURED;
  options.globals = &globals;
  assert_int_equal(mcor_extract(*state, &input, &options, &surface), MCOR_INVALID_ARGUMENT);
  assert_true(core_told(*state, "GLOBALS_LACK_WALL_SHARE"));
}

CORE_MAIN(core_set_up, core_tear_down, test_without_solids, test_share, test_measured,
  test_measured_elsewhere, test_auto)
