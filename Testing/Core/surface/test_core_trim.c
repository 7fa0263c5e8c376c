/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Trimming: the five cases of Fig. 3 with hand-made weights, shared cut vertices, limits. The oracle compares what is
 * cut of real surfaces. */

#include "core_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define THRESHOLD 0.5f
#define VERTEX_LIMIT 2000
#define TRIANGLE_LIMIT 4000

/* A mesh as the correction leaves it, positions in cubes. */
typedef struct flat_mesh
{
  int vertices, triangles;
  cl_int node[VERTEX_LIMIT][4];
  float offset[VERTEX_LIMIT][4];
  float weight[VERTEX_LIMIT];
  int triangle[TRIANGLE_LIMIT][3];
} flat_mesh;

static double place(const flat_mesh* m, int vertex, int axis)
{
  return m->node[vertex][axis] + (double)m->offset[vertex][axis];
}

/* Runs the phase on the mesh, without correction of the cuts; *m becomes the trimmed mesh. */
static void trim(mcor_context* context, flat_mesh* m)
{
  static const float zeros[VERTEX_LIMIT * 4];
  static mcor_options options;
  core_set set = core_make_block(3, 0, 1, core_slope);
  const double iso = 0;
  const mcor_input input = core_input_to_keep(&set);
  options = core_options(&iso);
  options.preview = 1;
  static mcor_statistics statistics;
  mcor_surface surface = core_extract(context, &input, &options); /* for the search grid */
  context->run.options = &options;                                /* as if the call went on */
  context->run.statistics = &statistics;
  mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)m->vertices;
  CORE_OK(context, mcor_write(context, &mesh->node, m->node, n * sizeof m->node[0]));
  CORE_OK(context, mcor_write(context, &mesh->offset, m->offset, n * sizeof m->offset[0]));
  CORE_OK(context, mcor_write(context, &mesh->vertex_weight, m->weight, n * sizeof(float)));
  CORE_OK(context, mcor_write(context, &mesh->field_value, zeros, n * sizeof(float)));
  CORE_OK(context, mcor_write(context, &mesh->gradient, zeros, n * 4 * sizeof(float)));
  CORE_OK(context, mcor_fill(context, &mesh->flag, 0, n));
  CORE_OK(context,
    mcor_write(context, &mesh->triangles, m->triangle, (size_t)m->triangles * 3 * sizeof(int)));
  mesh->march_count = mesh->vertex_count = m->vertices;
  mesh->triangle_count = m->triangles;
  context->run.statistics = &surface.statistics;
  CORE_OK(context, mcor_trim(context));
  m->vertices = mesh->vertex_count;
  m->triangles = mesh->triangle_count;
  assert_true(m->vertices <= VERTEX_LIMIT && m->triangles <= TRIANGLE_LIMIT);
  CORE_OK(
    context, mcor_read(context, &mesh->node, 0, m->node, (size_t)m->vertices * sizeof m->node[0]));
  CORE_OK(context,
    mcor_read(context, &mesh->offset, 0, m->offset, (size_t)m->vertices * sizeof m->offset[0]));
  CORE_OK(context,
    mcor_read(context, &mesh->triangles, 0, m->triangle, (size_t)m->triangles * 3 * sizeof(int)));
  mcor_free_surface(&surface);
  core_free_set(&set);
}

/* Area in the xy plane, positive counter-clockwise. */
static double area_of(const flat_mesh* m, int t)
{
  const int* v = m->triangle[t];
  return 0.5 *
    ((place(m, v[1], 0) - place(m, v[0], 0)) * (place(m, v[2], 1) - place(m, v[0], 1)) -
      (place(m, v[1], 1) - place(m, v[0], 1)) * (place(m, v[2], 0) - place(m, v[0], 0)));
}

/* Area of the part of a triangle with linear weight >= threshold, by clipping the polygon. */
static double clipped_area(const double x[3][2], const float* weight)
{
  double p[6][2];
  int n = 0;
  for (int i = 0; i < 3; ++i)
  {
    const int j = (i + 1) % 3;
    const int in_i = weight[i] > THRESHOLD, in_j = weight[j] > THRESHOLD;
    if (in_i)
    {
      memcpy(p[n++], x[i], sizeof p[0]);
    }
    if (in_i != in_j)
    {
      const double s = (double)(THRESHOLD - weight[i]) / (double)(weight[j] - weight[i]);
      p[n][0] = x[i][0] + s * (x[j][0] - x[i][0]);
      p[n][1] = x[i][1] + s * (x[j][1] - x[i][1]);
      ++n;
    }
  }
  double area = 0;
  for (int i = 0; i < n; ++i)
  {
    const int j = (i + 1) % n;
    area += 0.5 * (p[i][0] * p[j][1] - p[j][0] * p[i][1]);
  }
  return area;
}

/* One triangle with each combination of weights below, at and above the threshold. */
static void test_figure_3(void** state)
{
  static const float weights[3] = { 0.2f, THRESHOLD, 0.9f };
  static const double x[3][2] = { { 0.25, 0.5 }, { 3.5, 0.75 }, { 1.5, 2.25 } };
  static flat_mesh m;
  for (int combination = 0; combination < 27; ++combination)
  {
    memset(&m, 0, sizeof m);
    m.vertices = 3;
    m.triangles = 1;
    int above = 0;
    for (int v = 0; v < 3; ++v)
    {
      const int digit = combination / (v == 0 ? 1 : v == 1 ? 3 : 9) % 3;
      m.weight[v] = weights[digit];
      above += digit == 2;
      m.triangle[0][v] = v;
      for (int a = 0; a < 3; ++a)
      {
        m.node[v][a] = 40 + (a < 2 ? (int)x[v][a] : 0);
        m.offset[v][a] = a < 2 ? (float)(x[v][a] - (int)x[v][a]) : 0.25f;
      }
    }
    const float weight[3] = { m.weight[0], m.weight[1], m.weight[2] };
    trim(*state, &m);
    const int expected = above == 0 ? 0 : above == 2 ? 2 : 1;
    CORE_CHECK(m.triangles == expected, "combination %d: %d triangles", combination, m.triangles);
    double area = 0;
    for (int t = 0; t < m.triangles; ++t)
    {
      CORE_CHECK(area_of(&m, t) > 0, "combination %d: triangle %d has no area", combination, t);
      area += area_of(&m, t);
    }
    const double wanted = clipped_area(x, weight);
    CORE_CHECK(
      fabs(area - wanted) < 3e-5, "combination %d: area %g, not %g", combination, area, wanted);
    if (above == 1 || above == 2)
    {
      CORE_CHECK(m.vertices == 5, "combination %d: %d vertices", combination, m.vertices);
    }
  }
}

/* A plane of many triangles with arbitrary weights. */
static void make_plane(flat_mesh* m, uint64_t seed)
{
  enum
  {
    N = 16
  };
  memset(m, 0, sizeof *m);
  m->vertices = N * N;
  for (int v = 0; v < N * N; ++v)
  {
    const int at[3] = { v % N, v / N, 0 };
    for (int a = 0; a < 3; ++a)
    {
      m->node[v][a] = 33 + at[a];
      m->offset[v][a] = a < 2 ? (float)(0.6 * random_unit(&seed)) : 0.5f;
    }
    m->weight[v] = (float)random_unit(&seed);
  }
  for (int c = 0; c < N * N; ++c)
  {
    const int v = c;
    if (v % N < N - 1 && v / N < N - 1)
    {
      const int quad[2][3] = { { v, v + 1, v + N + 1 }, { v, v + N + 1, v + N } };
      memcpy(m->triangle[m->triangles], quad, sizeof quad);
      m->triangles += 2;
    }
  }
}

/* Cut vertices are shared: the result is a manifold whose area is that of the clipped triangles. */
static void test_shared_cuts(void** state)
{
  static flat_mesh m;
  static double points[VERTEX_LIMIT][3];
  for (uint64_t seed = 1; seed <= 5; ++seed)
  {
    make_plane(&m, seed);
    double wanted = 0, area = 0;
    for (int t = 0; t < m.triangles; ++t)
    {
      double x[3][2];
      float weight[3];
      for (int c = 0; c < 3; ++c)
      {
        weight[c] = m.weight[m.triangle[t][c]];
        x[c][0] = place(&m, m.triangle[t][c], 0);
        x[c][1] = place(&m, m.triangle[t][c], 1);
      }
      wanted += clipped_area(x, weight);
    }
    trim(*state, &m);
    for (int t = 0; t < m.triangles; ++t)
    {
      area += area_of(&m, t);
    }
    CORE_CHECK(fabs(area - wanted) < 1e-3, "seed %d: area %g, not %g", (int)seed, area, wanted);
    for (int v = 0; v < m.vertices; ++v)
    {
      for (int a = 0; a < 3; ++a)
      {
        points[v][a] = place(&m, v, a);
      }
    }
    mesh_report report;
    assert_true(mesh_check(points[0], m.vertices, m.triangle[0], m.triangles, &report));
    static const mesh_fault faults[] = { MESH_BAD_INDEX, MESH_REPEATED_INDEX,
      MESH_DUPLICATE_TRIANGLE, MESH_NON_MANIFOLD_EDGE, MESH_ORIENTATION_CLASH,
      MESH_COINCIDENT_POINT };
    for (int f = 0; f < 6; ++f)
    {
      CORE_CHECK(report.faults[faults[f]] == 0, "seed %d: %s: %s", (int)seed,
        mesh_fault_name(faults[f]), report.first[faults[f]]);
    }
    mesh_free_report(&report);
  }
}

/* Thresholds of 0 trim nothing, high ones everything; in between the surface shrinks. Where it ends, points are
 * flagged. */
static void test_thresholds(void** state)
{
  core_set set = core_make_block(8, 0.2, 3, core_slope);
  const double iso = 0;
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  static const double thresholds[] = { 0, 0.3, 0.6, 0.9, 2 };
  options.outputs |= MCOR_OUT_BOUNDARY_FLAG;
  double last = INFINITY;
  for (int i = 0; i < 5; ++i)
  {
    options.vertex_threshold = thresholds[i];
    mcor_surface surface = core_extract(*state, &input, &options);
    mesh_report report = core_check_mesh(&surface);
    core_check_flags(&surface);
    CORE_CHECK(
      report.area < last, "threshold %g: area %g after %g", thresholds[i], report.area, last);
    CORE_CHECK(i > 0 || surface.triangle_count == surface.statistics.triangles_before_trimming,
      "a threshold of 0 trims");
    CORE_CHECK((report.area > 0) == (i < 4), "threshold %g: area %g", thresholds[i], report.area);
    last = report.area;
    mesh_free_report(&report);
    mcor_free_surface(&surface);
  }
  options.node_threshold = 2;
  options.vertex_threshold = 0;
  mcor_surface surface = core_extract(*state, &input, &options);
  assert_int_equal(surface.triangle_count, 0);
  mcor_free_surface(&surface);
  core_free_set(&set);
}

/* Vertices of the trim boundary are counted on top of those of the surface. */
static void test_vertex_limit(void** state)
{
  mcor_context* context = *state;
  static const int corners[3] = { 0, 1, 2 };
  static const float weights[3] = { 0.2f, 0.8f, 0.9f };
  const double iso = 0;
  core_set set = core_make_block(3, 0, 1, core_slope);
  const mcor_input input = core_input_to_keep(&set);
  mcor_options options = core_options(&iso);
  mcor_surface surface = core_extract(context, &input, &options);
  mcor_mesh* mesh = &context->mesh;
  CORE_OK(context, mcor_write(context, &mesh->vertex_weight, weights, sizeof weights));
  CORE_OK(context, mcor_write(context, &mesh->triangles, corners, sizeof corners));
  mesh->triangle_count = 1;
  mesh->march_count = mesh->vertex_count = MCOR_COUNT_LIMIT - 1;
  context->run.options = &options;
  context->run.statistics = &surface.statistics;
  assert_int_equal(mcor_trim(context), MCOR_OUT_OF_CAPACITY);
  CORE_CHECK(
    strstr(mcor_last_error(context), "2147479553 vertices"), "%s", mcor_last_error(context));
  mcor_release_memory(context);
  mcor_free_surface(&surface);
  core_free_set(&set);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_figure_3),
    cmocka_unit_test(test_shared_cuts), cmocka_unit_test(test_thresholds),
    cmocka_unit_test(test_vertex_limit) };
  return cmocka_run_group_tests_name("trim", tests, core_set_up, core_tear_down);
}
