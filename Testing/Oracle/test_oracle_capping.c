/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Caps at periodic sides: the surface without them is untouched, with them it is closed, and what it
 * encloses is where the oracle's field is above the iso value. */

#include "oracle_case.h"
#include "particle_period.h"
#include "particle_sets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct cap_case
{
  const char* name;
  mcor_sph_kernel kernel;
  mcor_field field;
  double iso;
  const char* open; /* axes that have no period */
  double threshold; /* of vertices */
  mcor_topology topology;
  int precise;
  double eigenvalue; /* trimmed where it is lower */
} cap_case;

static const cap_case cases[] = {
  { "cubic", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1.2, "", 0.5, MCOR_TOPOLOGY_TABLE, 0, 0.0 },
  { "cubic", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 0.7, "", 0.5, MCOR_TOPOLOGY_FIELD, 0, 0.0 },
  { "cubic", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1.0, "", 0.5, MCOR_TOPOLOGY_TABLE, 1, 0.0 },
  { "quintic", MCOR_QUINTIC_SPLINE, MCOR_SHEPARD, 0.9, "", 0.5, MCOR_TOPOLOGY_TABLE, 0, 0.0 },
  { "sum", MCOR_CUBIC_SPLINE, MCOR_SUM, 0.8, "", 0.5, MCOR_TOPOLOGY_FIELD, 0, 0.0 },
  { "all-above", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 0.01, "", 0.5, MCOR_TOPOLOGY_TABLE, 0, 0.0 },
  { "none-above", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 99.0, "", 0.5, MCOR_TOPOLOGY_TABLE, 0, 0.0 },
  { "free", MCOR_CUBIC_SPLINE, MCOR_WEIGHT_SUM, 0.5, "z", 0.5, MCOR_TOPOLOGY_TABLE, 0, 0.0 },
  { "free-open2", MCOR_WENDLAND_C2, MCOR_WEIGHT_SUM, 0.4, "yz", 0.5, MCOR_TOPOLOGY_TABLE, 1, 0.0 },
  { "trimmed", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1.0, "z", 0.5, MCOR_TOPOLOGY_TABLE, 0, 0.0 },
  { "trimmed", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 0.8, "xy", 0.7, MCOR_TOPOLOGY_FIELD, 0, 0.0 },
  { "eigenvalue", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 0.8, "z", 0.3, MCOR_TOPOLOGY_TABLE, 0, 0.3 },
  { "untrimmed", MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 1.0, "z", 0.0, MCOR_TOPOLOGY_TABLE, 0, 0.0 },
};

static void expect(
  oracle_suite* suite, int condition, const char* name, const char* what, double figure)
{
  if (!condition)
  {
    printf("  FAILED: %s: %s: %.6g\n", name, what, figure);
    ++suite->failures;
  }
}

/* The oracle's share of the period that is above the iso value, and a bound on its error. */
static double measure_inside(
  const oracle_reference* reference, const mcor_options* options, double* error)
{
  enum
  {
    SAMPLES = 8000
  };
  uint64_t seed = 11;
  int inside = 0;
  for (int i = 0; i < SAMPLES; ++i)
  {
    double x[3];
    oracle_sample sample;
    for (int axis = 0; axis < 3; ++axis)
    {
      x[axis] = random_unit(&seed) * options->periodic[2 * axis + 1];
    }
    oracle_evaluate(&reference->field, NULL, x, &sample);
    inside += sample.value >= reference->limits.iso;
  }
  *error = 0.005 + 4.0 * sqrt(0.25 / SAMPLES);
  return (double)inside / SAMPLES;
}

/* The surface that the options give without caps comes first, to the last bit. */
static void check_surface(
  oracle_suite* suite, const char* name, const mcor_surface* own, const mcor_surface* capped)
{
  const size_t points = (size_t)own->point_count, triangles = (size_t)own->triangle_count;
  expect(suite,
    capped->point_count >= own->point_count && capped->triangle_count >= own->triangle_count &&
      memcmp(own->points, capped->points, points * 3 * sizeof(double)) == 0 &&
      memcmp(own->normals, capped->normals, points * 3 * sizeof(float)) == 0 &&
      memcmp(own->triangles, capped->triangles, triangles * 3 * sizeof(int32_t)) == 0,
    name, "the surface itself is another one", (double)capped->point_count);
  expect(suite,
    capped->statistics.cap_triangles == capped->triangle_count - own->triangle_count &&
      capped->statistics.residual_max == own->statistics.residual_max,
    name, "statistics", (double)capped->statistics.cap_triangles);
}

/* Points of caps are on sides, with the oracle's values; their normals and triangles face out. */
static void check_caps(oracle_suite* suite, const char* name, const oracle_reference* reference,
  const mcor_options* options, const mcor_surface* own, const mcor_surface* s)
{
  double weight_error = 0.0, value_error = 0.0;
  int64_t off = 0, inward = 0, flags = 0;
  for (int64_t i = own->point_count; i < s->point_count; ++i)
  {
    const double* x = &s->points[3 * i];
    double outward = 0.0;
    int on_side = 0;
    oracle_sample sample;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double length = options->periodic[2 * axis + 1], last = fabs(x[axis] - length);
      if (length > 0.0 && (x[axis] == 0.0 || last < 1e-12))
      {
        on_side = 1;
        outward += x[axis] == 0.0 ? -s->normals[3 * i + axis] : s->normals[3 * i + axis];
      }
    }
    off += !on_side;
    inward += !(outward > 0.99);
    flags += s->boundary_flag[i] != 8 && s->boundary_flag[i] != 2;
    oracle_evaluate(&reference->field, NULL, x, &sample);
    weight_error = fmax(weight_error, fabs((double)s->weight_sum[i] - sample.weight));
    if (options->field == MCOR_SHEPARD)
    {
      value_error = fmax(value_error, fabs(s->attributes[0][i] - sample.value));
    }
  }
  expect(suite, off == 0, name, "points off the sides", (double)off);
  expect(suite, inward == 0, name, "normals that do not point out", (double)inward);
  expect(suite, flags == 0, name, "flags", (double)flags);
  expect(suite, weight_error < 1e-5, name, "weights", weight_error);
  expect(suite, value_error < 1e-5, name, "attributes", value_error);
}

/* Along each periodic axis as many triangles face up as down: the caps are alike. */
static void check_alike(
  oracle_suite* suite, const char* name, const mcor_surface* own, const mcor_surface* s)
{
  double area[3][2] = { { 0.0 } };
  int64_t count[3][2] = { { 0 } };
  for (int64_t t = own->triangle_count; t < s->triangle_count; ++t)
  {
    const int32_t* c = &s->triangles[3 * t];
    const double *p = &s->points[3 * (int64_t)c[0]], *q = &s->points[3 * (int64_t)c[1]],
                 *r = &s->points[3 * (int64_t)c[2]];
    double n[3];
    int most = 0;
    for (int a = 0; a < 3; ++a)
    {
      const int b = (a + 1) % 3, d = (a + 2) % 3;
      n[a] = (q[b] - p[b]) * (r[d] - p[d]) - (q[d] - p[d]) * (r[b] - p[b]);
      most = fabs(n[a]) > fabs(n[most]) ? a : most;
    }
    area[most][n[most] > 0.0] += 0.5 * fabs(n[most]);
    ++count[most][n[most] > 0.0];
  }
  for (int a = 0; a < 3; ++a)
  {
    expect(suite, count[a][0] == count[a][1], name, "triangles that face one way",
      (double)(count[a][0] - count[a][1]));
    expect(suite, fabs(area[a][0] - area[a][1]) <= 1e-9 * area[a][0], name, "areas", area[a][0]);
  }
}

/* Open edges must be a border of trimming. */
static int64_t count_open(const mcor_surface* s, const mesh_report* mesh)
{
  int64_t open = 0;
  for (int64_t i = 0; i < mesh->side_count; ++i)
  {
    const mesh_edge* side = &mesh->side[i];
    open += mesh_count_sides(mesh, side->a, side->b) == 1 &&
      !(s->boundary_flag[side->a] % 8 && s->boundary_flag[side->b] % 8);
  }
  return open;
}

static void check_mesh(oracle_suite* suite, const char* name, const oracle_reference* reference,
  const mcor_options* options, const mcor_surface* s)
{
  mesh_report mesh;
  if (!mesh_check(s->points, s->point_count, s->triangles, s->triangle_count, &mesh))
  {
    expect(suite, 0, name, "out of memory", 0.0);
    return;
  }
  for (int fault = 0; fault < MESH_FAULT_COUNT; ++fault)
  {
    expect(suite, mesh.faults[fault] == 0, name, mesh.first[fault], (double)mesh.faults[fault]);
  }
  expect(suite, count_open(s, &mesh) == 0, name, "open edges", (double)count_open(s, &mesh));
  printf("%-28s %lld triangles, %lld of caps, %lld open, Euler %lld, volume %.6g\n", name,
    (long long)s->triangle_count, (long long)s->statistics.cap_triangles,
    (long long)mesh.boundary_edges, (long long)mesh.euler, mesh.volume);
  const int whole =
    options->periodic[1] > 0.0 && options->periodic[3] > 0.0 && options->periodic[5] > 0.0;
  expect(suite, !(whole || options->field == MCOR_WEIGHT_SUM) || mesh.boundary_edges == 0, name,
    "not closed", (double)mesh.boundary_edges);
  if (whole)
  {
    const double box = options->periodic[1] * options->periodic[3] * options->periodic[5];
    double error;
    const double share = measure_inside(reference, options, &error);
    expect(suite, fabs(mesh.volume / box - share) <= error, name, "volume", mesh.volume / box);
    expect(suite, share < 1.0 || fabs(mesh.volume / box - 1.0) < 1e-12, name, "volume of the box",
      mesh.volume / box);
  }
  mesh_free_report(&mesh);
}

/* unequal: the edges. */
static void run_case(oracle_suite* suite, const cap_case* one, int unequal)
{
  oracle_particles particles = particle_period_make(3);
  double iso = one->iso;
  char name[96], message[256];
  mcor_input input = particle_period_input(&particles);
  mcor_array density = input.scalar;
  mcor_options options = oracle_case_options(&iso);
  oracle_reference reference;
  mcor_surface own, capped;
  snprintf(name, sizeof(name), "capping/%s/%g%s", one->name, iso, unequal ? "/unequal" : "");
  if (!oracle_wants_case(suite, name))
  {
    oracle_free_particles(&particles);
    return;
  }
  ++suite->cases;
  input.attributes = &density;
  input.attribute_count = 1;
  options.sph_kernel = one->kernel;
  options.field = one->field;
  options.cube_size_factor = 0.7;
  options.vertex_threshold = one->threshold;
  options.topology = one->topology;
  options.precision = one->precise ? MCOR_FLOAT64 : MCOR_FLOAT32;
  options.boundary_detection =
    one->eigenvalue > 0.0 ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
  particle_period_set(&options, one->open);
  if (unequal)
  {
    particle_period_stretch(&particles, &options);
  }
  mcor_status status = mcor_extract(suite->context, &input, &options, &own);
  options.capping = 1;
  status = status == MCOR_OK ? mcor_extract(suite->context, &input, &options, &capped) : status;
  expect(suite, status == MCOR_OK, name, mcor_last_error(suite->context), 0.0);
  if (status == MCOR_OK && oracle_create_reference(&reference, &input, &options, 6000000, message))
  {
    check_surface(suite, name, &own, &capped);
    check_caps(suite, name, &reference, &options, &own, &capped);
    check_mesh(suite, name, &reference, &options, &capped);
    if (options.field == MCOR_WEIGHT_SUM || one->open[0] == '\0')
    {
      check_alike(suite, name, &own, &capped);
    }
    oracle_free_reference(&reference);
  }
  mcor_free_surface(&own);
  mcor_free_surface(&capped);
  oracle_free_particles(&particles);
}

int main(int argc, char** argv)
{
  oracle_suite suite;
  if (!oracle_begin_suite(&suite, argc, argv))
  {
    return 1;
  }
  for (size_t n = 0; n < sizeof(cases) / sizeof(cases[0]); ++n)
  {
    for (int unequal = 0; unequal < (strlen(cases[n].open) < 2 ? 2 : 1); ++unequal)
    {
      run_case(&suite, &cases[n], unequal);
    }
  }
  return oracle_end_suite(&suite);
}
