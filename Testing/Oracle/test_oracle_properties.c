/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* What must hold whatever the values are: the order of particles does not matter, reuse changes
 * nothing, several iso values are the single ones together, shifts by lattice vectors and scaling
 * carry over, preview has the same triangles, attributes are Shepard means. */

#include "mesh_check.h"
#include "oracle_case.h"
#include "oracle_check.h"
#include "particle_sets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The library, one particle set, options; extracted anew where a test changes something. */
typedef struct bench
{
  mcor_context* context;
  particle_set set;
  mcor_input input;
  mcor_options options;
  double iso;
} bench;

static int create_bench(bench* b, const char* name, const char* device)
{
  const particle_set_entry* entry = particle_set_find(name);
  memset(b, 0, sizeof(*b));
  if (mcor_create_context(device, &b->context) != MCOR_OK || !entry->make(&b->set))
  {
    ORACLE_CHECK(0, "%s", mcor_last_error(b->context));
    return 0;
  }
  b->iso = entry->iso;
  b->input = particle_set_input(&b->set);
  b->options = oracle_case_options(&b->iso);
  b->options.field = entry->field;
  return 1;
}

static void free_bench(bench* b)
{
  mcor_free_context(b->context);
  particle_set_free(&b->set);
}

static mcor_surface extract(bench* b)
{
  mcor_surface surface;
  memset(&surface, 0, sizeof(surface));
  const mcor_status status = mcor_extract(b->context, &b->input, &b->options, &surface);
  ORACLE_CHECK(status == MCOR_OK, "%s", mcor_last_error(b->context));
  return surface;
}

static int same_array(const void* a, const void* b, size_t bytes)
{
  return a && b ? memcmp(a, b, bytes) == 0 : a == b;
}

/* Bit for bit, all arrays of fixed type. */
static int same_surface(const mcor_surface* a, const mcor_surface* b)
{
  const size_t n = (size_t)a->point_count;
  return a->point_count == b->point_count && a->triangle_count == b->triangle_count &&
    same_array(a->points, b->points, 3 * n * sizeof(double)) &&
    same_array(a->triangles, b->triangles, 3 * (size_t)a->triangle_count * sizeof(int32_t)) &&
    same_array(a->normals, b->normals, 3 * n * sizeof(float)) &&
    same_array(a->gradients, b->gradients, 3 * n * sizeof(double)) &&
    same_array(a->weight_sum, b->weight_sum, n * sizeof(float)) &&
    same_array(a->correction_length, b->correction_length, n * sizeof(float)) &&
    same_array(a->residual, b->residual, n * sizeof(float)) &&
    same_array(a->boundary_flag, b->boundary_flag, n);
}

static void test_permutation(const char* name, const char* device)
{
  bench b;
  if (create_bench(&b, name, device))
  {
    mcor_surface first = extract(&b);
    ORACLE_CHECK(first.triangle_count > 50, "%s: too small a surface for a test", name);
    for (uint64_t seed = 1; seed <= 3; ++seed)
    {
      particle_set_shuffle(&b.set, seed);
      mcor_surface shuffled = extract(&b);
      ORACLE_CHECK(same_surface(&first, &shuffled), "%s changes with the order of particles", name);
      mcor_free_surface(&shuffled);
    }
    mcor_free_surface(&first);
  }
  free_bench(&b);
}

/* Reuse of particles, of the scalar, and neither, in turn; each against a context of its own. */
static void test_reuse(const char* device)
{
  bench b;
  bench fresh;
  if (create_bench(&b, "gyroid", device))
  {
    for (int run = 0; run < 8; ++run)
    {
      if (run == 3) /* another scalar */
      {
        for (int64_t j = 0; j < b.set.count; ++j)
        {
          b.set.scalar[j] *= b.set.scalar[j];
        }
      }
      if (run == 5) /* other particles */
      {
        b.set.position[0] += 0.01;
        b.set.position[3 * 700] += 0.04;
      }
      b.iso = 0.1 + 0.05 * run;
      b.options.field = run == 4 || run == 7 ? MCOR_SUM : MCOR_SHEPARD;
      b.options.sph_kernel = run == 6 ? MCOR_WENDLAND_C2 : MCOR_CUBIC_SPLINE;
      b.options.cube_size_factor = run == 2 ? 0.7 : 0.5;
      b.input.particles_version = run < 5 ? 1 : 2;
      b.input.scalar_version = run < 3 ? 1 : run < 5 ? 2 : 3;
      fresh = b;
      fresh.options.iso_values = &fresh.iso;
      fresh.input.particles_version = fresh.input.scalar_version = 0;
      ORACLE_CHECK(mcor_create_context(device, &fresh.context) == MCOR_OK, "no device");
      mcor_surface reused = extract(&b);
      mcor_surface anew = extract(&fresh);
      ORACLE_CHECK(anew.triangle_count > 50, "too small a surface for a test");
      ORACLE_CHECK(same_surface(&reused, &anew), "reuse changes the result of run %d", run);
      mcor_free_surface(&reused);
      mcor_free_surface(&anew);
      mcor_free_context(fresh.context);
    }
  }
  free_bench(&b);
}

static void test_iso_values(const char* device)
{
  const double iso[3] = { -0.4, 0.1, 0.6 };
  bench b;
  if (create_bench(&b, "gyroid", device))
  {
    int64_t points = 0;
    int64_t triangles = 0;
    b.options.iso_values = iso;
    b.options.iso_count = 3;
    b.options.outputs |= MCOR_OUT_ISO_VALUE;
    mcor_surface all = extract(&b);
    for (int n = 0; n < 3; ++n)
    {
      b.iso = iso[n];
      b.options.iso_values = &b.iso;
      b.options.iso_count = 1;
      mcor_surface one = extract(&b);
      const int fits = points + one.point_count <= all.point_count &&
        triangles + one.triangle_count <= all.triangle_count;
      ORACLE_CHECK(fits && one.triangle_count > 50, "iso value %g is not whole", iso[n]);
      for (int64_t v = 0; fits && v < one.point_count; ++v)
      {
        ORACLE_CHECK(all.iso_value[points + v] == iso[n] &&
            memcmp(&all.points[3 * (points + v)], &one.points[3 * v], 3 * sizeof(double)) == 0,
          "vertex %lld of iso value %g", (long long)v, iso[n]);
      }
      for (int64_t c = 0; fits && c < 3 * one.triangle_count; ++c)
      {
        ORACLE_CHECK(all.triangles[3 * triangles + c] == one.triangles[c] + points,
          "triangle %lld of iso value %g", (long long)c / 3, iso[n]);
      }
      points += one.point_count;
      triangles += one.triangle_count;
      mcor_free_surface(&one);
    }
    ORACLE_CHECK(points == all.point_count && triangles == all.triangle_count, "more than the sum");
    mcor_free_surface(&all);
  }
  free_bench(&b);
}

static int compare_doubles(const void* a, const void* b)
{
  const double x = *(const double*)a;
  const double y = *(const double*)b;
  return (x > y) - (x < y);
}

/* Coordinates of one axis, in ascending order: the order of vertices may differ. */
static double* sorted_coordinates(const mcor_surface* surface, int axis)
{
  double* sorted = malloc(((size_t)surface->point_count + 1) * sizeof(double));
  for (int64_t v = 0; sorted && v < surface->point_count; ++v)
  {
    sorted[v] = surface->points[3 * v + axis];
  }
  if (sorted)
  {
    qsort(sorted, (size_t)surface->point_count, sizeof(double), compare_doubles);
  }
  return sorted;
}

static double surface_area(const mcor_surface* surface)
{
  mesh_report report;
  ORACLE_CHECK(mesh_check(surface->points, surface->point_count, surface->triangles,
                 surface->triangle_count, &report),
    "no memory");
  const double area = report.area;
  mesh_free_report(&report);
  return area;
}

/* scale and offset are such that all coordinates stay exact: only the lattice could notice. */
static void test_transform(const char* device, double scale, const double offset[3])
{
  bench b;
  if (create_bench(&b, "gyroid", device))
  {
    const double cube = 0.0625;
    for (int64_t c = 0; c < 3 * b.set.count; ++c)
    {
      b.set.position[c] = round(b.set.position[c] * 0x1p20) * 0x1p-20;
    }
    b.options.cube_size = cube;
    mcor_surface first = extract(&b);
    particle_set_transform(&b.set, scale, offset);
    b.options.cube_size = scale * cube;
    mcor_surface second = extract(&b);
    const int same = first.point_count == second.point_count &&
      first.triangle_count == second.triangle_count && first.triangle_count > 50;
    ORACLE_CHECK(same, "scale %g: %lld triangles become %lld", scale,
      (long long)first.triangle_count, (long long)second.triangle_count);
    ORACLE_CHECK(fabs(surface_area(&second) / (scale * scale * surface_area(&first)) - 1.0) < 1e-6,
      "scale %g: another area", scale);
    for (int axis = 0; same && axis < 3; ++axis)
    {
      double* x = sorted_coordinates(&first, axis);
      double* y = sorted_coordinates(&second, axis);
      double worst = 0.0;
      for (int64_t v = 0; x && y && v < first.point_count; ++v)
      {
        worst = fmax(worst, fabs(y[v] - scale * x[v] - offset[axis]) / (scale * cube));
      }
      ORACLE_CHECK(
        x && y && worst < 1e-4, "scale %g: coordinates differ by %g cubes", scale, worst);
      free(x);
      free(y);
    }
    mcor_free_surface(&first);
    mcor_free_surface(&second);
  }
  free_bench(&b);
}

/* Without trimming preview has the same triangles, its vertices where a line between the node
 * values puts them. */
static void test_preview(const char* device)
{
  bench b;
  char message[256];
  oracle_reference reference;
  if (create_bench(&b, "gyroid", device) &&
    oracle_create_reference(&reference, &b.input, &b.options, 10000000, message))
  {
    b.options.vertex_threshold = 0.0;
    mcor_surface exact = extract(&b);
    b.options.preview = 1;
    mcor_surface preview = extract(&b);
    ORACLE_CHECK(exact.triangle_count > 50 && exact.point_count == preview.point_count &&
        exact.triangle_count == preview.triangle_count &&
        same_array(
          exact.triangles, preview.triangles, 3 * (size_t)exact.triangle_count * sizeof(int32_t)),
      "preview has other triangles");
    const double cube = reference.lattice.cube;
    double farthest = 0.0;
    for (int64_t v = 0; v < preview.point_count && preview.point_count == exact.point_count; ++v)
    {
      int64_t low[3];
      int axis = 0;
      for (int a = 0; a < 3; ++a)
      {
        const double u = preview.points[3 * v + a] / cube;
        axis = fabs(u - round(u)) > 1e-7 ? a : axis;
        low[a] =
          (int64_t)(fabs(u - round(u)) > 1e-7 ? floor(u) : round(u)) - reference.lattice.origin[a];
      }
      const int64_t node = oracle_node_index(&reference.lattice, low[0], low[1], low[2]);
      int64_t nodes[2];
      oracle_edge_ends(&reference.lattice, 3 * node + axis, nodes);
      const double f0 = reference.lattice.value[nodes[0]] - b.iso;
      const double f1 = reference.lattice.value[nodes[1]] - b.iso;
      double p[3];
      oracle_node_position(&reference.lattice, nodes[0], p);
      p[axis] += cube * f0 / (f0 - f1);
      for (int a = 0; a < 3; ++a)
      {
        farthest = fmax(farthest, fabs(p[a] - preview.points[3 * v + a]) / cube);
      }
    }
    ORACLE_CHECK(farthest < 1e-4, "preview vertices are off by %g cubes", farthest);
    mcor_free_surface(&exact);
    mcor_free_surface(&preview);
    oracle_free_reference(&reference);
  }
  free_bench(&b);
}

static int64_t nearest_fluid(const particle_set* set, const double point[3], double* distance)
{
  int64_t nearest = -1;
  *distance = INFINITY;
  for (int64_t j = 0; j < set->count; ++j)
  {
    const double* x = &set->position[3 * j];
    const double d = sqrt((x[0] - point[0]) * (x[0] - point[0]) +
      (x[1] - point[1]) * (x[1] - point[1]) + (x[2] - point[2]) * (x[2] - point[2]));
    if (!set->solid[j] && d < *distance)
    {
      *distance = d;
      nearest = j;
    }
  }
  return nearest;
}

/* A vector and a scalar attribute against the oracle, and the nearest particle against a loop. */
static void test_attributes(const char* name, const char* device)
{
  bench b;
  char message[256];
  oracle_reference reference;
  if (create_bench(&b, name, device) &&
    oracle_create_reference(&reference, &b.input, &b.options, 10000000, message))
  {
    const mcor_array attributes[2] = { b.input.positions, b.input.scalar };
    double* component = malloc((size_t)b.set.count * sizeof(double));
    b.input.attributes = attributes;
    b.input.attribute_count = 2;
    b.options.outputs |= MCOR_OUT_NEAREST_PARTICLE;
    mcor_surface surface = extract(&b);
    ORACLE_CHECK(surface.triangle_count > 50 && surface.attribute_count == 2, "%s", name);
    reference.field.kind = ORACLE_SHEPARD;
    double worst = 0.0;
    for (int a = 0; a < 4 && component; ++a)
    {
      for (int64_t j = 0; j < b.set.count; ++j)
      {
        component[j] = a < 3 ? b.set.position[3 * j + a] : b.set.scalar[j];
      }
      for (int64_t v = 0; v < surface.point_count; ++v)
      {
        oracle_sample sample;
        oracle_evaluate(&reference.field, component, &surface.points[3 * v], &sample);
        const double value = a < 3 ? surface.attributes[0][3 * v + a] : surface.attributes[1][v];
        worst = fmax(worst, fabs(value - sample.value));
      }
    }
    ORACLE_CHECK(worst < 1e-5, "%s: attributes are off by %g", name, worst);
    for (int64_t v = 0; v < surface.point_count; v += 7)
    {
      double distance;
      const int64_t nearest = nearest_fluid(&b.set, &surface.points[3 * v], &distance);
      const int64_t found = surface.nearest_particle[v];
      double d = 0.0;
      for (int axis = 0; axis < 3 && found >= 0; ++axis)
      {
        d += pow(b.set.position[3 * found + axis] - surface.points[3 * v + axis], 2.0);
      }
      ORACLE_CHECK(found >= 0 && !b.set.solid[found] && sqrt(d) <= distance * (1.0 + 1e-5),
        "%s: nearest to vertex %lld is %lld, not %lld", name, (long long)v, (long long)found,
        (long long)nearest);
    }
    free(component);
    mcor_free_surface(&surface);
    oracle_free_reference(&reference);
  }
  free_bench(&b);
}

/* Smoothing lengths 1:1024 with cubes as small as the smallest asks for: a lattice of 10^12 cells,
 * too large for a reference. The surface is a closed manifold, and each vertex on it. */
static void test_wide_range(const char* device)
{
  bench b;
  char message[256];
  oracle_reference reference; /* with large cubes: for its field alone */
  memset(&reference, 0, sizeof(reference));
  const int made = create_bench(&b, "variable_1024", device);
  b.options.cube_size = 0.1;
  if (made && oracle_create_reference(&reference, &b.input, &b.options, 10000000, message))
  {
    b.options.cube_size = 0.0;
    b.options.node_threshold = b.options.vertex_threshold = 0.0; /* closed */
    mcor_surface surface = extract(&b);
    mesh_report report;
    ORACLE_CHECK(surface.triangle_count > 5000 && surface.statistics.virtual_cells > 1000000000000,
      "%lld triangles in %lld cells", (long long)surface.triangle_count,
      (long long)surface.statistics.virtual_cells);
    double worst = 0.0;
    for (int64_t v = 0; v < surface.point_count; ++v)
    {
      oracle_sample sample;
      oracle_evaluate(&reference.field, b.set.scalar, &surface.points[3 * v], &sample);
      worst = fmax(worst, fabs(sample.value - b.iso));
    }
    const double range = surface.statistics.scalar_max - surface.statistics.scalar_min;
    ORACLE_CHECK(worst <= 5e-6 * range, "1:1024: off by %g of the range", worst / range);
    if (mesh_check(
          surface.points, surface.point_count, surface.triangles, surface.triangle_count, &report))
    {
      for (int f = 0; f < MESH_FAULT_COUNT; ++f)
      {
        ORACLE_CHECK(
          report.faults[f] == 0, "1:1024: %s: %s", mesh_fault_name((mesh_fault)f), report.first[f]);
      }
      ORACLE_CHECK(report.boundary_edges == 0 && report.components == 1 && report.euler == 2,
        "1:1024: %lld boundary edges, %lld components, Euler characteristic %lld",
        (long long)report.boundary_edges, (long long)report.components, (long long)report.euler);
      mesh_free_report(&report);
    }
    mcor_free_surface(&surface);
  }
  else
  {
    ORACLE_CHECK(0, "variable_1024: no reference");
  }
  oracle_free_reference(&reference);
  free_bench(&b);
}

int main(int argc, char** argv)
{
  const char* device = argc > 1 ? argv[1] : NULL;
  const double shift[3] = { 3 * 0.0625, -40 * 0.0625, 1000 * 0.0625 };
  const double far[3] = { 0x1p21, -0x1p21, 0x1p20 }; /* a million times the size */
  const double none[3] = { 0.0, 0.0, 0.0 };
  test_permutation("gyroid", device);
  test_permutation("variable_4", device);
  test_permutation("puddle", device);
  test_permutation("coincident", device);
  test_reuse(device);
  test_iso_values(device);
  test_transform(device, 1.0, shift);
  test_transform(device, 1.0, far);
  test_transform(device, 0x1p-30, none); /* about 1e-9 */
  test_transform(device, 0x1p30, none);
  test_wide_range(device);
  test_preview(device);
  test_attributes("gyroid", device);
  test_attributes("puddle", device);
  printf("%d failures\n", oracle_failures);
  return oracle_failures > 0;
}
