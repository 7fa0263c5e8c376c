/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests trimming: thresholds, flags, limits. The oracle compares which vertices are cut away. */

#include "core_fixture.h"

/* A threshold of 0 trims nothing, and a high one trims everything; thresholds between shrink the surface. Points where
 * the surface ends are flagged. */
static void test_thresholds(void** state)
{
  CORE_SET set = core_make_block(8, 0.2, 3, core_slope);
  const double iso = 0;
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  static const double thresholds[] = { 0, 0.3, 0.6, 0.9, 2 };
  options.outputs |= MCOR_OUT_BOUNDARY_FLAG;
  double last = INFINITY;
  for (int i = 0; i < 5; ++i)
  {
    options.vertex_threshold = thresholds[i];
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    CORE_REPORT report = core_check_mesh(&surface);
    core_check_flags(&surface);
    CORE_CHECK(report.area < last, thresholds[i], report.area, last);
    assert_true(i > 0 || surface.triangle_count == surface.statistics.triangles_before_trimming);
    CORE_CHECK((report.area > 0) == (i < 4), thresholds[i], report.area);
    last = report.area;
  }
  options.node_threshold = 2;
  options.vertex_threshold = 0;
  CORE_SURFACE surface = core_extract(*state, &input, &options);
  assert_int_equal(surface.triangle_count, 0);
}

/* The limit of vertices counts the surface's own vertices and the vertices that trimming adds at the border. */
static void test_vertex_limit(void** state)
{
  mcor_context* context = *state;
  static const int corners[3] = { 0, 1, 2 };
  static const float weights[3] = { 0.2f, 0.8f, 0.9f };
  const double iso = 0;
  CORE_SET set = core_make_block(3, 0, 1, core_slope);
  const mcor_input input = core_input_to_keep(&set);
  mcor_options options = core_options(&iso);
  CORE_SURFACE surface = core_extract(context, &input, &options);
  mcor_mesh* mesh = &context->mesh;
  CORE_OK(context, mcor_write(context, &mesh->vertex_weight, weights, sizeof weights));
  CORE_OK(context, mcor_write(context, &mesh->triangles, corners, sizeof corners));
  mesh->triangle_count = 1;
  mesh->march_count = mesh->vertex_count = MCOR_COUNT_LIMIT - 1;
  context->run.options = &options;
  context->run.statistics = &surface.statistics;
  CORE_FAILS(context, MCOR_OUT_OF_CAPACITY, mcor_trim(context), "VERTICES_TOO_MANY|2147479553");
  mcor_release_memory(context);
}

CORE_MAIN(core_set_up, core_tear_down, test_thresholds, test_vertex_limit)
