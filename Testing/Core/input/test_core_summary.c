/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compares the estimated number of a run's cubes with numbers worked out by hand. Tests the text on
 * what a run used. */

#include "core_fixture.h"

/* Four particles, the last of which is twice as large. */
static const double place[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
static const double length[4] = { 0.1, 0.1, 0.1, 0.2 };

static mcor_input make_input(void)
{
  return (mcor_input){ .count = 4,
    .positions = { .data = place, .type = MCOR_FLOAT64, .components = 3 },
    .smoothing_length = { .data = length, .type = MCOR_FLOAT64, .name = "h" } };
}

static void assert_near(double found, double expected)
{
  assert_true(fabs(found - expected) < 1e-9 * expected);
}

static void test_estimate(void** state)
{
  mcor_input input = make_input();
  mcor_options options;
  mcor_set_default_options(&options);
  const double one = pow(2.0 / 1.3, 3); /* one: cubes that a particle of the smallest size takes */
  const double least = mcor_least_smoothing_length(&input);
  assert_true(least == 0.1);
  /* The large particle's cubes are twice as large, unless all cubes have one size. */
  assert_near(mcor_estimate_cells(&input, &options, least), 4 * one);
  options.capping = MCOR_CAP_PERIOD; /* caps make all cubes one size */
  assert_near(mcor_estimate_cells(&input, &options, least), 11 * one);
  options.capping = 0;
  options.level_limit = 0;
  assert_near(mcor_estimate_cells(&input, &options, least), 11 * one);
  const uint8_t solid[4] = { 0, 0, 0, 1 };
  input.solid = solid;
  assert_near(mcor_estimate_cells(&input, &options, least), 3 * one);
  memcpy(options.box, (double[6]){ 0, 2, -1, 0.5, -1, 2 }, sizeof options.box);
  assert_near(mcor_estimate_cells(&input, &options, least), 2 * one);
  options.cube_size = 0.1;
  assert_near(mcor_estimate_cells(&input, &options, least), 2 * one / 8);
  input.estimate_smoothing_length = 1;
  assert_true(mcor_estimate_cells(&input, &options, 1) == 0);
  input.solid = (const uint8_t[4]){ 1, 1, 1, 1 };
  assert_true(isinf(mcor_least_smoothing_length(&input)));
  assert_null(mcor_describe_estimate(0.999e9).text);
  CORE_MESSAGE message = mcor_describe_estimate(2e9);
  assert_int_equal(message.code, MCOR_SAYS_RUN_HUGE);
  assert_non_null(strstr(message.text, " 2e+09 "));
}

static void expect(char* text, const char* words)
{
  assert_string_equal(text, words);
  free(text);
}

static void test_words(void** state)
{
  mcor_input input = make_input();
  mcor_statistics found = { .smoothing_length_min = 0.1, .smoothing_length_max = 0.2 };
  expect(mcor_describe_smoothing_length(&input, &found), "0.1 to 0.2 (array h)");
  input.smoothing_length = (mcor_array){ .constant = 0.2 };
  input.smoothing_length_is_support_radius = 1;
  found.smoothing_length_max = 0.1;
  expect(mcor_describe_smoothing_length(&input, &found), "0.1 (given, support radius)");
  input.estimate_smoothing_length = 1;
  expect(mcor_describe_smoothing_length(&input, &found), "0.1 (estimated)");
  expect(mcor_describe_volume(&input), "computed from the positions");
  input.mass = (mcor_array){ .constant = 0.5 };
  expect(mcor_describe_volume(&input), "0.5 / density summed from it");
  input.density = (mcor_array){ .data = length, .type = MCOR_FLOAT64, .name = "rho" };
  expect(mcor_describe_volume(&input), "0.5 / array rho");
  input.volume = input.density;
  expect(mcor_describe_volume(&input), "array rho");
  expect(mcor_describe_measures(&found), "");
  found.area = 2;
  expect(mcor_describe_measures(&found), "area 2; open, so that it has no volume");
  found.is_closed = 1;
  found.volume = 3;
  expect(mcor_describe_measures(&found), "area 2, volume 3");
  found.dimension = 2;
  found.length = 4;
  expect(mcor_describe_measures(&found), "two dimensions: length 4, area 2");
  found.area = 0;
  expect(mcor_describe_measures(&found), "two dimensions: length 4; open, so that it has no area");
}

CORE_MAIN(NULL, NULL, test_estimate, test_words)
