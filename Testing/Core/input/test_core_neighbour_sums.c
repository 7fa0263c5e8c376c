/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests smoothing lengths by neighbours, and summed densities. They are compared with sums over all pairs, and with
 * Plummer's sphere. */

#include "core_fixture.h"
#include "mcor_plane.h"
#include "mcor_vector.h"

/* Returns sum_j m_j W h^d over all particles and their images (d: dimension); m_j = 1 if there are no masses. */
static double sum_of_all(const particle_set* set, const mcor_options* options, int dimension,
  const double* mass, int64_t i, double h)
{
  double sum = 0;
  const double scale =
    h * h * h * (dimension == 2 ? mcor_kernel_of(options->sph_kernel)->plane_factor : 1);
  int64_t images[3];
  for (int a = 0; a < 3; ++a)
  {
    images[a] = options->periodic[2 * a] < options->periodic[2 * a + 1] ? 3 : 0;
  }
  for (int64_t j = 0; j < set->count; ++j)
  {
    for (int64_t n = 0; n < (2 * images[0] + 1) * (2 * images[1] + 1) * (2 * images[2] + 1); ++n)
    {
      const int64_t x = n % (2 * images[0] + 1), yz = n / (2 * images[0] + 1);
      const int64_t k[3] = { x - images[0], yz % (2 * images[1] + 1) - images[1],
        yz / (2 * images[1] + 1) - images[2] };
      double d[3];
      for (int a = 0; a < 3; ++a)
      {
        d[a] = set->position[3 * i + a] - set->position[3 * j + a] +
          (double)k[a] * (options->periodic[2 * a + 1] - options->periodic[2 * a]);
      }
      sum += (mass ? mass[j] : 1) * scale *
        oracle_kernel_value((oracle_kernel)options->sph_kernel, h, d, NULL);
    }
  }
  return sum;
}

/* Makes particles in clusters, so that smoothing lengths vary by a factor of more than 20. */
static particle_set make_clusters(int64_t count, int dimension, uint64_t seed)
{
  particle_set set = particle_set_make(count);
  for (int64_t i = 0; i < count; ++i)
  {
    const double size = pow(0.1, (double)(i % 3));
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] = dimension == 2 && a == 1
        ? 4
        : 0.5 + 0.3 * (double)(i % 3) + size * (random_unit(&seed) - 0.5);
    }
    set.solid[i] = i % 5 == 0;
    set.has_solids = 1;
  }
  return set;
}

static void find_lengths(
  const mcor_input* input, const mcor_options* options, int64_t count, double* lengths)
{
  CORE_MESSAGE why;
  const mcor_status status =
    mcor_find_smoothing_lengths(input, options, MCOR_USUAL_ETA, count, lengths, &why);
  CORE_CHECK(status == MCOR_OK, why.text);
}

static void sum_densities(
  const mcor_input* input, const mcor_options* options, int64_t count, double* densities)
{
  CORE_MESSAGE why;
  const mcor_status status = mcor_sum_densities(input, options, count, densities, &why);
  CORE_CHECK(status == MCOR_OK, why.text);
}

static void check_sums(mcor_sph_kernel kernel, int dimension, int periodic)
{
  enum
  {
    count = 400
  };
  double lengths[count], densities[count], mass[count], again[count], some[count];
  uint8_t marks[count] = { 0 };
  CORE_SET set = make_clusters(count, dimension, 3 + (uint64_t)kernel);
  mcor_options options = core_options(NULL);
  options.sph_kernel = kernel;
  options.dimension = 0;
  for (int a = 0; a < 3 && periodic; a += dimension == 2 ? 2 : 1)
  {
    options.periodic[2 * a] = -0.1;
    options.periodic[2 * a + 1] = 1.4;
  }
  mcor_input input = core_input(&set);
  find_lengths(&input, &options, input.count, lengths);
  double least = INFINITY, most = 0;
  for (int64_t i = 0; i < count; ++i)
  {
    const double sum = sum_of_all(&set, &options, dimension, NULL, i, lengths[i]);
    CORE_CHECK(fabs(sum / pow(1.3, dimension) - 1) < 1e-5, mcor_sph_kernel_name(kernel), dimension,
      i, lengths[i], sum);
    mass[i] = 1 + (double)(i % 7);
    least = fmin(least, lengths[i]);
    most = fmax(most, lengths[i]);
  }
  assert_true(most > 20 * least);
  input.mass = core_array(mass, 1);
  input.smoothing_length = core_array(lengths, 1);
  sum_densities(&input, &options, input.count, densities);
  for (int64_t i = 0; i < count; ++i)
  {
    const double expected =
      sum_of_all(&set, &options, dimension, mass, i, lengths[i]) / pow(lengths[i], dimension);
    CORE_CHECK(fabs(densities[i] / expected - 1) < 1e-12, i, densities[i], expected);
  }
  /* The particles in another order give the same bits. */
  CORE_FREED int64_t* order = core_make_order(count, 5);
  CORE_SET other = particle_set_make(count);
  for (int64_t i = 0; i < count; ++i)
  {
    memcpy(other.position + 3 * i, set.position + 3 * order[i], 3 * sizeof(double));
  }
  input = core_input(&other);
  find_lengths(&input, &options, input.count, again);
  for (int64_t i = 0; i < count; ++i)
  {
    assert_true(again[i] == lengths[order[i]]);
  }
  /* A call may ask for the first few particles' lengths only, with all particles as neighbours. Absent particles must
   * change nothing. */
  input = core_input(&set);
  const int64_t part = count / 3;
  memset(some, 0, sizeof some);
  find_lengths(&input, &options, part, some);
  assert_memory_equal(some, lengths, (size_t)part * sizeof *some);
  assert_true(some[part] == 0);
  for (int64_t i = part; i < count; ++i)
  {
    marks[i] = MCOR_ABSENT;
    set.position[3 * i] = NAN;
  }
  other.count = part;
  memcpy(other.position, set.position, 3 * (size_t)part * sizeof(double));
  input = core_input(&other);
  find_lengths(&input, &options, part, again);
  input = core_input(&set);
  input.solid = marks;
  input.mass = core_array(mass, 1);
  mass[part] = NAN;
  find_lengths(&input, &options, count, some);
  assert_memory_equal(some, again, (size_t)part * sizeof *some);
  assert_true(some[part] == 0);
  input.smoothing_length = core_array(some, 1);
  sum_densities(&input, &options, count, again);
  assert_true(again[0] > 0 && again[part] == 0);
  other.count = count;
}

static void test_sums(void** state)
{
  for (int k = 0; k < MCOR_SPH_KERNEL_COUNT; ++k)
  {
    if (k != MCOR_M_PRIME_4)
    {
      check_sums((mcor_sph_kernel)k, 3, 0);
      check_sums((mcor_sph_kernel)k, 2, 0);
    }
  }
  check_sums(MCOR_CUBIC_SPLINE, 3, 1);
  check_sums(MCOR_QUINTIC_SPLINE, 2, 1);
}

/* Checks that the densities of Plummer's sphere at the radii 1 and 3 follow from positions and masses alone. */
static void test_plummer(void** state)
{
  const int count = 20000;
  const double radii[2] = { 1, 3 }, isos[2] = { 0.0422, 0.000755 };
  CORE_SET set = particle_set_make(count);
  uint64_t seed = 1;
  for (int i = 0; i < count; ++i)
  {
    const double r = 1 / sqrt(pow((double)i / count + 0.5 / count, -2.0 / 3) - 1);
    const double z = 2 * random_unit(&seed) - 1, angle = 6.283185307179586 * random_unit(&seed);
    set.position[3 * i] = r * sqrt(1 - z * z) * cos(angle);
    set.position[3 * i + 1] = r * sqrt(1 - z * z) * sin(angle);
    set.position[3 * i + 2] = r * z;
  }
  mcor_options options = core_options(NULL);
  mcor_input input = core_input(&set);
  find_lengths(&input, &options, input.count, set.smoothing_length);
  input.volume = (mcor_array){ 0 };
  input.mass = (mcor_array){ .constant = 1.0 / count };
  sum_densities(&input, &options, input.count, set.scalar);
  input.density = core_array(set.scalar, 1);
  for (int k = 0; k < 2; ++k)
  {
    options.iso_values = &isos[k];
    options.iso_count = 1;
    options.field = MCOR_SUM;
    options.node_threshold = options.vertex_threshold = 0;
    options.level_limit = MCOR_CUBE_LEVELS - 1;
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    double sum = 0;
    for (int64_t p = 0; p < surface.point_count; ++p)
    {
      const double* x = surface.points + 3 * p;
      sum += sqrt(mcor_dot(x, x));
    }
    const double mean = sum / (double)surface.point_count;
    CORE_CHECK(surface.point_count > 1000 && fabs(mean / radii[k] - 1) < 0.03, mean, radii[k]);
  }
}

/* Checks that moving particles by any number of periods changes no smoothing length. */
static void test_far_beyond_period(void** state)
{
  double at[3 * 64], lengths[2][64];
  uint64_t seed = 9;
  for (int i = 0; i < 3 * 64; ++i)
  {
    at[i] = floor(1024 * random_unit(&seed)) / 1024;
  }
  mcor_options options = core_options(NULL);
  options.periodic[1] = options.periodic[3] = options.periodic[5] = 1;
  const mcor_input input = { .count = 64, .positions = core_array(at, 3) };
  for (int far = 0; far < 2; ++far)
  {
    at[12] += far * 1e6;
    at[13] -= far * 1e6;
    at[14] += far * 2e6;
    find_lengths(&input, &options, input.count, lengths[far]);
  }
  assert_memory_equal(lengths[0], lengths[1], sizeof lengths[0]);
}

/* A particle is so far away that it has no place on the space-filling curve of the other particles. Checks that it
 * changes their smoothing lengths by less than 1e-5. */
static void test_far_away(void** state)
{
  enum
  {
    N = 300
  };
  double at[3 * N], lengths[2][N];
  uint64_t seed = 9;
  const mcor_options options = core_options(NULL);
  static const double places[][3] = { { 1e12, 0, 0 }, { 0, -1e30, 1e30 }, { 0, 1e300, -1e300 } };
  for (int i = 0; i < 3 * N; ++i)
  {
    at[i] = random_unit(&seed);
  }
  for (int k = 0; k < 3; ++k)
  {
    memcpy(at + 3 * (N - 1), places[k], sizeof places[k]);
    for (int far = 0; far < 2; ++far)
    {
      const mcor_input input = { .count = N - 1 + far, .positions = core_array(at, 3) };
      find_lengths(&input, &options, input.count, lengths[far]);
    }
    for (int i = 0; i < N - 1; ++i)
    {
      CORE_CHECK(
        fabs(lengths[1][i] / lengths[0][i] - 1) < 1e-5, places[k][2], lengths[1][i], lengths[0][i]);
    }
  }
}

/* Checks a body far away along the diagonal: its smoothing lengths are as without the other particles to within 1e-5,
 * and the order of the input changes no bit. */
static void test_far_body(void** state)
{
  enum
  {
    BODY = 100,
    N = 5 * BODY
  };
  double at[3 * N], turned[3 * N], lengths[3][N];
  uint64_t seed = 9;
  const mcor_options options = core_options(NULL);
  for (int i = 0; i < 3 * N; ++i)
  {
    at[i] = random_unit(&seed) + (i < 3 * BODY ? 5000 : 0);
    turned[3 * (N - 1 - i / 3) + i % 3] = at[i];
  }
  for (int k = 0; k < 3; ++k)
  {
    const mcor_input input = { .count = k == 0 ? BODY : N,
      .positions = core_array(k == 2 ? turned : at, 3) };
    find_lengths(&input, &options, input.count, lengths[k]);
  }
  for (int i = 0; i < N; ++i)
  {
    CORE_CHECK(
      i >= BODY || fabs(lengths[1][i] / lengths[0][i] - 1) < 1e-5, lengths[1][i], lengths[0][i]);
    assert_true(lengths[2][N - 1 - i] == lengths[1][i]);
  }
}

static void expect_refusal(const mcor_input* input, const mcor_options* options, double eta,
  mcor_status expected, const char* words)
{
  CORE_MESSAGE why;
  double out[2];
  const mcor_status status =
    mcor_find_smoothing_lengths(input, options, eta, input->count, out, &why);
  CORE_CHECK(status == expected && core_tells(&why, words), status, why.text);
}

static void test_weird(void** state)
{
  double at[6] = { 1, 2, 3, 1, 2, 3 }, out[2] = { -1, -1 };
  CORE_MESSAGE why;
  mcor_options options = core_options(NULL);
  mcor_input input = { .count = 2, .positions = core_array(at, 3) };
  expect_refusal(&input, &options, 1.3, MCOR_INVALID_DATA, "NEIGHBOURS_AT_ONE_POINT");
  at[0] = 2;
  find_lengths(&input, &options, input.count, out);
  /* Two particles are too few neighbours, so the length is the extent of the domain. */
  assert_true(out[0] == 1 && out[1] == 1);
  expect_refusal(&input, &options, 0.6, MCOR_INVALID_ARGUMENT, "ETA_ILLEGAL|0.6;|0.683");
  expect_refusal(&input, &options, NAN, MCOR_INVALID_ARGUMENT, "ETA_ILLEGAL");
  assert_int_equal(
    mcor_sum_densities(&input, &options, input.count, out, &why), MCOR_INVALID_ARGUMENT);
  assert_true(core_tells(&why, "NOTHING_TO_SUM|mass"));
  options.sph_kernel = MCOR_M_PRIME_4;
  expect_refusal(&input, &options, 1.3, MCOR_INVALID_ARGUMENT, "NEIGHBOURS_OF_KERNEL");
  options.sph_kernel = MCOR_CUBIC_SPLINE;
  at[4] = NAN;
  expect_refusal(&input, &options, 1.3, MCOR_INVALID_DATA, "POSITION_NOT_FINITE|particle 1 ");
  input.count = 0;
  find_lengths(&input, &options, input.count, out);
  /* So many particles lie at one place that the smoothing length becomes the least possible. */
  double many[3 * 100] = { 0 }, lengths[100];
  many[0] = 1;
  input = (mcor_input){ .count = 100, .positions = core_array(many, 3) };
  find_lengths(&input, &options, input.count, lengths);
  assert_true(lengths[99] > 0 && lengths[99] < 1e-6);
}

CORE_MAIN(core_set_up, core_tear_down, test_sums, test_plummer, test_far_beyond_period,
  test_far_away, test_far_body, test_weird)
