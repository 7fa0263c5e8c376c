/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Two dimensions: kernels, the plane, weights, lines against a reference of all squares. */

#include "mcor_plane.h"
#include "plane_reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Midpoint rule over the support's square, of the normalisation that the library has. */
static void test_kernels_integrate_to_1(void** state)
{
  (void)state;
  for (int k = 0; k < MCOR_SPH_KERNEL_COUNT; ++k)
  {
    const int n = 400;
    const double h = 0.7, reach = h * oracle_support((oracle_kernel)k), step = 2 * reach / n;
    double sum = 0;
    for (int i = 0; i < n * n; ++i)
    {
      const double d[3] = { (i % n + 0.5) * step - reach, (i / n + 0.5) * step - reach, 0 };
      sum += mcor_plane_factor((mcor_sph_kernel)k) * h *
        oracle_kernel_value((oracle_kernel)k, h, d, NULL) * step * step;
    }
    CORE_CHECK(fabs(sum - 1) < 1e-5, "kernel %s: integral %.7f",
      mcor_sph_kernel_name((mcor_sph_kernel)k), sum);
  }
}

/* Inside of a lattice of particles, by given and by computed volumes. */
static void test_weight_is_1_inside(void** state)
{
  mcor_context* context = *state;
  core_set set = plane_make(20, 0, 1, 1, 3, 1);
  const double points[5][3] = { { 0, 3, 0 }, { 0.3, 3, -1.2 }, { 2.25, 3, 1.5 }, { -3.1, 3, 0.77 },
    { 0, 3.5, 0 } };
  const mcor_array at = core_array(points[0], 3);
  for (int k = 0; k < MCOR_SPH_KERNEL_COUNT; ++k)
  {
    for (int computed = 0; computed < 3; ++computed)
    {
      mcor_input input = core_input(&set);
      mcor_options options = core_options(NULL);
      mcor_samples samples;
      options.iso_count = 0;
      options.sph_kernel = (mcor_sph_kernel)k;
      options.h_scale = computed == 2 ? 0.9 : 1;
      input.volume = computed ? (mcor_array){ 0 } : input.volume;
      input.scalar = (mcor_array){ 0 };
      CORE_OK(context, mcor_probe(context, &input, &options, &at, 5, &samples));
      for (int p = 0; p < 5; ++p)
      {
        const double w = samples.weight_sum[p];
        CORE_CHECK(p == 4 ? w == 0 && !samples.valid[p] : fabs(w - 1) < (computed ? 8e-2 : 1e-2),
          "%s, %d: weight %g", mcor_sph_kernel_name((mcor_sph_kernel)k), computed, w);
      }
      assert_int_equal(samples.statistics.dimension, 2);
      mcor_free_samples(&samples);
    }
  }
  core_free_set(&set);
}

static mcor_options plane_options(const double* iso)
{
  mcor_options options = core_options(iso);
  options.boundary_flag = 1;
  options.vertex_threshold = 0;
  return options;
}

static int64_t compare(
  mcor_context* context, const core_set* set, const mcor_options* options, int axis, int closed)
{
  mcor_input input = core_input(set);
  const plane_field field = { set, options, axis };
  mcor_surface surface = core_extract(context, &input, options);
  const int64_t edges = plane_compare(&field, options->iso_values[0], &surface);
  plane_check_lines(&field, options->iso_values[0], &surface, closed);
  mcor_free_surface(&surface);
  return edges;
}

static void test_lines_are_those_of_the_field(void** state)
{
  const double isos[3] = { 0.5, 0.4, 0.45 };
  for (int k = 0; k < MCOR_SPH_KERNEL_COUNT; ++k)
  {
    for (int f = 0; f < 3; ++f)
    {
      const int axis = (k + f) % 3;
      core_set set = plane_make(12, 0.3, 1.4, axis, 10.0 * axis - 7, (uint64_t)(5 + k));
      for (int64_t i = 0; i < set.count; ++i)
      {
        set.scalar[i] = f == MCOR_SUM ? 1 + 0.05 * set.scalar[i] : set.scalar[i];
      }
      mcor_options options = plane_options(&isos[f]);
      options.sph_kernel = (mcor_sph_kernel)k;
      options.field = (mcor_field)f;
      options.h_scale = k == 3 ? 0.75 : 1;
      CORE_CHECK(compare(*state, &set, &options, axis, f == MCOR_WEIGHT_SUM) > 20, "few edges");
      options.precision = MCOR_FLOAT64;
      CORE_CHECK(compare(*state, &set, &options, axis, f == MCOR_WEIGHT_SUM) > 20, "few edges");
      core_free_set(&set);
    }
  }
}

/* Anything: noise, walls, all options that change where lines are. */
static void test_random_lines(void** state)
{
  uint64_t seed = 11;
  for (int round = 0; round < 40; ++round)
  {
    const int axis = (int)(random_bits(&seed) % 3);
    core_set set = plane_make(10 + (int)(random_bits(&seed) % 6), 0.45, 1 + 2 * random_unit(&seed),
      axis, 3 * random_unit(&seed), seed);
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.scalar[i] = 2 * random_unit(&seed) - 1;
      set.solid[i] = random_bits(&seed) % 6 == 0;
    }
    const double iso = round % 3 == MCOR_WEIGHT_SUM ? 0.6 : 0.1;
    mcor_options options = plane_options(&iso);
    set.has_solids = round % 4 == 1 && round % 3 != MCOR_WEIGHT_SUM;
    options.sph_kernel = (mcor_sph_kernel)(random_bits(&seed) % MCOR_SPH_KERNEL_COUNT);
    options.field = (mcor_field)(round % 3);
    options.cube_size_factor = 0.3 + 0.5 * random_unit(&seed);
    options.vertex_threshold = round & 1 ? 0.5 : 0;
    options.topology = round & 2 ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
    compare(*state, &set, &options, axis, options.field == MCOR_WEIGHT_SUM);
    core_free_set(&set);
  }
}

/* A circle: its place, length and area. */
static void test_circle(void** state)
{
  core_set set = plane_make(24, 0, 1, 2, 0, 1);
  double isos[2] = { 0, -16 };
  mcor_options options = plane_options(isos);
  options.iso_count = 2;
  options.iso_value = options.gradients = options.residual = options.weight_sum = 1;
  mcor_input input = core_input(&set);
  mcor_surface surface = core_extract(*state, &input, &options);
  assert_int_equal(surface.line_count, 2);
  assert_true(surface.statistics.is_closed);
  const double pi = 3.14159265358979;
  double area = 0;
  for (int64_t p = 0; p < surface.point_count; ++p)
  {
    const double r = hypot(surface.points[3 * p], surface.points[3 * p + 1]);
    const double expected = surface.iso_value[p] == 0 ? 3 : 5;
    /* A mean over the support lowers 9 - r^2 by its second moment. */
    CORE_CHECK(fabs(r - expected) < 0.4, "radius %g", r);
    CORE_CHECK(fabs(surface.weight_sum[p] - 1) < 2e-2, "weight %g", surface.weight_sum[p]);
    area += surface.iso_value[p] == 0 ? 0 : r * r / (double)surface.point_count;
  }
  assert_true(area > 0);
  CORE_CHECK(fabs(surface.statistics.area / pi - (2.7 * 2.7 + 4.8 * 4.8)) < 4, "area %g",
    surface.statistics.area);
  CORE_CHECK(
    fabs(surface.statistics.length / (2 * pi) - 7.6) < 0.5, "length %g", surface.statistics.length);
  mcor_free_surface(&surface);
  core_free_set(&set);
}

/* Both detectors cut where both equations hold; the eigenvalue is one of the two axes. */
static void test_trimming(void** state)
{
  core_set set = plane_make(14, 0.2, 1, 0, 2, 3);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] = set.position[3 * i + 1] + 0.3 * set.position[3 * i + 2];
  }
  const double iso = 0.2;
  mcor_options options = plane_options(&iso);
  mcor_input input = core_input(&set);
  options.boundary_eigenvalue = options.weight_sum = 1;
  for (int eigenvalue = 0; eigenvalue < 2; ++eigenvalue)
  {
    options.boundary_detection = eigenvalue ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
    options.vertex_threshold = eigenvalue ? 0.3 : 0.5;
    mcor_surface surface = core_extract(*state, &input, &options);
    assert_int_equal(surface.line_count, 1);
    assert_int_equal(surface.statistics.trim_vertices, 2);
    int inside = 0;
    for (int64_t p = 0; p < surface.point_count; ++p)
    {
      const float at = eigenvalue ? surface.boundary_eigenvalue[p] : surface.weight_sum[p];
      CORE_CHECK(!(surface.boundary_flag[p] & 1) || fabs(at - options.vertex_threshold) < 3e-5,
        "cut at %g", at);
      inside += fabs(surface.boundary_eigenvalue[p] - 1) < 0.2;
    }
    CORE_CHECK(2 * inside > surface.point_count, "%d of %lld near 1", inside,
      (long long)surface.point_count);
    const plane_field field = { &set, &options, 0 };
    plane_check_lines(&field, iso, &surface, 0);
    mcor_free_surface(&surface);
  }
  core_free_set(&set);
}

static void expect_error(
  mcor_context* context, const mcor_input* input, const mcor_options* options, const char* words)
{
  mcor_surface surface;
  const mcor_status status = mcor_extract(context, input, options, &surface);
  CORE_CHECK(status != MCOR_OK && strstr(mcor_last_error(context), words), "%s: %s", words,
    mcor_last_error(context));
}

static void test_what_is_no_plane(void** state)
{
  core_set set = plane_make(10, 0.1, 1, 2, 1, 7);
  const double iso = 0;
  mcor_options options = plane_options(&iso);
  mcor_input input = core_input(&set);
  options.dimension = 3;
  mcor_surface surface = core_extract(*state, &input, &options);
  assert_int_equal(surface.statistics.dimension, 3);
  assert_true(surface.line_count == 0 && surface.line_offsets == NULL);
  mcor_free_surface(&surface);
  options.dimension = 4;
  expect_error(*state, &input, &options, "The dimension is 4");
  options.dimension = 2;
  set.position[5] += 1e-9;
  expect_error(*state, &input, &options, "do not share one coordinate exactly");
  options.dimension = 0; /* thin, but uneven */
  surface = core_extract(*state, &input, &options);
  assert_int_equal(surface.statistics.dimension, 3);
  mcor_free_surface(&surface);
  options.dimension = 2;
  set.solid[1] = 1;
  set.has_solids = 1;
  input = core_input(&set);
  expect_error(*state, &input, &options, "solid particle 1 has");
  set.position[5] = NAN;
  expect_error(*state, &input, &options, "position of particle 1 is not a number");
  core_free_set(&set);
}

/* A point, and particles on a line, are in a plane if the caller says so. */
static void test_points_and_rows(void** state)
{
  const double iso = 0.1;
  for (int count = 1; count < 12; count += 10)
  {
    core_set set = core_make_set(count);
    for (int i = 0; i < count; ++i)
    {
      set.position[3 * i] = i;
      set.smoothing_length[i] = 1.3;
      set.volume[i] = 1;
    }
    mcor_options options = plane_options(&iso);
    mcor_input input = core_input(&set);
    options.field = MCOR_WEIGHT_SUM;
    mcor_surface surface = core_extract(*state, &input, &options);
    assert_int_equal(surface.statistics.dimension, 3);
    mcor_free_surface(&surface);
    options.dimension = 2;
    compare(*state, &set, &options, 2, 1);
    core_free_set(&set);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_kernels_integrate_to_1),
    cmocka_unit_test(test_weight_is_1_inside), cmocka_unit_test(test_lines_are_those_of_the_field),
    cmocka_unit_test(test_random_lines), cmocka_unit_test(test_circle),
    cmocka_unit_test(test_trimming), cmocka_unit_test(test_what_is_no_plane),
    cmocka_unit_test(test_points_and_rows) };
  return cmocka_run_group_tests(tests, core_set_up, core_tear_down);
}
