/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Preview has the same triangles, and a range of sizes that is too wide for the reference's lattice gives a closed
 * surface on which the field has the iso value. */

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
  test_wide_range(device);
  test_preview(device);
  printf("%d failures\n", oracle_failures);
  return oracle_failures > 0;
}
