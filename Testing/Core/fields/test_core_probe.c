/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests the field at points: it agrees with the oracle, and its bits do not depend on the other points. */

#include "core_fixture.h"
#include "mcor_input.h"

/* Returns `count` points in a cube of edge `size` around the origin; free them with free(). */
static double* probe_points(int64_t count, double size, uint64_t seed)
{
  double* points = oracle_allocate(count * 3, sizeof(double));
  for (int64_t i = 0; i < 3 * count; ++i)
  {
    points[i] = size * (random_unit(&seed) - 0.5);
  }
  return points;
}

static mcor_options probe_options(void)
{
  mcor_options options = core_options(NULL);
  options.outputs |= MCOR_OUT_GRADIENTS;
  return options;
}

/* Evaluates the set's scalar at points, [count][3]. */
static mcor_samples probe(mcor_context* context, const particle_set* set,
  const mcor_options* options, const double* points, int64_t count)
{
  const mcor_array attribute = core_array(set->scalar, 1), at = core_array(points, 3);
  mcor_input input = core_input_with(set, &attribute, 1);
  input.scalar = (mcor_array){ 0 };
  mcor_samples samples;
  CORE_OK(context, mcor_probe(context, &input, options, &at, count, &samples));
  return samples;
}

/* Compares all samples at one point with the oracle. scale: the size of the array's values. steep: errors of gradients
 * are divided by the largest component of the expected gradient, if this is above 1. Returns the divisor, which is 1 if
 * not `steep`. */
static double probe_compare(const oracle_field* field, const double point[3], double threshold,
  double scale, bool steep, double tolerance, const mcor_samples* samples, int64_t i)
{
  double steepest = 1;
  oracle_sample expected;
  oracle_evaluate(field, NULL, point, &expected);
  CORE_CHECK(fabs(samples->weight_sum[i] - expected.weight) <= tolerance * fmax(1, expected.weight),
    i, samples->weight_sum[i], expected.weight);
  if (fabs(expected.weight - threshold) < tolerance && threshold > 0)
  {
    return steepest;
  }
  assert_int_equal(samples->valid[i], expected.weight >= threshold);
  if (!samples->valid[i])
  {
    assert_true(samples->values[0][i] == 0);
    return steepest;
  }
  CORE_CHECK(fabs(samples->values[0][i] - expected.value) <= tolerance * scale, i,
    samples->values[0][i], expected.value);
  for (int a = 0; a < 3 && steep; ++a)
  {
    steepest = fmax(steepest, fabs(expected.gradient[a]));
  }
  for (int a = 0; a < 3; ++a)
  {
    const double got = samples->gradients[0][3 * i + a];
    const double rise = samples->weight_gradient[3 * i + a];
    CORE_CHECK(fabs(got - expected.gradient[a]) <= 20 * tolerance * scale * steepest, i, got,
      expected.gradient[a]);
    CORE_CHECK(steep || fabs(rise - expected.weight_gradient[a]) <= 20 * tolerance * scale, i, rise,
      expected.weight_gradient[a]);
  }
  return steepest;
}

static void test_against_oracle(void** state)
{
  static const struct
  {
    mcor_sph_kernel sph_kernel;
    mcor_field field;
    mcor_type precision;
    double offset; /* added to the scalar */
    double tolerance;
    double
      size; /* the edge of the particles' cube; in a small one more particles reach a point than are gathered at
                  * once */
  } cases[] = { { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32, 0, 3e-6, 10 },
    { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32, 0, 1e-5, 3 },
    { MCOR_CUBIC_SPLINE, MCOR_SUM, MCOR_FLOAT32, 100, 3e-6, 10 },
    { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32, 1e5, 3e-6, 10 },
    { MCOR_QUINTIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT64, -3, 1e-11, 10 },
    { MCOR_SINC_6, MCOR_SHEPARD, MCOR_FLOAT64, -3, 1e-11, 10 } };
  const int64_t count = 2000;
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; ++c)
  {
    const double size = cases[c].size, offset = cases[c].offset;
    const bool is_sum = cases[c].field == MCOR_SUM;
    CORE_SET set = core_make_random(3000, size, 0.6, 1.8, 11);
    set.has_solids = 1;
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.volume[i] = pow(size, 3) / 3000;
      set.solid[i] = i % 7 == 0;
      set.scalar[i] += offset;
    }
    CORE_FREED double* points = probe_points(count, 1.2 * size, 5);
    mcor_options options = probe_options();
    options.sph_kernel = cases[c].sph_kernel;
    options.field = cases[c].field;
    options.precision = cases[c].precision;
    CORE_SAMPLES samples = probe(*state, &set, &options, points, count);
    CORE_FIELD field = oracle_make_field(
      &set, (oracle_kernel)cases[c].sph_kernel, is_sum ? ORACLE_SUM : ORACLE_SHEPARD, 1);
    int valid = 0;
    for (int64_t i = 0; i < count; ++i)
    {
      probe_compare(&field, points + 3 * i, options.node_threshold, 1 + (is_sum ? fabs(offset) : 0),
        false, cases[c].tolerance, &samples, i);
      valid += samples.valid[i];
    }
    assert_in_range(valid, count / 4, count - 1);
  }
}

/* Smoothing lengths differ by a factor of 1000. Errors are divided before they are compared: errors of weights by the
 * weight, errors of gradients by the gradient's largest component, but never by less than 1. */
static void test_wide_range_against_oracle(void** state)
{
  CORE_SET set = core_make_random(3000, 10, 0.004, 4, 23);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.volume[i] =
      0.8 * pow(set.smoothing_length[i], 2); /* small particles weigh most where they are */
  }
  const int64_t count = 3000;
  CORE_FREED double* points = oracle_allocate(count * 3, sizeof(double));
  uint64_t seed = 31;
  for (int64_t i = 0; i < count; ++i) /* points within the supports of single particles */
  {
    const int64_t j = (int64_t)(random_unit(&seed) * (double)set.count);
    for (int a = 0; a < 3; ++a)
    {
      points[3 * i + a] =
        set.position[3 * j + a] + set.smoothing_length[j] * (2 * random_unit(&seed) - 1);
    }
  }
  mcor_options options = probe_options();
  options.node_threshold = 0;
  CORE_FIELD field = oracle_make_field(&set, ORACLE_CUBIC_SPLINE, ORACLE_SHEPARD, 1);
  for (int precision = 0; precision < 2; ++precision)
  {
    /* In single precision, positions are rounded to 1e-5 of the least h. */
    const double tolerance = precision ? 1e-11 : 5e-5;
    double most = 0;
    options.precision = precision ? MCOR_FLOAT64 : MCOR_FLOAT32;
    CORE_SAMPLES samples = probe(*state, &set, &options, points, count);
    for (int64_t i = 0; i < count; ++i)
    {
      most = fmax(most, probe_compare(&field, points + 3 * i, 0, 1, true, tolerance, &samples, i));
    }
    assert_true(most > 20); /* some points lie at small particles */
  }
}

/* Probes two arrays at points in a cube of edge `size`, then at half of the points in another order. The bits at each
 * point must be the same. The arrays have 12 components together, so that the sums take more than one round. */
static void probe_in_another_order(mcor_context* context, double size, double h_min, double h_max)
{
  CORE_SET set = core_make_random(2000, size, h_min, h_max, 3);
  CORE_FREED double* wide = oracle_allocate(set.count * 11, sizeof(double));
  uint64_t seed = 9;
  for (int64_t i = 0; i < set.count * 11; ++i)
  {
    wide[i] = random_unit(&seed);
  }
  const mcor_array attributes[2] = { core_array(set.scalar, 1), core_array(wide, 11) };
  const mcor_input input = core_input_with(&set, attributes, 2);
  const mcor_options options = probe_options();
  const int64_t count = 700;
  CORE_FREED double* points = probe_points(count, size, 21);
  CORE_FREED int64_t* order = core_make_order(count, 8);
  CORE_FREED double* moved = oracle_allocate(count * 3, sizeof(double));
  for (int64_t i = 0; i < count; ++i)
  {
    memcpy(moved + 3 * i, points + 3 * order[i], 3 * sizeof(double));
  }
  mcor_array at = core_array(points, 3);
  CORE_SAMPLES one, other;
  CORE_OK(context, mcor_probe(context, &input, &options, &at, count, &one));
  at.data = moved;
  CORE_OK(context, mcor_probe(context, &input, &options, &at, count / 2, &other));
  for (int64_t i = 0; i < count / 2; ++i)
  {
    const int64_t j = order[i];
    assert_memory_equal(other.weight_sum + i, one.weight_sum + j, sizeof(double));
    assert_memory_equal(other.values[0] + i, one.values[0] + j, sizeof(double));
    assert_memory_equal(other.values[1] + 11 * i, one.values[1] + 11 * j, 11 * sizeof(double));
    assert_memory_equal(
      other.gradients[1] + 33 * i, one.gradients[1] + 33 * j, 33 * sizeof(double));
  }
}

static void test_bits_do_not_depend_on_other_points(void** state)
{
  probe_in_another_order(*state, 8, 0.5, 0.9);
  /* The largest support radius is 256 cube edges. */
  probe_in_another_order(*state, 30, 0.25, 16);
}

/* Probes points in a cube of edge `size` around (x, 0, 0), first with only the nearby particles on the device, then
 * with all particles, which later calls may reuse. The bits must be the same. Returns how many points are valid. */
static int probe_near(
  mcor_context* context, const particle_set* set, bool volumes, double x, double size)
{
  const int64_t count = 300;
  CORE_FREED double* points = probe_points(count, size, 4);
  for (int64_t i = 0; i < count; ++i)
  {
    points[3 * i] += x;
  }
  mcor_input near = core_input(set), all = core_input_to_keep(set);
  const mcor_array attribute = near.scalar, at = core_array(points, 3);
  near.attributes = all.attributes = &attribute;
  near.attribute_count = all.attribute_count = 1;
  if (!volumes)
  {
    near.volume = all.volume = (mcor_array){ 0 };
  }
  const mcor_options options = probe_options();
  CORE_SAMPLES one, other;
  CORE_OK(context, mcor_probe(context, &near, &options, &at, count, &one));
  const int staged = context->grid.count;
  CORE_OK(context, mcor_probe(context, &all, &options, &at, count, &other));
  assert_true(staged <= set->count / 2); /* The other half is 40 away. */
  assert_int_equal(context->grid.count, set->count);
  assert_memory_equal(one.weight_sum, other.weight_sum, (size_t)count * sizeof(double));
  assert_memory_equal(one.values[0], other.values[0], (size_t)count * sizeof(double));
  assert_memory_equal(one.gradients[0], other.gradients[0], (size_t)count * 3 * sizeof(double));
  int valid = 0;
  for (int64_t i = 0; i < count; ++i)
  {
    valid += one.valid[i];
  }
  return valid;
}

static void test_only_particles_nearby_are_needed(void** state)
{
  CORE_SET set = core_make_random(4000, 12, 0.3, 1.2, 17);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.position[3 * i] += i % 2 ? 40 : 0;
    set.volume[i] = 0.8;
  }
  for (int volumes = 0; volumes < 2; ++volumes)
  {
    assert_true(probe_near(*state, &set, volumes, 0, 2) > 0);
    assert_true(probe_near(*state, &set, volumes, 41, 1e-9) > 0);
    /* The points lie between the groups. */
    assert_int_equal(probe_near(*state, &set, volumes, 20, 2), 0);
    /* The points lie outside of everything. */
    assert_int_equal(probe_near(*state, &set, volumes, 1000, 2), 0);
  }
}

static void test_odd_points(void** state)
{
  mcor_context* context = *state;
  CORE_SET set = core_make_block(6, 0, 1, core_slope);
  const mcor_array attribute = core_array(set.scalar, 1);
  const mcor_input input = core_input_with(&set, &attribute, 1);
  mcor_options options = core_options(NULL);
  const double points[] = { 0, 0, 0, NAN, 0, 0, 1e300, 0, 0, INFINITY, 0, 0, -40, 0, 0 };
  CORE_FREED double* copy = core_copy(points, sizeof points);
  const mcor_array at = core_array(copy, 3);
  CORE_SAMPLES samples;
  CORE_OK(context, mcor_probe(context, &input, &options, &at, 5, &samples));
  assert_int_equal(samples.valid[0], 1);
  assert_int_equal(samples.statistics.fluid_particles, set.count);
  assert_true(samples.statistics.seconds[MCOR_PHASE_CORRECTION] > 0);
  assert_true(samples.statistics.device[0] != 0);
  for (int i = 1; i < 5; ++i)
  {
    assert_int_equal(samples.valid[i], 0);
    assert_true(samples.weight_sum[i] == 0);
  }
  mcor_free_samples(&samples);
  CORE_OK(context, mcor_probe(context, &input, &options, NULL, 0, &samples));
  mcor_free_samples(&samples);
  assert_int_equal(mcor_probe(context, &input, &options, NULL, 1, &samples), MCOR_INVALID_ARGUMENT);
  set.scalar[3] = NAN;
  CORE_OK(context, mcor_probe(context, &input, &options, &at, 5, &samples));
  assert_int_equal(samples.attribute_not_finite[0], 3);
  assert_null(samples.values[0]);
}

/* A point whose weight exactly equals the threshold must be valid. */
static void test_threshold_itself(void** state)
{
  mcor_context* context = *state;
  CORE_SET set = core_make_block(3, 0.2, 5, core_slope);
  const double at[3] = { 0.3, -0.2, 0.1 };
  const mcor_input input = core_input(&set);
  const mcor_array points = core_array(at, 3);
  mcor_options options = core_options(NULL);
  mcor_samples samples;
  CORE_OK(context, mcor_probe(context, &input, &options, &points, 1, &samples));
  const double weight = samples.weight_sum[0];
  mcor_free_samples(&samples);
  for (int above = 0; above < 2; ++above)
  {
    options.node_threshold = above ? nextafter(weight, 9) : weight;
    CORE_OK(context, mcor_probe(context, &input, &options, &points, 1, &samples));
    assert_int_equal(samples.valid[0], !above);
    mcor_free_samples(&samples);
  }
}

/* ---- attributes kept between calls ---- */

typedef struct kept_call
{
  particle_set set;
  double *points, *other;
  mcor_array attributes[2 * MCOR_ATTRIBUTE_LIMIT];
  mcor_input input;
  mcor_options options;
} kept_call;

#define KEPT_POINTS 200

/* Probes, and checks that a new context gives the same bits. reused: the call must use the attributes that the last
 * call left on the device. */
static void kept_probe(mcor_context* context, const kept_call* call, bool reused, const char* step)
{
  const mcor_array at = core_array(call->points, 3);
  mcor_input alone = call->input;
  CORE_CONTEXT fresh = NULL;
  CORE_SAMPLES got, expected;
  alone.particles_version = alone.scalar_version = alone.attributes_version = 0;
  /* If kept values are used, the array itself is not read, so NaN in it does no harm. */
  double* const values = (double*)call->attributes[0].data;
  const double value = values[0];
  values[0] = reused ? NAN : value;
  CORE_OK(context, mcor_probe(context, &call->input, &call->options, &at, KEPT_POINTS, &got));
  values[0] = value;
  CORE_OK(fresh, mcor_create_context(NULL, &fresh));
  CORE_OK(fresh, mcor_probe(fresh, &alone, &call->options, &at, KEPT_POINTS, &expected));
  for (int a = 0; a < call->input.attribute_count; ++a)
  {
    CORE_CHECK(got.attribute_not_finite[a] == expected.attribute_not_finite[a], step);
    if (expected.values[a])
    {
      const size_t bytes =
        (size_t)mcor_components(&call->attributes[a]) * KEPT_POINTS * sizeof(double);
      CORE_CHECK(memcmp(got.values[a], expected.values[a], bytes) == 0, step, a);
    }
  }
}

static void test_kept_attributes(void** state)
{
  mcor_context* context = *state;
  kept_call call = { .set = core_make_random(800, 6, 0.6, 1.2, 31), .options = core_options(NULL) };
  call.points = probe_points(KEPT_POINTS, 6, 9);
  call.other = probe_points(call.set.count, 3, 7);
  call.input = core_input_to_keep(&call.set);
  call.input.attributes = call.attributes;
  call.input.attribute_count = 1;
  call.input.attributes_version = 5;
  call.attributes[0] = call.input.scalar;
  kept_probe(context, &call, false, "first");
  kept_probe(context, &call, true, "again");
  call.points[0] += 0.5;
  kept_probe(context, &call, true, "other points");
  call.options.field = MCOR_SUM;
  call.input.attribute_count = 2;
  call.attributes[1] = core_array(call.other, 3);
  kept_probe(context, &call, false, "one more");
  kept_probe(context, &call, true, "one more, again");
  call.attributes[0] = core_array(call.other, 1);
  call.input.attributes_version = 6;
  kept_probe(context, &call, false, "other values");
  const double iso = 0.3;
  const mcor_options of_surface = core_options(&iso);
  CORE_SURFACE surface = core_extract(context, &call.input, &of_surface);
  kept_probe(context, &call, false, "after a surface");
  call.options.h_scale = 1.2;
  kept_probe(context, &call, false, "another search grid");
  call.input.particles_version = call.input.scalar_version += 1000;
  kept_probe(context, &call, false, "other particles");
  kept_probe(context, &call, true, "other particles, again");
  mcor_release_memory(context);
  kept_probe(context, &call, false, "released");
  call.input.attributes_version = 0;
  kept_probe(context, &call, false, "no version");
  kept_probe(context, &call, false, "no version, again");
  call.input.attributes_version = 7;
  call.other[0] = NAN;
  kept_probe(context, &call, false, "not finite");
  kept_probe(context, &call, false, "not finite, again");
  call.other[0] = 1;
  call.input.attributes_version = 8;
  call.input.attribute_count = MCOR_ATTRIBUTE_LIMIT + 1;
  for (int a = 1; a <= MCOR_ATTRIBUTE_LIMIT; ++a)
  {
    call.attributes[a] = call.input.scalar;
  }
  kept_probe(context, &call, false, "too many");
  kept_probe(context, &call, false, "too many, again");
  free(call.points);
  free(call.other);
  particle_set_free(&call.set);
}

/* Probes exactly at particles, where the quadratic kernel's gradient has no direction and must be
 * 0. */
static void test_at_particles(void** state)
{
  CORE_SET set = core_make_random(3000, 10, 0.6, 6, 11);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.volume[i] = 1.0 / 3;
  }
  mcor_options options = probe_options();
  options.sph_kernel = MCOR_QUADRATIC;
  CORE_SAMPLES samples = probe(*state, &set, &options, set.position, set.count);
  CORE_FIELD field = oracle_make_field(&set, ORACLE_QUADRATIC, ORACLE_SHEPARD, 1);
  for (int64_t i = 0; i < set.count; ++i)
  {
    probe_compare(
      &field, set.position + 3 * i, options.node_threshold, 1, false, 5e-6, &samples, i);
  }
}

/* Checks that a mean lies between the least and the greatest value, even with rounding. */
static void test_means_are_between(void** state)
{
  CORE_SET set = core_make_random(3000, 10, 0.6, 1.8, 11);
  uint64_t seed = 3;
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.volume[i] = 1.0 / 3;
    set.scalar[i] = set.position[3 * i] < 4 ? 0 : 12421.7 * random_unit(&seed);
  }
  CORE_FREED double* points = probe_points(20000, 10, 5);
  mcor_options options = probe_options();
  options.outputs &= ~(unsigned)MCOR_OUT_GRADIENTS;
  CORE_SAMPLES samples = probe(*state, &set, &options, points, 20000);
  int zero = 0, more = 0;
  for (int64_t i = 0; i < 20000; ++i)
  {
    CORE_CHECK(samples.values[0][i] >= 0, i, samples.values[0][i]);
    zero += samples.valid[i] && samples.values[0][i] == 0;
    more += samples.values[0][i] > 1;
  }
  CORE_CHECK(zero > 1000 && more > 1000, zero, more);
}

CORE_MAIN(core_set_up, core_tear_down, test_threshold_itself, test_against_oracle,
  test_wide_range_against_oracle, test_bits_do_not_depend_on_other_points,
  test_only_particles_nearby_are_needed, test_odd_points, test_kept_attributes, test_at_particles,
  test_means_are_between)
