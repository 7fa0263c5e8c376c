/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests that gauges find every crossing of the level. The crossings are compared with sums in double precision at ten
 * times as many points. */

#include "core_fixture.h"
#include "mcor_vector.h"

#define LEVEL 0.5
#define ERROR_OF_WEIGHT 1e-4

/* Returns whether there is a particle at a point of a lattice of spacing 1: in a pool with waves and a bubble, or in a
 * droplet above the pool. */
static int pool_has(const double x[3])
{
  const double dx = x[0] - 12, dy = x[1] - 8, bubble = x[2] - 5, drop = x[2] - 15;
  const double ball = dx * dx + dy * dy;
  return (x[2] <= 9 + 1.5 * sin(0.5 * x[0]) && ball + bubble * bubble > 3.2 * 3.2) ||
    ball + drop * drop < 1.9 * 1.9;
}

static particle_set make_pool(int wave)
{
  particle_set set = particle_set_make(24 * 16 * 20);
  int64_t n = 0;
  for (int i = 0; i < 24 * 16 * 20; ++i)
  {
    const double x[3] = { i % 24 + 0.5, i / 24 % 16 + 0.5, i / (24 * 16) + 0.5 };
    if (wave ? pool_has(x) : x[2] < 10)
    {
      memcpy(set.position + 3 * n, x, sizeof x);
      set.smoothing_length[n] = 1.3;
      set.volume[n] = 1;
      ++n;
    }
  }
  set.count = n;
  return set;
}

typedef struct gauge_counts
{
  int crossings, close_pairs, wet, full, dry;
} gauge_counts;

static double weight_at(const oracle_field* field, const mcor_gauge_line* line, double t)
{
  double point[3];
  oracle_sample sample;
  mcor_point_between(line->from, line->to, t, point);
  oracle_evaluate(field, NULL, point, &sample);
  return sample.weight;
}

static double length_of(const mcor_gauge_line* line)
{
  double way[3];
  mcor_subtract(line->to, line->from, way);
  return sqrt(mcor_dot(way, way));
}

/* Compares the reading of a line with the crossings that dense samples find. A pair of crossings may be missing or
 * added where the weight sum between them differs from the level by less than the sum's error. */
static void check_line(const oracle_field* field, const mcor_gauge_line* line,
  const mcor_gauges* gauges, int64_t number, double step, gauge_counts* counts)
{
  const mcor_gauge_reading* r = &gauges->readings[number];
  const double* at = gauges->crossings + r->first_crossing;
  const double length = length_of(line);
  const int n = (int)ceil(length / step);
  for (int64_t i = 0; i < r->crossing_count; ++i)
  {
    const double error = fabs(weight_at(field, line, at[i] / length) - LEVEL);
    CORE_CHECK(error <= ERROR_OF_WEIGHT, number, error);
    CORE_CHECK(i == 0 || at[i] >= at[i - 1], number);
    /* The gauge's samples are 10 steps apart. Crossings less than 5 steps apart are a close pair. */
    counts->close_pairs += i > 0 && at[i] - at[i - 1] < 5 * step;
  }
  double before = weight_at(field, line, 0), depth = 0;
  int64_t next = 0;
  for (int i = 1; i <= n; ++i)
  {
    const double after = weight_at(field, line, (double)i / n);
    int64_t passed = 0;
    for (; next < r->crossing_count && at[next] <= length * i / n; ++next, ++passed)
    {
    }
    const int changes = (before >= LEVEL) != (after >= LEVEL);
    const int certain =
      fabs(before - LEVEL) > ERROR_OF_WEIGHT && fabs(after - LEVEL) > ERROR_OF_WEIGHT;
    CORE_CHECK(!certain || passed % 2 == changes, number, length * i / n, passed, changes);
    depth += (before >= LEVEL) + (after >= LEVEL);
    before = after;
  }
  counts->crossings += (int)r->crossing_count;
  counts->wet += r->state == MCOR_GAUGE_WET;
  counts->full += r->state == MCOR_GAUGE_FULL;
  counts->dry += r->state == MCOR_GAUGE_DRY;
  assert_true(
    fabs(r->depth - 0.5 * depth * length / n) < 0.5 * step * (double)(r->crossing_count + 1));
}

static void check_reading(
  const oracle_field* field, const mcor_gauge_line* line, const mcor_gauge_reading* r)
{
  const double length = length_of(line);
  const int full = weight_at(field, line, 1) >= LEVEL;
  if (r->state == MCOR_GAUGE_DRY)
  {
    assert_true(r->crossing_count == 0 && r->depth == 0 && isnan(r->first) && isnan(r->last) &&
      isnan(r->place[0]));
    return;
  }
  double place[3];
  mcor_point_between(line->from, line->to, r->last / length, place);
  mcor_subtract(place, r->place, place);
  assert_true((r->state == MCOR_GAUGE_FULL) == full && sqrt(mcor_dot(place, place)) < 1e-9);
  assert_true(r->first <= r->last && r->last <= length * (1 + 1e-12) && r->depth <= r->last + 1e-9);
  assert_true(!full || fabs(r->last - length) < 1e-9);
}

static void check_lines(mcor_context* context, const particle_set* set,
  const mcor_gauge_line* lines, int count, mcor_sph_kernel kernel, mcor_type precision,
  gauge_counts* counts)
{
  const mcor_input input = core_input(set);
  mcor_options options = core_options(NULL);
  options.precision = precision;
  options.sph_kernel = kernel;
  CORE_GAUGES gauges;
  CORE_OK(context, mcor_gauge(context, &input, &options, lines, count, &gauges));
  assert_int_equal(gauges.count, count);
  CORE_FIELD field = oracle_make_field(set, (oracle_kernel)kernel, ORACLE_WEIGHT, 1);
  for (int i = 0; i < count; ++i)
  {
    check_line(&field, &lines[i], &gauges, i, 0.025 * oracle_smallest_h(set), counts);
    check_reading(&field, &lines[i], &gauges.readings[i]);
  }
}

static mcor_gauge_line* random_lines(int count, const double low[3], const double high[3])
{
  mcor_gauge_line* lines = oracle_allocate(count, sizeof *lines);
  uint64_t seed = 7;
  for (int i = 0; i < count; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      lines[i].from[a] = low[a] + (high[a] - low[a]) * random_unit(&seed);
      lines[i].to[a] = low[a] + (high[a] - low[a]) * random_unit(&seed);
    }
  }
  return lines;
}

static void test_pool_with_waves(void** state)
{
  CORE_SET set = make_pool(1);
  const double low[3] = { -4, -4, -4 }, high[3] = { 28, 20, 24 };
  CORE_FREED mcor_gauge_line* lines = random_lines(150, low, high);
  for (int i = 0; i < 40; ++i) /* upright lines through the bubble and the droplet */
  {
    lines[i] =
      (mcor_gauge_line){ .from = { 0.6 * i + 0.2, 8, -3 }, .to = { 0.6 * i + 0.2, 8, 20 } };
  }
  for (int p = 0; p < 2; ++p)
  {
    gauge_counts counts = { 0 };
    check_lines(
      *state, &set, lines, 150, MCOR_CUBIC_SPLINE, p ? MCOR_FLOAT64 : MCOR_FLOAT32, &counts);
    assert_true(counts.crossings > 200 && counts.wet > 50 && counts.full > 10 && counts.dry > 5);
  }
}

/* Checks sparse random particles: the weight sum is near the level everywhere, and crosses it often and by little. */
static void test_noise(void** state)
{
  CORE_SET set = core_make_random(1500, 10, 0.6, 1.0, 3);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.volume[i] = 0.36;
  }
  const double low[3] = { -6, -6, -6 }, high[3] = { 6, 6, 6 };
  CORE_FREED mcor_gauge_line* lines = random_lines(1000, low, high);
  for (int kernel = 0; kernel < MCOR_SPH_KERNEL_COUNT; ++kernel)
  {
    const mcor_sph_kernel k = (mcor_sph_kernel)kernel;
    gauge_counts counts = { 0 };
    check_lines(*state, &set, lines, k == MCOR_CUBIC_SPLINE ? 1000 : 400, k, MCOR_FLOAT32, &counts);
    CORE_CHECK(counts.crossings > 700, kernel, counts.crossings);
    CORE_CHECK(counts.close_pairs > (k == MCOR_CUBIC_SPLINE ? 5 : 0), kernel, counts.close_pairs);
  }
}

/* Checks that computed volumes give the right water level too, though particles near the top lack half of their
 * neighbours: with usual smoothing lengths, all kernels but M'4, masses or none, in space and in a plane. */
static void test_still_pool_of_computed_volumes(void** state)
{
  static const struct
  {
    mcor_sph_kernel kernel;
    double h[4];
  } cases[] = { { MCOR_CUBIC_SPLINE, { 1, 1.3, 1.5, 2 } }, { MCOR_QUADRATIC, { 1.3, 1.6 } },
    { MCOR_QUINTIC_SPLINE, { 1, 1.3 } }, { MCOR_WENDLAND_C2, { 1.2, 1.3, 1.7, 2.078 } },
    { MCOR_QUARTIC_SPLINE, { 1, 1.3 } }, { MCOR_WENDLAND_C4, { 1.5, 2 } },
    { MCOR_WENDLAND_C6, { 1.6, 2 } }, { MCOR_SINC_6, { 1.2, 1.6 } } };
  const mcor_gauge_line line = { .from = { 12.3, 8.1, 3 }, .to = { 12.3, 8.1, 15 } };
  CORE_SET space = make_pool(0), plane = particle_set_make(24 * 10);
  for (int64_t i = 0; i < 24 * 10; ++i)
  {
    const double x[3] = { (double)(i % 24) + 0.5, 8.1, (double)(i / 24) + 0.5 };
    memcpy(plane.position + 3 * i, x, sizeof x);
  }
  for (size_t c = 0; c < 8 * sizeof cases / sizeof cases[0]; ++c)
  {
    const double h = cases[c / 8].h[c / 2 % 4];
    if (h == 0)
    {
      continue;
    }
    mcor_input input = core_input(c % 2 ? &plane : &space);
    mcor_options options = core_options(NULL);
    options.sph_kernel = cases[c / 8].kernel;
    input.smoothing_length = (mcor_array){ .constant = h };
    input.volume = (mcor_array){ 0 };
    input.mass = (mcor_array){ .constant = c & 2 ? 3 : 0 };
    CORE_GAUGES gauges;
    CORE_OK(*state, mcor_gauge(*state, &input, &options, &line, 1, &gauges));
    const double level = gauges.readings[0].place[2];
    CORE_CHECK(
      fabs(level - 10) < 0.05, mcor_sph_kernel_name(options.sph_kernel), h, c % 2 ? 2 : 3, level);
  }
}

/* A gauge beyond a side of the period must read the fluid's image there. All shifts are exact, so no bit differs. */
static void test_period(void** state)
{
  CORE_SET set = make_pool(1);
  const mcor_gauge_line lines[2] = { { .from = { 3.25, 8, -2 }, .to = { 3.25, 8, 20 } },
    { .from = { 3.25 + 48, 8, -2 }, .to = { 3.25 + 48, 8, 20 } } };
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(NULL);
  options.periodic[1] = 24;
  CORE_GAUGES gauges;
  CORE_OK(*state, mcor_gauge(*state, &input, &options, lines, 2, &gauges));
  assert_int_equal(gauges.readings[0].crossing_count, 2);
  assert_int_equal(gauges.readings[1].crossing_count, 2);
  assert_true(memcmp(gauges.crossings, gauges.crossings + 2, 2 * sizeof(double)) == 0);
}

/* A line's readings must have the same bits if it is measured alone or among others, and if particles stay on the
 * device or not. */
static void test_same_bits(void** state)
{
  CORE_SET set = make_pool(1);
  const double low[3] = { -4, -4, -4 }, high[3] = { 28, 20, 24 };
  CORE_FREED mcor_gauge_line* lines = random_lines(20, low, high);
  const mcor_input input = core_input(&set), kept = core_input_to_keep(&set);
  mcor_options options = core_options(NULL);
  CORE_GAUGES all;
  CORE_OK(*state, mcor_gauge(*state, &input, &options, lines, 20, &all));
  for (int i = 0; i < 20; ++i)
  {
    CORE_GAUGES one;
    CORE_OK(*state, mcor_gauge(*state, i % 2 ? &input : &kept, &options, &lines[i], 1, &one));
    const mcor_gauge_reading *a = &all.readings[i], *b = &one.readings[0];
    assert_int_equal(a->crossing_count, b->crossing_count);
    assert_true(memcmp(&a->first, &b->first, sizeof a->first) == 0 && a->depth == b->depth);
    assert_true(memcmp(all.crossings + a->first_crossing, one.crossings,
                  (size_t)a->crossing_count * sizeof(double)) == 0);
  }
}

/* Particles on a line define no plane, so they are measured in space. */
static void test_particles_on_a_line(void** state)
{
  CORE_SET set = make_pool(0);
  const double level = 0.1;
  const mcor_gauge_line line = { .from = { 3, 0.5, -2 }, .to = { 3, 0.75, 3 } };
  mcor_input input = core_input(&set);
  mcor_options options = core_options(&level);
  input.count = 24;
  CORE_GAUGES found, in_space;
  CORE_OK(*state, mcor_gauge(*state, &input, &options, &line, 1, &found));
  options.dimension = 3;
  CORE_OK(*state, mcor_gauge(*state, &input, &options, &line, 1, &in_space));
  assert_int_equal(found.crossing_count, 2);
  assert_true(memcmp(found.crossings, in_space.crossings, 2 * sizeof(double)) == 0);
}

/* Checks that the call fails with a message in which core_told finds the words. */
static void refuse(mcor_context* context, const mcor_input* input, const mcor_options* options,
  const mcor_gauge_line* line, const char* words)
{
  mcor_gauges gauges;
  CORE_FAILS(
    context, MCOR_INVALID_ARGUMENT, mcor_gauge(context, input, options, line, 1, &gauges), words);
  assert_true(gauges.count == 0 && !gauges.readings);
}

static void test_weird(void** state)
{
  CORE_SET set = make_pool(0);
  mcor_input input = core_input(&set);
  mcor_options options = core_options(NULL);
  const mcor_gauge_line none = { .from = { 1, 2, 3 }, .to = { 1, 2, 3 }, .name = "bow" };
  const mcor_gauge_line nan = { .from = { 1, NAN, 3 }, .to = { 1, 2, 4 } };
  const mcor_gauge_line endless = { .from = { -1e308, 0, 3 }, .to = { 1e308, 2, 4 } };
  const mcor_gauge_line far = { .from = { 100, 2, 3 }, .to = { 1e9, 2, 4 } };
  const mcor_gauge_line good = { .from = { 3, 3, 3 }, .to = { 3, 3, 3.1 } };
  refuse(*state, &input, &options, &none, "GAUGE_WITHOUT_LENGTH|'bow'");
  refuse(*state, &input, &options, &nan, "GAUGE_NOT_FINITE");
  refuse(*state, &input, &options, &endless, "GAUGE_TOO_LONG");
  const double zero = 0;
  options.iso_values = &zero;
  options.iso_count = 1;
  refuse(*state, &input, &options, &good, "FLUID_LEVEL");
  options.iso_count = 0;
  CORE_GAUGES gauges;
  CORE_OK(*state, mcor_gauge(*state, &input, &options, &far, 1, &gauges));
  assert_true(gauges.readings[0].state == MCOR_GAUGE_DRY && gauges.readings[0].outside);
  mcor_free_gauges(&gauges);
  CORE_OK(*state,
    mcor_gauge(*state, &input, &options, &good, 1, &gauges)); /* the line is shorter than a step */
  assert_true(gauges.readings[0].state == MCOR_GAUGE_FULL && !gauges.readings[0].outside);
  assert_true(fabs(gauges.readings[0].depth - 0.1) < 1e-9);
  mcor_free_gauges(&gauges);
  CORE_OK(*state, mcor_gauge(*state, &input, &options, NULL, 0, &gauges));
  assert_int_equal(gauges.count, 0);
  mcor_free_gauges(&gauges);
  input.count = 0;
  CORE_OK(*state, mcor_gauge(*state, &input, &options, &good, 1, &gauges));
  assert_true(gauges.readings[0].state == MCOR_GAUGE_DRY && gauges.readings[0].outside);
}

CORE_MAIN(core_set_up, core_tear_down, test_pool_with_waves, test_noise,
  test_still_pool_of_computed_volumes, test_period, test_same_bits, test_particles_on_a_line,
  test_weird)
