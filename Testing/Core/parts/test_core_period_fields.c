/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests probes and derivatives of periodic particles, against results for the same particles and all their images. */

#include "core_period.h"

/* Returns an input with the set's scalar as its only attribute. */
static mcor_input attribute_input(const particle_set* set, mcor_array* attribute)
{
  mcor_input input = core_input_with(set, attribute, 1);
  *attribute = input.scalar;
  input.scalar = (mcor_array){ 0 };
  return input;
}

enum
{
  POINTS = 1500
};

static void check_equal(const double* values, const double* expected, int count, double limit)
{
  for (int i = 0; i < count; ++i)
  {
    CORE_CHECK(fabs(values[i] - expected[i]) <= limit, i, values[i], expected[i]);
  }
}

/* Evaluates a field with a period at points. Without a period, the particles and all their images must have the same
 * field. With it, the points moved by whole periods must have the same values. */
static void check_points(
  mcor_context* context, const particle_set* set, mcor_options* options, uint64_t version)
{
  double points[2][3 * POINTS];
  uint64_t seed = 9;
  for (int i = 0; i < 3 * POINTS; ++i)
  {
    /* Some points lie on the sides; all have coordinates that a shift by the period leaves exact. */
    const double length = options->periodic[2 * (i % 3) + 1];
    const double at = i % 7 == 0 ? 0 : floor(random_unit(&seed) * 1024) / 1024;
    points[0][i] = at * fmax(length, 8);
    points[1][i] = points[0][i] + length * (i % 5 == 0 ? 1 : i % 5 - 2);
  }
  mcor_array attribute, images_attribute, at = core_array(points[0], 3);
  mcor_input input = attribute_input(set, &attribute);
  input.particles_version = input.scalar_version = version;
  CORE_SAMPLES samples, moved, expected;
  CORE_OK(context, mcor_probe(context, &input, options, &at, POINTS, &samples));
  CORE_SET all = core_add_images(set, options->periodic);
  const mcor_input other = attribute_input(&all, &images_attribute);
  mcor_options plain = *options;
  memset(plain.periodic, 0, sizeof plain.periodic);
  CORE_OK(context, mcor_probe(context, &other, &plain, &at, POINTS, &expected));
  at.data = points[1];
  CORE_OK(context, mcor_probe(context, &input, options, &at, POINTS, &moved));
  for (int i = 0; i < POINTS; ++i)
  {
    CORE_CHECK(samples.weight_sum[i] > 0.3 &&
        fabs(samples.weight_sum[i] - expected.weight_sum[i]) < 1e-5 &&
        fabs(samples.values[0][i] - expected.values[0][i]) < 1e-5,
      i, samples.values[0][i], samples.weight_sum[i], expected.values[0][i],
      expected.weight_sum[i]);
    for (int a = 0; a < 3; ++a)
    {
      assert_true(fabs(samples.gradients[0][3 * i + a] - expected.gradients[0][3 * i + a]) < 1e-4);
    }
  }
  /* If a point lies halfway between two places that the device can store, rounding chooses one. In double precision
   * this happens to some of these points. */
  const int halves = options->cube_size > 0 && options->precision == MCOR_FLOAT64;
  check_equal(moved.weight_sum, samples.weight_sum, POINTS, halves ? 1e-10 : 0);
  check_equal(moved.values[0], samples.values[0], POINTS, halves ? 1e-10 : 0);
  check_equal(moved.gradients[0], samples.gradients[0], 3 * POINTS, halves ? 1e-10 : 0);
}

static void points_see_images(void** state)
{
  const int cube[3] = { 8, 8, 8 }, slab[3] = { 12, 8, 10 };
  const double around[6] = { 0, 8, 0, 8, 0, 8 }, along[6] = { 0, 12, 0, 8, 0, 0 };
  for (int i = 0; i < 8; ++i)
  {
    CORE_SET set = core_make_period(i % 2 ? slab : cube, 5);
    mcor_options options = core_period_options(NULL, i % 2 ? along : around);
    options.iso_count = 0;
    options.precision = i % 4 < 2 ? MCOR_FLOAT32 : MCOR_FLOAT64;
    if (i >= 4)
    {
      options.cube_size = 0.5;
      core_stretch_period(&set, options.periodic);
    }
    check_points(*state, &set, &options, i == 1 ? 77 : 0);
  }
}

/* Checks the derivatives in each half of the period. A particle on the period's lower side must also count on the upper
 * side of the upper half. */
static void check_halves(mcor_context* context, const mcor_input* input,
  const mcor_options* options, const mcor_derivatives* whole)
{
  mcor_globals globals;
  mcor_options part = *options;
  const double* x = input->positions.data;
  CORE_OK(context, mcor_measure_probe_globals(context, input, options, &globals));
  part.globals = &globals;
  for (int h = 0; h < 6; ++h)
  {
    const int axis = h / 2;
    const double length = options->periodic[2 * axis + 1];
    const double low = h % 2 ? length / 2 : 0, high = h % 2 ? length : length / 2;
    CORE_DERIVATIVES found;
    int sides = 0;
    memcpy(part.box, options->periodic, sizeof part.box);
    part.box[2 * axis] = low;
    part.box[2 * axis + 1] = high;
    CORE_OK(context, mcor_derive(context, input, &part, MCOR_GRADIENT_CORRECTED, &found));
    for (int64_t i = 0; i < input->count; ++i)
    {
      const double at = x[3 * i + axis];
      if ((at >= low && at <= high) || at + length == high)
      {
        sides += at == 0;
        check_equal(found.gradients[0] + 3 * i, whole->gradients[0] + 3 * i, 3, 0);
      }
    }
    CORE_CHECK(sides > 10, h, sides);
  }
  mcor_free_globals(&globals);
}

/* Compares gradients at particles, some of which are moved by whole periods, with gradients of an input that has all
 * images as particles. */
static void check_derivatives(void** state, int unequal, mcor_sph_kernel kernel)
{
  const int cube[3] = { 8, 8, 8 };
  double around[6] = { 0, 8, 0, 8, 0, 8 };
  CORE_SET set = core_make_period(cube, 8);
  for (int64_t i = 0; i < 3 * set.count; ++i)
  {
    set.position[i] = i % 11 == 0 ? 0 : floor(set.position[i] * 1024) / 1024;
  }
  if (unequal)
  {
    core_stretch_period(&set, around);
  }
  CORE_SET all = core_add_images(&set, around);
  mcor_array attribute, images_attribute;
  const mcor_input input = attribute_input(&set, &attribute);
  const mcor_input other = attribute_input(&all, &images_attribute);
  mcor_options options = core_period_options(NULL, around), plain = options;
  options.iso_count = plain.iso_count = 0;
  options.sph_kernel = plain.sph_kernel = kernel;
  options.cube_size = unequal ? 0.5 : 0;
  memset(plain.periodic, 0, sizeof plain.periodic);
  mcor_derivatives found, expected, moved;
  CORE_OK(*state, mcor_derive(*state, &input, &options, MCOR_GRADIENT_CORRECTED, &found));
  CORE_OK(*state, mcor_derive(*state, &other, &plain, MCOR_GRADIENT_CORRECTED, &expected));
  check_halves(*state, &input, &options, &found);
  for (int64_t i = 0; i < 3 * set.count; ++i)
  {
    const double is = found.gradients[0][i], was = expected.gradients[0][3 * 13 * set.count + i];
    CORE_CHECK(fabs(is - was) < 1e-4, i, is, was);
    set.position[i] += around[2 * (i % 3) + 1] * (double)(i % 5 - 2);
  }
  CORE_OK(*state, mcor_derive(*state, &input, &options, MCOR_GRADIENT_CORRECTED, &moved));
  assert_memory_equal(
    moved.gradients[0], found.gradients[0], 3 * (size_t)set.count * sizeof(double));
  mcor_free_derivatives(&moved);
  /* After each shift, other particles lie next to the period's sides. */
  for (int shift = 1; shift < 4; ++shift)
  {
    for (int64_t i = 0; i < 3 * set.count; ++i)
    {
      set.position[i] += 0.25;
    }
    CORE_OK(*state, mcor_derive(*state, &input, &options, MCOR_GRADIENT_CORRECTED, &moved));
    for (int64_t i = 0; i < 3 * set.count; ++i)
    {
      const double is = moved.gradients[0][i], was = found.gradients[0][i];
      CORE_CHECK(fabs(is - was) < 1e-4, shift, i, is, was);
    }
    mcor_free_derivatives(&moved);
  }
  mcor_free_derivatives(&found);
  mcor_free_derivatives(&expected);
}

static void derivatives_see_images(void** state)
{
  check_derivatives(state, 0, MCOR_CUBIC_SPLINE);
  check_derivatives(state, 1, MCOR_CUBIC_SPLINE);
  check_derivatives(state, 1, MCOR_QUADRATIC);
}

CORE_MAIN(core_set_up, core_tear_down, points_see_images, derivatives_see_images)
