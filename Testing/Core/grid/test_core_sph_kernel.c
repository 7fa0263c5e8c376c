/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests the SPH kernels as the device evaluates them: values and slopes must equal the oracle's, whose integrals
 * oracle_self checks. */

#include "core_fixture.h"

/* Computes W h^3 at offsets in two ways: alone, as the sums at nodes do, and with its gradient, as the correction does. */
static const char source[] =
  "__kernel void test_kernel(const int count, const real inv_h, __global const real* offset,\n"
  "  __global real* out)\n"
  "{\n"
  "  const int i = get_global_id(0);\n"
  "  if (i >= count)\n"
  "    return;\n"
  "  const realv x = offset[3 * i], y = offset[3 * i + 1], z = offset[3 * i + 2];\n"
  "  const realv d[3] = { x, y, z };\n"
  "  const mcor_length length = mcor_length_of(d);\n"
  "  realv slope, along[3];\n"
  "  const realv w = mcor_weight_gradient(d, &length, inv_h, &slope, along);\n"
  "  const realv gradient[3] = { slope * along[0], slope * along[1], slope * along[2] };\n"
  "  const realv plain = mcor_weight(mcor_distance(x, y, z, inv_h), inv_h);\n"
  "  out[5 * i] = MCOR_GET(w, MCOR_LANES - 1) * MCOR_NORM;\n"
  "  out[5 * i + 1] = MCOR_GET(plain, 0) * MCOR_NORM;\n"
  "  out[5 * i + 2] = MCOR_GET(gradient[0], 0) * MCOR_NORM;\n"
  "  out[5 * i + 3] = MCOR_GET(gradient[1], 0) * MCOR_NORM;\n"
  "  out[5 * i + 4] = MCOR_GET(gradient[2], MCOR_LANES - 1) * MCOR_NORM;\n"
  "}\n";

/* Runs test_kernel for h = 1 / inv_h at `offsets`, which are floats or doubles as `precision` says. Free the result. */
static void* evaluate(mcor_context* context, mcor_sph_kernel kernel, mcor_type precision,
  const void* offsets, int count, double inv_h)
{
  mcor_buffer in = { 0 }, out = { 0 };
  const size_t size = precision == MCOR_FLOAT64 ? sizeof(double) : sizeof(float),
               bytes = (size_t)count * 5 * size;
  void* result = malloc(bytes);
  assert_non_null(result);
  core_build(context, kernel, MCOR_SHEPARD, precision);
  core_extend_program(context, source);
  CORE_OK(context, mcor_write(context, &in, offsets, (size_t)count * 3 * size));
  CORE_OK(context, mcor_reserve(context, &out, bytes));
  CORE_OK(context,
    MCOR_LAUNCH(context, "test_kernel", MCOR_LIGHT, count, MCOR_INT(count), MCOR_REAL(inv_h),
      MCOR_BUFFER(&in), MCOR_BUFFER(&out)));
  CORE_OK(context, mcor_read(context, &out, 0, result, bytes));
  mcor_release(context, &in);
  mcor_release(context, &out);
  return result;
}

/* Compares W and its gradient with the oracle's. */
static void check_values(mcor_context* context, mcor_sph_kernel kernel)
{
  enum
  {
    N = 400
  };
  const double h = 0.7, reach = mcor_support_factor(kernel) * h;
  double offsets[3 * N];
  uint64_t seed = 5;
  for (int i = 0; i < 3 * N; ++i)
  {
    offsets[i] = reach * (2 * random_unit(&seed) - 1);
  }
  CORE_FREED double* w = evaluate(context, kernel, MCOR_FLOAT64, offsets, N, 1 / h);
  for (int i = 0; i < N; ++i)
  {
    double gradient[3];
    const double* at = w + 5 * i;
    const double twin =
      h * h * h * oracle_kernel_value((oracle_kernel)kernel, h, offsets + 3 * i, gradient);
    CORE_CHECK(fabs(at[0] - twin) < 1e-12 && fabs(at[1] - twin) < 1e-12,
      mcor_sph_kernel_name(kernel), offsets[3 * i], offsets[3 * i + 1], offsets[3 * i + 2], at[0],
      at[1], twin);
    for (int a = 0; a < 3; ++a)
    {
      CORE_CHECK(fabs(at[2 + a] - h * h * h * gradient[a]) < 1e-10, mcor_sph_kernel_name(kernel),
        at[2 + a], a, h * h * h * gradient[a]);
    }
  }
}

/* Checks that W and its slope are exactly 0 from the support radius on, that W is not 0 just inside,
 * and that the slope is 0 at the centre. */
static void check_support(mcor_context* context, mcor_sph_kernel kernel)
{
  const double support = mcor_support_factor(kernel);
  const double offsets[6][3] = { { support, 0, 0 }, { 0, -support * 1.5, 0 },
    { 0, 0, support * 1e6 }, { 0, support * 0.98, 0 }, { 0, 0, 0 }, { -support * 1.0001, 0.1, 0 } };
  CORE_FREED double* w = evaluate(context, kernel, MCOR_FLOAT64, offsets[0], 6, 1);
  for (int i = 0; i < 6; ++i)
  {
    const double* at = w + 5 * i;
    const int inside = i == 3 || i == 4;
    CORE_CHECK((at[0] != 0) == inside && (at[1] != 0) == inside, mcor_sph_kernel_name(kernel),
      at[0], at[1], i);
    if (i != 3)
    {
      CORE_CHECK(at[2] == 0 && at[3] == 0 && at[4] == 0, mcor_sph_kernel_name(kernel), at[2], at[3],
        at[4], i);
    }
  }
}

/* Checks single precision, where some formulas differ. Allowed errors: 1.5e-6 of the greatest W; 3e-6 of the steepest
 * slope; 3e-5 of W itself, except near the support radius and for M'4. */
static void check_single(mcor_context* context, mcor_sph_kernel kernel)
{
  enum
  {
    N = 3000
  };
  const double support = mcor_support_factor(kernel), zero[3] = { 0, 0, 0 };
  float offset[3 * N] = { 0 };
  for (int i = 0; i < N; ++i)
  {
    offset[3 * i + i % 3] = (float)(support * (i + 0.5) / N);
  }
  CORE_FREED float* found = evaluate(context, kernel, MCOR_FLOAT32, offset, N, 1);
  const double greatest = oracle_kernel_value((oracle_kernel)kernel, 1, zero, NULL);
  double error = 0, share = 0, slope = 0, steepest = 0;
  for (int i = 0; i < N; ++i)
  {
    const double at[3] = { offset[3 * i], offset[3 * i + 1], offset[3 * i + 2] };
    double gradient[3];
    const double w = oracle_kernel_value((oracle_kernel)kernel, 1, at, gradient);
    error = fmax(error, fabs((double)found[5 * i] - w) / greatest);
    share = fmax(share, i < 0.95 * N && fabs(w) > 1e-6 ? fabs((double)found[5 * i] / w - 1) : 0);
    slope = fmax(slope, fabs((double)found[5 * i + 2 + i % 3] - gradient[i % 3]));
    steepest = fmax(steepest, fabs(gradient[i % 3]));
  }
  CORE_CHECK(
    error < 1.5e-6 && slope < 3e-6 * steepest && (share < 3e-5 || kernel == MCOR_M_PRIME_4),
    mcor_sph_kernel_name(kernel), error, share, slope / steepest);
}

static void test_kernels(void** state)
{
  for (int k = 0; k < MCOR_SPH_KERNEL_COUNT; ++k)
  {
    for (int dimensions = 2; dimensions <= 3; ++dimensions)
    {
      const double found = mcor_kernel_of((mcor_sph_kernel)k)->variance[dimensions == 2],
                   twin = oracle_kernel_variance((oracle_kernel)k, dimensions);
      CORE_CHECK(fabs(found - twin) < 1e-9, mcor_sph_kernel_name((mcor_sph_kernel)k), dimensions,
        found, twin);
    }
    check_values(*state, (mcor_sph_kernel)k);
    check_support(*state, (mcor_sph_kernel)k);
    check_single(*state, (mcor_sph_kernel)k);
  }
}

static void test_names(void** state)
{
  static const char* const names[] = { "cubic", "quadratic", "mprime4", "quintic", "wendland",
    "quartic", "wendland_c4", "wendland_c6", "sinc6" };
  assert_int_equal(sizeof names / sizeof names[0], MCOR_SPH_KERNEL_COUNT);
  for (int k = 0; k < MCOR_SPH_KERNEL_COUNT; ++k)
  {
    assert_int_equal(mcor_find_sph_kernel(names[k]), k);
    assert_string_equal(mcor_sph_kernel_name((mcor_sph_kernel)k), names[k]);
    CORE_CHECK(
      mcor_support_factor((mcor_sph_kernel)k) == oracle_support((oracle_kernel)k), names[k]);
  }
  assert_int_equal(mcor_find_sph_kernel("cubi"), -1);
  assert_int_equal(mcor_find_sph_kernel(NULL), -1);
  assert_null(mcor_sph_kernel_name((mcor_sph_kernel)99));
}

CORE_MAIN(core_set_up, core_tear_down, test_kernels, test_names)
