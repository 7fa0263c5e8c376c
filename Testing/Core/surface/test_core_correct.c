/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests the correction of vertices: whether every particle counts, reported numbers, the limit of steps, poles of a
 * mean. The oracle checks that vertices stay on their edges and are within the tolerance, in fields of any kind. */

#include "core_fixture.h"
#include "mcor_vector.h"

#include <float.h>

/* A field that is nearly constant on both sides of a jump: steep at the surface, flat beside it. */
static double steep(const double x[3])
{
  return tanh(20 * (x[0] + 0.3 * x[1]));
}

/* A field that is above iso at about every other particle: many kinks and crossings. */
static double rough(const double x[3])
{
  return sin(50 * x[0] + 31 * x[1] + 77 * x[2]);
}

/* In double precision the residual shows if any particle was left out, even one whose support just reaches the vertex.
 * Cubes are coarse, so vertices move far from where their neighbours were gathered. Each set is mirrored, too, so that
 * vertices move in both directions. */
static void test_every_particle_counts(void** state)
{
  static const struct
  {
    double (*value)(const double x[3]);
    double cube_factor, spread;
  } at[] = { { rough, 0.7, 0.6 }, { rough, 0.7, 0.6 }, { core_slope, 0.5, 0.3 }, { steep, 1, 0 } };
  for (size_t run = 0; run < 2 * sizeof at / sizeof at[0]; ++run)
  {
    const size_t k = run / 2;
    CORE_SET set = core_make_block(8, 0.3, 4 + k, at[k].value);
    uint64_t seed = 9;
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.smoothing_length[i] *= 1 + at[k].spread * random_unit(&seed);
    }
    for (int64_t i = 0; run % 2 && i < 3 * set.count; ++i)
    {
      set.position[i] = -set.position[i];
    }
    const double iso = 0.05;
    const mcor_input input = core_input(&set);
    mcor_options options = core_options(&iso);
    options.precision = MCOR_FLOAT64;
    options.cube_size_factor = at[k].cube_factor;
    options.vertex_threshold = 0;
    options.tolerance = 1e-11;
    options.iteration_limit = 255;
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    const double range = oracle_scalar_range(&set);
    double worst = 0;
    CORE_FIELD field = oracle_make_field(&set, ORACLE_CUBIC_SPLINE, ORACLE_SHEPARD, 1);
    for (int64_t i = 0; i < surface.point_count; ++i)
    {
      oracle_sample sample;
      oracle_evaluate(&field, NULL, surface.points + 3 * i, &sample);
      worst = fmax(worst, fabs(sample.value - iso) / range);
    }
    CORE_CHECK(surface.point_count > 20 && worst < 1e-10, run, worst, surface.point_count);
  }
}

/* Checks the reported residuals and correction lengths against the points. Reported numbers include what rounding may
 * add, so the true ones must not be greater. */
static void test_reported_numbers(void** state)
{
  CORE_SET set = core_make_block(8, 0.3, 4, core_ball);
  const double iso = 1;
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.outputs |= MCOR_OUT_CORRECTION_LENGTH | MCOR_OUT_RESIDUAL | MCOR_OUT_GRADIENTS;
  options.vertex_threshold = 0;
  CORE_SURFACE corrected = core_extract(*state, &input, &options);
  options.preview = 1;
  CORE_SURFACE preview = core_extract(*state, &input, &options);
  assert_int_equal(preview.triangle_count, corrected.triangle_count);
  assert_memory_equal(preview.triangles, corrected.triangles,
    3 * (size_t)corrected.triangle_count * sizeof *corrected.triangles);
  const mcor_statistics* s = &corrected.statistics;
  double sum = 0, most = 0, worst = 0;
  for (int64_t i = 0; i < corrected.point_count; ++i)
  {
    double d[3];
    mcor_subtract(corrected.points + 3 * i, preview.points + 3 * i, d);
    const double moved = sqrt(mcor_dot(d, d));
    CORE_CHECK(fabs(moved - (double)corrected.correction_length[i]) < 1e-6,
      corrected.correction_length[i], moved);
    sum += moved;
    most = fmax(most, moved);
    const double* g = corrected.gradients + 3 * i;
    worst = fmax(worst,
      fabs((double)corrected.residual[i]) +
        s->position_error / sqrt(3) * (fabs(g[0]) + fabs(g[1]) + fabs(g[2])));
  }
  CORE_CHECK(fabs(sum / (double)corrected.point_count - s->correction_mean) < 1e-6 &&
      fabs(most - s->correction_max) < 1e-6,
    sum / (double)corrected.point_count, most, s->correction_mean, s->correction_max);
  worst += 2 * FLT_EPSILON * fmax(iso - s->scalar_min, s->scalar_max - iso);
  CORE_CHECK(fabs(worst - s->residual_max) <= 1e-6 * worst, worst, s->residual_max);
  CORE_FIELD field = oracle_make_field(&set, ORACLE_CUBIC_SPLINE, ORACLE_SHEPARD, 1);
  for (int64_t i = 0; i < corrected.point_count; ++i)
  {
    oracle_sample sample;
    oracle_evaluate(&field, NULL, corrected.points + 3 * i, &sample);
    CORE_CHECK(
      fabs(sample.value - iso) <= s->residual_max, fabs(sample.value - iso), s->residual_max);
  }
  assert_int_equal(preview.statistics.vertices_corrected, 0);
  assert_true(preview.statistics.correction_max == 0);
}

/* More Newton steps must never make the worst residual larger, and there must not be more steps
 * than the limit allows. */
static void test_iteration_limit(void** state)
{
  CORE_SET set = core_make_block(8, 0.3, 4, steep);
  const double iso = 0.1;
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  double last = INFINITY;
  options.cube_size_factor = 1;
  options.vertex_threshold = 0;
  static const int limits[] = { 1, 2, 4, 8, 255 };
  for (int i = 0; i < (int)(sizeof limits / sizeof limits[0]); ++i)
  {
    options.iteration_limit = limits[i];
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    const mcor_statistics* s = &surface.statistics;
    CORE_CHECK(
      s->iterations_max <= limits[i] && s->iterations_max < 60, s->iterations_max, limits[i]);
    CORE_CHECK(i > 0 || s->vertices_above_tolerance > 0, limits[i]);
    CORE_CHECK(s->residual_max <= last * 1.0001, limits[i], s->residual_max, last);
    last = s->residual_max;
  }
  CORE_CHECK(last < 1e-5, last);
}

/* A looser tolerance must also be met, with fewer evaluations. */
static void test_tolerance(void** state)
{
  CORE_SET set = core_make_block(8, 0.3, 4, core_ball);
  const double iso = 1;
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  int64_t evaluations[2];
  for (int i = 0; i < 2; ++i)
  {
    options.tolerance = i ? 1e-2 : 1e-6;
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    const mcor_statistics* s = &surface.statistics;
    assert_int_equal(s->vertices_above_tolerance, 0);
    CORE_CHECK(s->residual_max <= options.tolerance * (s->scalar_max - s->scalar_min),
      options.tolerance, s->residual_max);
    evaluations[i] = s->newton_evaluations;
  }
  CORE_CHECK(evaluations[1] < evaluations[0], evaluations[0], evaluations[1]);
}

static double core_waves(const double x[3])
{
  return sin(1.3 * x[0]) + cos(0.9 * x[1]) + 0.7 * sin(1.1 * x[2]);
}

/* Half of the particles are solids, and the kernel has negative lobes, so the fluid's weight passes 0 where the weight
 * of fluid and solids is about 1. The mean has a pole there, which must not become a part of the surface. */
static void check_poles(mcor_context* context, uint64_t seed, double spread, int level_limit)
{
  CORE_SET set = core_make_block(12, 0.45, seed, core_waves);
  set.has_solids = 1;
  for (int64_t j = 0; j < set.count; ++j)
  {
    set.solid[j] = ((uint32_t)j * 2654435761u >> 7) % 10 < 5;
    set.smoothing_length[j] *= set.position[3 * j] > 0 ? spread : 1;
  }
  const double iso = 0.3;
  const mcor_array other = core_array(set.position, 3);
  const mcor_input input = core_input_with(&set, &other, 1);
  mcor_options options = core_options(&iso);
  options.sph_kernel = MCOR_M_PRIME_4;
  options.level_limit = level_limit;
  options.outputs |= MCOR_OUT_BOUNDARY_FLAG;
  CORE_SURFACE surface = core_extract(context, &input, &options);
  CORE_FIELD field = oracle_make_field(&set, ORACLE_M_PRIME_4, ORACLE_SHEPARD, 1);
  int64_t lacking = 0;
  for (int64_t v = 0; v < surface.point_count; ++v)
  {
    oracle_sample s;
    oracle_evaluate(&field, NULL, surface.points + 3 * v, &s);
    CORE_CHECK(s.weight > 0.05 - 1e-4, v, s.weight);
    CORE_CHECK(surface.boundary_flag[v] == 2 || fabs(s.value - iso) < 3e-5, v, s.weight, s.value);
    lacking += surface.boundary_flag[v] == 1 && s.weight < 0.05 + 1e-4;
    for (int a = 0; a < 3; ++a)
    {
      CORE_CHECK(fabs(surface.attributes[0][3 * v + a]) < 100, v, surface.attributes[0][3 * v + a]);
    }
  }
  CORE_CHECK(lacking > 10, lacking);
  assert_int_equal(surface.statistics.vertices_above_tolerance, 0);
  assert_true(surface.statistics.trim_vertices_linear * 20 < surface.statistics.trim_vertices);
  CORE_REPORT report = core_check_pinched_mesh(&surface);
}

static void test_poles(void** state)
{
  for (uint64_t seed = 100; seed < 114; ++seed)
  {
    check_poles(*state, seed, 1, 0);
  }
  check_poles(*state, 100, 2.2, 0);
  check_poles(*state, 100, 2.2, MCOR_CUBE_LEVELS - 1);
}

CORE_MAIN(core_set_up, core_tear_down, test_every_particle_counts, test_reported_numbers,
  test_iteration_limit, test_poles, test_tolerance)
