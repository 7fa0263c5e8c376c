/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests particles that must play no part. Absent or ignored particles may hold anything. Particles too far away for the
 * virtual grid do not stop a run: they do not matter to a call with a box or with points; any other call leaves a few
 * of them out, with a warning. */

#include "core_fixture.h"
#include "mcor_input.h"

#define SIDE 10
#define BLOCK (SIDE * SIDE * SIDE)

/* Returns the block's particles, followed by `more` particles whose arrays hold nothing valid. */
static particle_set add_particles(const particle_set* block, int more)
{
  particle_set set = particle_set_make(block->count + more);
  set.count = 0;
  for (int64_t i = 0; i < block->count; ++i)
  {
    particle_set_append(&set, block, i);
  }
  set.count += more;
  for (int64_t i = block->count; i < set.count; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] = NAN;
    }
    set.smoothing_length[i] = -1;
    set.volume[i] = NAN;
    set.scalar[i] = INFINITY;
    set.solid[i] = MCOR_ABSENT;
  }
  return set;
}

/* Checks that the set's surface equals the block's surface to the last bit. */
static void check_same(mcor_context* context, const particle_set* block, const particle_set* set,
  mcor_input (*input_of)(const particle_set*), const mcor_options* options)
{
  const mcor_input one = input_of(block), other = input_of(set);
  CORE_SURFACE expected = core_extract(context, &one, options);
  CORE_SURFACE surface = core_extract(context, &other, options);
  assert_true(expected.triangle_count > 0);
  assert_true(core_hash(&surface) == core_hash(&expected));
  assert_int_equal(surface.statistics.fluid_particles, expected.statistics.fluid_particles);
  assert_true(surface.statistics.neighbours_median == expected.statistics.neighbours_median);
}

static mcor_input input_with_solids(const particle_set* set)
{
  mcor_input input = core_input(set);
  input.solid = set->solid;
  return input;
}

static mcor_input input_of_masses(const particle_set* set)
{
  mcor_input input = input_with_solids(set);
  input.mass = input.volume;
  input.volume = (mcor_array){ 0 };
  return input;
}

static mcor_input input_with_estimate(const particle_set* set)
{
  mcor_input input = input_with_solids(set);
  input.estimate_smoothing_length = 1;
  return input;
}

static mcor_input input_without_solids(const particle_set* set)
{
  mcor_input input = input_with_solids(set);
  input.ignore_solids = 1;
  return input;
}

static void test_absent(void** state)
{
  const double iso = 0;
  CORE_SET block = core_make_block(SIDE, 0.2, 3, core_ball);
  CORE_SET set = add_particles(&block, 5);
  mcor_options options = core_options(&iso);
  options.outputs |= MCOR_OUT_NEAREST_PARTICLE;
  check_same(*state, &block, &set, input_with_solids, &options);
  check_same(*state, &block, &set, input_of_masses, &options);
  check_same(*state, &block, &set, input_with_estimate, &options);
  memset(block.solid, 1, BLOCK / 4);
  memset(set.solid, 1, BLOCK / 4);
  check_same(*state, &block, &set, input_with_solids, &options);
  /* Ignored solids may hold anything, too. */
  memset(block.solid, 0, (size_t)block.count);
  memset(set.solid, 0, (size_t)set.count);
  memset(set.solid + block.count, 1, (size_t)(set.count - block.count));
  check_same(*state, &block, &set, input_without_solids, &options);
  const mcor_input input = input_with_solids(&set);
  mcor_surface surface;
  assert_int_equal(mcor_extract(*state, &input, &options, &surface), MCOR_INVALID_DATA);
  assert_true(core_told(*state, "ARRAY_VALUE|position of particle 1000"));
  particle_set_free(&set);
  particle_set_free(&block);
  /* The set is so large that it is read in several slices. Particles that are not ignored must keep
   * their order. */
  set = core_make_block(40, 0.2, 3, core_ball);
  assert_true(set.count > 4 * MCOR_HEAVY_GRAIN);
  block = particle_set_make(set.count);
  block.count = 0;
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.solid[i] = (i * 2654435761 >> 7) % 8 == 0;
    set.solid[i] ? (void)0 : particle_set_append(&block, &set, i);
  }
  /* A particle has another number in each set, so the nearest particle is not compared. */
  options.outputs &= ~(unsigned)MCOR_OUT_NEAREST_PARTICLE;
  check_same(*state, &block, &set, input_without_solids, &options);
}

static int compare_hashes(const void* a, const void* b)
{
  const uint64_t *p = a, *q = b;
  return (p[0] > q[0]) - (p[0] < q[0]);
}

/* Checks the medians of spacing, smoothing length and number of neighbours over the 32 fluid particles whose positions
 * have the least hashes. Absent particles must play no part. */
static void test_measures(void** state)
{
  enum
  {
    WATCHED = 32,
    N = 32 * 32 * 32
  };
  const double iso = 0;
  CORE_SET set = core_make_block(32, 0.2, 3, core_ball);
  CORE_FREED uint64_t(*hash)[2] = malloc(N * sizeof *hash);
  assert_true(hash && set.count >= 4 * MCOR_HEAVY_GRAIN);
  for (int way = 0; way < 4; ++way)
  {
    const bool ignored = way & 1, estimated = way & 2;
    CORE_SET present = particle_set_make(N);
    int fluid = 0;
    present.count = 0;
    for (int64_t i = 0; i < N; ++i)
    {
      set.smoothing_length[i] = 1.2 + 0.1 * (double)(i % 3);
      set.solid[i] = i % 11 == 0 ? MCOR_ABSENT : i % 3 == 0;
      hash[fluid][0] = mcor_hash_position(set.position + 3 * i);
      hash[fluid][1] = (uint64_t)i;
      fluid += set.solid[i] == 0;
      set.solid[i] != MCOR_ABSENT ? particle_set_append(&present, &set, i) : (void)0;
    }
    qsort(hash, (size_t)fluid, sizeof *hash, compare_hashes);
    mcor_measure measured[2];
    for (int k = 0; k < 2; ++k)
    {
      mcor_input input = input_with_solids(k ? &present : &set);
      mcor_options options = core_options(&iso);
      options.wall_share = MCOR_WALL_SHARE_MEASURED;
      input.ignore_solids = ignored;
      input.estimate_smoothing_length = estimated;
      CORE_OWNED(mcor_free_globals) mcor_globals globals;
      CORE_OK(*state, mcor_measure_globals(*state, &input, &options, &globals));
      measured[k] = globals.measured;
    }
    const mcor_measure *m = &measured[0], *same = &measured[1];
    assert_true(m->h_estimate == same->h_estimate && m->wall_share == same->wall_share);
    CORE_CHECK((m->h_estimate > 0) == estimated && (m->wall_share > 0) == !ignored, way,
      m->h_estimate, m->wall_share);
    double count[WATCHED], spacing[WATCHED], h[WATCHED];
    for (int s = 0; s < WATCHED; ++s)
    {
      const double* x = set.position + 3 * hash[s][1];
      double nearest = INFINITY;
      count[s] = 0;
      h[s] = estimated ? m->h_estimate : set.smoothing_length[hash[s][1]];
      for (int64_t i = 0; i < N; ++i)
      {
        const double *at = set.position + 3 * i,
                     d[3] = { at[0] - x[0], at[1] - x[1], at[2] - x[2] };
        const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (set.solid[i] == 0 || (set.solid[i] == 1 && !ignored))
        {
          count[s] += square < 4 * h[s] * h[s];
          nearest = square > 0 ? fmin(nearest, square) : nearest;
        }
      }
      spacing[s] = sqrt(nearest);
    }
    CORE_CHECK(m->neighbours == mcor_median_of(count, WATCHED) &&
        fabs(m->spacing / mcor_median_of(spacing, WATCHED) - 1) < 1e-12 &&
        m->h_median == mcor_median_of(h, WATCHED),
      way, m->neighbours, m->spacing, m->h_median);
  }
}

/* Returns the block's particles, followed by `far` particles at great distances, whose scalar is NaN. */
static particle_set add_far(const particle_set* block, int far)
{
  particle_set set = add_particles(block, far);
  for (int64_t i = block->count; i < set.count; ++i)
  {
    const double place[3] = { 0.5, i % 2 ? 1e7 : -3e9, 1e6 * (double)(i - block->count) };
    memcpy(set.position + 3 * i, place, sizeof place);
    set.smoothing_length[i] = block->smoothing_length[0];
    set.volume[i] = block->volume[0];
    set.scalar[i] = NAN;
    set.solid[i] = 0;
  }
  return set;
}

/* Checks that eight far particles are left out, with a warning, and that nine are an error. */
static void test_few(void** state)
{
  const double iso = 0.5;
  CORE_SET block = core_make_block(SIDE, 0.2, 3, core_ball);
  CORE_SET set = add_far(&block, 8);
  mcor_options options = core_options(&iso);
  options.field = MCOR_WEIGHT_SUM;
  for (int widest = 1; widest <= 2; ++widest)
  {
    options.widen = widest;
    check_same(*state, &block, &set, core_input, &options);
  }
  options.widen = 1;
  mcor_input input = core_input_to_keep(&set);
  for (int again = 0; again < 2; ++again) /* nothing of such a run is kept */
  {
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    assert_int_equal(surface.statistics.far_particles, 8);
    assert_int_equal(surface.statistics.far_first, BLOCK);
    assert_true(surface.statistics.far_place[1] == -3e9);
    CORE_MESSAGE message = mcor_describe_warning(MCOR_WARN_FAR, &input, &options, &surface);
    assert_int_equal(message.code, MCOR_SAYS_PARTICLES_FAR);
    assert_non_null(strstr(message.text, "particle 1000"));
  }
  particle_set_free(&set);
  set = add_far(&block, 9);
  input = core_input(&set);
  mcor_surface surface;
  assert_int_equal(mcor_extract(*state, &input, &options, &surface), MCOR_OUT_OF_CAPACITY);
  assert_non_null(strstr(mcor_last_error(*state), "far away"));
}

/* Nine far particles are too many to be left out, but do not matter with a box or at points. */
static void test_region(void** state)
{
  const double iso = 0.5, box[6] = { -3, 20, -2.5, 30, -40, 3 };
  CORE_SET block = core_make_block(SIDE, 0.2, 3, core_ball);
  CORE_SET set = add_far(&block, 9);
  const mcor_input near = core_input(&block), input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.field = MCOR_WEIGHT_SUM;
  memcpy(options.box, box, sizeof box);
  for (int widest = 1; widest <= 4; ++widest) /* at 4, sums reach beyond the region's margin */
  {
    options.widen = widest;
    check_same(*state, &block, &set, core_input, &options);
  }
  options.box[0] =
    3; /* volumes and sums of particles that reach the region include particles beyond it */
  for (int widest = 0; widest <= 4; ++widest)
  {
    const mcor_input one = widest == 0 ? input_of_masses(&block) : near,
                     other = widest == 0 ? input_of_masses(&set) : input;
    options.widen = widest == 0 ? 1 : widest;
    CORE_SURFACE expected = core_extract(*state, &one, &options);
    CORE_SURFACE surface = core_extract(*state, &other, &options);
    CORE_CHECK(surface.triangle_count > 0 && core_hash(&surface) == core_hash(&expected), widest);
  }
  options.widen = 1;
  options.periodic[0] = -5; /* from there images reach the box */
  options.periodic[1] = 5;
  options.box[0] = -5;
  options.box[1] = -4;
  check_same(*state, &block, &set, core_input, &options);
  memset(options.periodic, 0, sizeof options.periodic);
  memset(options.box, 0, sizeof box);
  const mcor_gauge_line lines[2] = { { .from = { 0, 0, -20 }, .to = { 0, 0, 20 } },
    { .from = { 50, 0, 0 }, .to = { 60, 0, 0 } } };
  CORE_GAUGES expected, gauges;
  CORE_OK(*state, mcor_gauge(*state, &near, &options, lines, 2, &expected));
  CORE_OK(*state, mcor_gauge(*state, &input, &options, lines, 2, &gauges));
  assert_true(expected.readings[0].crossing_count == 2);
  assert_true(gauges.readings[0].last == expected.readings[0].last);
  assert_int_equal(gauges.readings[1].state, expected.readings[1].state);
  const double places[6] = { 0.25, 0.5, 1, 3, 2, 1 };
  const mcor_array points = core_array(places, 3);
  for (int kept = 0; kept < 2; ++kept)
  {
    const mcor_input kept_near = core_input_to_keep(&block), kept_all = core_input_to_keep(&set);
    CORE_SAMPLES one, other;
    CORE_OK(*state, mcor_probe(*state, kept ? &kept_near : &near, &options, &points, 2, &one));
    CORE_OK(*state, mcor_probe(*state, kept ? &kept_all : &input, &options, &points, 2, &other));
    assert_true(one.weight_sum[0] > 0.9 && one.weight_sum[0] == other.weight_sum[0]);
    assert_true(one.weight_sum[1] == other.weight_sum[1]);
  }
}

/* Checks a zoom: small particles lie in a lattice of large ones whose supports reach all small ones. */
static void test_zoom(void** state)
{
  const double iso = 0.5;
  CORE_SET small = core_make_block(SIDE, 0, 1, core_slope);
  CORE_SET set = particle_set_make(small.count + 64);
  for (int64_t i = 0; i < set.count; ++i)
  {
    const int64_t k = i - small.count;
    const bool is_small = k < 0;
    const double grid[3] = { (double)(k % 4) - 1.3, (double)(k / 4 % 4) - 1.7,
      (double)(k / 16) - 1.1 };
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] = is_small ? small.position[3 * i + a] : 4e5 * grid[a];
    }
    set.smoothing_length[i] = is_small ? 1.3 : 5.2e5;
    set.volume[i] = is_small ? 1 : 6.4e16;
    set.scalar[i] = is_small ? 1 : 1e-9;
  }
  const mcor_input input = core_input(&set), alone = core_input(&small);
  mcor_options options = core_options(&iso);
  mcor_surface surface;
  options.field = MCOR_SUM;
  assert_int_equal(mcor_extract(*state, &input, &options, &surface), MCOR_OUT_OF_CAPACITY);
  const double box[6] = { -20, 20, -20, 20, -20, 20 };
  memcpy(options.box, box, sizeof box);
  options.field = MCOR_WEIGHT_SUM;
  CORE_SURFACE expected = core_extract(*state, &alone, &options);
  options.field = MCOR_SUM;
  for (int uniform = 0; uniform < 2; ++uniform)
  {
    options.level_limit = uniform ? 0 : MCOR_CUBE_LEVELS - 1;
    surface = core_extract(*state, &input, &options);
    CORE_REPORT report = core_check_mesh(&surface);
    assert_true(surface.statistics.is_closed);
    /* The small particles' scalars are 1 and the large ones' nearly 0, so the sum is the small
     * particles' weight sum. */
    CORE_CHECK(fabs(surface.statistics.volume / expected.statistics.volume - 1) < 0.005,
      surface.statistics.volume, expected.statistics.volume);
    mcor_free_surface(&surface);
  }
}

CORE_MAIN(core_set_up, core_tear_down, test_absent, test_measures, test_few, test_region, test_zoom)
