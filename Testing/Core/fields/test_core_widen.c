/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests widened smoothing lengths. They are compared with plain sums in double precision, and the surface with the
 * surface of an ordinary call that gets these lengths as its input. */

#include "core_fixture.h"
#include "mcor_vector.h"

#define WIDEST 2.0

static particle_set make_scene(int n, double jitter, uint64_t seed)
{
  particle_set set = core_make_splash(n, jitter, seed);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.smoothing_length[i] = 1.1;
    set.scalar[i] = set.position[3 * i];
  }
  return set;
}

static double distance(const particle_set* set, int64_t i, int64_t j)
{
  double way[3];
  mcor_subtract(set->position + 3 * i, set->position + 3 * j, way);
  return sqrt(mcor_dot(way, way));
}

/* Returns the weight of particle k at particle j for smoothing length h. */
static double weight_of(const particle_set* set, int64_t j, int64_t k, double h)
{
  const double offset[3] = { distance(set, j, k), 0, 0 };
  return set->volume[k] * oracle_kernel_value(ORACLE_CUBIC_SPLINE, h, offset, NULL);
}

static double weight_with(const particle_set* set, int64_t j, double s)
{
  double sum = 0;
  for (int64_t k = 0; k < set->count; ++k)
  {
    sum += weight_of(set, j, k, s * set->smoothing_length[j]);
  }
  return sum;
}

static double ramp(double x, double from, double to)
{
  const double t = fmin(fmax((x - from) / (to - from), 0), 1);
  return t * t * (3 - 2 * t);
}

/* Returns the widening factor of particle j: the largest of 1, 1.2, ..., 2 at which j's weight sum exceeds iso by a
 * margin, plus a part of the step to the next number. With few neighbours, the factor is near 1. If all neighbours are
 * on one side, the margin is larger for few neighbours, and may be negative for many. *one_sided: 1 if many neighbours
 * are on one side; 0 if neighbours are few, or on all sides. */
static double expected_factor(const particle_set* set, int64_t j, double iso, double* one_sided)
{
  double crowd = 0, offset[3] = { 0 };
  for (int64_t k = 0; k < set->count; ++k)
  {
    const double r = distance(set, j, k) / (2 * set->smoothing_length[j]);
    const double near = k != j && r < 1 ? 1 - r * r * r : 0;
    crowd += near;
    for (int a = 0; a < 3; ++a)
    {
      offset[a] += near * (set->position[3 * k + a] - set->position[3 * j + a]);
    }
  }
  const double middle =
    sqrt(mcor_dot(offset, offset)) / fmax(crowd, 1) / set->smoothing_length[j];
  double upper = WIDEST, above = weight_with(set, j, upper);
  const double sided = ramp(middle, 0.4, 0.6) * (1.5 * ramp(crowd, 4.5, 6) - 0.5);
  const double least =
    iso + 0.1 * (1 - sided) - 0.08 * fmax(sided, 0) * ramp(above, iso - 0.16, iso - 0.08);
  double s = above >= least ? upper : 1;
  *one_sided = fmax(sided, 0);
  for (int step = 4; step >= 0 && above < least; --step)
  {
    const double lower = 1 + 0.2 * step, c = weight_with(set, j, lower);
    if (c >= least)
    {
      s = lower + (c - least) / (c - above) * (upper - lower);
      break;
    }
    upper = lower;
    above = c;
  }
  return 1 + (s - 1) * ramp(crowd, 2.2, 4.5);
}

static void test_factors(void** state)
{
  mcor_context* context = *state;
  const double iso = 0.5;
  CORE_SET set = make_scene(9, 0.24, 3);
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.field = MCOR_WEIGHT_SUM;
  options.widen = WIDEST;
  CORE_FREED double* s = oracle_allocate(set.count, sizeof *s);
  CORE_FREED double* sided = oracle_allocate(set.count, sizeof *sided);
  for (int64_t j = 0; j < set.count; ++j)
  {
    s[j] = expected_factor(&set, j, iso, &sided[j]);
  }
  for (int precision = 0; precision < 2; ++precision)
  {
    CORE_WIDENING w;
    options.precision = precision ? MCOR_FLOAT64 : MCOR_FLOAT32;
    CORE_OK(context, mcor_widen(context, &input, &options, &w));
    int wide = 0, narrow = 0, outside = 0, corners = 0;
    for (int64_t j = 0; j < set.count; ++j)
    {
      double mean = 0, weight = 0;
      for (int64_t k = 0; k < set.count; ++k)
      {
        const double v = weight_of(&set, j, k, set.smoothing_length[k]);
        mean += v * s[k];
        weight += v;
      }
      const int is = weight_with(&set, j, 1) >= iso && weight_with(&set, j, w.factor[j]) < iso;
      assert_int_equal(w.outside[j], is);
      outside += is;
      const int takes_mean = s[j] == 1 && sided[j] > 0;
      const double share = 4 * sided[j] * (1 - sided[j]);
      const double expected =
        takes_mean ? 1 + share * fmax(mean / weight - 1, 0) : fmax(fmin(s[j], mean / weight), 1);
      corners += takes_mean && expected > 1.05;
      CORE_CHECK(fabs(w.factor[j] - expected) < 2e-4, j, w.factor[j], expected);
      wide += expected > 1.9;
      narrow += expected < 1.01;
    }
    CORE_CHECK(wide > 50 && narrow >= 4 && corners > 0, wide, narrow, corners);
    CORE_CHECK(outside > 10 && w.statistics.widening_outside == outside,
      w.statistics.widening_outside, outside);
  }
}

/* Compares the surface with the surface of an ordinary call whose input has the widened lengths, in uniform cubes of
 * the same size. */
static void check_surface(mcor_context* context, const mcor_input* asked, mcor_options options)
{
  mcor_input input = *asked;
  CORE_WIDENING w;
  options.widen = WIDEST;
  options.level_limit = 0;
  CORE_OK(context, mcor_widen(context, &input, &options, &w));
  CORE_SURFACE widened = core_extract(context, &input, &options);
  assert_int_equal(w.volume != NULL, !mcor_is_given(&input.volume));
  const mcor_statistics* s = &widened.statistics;
  CORE_CHECK(s->widening_min == 1 && s->widening_max > 1.99 && s->widening_mean > 1.1,
    s->widening_min, s->widening_mean, s->widening_max);
  assert_int_equal(s->widening_outside, w.statistics.widening_outside);
  CORE_FREED double* length = oracle_allocate(input.count, sizeof *length);
  for (int64_t j = 0; j < input.count; ++j)
  {
    CORE_CHECK(!(input.solid && input.solid[j]) || w.factor[j] == 1, w.factor[j]);
    length[j] = ((const double*)input.smoothing_length.data)[j] * w.factor[j];
  }
  options.widen = 1;
  options.cube_size = 0.5 * 1.1;
  input.smoothing_length.data = length;
  input.volume = w.volume ? core_array(w.volume, 1) : input.volume;
  CORE_SURFACE plain = core_extract(context, &input, &options);
  CORE_CHECK(plain.point_count > 30 && plain.point_count == widened.point_count, plain.point_count,
    widened.point_count);
  assert_true(core_hash(&plain) == core_hash(&widened));
}

/* Checks the surface in 64 cases. Each bit of a case's number adds a property: a scalar, computed volumes, periods,
 * lengths that differ, solids, particles in a plane. */
static void test_surface(void** state)
{
  CORE_SET set = make_scene(8, 0.24, 5);
  for (int way = 0; way < 64; ++way)
  {
    for (int64_t j = 0; j < set.count; ++j)
    {
      set.smoothing_length[j] = way & 8 ? 1.1 + 0.1 * (double)(j % 3) : 1.1;
      set.solid[j] = way & 16 && set.position[3 * j] < 1.5;
      set.position[3 * j + 2] *= way & 32 ? 0 : 1;
    }
    const double iso = way & 1 ? 3.3 : 0.5;
    mcor_input input = core_input(&set);
    mcor_options options = core_options(&iso);
    options.field = way & 1 ? MCOR_SHEPARD : MCOR_WEIGHT_SUM;
    input.volume = way & 2 ? (mcor_array){ 0 } : input.volume;
    input.solid = way & 16 ? set.solid : NULL;
    for (int a = 0; a < (way & 32 ? 2 : 3) && way & 4; ++a)
    {
      options.periodic[2 * a] = -2.25;
      options.periodic[2 * a + 1] = a == 1 ? 38 : 16 + 2 * a;
    }
    check_surface(*state, &input, options);
  }
}

/* Checks that particles at least 0.6 inside a box get the same factors in the call for the box as
 * in the call for all particles, and that factors do not depend on where a period begins. */
static void test_parts(void** state)
{
  mcor_context* context = *state;
  const double iso = 0.5;
  CORE_SET set = make_scene(8, 0.24, 5);
  CORE_SET moved = make_scene(8, 0.24, 5);
  const mcor_input input = core_input(&set), other = core_input(&moved);
  mcor_options options = core_options(&iso);
  options.field = MCOR_WEIGHT_SUM;
  options.widen = WIDEST;
  for (int periodic = 0; periodic < 2; ++periodic)
  {
    for (int a = 0; a < 3 && periodic; ++a)
    {
      options.periodic[2 * a] = -2.25;
      options.periodic[2 * a + 1] = a == 1 ? 38 : 16 + 2 * a;
    }
    for (int64_t i = 0; i < 3 * set.count; ++i)
    {
      const double* side = options.periodic + i % 3 * 2;
      moved.position[i] = set.position[i] + 0.5 * (side[1] - side[0]);
    }
    mcor_globals globals;
    CORE_WIDENING whole, shifted;
    CORE_OK(context, mcor_widen(context, &input, &options, &whole));
    CORE_OK(context, mcor_widen(context, &other, &options, &shifted));
    CORE_OK(context, mcor_measure_probe_globals(context, &input, &options, &globals));
    for (int side = 0; side < 2; ++side)
    {
      const double box[6] = { side ? 4.1 : -INFINITY, side ? INFINITY : 4.1, -INFINITY, INFINITY,
        -INFINITY, INFINITY };
      mcor_options part = options;
      part.globals = &globals;
      memcpy(part.box, box, sizeof box);
      CORE_WIDENING w;
      CORE_OK(context, mcor_widen(context, &input, &part, &w));
      for (int64_t j = 0; j < set.count - 20; ++j) /* without the thread and the drops */
      {
        const double x = set.position[3 * j];
        CORE_CHECK(x < box[0] + 0.6 || x > box[1] - 0.6 || w.factor[j] == whole.factor[j], j, x,
          w.factor[j], whole.factor[j]);
        CORE_CHECK(
          fabs(shifted.factor[j] - whole.factor[j]) < 2e-4, j, whole.factor[j], shifted.factor[j]);
      }
    }
    mcor_free_globals(&globals);
  }
}

/* Checks that cube sizes follow the unwidened lengths, and that a second call with the same particles has the same
 * result, whatever the device has kept. */
static void test_levels_and_reuse(void** state)
{
  mcor_context* context = *state;
  CORE_SET set = make_scene(8, 0.24, 7);
  static const double isos[4] = { 2, 3.3, 3.3, 3.3 };
  static const double widest[4] = { 1.7, 1.7, 2, 1 };
  for (int64_t j = 0; j < set.count; ++j)
  {
    set.smoothing_length[j] *= set.position[3 * j] < 3 ? 1 : 2.01;
    set.volume[j] *= set.position[3 * j] < 3 ? 1 : 1.2;
  }
  mcor_input input = core_input(&set);
  uint64_t expected[4];
  for (int reuse = 0; reuse < 2; ++reuse)
  {
    input.particles_version = input.scalar_version = (uint64_t)reuse;
    for (int i = 0; i < 8; ++i)
    {
      const int k = i % 4;
      mcor_options options = core_options(&isos[k]);
      options.field = MCOR_SHEPARD;
      options.widen = widest[k];
      options.level_limit = 8;
      CORE_SURFACE surface = core_extract(context, &input, &options);
      assert_int_equal(surface.statistics.highest_level, 1);
      assert_true(surface.point_count > 300);
      expected[k] = reuse == 0 ? core_hash(&surface) : expected[k];
      CORE_CHECK(expected[k] == core_hash(&surface), i);
    }
  }
}

/* Checks a context whose first call has no particle, so that no OpenCL program is chosen. */
static void test_no_particle(void** state)
{
  (void)state;
  CORE_CONTEXT context = NULL;
  CORE_OK(context, mcor_create_context(NULL, &context));
  const double iso = 0.5;
  mcor_options options = core_options(&iso);
  options.widen = WIDEST;
  const mcor_input input = { 0 };
  CORE_WIDENING widening;
  CORE_OK(context, mcor_widen(context, &input, &options, &widening));
  assert_int_equal(widening.count, 0);
}

static void test_refused(void** state)
{
  mcor_context* context = *state;
  const double iso = 0.5;
  CORE_SET set = make_scene(3, 0, 1);
  const mcor_input input = core_input(&set);
  mcor_surface surface;
  mcor_widening widening;
  mcor_options options = core_options(&iso);
  static const double wrong[3] = { 0.9, 4.1, NAN };
  for (int i = 0; i < 3; ++i)
  {
    options.widen = wrong[i];
    CORE_FAILS(context, MCOR_INVALID_ARGUMENT, mcor_widen(context, &input, &options, &widening),
      "WIDENING_ILLEGAL");
    CORE_FAILS(context, MCOR_INVALID_ARGUMENT, mcor_extract(context, &input, &options, &surface),
      "WIDENING_MISSING");
  }
  options.widen = 1;
  options.smooth = 1;
  CORE_FAILS(context, MCOR_INVALID_ARGUMENT, mcor_widen(context, &input, &options, &widening),
    "SMOOTH_NOT_SPELLED_OUT");
  CORE_FAILS(context, MCOR_INVALID_ARGUMENT, mcor_extract(context, &input, &options, &surface),
    "SMOOTH_NOT_SPELLED_OUT");
  mcor_spell_out(&options);
  assert_true(options.widen == 2 && options.compact == 1);
  options.widen = 1.5;
  options.compact = 0;
  options.filled = 1; /* A region needs the points that compaction takes away. */
  mcor_spell_out(&options);
  assert_true(options.widen == 1.5 && options.compact == 0);
  options.filled = 0;
  /* A period is too short for the widened lengths. The message must say which widening fits. */
  options.smooth = 0;
  options.widen = WIDEST;
  options.level_limit = 0;
  options.periodic[1] = 6;
  CORE_FAILS(context, MCOR_INVALID_ARGUMENT, mcor_widen(context, &input, &options, &widening),
    "PERIOD_TOO_SHORT_WIDENED|widened to 4.4|{widen} of no more than 1.2");
}

CORE_MAIN(core_set_up, core_tear_down, test_factors, test_surface, test_parts,
  test_levels_and_reuse, test_no_particle, test_refused)
