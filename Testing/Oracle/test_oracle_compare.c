/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The comparison finds planted faults: a right surface (the oracle's own polygons) passes, and each
 * kind of damage shows up in the figure that is meant for it. No library under test here. */

#include "oracle_check.h"
#include "oracle_compare.h"
#include "particle_sets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct fixture
{
  particle_set set;
  mcor_options options;
  double iso;
  oracle_reference reference;
  mcor_surface surface; /* arrays with room for a few more points and triangles */
} fixture;

static void set_normal(fixture* f, int64_t v)
{
  oracle_sample sample;
  oracle_evaluate(&f->reference.field, NULL, &f->surface.points[3 * v], &sample);
  const double length = sqrt(sample.gradient[0] * sample.gradient[0] +
    sample.gradient[1] * sample.gradient[1] + sample.gradient[2] * sample.gradient[2]);
  for (int axis = 0; axis < 3; ++axis)
  {
    f->surface.normals[3 * v + axis] = (float)(-sample.gradient[axis] / length);
    f->surface.gradients[3 * v + axis] = sample.gradient[axis];
  }
  f->surface.weight_sum[v] = (float)sample.trim_weight;
}

static int create_fixture(fixture* f, const char* name)
{
  const particle_set_entry* entry = particle_set_find(name);
  memset(f, 0, sizeof(*f));
  f->iso = entry->iso;
  f->options.field = entry->field;
  f->options.h_scale = 1.0;
  f->options.cube_size_factor = 0.5;
  f->options.iso_values = &f->iso;
  f->options.iso_count = 1;
  f->options.node_threshold = 0.1;
  f->options.vertex_threshold = 0.5;
  char message[256];
  oracle_mesh mesh;
  if (!entry->make(&f->set))
  {
    return 0;
  }
  const mcor_input input = particle_set_input(&f->set);
  if (!oracle_create_reference(&f->reference, &input, &f->options, 10000000, message) ||
    !oracle_create_mesh(
      &mesh, &f->reference.surface, &f->reference.lattice, &f->reference.field, f->iso))
  {
    return 0;
  }
  const size_t points = (size_t)mesh.point_count + 8;
  f->surface.points = realloc(mesh.points, 3 * points * sizeof(double));
  f->surface.triangles =
    realloc(mesh.triangles, 3 * ((size_t)mesh.triangle_count + 8) * sizeof(int32_t));
  f->surface.normals = calloc(3 * points, sizeof(float));
  f->surface.gradients = calloc(3 * points, sizeof(double));
  f->surface.weight_sum = calloc(points, sizeof(float));
  f->surface.boundary_flag = calloc(points, 1);
  f->surface.point_count = mesh.point_count;
  f->surface.triangle_count = mesh.triangle_count;
  for (int64_t v = 0; v < mesh.point_count; ++v)
  {
    set_normal(f, v);
  }
  return 1;
}

static void free_fixture(fixture* f)
{
  free(f->surface.points);
  free(f->surface.triangles);
  free(f->surface.normals);
  free(f->surface.gradients);
  free(f->surface.weight_sum);
  free(f->surface.boundary_flag);
  oracle_free_reference(&f->reference);
  particle_set_free(&f->set);
}

static oracle_comparison compare(const fixture* f, int trimmed)
{
  oracle_comparison comparison;
  mesh_report report;
  memset(&comparison, 0, sizeof(comparison));
  ORACLE_CHECK(mesh_check(f->surface.points, f->surface.point_count, f->surface.triangles,
                 f->surface.triangle_count, &report),
    "no memory");
  ORACLE_CHECK(
    oracle_compare(&f->reference, &f->options, &f->surface, &report, trimmed, &comparison),
    "no memory");
  mesh_free_report(&report);
  return comparison;
}

static void check_right_surface(const char* name)
{
  fixture f;
  ORACLE_CHECK(create_fixture(&f, name), "no memory");
  const oracle_comparison c = compare(&f, 0);
  ORACLE_CHECK(c.edges > 100 && c.matched == c.edges, "%s: %lld of %lld matched", name,
    (long long)c.matched, (long long)c.edges);
  ORACLE_CHECK(c.missing == 0 && c.extra == 0 && c.excused == 0 && c.rounding == 0 &&
      c.off_lattice == 0 && c.doubled == 0,
    "%s: %s", name, c.first);
  ORACLE_CHECK(c.segments_missing == 0 && c.holes == 0 && c.inverted_components == 0 &&
      c.inverted_triangles == 0,
    "%s: %s", name, c.first);
  ORACLE_CHECK(c.residual < 1e-12 && c.distance < 1e-10 && c.normal_degrees < 1e-4, "%s: %g %g %g",
    name, c.residual, c.distance, c.normal_degrees);
  ORACLE_CHECK(c.weight_error < 1e-6 && c.gradient_error < 1e-12 && c.rim_gradient_error < 1e-12,
    "%s: %g %g %g", name, c.weight_error, c.gradient_error, c.rim_gradient_error);
  free_fixture(&f);
}

static void remove_point(fixture* f, int64_t point)
{
  /* The last point takes its number; triangles that used the point go. */
  const int64_t last = --f->surface.point_count;
  int64_t kept = 0;
  for (int64_t t = 0; t < f->surface.triangle_count; ++t)
  {
    int32_t c[3];
    int uses = 0;
    for (int n = 0; n < 3; ++n)
    {
      c[n] = f->surface.triangles[3 * t + n];
      uses += c[n] == point;
      c[n] = c[n] == last ? (int32_t)point : c[n];
    }
    if (!uses)
    {
      memcpy(&f->surface.triangles[3 * kept++], c, sizeof(c));
    }
  }
  f->surface.triangle_count = kept;
  memcpy(&f->surface.points[3 * point], &f->surface.points[3 * last], 3 * sizeof(double));
  set_normal(f, point);
}

static int64_t edge_axis(const fixture* f, int64_t v)
{
  return f->reference.surface.edge[v] % 3;
}

/* Damages a surface that is to be trimmed; returns as damage() does. */
static double damage_trimmed(fixture* f, int kind)
{
  double* point = &f->surface.points[30];
  const int64_t axis = edge_axis(f, 10);
  oracle_comparison c;
  switch (kind)
  {
    case 0: /* trimmed surface in which a vertex is cut away for no reason */
      f->options.vertex_threshold = -1.0;
      remove_point(f, 10);
      return (double)compare(f, 1).missing;
    case 1: /* a vertex that should have been trimmed */
      f->options.vertex_threshold = 2.0;
      c = compare(f, 1);
      return (double)(c.below_threshold == c.edges);
    default: /* flagged as trim vertex on no edge, but its weight is not the threshold */
      f->surface.boundary_flag[10] = 1;
      point[(axis + 1) % 3] += 0.1 * f->reference.lattice.cube;
      return compare(f, 1).trim_weight_error > 0.1;
  }
}

/* Damages a right surface in one way and returns the figure that must show it, 0 if it does not. */
static double damage(fixture* f, int kind)
{
  double* point = &f->surface.points[30];
  const double cube = f->reference.lattice.cube;
  const int64_t axis = edge_axis(f, 10);
  oracle_comparison c;
  switch (kind)
  {
    case 0:
      remove_point(f, 10);
      c = compare(f, 0);
      return c.missing == 1 && c.holes > 0 ? (double)c.components_partial : 0.0;
    case 1:
      point[(axis + 1) % 3] += 1e-6 * cube;
      return (double)compare(f, 0).off_lattice;
    case 2: /* along the edge, by a thousandth of a cube */
      point[axis] += (point[axis] / cube - floor(point[axis] / cube) < 0.5 ? 1e-3 : -1e-3) * cube;
      c = compare(f, 0);
      return c.residual > 1e-6 && fabs(c.distance - 1e-3) < 9e-4 ? 1.0 : 0.0;
    case 3:
      for (int a = 0; a < 3; ++a)
      {
        f->surface.normals[30 + a] *= -1.0F;
      }
      return compare(f, 0).normal_degrees > 179.0;
    case 4:
      --f->surface.triangle_count;
      c = compare(f, 0);
      return c.holes > 0 ? (double)c.segments_missing : 0.0;
    case 5: /* a vertex far outside, where nothing is crossed */
      memcpy(
        &f->surface.points[3 * f->surface.point_count], &f->surface.points[0], 3 * sizeof(double));
      f->surface.points[3 * f->surface.point_count + edge_axis(f, 0)] += 6.0 * cube;
      ++f->surface.point_count;
      return (double)compare(f, 0).extra;
    case 6:
      memcpy(&f->surface.points[3 * f->surface.point_count], point, 3 * sizeof(double));
      ++f->surface.point_count;
      return (double)compare(f, 0).doubled;
    case 7:
      for (int64_t t = 0; t < f->surface.triangle_count; ++t)
      {
        const int32_t first = f->surface.triangles[3 * t];
        f->surface.triangles[3 * t] = f->surface.triangles[3 * t + 1];
        f->surface.triangles[3 * t + 1] = first;
      }
      c = compare(f, 0);
      return c.inverted_components == c.components ? (double)c.inverted_triangles : 0.0;
    case 8:
      f->surface.weight_sum[7] += 1e-3F;
      return compare(f, 0).weight_error > 5e-4;
    default: /* nothing found at all */
      f->surface.point_count = f->surface.triangle_count = 0;
      c = compare(f, 0);
      return c.missing == c.edges && c.components_missing == c.components;
  }
}

static void test_damage(void)
{
  for (int kind = 0; kind < 13; ++kind)
  {
    fixture f;
    ORACLE_CHECK(create_fixture(&f, "sphere"), "no memory");
    const double shown = kind < 10 ? damage(&f, kind) : damage_trimmed(&f, kind - 10);
    ORACLE_CHECK(shown > 0.0, "damage of kind %d was not seen", kind);
    free_fixture(&f);
  }
}

/* A vertex on a lattice node fits several edges; it must be given the one that is open. */
static void test_vertex_on_node(void)
{
  fixture f;
  ORACLE_CHECK(create_fixture(&f, "sphere"), "no memory");
  const double cube = f.reference.lattice.cube;
  for (int64_t v = 0; v < f.surface.point_count; v += 50)
  {
    double* x = &f.surface.points[3 * v + edge_axis(&f, v)];
    *x = round(*x / cube) * cube;
  }
  const oracle_comparison c = compare(&f, 0);
  ORACLE_CHECK(c.matched == c.edges && c.extra == 0 && c.doubled == 0, "%lld of %lld, %s",
    (long long)c.matched, (long long)c.edges, c.first);
  ORACLE_CHECK(c.residual > 1e-3, "the residual must show that the vertices were moved");
  free_fixture(&f);
}

int main(void)
{
  check_right_surface("sphere");
  check_right_surface("torus");
  check_right_surface("drops");
  check_right_surface("gyroid");
  test_damage();
  test_vertex_on_node();
  printf("%d failures\n", oracle_failures);
  return oracle_failures > 0;
}
