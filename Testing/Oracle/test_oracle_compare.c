/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests that oracle_compare finds planted faults: each kind of damage to a right surface must show in the figure meant
 * for it. oracle_analytic checks that right surfaces pass. */

#include "oracle_case.h"
#include "oracle_check.h"
#include "particle_sets.h"

#include <math.h>
#include <string.h>

typedef struct fixture
{
  particle_set set;
  mcor_options options;
  double iso;
  oracle_reference reference;
  mcor_surface surface; /* arrays with room for a few more points and triangles */
} fixture;

/* Returns a copy of the array with room for 8 more elements. */
static void* copy_array(const void* data, int64_t count, size_t width)
{
  return memcpy(oracle_allocate(count + 8, width), data, (size_t)count * width);
}

/* Makes the surface of the sphere as the library extracts it, in double precision, before trimming. */
static int create_fixture(fixture* f)
{
  const particle_set_entry* entry = particle_set_find("sphere");
  mcor_context* context = NULL;
  mcor_surface made;
  memset(f, 0, sizeof(*f));
  f->iso = entry->iso;
  f->options = oracle_case_options(&f->iso);
  f->options.field = entry->field;
  f->options.precision = MCOR_FLOAT64;
  f->options.tolerance = 1e-12;
  f->options.vertex_threshold = 0.0;
  if (mcor_create_context(NULL, &context) != MCOR_OK)
  {
    return 0;
  }
  f->set = particle_set_of(entry);
  const mcor_input input = core_input(&f->set);
  const int good = mcor_extract(context, &input, &f->options, &made) == MCOR_OK;
  oracle_create_reference(&f->reference, &input, &f->options);
  f->surface.point_count = made.point_count;
  f->surface.triangle_count = made.triangle_count;
  f->surface.points = copy_array(made.points, made.point_count, 3 * sizeof(double));
  f->surface.triangles = copy_array(made.triangles, made.triangle_count, 3 * sizeof(int32_t));
  f->surface.normals = copy_array(made.normals, made.point_count, 3 * sizeof(float));
  f->surface.gradients = copy_array(made.gradients, made.point_count, 3 * sizeof(double));
  f->surface.weight_sum = copy_array(made.weight_sum, made.point_count, sizeof(float));
  f->surface.boundary_flag = copy_array(made.boundary_flag, made.point_count, 1);
  f->options.vertex_threshold = 0.5;
  mcor_free_surface(&made);
  mcor_free_context(context);
  return good;
}

static void free_fixture(fixture* f)
{
  mcor_free_surface(&f->surface);
  oracle_free_reference(&f->reference);
  particle_set_free(&f->set);
}

static oracle_comparison compare(const fixture* f, int trimmed)
{
  oracle_comparison comparison;
  mesh_report report;
  mesh_check(f->surface.points, f->surface.point_count, f->surface.triangles,
    f->surface.triangle_count, &report);
  oracle_compare(&f->reference, &f->options, &f->surface, &report, trimmed, &comparison);
  mesh_free_report(&report);
  return comparison;
}

static void remove_point(fixture* f, int64_t point)
{
  /* The last point gets the removed point's number, and triangles that used the removed point are dropped. */
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
  mcor_surface* s = &f->surface;
  memcpy(&s->points[3 * point], &s->points[3 * last], 3 * sizeof(double));
  memcpy(&s->normals[3 * point], &s->normals[3 * last], 3 * sizeof(float));
  memcpy(&s->gradients[3 * point], &s->gradients[3 * last], 3 * sizeof(double));
  s->weight_sum[point] = s->weight_sum[last];
}

/* Returns the axis of the edge that a vertex lies on. */
static int edge_axis(const fixture* f, int64_t v)
{
  int axis = 0;
  for (int a = 1; a < 3; ++a)
  {
    const double *x = &f->surface.points[3 * v], cube = f->reference.lattice.cube;
    axis = fabs(x[a] / cube - round(x[a] / cube)) > fabs(x[axis] / cube - round(x[axis] / cube))
      ? a
      : axis;
  }
  return axis;
}

/* Damages a right surface in one way, and compares it as a trimmed one. Returns the figure that shows the damage. */
static double damage_trimmed(fixture* f, int kind)
{
  double* point = &f->surface.points[30];
  const int axis = edge_axis(f, 10);
  oracle_comparison c;
  switch (kind)
  {
    case 0: /* a vertex is cut away without a reason */
      f->options.vertex_threshold = -1.0;
      remove_point(f, 10);
      return (double)compare(f, 1).missing;
    case 1: /* a vertex stays that should have been trimmed */
      f->options.vertex_threshold = 2.0;
      c = compare(f, 1);
      return (double)(c.below_threshold == c.edges);
    default: /* a vertex is flagged as a trim vertex and lies on no edge, but its weight is not the threshold */
      f->surface.boundary_flag[10] = 1;
      point[(axis + 1) % 3] += 0.1 * f->reference.lattice.cube;
      return compare(f, 1).trim_weight_error > 0.1;
  }
}

/* Damages a right surface in one way. Returns the figure that must show the damage; 0 means that it
 * does not. */
static double damage(fixture* f, int kind)
{
  double* point = &f->surface.points[30];
  const double cube = f->reference.lattice.cube;
  const int axis = edge_axis(f, 10);
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
    case 2: /* a vertex moves along its edge by a thousandth of a cube */
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
      return c.inverted_components == c.components;
    case 8:
      f->surface.weight_sum[7] += 1e-3F;
      return compare(f, 0).weight_error > 5e-4;
    default: /* nothing is found at all */
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
    ORACLE_CHECK(create_fixture(&f), f.set.count);
    const double shown = kind < 10 ? damage(&f, kind) : damage_trimmed(&f, kind - 10);
    ORACLE_CHECK(shown > 0.0, kind);
    free_fixture(&f);
  }
}

/* A vertex on a lattice node fits several edges; it must be matched with the edge that lacks a vertex. */
static void test_vertex_on_node(void)
{
  fixture f;
  ORACLE_CHECK(create_fixture(&f), f.set.count);
  const double cube = f.reference.lattice.cube;
  for (int64_t v = 0; v < f.surface.point_count; v += 50)
  {
    double* x = &f.surface.points[3 * v + edge_axis(&f, v)];
    *x = round(*x / cube) * cube;
  }
  const oracle_comparison c = compare(&f, 0);
  ORACLE_CHECK(c.matched == c.edges && c.extra == 0 && c.doubled == 0, c.matched, c.edges, c.first);
  ORACLE_CHECK(c.residual > 1e-3, c.residual);
  free_fixture(&f);
}

int main(void)
{
  test_damage();
  test_vertex_on_node();
  printf("%d failures\n", oracle_failures);
  return oracle_failures > 0;
}
