/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests the boundary eigenvalue: first the solver for matrices alone; then the surface's array and trimmed surfaces,
 * against sums in double precision on the host. */

#include "core_fixture.h"
#include "mcor_vector.h"

static const char source[] =
  "__kernel void test_eigen(const int count, __global const real* in, __global real* out)\n"
  "{\n"
  "  const int i = get_global_id(0);\n"
  "  if (i >= count)\n"
  "    return;\n"
  "  const mcor_symmetric m = { in[6 * i], in[6 * i + 1], in[6 * i + 2], in[6 * i + 3],\n"
  "    in[6 * i + 4], in[6 * i + 5] };\n"
  "  realv e[3];\n"
  "  const realv value = mcor_eigen_smallest(&m, e);\n"
  "  out[4 * i] = MCOR_GET(value, 0);\n"
  "  for (int a = 0; a < 3; ++a)\n"
  "    out[4 * i + 1 + a] = MCOR_GET(e[a], MCOR_LANES - 1);\n"
  "}\n";

/* Each row is xx yy zz xy yz zx. */
static const double matrices[][6] = { { 0, 0, 0, 0, 0, 0 }, { 1, 1, 1, 0, 0, 0 },
  { 3, 1, 2, 0, 0, 0 }, { 2, 2, 2, 1, 1, 1 }, { 2, 2, 2, -1, -1, -1 }, { 1, 1, 1, 1, 1, 1 },
  { 1, 1, 5, 1e-7, 0, 0 }, { 1, 1, 1, 1e-8, 1e-9, 1e-10 }, { 1e-20, 2e-20, 3e-20, 1e-20, 0, 0 },
  { 0, 0, 0, 1e-25, 1e-30, 1e-25 }, { 0, 0, 0, 1, 0, 0 }, { 1e6, 1, 1e-6, 1, 1, 1 },
  { -1, 0.5, 2, 0.3, -0.7, 0.1 }, { 0.9, 1.1, 0.5, 0.01, 0.02, -0.03 }, { 4, 9, 1, 6, 3, 2 } };

/* Checks the lowest eigenvalue (found[0]) and its vector e (found + 1): m e = value e, |e| = 1, and m - value has no
 * negative eigenvalue. Entries whose squares vanish in single precision count as 0. */
static void check_eigen(const double m[6], const double found[4], double tolerance)
{
  const double full[3][3] = { { m[0], m[3], m[5] }, { m[3], m[1], m[4] }, { m[5], m[4], m[2] } };
  const double *e = found + 1, value = found[0];
  double scale = 0;
  for (int a = 0; a < 3; ++a)
  {
    scale = fmax(scale, fabs(full[a][0]) + fabs(full[a][1]) + fabs(full[a][2]));
  }
  const double small = tolerance * scale + 1e-19;
  CORE_CHECK(fabs(mcor_dot(e, e) - 1) < 4 * tolerance, mcor_dot(e, e));
  for (int a = 0; a < 3; ++a)
  {
    const double rest = mcor_dot(full[a], e) - value * e[a];
    CORE_CHECK(fabs(rest) < 10 * small, value, rest, a, scale);
  }
  uint64_t seed = 3;
  for (int i = 0; i < 1000; ++i)
  {
    const double v[3] = { random_unit(&seed) - 0.5, random_unit(&seed) - 0.5,
      random_unit(&seed) - 0.5 };
    double form = 0;
    for (int n = 0; n < 9; ++n)
    {
      form += v[n / 3] * (full[n / 3][n % 3] - (n % 4 ? 0 : value)) * v[n % 3];
    }
    CORE_CHECK(form > -10 * small, value, form, scale);
  }
}

static void test_eigenvalues(void** state)
{
  enum
  {
    N = sizeof matrices / sizeof matrices[0]
  };
  for (int precision = MCOR_FLOAT32; precision <= MCOR_FLOAT64; ++precision)
  {
    mcor_buffer in = { 0 }, out = { 0 };
    double found[4 * N];
    core_build(*state, MCOR_CUBIC_SPLINE, MCOR_SHEPARD, (mcor_type)precision);
    core_extend_program(*state, source);
    const size_t real = precision == MCOR_FLOAT64 ? sizeof(double) : sizeof(float);
    double host[6 * N];
    for (int i = 0; i < 6 * N; ++i)
    {
      mcor_put_real(*state, host, i, matrices[i / 6][i % 6]);
    }
    CORE_OK(*state, mcor_write(*state, &in, host, N * 6 * real));
    CORE_OK(*state, mcor_reserve(*state, &out, N * 4 * sizeof(double)));
    CORE_OK(*state,
      MCOR_LAUNCH(
        *state, "test_eigen", MCOR_LIGHT, N, MCOR_INT(N), MCOR_BUFFER(&in), MCOR_BUFFER(&out)));
    CORE_OK(*state, mcor_read(*state, &out, 0, host, N * 4 * real));
    for (int i = 0; i < 4 * N; ++i)
    {
      found[i] = mcor_get_real(*state, host, i);
    }
    mcor_release(*state, &in);
    mcor_release(*state, &out);
    for (int i = 0; i < N; ++i)
    {
      check_eigen(matrices[i], found + 4 * i, precision == MCOR_FLOAT64 ? 1e-14 : 1e-6);
    }
  }
}

/* Checks that the array of eigenvalues has the reference's values, whether the eigenvalue or the weight trims. If the
 * eigenvalue trims, nearly all Newton steps along its gradient must end at the threshold. */
static void check_surface(
  mcor_context* context, mcor_sph_kernel kernel, mcor_type precision, mcor_field field_kind)
{
  CORE_SET set = core_make_block(8, 0.2, 3, core_slope);
  /* Each combination with solids needs its own device program, so only one has solids. */
  set.has_solids = kernel == MCOR_CUBIC_SPLINE && field_kind == MCOR_SHEPARD;
  for (int64_t j = 0; j < set.count; ++j)
  {
    set.solid[j] = set.has_solids && j % 5 == 0;
  }
  const double iso = 0.5;
  const mcor_input input = core_input(&set);
  CORE_FIELD field = oracle_make_field(&set, (oracle_kernel)kernel, ORACLE_WEIGHT, 1);
  mcor_options options = core_options(&iso);
  options.outputs |= MCOR_OUT_BOUNDARY_EIGENVALUE | MCOR_OUT_BOUNDARY_FLAG;
  options.sph_kernel = kernel;
  options.precision = precision;
  options.field = field_kind;
  int64_t points[2], of_flag[4] = { 0 }; /* of_flag: how many points have each flag */
  for (int by_eigenvalue = 0; by_eigenvalue < 2; ++by_eigenvalue)
  {
    options.boundary_detection =
      by_eigenvalue ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
    CORE_SURFACE surface = core_extract(context, &input, &options);
    points[by_eigenvalue] = surface.point_count;
    for (int64_t i = 0; i < surface.point_count; ++i)
    {
      double e[3];
      const int flag = by_eigenvalue ? surface.boundary_flag[i] & 3 : 0;
      oracle_boundary_eigenvalues(&field, surface.points + 3 * i, e);
      CORE_CHECK(fabs(e[0] - (double)surface.boundary_eigenvalue[i]) < 1e-5, kernel, e[0],
        surface.boundary_eigenvalue[i]);
      CORE_CHECK(flag != 1 || fabs(e[0] - options.vertex_threshold) < 2e-5, kernel, e[0]);
      ++of_flag[flag];
    }
  }
  if (field_kind == MCOR_WEIGHT_SUM)
  {
    assert_true(points[0] == points[1] && points[0] > 0);
  }
  else
  {
    CORE_CHECK(of_flag[1] > 100 && of_flag[2] < 10, kernel, of_flag[1], of_flag[2]);
  }
}

static void test_surfaces(void** state)
{
  for (int k = 0; k < MCOR_SPH_KERNEL_COUNT; ++k)
  {
    check_surface(*state, (mcor_sph_kernel)k, MCOR_FLOAT64, MCOR_SHEPARD);
  }
  check_surface(*state, MCOR_CUBIC_SPLINE, MCOR_FLOAT32, MCOR_SHEPARD);
  check_surface(*state, MCOR_M_PRIME_4, MCOR_FLOAT32, MCOR_SHEPARD);
  check_surface(*state, MCOR_CUBIC_SPLINE, MCOR_FLOAT32, MCOR_WEIGHT_SUM);
}

CORE_MAIN(core_set_up, core_tear_down, test_eigenvalues, test_surfaces)
