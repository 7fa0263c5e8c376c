/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The boundary eigenvalue: its value and gradient against sums in double precision on the host, the eigenvalue solver
 * alone, and the array. The oracle compares surfaces that are trimmed by it. */

#include "core_fixture.h"

#include <math.h>
#include <stdlib.h>

static const char source[] =
  "__kernel void test_boundary(MCOR_GRID_PARAMS, const int count, __global const int4* node,\n"
  "  __global const real4* offset, __global real* out)\n"
  "{\n"
  "  const int i = get_global_id(0);\n"
  "  if (i >= count)\n"
  "    return;\n"
  "  const mcor_grid grid = MCOR_GRID;\n"
  "  mcor_points points;\n"
  "  mcor_query query;\n"
  "  mcor_tile tile;\n"
  "  mcor_boundary_at at;\n"
  "  mcor_group_load(&grid, i, i + 1, node, offset, 0, &points, &query);\n"
  "  mcor_tile_init(&tile);\n"
  "  mcor_evaluate_boundary(&grid, &query, &tile, &points, false, true, &at);\n"
  "  out[4 * i] = MCOR_GET(at.value, 0);\n"
  "  out[4 * i + 1] = MCOR_GET(at.gx, MCOR_LANES - 1);\n"
  "  out[4 * i + 2] = MCOR_GET(at.gy, 0);\n"
  "  out[4 * i + 3] = MCOR_GET(at.gz, MCOR_LANES - 1);\n"
  "}\n"
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

static void write_reals(
  mcor_context* context, mcor_buffer* buffer, const double* values, size_t count)
{
  float* single = malloc(count * sizeof(float));
  assert_non_null(single);
  for (size_t i = 0; i < count; ++i)
  {
    single[i] = (float)values[i];
  }
  const size_t real = context->cl.real_size;
  const void* data = real == sizeof(float) ? (const void*)single : (const void*)values;
  CORE_OK(context, mcor_write(context, buffer, data, count * real));
  free(single);
}

/* Reads [count][4] reals, releases the buffer. */
static void read_reals(mcor_context* context, mcor_buffer* buffer, int count, double* values)
{
  const size_t bytes = (size_t)count * 4 * context->cl.real_size;
  void* host = malloc(bytes);
  assert_non_null(host);
  CORE_OK(context, mcor_read(context, buffer, 0, host, bytes));
  for (int i = 0; i < 4 * count; ++i)
  {
    values[i] = mcor_get_real(context, host, i);
  }
  free(host);
  mcor_release(context, buffer);
}

/* Eigenvalue and gradient (per unit length) at points, over the particles of the last
 * extraction. */
static void evaluate(mcor_context* context, const double (*points)[3], int count, double* out)
{
  mcor_buffer node = { 0 }, offset = { 0 }, result = { 0 };
  cl_int* nodes = calloc((size_t)count, 4 * sizeof(cl_int));
  double* offsets = calloc((size_t)count, 4 * sizeof(double));
  assert_true(nodes && offsets);
  const double cube = context->lattice.cube;
  for (int i = 0; i < 4 * count; ++i)
  {
    if (i % 4 < 3)
    {
      const double at = points[i / 4][i % 4] / cube - (double)context->lattice.origin[i % 4];
      nodes[i] = (cl_int)floor(at);
      offsets[i] = at - nodes[i];
    }
  }
  core_extend_program(context, source);
  CORE_OK(context, mcor_write(context, &node, nodes, (size_t)count * 4 * sizeof(cl_int)));
  write_reals(context, &offset, offsets, (size_t)count * 4);
  CORE_OK(context, mcor_reserve(context, &result, (size_t)count * 4 * context->cl.real_size));
  CORE_OK(context,
    MCOR_LAUNCH(context, "test_boundary", MCOR_HEAVY, count, MCOR_GRID_ARGS(context),
      MCOR_INT(count), MCOR_BUFFER(&node), MCOR_BUFFER(&offset), MCOR_BUFFER(&result)));
  read_reals(context, &result, count, out);
  for (int i = 0; i < 4 * count; ++i)
  {
    out[i] /= i % 4 ? cube : 1;
  }
  mcor_release(context, &node);
  mcor_release(context, &offset);
  free(nodes);
  free(offsets);
}

/* Makes the search grid of a set. */
static void load(
  mcor_context* context, const core_set* set, mcor_sph_kernel kernel, mcor_type precision)
{
  const double iso = 0;
  const mcor_input input = core_input_to_keep(set);
  mcor_options options = core_options(&iso);
  options.sph_kernel = kernel;
  options.precision = precision;
  mcor_surface surface = core_extract(context, &input, &options);
  mcor_free_surface(&surface);
}

/* ---- value and gradient ---- */

static void check_gradient(const oracle_field* field, const double x[3], const double* found)
{
  double e[3], low[3], high[3];
  oracle_boundary_eigenvalues(field, x, e);
  if (e[1] - e[0] < 0.05)
  {
    return; /* hardly a gradient where eigenvalues cross */
  }
  for (int a = 0; a < 3; ++a)
  {
    const double step = 1e-6;
    double p[3] = { x[0], x[1], x[2] };
    p[a] = x[a] - step;
    oracle_boundary_eigenvalues(field, p, low);
    p[a] = x[a] + step;
    oracle_boundary_eigenvalues(field, p, high);
    const double slope = (high[0] - low[0]) / (2 * step);
    CORE_CHECK(fabs(slope - found[1 + a]) < 1e-4 * (1 + fabs(slope)),
      "kernel %d at %g %g %g: slope %g along axis %d, should be %g", (int)field->kernel, x[0], x[1],
      x[2], found[1 + a], a, slope);
  }
}

static void check_values(mcor_context* context, mcor_sph_kernel kernel, mcor_type precision)
{
  enum
  {
    N = 300
  };
  static double points[N][3], found[4 * N];
  core_set set = core_make_random(500, 4, 0.5, 1.0, 31);
  uint64_t seed = 9;
  for (int64_t j = 0; j < set.count; ++j)
  {
    set.volume[j] *= 0.3;
    set.solid[j] = kernel == MCOR_CUBIC_SPLINE && j % 5 == 0;
  }
  set.has_solids = kernel == MCOR_CUBIC_SPLINE; /* each variant is a program to build */
  for (int i = 0; i < 3 * N; ++i)
  {
    points[i / 3][i % 3] = 5 * random_unit(&seed) - 2.5;
  }
  const oracle_particles particles = core_oracle(&set);
  oracle_field field;
  assert_true(oracle_create_field(&field, &particles, (oracle_kernel)kernel, ORACLE_SHEPARD, 1));
  load(context, &set, kernel, precision);
  evaluate(context, (const double(*)[3])points, N, found);
  const double tolerance = precision == MCOR_FLOAT64 ? 1e-9 : 5e-6;
  double most = 0;
  for (int i = 0; i < N; ++i)
  {
    double e[3];
    oracle_boundary_eigenvalues(&field, points[i], e);
    most = fmax(most, e[0]);
    CORE_CHECK(fabs(found[4 * i] - e[0]) < tolerance * (1 + fabs(e[2])),
      "kernel %d at %g %g %g: eigenvalue %.9g, should be %.9g of %g", (int)kernel, points[i][0],
      points[i][1], points[i][2], found[4 * i], e[0], e[2]);
    if (precision == MCOR_FLOAT64)
    {
      check_gradient(&field, points[i], found + 4 * i);
    }
  }
  CORE_CHECK(most > 0.3, "no point is inside: %g", most);
  oracle_free_field(&field);
  core_free_set(&set);
}

static void test_values(void** state)
{
  for (int k = 0; k < MCOR_SPH_KERNEL_COUNT; ++k)
  {
    check_values(*state, (mcor_sph_kernel)k, MCOR_FLOAT64);
  }
  check_values(*state, MCOR_CUBIC_SPLINE, MCOR_FLOAT32);
  check_values(*state, MCOR_M_PRIME_4, MCOR_FLOAT32);
}

/* ---- eigenvalues ---- */

/* xx yy zz xy yz zx */
static const double matrices[][6] = { { 0, 0, 0, 0, 0, 0 }, { 1, 1, 1, 0, 0, 0 },
  { 3, 1, 2, 0, 0, 0 }, { 2, 2, 2, 1, 1, 1 }, { 2, 2, 2, -1, -1, -1 }, { 1, 1, 1, 1, 1, 1 },
  { 1, 1, 5, 1e-7, 0, 0 }, { 1, 1, 1, 1e-8, 1e-9, 1e-10 }, { 1e-20, 2e-20, 3e-20, 1e-20, 0, 0 },
  { 0, 0, 0, 1e-25, 1e-30, 1e-25 }, { 0, 0, 0, 1, 0, 0 }, { 1e6, 1, 1e-6, 1, 1, 1 },
  { -1, 0.5, 2, 0.3, -0.7, 0.1 }, { 0.9, 1.1, 0.5, 0.01, 0.02, -0.03 }, { 4, 9, 1, 6, 3, 2 } };

/* m e = value e with |e| = 1, and m - value without a negative eigenvalue. Entries so small that
 * their squares vanish in single precision are as good as 0. */
static void check_eigen(const double m[6], const double found[4], double tolerance)
{
  const double full[3][3] = { { m[0], m[3], m[5] }, { m[3], m[1], m[4] }, { m[5], m[4], m[2] } };
  const double *e = found + 1, value = found[0];
  double length = 0, scale = 0;
  for (int a = 0; a < 3; ++a)
  {
    length += e[a] * e[a];
    scale = fmax(scale, fabs(full[a][0]) + fabs(full[a][1]) + fabs(full[a][2]));
  }
  const double small = tolerance * scale + 1e-19;
  CORE_CHECK(fabs(length - 1) < 4 * tolerance, "length %g", length);
  for (int a = 0; a < 3; ++a)
  {
    const double rest = full[a][0] * e[0] + full[a][1] * e[1] + full[a][2] * e[2] - value * e[a];
    CORE_CHECK(fabs(rest) < 10 * small, "m e - %g e has %g at %d (size %g)", value, rest, a, scale);
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
    CORE_CHECK(form > -10 * small, "%g is not the smallest: %g (size %g)", value, form, scale);
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
    write_reals(*state, &in, matrices[0], N * 6);
    CORE_OK(*state, mcor_reserve(*state, &out, N * 4 * sizeof(double)));
    CORE_OK(*state,
      MCOR_LAUNCH(
        *state, "test_eigen", MCOR_LIGHT, N, MCOR_INT(N), MCOR_BUFFER(&in), MCOR_BUFFER(&out)));
    read_reals(*state, &out, N, found);
    mcor_release(*state, &in);
    for (int i = 0; i < N; ++i)
    {
      check_eigen(matrices[i], found + 4 * i, precision == MCOR_FLOAT64 ? 1e-14 : 1e-6);
    }
  }
}

/* ---- the array ---- */

/* The array is there on request whatever trims, and on the free surface, which nothing trims. */
static void test_array(void** state)
{
  core_set set = core_make_block(8, 0.2, 3, core_slope);
  const double iso = 0.5;
  const mcor_input input = core_input(&set);
  const oracle_particles particles = core_oracle(&set);
  oracle_field field;
  assert_true(oracle_create_field(&field, &particles, ORACLE_CUBIC_SPLINE, ORACLE_WEIGHT, 1));
  mcor_options options = core_options(&iso);
  options.outputs |= MCOR_OUT_BOUNDARY_EIGENVALUE;
  for (int free_surface = 0; free_surface < 2; ++free_surface)
  {
    options.field = free_surface ? MCOR_WEIGHT_SUM : MCOR_SHEPARD;
    options.boundary_detection = MCOR_BOUNDARY_WEIGHT_SUM;
    mcor_surface surface = core_extract(*state, &input, &options);
    options.boundary_detection = MCOR_BOUNDARY_EIGENVALUE;
    mcor_surface other = core_extract(*state, &input, &options);
    CORE_CHECK(
      (surface.point_count == other.point_count) == free_surface && surface.point_count > 0,
      "%lld and %lld points", (long long)surface.point_count, (long long)other.point_count);
    for (int64_t i = 0; i < surface.point_count; ++i)
    {
      double e[3];
      oracle_boundary_eigenvalues(&field, surface.points + 3 * i, e);
      CORE_CHECK(fabs(e[0] - (double)surface.boundary_eigenvalue[i]) < 1e-5,
        "eigenvalue %g, reported %g", e[0], (double)surface.boundary_eigenvalue[i]);
    }
    mcor_free_surface(&surface);
    mcor_free_surface(&other);
  }
  oracle_free_field(&field);
  core_free_set(&set);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_eigenvalues),
    cmocka_unit_test(test_values), cmocka_unit_test(test_array) };
  return cmocka_run_group_tests_name("boundary", tests, core_set_up, core_tear_down);
}
