/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests curvatures. The curvatures of balls, cylinders and circles are worked out by hand; all others are compared with
 * differences of the oracle's gradients. */

#include "core_fixture.h"

#define CURVATURES (MCOR_OUT_MEAN_CURVATURE | MCOR_OUT_GAUSS_CURVATURE)

static mcor_surface curved(mcor_context* context, const particle_set* set, mcor_options* options)
{
  const mcor_input input = core_input(set);
  options->outputs |= CURVATURES;
  return core_extract(context, &input, options);
}

/* Returns the volume of a unit cube around x within a ball around the origin; x becomes the centre of this part. */
static double share_of_ball(double x[3], double radius)
{
  double sum[3] = { 0, 0, 0 };
  int in = 0;
  for (int i = 0; i < 8000; ++i)
  {
    const double at[3] = { x[0] + (i % 20) / 20.0 - 0.475, x[1] + (i / 20 % 20) / 20.0 - 0.475,
      x[2] + (i / 400) / 20.0 - 0.475 };
    const int is_in = at[0] * at[0] + at[1] * at[1] + at[2] * at[2] < radius * radius;
    in += is_in;
    for (int a = 0; a < 3; ++a)
    {
      sum[a] += is_in * at[a];
    }
  }
  for (int a = 0; a < 3 && in > 0; ++a)
  {
    x[a] = sum[a] / in;
  }
  return in / 8000.0;
}

/* The isosurface is a ball (axes 3) or a cylinder (axes 2) of radius r. Mean curvature times r must be right to within
 * 1e-3, Gaussian curvature times r^2 to within 2e-3. */
static void test_ball_and_cylinder(void** state)
{
  static const struct
  {
    mcor_field field;
    int axes;
    double sign; /* -1: values grow outwards */
  } cases[] = { { MCOR_SHEPARD, 3, 1 }, { MCOR_SHEPARD, 3, -1 }, { MCOR_SHEPARD, 2, 1 },
    { MCOR_WEIGHT_SUM, 3, 1 } };
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; ++c)
  {
    const double radius = cases[c].field == MCOR_WEIGHT_SUM ? 8 : 4;
    const double iso = cases[c].field == MCOR_WEIGHT_SUM ? 0.5 : 0;
    CORE_SET set = core_make_block(24, 0, 1, core_ball);
    int64_t kept = 0;
    for (int64_t i = 0; i < set.count; ++i)
    {
      double* x = set.position + 3 * i;
      const double r2 = x[0] * x[0] + x[1] * x[1] + (cases[c].axes == 3 ? x[2] * x[2] : 0);
      const double volume = cases[c].field == MCOR_WEIGHT_SUM ? share_of_ball(x, radius) : 1;
      if (volume > 0)
      {
        memmove(set.position + 3 * kept, x, 3 * sizeof(double));
        set.scalar[kept] = cases[c].sign * (radius * radius - r2);
        set.smoothing_length[kept] = cases[c].field == MCOR_WEIGHT_SUM ? 3.6 : 2.4;
        set.volume[kept++] = volume;
      }
    }
    set.count = kept;
    mcor_options options = core_options(&iso);
    options.field = cases[c].field;
    options.sph_kernel = MCOR_QUINTIC_SPLINE;
    CORE_SURFACE surface = curved(*state, &set, &options);
    int64_t seen = 0;
    double worst[2] = { 0, 0 };
    for (int64_t p = 0; p < surface.point_count; ++p)
    {
      const double* x = surface.points + 3 * p;
      if (cases[c].field != MCOR_WEIGHT_SUM && (fabs(x[0]) > 6 || fabs(x[1]) > 6 || fabs(x[2]) > 4))
      {
        continue; /* This point is near the end of the lattice. */
      }
      const double r = sqrt(x[0] * x[0] + x[1] * x[1] + (cases[c].axes == 3 ? x[2] * x[2] : 0));
      const double mean = cases[c].axes == 3 ? cases[c].sign : 0.5 * cases[c].sign;
      const double gauss = cases[c].axes == 3 ? 1 : 0;
      worst[0] = fmax(worst[0], fabs(surface.mean_curvature[p] * r - mean));
      worst[1] = fmax(worst[1], fabs(surface.gauss_curvature[p] * r * r - gauss));
      ++seen;
    }
    CORE_CHECK(seen > 100 && worst[0] < 1e-3 && worst[1] < 2e-3, c, seen, worst[0], worst[1]);
  }
}

/* For particles in a plane, the mean curvature is the line's curvature, and there is no Gaussian
 * curvature. */
static void test_circle(void** state)
{
  const double iso = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    CORE_SET set = particle_set_make(24 * 24);
    for (int64_t i = 0; i < set.count; ++i)
    {
      const double u = (double)(i % 24) - 11.5, v = (double)(i / 24) - 11.5;
      set.position[3 * i + axis] = 7;
      set.position[3 * i + (axis + 1) % 3] = u;
      set.position[3 * i + (axis + 2) % 3] = v;
      set.scalar[i] = 16 - u * u - v * v;
      set.smoothing_length[i] = 2.4;
      set.volume[i] = 1;
    }
    mcor_options options = core_options(&iso);
    options.sph_kernel = MCOR_QUINTIC_SPLINE;
    CORE_SURFACE surface = curved(*state, &set, &options);
    assert_true(surface.point_count > 10 && surface.mean_curvature && !surface.gauss_curvature);
    for (int64_t p = 0; p < surface.point_count; ++p)
    {
      const double u = surface.points[3 * p + (axis + 1) % 3],
                   v = surface.points[3 * p + (axis + 2) % 3];
      const double off = surface.mean_curvature[p] * sqrt(u * u + v * v) - 1;
      CORE_CHECK(fabs(off) < 1e-3 || fabs(u) > 6 || fabs(v) > 6, axis, off);
    }
  }
}

/* Computes mean and Gaussian curvature by central differences of gradients, in double precision. */
static void reference(
  const oracle_field* field, const double x[3], double step, double curvature[2])
{
  double h[3][3], g[3];
  oracle_sample sample, side[2];
  oracle_evaluate(field, NULL, x, &sample);
  memcpy(g, field->kind == ORACLE_WEIGHT ? sample.weight_gradient : sample.gradient, sizeof g);
  for (int a = 0; a < 3; ++a)
  {
    for (int s = 0; s < 2; ++s)
    {
      double at[3] = { x[0], x[1], x[2] };
      at[a] += s ? step : -step;
      oracle_evaluate(field, NULL, at, &side[s]);
    }
    for (int b = 0; b < 3; ++b)
    {
      h[a][b] = field->kind == ORACLE_WEIGHT
        ? (side[1].weight_gradient[b] - side[0].weight_gradient[b]) / (2 * step)
        : (side[1].gradient[b] - side[0].gradient[b]) / (2 * step);
    }
  }
  const double g2 = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
  double bent = 0, gauss = 0;
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
      bent += g[a] * h[a][b] * g[b];
      gauss += g[a] * (h[a1][b1] * h[a2][b2] - h[a1][b2] * h[a2][b1]) * g[b];
    }
  }
  curvature[0] = 0.5 * (bent / g2 - (h[0][0] + h[1][1] + h[2][2])) / sqrt(g2);
  curvature[1] = gauss / g2 / g2;
}

/* Compares curvatures of each field with the reference, with solids among the fluid. In the last run, the kernel is a
 * product of one-dimensional kernels. One point in 100 may differ, because the reference is wrong where W'' jumps. */
static void test_any_field(void** state)
{
  CORE_SET set = core_make_block(9, 0.5, 3, core_slope);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] += 2 * sin((double)i);
    set.solid[i] = i % 17 == 0;
  }
  set.has_solids = 1;
  for (int run = 0; run < 4; ++run)
  {
    const mcor_sph_kernel kernel = run < 3 ? MCOR_CUBIC_SPLINE : MCOR_M_PRIME_4;
    const mcor_field fields[3] = { MCOR_SHEPARD, MCOR_SUM, MCOR_WEIGHT_SUM };
    const oracle_kind kinds[3] = { ORACLE_SHEPARD, ORACLE_SUM, ORACLE_WEIGHT };
    const double iso = run % 3 == 2 ? 0.5 : 0.7;
    mcor_options options = core_options(&iso);
    options.field = fields[run % 3];
    options.sph_kernel = kernel;
    CORE_SURFACE surface = curved(*state, &set, &options);
    CORE_FIELD field = oracle_make_field(&set, (oracle_kernel)kernel, kinds[run % 3], 1);
    int64_t good = 0, seen = 0;
    for (int64_t p = 0; p < surface.point_count; p += 5, ++seen)
    {
      double expected[2];
      reference(&field, surface.points + 3 * p, 1e-5, expected);
      good += fabs(surface.mean_curvature[p] - expected[0]) < 1e-3 * (1 + fabs(expected[0])) &&
        fabs(surface.gauss_curvature[p] - expected[1]) <
          1e-3 * (1 + fabs(expected[1]) + expected[0] * expected[0]);
    }
    CORE_CHECK(seen > 100 && (double)good > 0.99 * (double)seen, mcor_sph_kernel_name(kernel),
      run % 3, good, seen);
  }
}

CORE_MAIN(core_set_up, core_tear_down, test_ball_and_cylinder, test_circle, test_any_field)
