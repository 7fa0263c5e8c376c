/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Periodic boxes: the library against the oracle, which has all images as particles; a density known
 * in closed form; and all particles shifted. */

#include "oracle_case.h"
#include "particle_period.h"
#include "particle_sets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- against the oracle ---- */

typedef struct period_case
{
  const char* name;
  mcor_sph_kernel kernel;
  mcor_field field;
  double iso, cube, h_scale;
  const char* open; /* axes that have no period */
  int volumes;      /* 0: computed */
  int precise;      /* double precision */
} period_case;

static const period_case cases[] = {
  { "cubic", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1.2, 0.7, 1.0, "", 1, 0 },
  { "cubic", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 0.8, 0.7, 1.0, "", 1, 1 },
  { "cubic-open", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1.0, 0.5, 1.0, "z", 1, 0 },
  { "cubic-open2", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1.2, 0.7, 1.0, "xz", 1, 0 },
  { "cubic-volumes", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1.2, 0.9, 0.75, "", 0, 0 },
  { "sum", MCOR_CUBIC_SPLINE, MCOR_SUM, 1.0, 0.7, 1.0, "y", 1, 0 },
  { "free", MCOR_CUBIC_SPLINE, MCOR_WEIGHT_SUM, 0.5, 0.7, 1.0, "z", 1, 0 },
  { "free-open2", MCOR_WENDLAND_C2, MCOR_WEIGHT_SUM, 0.4, 0.7, 1.0, "yz", 0, 1 },
  { "quadratic", MCOR_QUADRATIC, MCOR_SHEPARD, 1.2, 0.9, 1.0, "", 1, 0 },
  { "wendland", MCOR_WENDLAND_C2, MCOR_SHEPARD, 1.5, 0.7, 1.0, "x", 1, 0 },
  { "quintic", MCOR_QUINTIC_SPLINE, MCOR_SHEPARD, 1.0, 0.9, 0.75, "", 1, 0 },
  { "mprime4", MCOR_M_PRIME_4, MCOR_SHEPARD, 1.2, 0.9, 1.0, "y", 1, 1 },
};

/* unequal: the edges. */
static void run_case(oracle_suite* suite, const period_case* one, int unequal)
{
  oracle_particles particles = particle_period_make(3);
  oracle_case at;
  double iso = one->iso;
  memset(&at, 0, sizeof(at));
  at.input = particle_period_input(&particles);
  at.input.volume = one->volumes ? at.input.volume : (mcor_array){ 0 };
  at.options = oracle_case_options(&iso);
  at.options.sph_kernel = one->kernel;
  at.options.field = one->field;
  at.options.cube_size_factor = one->cube;
  at.options.h_scale = one->h_scale;
  at.options.precision = one->precise ? MCOR_FLOAT64 : MCOR_FLOAT32;
  particle_period_set(&at.options, one->open);
  if (unequal)
  {
    particle_period_stretch(&particles, &at.options);
  }
  at.skip_pairs = one->field == MCOR_WEIGHT_SUM;
  snprintf(at.name, sizeof(at.name), "period/%s/%g%s%s", one->name, iso,
    one->precise ? "/double" : "", unequal ? "/unequal" : "");
  oracle_run_case(suite, &at);
  oracle_free_particles(&particles);
}

/* ---- the density ---- */

static void expect(oracle_suite* suite, int condition, const char* what, double figure)
{
  if (!condition)
  {
    printf("  FAILED: %s: %.3g\n", what, figure);
    ++suite->failures;
  }
}

/* How far from the surface of the density itself, about: what smoothing and sampling make of it. */
static void check_density(oracle_suite* suite, const oracle_particles* particles)
{
  double iso = 1.0, sum = 0.0, largest = 0.0;
  const mcor_input input = particle_period_input(particles);
  mcor_options options = oracle_case_options(&iso);
  mcor_surface surface;
  particle_period_set(&options, "");
  ++suite->cases;
  const mcor_status status = mcor_extract(suite->context, &input, &options, &surface);
  expect(suite, status == MCOR_OK && surface.point_count > 1000, "points", 0.0);
  for (int64_t i = 0; i < surface.point_count; ++i)
  {
    const double* x = &surface.points[3 * i];
    double slope = 0.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      double side[2];
      for (int s = 0; s < 2; ++s)
      {
        double y[3] = { x[0], x[1], x[2] };
        y[axis] += (2 * s - 1) * 1e-4;
        side[s] = particle_period_density(y);
      }
      slope += pow((side[1] - side[0]) / 2e-4, 2.0);
    }
    const double distance = fabs(particle_period_density(x) - iso) / sqrt(slope);
    sum += distance;
    largest = fmax(largest, distance);
  }
  const double mean = sum / (double)surface.point_count;
  printf("density: %lld points, %.3g particle spacings from it on average, %.3g at most\n",
    (long long)surface.point_count, mean, largest);
  expect(suite, mean < 0.2 && largest < 0.7, "spacings from the density's own surface", largest);
  mcor_free_surface(&surface);
}

/* ---- shifts ---- */

/* A point by the place of its edge within the period, with all it carries. */
typedef struct shifted_point
{
  double at[3];
  float carried[8];
} shifted_point;

/* The one that is nearest, along the axis where it is farthest. */
static const shifted_point* find_shifted(
  const shifted_point* points, int64_t count, const double at[3], double* distance)
{
  const shifted_point* found = NULL;
  *distance = INFINITY;
  for (int64_t i = 0; i < count; ++i)
  {
    double farthest = 0.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      farthest = fmax(farthest, fabs(points[i].at[axis] - at[axis]));
    }
    if (farthest < *distance)
    {
      *distance = farthest;
      found = &points[i];
    }
  }
  return found;
}

/* Shifted back by so many cubes; those on an upper side are those on the lower one. */
static shifted_point* list_shifted(const mcor_surface* s, const int shift[3], double cube)
{
  shifted_point* points = calloc((size_t)s->point_count + 1, sizeof(*points));
  for (int64_t i = 0; points && i < s->point_count; ++i)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const double x = s->points[3 * i + axis] - shift[axis] * cube;
      points[i].at[axis] =
        x - floor((x + 1e-6) / particle_period_lengths[axis]) * particle_period_lengths[axis];
      points[i].carried[axis] = s->normals[3 * i + axis];
      points[i].carried[3 + axis] = (float)s->gradients[3 * i + axis];
    }
    points[i].carried[6] = s->weight_sum[i];
    points[i].carried[7] = s->residual[i];
  }
  return points;
}

static int extract_shifted(oracle_suite* suite, const oracle_particles* particles,
  const mcor_options* options, const int shift[3], mcor_surface* surface)
{
  oracle_particles moved = *particles;
  moved.position = malloc(3 * (size_t)particles->count * sizeof(double));
  for (int64_t i = 0; moved.position && i < 3 * particles->count; ++i)
  {
    moved.position[i] = particles->position[i] + shift[i % 3] * options->cube_size;
  }
  const mcor_input input = particle_period_input(&moved);
  const int good =
    moved.position && mcor_extract(suite->context, &input, options, surface) == MCOR_OK;
  free(moved.position);
  return good;
}

/* The surface of all particles shifted by lattice steps is the same one, shifted: to the last bit
 * where search cells, which order the sums, come to lie on search cells; else up to rounding. */
static void check_shift(oracle_suite* suite, const oracle_particles* particles,
  const mcor_options* options, const int shift[3], int same_bits)
{
  static const int none[3] = { 0, 0, 0 };
  const double limit = same_bits ? 0.0 : options->precision == MCOR_FLOAT64 ? 1e-12 : 1e-4;
  mcor_surface own, other;
  double farthest = 0.0, most = 0.0;
  ++suite->cases;
  const int good = extract_shifted(suite, particles, options, none, &own) &&
    extract_shifted(suite, particles, options, shift, &other) && own.point_count > 1000 &&
    own.triangle_count == other.triangle_count;
  expect(suite, good, "not as many triangles", (double)other.triangle_count);
  shifted_point *p = list_shifted(&own, none, options->cube_size),
                *q = list_shifted(&other, shift, options->cube_size);
  /* Points on a face are there twice, once or twice after a shift: each has its like. */
  for (int64_t i = 0; good && p && q && i < own.point_count; ++i)
  {
    double distance;
    const shifted_point* found = find_shifted(q, other.point_count, p[i].at, &distance);
    farthest = fmax(farthest, distance);
    for (int c = 0; found && c < 8; ++c)
    {
      most = fmax(most, fabs((double)found->carried[c] - (double)p[i].carried[c]));
    }
  }
  printf("shift %d %d %d: %lld points, farthest %.3g, carried %.3g\n", shift[0], shift[1], shift[2],
    (long long)own.point_count, farthest, most);
  /* Undoing the shift rounds. */
  expect(suite, p && q && farthest <= fmax(limit, 1e-14), "points elsewhere", farthest);
  expect(suite, most <= limit, "points carry something else", most);
  free(p);
  free(q);
  mcor_free_surface(&own);
  mcor_free_surface(&other);
}

static void check_shifts(oracle_suite* suite, oracle_particles* particles)
{
  static const int cells[2][3] = { { 6, 5, -10 }, { -18, 15, 5 } };
  double iso = 1.2;
  uint64_t seed = 7;
  mcor_options options = oracle_case_options(&iso);
  options.cube_size = 0.5;
  particle_period_set(&options, "");
  for (int n = 0; n < 6; ++n)
  {
    int shift[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      shift[axis] = (int)(random_bits(&seed) % 101) - 50;
    }
    options.precision = n % 2 ? MCOR_FLOAT64 : MCOR_FLOAT32;
    check_shift(suite, particles, &options, shift, 0);
  }
  static const int periods[3] = { 24, -20, 40 };
  check_shift(suite, particles, &options, periods, 1);
  for (int64_t i = 0; i < particles->count; ++i)
  {
    particles->smoothing_length[i] = 1.2; /* search cells of 6 and 5 cubes */
  }
  for (int n = 0; n < 2; ++n)
  {
    options.precision = n % 2 ? MCOR_FLOAT64 : MCOR_FLOAT32;
    check_shift(suite, particles, &options, cells[n], 1);
  }
}

int main(int argc, char** argv)
{
  oracle_suite suite;
  if (!oracle_begin_suite(&suite, argc, argv))
  {
    return 1;
  }
  oracle_particles particles = particle_period_make(3);
  for (size_t n = 0; n < sizeof(cases) / sizeof(cases[0]); ++n)
  {
    for (int unequal = 0; unequal < (strlen(cases[n].open) < 2 ? 2 : 1); ++unequal)
    {
      run_case(&suite, &cases[n], unequal);
    }
  }
  if (!suite.filter)
  {
    check_density(&suite, &particles);
    check_shifts(&suite, &particles);
  }
  oracle_free_particles(&particles);
  return oracle_end_suite(&suite);
}
