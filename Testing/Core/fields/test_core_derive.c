/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests SPH gradients at the particles. */

#include "core_fixture.h"
#include "mcor_vector.h"

static mcor_derivatives derive(mcor_context* context, const particle_set* set, const double* values,
  int components, mcor_type precision, mcor_gradient form)
{
  const mcor_array attribute = core_array(values, components);
  mcor_input input = core_input_with(set, &attribute, 1);
  input.scalar = (mcor_array){ 0 };
  mcor_options options = core_options(NULL);
  options.precision = precision;
  options.dimension = 3; /* three particles would otherwise be two-dimensional */
  mcor_derivatives derivatives;
  CORE_OK(context, mcor_derive(context, &input, &options, form, &derivatives));
  return derivatives;
}

/* J of the velocity v = J x: a rotation, a shear and a strain, none of them near 0. */
static const double derive_jacobian[3][3] = { { 0.3, -2, 0.5 }, { 2, -0.1, 1 }, { 0, 0.7, 0.4 } };

/* Checks that the corrected gradient of a linear field is exact, with disordered particles that have one h, or h that
 * varies by a factor of 2. */
static void test_linear_is_exact(void** state)
{
  for (int run = 0; run < 3; ++run)
  {
    const double tolerance = run < 2 ? 2e-5 : 2e-12;
    CORE_SET set = core_make_block(14, 0.15, 77, core_slope);
    CORE_FREED double* v = oracle_allocate(set.count * 3, sizeof(double));
    uint64_t seed = 5;
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.smoothing_length[i] = run > 0 ? 1.2 * (1 + random_unit(&seed)) : 1.3;
      for (int a = 0; a < 3; ++a)
      {
        v[3 * i + a] = 1000 + mcor_dot(derive_jacobian[a], set.position + 3 * i);
      }
    }
    CORE_DERIVATIVES d = derive(
      *state, &set, v, 3, run < 2 ? MCOR_FLOAT32 : MCOR_FLOAT64, MCOR_GRADIENT_CORRECTED);
    assert_int_equal(d.statistics.fluid_particles, set.count);
    assert_true(d.statistics.seconds[MCOR_PHASE_CORRECTION] > 0);
    for (int64_t i = 0; i < 9 * set.count; ++i)
    {
      const double expected = derive_jacobian[i / 3 % 3][i % 3], got = d.gradients[0][i];
      CORE_CHECK(
        d.corrected[i / 9] && fabs(got - expected) <= tolerance, run, i, got, expected);
    }
  }
}

/* Sums the standard form of the gradient without the library. */
static void derive_standard(const particle_set* set, int64_t i, double gradient[3])
{
  gradient[0] = gradient[1] = gradient[2] = 0;
  for (int64_t j = 0; j < set->count; ++j)
  {
    double offset[3], g[3];
    mcor_subtract(set->position + 3 * i, set->position + 3 * j, offset);
    oracle_kernel_value(ORACLE_CUBIC_SPLINE, set->smoothing_length[j], offset, g);
    for (int a = 0; a < 3 && !set->solid[j]; ++a)
    {
      gradient[a] += set->volume[j] * (set->scalar[j] - set->scalar[i]) * g[a];
    }
  }
}

/* Checks that the standard form equals derive_standard's sum; solids have no gradient, and their
 * values (NaN) play no part. */
static void test_standard_form(void** state)
{
  CORE_SET set = core_make_random(2500, 9, 0.7, 2, 4);
  set.has_solids = 1;
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.volume[i] = 0.3;
    set.solid[i] = i % 5 == 0;
    set.scalar[i] = set.solid[i] ? NAN : set.scalar[i];
  }
  CORE_DERIVATIVES d = derive(*state, &set, set.scalar, 1, MCOR_FLOAT32, MCOR_GRADIENT_STANDARD);
  for (int64_t i = 0; i < set.count; ++i)
  {
    double expected[3] = { 0, 0, 0 };
    if (!set.solid[i])
    {
      derive_standard(&set, i, expected);
    }
    assert_int_equal(d.corrected[i], 0);
    for (int a = 0; a < 3; ++a)
    {
      const double got = d.gradients[0][3 * i + a];
      CORE_CHECK(fabs(got - expected[a]) <= 2e-5, i, got, expected[a]);
    }
  }
}

/* Checks groups whose correction has no inverse matrix: one particle, two, three in a plane, and four nearly in a
 * plane. The four span a body 100 times as wide as high, so inversion would magnify rounding by 100^2. */
static void test_too_few_neighbours(void** state)
{
  CORE_SET set = particle_set_make(10);
  const double x[10][3] = { { 0, 0, 0 }, { 10, 0, 0 }, { 11, 0, 0 }, { 20, 0, 0 }, { 21, 0, 0 },
    { 20, 1, 0 }, { 30, 0, 0 }, { 31, 0, 0 }, { 30, 1, 0 }, { 31, 1, 0.01 } };
  for (int i = 0; i < 10; ++i)
  {
    memcpy(set.position + 3 * i, x[i], sizeof x[i]);
    set.smoothing_length[i] = 1.2;
    set.volume[i] = 1;
    set.scalar[i] = i;
  }
  CORE_DERIVATIVES d = derive(*state, &set, set.scalar, 1, MCOR_FLOAT32, MCOR_GRADIENT_CORRECTED);
  for (int i = 0; i < 10; ++i)
  {
    double expected[3];
    derive_standard(&set, i, expected);
    assert_int_equal(d.corrected[i], 0);
    for (int a = 0; a < 3; ++a)
    {
      CORE_CHECK(fabs(d.gradients[0][3 * i + a] - expected[a]) <= 1e-5, i);
    }
  }
}

/* Checks the decomposition of gradients whose parts are known: rotation, shear, strain. */
static void test_decomposition(void** state)
{
  const double gradients[5][9] = { { 0, -1, 0, 1, 0, 0, 0, 0, 0 }, /* rotation about z */
    { 0, 2, 0, 0, 0, 0, 0, 0, 0 },                                 /* shear */
    { 3, 0, 0, 0, 2, 0, 0, 0, 1 },                                 /* strain */
    { 1, 0, 0, 0, 1, 0, 0, 0, 1 }, { 0, -0.5, -0.2, 0.5, 0, -0.3, 0.2, 0.3, 0 } };
  double divergence[5], vorticity[15], q[5], lambda2[5], strain[45];
  const mcor_flow flow = { divergence, vorticity, q, lambda2, strain };
  assert_int_equal(mcor_decompose_gradients(gradients[0], 5, &flow), MCOR_OK);
  const double expected_divergence[] = { 0, 0, 6, 3, 0 }, expected_q[] = { 1, 0, 11, 3, 0.38 },
               expected_lambda2[] = { -1, 0, 4, 1, -0.38 };
  for (int i = 0; i < 5; ++i)
  {
    CORE_CHECK(fabs(divergence[i] - expected_divergence[i]) < 1e-12, i);
    CORE_CHECK(fabs(q[i] - expected_q[i]) < 1e-12, i, q[i]);
    CORE_CHECK(
      fabs(lambda2[i] - expected_lambda2[i]) < 1e-15 * (1 + fabs(lambda2[i])), i, lambda2[i]);
  }
  assert_true(vorticity[2] == 2 && vorticity[5] == -2 && vorticity[8] == 0);
  assert_true(strain[9 + 1] == 1 && strain[9 + 3] == 1 && strain[1] == 0);
}

CORE_MAIN(core_set_up, core_tear_down, test_linear_is_exact, test_standard_form,
  test_too_few_neighbours, test_decomposition)
