/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Correction: residual in double precision, vertices stay on their edges, hard fields, limits. */

#include "core_fixture.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Position along the edge in cubes, 0 to 1; fails if the point lies on no lattice edge. */
static double place_on_edge(const double* x, double cube)
{
  int off = 0;
  double t = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double at = x[a] / cube, away = fabs(at - nearbyint(at));
    if (away > 1e-10)
    {
      t = at - floor(at);
      ++off;
    }
  }
  CORE_CHECK(off <= 1, "(%.12g, %.12g, %.12g) / %g is on no edge", x[0], x[1], x[2], cube);
  return t;
}

typedef struct correct_case
{
  const char* name;
  mcor_sph_kernel kernel;
  mcor_field field;
  mcor_type precision;
  double iso, cube_factor, jitter;
  double (*value)(const double x[3]);
} correct_case;

/* Nearly constant on both sides of a jump: steep at the surface, flat beside it. */
static double steep(const double x[3])
{
  return tanh(20 * (x[0] + 0.3 * x[1]));
}

/* Flat where it is 0: slope 0 on the surface. */
static double flat(const double x[3])
{
  return pow(0.25 * core_slope(x), 3);
}

/* Every other particle above: many kinks and crossings. */
static double rough(const double x[3])
{
  return sin(50 * x[0] + 31 * x[1] + 77 * x[2]);
}

static double offset(const double x[3])
{
  return 101325 + core_slope(x);
}

static const correct_case cases[] = { { "linear", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32, 0,
                                        0.5, 0.3, core_slope },
  { "linear, double", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT64, 0, 0.5, 0.3, core_slope },
  { "sum", MCOR_CUBIC_SPLINE, MCOR_SUM, MCOR_FLOAT32, 2, 0.5, 0.3, core_ball },
  { "steep", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32, 0.1, 1, 0.3, steep },
  { "flat", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT64, 0, 0.5, 0.1, flat },
  { "rough", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT64, 0.1, 0.3, 0.3, rough },
  { "kinks of the quadratic kernel", MCOR_QUADRATIC, MCOR_SUM, MCOR_FLOAT32, 1, 0.5, 0, core_ball },
  { "M'4", MCOR_M_PRIME_4, MCOR_SHEPARD, MCOR_FLOAT64, 0.2, 0.5, 0.3, core_slope },
  { "sinc^6", MCOR_SINC_6, MCOR_SHEPARD, MCOR_FLOAT32, 0.2, 0.5, 0.3, core_slope },
  { "sinc^6, double", MCOR_SINC_6, MCOR_SUM, MCOR_FLOAT64, 2, 0.5, 0.3, core_ball },
  { "coarse", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32, 0, 2, 0.3, core_ball },
  { "large offset", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32, 101325.3, 0.5, 0.3, offset } };

/* |f - iso| over the scalar's range at every point, evaluated in double precision. */
static double worst_residual(
  const core_set* set, const correct_case* at, const mcor_surface* surface)
{
  const oracle_particles particles = core_oracle(set);
  const double range = oracle_scalar_range(&particles);
  double worst = 0;
  oracle_field field;
  assert_true(
    oracle_create_field(&field, &particles, (oracle_kernel)at->kernel, (oracle_kind)at->field, 1));
  for (int64_t i = 0; i < surface->point_count; ++i)
  {
    oracle_sample sample;
    oracle_evaluate(&field, NULL, surface->points + 3 * i, &sample);
    worst = fmax(worst, fabs(sample.value - at->iso) / range);
  }
  oracle_free_field(&field);
  return worst;
}

static void check_case(mcor_context* context, const correct_case* at)
{
  core_set set = core_make_block(8, at->jitter, 4, at->value);
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&at->iso);
  options.sph_kernel = at->kernel;
  options.field = at->field;
  options.precision = at->precision;
  options.cube_size_factor = at->cube_factor;
  options.vertex_threshold = 0;
  options.outputs |= MCOR_OUT_CORRECTION_LENGTH;
  options.outputs |= MCOR_OUT_RESIDUAL;
  mcor_surface surface = core_extract(context, &input, &options);
  const double cube = surface.statistics.cube_size;
  const double limit = at->precision == MCOR_FLOAT64 ? 1e-6 : 5e-6;
  CORE_CHECK(surface.point_count > 20, "%s: %lld points", at->name, (long long)surface.point_count);
  for (int64_t i = 0; i < surface.point_count; ++i)
  {
    place_on_edge(surface.points + 3 * i, cube);
    CORE_CHECK((double)surface.correction_length[i] <= cube, "%s: correction %g", at->name,
      (double)surface.correction_length[i]);
  }
  const double worst = worst_residual(&set, at, &surface);
  CORE_CHECK(worst <= limit, "%s: residual %.3g of the range (%lld above tolerance, %d iterations)",
    at->name, worst, (long long)surface.statistics.vertices_above_tolerance,
    surface.statistics.iterations_max);
  mesh_report report = core_check_mesh(&surface);
  mesh_free_report(&report);
  mcor_free_surface(&surface);
  core_free_set(&set);
}

static void test_residuals(void** state)
{
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
  {
    check_case(*state, cases + i);
  }
}

/* In double precision the residual shows any particle that is left out, even at its kernel's rim: of
 * coarse cubes, whose vertices move far from where gathering began, and of kernels of all sizes; each
 * mirrored, too, so that what moves up moves down. */
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
    core_set set = core_make_block(8, 0.3, 4 + k, at[k].value);
    uint64_t seed = 9;
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.smoothing_length[i] *= 1 + at[k].spread * random_unit(&seed);
    }
    for (int64_t i = 0; run % 2 && i < 3 * set.count; ++i)
    {
      set.position[i] = -set.position[i];
    }
    const correct_case c = { "", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT64, 0.05,
      at[k].cube_factor, 0.3, at[k].value };
    const mcor_input input = core_input(&set);
    mcor_options options = core_options(&c.iso);
    options.precision = c.precision;
    options.cube_size_factor = c.cube_factor;
    options.vertex_threshold = 0;
    options.tolerance = 1e-11;
    options.iteration_limit = 255;
    mcor_surface surface = core_extract(*state, &input, &options);
    const double worst = worst_residual(&set, &c, &surface);
    CORE_CHECK(surface.point_count > 20 && worst < 1e-10, "run %d: residual %.3g at one of %lld",
      (int)run, worst, (long long)surface.point_count);
    mcor_free_surface(&surface);
    core_free_set(&set);
  }
}

/* The edges are those of the preview, point for point: correction changes no topology. */
static void test_bracket_is_kept(void** state)
{
  core_set set = core_make_block(8, 0.3, 4, rough);
  const double iso = 0.1;
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.vertex_threshold = 0;
  options.preview = 1;
  mcor_surface preview = core_extract(*state, &input, &options);
  options.preview = 0;
  mcor_surface corrected = core_extract(*state, &input, &options);
  assert_int_equal(preview.point_count, corrected.point_count);
  assert_int_equal(preview.triangle_count, corrected.triangle_count);
  assert_memory_equal(
    preview.triangles, corrected.triangles, (size_t)preview.triangle_count * 3 * sizeof(int32_t));
  for (int64_t i = 0; i < preview.point_count; ++i)
  {
    const double cube = preview.statistics.cube_size;
    for (int a = 0; a < 3; ++a)
    {
      const double p = preview.points[3 * i + a] / cube, c = corrected.points[3 * i + a] / cube;
      CORE_CHECK(p == c || floor(p) == floor(c), "point %lld left its edge: %.17g, %.17g",
        (long long)i, p, c);
    }
  }
  CORE_CHECK(memcmp(preview.points, corrected.points, 3 * sizeof(double)) != 0, "no correction");
  mcor_free_surface(&preview);
  mcor_free_surface(&corrected);
  core_free_set(&set);
}

/* The reported residuals and lengths are those of the points, and what rounded positions and sums may add; true ones
 * are not greater. */
static void test_reported_numbers(void** state)
{
  core_set set = core_make_block(8, 0.3, 4, core_ball);
  const double iso = 1;
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.outputs |= MCOR_OUT_CORRECTION_LENGTH | MCOR_OUT_RESIDUAL | MCOR_OUT_GRADIENTS;
  options.vertex_threshold = 0;
  mcor_surface corrected = core_extract(*state, &input, &options);
  options.preview = 1;
  mcor_surface preview = core_extract(*state, &input, &options);
  const mcor_statistics* s = &corrected.statistics;
  double sum = 0, most = 0, worst = 0;
  for (int64_t i = 0; i < corrected.point_count; ++i)
  {
    double d2 = 0;
    for (int a = 0; a < 3; ++a)
    {
      d2 += pow(corrected.points[3 * i + a] - preview.points[3 * i + a], 2);
    }
    CORE_CHECK(fabs(sqrt(d2) - (double)corrected.correction_length[i]) < 1e-6,
      "length %g, moved %g", (double)corrected.correction_length[i], sqrt(d2));
    sum += sqrt(d2);
    most = fmax(most, sqrt(d2));
    const double* g = corrected.gradients + 3 * i;
    worst = fmax(worst,
      fabs((double)corrected.residual[i]) +
        s->position_error / sqrt(3) * (fabs(g[0]) + fabs(g[1]) + fabs(g[2])));
  }
  CORE_CHECK(fabs(sum / (double)corrected.point_count - s->correction_mean) < 1e-6 &&
      fabs(most - s->correction_max) < 1e-6,
    "mean %g, max %g; statistics %g, %g", sum / (double)corrected.point_count, most,
    s->correction_mean, s->correction_max);
  worst += 2 * FLT_EPSILON * fmax(iso - s->scalar_min, s->scalar_max - iso);
  CORE_CHECK(fabs(worst - s->residual_max) <= 1e-6 * worst, "residual %g, statistics %g", worst,
    s->residual_max);
  const oracle_particles particles = core_oracle(&set);
  oracle_field field;
  assert_true(oracle_create_field(&field, &particles, ORACLE_CUBIC_SPLINE, ORACLE_SHEPARD, 1));
  for (int64_t i = 0; i < corrected.point_count; ++i)
  {
    oracle_sample sample;
    oracle_evaluate(&field, NULL, corrected.points + 3 * i, &sample);
    CORE_CHECK(fabs(sample.value - iso) <= s->residual_max, "residual %g, statistics %g",
      fabs(sample.value - iso), s->residual_max);
  }
  oracle_free_field(&field);
  assert_int_equal(preview.statistics.vertices_corrected, 0);
  CORE_CHECK(preview.statistics.correction_max == 0, "a preview corrects nothing");
  mcor_free_surface(&preview);
  mcor_free_surface(&corrected);
  core_free_set(&set);
}

/* More steps never make the worst residual larger; the limit is never passed. */
static void test_iteration_limit(void** state)
{
  core_set set = core_make_block(8, 0.3, 4, steep);
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
    mcor_surface surface = core_extract(*state, &input, &options);
    const mcor_statistics* s = &surface.statistics;
    CORE_CHECK(s->iterations_max <= limits[i] && s->iterations_max < 60, "%d iterations of %d",
      s->iterations_max, limits[i]);
    CORE_CHECK(
      i > 0 || s->vertices_above_tolerance > 0, "limit %d: all within tolerance", limits[i]);
    CORE_CHECK(s->residual_max <= last * 1.0001, "limit %d: residual %g after %g", limits[i],
      s->residual_max, last);
    last = s->residual_max;
    mcor_free_surface(&surface);
  }
  CORE_CHECK(last < 1e-5, "residual %g in the end", last);
  core_free_set(&set);
}

/* A looser tolerance is kept, too, and costs fewer evaluations. */
static void test_tolerance(void** state)
{
  core_set set = core_make_block(8, 0.3, 4, core_ball);
  const double iso = 1;
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  int64_t evaluations[2];
  for (int i = 0; i < 2; ++i)
  {
    options.tolerance = i ? 1e-2 : 1e-6;
    mcor_surface surface = core_extract(*state, &input, &options);
    const mcor_statistics* s = &surface.statistics;
    assert_int_equal(s->vertices_above_tolerance, 0);
    CORE_CHECK(s->residual_max <= options.tolerance * (s->scalar_max - s->scalar_min),
      "tolerance %g: residual %g", options.tolerance, s->residual_max);
    evaluations[i] = s->newton_evaluations;
    mcor_free_surface(&surface);
  }
  CORE_CHECK(evaluations[1] < evaluations[0], "%lld and %lld evaluations",
    (long long)evaluations[0], (long long)evaluations[1]);
  core_free_set(&set);
}

static double core_waves(const double x[3])
{
  return sin(1.3 * x[0]) + cos(0.9 * x[1]) + 0.7 * sin(1.1 * x[2]);
}

/* Half of the particles are solid, so that the fluid's weight, with a kernel that has negative lobes,
 * passes 0 where that of both is about 1: a mean then has a pole, which is no place of the surface. */
static void check_poles(mcor_context* context, uint64_t seed, double spread, int level_limit)
{
  core_set set = core_make_block(12, 0.45, seed, core_waves);
  set.has_solids = 1;
  for (int64_t j = 0; j < set.count; ++j)
  {
    set.solid[j] = ((uint32_t)j * 2654435761u >> 7) % 10 < 5;
    set.smoothing_length[j] *= set.position[3 * j] > 0 ? spread : 1;
  }
  const double iso = 0.3;
  mcor_input input = core_input(&set);
  const mcor_array other = core_array(set.position, 3);
  input.attributes = &other;
  input.attribute_count = 1;
  mcor_options options = core_options(&iso);
  options.sph_kernel = MCOR_M_PRIME_4;
  options.level_limit = level_limit;
  options.outputs |= MCOR_OUT_BOUNDARY_FLAG;
  mcor_surface surface = core_extract(context, &input, &options);
  oracle_particles particles = core_oracle(&set);
  oracle_field field;
  assert_true(oracle_create_field(&field, &particles, ORACLE_M_PRIME_4, ORACLE_SHEPARD, 1));
  int64_t lacking = 0;
  for (int64_t v = 0; v < surface.point_count; ++v)
  {
    oracle_sample s;
    oracle_evaluate(&field, NULL, surface.points + 3 * v, &s);
    CORE_CHECK(s.weight > 0.05 - 1e-4, "vertex %lld: fluid %g", (long long)v, s.weight);
    CORE_CHECK(surface.boundary_flag[v] == 2 || fabs(s.value - iso) < 3e-5,
      "vertex %lld, fluid %g: %g", (long long)v, s.weight, s.value);
    lacking += surface.boundary_flag[v] == 1 && s.weight < 0.05 + 1e-4;
    for (int a = 0; a < 3; ++a)
    {
      CORE_CHECK(fabs(surface.attributes[0][3 * v + a]) < 100, "vertex %lld: attribute %g",
        (long long)v, surface.attributes[0][3 * v + a]);
    }
  }
  CORE_CHECK(lacking > 10, "%lld cuts where the fluid ends", (long long)lacking);
  assert_int_equal(surface.statistics.vertices_above_tolerance, 0);
  assert_true(surface.statistics.trim_vertices_linear * 20 < surface.statistics.trim_vertices);
  mesh_report report = core_check_pinched_mesh(&surface);
  mesh_free_report(&report);
  oracle_free_field(&field);
  mcor_free_surface(&surface);
  core_free_set(&set);
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

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_residuals),
    cmocka_unit_test(test_every_particle_counts), cmocka_unit_test(test_bracket_is_kept),
    cmocka_unit_test(test_reported_numbers), cmocka_unit_test(test_iteration_limit),
    cmocka_unit_test(test_poles), cmocka_unit_test(test_tolerance) };
  return cmocka_run_group_tests_name("correct", tests, core_set_up, core_tear_down);
}
