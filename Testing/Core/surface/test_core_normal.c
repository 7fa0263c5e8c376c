/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests attributes, nearest particles, and normals from triangles. The oracle checks normals from gradients. */

#include "core_fixture.h"
#include "mcor_parallel.h"
#include "mcor_vector.h"

static double length_of(const double x[3])
{
  return sqrt(mcor_dot(x, x));
}

/* Checks normals from triangles: each is the sum of the cross products of the triangles around its point, scaled to
 * length 1. */
static void check_triangle_normals(const mcor_surface* surface)
{
  CORE_FREED double* sums = oracle_allocate(surface->point_count, 3 * sizeof(double));
  for (int64_t t = 0; t < 3 * surface->triangle_count; t += 3)
  {
    const int32_t* corner = surface->triangles + t;
    const double* x = surface->points;
    double u[3], v[3], cross[3];
    mcor_subtract(x + 3 * corner[1], x + 3 * corner[0], u);
    mcor_subtract(x + 3 * corner[2], x + 3 * corner[0], v);
    mcor_cross(u, v, cross);
    for (int i = 0; i < 9; ++i)
    {
      sums[3 * corner[i / 3] + i % 3] += cross[i % 3];
    }
  }
  for (int64_t i = 0; i < surface->point_count; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      const double wanted = sums[3 * i + a] / length_of(sums + 3 * i);
      CORE_CHECK(fabs((double)surface->normals[3 * i + a] - wanted) < 1e-6, i,
        surface->normals[3 * i + a], a, wanted);
    }
  }
}

/* Checks that normals from triangles are right and point outwards. */
static void test_triangle_normals(void** state)
{
  CORE_SET set = core_make_block(10, 0.1, 3, core_ball);
  const double iso = 1.5;
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  for (int kind = 0; kind < 2; ++kind)
  {
    options.preview = kind == 0;
    options.triangle_normals = kind == 1;
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    CORE_CHECK(surface.point_count > 100, surface.point_count);
    check_triangle_normals(&surface);
    for (int64_t i = 0; i < surface.point_count; ++i)
    {
      const float* normal = surface.normals + 3 * i;
      const double n[3] = { normal[0], normal[1], normal[2] }, *x = surface.points + 3 * i;
      const double outwards = mcor_dot(n, x) / length_of(x);
      CORE_CHECK(fabs(length_of(n) - 1) < 1e-5 && outwards > 0.7, n[0], n[1], n[2], outwards);
    }
  }
  options.outputs &= ~(unsigned)MCOR_OUT_NORMALS;
  CORE_SURFACE surface = core_extract(*state, &input, &options);
  assert_true(!surface.normals && !surface.gradients && !surface.weight_sum &&
    !surface.boundary_eigenvalue && !surface.correction_length && !surface.residual &&
    !surface.boundary_flag && !surface.iso_value && !surface.nearest_particle);
}

/* Compares attributes with the oracle's weighted means: a constant, 9 components (the device sums 4 at a time), a
 * linear function in single precision, and a vector. */
static void check_attributes(mcor_context* context, int solids)
{
  CORE_SET set = core_make_block(10, 0.2, 3, core_ball);
  const int64_t n = set.count;
  CORE_FREED double* constant = oracle_allocate(n, sizeof(double));
  CORE_FREED double* many = oracle_allocate(n * 9, sizeof(double));
  CORE_FREED float* single = oracle_allocate(n, sizeof(float));
  for (int64_t i = 0; i < n; ++i)
  {
    constant[i] = 1234.5;
    single[i] = (float)core_slope(set.position + 3 * i);
    set.solid[i] = i % 5 == 0;
    for (int c = 0; c < 9; ++c)
    {
      many[9 * i + c] = c + set.position[3 * i + c % 3];
    }
  }
  set.has_solids = solids;
  const mcor_array attributes[4] = { core_array(constant, 0), core_array(many, 9),
    { .data = single, .type = MCOR_FLOAT32 }, core_array(set.position, 3) };
  const double iso = 1.5;
  const mcor_input input = core_input_with(&set, attributes, 4);
  const mcor_options options = core_options(&iso);
  CORE_SURFACE surface = core_extract(context, &input, &options);
  particle_set fluid = set;
  CORE_FREED uint8_t* none = oracle_allocate(n, 1);
  fluid.solid = solids ? set.solid : none;
  CORE_FIELD field = oracle_make_field(&fluid, ORACLE_CUBIC_SPLINE, ORACLE_SHEPARD, 1);
  CORE_FREED double* component = oracle_allocate(n, sizeof(double));
  assert_int_equal(surface.attribute_count, 4);
  for (int c = -2; c < 12; ++c)
  {
    for (int64_t i = 0; i < n; ++i)
    {
      component[i] = c == -2 ? constant[i]
        : c == -1            ? (double)single[i]
        : c < 9              ? many[9 * i + c]
                             : set.position[3 * i + c - 9];
    }
    for (int64_t i = 0; i < surface.point_count; ++i)
    {
      oracle_sample sample;
      oracle_evaluate(&field, component, surface.points + 3 * i, &sample);
      const double value = c == -2 ? surface.attributes[0][i]
        : c == -1                  ? surface.attributes[2][i]
        : c < 9                    ? surface.attributes[1][9 * i + c]
                                   : surface.attributes[3][3 * i + c - 9];
      CORE_CHECK(
        fabs(value - sample.value) < 1e-6 * (10 + fabs(sample.value)), c, value, sample.value);
      CORE_CHECK(c != -2 || value == 1234.5, value);
      CORE_CHECK(c != -1 || fabs(value - core_slope(surface.points + 3 * i)) < 0.6,
        value - core_slope(surface.points + 3 * i));
    }
  }
  CORE_CHECK(surface.point_count > 100, surface.point_count);
}

static void test_attributes(void** state)
{
  check_attributes(*state, 0);
  check_attributes(*state, 1);
}

/* Compares the nearest fluid particle with a search of all particles. h_ratio: largest over smallest smoothing length. */
static void check_nearest(mcor_context* context, double h_ratio, int solids)
{
  CORE_SET set = core_make_random(300, 5, 1.2 / h_ratio, 1.2, 6);
  const double iso = 0;
  set.has_solids = solids;
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.solid[i] = i % 3 == 0;
  }
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.outputs |= MCOR_OUT_NEAREST_PARTICLE;
  options.node_threshold = 0.01;
  options.vertex_threshold = 0;
  options.cube_size = 0.3;
  CORE_SURFACE surface = core_extract(context, &input, &options);
  int64_t wrong = 0;
  for (int64_t i = 0; i < surface.point_count; ++i)
  {
    const int64_t got = surface.nearest_particle[i];
    double best = INFINITY, at_got = INFINITY;
    CORE_CHECK(got >= 0 && got < set.count, got);
    CORE_CHECK(!solids || !set.solid[got], got);
    for (int64_t j = 0; j < set.count; ++j)
    {
      double d[3];
      mcor_subtract(set.position + 3 * j, surface.points + 3 * i, d);
      best = !solids || !set.solid[j] ? fmin(best, length_of(d)) : best;
      at_got = j == got ? length_of(d) : at_got;
    }
    wrong += at_got > best + 1e-5;
  }
  CORE_CHECK(surface.point_count > 100, surface.point_count);
  CORE_CHECK(wrong == 0, h_ratio, solids, wrong, surface.point_count);
}

static void test_nearest(void** state)
{
  check_nearest(*state, 1, 0);
  check_nearest(*state, 1, 1);
  check_nearest(*state, 4, 0);
}

/* Checks that the greatest area and volume of a single triangle are found in any thread's slice of the triangles. */
static void test_greatest_terms(void** state)
{
  enum
  {
    N = 4 * MCOR_HEAVY_GRAIN
  };
  double points[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 100, 3 };
  CORE_FREED int32_t* triangles = oracle_allocate(3 * N, sizeof *triangles);
  const mcor_surface surface = {
    .points = points, .point_count = 4, .triangles = triangles, .triangle_count = N
  };
  mcor_measures none = { 0 }, found;
  for (int64_t large = -1; large < N; large += N / 2)
  {
    for (int64_t t = 0; t < N; ++t)
    {
      triangles[3 * t + 1] = 1;
      triangles[3 * t + 2] = t == large ? 3 : 2;
    }
    found = (mcor_measures){ .origin = { 1, 1, 1 } };
    mcor_measure_terms(&surface, &found);
    none = large < 0 ? found : none;
    CORE_CHECK(large < 0 ||
        (found.area_most > 50 * none.area_most && found.volume_most > 50 * none.volume_most),
      found.area_most, found.volume_most);
    mcor_measure_sums(&surface, NULL, &found);
    CORE_CHECK(fabs(found.area - 0.5 * N - (large < 0 ? 0 : 49.5)) < 0.1, found.area);
  }
}

CORE_MAIN(core_set_up, core_tear_down, test_triangle_normals, test_attributes, test_nearest,
  test_greatest_terms)
