/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests particles in a plane: kernels, weights, what counts as a plane, derivatives, gauges, data kept between calls,
 * and that the particles' order changes no bit. test_core_plane_lines compares lines. */

#include "mcor_plane.h"
#include "plane_reference.h"

/* Checks that each kernel, normalised by the library for a plane, has the integral 1. The midpoint rule sums over the
 * square around its support. */
static void test_kernels_integrate_to_1(void** state)
{
  for (int k = 0; k < MCOR_SPH_KERNEL_COUNT; ++k)
  {
    const int n = 400;
    const double h = 0.7, reach = h * oracle_support((oracle_kernel)k), step = 2 * reach / n;
    double sum = 0;
    for (int i = 0; i < n * n; ++i)
    {
      const double d[3] = { (i % n + 0.5) * step - reach, (i / n + 0.5) * step - reach, 0 };
      sum += mcor_kernel_of((mcor_sph_kernel)k)->plane_factor * h *
        oracle_kernel_value((oracle_kernel)k, h, d, NULL) * step * step;
    }
    CORE_CHECK(fabs(sum - 1) < 1e-5, mcor_sph_kernel_name((mcor_sph_kernel)k), sum);
  }
}

/* Within a lattice of particles the weight sum is 1, with given volumes and with computed ones. */
static void test_weight_is_1_inside(void** state)
{
  mcor_context* context = *state;
  CORE_SET set = plane_make(20, 0, 1, 1, 3, 1);
  const double points[5][3] = { { 0, 3, 0 }, { 0.3, 3, -1.2 }, { 2.25, 3, 1.5 }, { -3.1, 3, 0.77 },
    { 0, 3.5, 0 } };
  const mcor_array at = core_array(points[0], 3);
  for (int k = 0; k < MCOR_SPH_KERNEL_COUNT; ++k)
  {
    for (int computed = 0; computed < 3; ++computed)
    {
      mcor_input input = core_input(&set);
      mcor_options options = core_options(NULL);
      CORE_SAMPLES samples;
      options.sph_kernel = (mcor_sph_kernel)k;
      options.h_scale = computed == 2 ? 0.9 : 1;
      input.volume = computed ? (mcor_array){ 0 } : input.volume;
      input.scalar = (mcor_array){ 0 };
      CORE_OK(context, mcor_probe(context, &input, &options, &at, 5, &samples));
      for (int p = 0; p < 5; ++p)
      {
        const double w = samples.weight_sum[p];
        CORE_CHECK(p == 4 ? w == 0 && !samples.valid[p]
                          : fabs(w - 1) < (computed              ? 8e-2
                                              : k == 1 || k == 2 ? 3e-2
                                                                 : 1e-2),
          mcor_sph_kernel_name((mcor_sph_kernel)k), computed, w);
      }
      assert_int_equal(samples.statistics.dimension, 2);
    }
  }
}

/* A coordinate of -0 counts as 0, whichever particles have it. */
static void test_minus_zero(void** state)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    CORE_SET set = plane_make(10, 0.1, 1, axis, 0, 7);
    const double iso = 0;
    const mcor_input input = core_input(&set);
    const mcor_options options = plane_options(&iso);
    CORE_SURFACE zero = core_extract(*state, &input, &options);
    assert_true(zero.line_count > 0);
    for (int which = 0; which < 2; ++which)
    {
      for (int64_t i = 0; i < set.count; ++i)
      {
        set.position[3 * i + axis] = i % 2 == which ? -0.0 : 0.0;
      }
      CORE_SURFACE other = core_extract(*state, &input, &options);
      assert_int_equal(core_hash(&other), core_hash(&zero));
    }
  }
}

static void expect_error(
  mcor_context* context, const mcor_input* input, const mcor_options* options, const char* words)
{
  mcor_surface surface;
  const mcor_status status = mcor_extract(context, input, options, &surface);
  CORE_CHECK(status != MCOR_OK && core_told(context, words), words, mcor_last_error(context));
}

static void test_what_is_no_plane(void** state)
{
  CORE_SET set = plane_make(10, 0.1, 1, 2, 1, 7);
  const double iso = 0;
  mcor_options options = plane_options(&iso);
  mcor_input input = core_input(&set);
  options.dimension = 3;
  mcor_surface surface = core_extract(*state, &input, &options);
  assert_int_equal(surface.statistics.dimension, 3);
  assert_true(surface.line_count == 0 && surface.line_offsets == NULL);
  mcor_free_surface(&surface);
  options.dimension = 4;
  expect_error(*state, &input, &options, "DIMENSION_ILLEGAL|{dimension} is 4");
  options.dimension = 2;
  set.position[5] += 1e-9;
  expect_error(*state, &input, &options, "NOT_IN_PLANE");
  options.dimension = 0; /* the set is thin, but uneven */
  surface = core_extract(*state, &input, &options);
  assert_int_equal(surface.statistics.dimension, 3);
  mcor_free_surface(&surface);
  options.dimension = 2;
  set.solid[1] = 1;
  set.has_solids = 1;
  input = core_input(&set);
  expect_error(*state, &input, &options, "SOLIDS_BESIDE_PLANE|1.000000001");
  set.position[5] = NAN; /* an ignored solid may be anywhere */
  surface = core_extract(*state, &input, &options);
  assert_int_equal(surface.statistics.dimension, 2);
  mcor_free_surface(&surface);
  set.solid[1] = 0;
  expect_error(*state, &input, &options, "ARRAY_VALUE|particle 1");
}

/* If steps of single precision are longer than the particles' distances, rounding may put all layers of a block into
 * one plane. The particles must still count as lying in space. */
static void test_rounded_plane(void** state)
{
  const double iso = 0;
  CORE_SET set = core_make_block(6, 0, 1, core_slope);
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  for (int is_far = 0; is_far < 2; ++is_far)
  {
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.position[3 * i + 1] = is_far ? 1e9 : 1;
    }
    options.dimension = 0;
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    assert_int_equal(surface.statistics.dimension, is_far ? 3 : 2);
    assert_int_equal(mcor_find_dimension(&input, NULL, 0), is_far ? 3 : 2);
    const double y = set.position[1];
    const mcor_gauge_line line = { .from = { 2, y, -8 }, .to = { 2, y, 8 } };
    options.iso_count = 0;
    CORE_GAUGES gauges;
    CORE_OK(*state, mcor_gauge(*state, &input, &options, &line, 1, &gauges));
    assert_int_equal(gauges.readings[0].crossing_count, 2);
    options.iso_count = 1;
  }
}

/* Messages name the caller's axes, though the core turns the plane. A flat box gives the whole result
 * if it lies in the particles' plane, and nothing if it lies beside the plane. */
static void test_sentences_of_sides(void** state)
{
  CORE_SET set = plane_make(10, 0.1, 1, 1, 1, 7);
  const double iso = 0;
  const mcor_input input = core_input(&set);
  mcor_options options = plane_options(&iso);
  options.periodic[0] = 1;
  expect_error(*state, &input, &options, "PERIOD_ILLEGAL|along x");
  options.periodic[0] = 0;
  options.periodic[5] = 1;
  expect_error(*state, &input, &options, "PERIOD_TOO_SHORT|along z");
  options.periodic[5] = 0;
  CORE_SURFACE whole = core_extract(*state, &input, &options);
  const double box[6] = { -9, 9, 1, 1, 9, -9 };
  memcpy(options.box, box, sizeof box);
  expect_error(*state, &input, &options, "BOX_ILLEGAL|along z");
  options.box[4] = -9;
  options.box[5] = 9;
  CORE_SURFACE flat = core_extract(*state, &input, &options);
  assert_true(whole.line_count > 0);
  assert_int_equal(core_hash(&flat), core_hash(&whole));
  mcor_free_surface(&flat);
  options.box[2] = options.box[3] = 0.5; /* the box lies beside the particles */
  flat = core_extract(*state, &input, &options);
  assert_int_equal(flat.line_count, 0);
}

/* If walls lie in another plane than the fluid, a call is refused, also with an automatic dimension, unless it ignores
 * walls. If walls lie in no plane, two dimensions are refused, and an automatic dimension becomes three. */
static void test_walls_in_another_plane(void** state)
{
  CORE_SET set = plane_make(10, 0.1, 1, 1, -2, 7);
  const double iso = 0;
  mcor_options options = plane_options(&iso);
  for (int64_t i = 0; i < 20; ++i)
  {
    set.solid[i] = 1;
    set.position[3 * i + 1] = 0.5;
  }
  set.has_solids = 1;
  mcor_input input = core_input(&set);
  for (int dimension = 0; dimension <= 2; dimension += 2)
  {
    options.dimension = dimension;
    expect_error(*state, &input, &options, "SOLIDS_BESIDE_PLANE|y = -2");
    assert_int_equal(mcor_find_dimension(&input, NULL, dimension), dimension == 2 ? 2 : 3);
    input.ignore_solids = 1;
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    assert_int_equal(surface.statistics.dimension, 2);
    assert_int_equal(mcor_find_dimension(&input, NULL, dimension), 2);
    input.ignore_solids = 0;
  }
  set.position[4] = 0.6;
  expect_error(*state, &input, &options, "SOLID_BESIDE_PLANE|particle 0");
  options.dimension = 0;
  CORE_SURFACE surface = core_extract(*state, &input, &options);
  assert_int_equal(surface.statistics.dimension, 3);
}

/* Derivatives of a linear field are exact; a gauge reads the place where the weight is 0.5. */
static void test_derivatives_and_gauges(void** state)
{
  mcor_context* context = *state;
  for (int axis = 0; axis < 3; ++axis)
  {
    CORE_SET set = plane_make(14, 0.2, 1.2, axis, 5, 3);
    CORE_FREED double* velocity = oracle_allocate(set.count * 3, sizeof *velocity);
    for (int64_t i = 0; i < set.count; ++i)
    {
      const double u = set.position[3 * i + (axis + 1) % 3],
                   v = set.position[3 * i + (axis + 2) % 3];
      velocity[3 * i + axis] = 0;
      velocity[3 * i + (axis + 1) % 3] = 2 * u - 3 * v;
      velocity[3 * i + (axis + 2) % 3] = 0.5 * u + v;
    }
    const mcor_array attribute = core_array(velocity, 3);
    mcor_input input = core_input_with(&set, &attribute, 1);
    input.scalar = (mcor_array){ 0 };
    mcor_options options = core_options(NULL);
    CORE_DERIVATIVES derivatives;
    CORE_OK(context, mcor_derive(context, &input, &options, MCOR_GRADIENT_CORRECTED, &derivatives));
    assert_int_equal(derivatives.statistics.dimension, 2);
    for (int64_t i = 0; i < set.count; ++i)
    {
      const double* j = derivatives.gradients[0] + 9 * i;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      CORE_CHECK(derivatives.corrected[i] && fabs(j[3 * u + u] - 2) < 1e-3 &&
          fabs(j[3 * u + v] + 3) < 1e-3 && fabs(j[3 * v + u] - 0.5) < 1e-3 &&
          fabs(j[3 * v + v] - 1) < 1e-3 && j[3 * u + axis] == 0 && j[3 * axis + u] == 0,
        i, j[3 * u + u], j[3 * u + v], j[3 * v + u], j[3 * v + v]);
    }
    mcor_gauge_line line = { .name = "across" }, dry = line;
    line.from[axis] = line.to[axis] = dry.from[axis] = dry.to[axis] = 5;
    line.to[(axis + 1) % 3] = 12;
    dry.to[(axis + 1) % 3] = dry.to[(axis + 2) % 3] = -99;
    dry.from[(axis + 1) % 3] = -90;
    mcor_gauges gauges;
    CORE_OK(context, mcor_gauge(context, &input, &options, &dry, 1, &gauges));
    assert_true(gauges.readings[0].outside && isnan(gauges.readings[0].place[axis]));
    mcor_free_gauges(&gauges);
    CORE_OK(context, mcor_gauge(context, &input, &options, &line, 1, &gauges));
    const plane_field field = { &set, &options, axis, NULL };
    const double at = gauges.readings[0].place[(axis + 1) % 3];
    CORE_CHECK(gauges.readings[0].state == MCOR_GAUGE_WET && gauges.readings[0].place[axis] == 5 &&
        fabs(plane_evaluate(&field, at, 0).fluid - 0.5) < 1e-4,
      at);
    mcor_free_gauges(&gauges);
    line.to[axis] = 6;
    CORE_FAILS(context, MCOR_INVALID_ARGUMENT,
      mcor_gauge(context, &input, &options, &line, 1, &gauges), "GAUGE_OUT_OF_PLANE");
  }
}

/* If the scalar is smooth, MCOR_PAIRS and MCOR_COMPLETE give the same lines. Data kept from one call serve a call with
 * another iso value. */
static void test_pairs_and_reuse(void** state)
{
  CORE_SET set = plane_make(20, 0.2, 1, 2, -1, 4);
  const double isos[2] = { -20, 2 };
  for (int64_t p = 0; p < set.count; ++p)
  {
    set.smoothing_length[p] *= set.position[3 * p] > 1 ? 2.5 : 1;
  }
  mcor_input input = core_input_to_keep(&set);
  for (int i = 0; i < 4; ++i)
  {
    uint64_t hash[3];
    for (int k = 0; k < 3; ++k)
    {
      mcor_options options = plane_options(&isos[i % 2]);
      options.level_limit = i < 2 ? 0 : MCOR_CUBE_LEVELS - 1;
      options.seeds = k == 1 && i < 2 ? MCOR_PAIRS : MCOR_COMPLETE;
      mcor_input fresh = core_input(&set);
      CORE_SURFACE surface = core_extract(*state, k == 2 ? &fresh : &input, &options);
      assert_int_equal(surface.line_count, 1);
      hash[k] = core_hash_bytes(
        CORE_HASH_OF_NOTHING, surface.points, (size_t)surface.point_count * 3 * sizeof(double));
    }
    assert_int_equal(hash[0], hash[1]);
    assert_int_equal(hash[0], hash[2]);
  }
}

/* No bit depends on the order of the particles, or on the plane's axis, except that coordinates change places. */
static void test_bits(void** state)
{
  const double iso = 0.4;
  CORE_SET set = plane_make(12, 0.3, 3, 1, 2, 5);
  CORE_FREED int64_t* order = core_make_order(set.count, 6);
  CORE_SET other = core_permute(&set, order);
  mcor_options options = plane_options(&iso);
  options.level_limit = 1;
  options.vertex_threshold = 0.5;
  uint64_t hash[3];
  for (int i = 0; i < 3; ++i)
  {
    mcor_input input = core_input(i == 1 ? &other : &set);
    for (int64_t p = 0; p < set.count && i == 2; ++p)
    {
      const double y = set.position[3 * p], z = set.position[3 * p + 2];
      set.position[3 * p] = z;
      set.position[3 * p + 1] = y;
      set.position[3 * p + 2] = -3;
    }
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    for (int64_t p = 0; p < surface.point_count && i == 2; ++p)
    {
      const double x = surface.points[3 * p], y = surface.points[3 * p + 1];
      surface.points[3 * p] = y;
      surface.points[3 * p + 1] = 2;
      surface.points[3 * p + 2] = x;
    }
    hash[i] = core_hash_bytes(
      CORE_HASH_OF_NOTHING, surface.points, (size_t)surface.point_count * 3 * sizeof(double));
    hash[i] = core_hash_bytes(
      hash[i], surface.line_points, (size_t)surface.line_point_count * sizeof(int32_t));
  }
  assert_int_equal(hash[0], hash[1]);
  assert_int_equal(hash[0], hash[2]);
}

CORE_MAIN(core_set_up, core_tear_down, test_kernels_integrate_to_1, test_weight_is_1_inside,
  test_what_is_no_plane, test_rounded_plane, test_minus_zero, test_sentences_of_sides,
  test_walls_in_another_plane, test_derivatives_and_gauges, test_pairs_and_reuse, test_bits)
