/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests the search grid's order, and estimated smoothing lengths. The oracle checks that queries find all particles. */

#include "core_fixture.h"
#include "mcor_input.h"

#include <float.h>

/* Cube roots of cubes of whole numbers must be exact, other cube roots right to within two units of rounding, and all
 * must have the same bits on every machine. */
static void test_cube_root(void** state)
{
  uint64_t seed = 34;
  for (int i = 0; i < 10000; ++i)
  {
    const double root = ldexp(1 + random_unit(&seed), (int)(600 * random_unit(&seed)) - 300);
    const double found = mcor_cube_root(root * root * root);
    CORE_CHECK(fabs(found / root - 1) < 2 * DBL_EPSILON, found, root);
    const double whole = i + 1;
    CORE_CHECK(mcor_cube_root(whole * whole * whole) == whole, whole);
  }
  const double volume = 4.0 / 3.0 * 3.14159265358979323846;
  assert_true(mcor_cube_root(volume / 33) == 0x1.01501895415edp-1);
  assert_true(mcor_cube_root(volume / 2) == 0x1.47894e24991b8p+0);
}

/* The estimated smoothing length must be 1.3 times the spacing of a lattice: most particles are far from its faces. */
static void test_estimate(void** state)
{
  const double spacings[] = { 1, 1e-3, 250 };
  for (int s = 0; s < 3; ++s)
  {
    CORE_SET set = core_make_block(30, 0, 1, core_ball);
    for (int64_t i = 0; i < 3 * set.count; ++i)
    {
      set.position[i] *= spacings[s];
    }
    const double iso = 9;
    mcor_input input = core_input(&set);
    input.volume = (mcor_array){ 0 };
    input.estimate_smoothing_length = 1;
    const mcor_options options = core_options(&iso);
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    const double h = surface.statistics.smoothing_length_min / spacings[s];
    CORE_CHECK(
      fabs(h / 1.3 - 1) < 0.02 && surface.statistics.smoothing_length_max / spacings[s] == h, h);
  }
}

static uint64_t hash_of(mcor_context* context, const particle_set* set, double iso)
{
  const mcor_input input = core_input(set);
  mcor_options options = core_options(&iso);
  options.cube_size = 0.5;
  options.node_threshold = options.vertex_threshold = 0.01;
  options.outputs |= MCOR_OUT_GRADIENTS | MCOR_OUT_WEIGHT_SUM | MCOR_OUT_RESIDUAL;
  CORE_SURFACE surface = core_extract(context, &input, &options);
  CORE_CHECK(surface.triangle_count > 50, surface.triangle_count);
  return core_hash(&surface);
}

/* Makes `count` particles in few cells of the search grid, `coincident` of them at one place, and 40 others. Checks
 * that two orders of the particles, with the OpenCL code for CPUs and for GPUs, give the same bits. */
static void check_crowd(mcor_context* context, mcor_context* gpu, int count, int coincident)
{
  CORE_SET set = core_make_random(count + 40, 0.5, 2, 2, (uint64_t)(count + coincident));
  uint64_t seed = 9;
  double iso = 0; /* lies between the crowd's mean and the mean of the particles beside the crowd */
  for (int i = 0; i < count + 40; ++i)
  {
    set.scalar[i] = (double)(random_bits(&seed) % 1000);
    set.volume[i] = i % 3 ? 1 : 2;
    iso += 0.5 * set.scalar[i] / (i < count ? count : 40);
    for (int a = 0; a < 3; ++a)
    {
      double* x = set.position + 3 * i + a;
      *x = i < coincident ? 0.1 : i < count ? floor(*x * 30) / 30 : *x + 3;
      set.volume[i] = i < coincident ? 1 : set.volume[i];
    }
  }
  CORE_FREED int64_t* order = core_make_order(set.count, 4);
  CORE_SET permuted = core_permute(&set, order);
  const uint64_t expected = hash_of(context, &set, iso);
  CORE_CHECK(hash_of(context, &permuted, iso) == expected && hash_of(gpu, &set, iso) == expected &&
      hash_of(gpu, &permuted, iso) == expected,
    count, coincident);
}

/* Checks crowded cells: about as many particles as one work-item sorts, and more, spread or at one place. */
static void test_crowds(void** state)
{
  static const int counts[][2] = { { 63, 0 }, { 64, 64 }, { 65, 65 }, { 129, 129 }, { 128, 0 },
    { 257, 0 }, { 1000, 130 }, { 1000, 1000 }, { 5000, 700 }, { 20000, 0 }, { 20000, 9000 } };
  CORE_CONTEXT gpu = NULL;
  core_create_with(&gpu, "MCOR_DEVICE_FORM", "gpu");
  for (size_t i = 0; i < sizeof counts / sizeof counts[0]; ++i)
  {
    check_crowd(*state, gpu, counts[i][0], counts[i][1]);
  }
}

CORE_MAIN(core_set_up, core_tear_down, test_cube_root, test_estimate, test_crowds)
