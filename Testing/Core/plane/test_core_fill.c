/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Filled regions and bands of two dimensions. */

#include "core_parts.h"
#include "fill_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static mcor_options fill_options(const double* isos, int count)
{
  mcor_options options = core_options(isos);
  options.iso_count = count;
  options.filled = 1;
  options.outputs |= MCOR_OUT_BOUNDARY_FLAG | MCOR_OUT_RESIDUAL | MCOR_OUT_WEIGHT_SUM;
  return options;
}

static fill_report extract(mcor_context* context, const particle_set* set,
  const mcor_options* options, int axis, mcor_surface* surface)
{
  const mcor_input input = core_input(set);
  const plane_field field = { set, options, axis, NULL };
  *surface = core_extract(context, &input, options);
  return fill_check(&field, surface);
}

static void check_close(double a, double b, double tolerance, const char* what)
{
  CORE_CHECK(fabs(a - b) <= tolerance * fabs(b), "%s: %g, not %g", what, a, b);
}

/* The region that the lines enclose is filled, and its border is these lines alone. */
static void test_free_surface(void** state)
{
  const double iso = 0.5;
  const mcor_sph_kernel kernels[3] = { MCOR_CUBIC_SPLINE, MCOR_M_PRIME_4, MCOR_WENDLAND_C2 };
  for (int k = 0; k < 3; ++k)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      CORE_SET set = plane_make(12, 0.3, 1.4, axis, 2 * axis - 3, (uint64_t)(1 + k));
      mcor_options options = fill_options(&iso, 1);
      options.field = MCOR_WEIGHT_SUM;
      options.sph_kernel = kernels[k];
      options.precision = axis == 2 && k == 0 ? MCOR_FLOAT64 : MCOR_FLOAT32;
      options.preview = axis == 1 && k == 0;
      CORE_SURFACE surface;
      const fill_report report = extract(*state, &set, &options, axis, &surface);
      const plane_field field = { &set, &options, axis, NULL };
      assert_int_equal(report.loose, 0);
      check_close(report.area, report.enclosed, 1e-9, "enclosed");
      check_close(report.area, fill_sample(&field, iso, 100), 2e-2, "sampled");
      CORE_CHECK(report.inverted == 0, "inverted %g", report.inverted);
      options.preview ? (void)0 : fill_check_points(&field, &surface);
    }
  }
}

/* Bands add up to what is above the least value, whatever the order of the values. */
static void test_bands(void** state)
{
  const double isos[7] = { 3, -60, 5.5, -20, 3, 1e9, 0 };
  CORE_SET set = plane_make(20, 0.2, 1.2, 1, 4, 3);
  mcor_options options = fill_options(isos, 7);
  mcor_surface surface;
  const plane_field field = { &set, &options, 1, NULL };
  const fill_report all = extract(*state, &set, &options, 1, &surface);
  fill_check_points(&field, &surface);
  CORE_CHECK(all.inverted == 0, "inverted %g", all.inverted);
  double bands[3] = { 0 };
  for (int64_t t = 0; t < surface.triangle_count; ++t)
  {
    const double* p[3];
    for (int c = 0; c < 3; ++c)
    {
      p[c] = surface.points + 3 * (int64_t)surface.triangles[3 * t + c];
    }
    const double u[2] = { (p[0][2] + p[1][2] + p[2][2]) / 3, (p[0][0] + p[1][0] + p[2][0]) / 3 };
    const double value = plane_evaluate(&field, u[0], u[1]).value, band = surface.band_value[t];
    const double next = band == -60 ? -20 : band == -20 ? 0 : band == 0 ? 3 : band == 3 ? 5.5 : 1e9;
    CORE_CHECK(
      value > band - 1 && value < next + 1, "%g in the band from %g to %g", value, band, next);
    const double area = 0.5 *
      fabs((p[1][2] - p[0][2]) * (p[2][0] - p[0][0]) - (p[2][2] - p[0][2]) * (p[1][0] - p[0][0]));
    bands[band >= 3 ? 2 : band >= 0 ? 1 : 0] += area;
  }
  mcor_free_surface(&surface);
  const double single[3] = { -60, 0, 3 };
  double area[4] = { 0 };
  for (int i = 0; i < 3; ++i)
  {
    options.iso_values = single + i;
    options.iso_count = 1;
    area[i] = extract(*state, &set, &options, 1, &surface).area;
    mcor_free_surface(&surface);
  }
  check_close(all.area, area[0], 1e-9, "all bands");
  for (int i = 0; i < 3; ++i)
  {
    check_close(bands[i], area[i] - area[i + 1], 1e-9, "a band");
  }
}

/* Inside of the fluid only: by weight, by eigenvalue, at walls. */
static void test_trimming(void** state)
{
  const double isos[3] = { -1e3, -2.2, 3.1 };
  for (int mode = 0; mode < 6; ++mode)
  {
    CORE_SET set = plane_make(16, 0.25, 1, 0, 2, (uint64_t)(4 + mode));
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.scalar[i] = set.position[3 * i + 1] + 0.3 * set.position[3 * i + 2];
      set.solid[i] = set.position[3 * i + 2] < -4;
    }
    set.has_solids = mode >= 3;
    mcor_options options = fill_options(isos, 3);
    options.boundary_detection = mode == 1 ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
    options.vertex_threshold = mode == 1 ? 0.75 : mode == 2 ? 0.8 : 0.5;
    options.wall_share = mode == 3 ? 0 : mode == 4 ? 0.5 : MCOR_WALL_SHARE_AUTO;
    options.outputs |= mode == 1 ? MCOR_OUT_BOUNDARY_EIGENVALUE : 0;
    options.node_threshold = 0.02;
    CORE_SURFACE surface;
    const plane_field field = { &set, &options, 0, NULL };
    const fill_report report = extract(*state, &set, &options, 0, &surface);
    fill_check_points(&field, &surface);
    int64_t cuts = 0;
    for (int64_t p = 0; p < surface.point_count; ++p)
    {
      cuts += surface.boundary_flag[p] == 1;
      CORE_CHECK(!surface.boundary_eigenvalue || surface.boundary_flag[p] != 1 ||
          fabs(surface.boundary_eigenvalue[p] - 0.75) < 1e-4,
        "a cut at %g", surface.boundary_eigenvalue[p]);
    }
    CORE_CHECK(cuts > 40 && report.loose > 40, "%lld cuts, %lld edges", (long long)cuts,
      (long long)report.loose);
    CORE_CHECK(report.inverted == 0, "inverted %g", report.inverted);
    if (mode == 0 || mode == 2)
    {
      check_close(report.area, fill_sample(&field, isos[0], 150), 2e-2, "sampled");
    }
    CORE_CHECK(mode < 4 || report.area < 16 * 12.5, "%g reaches into the wall", report.area);
  }
}

/* Anything: noise, walls, all options that change where lines are. Watertight. */
static void test_random(void** state)
{
  uint64_t seed = 21;
  double area = 0, inverted = 0;
  for (int round = 0; round < 40; ++round)
  {
    const int axis = (int)(random_bits(&seed) % 3), count = 1 + (int)(random_bits(&seed) % 5);
    CORE_SET set = plane_make(10 + (int)(random_bits(&seed) % 6), 0.45, 1 + 2 * random_unit(&seed),
      axis, 3 * random_unit(&seed), seed);
    double isos[5];
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.scalar[i] = 2 * random_unit(&seed) - 1;
      set.solid[i] = random_bits(&seed) % 6 == 0;
    }
    mcor_options options = fill_options(isos, count);
    options.field = (mcor_field)(round % 3);
    for (int i = 0; i < count; ++i)
    {
      isos[i] = options.field == MCOR_WEIGHT_SUM
        ? 0.2 + random_unit(&seed)
        : (i > 0 ? 2 : 0.4) * random_unit(&seed) - (i > 0 ? 1 : 0.4);
    }
    set.has_solids = round % 4 == 1 && options.field != MCOR_WEIGHT_SUM;
    options.sph_kernel = (mcor_sph_kernel)(random_bits(&seed) % (MCOR_WENDLAND_C2 + 1));
    options.cube_size_factor = 0.3 + 0.5 * random_unit(&seed);
    options.vertex_threshold = round & 1 ? 0.5 : 0;
    options.topology = round & 2 ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
    options.boundary_detection =
      round % 7 == 3 ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
    CORE_SURFACE surface;
    const fill_report report = extract(*state, &set, &options, axis, &surface);
    assert_true(options.field != MCOR_WEIGHT_SUM || report.loose == 0);
    area += report.area;
    inverted += report.inverted;
  }
  /* Where noise crosses two values more than once on one edge. */
  CORE_CHECK(inverted < 1e-4 * area, "%g of %g is inverted", inverted, area);
}

/* Boxes side by side make the whole: the same triangles and lines, with all that their points carry. */
static void test_boxes(void** state)
{
  static const core_cut cuts[] = { { "4 boxes", { 0, 1, 1 }, { { 0 }, { 0.1 }, { -0.7 } } },
    { "thin ones", { 0, 2, 0 }, { { 0 }, { 1.1, 1.3 } } } };
  const double isos[2] = { -8, 2 };
  CORE_SET set = plane_make(14, 0.3, 1.3, 0, 4, 9);
  mcor_options options = fill_options(isos, 2);
  const mcor_input input = core_input(&set);
  core_ask_for_all(&options);
  core_check_these_cuts(*state, "filled", &input, &options, cuts, 2);
}

/* One period is filled from side to side: with fluid everywhere, all of it. */
static void test_period(void** state)
{
  const double isos[2] = { -1e3, 2 };
  CORE_SET set = plane_make(12, 0.2, 1.2, 1, 0.5, 2);
  mcor_options options = fill_options(isos, 2);
  const double period[6] = { -6, 6, 0, 0, -6, 6 };
  memcpy(options.periodic, period, sizeof period);
  CORE_SURFACE surface;
  const fill_report report = extract(*state, &set, &options, 1, &surface);
  check_close(report.area, 144, 1e-9, "a period");
  check_close(report.loose_length, 48, 1e-9, "its sides");
  mcor_free_surface(&surface);
  options.periodic[0] = options.periodic[1] = 0;
  const fill_report strip = extract(*state, &set, &options, 1, &surface);
  CORE_CHECK(fabs(strip.area - 144) < 8, "a strip of %g", strip.area);
}

/* Seeds, order of particles, what is kept, plane: the same bits. */
static void test_bits(void** state)
{
  const double isos[2] = { -3, 4 };
  CORE_SET set = plane_make(12, 0.3, 1.5, 2, 2, 5);
  CORE_FREED int64_t* order = core_make_order(set.count, 6);
  CORE_SET other = core_permute(&set, order);
  mcor_options options = fill_options(isos, 2);
  uint64_t hash[5];
  for (int i = 0; i < 5; ++i)
  {
    options.seeds = i == 1 ? MCOR_PAIRS : MCOR_COMPLETE;
    mcor_input input = i >= 3 ? core_input_to_keep(&set) : core_input(i == 2 ? &other : &set);
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    hash[i] = core_hash_bytes(
      core_hash(&surface), surface.band_value, (size_t)surface.triangle_count * sizeof(double));
  }
  for (int i = 1; i < 5; ++i)
  {
    CORE_CHECK(hash[i] == hash[0], "other bits: %d", i);
  }
}

/* Attributes of nodes are those of a probe there. */
static void test_attributes(void** state)
{
  mcor_context* context = *state;
  const double isos[2] = { -20, 1 };
  CORE_SET set = plane_make(10, 0.3, 1.2, 0, 1, 8);
  enum
  {
    ARRAYS = 5
  };
  mcor_array attributes[ARRAYS];
  CORE_FREED double* values = oracle_allocate(set.count * 3 * ARRAYS, sizeof *values);
  for (int64_t i = 0; i < set.count * 3 * ARRAYS; ++i)
  {
    values[i] = i < set.count * 3 ? 7 : sin((double)i);
  }
  for (int a = 0; a < ARRAYS; ++a)
  {
    attributes[a] = core_array(values + set.count * 3 * a, 3);
  }
  mcor_input input = core_input(&set);
  input.attributes = attributes;
  input.attribute_count = ARRAYS;
  mcor_options options = fill_options(isos, 2);
  options.outputs |= MCOR_OUT_NEAREST_PARTICLE | MCOR_OUT_GRADIENTS;
  CORE_SURFACE surface = core_extract(context, &input, &options);
  CORE_SAMPLES samples;
  const mcor_array points = core_array(surface.points, 3);
  CORE_OK(context, mcor_probe(context, &input, &options, &points, surface.point_count, &samples));
  for (int64_t p = 0; p < surface.point_count; ++p)
  {
    CORE_CHECK(surface.nearest_particle[p] >= 0 && surface.nearest_particle[p] < set.count,
      "point %lld", (long long)p);
    for (int i = 0; i < 3 * ARRAYS; ++i)
    {
      const double at = surface.attributes[i / 3][3 * p + i % 3];
      CORE_CHECK(fabs(at - samples.values[i / 3][3 * p + i % 3]) < 1e-4, "point %lld: %g, not %g",
        (long long)p, at, samples.values[i / 3][3 * p + i % 3]);
    }
  }
}

static void expect_error(
  mcor_context* context, const particle_set* set, const mcor_options* options, const char* words)
{
  mcor_surface surface;
  const mcor_input input = core_input(set);
  CORE_FAILS(
    context, MCOR_INVALID_ARGUMENT, mcor_extract(context, &input, options, &surface), words);
  assert_true(surface.triangle_count == 0 && surface.points == NULL);
}

static void test_what_is_not_filled(void** state)
{
  const double iso = -1;
  CORE_SET set = plane_make(8, 0.2, 1, 2, 0, 1);
  mcor_options options = fill_options(&iso, 1);
  options.field = MCOR_SUM;
  options.node_threshold = 0;
  expect_error(*state, &set, &options, "has no end");
  options.node_threshold = 0.1;
  CORE_SURFACE surface;
  extract(*state, &set, &options, 2, &surface);
  mcor_free_surface(&surface);
  options.dimension = 3;
  expect_error(*state, &set, &options, "two dimensions");
  options.dimension = 0;
  mcor_input nothing = core_input(&set);
  nothing.count = 0;
  surface = core_extract(*state, &nothing, &options);
  assert_int_equal(surface.triangle_count, 0);
  mcor_free_surface(&surface);
  options.box[0] = 100; /* beside all */
  options.box[1] = 101;
  options.box[2] = options.box[4] = -1;
  options.box[3] = options.box[5] = 1;
  mcor_input input = core_input(&set);
  surface = core_extract(*state, &input, &options);
  assert_int_equal(surface.triangle_count, 0);
  mcor_free_surface(&surface);
  memset(options.box, 0, sizeof options.box);
  options.iso_count = 0;
  surface = core_extract(*state, &input, &options);
  assert_true(surface.triangle_count == 0 && surface.point_count == 0);
  mcor_free_surface(&surface);
  options.iso_count = 1;
  options.filled = 0;
  surface = core_extract(*state, &input, &options);
  assert_true(surface.band_value == NULL && surface.triangles == NULL && surface.iso_value == NULL);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_free_surface),
    cmocka_unit_test(test_bands), cmocka_unit_test(test_trimming), cmocka_unit_test(test_random),
    cmocka_unit_test(test_boxes), cmocka_unit_test(test_period), cmocka_unit_test(test_bits),
    cmocka_unit_test(test_attributes), cmocka_unit_test(test_what_is_not_filled) };
  return cmocka_run_group_tests(tests, core_set_up, core_tear_down);
}
