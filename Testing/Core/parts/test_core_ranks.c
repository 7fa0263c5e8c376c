/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests that ranks, which are threads, have the same global values, surfaces and smoothing lengths as one process, to
 * the last bit, whichever rank holds which particles. */

#include "core_parts.h"
#include "core_ranks.h"

/* ---- Which rank has which particle ---- */

typedef int (*split_function)(const particle_set* set, int64_t i, int ranks);

static int split_scattered(const particle_set* set, int64_t i, int ranks)
{
  (void)set;
  uint64_t seed = (uint64_t)i + 1;
  return (int)(random_bits(&seed) % (uint64_t)ranks);
}

static int split_to_last(const particle_set* set, int64_t i, int ranks)
{
  (void)set;
  (void)i;
  return ranks - 1;
}

static int split_slabs(const particle_set* set, int64_t i, int ranks)
{
  const double at = (set->position[3 * i] / 14 + 0.5) * ranks;
  return at < 0 ? 0 : at < ranks ? (int)at : ranks - 1;
}

/* Gives each rank one particle, and the first rank all the others. */
static int split_uneven(const particle_set* set, int64_t i, int ranks)
{
  (void)set;
  return i < ranks ? (int)i : 0;
}

static const split_function splits[] = { split_scattered, split_to_last, split_slabs,
  split_uneven };
static const char* const split_names[] = { "scattered", "all on one", "slabs", "uneven" };

#define SPLITS (sizeof splits / sizeof splits[0])

/* Returns the particles of one rank, in reverse order. */
static particle_set take_part(const particle_set* set, split_function split, int ranks, int rank)
{
  particle_set part = particle_set_make(set->count);
  part.has_solids = set->has_solids;
  part.count = 0;
  for (int64_t i = set->count - 1; i >= 0; --i)
  {
    if (split(set, i, ranks) == rank)
    {
      particle_set_append(&part, set, i);
    }
  }
  return part;
}

/* ---- Global values ---- */

/* What an input and its options have besides the set of particles. */
typedef struct measure_case
{
  const char* name;
  int estimate, mass, field;
} measure_case;

typedef struct measure_job
{
  const particle_set* set;
  const measure_case* what;
  split_function split;
  mcor_globals globals[CORE_MOST_RANKS];
  int failing; /* the rank that has a NaN particle; -1: none */
} measure_job;

static mcor_input measure_input(
  const particle_set* set, const measure_case* what, mcor_array attributes[3])
{
  mcor_input input = core_input_with(set, attributes, 3);
  input.estimate_smoothing_length = what->estimate;
  if (what->mass)
  {
    input.mass = input.volume;
    input.volume = (mcor_array){ 0 };
  }
  attributes[0] = core_array(set->position, 3);
  attributes[1] = core_array(set->scalar, 1);
  attributes[2] = (mcor_array){ .constant = 3, .type = MCOR_FLOAT64, .components = 1 };
  return input;
}

static mcor_options measure_options(const measure_case* what)
{
  static const double iso = 0.5;
  mcor_options options = core_options(&iso);
  options.field = (mcor_field)what->field;
  options.wall_share = MCOR_WALL_SHARE_MEASURED;
  return options;
}

static mcor_status measure_part(core_rank* rank, void* data)
{
  measure_job* job = data;
  mcor_array attributes[3];
  const int r = rank->number;
  CORE_SET part = take_part(job->set, job->split, rank->world->count, r);
  if (r == job->failing)
  {
    part.position[7] = NAN;
  }
  const mcor_input input = measure_input(&part, job->what, attributes);
  mcor_options options = measure_options(job->what);
  options.ranks = &rank->ranks;
  return mcor_measure_globals(rank->context, &input, &options, &job->globals[r]);
}

static int same_globals(const mcor_globals* a, const mcor_globals* b)
{
  int same = memcmp(a, b, offsetof(mcor_globals, component_count)) == 0 &&
    a->component_count == b->component_count;
  for (int i = 0; i < a->component_count && same; ++i)
  {
    const mcor_global_component *x = a->components + i, *y = b->components + i;
    same = x->largest == y->largest && !x->varies == !y->varies &&
      (x->not_finite < 0) == (y->not_finite < 0);
  }
  return same;
}

static void check_globals(mcor_context* context, const particle_set* set, const measure_case* what)
{
  mcor_array attributes[3];
  const mcor_input input = measure_input(set, what, attributes);
  const mcor_options options = measure_options(what);
  CORE_OWNED(mcor_free_globals) mcor_globals expected;
  CORE_OK(context, mcor_measure_globals(context, &input, &options, &expected));
  assert_true(expected.measured.neighbours > 10 && expected.measured.spacing > 0);
  assert_true(expected.measured.wall_share > 0);
  assert_int_equal(what->estimate, expected.measured.h_estimate > 0);
  for (size_t s = 0; s < SPLITS; ++s)
  {
    for (int count = 1; count <= CORE_MOST_RANKS; count += count == 3 ? 5 : 1)
    {
      measure_job job = { .set = set, .what = what, .split = splits[s], .failing = -1 };
      core_world world;
      core_run_ranks(count, measure_part, &job, &world);
      core_expect_ranks(&world, what->name);
      for (int r = 0; r < count; ++r)
      {
        CORE_CHECK(same_globals(&job.globals[r], &expected), what->name, split_names[s], r, count);
        mcor_free_globals(&job.globals[r]);
      }
    }
  }
}

static particle_set make_set(void)
{
  particle_set set = core_make_random(3000, 14, 0.7, 2, 17);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] += core_ball(set.position + 3 * i);
    set.solid[i] = i % 11 == 0;
  }
  set.has_solids = 1;
  return set;
}

static void global_values(void** state)
{
  const measure_case cases[] = { { "volumes", 0, 0, MCOR_SHEPARD },
    { "masses, estimate", 1, 1, MCOR_SHEPARD }, { "sum", 0, 1, MCOR_SUM },
    { "free surface", 1, 0, MCOR_WEIGHT_SUM } };
  CORE_SET set = make_set();
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
  {
    check_globals(*state, &set, &cases[i]);
  }
  /* An outlier of the scalar makes the search for the median narrow its bins. */
  const measure_case rough = { "outliers", 0, 1, MCOR_SHEPARD };
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] = i == 5 ? 1e12 : 3 + 1e-3 * set.scalar[i];
    set.position[3 * i + 2] = i % 2 ? 0 : set.position[3 * i + 2];
  }
  check_globals(*state, &set, &rough);
}

static void not_finite_attributes(void** state)
{
  const measure_case what = { "not finite", 0, 1, MCOR_WEIGHT_SUM };
  CORE_SET set = make_set();
  for (int64_t i = 0; i < set.count; ++i)
  {
    /* With the uneven split, all values of a rank are equal, but rank 1 has another value than the
     * other ranks. */
    set.scalar[i] = i == 1 ? 1 : 2;
  }
  check_globals(*state, &set, &what);
  set.scalar[1234] = INFINITY;
  check_globals(*state, &set, &what);
}

/* A fault on one rank must be an error on all ranks, and no rank may wait for ever. */
static void faults(void** state)
{
  const measure_case what = { "fault", 0, 0, MCOR_SHEPARD };
  CORE_SET set = make_set();
  for (int failing = 0; failing < 3; ++failing)
  {
    measure_job job = { .set = &set, .what = &what, .split = split_slabs, .failing = failing };
    core_world world;
    core_run_ranks(3, measure_part, &job, &world);
    for (int r = 0; r < 3; ++r)
    {
      assert_int_equal(world.status[r], r == failing ? MCOR_INVALID_DATA : MCOR_CANCELLED);
      CORE_CHECK(
        strstr(world.error[r], r == failing ? "particle 2" : "Another rank"), world.error[r]);
      assert_null(job.globals[r].components);
    }
  }
  CORE_SET none = particle_set_make(0);
  measure_job job = { .set = &none, .what = &what, .split = split_slabs, .failing = -1 };
  core_world world;
  core_run_ranks(2, measure_part, &job, &world);
  assert_true(world.status[0] == MCOR_INVALID_DATA && world.status[1] == MCOR_INVALID_DATA);
}

/* ---- Surfaces of parts ---- */

typedef struct parts_job
{
  const particle_set* set;
  const mcor_options* options;
  const double* sides; /* along x, [ranks - 1] */
  mcor_globals globals;
  mcor_surface surface[CORE_MOST_RANKS];
  double margin; /* how far beside a box its particles are kept */
} parts_job;

static mcor_status extract_part(core_rank* rank, void* data)
{
  parts_job* job = data;
  const int r = rank->number, last = rank->world->count - 1;
  mcor_options options = *job->options;
  const double box[6] = { r > 0 ? job->sides[r - 1] : -INFINITY,
    r < last ? job->sides[r] : INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY };
  memcpy(options.box, box, sizeof box);
  options.globals = &job->globals;
  options.ranks = &rank->ranks;
  CORE_SET near = core_take_near(job->set, box, job->margin);
  const mcor_input input = core_input(&near);
  return mcor_extract(rank->context, &input, &options, &job->surface[r]);
}

/* Makes particles whose surface is a band that winds from part to part. */
static particle_set make_band(void)
{
  particle_set set = core_make_block(14, 0.2, 3, core_slope);
  for (int64_t i = 0; i < set.count; ++i)
  {
    const double* x = set.position + 3 * i;
    set.scalar[i] = 4 * sin(0.7 * x[0]) + 3 * sin(0.9 * x[1]) + x[2];
  }
  return set;
}

static void check_parts(mcor_context* context, const particle_set* set, const mcor_options* options,
  int ranks, const double* sides, double margin, int64_t least)
{
  const mcor_input input = core_input(set);
  core_triangles whole = { 0 }, all = { 0 };
  parts_job job = { .set = set, .options = options, .sides = sides, .margin = margin };
  CORE_SURFACE surface = core_extract(context, &input, options);
  CORE_OK(context, mcor_measure_globals(context, &input, options, &job.globals));
  core_add_surface(&whole, &input, &surface);
  core_world world;
  core_run_ranks(ranks, extract_part, &job, &world);
  core_expect_ranks(&world, "parts");
  int64_t cells = 0;
  for (int r = 0; r < ranks; ++r)
  {
    core_add_surface(&all, &input, &job.surface[r]);
    cells += job.surface[r].statistics.cells_used;
    mcor_free_surface(&job.surface[r]);
  }
  CORE_CHECK(whole.count > least, ranks, whole.count);
  core_expect_same("ranks", &all, &whole);
  assert_int_equal(cells, surface.statistics.cells_used);
  free(whole.bytes);
  free(all.bytes);
  mcor_free_globals(&job.globals);
}

static void parts_of_a_band(void** state)
{
  const double iso[2] = { 0.3, 2 };
  const double two[] = { 0.4 }, three[] = { -1.2, -1.0 },
               eight[] = { -1000, -7, -3, -0.05, 0.1, 4.4, 1000 };
  CORE_SET set = make_band();
  mcor_options options = core_options(iso);
  options.iso_count = 2;
  check_parts(*state, &set, &options, 1, NULL, 9, 1000);
  check_parts(*state, &set, &options, 2, two, 9, 1000);
  check_parts(*state, &set, &options, 3, three, 9, 1000);
  check_parts(*state, &set, &options, 8, eight, 9, 1000);
  options.compact = 1;
  check_parts(*state, &set, &options, 3, three, 14, 1000);
  check_parts(*state, &set, &options, 8, eight, 14, 1000);
}

/* Compares the lines of parts with the whole lines for particles in a plane, with squares of one
 * size and of several. */
static void lines_of_parts(void** state)
{
  const double iso = 0.3, two[] = { 0.4 }, three[] = { -3.1, 2.9 };
  CORE_SET set = particle_set_make(30 * 30);
  uint64_t seed = 8;
  for (int64_t i = 0; i < set.count; ++i)
  {
    double* x = set.position + 3 * i;
    x[0] = (double)(i % 30) - 14.5 + 0.4 * random_unit(&seed);
    x[1] = 2;
    x[2] = (double)(i / 30) - 14.5 + 0.4 * random_unit(&seed);
    set.smoothing_length[i] = 1.3 * (x[0] < -6 ? 1 : x[0] < 3 ? 2 : 4);
    set.volume[i] = 1;
    set.scalar[i] = 3 * sin(0.4 * x[0]) + 3 * sin(0.5 * x[2]);
  }
  for (int i = 0; i < 6; ++i)
  {
    mcor_options options = core_options(&iso);
    options.level_limit = i < 2 ? 0 : MCOR_CUBE_LEVELS - 1;
    options.topology = i & 2 ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
    options.h_scale = i < 4 ? 1 : 0.8;
    options.vertex_threshold = 0.7;
    options.preview = i == 1;
    options.compact = i % 2 == 0;
    const mcor_input input = core_input(&set);
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    assert_int_equal(surface.statistics.highest_level, i < 2 ? 0 : 2);
    CORE_CHECK(
      i < 2 || surface.statistics.cells_of_level[1] > 10, surface.statistics.cells_of_level[1]);
    check_parts(*state, &set, &options, 2, two, 80, 100);
    check_parts(*state, &set, &options, 3, three, 80, 100);
  }
}

typedef struct rank_sums
{
  const particle_set* set;
  const mcor_options* options;
  const double* whole; /* lengths of one process */
  int64_t wrong[CORE_MOST_RANKS], held[CORE_MOST_RANKS];
} rank_sums;

/* Finds the smoothing lengths of the particles in this rank's slab: first from these particles alone, then with all
 * particles within 1.25 times the supports that were found. Counts the lengths that differ from one process's. */
static mcor_status sum_on_rank(core_rank* rank, void* data)
{
  rank_sums* job = data;
  mcor_message why;
  mcor_status status = MCOR_OK;
  const int64_t count = job->set->count;
  mcor_options options = *job->options;
  options.ranks = &rank->ranks;
  CORE_FREED double* at = oracle_allocate(3 * count, sizeof *at);
  CORE_FREED double* lengths = oracle_allocate(count, sizeof *lengths);
  CORE_FREED int64_t* number = oracle_allocate(count, sizeof *number);
  mcor_input input = { .positions = core_array(at, 3) };
  int64_t own = 0;
  for (int all = 0; all < 2; ++all)
  {
    for (int64_t i = 0; i < count; ++i)
    {
      const double* x = job->set->position + 3 * i;
      const bool is_own = (int)(x[0] / 1.5 * rank->world->count) == rank->number;
      bool is_taken = is_own && !all;
      for (int64_t k = 0; k < own && !is_own && !is_taken; ++k)
      {
        double square = 0;
        for (int a = 0; a < 3; ++a)
        {
          const double period = options.periodic[2 * a + 1] - options.periodic[2 * a],
                       d = x[a] - at[3 * k + a],
                       least = period > 0 ? d - period * round(d / period) : d;
          square += least * least;
        }
        is_taken = sqrt(square) < 1.25 * 2 * lengths[k];
      }
      if (is_taken)
      {
        memcpy(at + 3 * input.count, x, 3 * sizeof *at);
        number[input.count++] = i;
      }
    }
    own = all ? own : input.count;
    MCOR_THEN(status, mcor_find_smoothing_lengths(&input, &options, 1.3, own, lengths, &why));
  }
  job->held[rank->number] = input.count;
  for (int64_t k = 0; k < own; ++k)
  {
    job->wrong[rank->number] += lengths[k] != job->whole[number[k]];
  }
  return status;
}

/* Checks that ranks find the same smoothing lengths by neighbours as one process, to the last bit, if each rank also
 * has all particles around its own ones. */
static void lengths_by_neighbours(void** state)
{
  (void)state;
  enum
  {
    N = 3000
  };
  for (int periodic = 0; periodic < 2; ++periodic)
  {
    mcor_message why;
    double whole[N];
    uint64_t seed = 7;
    CORE_SET set = particle_set_make(N);
    for (int i = 0; i < 3 * N; ++i) /* clusters, so that lengths vary by a factor of 100 */
    {
      set.position[i] = 0.5 + 0.3 * (i / 3 % 3) + pow(0.1, i / 3 % 3) * (random_unit(&seed) - 0.5);
    }
    mcor_options options = core_options(NULL);
    for (int a = 0; a < 3 && periodic; ++a)
    {
      options.periodic[2 * a] = -0.1;
      options.periodic[2 * a + 1] = 1.4;
    }
    const mcor_input input = { .count = N, .positions = core_array(set.position, 3) };
    assert_int_equal(mcor_find_smoothing_lengths(&input, &options, 1.3, N, whole, &why), MCOR_OK);
    for (int ranks = 2; ranks <= 3; ++ranks)
    {
      rank_sums job = { .set = &set, .options = &options, .whole = whole };
      core_world world;
      core_run_ranks(ranks, sum_on_rank, &job, &world);
      core_expect_ranks(&world, "lengths");
      for (int r = 0; r < ranks; ++r)
      {
        CORE_CHECK(
          job.wrong[r] == 0 && (periodic || job.held[r] < N), r, job.wrong[r], job.held[r]);
      }
    }
  }
}

CORE_MAIN(core_set_up, core_tear_down, global_values, not_finite_attributes, faults,
  parts_of_a_band, lines_of_parts, lengths_by_neighbours)
